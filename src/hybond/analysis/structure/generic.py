"""The same graph with other numbers: what holds for almost all values is structural."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hybond.model.expressions import Binary, Expr, Name, Number, simplify
from hybond.model.graph import FlatGraph, Node
from hybond.model.kinds import RESISTORS, SOURCES, STORAGES
from hybond.model.laws import Law

LEAST, MOST = 0.4, 2.5
"""Bounds of the random values; their logarithms are uniform."""


def generic(graph: FlatGraph, seed: int) -> FlatGraph:
    """Return `graph` with random values in its elements; what is zero stays zero.

    Constants of C, I, R, G, TF and GY become positive random numbers, each by itself (two
    elements that share a parameter are separated). Matrices keep their pattern of zeros;
    those of storages stay symmetric and positive definite. A law that is not a constant is
    multiplied by a random number.

    Parameters
    ----------
    seed : int
        The same seed gives the same values.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(c=hb.C(1), r=hb.R(1), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> graph = m.flatten()
    >>> [n.law.matrix[0][0] == 1 for n in graph.nodes if n.law]
    [True, True]
    >>> [n.law.matrix[0][0] == 1 for n in generic(graph, 0).nodes if n.law]
    [False, False]
    """
    rng = np.random.default_rng(seed)
    # the laws as written hold no more
    return replace(graph, nodes=tuple(_other(n, rng) for n in graph.nodes), parametric=None)


def with_constants(graph: FlatGraph, seed: int) -> FlatGraph:
    """Return `graph` with random constants for the laws, sources aside, that are none.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("cubic")
    >>> m.add(c=hb.C(2), r=hb.R({"e": "f^3"}), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> [n.law.linear for n in with_constants(m.flatten(), 0).nodes if n.law]
    [True, True]
    """
    rng = np.random.default_rng(seed)
    nodes = []
    for n in graph.nodes:
        if n.law is not None and n.law.matrix is None and n.kind not in SOURCES:
            size = 1 if n.kind not in STORAGES + RESISTORS else len(n.ends)
            n = replace(n, law=_law(n, n.law, np.diag(_numbers(rng, size))))
        nodes.append(n)
    return replace(graph, nodes=tuple(nodes), parametric=None)


def _other(node: Node, rng: np.random.Generator) -> Node:
    law = node.law
    if law is None or node.kind in SOURCES:
        return node
    if law.matrix is None:
        factor = _numbers(rng, 1)[0]
        return replace(node, law=replace(law, expressions=_times(factor, law.expressions)))
    old = np.array(law.matrix)
    new = _numbers(rng, old.size).reshape(old.shape)
    if node.kind in STORAGES:
        # diagonally dominant, hence positive definite
        new = np.where(old != 0.0, np.tril(new, -1) + np.tril(new, -1).T, 0.0)
        np.fill_diagonal(new, np.abs(new).sum(axis=1) + _numbers(rng, len(old)))
    else:
        symmetric = old.shape[0] == old.shape[1] and bool((old == old.T).all())
        new = np.where(old != 0.0, (np.tril(new) + np.tril(new, -1).T) if symmetric else new, 0.0)
    return replace(node, law=_law(node, law, new))


def _law(node: Node, law: Law, matrix: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Law:
    rows = tuple(tuple(float(v) for v in row) for row in matrix)
    if node.kind not in STORAGES + RESISTORS:
        return Law(law.output, (Number(rows[0][0]),), rows)
    argument = node.about.energy or ("f" if law.output == "e" else "e")
    many = len(node.ends) > 1
    expressions = []
    for row in rows:
        total: Expr = Number(0.0)
        for k, c in enumerate(row):
            name = Name(f"law:{argument}{k + 1 if many else ''}")
            total = Binary("+", total, Binary("*", Number(c), name))
        expressions.append(simplify(total))
    return Law(law.output, tuple(expressions), rows)


def _times(factor: float, expressions: tuple[Expr, ...]) -> tuple[Expr, ...]:
    return tuple(simplify(Binary("*", Number(float(factor)), e)) for e in expressions)


def _numbers(
    rng: np.random.Generator, count: int
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.exp(rng.uniform(np.log(LEAST), np.log(MOST), count))
