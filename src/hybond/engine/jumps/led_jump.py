"""The areas of a jump: by Newton's method, and where that leads astray, the way they are pushed.

Far up an exponential, or over the hump of a source that reads what it prescribes, Newton's steps go
beyond all bounds, or lead back: to a solution that nothing goes to. What a mode leaves out between
storages, however small a resistance it is, lets what is missing drive them until nothing is: the
end of a motion in no time, `M nu' = -gap` with the slope `M` that storages make alone. Steps of it
are implicit and become ever longer, until they are Newton's.

Source: C. T. Kelley and D. E. Keyes, *Convergence analysis of pseudo-transient continuation*, SIAM
J. Numer. Anal. 35 (1998).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats
from hybond.engine.constraints.constraints import constraint_by_co_energy
from hybond.engine.constraints.impulse_ways import slope_of
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.jumps.jump_steps import (
    FAR,
    LOCKED,
    find_step,
    furthest,
    gap_at,
    newton_steps,
    put_here,
)
from hybond.engine.jumps.left_over import is_rounding
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.rows.storage import own_stiffness, stiff, with_stored
from hybond.engine.model import Model
from hybond.engine.reasons.facts import refuse_jump
from hybond.engine.words import Floats

FIRST_TIME: Final = 0.1
"""The first step, as a part of the time in which storages alone would answer."""
NEARLY: Final = 1e-6
"""What is missing is nearly nothing below this part of its terms: Newton's steps find the rest."""
LEAST_TIME: Final = 1e-12
"""What is shorter leads nowhere."""
GROWS: Final = 1.5
"""What is missing may grow by this in a step."""
FASTER: Final = 2.0
"""A step may be as many times as long as what is missing drives it at first."""
STEPS: Final = 400
POINTS: Final = 32
"""At which a law is looked at between what is stored before and after."""


def find_areas(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, measured: bool) -> int:
    """Find the areas at which the constraints hold, into `e.work.nu`.

    Where they are `measured`, the residuals at `x` are in `e.work`.
    """
    status = newton_steps(e, mode, v, x, ways, measured, False)
    if status == FAR and is_rounding(e, ways):
        return OK
    if ways.known or ways.sparse or e.work.constraints != ways.areas:
        return OK if status == OK else tell_none(e, mode, status)
    if status == OK and (e.work.missing <= NEARLY or is_driven(e, mode, v, x, ways)):
        return OK
    w = e.work
    areas = ways.areas
    fit(w.nu_found, areas)
    copy_floats(areas, w.nu.at, w.nu_found.at)
    if driven(e, mode, v, x, ways) and newton_steps(e, mode, v, x, ways, False, True) == OK:
        return OK
    if status != OK:
        return tell_none(e, mode, status)
    # nothing else was found
    copy_floats(areas, w.nu_found.at, w.nu.at)
    gap_at(e, mode, v, x, ways, 0.0)
    return OK


def tell_none(e: Engine, mode: Mode, status: int) -> int:
    """Refuse a jump for which nothing was found."""
    if status == LOCKED:
        why = "no redistribution of what is stored meets the constraints of this mode"
        if e.model.tells != 0:
            return refuse_jump(e, mode, "HB-N303", why)
        return say_fault(e, "HB-N303", why, "")
    if e.model.tells != 0:
        return refuse_jump(e, mode, "HB-N304", "the jump into this mode does not converge")
    return say_fault(e, "HB-N304", "the jump into this mode does not converge", "")


def is_driven(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> bool:
    """Whether the areas found are such as what is missing drives at first.

    On the way a law that falls may have been another solution, which has been passed over.
    """
    w = e.work
    areas = ways.areas
    if falls_between(e, x, ways):
        return False
    fit(w.nu_found, areas)
    fit(w.nu_led, areas)
    none = True
    for a in range(areas):
        w.nu_found.at[a] = w.nu.at[a]
        none = none and w.nu.at[a] == 0.0
        w.nu.at[a] = 0.0
    if none:
        return True
    gap_at(e, mode, v, x, ways, 0.0)
    slope_of_storages(e, mode, x, ways, ways.slope.at)
    rank = find_step(e, ways, w.constraints)
    forth = -energy_of_both(e, x, ways, w.nu_found.at, w.step.at)
    copy_floats(areas, w.nu_found.at, w.nu.at)
    put_here(e.model.storages, x, ways, w.nu.at, w.here)
    slope_of(e, mode, v, w.here, ways)
    gap_at(e, mode, v, x, ways, 0.0)
    return rank < areas or not forth < 0.0


def falls_between(e: Engine, x: Floats, ways: Ways) -> bool:
    """Whether a law of storage falls between no areas and those found."""
    m = e.model
    w = e.work
    bends = False
    for k in range(m.storages):
        bends = bends or m.co_energy[k] >= 0
    if not bends:
        return False
    fit(w.nu_led, ways.areas)
    for part in range(POINTS + 1):
        for a in range(ways.areas):
            w.nu_led.at[a] = w.nu.at[a] * float(part) / float(POINTS)
        put_here(m.storages, x, ways, w.nu_led.at, w.here)
        values = with_stored(e, w.here)
        for k in range(m.storages):
            if m.co_energy[k] >= 0 and w.here[k] != x[k] and own_stiffness(m, k, values) < 0.0:
                return True
    return False


def rising(m: Model, k: int, p: int, v: Floats) -> float:
    """Return entry p of the stiffness, of storage k, as if its law were rising.

    A resistance drives what is stored on to where it is missing also where its law falls.
    """
    own = m.stiff_other[p] == k
    return math.fabs(stiff(m, p, v)) if own else stiff(m, p, v)


def energy_of_both(e: Engine, x: Floats, ways: Ways, one: Floats, other: Floats) -> float:
    """Return the product of two sets of areas: the energy of what one stores with the other."""
    m = e.model
    areas = ways.areas
    values = with_stored(e, x)
    total = 0.0
    for k in range(m.storages):
        level = 0.0
        for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
            moved = 0.0
            for a in range(areas):
                moved += ways.d.at[m.stiff_other[p] * areas + a] * one[a]
            if moved != 0.0:
                level += rising(m, k, p, values) * moved
        moved = 0.0
        for a in range(areas):
            moved += ways.d.at[k * areas + a] * other[a]
        total += level * moved
    return total


def driven(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> bool:
    """Let what is missing drive the areas, from none on, until it is nearly nothing."""
    w = e.work
    count = w.constraints
    areas = ways.areas
    fit(w.nu_led, areas)
    fit(w.pushed, areas)
    fit(w.slope_alone, count * areas)
    for a in range(areas):
        w.nu.at[a] = 0.0
    gap_at(e, mode, v, x, ways, 0.0)
    missing = furthest(e, e.work.gap_first.at)
    time = FIRST_TIME
    for _ in range(STEPS):
        if missing <= NEARLY:
            return True
        if not missing < math.inf:
            return False
        put_here(e.model.storages, x, ways, w.nu.at, w.here)
        slope_of(e, mode, v, w.here, ways)
        slope_of_storages(e, mode, w.here, ways, w.slope_alone.at)
        gap_at(e, mode, v, x, ways, 0.0)
        for i in range(count * areas):
            slope = ways.slope.at[i]
            ways.slope.at[i] = w.slope_alone.at[i]
            w.slope_alone.at[i] = slope + w.slope_alone.at[i] / time
        find_step(e, ways, count)
        for a in range(areas):
            w.pushed.at[a] = time * w.step.at[a]
            w.nu_led.at[a] = w.nu.at[a]
        copy_floats(count * areas, w.slope_alone.at, ways.slope.at)
        find_step(e, ways, count)
        for a in range(areas):
            w.nu.at[a] -= w.step.at[a]
        # where a source gives way, a step that is too long leads back
        forth = energy_of_both(e, w.here, ways, w.step.at, w.pushed.at)
        most = energy_of_both(e, w.here, ways, w.pushed.at, w.pushed.at)
        gap_at(e, mode, v, x, ways, 0.0)
        left = furthest(e, e.work.gap_first.at)
        if left <= GROWS * missing and forth > 0.0 and forth <= FASTER * most:
            missing = left
            time *= 2.0
            continue
        copy_floats(areas, w.nu_led.at, w.nu.at)
        # steps that went too far leave nothing of what is measured there
        gap_at(e, mode, v, x, ways, 0.0)
        time *= 0.25
        if time < LEAST_TIME:
            return False
    return False


def slope_of_storages(e: Engine, mode: Mode, x: Floats, ways: Ways, slope: Floats) -> None:
    """Put the derivative of the residuals by the areas there that storages make alone."""
    m = e.model
    w = e.work
    areas = ways.areas
    values = with_stored(e, x)
    fit(w.by_stored, m.storages)
    for i in range(w.constraints):
        constraint_by_co_energy(e, mode, i, 2 * m.bonds)
        for a in range(areas):
            total = 0.0
            for k in range(m.storages):
                factor = w.by_stored.at[k]
                for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
                    if factor != 0.0:
                        way = ways.d.at[m.stiff_other[p] * areas + a]
                        total += factor * rising(m, k, p, values) * way
            slope[i * areas + a] = total
