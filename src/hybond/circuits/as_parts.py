"""A netlist as a circuit diagram has it: a part for each card, a junction for each node.

It is there to be drawn: what parts are worth stands beside them, as far as it is short.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from hybond.circuits.graph_names import GraphNames
from hybond.circuits.numerals import short
from hybond.circuits.opened import GROUND, Branch, Opened
from hybond.circuits.texts import Texts
from hybond.library import part
from hybond.model.builder import Model
from hybond.model.constructors import Zero
from hybond.model.parts import SubmodelPart
from hybond.model.symbol import CORE

PARTS: Final[Mapping[str, tuple[str, str]]] = {
    "r": ("resistor", "ohm"),
    "c": ("capacitor", "F"),
    "l": ("inductor", "H"),
    "v": ("voltage_source", "V"),
    "i": ("current_source", "A"),
    "d": ("diode", ""),
    "s": ("switch", ""),
    "w": ("switch", ""),
    "a": ("switch", ""),
    "e": ("voltage_source", ""),
    "h": ("voltage_source", "ohm"),
    "g": ("current_source", "A/V"),
    "f": ("current_source", ""),
}
"""Of each letter of a card: the part that it is drawn as, and the unit of its value."""
DOT: Final = (1.25, -0.45, 0.14)
"""Of the dot of a winding: its distance from the middle, its height, its radius."""
_ROUND: Final = tuple(
    (math.cos(2.0 * math.pi * k / 12), math.sin(2.0 * math.pi * k / 12)) for k in range(12)
)
_LAWS: Final[Mapping[str, str]] = {"v": "voltage_source", "i": "current_source"}


def as_parts(opened: Opened, texts: Texts, title: str) -> Model:
    """Return a model of parts of the library, to be drawn as a schematic and not to be run.

    Parameters
    ----------
    opened : Opened
        The netlist with its subcircuits opened; what is in one has its name before its own.
    """
    names = GraphNames()
    model = Model(names.take("schematic"), title=title, domain="electrical")
    model.only_drawn = True
    keys = dict.fromkeys(key for b in opened.branches for key in (b.a, b.b))
    # parts keep their names; of a node that is called like one the name gets a number
    own = {id(b): names.take(b.name) for b in opened.branches}
    node = {key: names.take("earth" if key == GROUND else opened.nodes[key], "n") for key in keys}
    coupled: dict[str, list[str]] = {}
    for coupling in opened.couplings:
        for key in coupling.coils:
            coupled.setdefault(key, []).append(coupling.name)
    way = _ways(opened)
    model.add({name: Zero() for name in node.values()})
    for branch in opened.branches:
        name = own[id(branch)]
        beside = {
            "value": _said(branch, opened, texts),
            CORE: " ".join(coupled.get(branch.key, ())),
        }
        values: dict[str, str | float] = {key: text for key, text in beside.items() if text}
        kind = f"electrical.{_LAWS[branch.law.imposes] if branch.law else PARTS[branch.kind][0]}"
        if branch.key in way:
            kind = "winding" if way[branch.key] > 0 else "winding_reversed"
            model.models.setdefault(kind, _winding(way[branch.key]))
        model.add({name: SubmodelPart(kind, values, {})})
        model.bond(f"{node[branch.a]} -> {name}.plus", f"{name}.minus -> {node[branch.b]}")
    if GROUND in node:
        ground = names.take("ground")
        model.add({ground: SubmodelPart("electrical.ground", {}, {})})
        model.bond(f"{node[GROUND]} -> {ground}.pin")
    return model


def _ways(opened: Opened) -> dict[str, int]:
    """Return of each coupled coil whether its dot is at its first node, 1, or at its second, -1.

    A coupling below zero turns the coils that come after it.
    """
    way: dict[str, int] = {}
    for coupling in opened.couplings:
        sign = -1 if coupling.value.number < 0.0 else 1
        first, *others = coupling.coils
        own = way.setdefault(first, 1)
        for key in others:
            way.setdefault(key, own * sign)
    return way


def _winding(way: int) -> Model:
    """Return the inductor of the library with the dot of a winding at one of its ends."""
    plain = part("electrical.inductor")
    assert plain.symbol is not None
    found = Model("winding", domain="electrical")
    found.elements, found.bonds = dict(plain.elements), list(plain.bonds)
    found.ports, found.parameters = dict(plain.ports), dict(plain.parameters)
    x, y, radius = DOT
    corners = [(radius * u - way * x, radius * v + y) for u, v in _ROUND]
    outline = " ".join(f"{u:.3f},{v:.3f}" for u, v in [*corners, corners[0]])
    found.symbol = replace(plain.symbol, fills=(*plain.symbol.fills, outline))
    return found


def _said(branch: Branch, opened: Opened, texts: Texts) -> str:
    """Return what stands beside a part."""
    senses = ",".join(opened.nodes.get(key, key) for key in branch.senses)
    if branch.law is not None:
        return branch.line.text.partition("=")[2].strip() or "computed"
    if branch.kind in "adsw":
        model = branch.model.name if branch.model is not None else ""
        return model if branch.kind == "d" else f"{model} {_control(branch, senses)}".strip()
    if branch.wave is not None:
        return branch.wave[0].lower()
    if branch.value is None:
        return ""
    value = texts.value(branch.value, PARTS[branch.kind][1])
    text = short(value) if isinstance(value, float) else value
    return f"{text}*{_control(branch, senses)}" if senses else text


def _control(branch: Branch, senses: str) -> str:
    return f"i({senses})" if branch.kind in "fhw" else f"v({senses})"
