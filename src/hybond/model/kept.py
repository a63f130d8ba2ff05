"""The flat graph of a model, kept as long as the model stays what it is.

Who runs a model again with other parameters writes these into the slots of the graph that is kept;
it is flattened anew where they make another model of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, fields, is_dataclass, replace
from typing import Any

import numpy as np

from hybond.model.builder import Model
from hybond.model.expressions.slots import Slots
from hybond.model.flatten import flatten
from hybond.model.graph import FlatGraph
from hybond.model.junction_laws import warn_of_values
from hybond.model.parts import Value
from hybond.model.paths import with_parts
from hybond.model.written import Writing, Written
from hybond.records import dataclass
from hybond.units import Dimension, try_quantity

Kind = Dimension | str | None
"""Of a value that is set: its dimension, None for a plain number; what is neither, as written."""
MOST = 4
"""Graphs with slots that are kept of a model: each for parameters that make other parts of it."""
OWN = "_known"
"""Where a model holds what is known of it. A graph refers to its model, so that a table of models
beside them would keep all of these for ever."""


@dataclass(slots=True)
class _Known:
    """What is known of a model.

    Parameters
    ----------
    content : Any
        What it was.
    graph : FlatGraph or None
        As it is written.
    slotted : list
        Kinds of parameters that were set, the graph with slots, and how it is written.
    """

    content: Any
    graph: FlatGraph | None = None
    slotted: list[tuple[dict[str, Kind], FlatGraph, Writing]] = field(default_factory=list)

    def __deepcopy__(self, memo: object) -> _Known:
        return _Known(None)

    def __reduce__(self) -> tuple[type[_Known], tuple[None]]:
        return _Known, (None,)


def kept_graph(model: Model, parameters: Mapping[str, Value]) -> FlatGraph:
    """Return the flat graph of a model, with values by dotted path in place of its own.

    Raises
    ------
    ModelError
        As `hybond.model.flatten.flatten`.

    Examples
    --------
    >>> m = Model("rc", parameters={"R": "2 ohm"})
    >>> kept_graph(m, {}) is kept_graph(m, {})
    True
    >>> m.parameter(R="3 ohm")
    >>> kept_graph(m, {}).parameters["R"], kept_graph(m, {"R": 4.0}).parameters["R"]
    (3.0, 4.0)
    """
    content = _content(model)
    known = vars(model).get(OWN)
    if known is None or known.content != content:
        known = vars(model)[OWN] = _Known(content)
    if parameters:
        return _written(model, known, parameters)
    graph = known.graph or flatten(model, {})
    if not _has_blocks(graph):
        known.graph = graph
    return graph


def _has_blocks(graph: FlatGraph) -> bool:
    """Whether files that are not the model's say what it does."""
    return any(s.block is not None for s in graph.samples)


def _written(model: Model, known: _Known, parameters: Mapping[str, Value]) -> FlatGraph:
    changed, left = with_parts(model, parameters)
    if changed is not model:
        return flatten(changed, left)
    found = {path: kind_of(value) for path, value in parameters.items()}
    kinds = {path: kind for path, (kind, _) in found.items()}
    given = {path: number for path, (_, number) in found.items()}
    if any(isinstance(kind, str) for kind in kinds.values()):
        return flatten(model, parameters)
    for own, graph, writing in known.slotted:
        row = writing.row(given) if own == kinds else None
        if row is not None:
            try:
                return _with(graph, writing, row)
            except ArithmeticError:
                return flatten(model, parameters)
    slots = Slots()
    graph = flatten(model, parameters, slots)
    if warn_of_values(graph) or _has_blocks(graph):
        return flatten(model, parameters)
    writing = Writing(slots)
    known.slotted = [*known.slotted[1 - MOST :], (kinds, graph, writing)]
    return _with(graph, writing, [p.start for p in writing.parameters])


def _with(graph: FlatGraph, writing: Writing, row: list[float]) -> FlatGraph:
    """Return a graph with numbers in its slots."""
    written = Written(graph, writing, row)
    read, parametric, condition = graph.read, graph.parametric, graph.condition
    assert read is not None and parametric is not None and condition is not None
    found: FlatGraph = written.put(graph, stays=True)
    return replace(
        found,
        written=written,
        read=lambda text: written.put(read(text)),
        parametric=lambda k: written.put(parametric(k)),
        condition=lambda text: written.put(condition(text)),
    )


def kind_of(value: Value) -> tuple[Kind, float]:
    """Return what kind of value a parameter is set to, and the number, SI.

    Examples
    --------
    >>> kind_of(2), kind_of("2*m")
    ((None, 2.0), ('2*m', nan))
    >>> str(kind_of("5 mm")[0]), kind_of("5 mm")[1]
    ('m', 0.005)
    """
    if isinstance(value, float | int) and not isinstance(value, bool):
        return None, float(value)
    quantity = try_quantity(value) if isinstance(value, str) else None
    if quantity is None:
        return str(value), np.nan
    return quantity.dimension, quantity.value


def _content(value: Any) -> Any:
    """Return all that a model consists of, to be compared with what it was."""
    if isinstance(value, Model):
        own = vars(value).items()
        return tuple((name, _content(part)) for name, part in own if name not in (OWN, "origin"))
    if isinstance(value, Mapping):
        return dict, tuple((name, _content(part)) for name, part in value.items())
    if isinstance(value, list | tuple):
        return type(value), tuple(map(_content, value))
    if is_dataclass(value) and not isinstance(value, type):
        parts = tuple(_content(getattr(value, f.name)) for f in fields(value))
        return type(value), parts
    if isinstance(value, np.ndarray):
        return value.shape, value.dtype.str, value.tobytes()
    return type(value), value
