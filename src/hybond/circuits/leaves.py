"""What each branch of a circuit is in a bond graph: an element, a source, a controlled junction."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from hybond.circuits.coils import Winding
from hybond.circuits.ideal import IdealSwitch, ideal_diode, ideal_switch
from hybond.circuits.notices import Notices
from hybond.circuits.numerals import quantity
from hybond.circuits.opened import Branch, Opened, Value
from hybond.circuits.resistive import resistive
from hybond.circuits.texts import Texts
from hybond.circuits.waves import Clock, Drive, drive_of
from hybond.model.expressions import Expr, Neg, Number

Role = Literal["R", "C", "I", "Se", "Sf", "meter", "diode", "switch", "winding"]

_PLAIN: Mapping[str, tuple[Role, str]] = {
    "r": ("R", "ohm"),
    "c": ("C", "F"),
    "l": ("I", "H"),
}

RAMP = "(if time < 20 us then time/(20 us) else 1)"
"""What sources are multiplied with after ``startup``."""
_FEMTO = re.compile(r"[0-9.]+f", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Leaf:
    """A branch with its meaning."""

    branch: Branch
    role: Role
    """The kind of element; ``"meter"`` is a source of 0 V, whose current can be read."""
    text: str | float | None = None
    """What the element says; None if it follows from a controlling voltage or current."""
    drive: Drive | None = None
    """Of an independent source."""
    start: Value | None = None
    """Voltage of a C, current of an I, from node a to node b."""
    resistance: str | float | None = None
    """In series with a diode or switch."""
    emission: float = 0.0
    """N Vt of a diode that is taken as the tangent of its curve, V."""
    drop: float = 0.0
    """In series with a diode, V."""
    switch: IdealSwitch | None = None
    winding: Winding | None = None
    beside: str = ""
    """Of a part of another branch, between the same nodes: its key."""
    backward: bool = False
    """Whether its nodes are those of that branch, or of its card, the other way round."""
    formula: Expr | None = None
    """Of an R whose law is computed: what it gives, of its own voltage or current."""


def leaves_of(
    opened: Opened,
    windings: Mapping[str, Winding],
    texts: Texts,
    clock: Clock,
    notices: Notices,
    *,
    current: Mapping[str, float],
) -> list[Leaf]:
    """Return the branches with their meaning.

    Parameters
    ----------
    current : mapping
        Where a diode is taken as a tangent, A, by its key; an empty one is that of all others.

    Raises
    ------
    FileError
        HB-F130, HB-F136, HB-F140.
    """
    found: list[Leaf] = []
    for branch in opened.branches:
        kind = branch.kind
        if branch.key in windings:
            if kind == "l":
                _positive(branch)
            found.append(Leaf(branch, "winding", start=branch.start, winding=windings[branch.key]))
        elif branch.law is not None:
            own = resistive(branch.law, branch.a, branch.b, branch.key)
            role: Role = "Se" if branch.law.imposes == "v" else "Sf"
            found.append(Leaf(branch, "R" if own is not None else role, formula=own))
        elif kind in _PLAIN:
            found += _plain(branch, texts, notices)
        elif kind in "vi":
            drive = drive_of(branch, texts, clock)
            if clock.startup and not drive.zero:
                drive = replace(drive, initial=0.0, constant=False, ramp=RAMP)
            role = "Sf" if kind == "i" else "meter" if drive.zero else "Se"
            text = f"{RAMP}*({drive.text})" if drive.ramp and drive.input is None else drive.text
            found.append(Leaf(branch, role, text, drive))
        elif kind in "eh":
            found.append(Leaf(branch, "Se"))
        elif kind in "gf":
            found.append(Leaf(branch, "Sf"))
        elif kind == "d":
            found += _diode(branch, notices, current)
        else:
            found += _switch(branch, texts, notices)
    return found


def _positive(branch: Branch) -> None:
    assert branch.value is not None
    if branch.value.number <= 0.0:
        what = {"c": "capacitance", "l": "inductance"}[branch.kind]
        raise branch.line.refuse(
            f"a {what} of {branch.value.number:g} stores no energy",
            code="HB-F140",
            hint="give a positive value, or take the element out",
        )


def _plain(branch: Branch, texts: Texts, notices: Notices) -> list[Leaf]:
    assert branch.value is not None
    role, unit = _PLAIN[branch.kind]
    if role == "R" and branch.value.number == 0.0 and not branch.value.parametric:
        notices.add(branch.line, f"{branch.name} has no resistance: a connection")
        return [Leaf(branch, "meter", "0 V", Drive("0 V", None, 0.0, True))]
    if role != "R":
        _positive(branch)
    text = branch.line.text.split()
    if role == "C" and len(text) > 3 and _FEMTO.fullmatch(text[3]):
        notices.add(branch.line, f"{branch.name}: F is femto, so this is {text[3][:-1]}e-15 F")
    return [Leaf(branch, role, texts.value(branch.value, unit), start=branch.start)]


def _diode(branch: Branch, notices: Notices, current: Mapping[str, float]) -> list[Leaf]:
    back_name = f"{branch.name}_back"
    ahead = current.get(branch.key, current[""])
    ideal = ideal_diode(branch, ahead, current.get(back_name.lower(), current[""]), notices)
    resistance = _without(ideal.resistance, ideal.beside)
    text = quantity(resistance, "ohm") if resistance else None
    found = [Leaf(branch, "diode", resistance=text, drop=ideal.drop, emission=ideal.emission)]
    back = ideal.breakdown
    if back is not None:
        other = replace(branch, name=back_name, a=branch.b, b=branch.a)
        text = quantity(back.resistance, "ohm") if back.resistance else None
        found.append(
            Leaf(
                other,
                "diode",
                resistance=text,
                drop=back.drop,
                emission=back.emission,
                beside=branch.key,
                backward=True,
            )
        )
    return found + _beside(branch, ideal.beside)


def _switch(branch: Branch, texts: Texts, notices: Notices) -> list[Leaf]:
    ideal = ideal_switch(branch, notices)
    text: str | float | None = None
    if ideal.resistance is not None:
        text = texts.value(ideal.resistance, "ohm")
        if math.isfinite(ideal.beside):
            text = quantity(_without(ideal.resistance.number, ideal.beside), "ohm")
    rectifies = _rectifies(branch, ideal, notices)
    if not rectifies:
        found = [Leaf(branch, "switch", resistance=text, switch=ideal)]
    elif rectifies > 0:
        found = [Leaf(branch, "diode", resistance=text)]
    else:
        other = replace(branch, a=branch.b, b=branch.a)
        found = [Leaf(other, "diode", resistance=text, backward=True)]
    return found + _beside(branch, ideal.beside)


def _rectifies(branch: Branch, ideal: IdealSwitch, notices: Notices) -> int:
    """Return the way in which a switch that follows its own voltage conducts, as an ideal diode.

    Closed while the voltage along it is above zero, open while it is below: these are the two
    branches of a diode with RON in series, and a law settles many of them at once. Zero for any
    other switch.
    """
    if branch.senses == (branch.a, branch.b):
        way = 1
    elif branch.senses == (branch.b, branch.a):
        way = -1
    else:
        return 0
    if ideal.inverted or ideal.on or ideal.off or ideal.threshold.parametric:
        return 0
    notices.add(branch.line, f"{branch.name} follows its own voltage: taken as an ideal diode")
    return way


def _without(resistance: float, beside: float) -> float:
    """Return what, with `beside` in parallel, makes `resistance`."""
    return resistance if math.isinf(beside) else 1.0 / (1.0 / resistance - 1.0 / beside)


def _beside(branch: Branch, resistance: float) -> list[Leaf]:
    if math.isinf(resistance):
        return []
    value = Value(Number(resistance), resistance)
    name = f"{branch.name}_off"
    part = replace(branch, name=name, kind="r", value=value)
    return [Leaf(part, "R", quantity(resistance, "ohm"), beside=branch.key)]


def negated(value: Value) -> Value:
    """Return minus a value."""
    if isinstance(value.formula, Number):
        return Value(Number(-value.number), -value.number)
    return Value(Neg(value.formula), -value.number)
