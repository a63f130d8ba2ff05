"""What a run is differentiated by: each thing a slot in the laws of a graph."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.opened import Opened
from hybond.equations.storage import stored_names
from hybond.errors import EquationError
from hybond.model.builder import Model
from hybond.model.expressions import (
    Expr,
    Number,
    compile_expression,
    differentiate,
    names,
    substitute,
)
from hybond.model.expressions.slots import PREFIX, Slots, tree_of
from hybond.model.expressions.tree import transform
from hybond.model.flatten import flatten
from hybond.model.graph import FlatGraph, Storage
from hybond.model.kept import kept_graph
from hybond.model.parts import Value

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is varied.

    Parameters
    ----------
    names : tuple of str
        As they were asked for.
    paths : tuple of str
        The parameters of `model` that they are.
    model : Model
        With a parameter for each.
    graph : FlatGraph
        With a slot for each in its laws.
    plain : FlatGraph
        The same with numbers.
    values : array, shape (many,)
        SI.
    units : tuple of str
    follows : array, shape (many, many)
        How each parameter changes with each: those that are made of others follow them.
    modes : dict
        Those of `Opened`.
    """

    names: tuple[str, ...]
    paths: tuple[str, ...]
    model: Model
    graph: FlatGraph
    plain: FlatGraph
    values: NDArray[np.float64]
    units: tuple[str, ...]
    follows: NDArray[np.float64]
    modes: dict[Any, Any] = field(default_factory=dict, compare=False, repr=False)

    @property
    def columns(self) -> list[str]:
        """The names in laws."""
        return [PREFIX + path for path in self.paths]


def slotted(opened: Opened, given: Mapping[str, Value]) -> Wanted:
    """Return the graph of an opened model with slots, and with other numbers in it.

    Parameters
    ----------
    given : mapping of path to value
        Of what is varied, by the names of `opened.paths`.
    """
    paths, model = opened.paths, opened.model
    slots = Slots(set(paths), moving=True)
    values = {**opened.given, **given}
    graph = flatten(model, values, slots)
    for name, path in zip(opened.names, paths):
        if path in slots.fixed or path not in slots.parameters:
            into = slots.fixed.get(path)
            raise EquationError(
                f"{name} cannot be varied: {f'it goes into {into}' if into else 'it is no number'}",
                code="HB-A521",
                where="wrt",
                hint="vary another parameter, or compare two runs",
            )
    found = [slots.parameters[path] for path in paths]
    row = [s.start for s in found]
    index = {PREFIX + path: k for k, path in enumerate(paths)}
    follows = np.eye(len(paths))
    order = {path: k for k, path in enumerate(slots.parameters)}
    for k in sorted(range(len(paths)), key=lambda k: order[paths[k]]):
        made = found[k].made_of
        if made is not None and paths[k] not in given:
            for name in sorted(names(made)):
                slope = compile_expression(differentiate(made, name), index, pre_offset=0)(row)
                follows[k] += float(slope) * follows[index[name]]
    units = []
    for s in found:
        text = "" if s.dimension is None else str(s.dimension)
        units.append("" if text == "1" else text)
    return Wanted(
        opened.names,
        paths,
        model,
        graph,
        kept_graph(model, values),
        np.array(row),
        tuple(units),
        follows,
        opened.modes,
    )


def followed(e: Expr) -> Expr:
    """Return an expression in which numbers that follow from parameters say so."""
    return transform(e, lambda node: tree_of(node.value) if isinstance(node, Number) else node)


def start_slopes(found: Wanted, x0: Vector) -> Vector:
    """Return the derivatives of what is stored and integrated at the start, shape (states, many).

    Parameters
    ----------
    x0 : array, shape (states,)
        The start itself. Where the co-energy variable z is given, ``law(x0) = z`` is
        differentiated.
    """
    graph, many = found.graph, len(found.names)
    index = {name: k for k, name in enumerate(found.columns)}
    index |= {f"x:{s.index}": many + s.index for s in graph.storages}
    row = [*found.values.tolist(), *x0.tolist()]

    def slope(e: Expr, name: str) -> float:
        if name not in names(e):
            return 0.0
        return float(compile_expression(differentiate(e, name), index, pre_offset=0)(row))

    def by_parameters(e: Expr) -> Vector:
        return np.array([slope(e, name) for name in found.columns])

    states = np.zeros((len(graph.storages) + len(graph.integrals), many))
    for s in graph.storages:
        states[s.index] = by_parameters(tree_of(s.start))
    for i in graph.integrals:
        states[len(graph.storages) + i.index] = by_parameters(tree_of(i.start))
    for node in {s.node: None for s in graph.storages if s.start_is == "co-energy"}:
        own = [s for s in graph.storages if s.node == node]
        laws = [stored_law(graph, s) for s in own]
        stiff = np.array([[slope(law, f"x:{o.index}") for o in own] for law in laws])
        places = [s.index for s in own]
        right = states[places] - np.array([by_parameters(law) for law in laws])
        states[places] = np.linalg.solve(stiff, right)
    return states


def stored_law(graph: FlatGraph, s: Storage) -> Expr:
    """Return the co-energy variable of a storage port by what is stored, in slots."""
    law = graph.nodes[s.node].law
    assert law is not None
    return followed(substitute(law.expressions[s.port], stored_names(graph.nodes[s.node], graph)))
