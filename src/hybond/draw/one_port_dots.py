"""A dot where bonds meet at the only port of a part: a layout then lets the part hang there.

Without it the part would stand in the row that its bonds make, and wires would lead around it.
"""

from __future__ import annotations

import copy
import itertools

from hybond.draw.meeting import element_of
from hybond.model.builder import Model
from hybond.model.constructors import One, Zero
from hybond.model.hierarchy import submodel_of
from hybond.model.parts import Part, SubmodelPart

MARK = "\u00b7"
"""Ends the names of such dots: no element has it in its own."""


def with_dots(model: Model) -> tuple[Model, dict[str, str]]:
    """Return a model to be laid out and drawn, and its dots: the port at which each stands.

    The same model comes back where it has a layout of its own, or no such port.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("drain", domain="hydraulic")
    >>> m.add(a=hb.Submodel("hydraulic.pipe"), b=hb.Submodel("hydraulic.pipe"))
    >>> m.add(tank=hb.Submodel("hydraulic.tank"))
    >>> m.bond("a.outlet -> tank.port", "tank.port -> b.inlet")
    >>> drawn, dots = with_dots(m)
    >>> drawn.bonds, dots
    (['a.outlet -> tank·', 'tank· -> b.inlet', 'tank· -> tank.port'], {'tank·': 'tank.port'})
    """
    if model.layout.keys() & model.elements.keys():
        return model, {}
    arrows = [
        (a.strip(), b.strip())
        for text in model.bonds
        for a, b in itertools.pairwise(str(text).rpartition(":")[2].split("->"))
    ]
    dots: dict[str, str] = {}
    for name, part in model.elements.items():
        if not isinstance(part, SubmodelPart):
            continue
        inner = submodel_of(part, name, model.models)
        if len(inner.ports) != 1:
            continue
        port, target = next(iter(inner.ports.items()))
        end = f"{name}.{port}"
        others = [b if a == end else a for a, b in arrows if end in (a, b)]
        shared = inner.elements.get(target)
        kind = shared.kind if isinstance(shared, Part) else ""
        if len(others) > 1 and kind in ("0", "1") and all(_is_part(model, o) for o in others):
            dots[end] = kind
    if not dots:
        return model, {}
    new = copy.copy(model)
    new.elements = dict(model.elements)
    new.bonds = [" -> ".join(_dot(e) if e in dots else e for e in arrow) for arrow in arrows]
    for end, kind in dots.items():
        new.elements[_dot(end)] = Zero() if kind == "0" else One()
        new.bonds.append(f"{_dot(end)} -> {end}")
    return new, {_dot(end): end for end in dots}


def _dot(end: str) -> str:
    return element_of(end) + MARK


def _is_part(model: Model, end: str) -> bool:
    return isinstance(model.elements.get(element_of(end)), SubmodelPart)
