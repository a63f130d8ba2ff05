"""Laws of storage, in names of a graph and in numbers: co-energy variables, stiffness, starts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from hybond.errors import ModelError
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Neg,
    Number,
    compile_expression,
    differentiate,
    substitute,
)
from hybond.model.expressions.tree import fold
from hybond.model.graph import FlatGraph, Node, Storage
from hybond.records import dataclass

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Closure = Callable[[Sequence[float]], float]

EXACT = 15
"""Degree up to which the energy of a polynomial law is found without error control."""


@dataclass(frozen=True, slots=True)
class StorageLaw:
    """``z = dH/dx`` of one storage, on what its own ports store."""

    ports: tuple[Storage, ...]
    laws: tuple[Closure, ...]
    slopes: tuple[tuple[Closure, ...], ...]

    @staticmethod
    def of(graph: FlatGraph, ports: tuple[Storage, ...]) -> StorageLaw:
        """Read the law of the storage with these ports, which are all that it has."""
        node = graph.nodes[ports[0].node]
        assert node.law is not None
        index = {f"x:{s.index}": k for k, s in enumerate(ports)}
        named = stored_names(node, graph, ports)

        def closure(e: Expr) -> Closure:
            return compile_expression(e, index, pre_offset=len(index))

        return StorageLaw(
            ports,
            tuple(closure(substitute(node.law.expressions[s.port], named)) for s in ports),
            tuple(
                tuple(closure(stiffness(node, s.port, o.port, graph, ports)) for o in ports)
                for s in ports
            ),
        )

    def co_energy(self, x: Vector) -> Vector:
        """Return the effort of each port of a C, the flow of each of an I."""
        v = x.tolist()
        return np.array([f(v) for f in self.laws])

    def stiffness(self, x: Vector) -> Matrix:
        """Return dz/dx."""
        v = x.tolist()
        return np.array([[f(v) for f in row] for row in self.slopes])


def storage_laws(graph: FlatGraph) -> list[StorageLaw]:
    """Return the law of each storage, in the order of their first ports."""
    ports: dict[int, list[Storage]] = {}
    for s in graph.storages:
        ports.setdefault(s.node, []).append(s)
    return [StorageLaw.of(graph, tuple(own)) for own in ports.values()]


def stiffness_at(graph: FlatGraph, x: Vector) -> Matrix:
    """Return the derivative of all co-energy variables by all that is stored, at `x`."""
    return np.asarray(stiffness_along(graph, x[None, :])[0])


def stiffness_along(graph: FlatGraph, points: Matrix) -> NDArray[np.float64]:
    """Return those derivatives at each of many points: ``found[k]`` of the row ``points[k]``."""
    many, size = points.shape
    found = np.zeros((many, size, size))
    for law in storage_laws(graph):
        own = np.array([s.index for s in law.ports], dtype=np.intp)
        for k, x in enumerate(points[:, own]):
            found[k][np.ix_(own, own)] = law.stiffness(x)
    return found


def stored_at(graph: FlatGraph, law: StorageLaw, z: Vector) -> Vector:
    """Return what a storage stores at the co-energy variables `z` of its ports.

    Raises
    ------
    ModelError
        HB-M166 if the law cannot be inverted there.
    """
    linear = graph.nodes[law.ports[0].node].law
    if linear is not None and linear.matrix is not None:
        return np.asarray(np.linalg.solve(np.array(linear.matrix), z))
    x = np.zeros(len(z))
    for _ in range(100):
        error = law.co_energy(x) - z
        step = np.linalg.lstsq(law.stiffness(x), error, rcond=None)[0]
        if not step.any() and error.any():
            # flat at this point (a cubic spring at rest): look aside
            step = -np.sign(error) * 1e-3
        x -= step
        met = np.abs(law.co_energy(x) - z) <= 1e-9 * np.abs(z).max()
        if met.all() and (np.abs(step) <= 1e-12 * np.abs(x).max()).all():
            return x
    wanted = next(k for k, s in enumerate(law.ports) if s.start_is == "co-energy")
    raise ModelError(
        f"no stored quantity gives the start value {z[wanted]:g}",
        code="HB-M166",
        where=law.ports[wanted].path,
        hint="give the stored quantity itself",
    )


@cache
def gauss(count: int) -> tuple[list[float], list[float]]:
    """Return points and weights of Gauss's formula on [0, 1]."""
    if count == 1:
        return [0.5], [1.0]
    points, weights = np.polynomial.legendre.leggauss(count)
    return (0.5 * (points + 1.0)).tolist(), (0.5 * weights).tolist()


def polynomial_degree(e: Expr) -> int | None:
    """Return the degree of an expression as a polynomial of all its names; None if it is none.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> polynomial_degree(parse("1000*q + 2*q^3")), polynomial_degree(parse("q/3 - q*p"))
    (3, 2)
    >>> polynomial_degree(parse("sin(q)")) is None
    True
    """

    def of(node: Expr, _: bool, below: list[int | None]) -> int | None:
        known = [d for d in below if d is not None]
        if len(known) < len(below):
            return None
        match node:
            case Number():
                return 0
            case Name():
                return 1
            case Neg():
                return known[0]
            case Binary(op="+" | "-"):
                return max(known)
            case Binary(op="*"):
                return sum(known)
            case Binary(op="/"):
                return known[0] if known[1] == 0 else None
            case Binary(op="^", right=Number(value)) if value in range(1, EXACT + 1):
                return known[0] * int(value)
        return None

    return fold(e, of)


def stiffness(
    node: Node, port: int, other: int, graph: FlatGraph, own: Sequence[Storage] | None = None
) -> Expr:
    """Return the derivative of a storage's co-energy variable by a stored quantity.

    `own` are the storage ports of the node, if they are known.
    """
    assert node.law is not None
    if node.law.matrix is not None:
        return Number(node.law.matrix[port][other])
    energy = node.about.energy
    suffix = str(other + 1) if len(node.ends) > 1 else ""
    d = _slope(node.law.expressions[port], f"law:{energy}{suffix}")
    return substitute(d, stored_names(node, graph, own))


@lru_cache(maxsize=1024)
def _slope(law: Expr, name: str) -> Expr:
    """Return a derivative in local names, which are the same in many elements."""
    return differentiate(law, name)


def stored_names(
    node: Node, graph: FlatGraph, own: Sequence[Storage] | None = None
) -> dict[str, Expr]:
    """Return what a storage's local stored quantities are called in the graph.

    `own` are its ports, if they are known.
    """
    many = len(node.ends) > 1
    return {
        f"law:{node.about.energy}{s.port + 1 if many else ''}": Name(f"x:{s.index}")
        for s in (graph.storages if own is None else own)
        if s.node == node.index
    }
