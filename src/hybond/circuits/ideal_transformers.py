"""Ideal transformers written as two controlled sources, as SPICE has no other.

    E1 s x p q n      the secondary voltage is n times that of the primary
    V1 x 0 0          measures the secondary current
    F1 p q V1 n       the primary takes n times that current

What one source gives the other takes. As one transformer the two conserve power in jumps, too, and
currents that one diode interrupts are those that the other feels.
"""

from __future__ import annotations

from collections import Counter

from hybond.circuits.coils import Magnetics, Winding
from hybond.circuits.opened import GROUND, Branch, Opened
from hybond.circuits.texts import Texts

SAME = 1e-12
"""Part by which the two gains may differ."""


def ideal_transformers(opened: Opened, texts: Texts) -> dict[str, Winding]:
    """Return the sources that are windings of ideal transformers, by key."""
    branches = {b.key: b for b in opened.branches}
    ends = Counter(node for b in opened.branches for node in (b.a, b.b))
    at: dict[str, list[Branch]] = {}
    for branch in opened.branches:
        for node in {branch.a, branch.b}:
            at.setdefault(node, []).append(branch)
    found: dict[str, Winding] = {}
    for source in opened.branches:
        if source.kind != "f" or source.law is not None or len(source.senses) != 1:
            continue
        meter = branches.get(source.senses[0])
        if meter is None or not _measures(meter):
            continue
        for node in {meter.a, meter.b} - {GROUND}:
            beside = [b for b in at[node] if b is not meter]
            if ends[node] != 2 or len(beside) != 1 or beside[0].key in found:
                continue
            ratio = _ratio(source, meter, beside[0], node, texts)
            if ratio is not None:
                core = _core(source, beside[0], ratio)
                found[source.key] = Winding(core, 0)
                found[beside[0].key] = Winding(core, 1)
                break
    return found


def _measures(branch: Branch) -> bool:
    value = branch.value
    zero = value is None or (value.number == 0.0 and not value.parametric)
    return branch.kind == "v" and branch.law is None and branch.wave is None and zero


Ratio = tuple[str | float, str | float, float]
"""Turns of the second winding by those of the first, the inverse, and the first as a number."""


def _ratio(source: Branch, meter: Branch, other: Branch, node: str, texts: Texts) -> Ratio | None:
    """Return the ratio of the transformer that a source of current and one of voltage are."""
    if other.kind != "e" or other.law is not None or len(other.senses) != 2:
        return None
    there, back = (source.a, source.b), (source.b, source.a)
    if other.senses not in (there, back) or source.value is None or other.value is None:
        return None
    turn = 1.0 if other.senses == there else -1.0
    # the current of the meter is that of the source of voltage, or the opposite
    way = 1.0 if (node == other.b) == (node == meter.a) else -1.0
    gain, taken = other.value, source.value
    if gain.number == 0.0 or abs(turn * way * taken.number + gain.number) > SAME * abs(gain.number):
        return None
    if (gain.parametric or taken.parametric) and gain.formula != taken.formula:
        return None
    ratio = turn * gain.number
    if not gain.parametric:
        return ratio, 1.0 / ratio, ratio
    minus = "-" if turn < 0.0 else ""
    factor = texts.factor(gain, "")
    return f"{minus}{factor}", f"{minus}1/{factor}", ratio


def _core(source: Branch, other: Branch, ratio: Ratio) -> Magnetics:
    ahead, back, number = ratio
    return Magnetics(
        f"u_{source.name}",
        source.line,
        (source.key, other.key),
        None,
        None,
        ((1.0, 1.0), (ahead, back)),
        (1.0, number),
        (),
    )
