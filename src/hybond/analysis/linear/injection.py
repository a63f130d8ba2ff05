"""A graph into which a sine is injected: onto a source, or onto an input wherever it is read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from hybond.errors import UsageError
from hybond.model.expressions import Binary, Call, Expr, Name, Number, substitute
from hybond.model.graph import FlatGraph
from hybond.model.kinds import SOURCES
from hybond.model.laws import Law
from hybond.names import did_you_mean

WHOLE = ("nodes", "machines", "integrals", "samples", "signals")
"""What of a graph reads inputs."""


def injected(graph: FlatGraph, name: str, amplitude: float, frequency: float) -> FlatGraph:
    """Return a graph in which ``amplitude*sin(2 pi frequency time)`` is added.

    Parameters
    ----------
    name : str
        A source, ``V`` or ``V.e``, or an input of the model.
    amplitude : float
        In the unit of the source or input, SI.
    frequency : float
        Hz.

    Raises
    ------
    UsageError
        HB-A501 for what is neither.
    """
    angle = Binary("*", Number(2.0 * math.pi * frequency), Name("time"))
    sine: Expr = Binary("*", Number(amplitude), Call("sin", (angle,)))
    for i in graph.inputs:
        if i.path == name:
            own = f"u:{i.index}"
            return _read_anew(graph, {own: Binary("+", Name(own), sine)})
    node = graph.nodes[source_of(graph, name)]
    assert node.law is not None
    law = Law(node.law.output, (Binary("+", node.law.expressions[0], sine),))
    nodes = list(graph.nodes)
    nodes[node.index] = replace(node, law=law)
    return replace(graph, nodes=tuple(nodes), parametric=None, written=None)


def source_of(graph: FlatGraph, name: str) -> int:
    """Return the node of a source by its name, ``V`` or ``V.e``.

    Raises
    ------
    UsageError
        HB-A501.
    """
    sources = {n.path: n for n in graph.nodes if n.kind in SOURCES and not n.implied}
    path, _, variable = name.rpartition(".")
    for own in (name, path):
        node = sources.get(own)
        if node is not None and (own == name or variable == ("e" if node.kind == "Se" else "f")):
            return node.index
    inputs = [i.path for i in graph.inputs]
    hint = did_you_mean(name, [*inputs, *sources])
    if name in graph.parameters:
        hint = "make the parameter an input of the model: a sine can be added to that"
    raise UsageError(
        f"{name!r} is no source and no input of the model", code="HB-A501", where="input", hint=hint
    )


def _read_anew(graph: FlatGraph, put: Mapping[str, Expr]) -> FlatGraph:
    """Return a graph in which names are replaced wherever something reads them."""
    changed = {name: _put(getattr(graph, name), put) for name in WHOLE}
    read = graph.read
    assert read is not None
    return replace(
        graph,
        **changed,
        read=lambda text: substitute(read(text), put),
        parametric=None,
        written=None,
    )


def _put(value: Any, put: Mapping[str, Expr]) -> Any:
    if isinstance(value, Expr):
        return substitute(value, put)
    if isinstance(value, tuple):
        return tuple(_put(v, put) for v in value)
    if isinstance(value, Mapping):
        return {k: _put(v, put) for k, v in value.items()}
    if isinstance(value, Law):
        made = tuple(_put(e, put) for e in value.expressions)
        # a law that reads an input was not linear with constant coefficients before either
        return value if made == value.expressions else Law(value.output, made)
    if is_dataclass(value) and not isinstance(value, type) and _has_trees(value):
        new = {f.name: _put(getattr(value, f.name), put) for f in fields(value) if f.init}
        same = all(new[f.name] is getattr(value, f.name) for f in fields(value) if f.init)
        return value if same else type(value)(**new)
    return value


def _has_trees(value: Any) -> bool:
    """Whether a record is one of the model's own, which may hold expressions."""
    own = ("Node", "Machine", "Rule", "JunctionLaw", "Integral", "Sample", "Law")
    return type(value).__name__ in own
