"""A motion that stands before a jump of a law, and is driven back from behind it.

Steps there become too small to see the kink from both sides, or so small that they all end at one.
So rates are compared along a straight line through the kink: they lead to it from either side.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import largest_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.guards.guard_values import show
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, Locator
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.mode.reading import reads_plainly, show_plain
from hybond.engine.run.run_records import Run
from hybond.engine.surfaces.averages import solve_read_here
from hybond.engine.surfaces.values import field, set_motion

JUMPS: Final = 0.75
"""A jump is as large from a quarter of a way; what is bent is a half or less, like a root."""
SEEN: Final = 1e-9
"""Part of the rates below which a change of them is no jump."""
NEAR: Final = 1e-8
"""Part of the run within which a kink that holds the motion is reached,"""
STEPS: Final = 4.0
"""or so many of the steps that are being made: errors that they may make keep it away."""
WIDE: Final = 64.0
"""Instants on either side of it at which rates are compared, at the least."""
HALVINGS: Final = 60
DUST: Final = 1e-14
"""Part of the largest effort or flow that is rounding, where a rate is the sum of some."""


def is_held(e: Engine, r: Run) -> bool:
    """Whether a jump at a kink next to the present state holds the motion, into `r.kink`.

    The state whose rate jumps there is `r.jumping`.
    """
    g = r.locator
    refusal = e.refusal
    held = False
    if field(e, e.mode, e.t, e.y, r.rate) == OK:
        for k in range(g.guards):
            if not held and g.side[k] != NO_KINK and g.timed[k] == 0 and not is_met(e, g, k):
                held = holds_motion(e, r, k)
    g.looked = math.nan
    e.refusal = refusal
    return held


def is_met(e: Engine, g: Locator, k: int) -> bool:
    """Whether the kink of guard k is a root that has one value from both sides.

    It is so steep there that as near as one can see it looks like a jump.
    """
    return e.model.kink_meets[g.atom[g.atom_first[k]] - e.model.kink_atom] != 0


def holds_motion(e: Engine, r: Run, k: int) -> bool:
    """Whether the kink of guard k does; the rates at the present state are in `r.rate`."""
    g = r.locator
    if not math.isfinite(along(e, r, k, 0.0)):
        return False
    far = room_of_instant(e, e.t)
    passed = way_through(e, r, k, far)
    most = max(NEAR * e.until, STEPS * (e.step.t1 - e.step.t0))
    while not passed and far < most:
        far *= 4.0
        passed = way_through(e, r, k, far)
    if not passed:
        return False
    at = r.crossing
    least = WIDE * room_of_instant(e, e.t)
    wide = max(far, least)
    # a line that another law follows as far as that is none from nearer by
    if not jumps_within(e, r, k, at, wide):
        return False
    if wide > least and not jumps_within(e, r, k, at, least):
        return False
    r.kink = g.atom[g.atom_first[k]] - e.model.kink_atom
    return True


def jumps_within(e: Engine, r: Run, k: int, at: float, wide: float) -> bool:
    """Whether a rate jumps at the crossing and leads back to it, seen from that way on either side.

    The state whose rate jumps most is `r.jumping`, -1 if none does.
    """
    r.jumping = -1
    if not rates_beside(e, r, at, wide) or not both_lead_to(e, r, k, at, 0.25 * wide):
        return False
    most = 0.0
    tolerance(e, e.y, e.y, r.after)
    for i in range(e.states):
        apart = math.fabs(r.beside[i] - r.beside[e.states + i])
        near = math.fabs(r.beside[2 * e.states + i] - r.beside[3 * e.states + i])
        size = math.fabs(r.beside[2 * e.states + i]) + math.fabs(r.beside[3 * e.states + i])
        # what moves a state by less than its error in the whole run is rounding
        real = near * e.span > r.after[i]
        real = real and near > dust_of_rate(e, i)
        if real and near > JUMPS * apart and near > SEEN * size and near > most:
            most = near
            r.jumping = i
    return r.jumping >= 0


def dust_of_rate(e: Engine, i: int) -> float:
    """Return what rounding leaves of a rate where its terms cancel, at the values just found.

    What a controller makes of the difference of where something is and where it should be has, once
    it is there, the steps of its last place.
    """
    m = e.model
    if i >= m.storages:
        own = value(m, m.integral_size[i - m.storages], e.v)
        return DUST * own if math.isfinite(own) else 0.0
    first = m.bond_slot + (m.bonds if m.storage_kind[i] == 0 else 0)
    most = largest_part(m.bonds, e.v, first)
    return DUST * most


def way_through(e: Engine, r: Run, k: int, far: float) -> bool:
    """Whether what is compared changes its sign within `far`; where it does is `r.crossing`."""
    low = -far
    high = far
    before = along(e, r, k, low)
    if not before * along(e, r, k, high) < 0.0:
        return False
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if before * along(e, r, k, middle) > 0.0:
            low = middle
        else:
            high = middle
    r.crossing = 0.5 * (low + high)
    return True


def along(e: Engine, r: Run, k: int, h: float) -> float:
    """Return what guard k compares at the state that the present rates lead to in a time."""
    for i in range(e.states):
        r.locator.y[i] = e.y[i] + h * r.rate[i]
    return compared_by(e, r.locator, k, e.t + h)


def compared_by(e: Engine, g: Locator, k: int, t: float) -> float:
    """Return what the first comparison of guard k compares, at the state in `g.y`."""
    return compared(e, g, e.model.atom_value[g.atom[g.atom_first[k]]], g.part[k], t)


def compared(e: Engine, g: Locator, atom: int, part: int, t: float) -> float:
    """Return a difference that is watched, at the state in `g.y`; nan if it has no value.

    In one of the modes combined, or ALL_PARTS of them.
    """
    if not has_values(e, g, t):
        return math.nan
    show(e, g, part)
    there = value(e.model, atom, e.v)
    show(e, g, ALL_PARTS)
    return there


def has_values(e: Engine, g: Locator, t: float) -> bool:
    """Put what is watched reads there, at the state in `g.y`; whether there is any."""
    show(e, g, ALL_PARTS)
    g.looked = math.nan
    set_motion(e, e.v, t, g.y)
    # what is at rest may be asked for, too
    if e.slide.k == 0 and e.model.rests_apart == 0 and reads_plainly(e.model, e.mode, g.reads):
        show_plain(e, e.mode, g.reads, e.v)
        return True
    return solve_read_here(e, e.mode, g.reads, e.v) == OK


def rates_beside(e: Engine, r: Run, at: float, wide: float) -> bool:
    """Put the rates behind and before the crossing there, at that way and at a quarter of it."""
    g = r.locator
    known = True
    for k in range(4):
        h = at + wide * (1.0 if k % 2 == 0 else -1.0) * (1.0 if k < 2 else 0.25)
        for i in range(e.states):
            g.y[i] = e.y[i] + h * r.rate[i]
        known = known and field(e, e.mode, e.t + h, g.y, r.after) == OK
        for i in range(e.states):
            r.beside[k * e.states + i] = r.after[i]
    return known


def both_lead_to(e: Engine, r: Run, k: int, at: float, near: float) -> bool:
    """Whether rates on either side lead towards the kink, at that way from it."""
    g = r.locator
    both = True
    for side in range(2):
        h = at + (near if side == 0 else -near)
        here = along(e, r, k, h)
        for i in range(e.states):
            g.y[i] = e.y[i] + h * r.rate[i] + near * r.beside[(2 + side) * e.states + i]
        both = both and here * (compared_by(e, g, k, e.t + h + near) - here) < 0.0
    return both
