"""Which side of its only threshold a switch is on while what it follows rests there."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.circuits.ideal import IdealSwitch
from hybond.circuits.leaves import Leaf
from hybond.circuits.opened import Branch


def compared(branch: Branch, ideal: IdealSwitch, leaves: Sequence[Leaf]) -> tuple[str, str]:
    """Return the comparisons by which a switch goes above its thresholds and below them.

    Two thresholds keep it as it was at either of them. One threshold has no third side: what comes
    back to it, as a gate of 0 V and 5 V to the default of 0 V, has left the side above, and what
    comes up to it as its highest level has left the side below.
    """
    if ideal.on != ideal.off:
        return ">", "<"
    levels = _levels(branch, leaves)
    return (">=", "<") if levels and max(levels) == ideal.on else (">", "<=")


def rests_at(branch: Branch, ideal: IdealSwitch, leaves: Sequence[Leaf]) -> bool:
    """Whether the source that a switch follows has its only threshold as one of its levels."""
    return ideal.on == ideal.off and ideal.on in _levels(branch, leaves)


def _levels(branch: Branch, leaves: Sequence[Leaf]) -> tuple[float, ...]:
    """Return the levels of the source between the controlling nodes, none if it is no such one."""
    for leaf in leaves:
        source = leaf.branch
        ends = (source.a, source.b)
        if source.kind != "v" or leaf.beside or branch.kind == "w" or len(branch.senses) != 2:
            continue
        if branch.senses not in (ends, ends[::-1]):
            continue
        name, given = source.wave or ("", ())
        values = given[:2] if name == "pulse" else given[1::2] if name == "pwl" else ()
        sign = 1.0 if branch.senses == ends else -1.0
        return tuple(sign * value.number for value in values)
    return ()
