"""The areas of a jump: by Newton's method, and where that leads nowhere, part by part.

Far up an exponential, or over the hump of a source that reads what it prescribes, Newton's steps go
beyond all bounds. Then a part of what is missing is asked for, and with that found a larger one:
the solution that hangs together with no impulse at all. Where that way ends at a fold, one area
alone is looked for on both sides, in steps that grow, until its constraint changes its sign.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.instant.constraints import constraint_by_co_energy
from hybond.engine.instant.impulse_ways import slope_of
from hybond.engine.instant.jump_steps import (
    FAR,
    gap_at,
    jump_step,
    newton_steps,
    put_here,
)
from hybond.engine.mode.enclosed import FARTHER, FARTHEST, FIRST, HALVES, is_alike, middle_of
from hybond.engine.mode.mode_records import Mode, Ways
from hybond.engine.mode.storage import stiff, with_stored
from hybond.engine.reasons.facts import refuse_jump
from hybond.engine.words import Floats

FIRST_PART: Final = 0.125
"""What is asked for of what is missing first; twice as much more after each part that was found."""
LEAST_PART: Final = 1e-6
"""The way ends where no more than this part can be asked for."""
PARTS: Final = 200
"""Parts that are tried in all."""
TURNS: Final = 8
"""Newton's steps to each part."""
NEAR: Final = 1e-6
"""A part is found where this part of a constraint's terms is left of it."""


def find_areas(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, measured: bool) -> int:
    """Find the areas at which the constraints hold, into `e.work.nu`.

    Where they are `measured`, the residuals at `x` are in `e.work`.
    """
    status = newton_steps(e, mode, v, x, ways, measured, False)
    if status == OK and not ways.known and not ways.sparse:
        return lead_forth(e, mode, v, x, ways)
    if status != FAR:
        return status
    if not ways.known and not ways.sparse:
        if led(e, mode, v, x, ways):
            status = newton_steps(e, mode, v, x, ways, False, True)
        if status == FAR and enclosed_area(e, mode, v, x, ways, 0.0):
            status = newton_steps(e, mode, v, x, ways, False, True)
    if status != FAR:
        return status
    if e.model.tells != 0:
        return refuse_jump(e, mode, "HB-N304", "the jump into this mode does not converge")
    return say_fault(e, "HB-N304", "the jump into this mode does not converge", "")


def led(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> bool:
    """Find areas near the solution, into `e.work.nu`, by asking for ever larger parts of it."""
    w = e.work
    areas = ways.areas
    for a in range(areas):
        w.nu.at[a] = 0.0
    gap_at(e, mode, v, x, ways, 0.0)
    fit(w.gap_led, w.constraints)
    for i in range(w.constraints):
        w.gap_led.at[i] = w.gap.at[i]
        if not math.isfinite(w.gap.at[i]):
            return False
    fit(w.nu_led, areas)
    found = 0.0
    part = FIRST_PART
    for _ in range(PARTS):
        for a in range(areas):
            w.nu_led.at[a] = w.nu.at[a]
        asked = min(found + part, 1.0)
        if reaches(e, mode, v, x, ways, 1.0 - asked):
            found = asked
            part *= 2.0
        else:
            for a in range(areas):
                w.nu.at[a] = w.nu_led.at[a]
            part *= 0.5
        if found == 1.0 or part < LEAST_PART:
            break
    return found == 1.0


def reaches(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, left: float) -> bool:
    """Go on from `e.work.nu` to where so much is left of what was missing at first."""
    w = e.work
    before = math.inf
    # steps that went too far leave nothing of what is measured there
    gap_at(e, mode, v, x, ways, 0.0)
    for turn in range(TURNS):
        put_here(e.model.storages, x, ways, w.nu.at, w.here)
        slope_of(e, mode, v, w.here, ways)
        gap_at(e, mode, v, x, ways, 0.0)
        worst = 0.0
        for i in range(w.constraints):
            w.gap_size.at[i] = max(w.gap_first.at[i], w.gap_size.at[i])
            w.gap.at[i] -= left * w.gap_led.at[i]
            size = w.gap_size.at[i]
            off = math.fabs(w.gap.at[i]) / (size if size > 0.0 else 1.0)
            worst = max(worst, off if math.isfinite(off) else math.inf)
        if worst <= NEAR:
            return True
        if worst == math.inf or (turn > 1 and worst > before):
            return False
        before = worst
        jump_step(e, ways, w.constraints)
        for a in range(ways.areas):
            w.nu.at[a] -= w.step.at[a]
    return False


def lead_forth(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> int:
    """Let one area go the way that what is missing drives it, if there is a solution that way.

    A source that reads what it prescribes may give way faster than what it drives: then Newton's
    first step leads back. What is left out between them, however small, would be driven forth.
    """
    w = e.work
    if w.constraints != 1 or ways.areas != 1 or w.nu.at[0] == 0.0:
        return OK
    n = 2 * e.model.bonds
    found = w.nu.at[0]
    here = gap_of(e, mode, v, x, ways, 0.0)
    way = -here * power_slope(e, mode, x, ways, n)
    if way * found < 0.0 and enclosed_area(e, mode, v, x, ways, way):
        if newton_steps(e, mode, v, x, ways, False, True) == OK and way * w.nu.at[0] > 0.0:
            return OK
    w.nu.at[0] = found
    gap_at(e, mode, v, x, ways, 0.0)
    return OK


def power_slope(e: Engine, mode: Mode, x: Floats, ways: Ways, n: int) -> float:
    """Return the derivative of one constraint by one area that what is stored makes alone."""
    m = e.model
    w = e.work
    values = with_stored(e, x)
    fit(w.by_stored, m.storages)
    constraint_by_co_energy(e, mode, 0, n)
    total = 0.0
    for k in range(m.storages):
        for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
            factor = w.by_stored.at[k]
            if factor != 0.0:
                total += factor * stiff(m, p, values) * ways.d.at[m.stiff_other[p]]
    return total


def enclosed_area(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, way: float) -> bool:
    """Find one area, into `e.work.nu`, between two at which its constraint differs in sign.

    On the side of zero that `way` has, or on both.
    """
    w = e.work
    if w.constraints != 1 or ways.areas != 1:
        return False
    # what is measured there is that of no area, not of where steps went
    here = gap_of(e, mode, v, x, ways, 0.0)
    slope_of(e, mode, v, x, ways)
    here = gap_of(e, mode, v, x, ways, 0.0)
    if here != here or here == 0.0:
        return False
    jump_step(e, ways, 1)
    step = FIRST * math.fabs(w.step.at[0])
    if not step > 0.0:
        return False
    near = 0.0
    other = 0.0
    while step < FARTHEST:
        if way >= 0.0 and not is_alike(gap_of(e, mode, v, x, ways, step), here):
            halve(e, mode, v, x, ways, near, step, here)
            return True
        if way <= 0.0 and not is_alike(gap_of(e, mode, v, x, ways, -step), here):
            halve(e, mode, v, x, ways, other, -step, here)
            return True
        near = step
        other = -step
        step *= FARTHER
    return False


def gap_of(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways, nu: float) -> float:
    """Return what is left of the one constraint at an area, which goes into `e.work.nu`."""
    e.work.nu.at[0] = nu
    gap_at(e, mode, v, x, ways, 0.0)
    return e.work.gap.at[0]


def halve(
    e: Engine,
    mode: Mode,
    v: Floats,
    x: Floats,
    ways: Ways,
    near: float,
    far: float,
    here: float,
) -> None:
    """Halve what is between an area where the constraint has the sign of `here` and one where not.

    Whether it holds where that ends, Newton's method says.
    """
    for _ in range(HALVES):
        middle = middle_of(near, far)
        if middle == near or middle == far:
            break
        if is_alike(gap_of(e, mode, v, x, ways, middle), here):
            near = middle
        else:
            far = middle
    e.work.nu.at[0] = far
