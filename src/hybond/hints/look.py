"""`hints_of`: all hints of a model, each with the line that says it."""

from __future__ import annotations

from collections.abc import Iterator

from hybond.errors import HybondError
from hybond.hints.graphs import graph_hints
from hybond.hints.machines import machine_hints
from hybond.hints.ports import port_hints
from hybond.hints.uses import unused_hints
from hybond.model.builder import Model
from hybond.model.checked import Checked, Hint
from hybond.model.graph import FlatGraph
from hybond.model.located import locate


def checked(model: Model) -> Checked:
    """Return what a check of a model says; a model without meaning is no exception here.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("half", domain="electrical")
    >>> m.add(r=hb.R("1 ohm"))
    >>> checked(m).error.code
    'HB-M130'
    """
    title = model.title or model.name
    try:
        graph = model.flatten()
    except HybondError as error:
        return Checked(title, error, ())
    return Checked(title, None, hints_of(model, graph))


def hints_of(model: Model, graph: FlatGraph) -> tuple[Hint, ...]:
    """Return the hints of a model and of its flat graph, in the order of the file."""
    found = [_placed(hint, model) for hint in _all(model, graph)]
    return tuple(sorted(found, key=lambda h: (h.line is None, h.file, h.line or 0)))


def _all(model: Model, graph: FlatGraph) -> Iterator[Hint]:
    yield from graph_hints(model, graph)
    yield from port_hints(model, graph)
    yield from machine_hints(model, graph)
    yield from unused_hints(model)


def _placed(hint: Hint, model: Model) -> Hint:
    said = locate(HybondError(hint.why, code=hint.code, where=hint.where), model)
    return Hint(hint.code, hint.where, hint.why, hint.remedy, said.file, said.line, said.written)
