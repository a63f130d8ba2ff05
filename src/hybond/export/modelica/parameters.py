"""Parameters with their units and formulas; constants where values have gone into numbers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hybond.equations.element_parts import parameter_values
from hybond.errors import HybondError
from hybond.export.modelica.draft import Draft
from hybond.export.modelica.expressions import modelica, number
from hybond.export.modelica.identifiers import in_unit, quoted
from hybond.model.expressions import compile_expression, names, parse
from hybond.units import try_quantity

SLACK = 1e-8
"""Part of the terms of a value below which a law takes it for zero. A mode that ties stored
quantities together does so to the tolerance of the integration."""


def parameters(draft: Draft) -> Iterator[str]:
    """Yield the declarations of what the equations have read."""
    graph, model = draft.graph, draft.model
    known = {**parameter_values(graph), **{f"p:{p}": v for p, v in graph.parameters.items()}}
    for path in draft.used:
        name, own = draft.ids.of(path, path[2:]), path[2:]
        value = float(known[path])
        written = model.parameters.get(own, "")
        text, unit, remark = number(value), "", ""
        if isinstance(written, str) and written:
            quantity = try_quantity(written)
            if quantity is not None:
                unit = in_unit(quantity.dimension)
            else:
                text = _formula(draft, written, value) or text
                remark = f" {quoted(written)}" if text == number(value) else ""
        elif own not in model.parameters:
            unit = in_unit(_own_unit(draft, own))
        kind = "parameter"
        if own in draft.live.fixed:
            # its value has gone into numbers: a tool must not offer to change it
            kind, text = "constant", number(value)
            remark = remark or (f" {quoted(str(written))}" if unit == "" and written else "")
        yield f"{kind} Real {name}{unit} = {text}{remark};"
    if any(key.startswith("size:") for key in draft.made):
        yield (
            f"parameter Real {draft.slack} = {number(SLACK)} "
            '"laws: this part of its terms counts as zero";'
        )


def _own_unit(draft: Draft, path: str) -> Any:
    """Return the unit of a number that an element has as its value."""
    element, _, _ = path.rpartition(".")
    part = draft.model.elements.get(element)
    value = getattr(part, "value", None)
    quantity = try_quantity(value) if isinstance(value, str) else None
    return None if quantity is None else quantity.dimension


def _formula(draft: Draft, written: str, value: float) -> str | None:
    """Return a parameter as the formula of others that it is written as."""
    given = draft.graph.parameters
    try:
        e = parse(written)
    except HybondError:
        return None
    read = names(e)
    if not read or any(n not in given for n in read):
        return None
    index = {n: k for k, n in enumerate(sorted(read))}
    at = [float(given[n]) for n in sorted(read)]
    if float(compile_expression(e, index, pre_offset=0)(at)) != value:
        return None
    return modelica(e, lambda n, prior: draft.ids.of(f"p:{n}", n))
