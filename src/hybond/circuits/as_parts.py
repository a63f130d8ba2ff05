"""A netlist as a circuit diagram has it: a part for each card, a junction for each node.

It is there to be drawn: what parts are worth stands beside them, as far as it is short.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from hybond.circuits.graph_names import GraphNames
from hybond.circuits.numerals import short
from hybond.circuits.opened import GROUND, Branch, Opened
from hybond.circuits.texts import Texts
from hybond.model.builder import Model
from hybond.model.constructors import Zero
from hybond.model.parts import SubmodelPart

PARTS: Final[Mapping[str, tuple[str, str]]] = {
    "r": ("resistor", "ohm"),
    "c": ("capacitor", "F"),
    "l": ("inductor", "H"),
    "v": ("voltage_source", "V"),
    "i": ("current_source", "A"),
    "d": ("diode", ""),
    "s": ("switch", ""),
    "w": ("switch", ""),
    "e": ("voltage_source", ""),
    "h": ("voltage_source", "ohm"),
    "g": ("current_source", "A/V"),
    "f": ("current_source", ""),
}
"""Of each letter of a card: the part that it is drawn as, and the unit of its value."""
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
    keys = dict.fromkeys(key for b in opened.branches for key in (b.a, b.b))
    # parts keep their names; of a node that is called like one the name gets a number
    own = {id(b): names.take(b.name) for b in opened.branches}
    node = {key: names.take("earth" if key == GROUND else opened.nodes[key], "n") for key in keys}
    coupled = {key: k.name for k in opened.couplings for key in k.coils}
    model.add({name: Zero() for name in node.values()})
    for branch in opened.branches:
        name = own[id(branch)]
        said = [text for text in (_said(branch, opened, texts), coupled.get(branch.key)) if text]
        values: dict[str, str | float] = {f"value_{k}": text for k, text in enumerate(said)}
        part = _LAWS[branch.law.imposes] if branch.law else PARTS[branch.kind][0]
        model.add({name: SubmodelPart(f"electrical.{part}", values, {})})
        model.bond(f"{node[branch.a]} -> {name}.plus", f"{name}.minus -> {node[branch.b]}")
    if GROUND in node:
        ground = names.take("ground")
        model.add({ground: SubmodelPart("electrical.ground", {}, {})})
        model.bond(f"{node[GROUND]} -> {ground}.pin")
    return model


def _said(branch: Branch, opened: Opened, texts: Texts) -> str:
    """Return what stands beside a part."""
    senses = ",".join(opened.nodes.get(key, key) for key in branch.senses)
    if branch.law is not None:
        return branch.line.text.partition("=")[2].strip() or "computed"
    if branch.kind in "dsw":
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
