"""A model with its arrays written out: each member an element of its own, each bond one bond."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from hybond.errors import HybondError
from hybond.model.array_places import Place, places_of
from hybond.model.arrays import each, is_array, switching
from hybond.model.builder import Model
from hybond.model.expressions import names, parse
from hybond.model.hierarchy import bonds_in, parameters_of, width_of
from hybond.model.parts import Part, SubmodelPart
from hybond.model.scope import Scope, constant
from hybond.units import DIMENSIONLESS, format_quantity, try_quantity


def written_out(model: Model, *, layout: Mapping[str, Place] | None = None) -> Model:
    """Return a model without arrays to look at: values that follow from the index are rounded.

    The same model comes back if it has no arrays and its own layout is wanted.

    Parameters
    ----------
    layout : mapping of name to (x, y)
        In place of its own.

    Raises
    ------
    ModelError
        As `flatten` for arrays and ranges that have no meaning.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add({"c[1..2]": hb.C("(i) [mF]"), "v[1..2]": hb.Zero()})
    >>> m.bond("v[1..2] -> c[1..2]")
    >>> out = written_out(m)
    >>> out.elements["c[2]"].value, out.bonds
    ('2 mF', ['v[1] -> c[1]', 'v[2] -> c[2]'])
    """
    if layout is not None:
        model = copy.copy(model)
        model.layout = dict(layout)
    indexed = any("[" in text for text in model.bonds) or any("[" in key for key in model.layout)
    if not indexed and not any(map(is_array, (*model.elements, *model.machines))):
        return model
    scope = Scope("", model, parameters_of(model, "", {}, {}, None))
    arrays: dict[str, list[int]] = {}
    new = copy.copy(model)
    new.elements = {
        name: _said(part, own)
        for name, part, own in each(model.elements, scope, "elements", arrays)
    }
    new.machines = {
        name: switching(machine, own, f"machines.{name}")
        for name, machine, own in each(model.machines, scope, "machines", arrays)
    }
    new.bonds = []
    for k, text in enumerate(model.bonds):
        label, arrows = bonds_in(text, scope, f"graph.bonds[{k}]")
        front = f"{label}: " if label else ""
        new.bonds += [f"{front}{a} -> {b}" for bonds in arrows for a, b in bonds]
    new.layout = places_of(model.layout, scope, lambda name: width_of(model, name, model.models))
    return new


def _said(part: Any, scope: Scope) -> Any:
    if not scope.index:
        return part
    if isinstance(part, SubmodelPart):
        return replace(part, parameters={k: _value(v, scope) for k, v in part.parameters.items()})
    return replace(part, value=_value(part.value, scope)) if isinstance(part, Part) else part


def _value(value: Any, scope: Scope) -> Any:
    """Return a value that follows from the index as the quantity it is for this member."""
    if not isinstance(value, str) or try_quantity(value) is not None:
        return value
    try:
        if scope.index not in names(parse(value)):
            return value
        number = constant(value, scope.parameters, "")
    except HybondError:
        return value  # it reads signals
    return format_quantity(float(number.value), number.dimension or DIMENSIONLESS)
