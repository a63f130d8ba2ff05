"""Radau IIA as a method that a run may ask for: start, step, retry, and what is between."""

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.method_numbers import RADAU
from hybond.engine.methods.explicit.dopri import (
    begin_step,
    first_step,
    goes_elsewhere,
    not_finite,
)
from hybond.engine.methods.explicit.failed_steps import (
    no_rate,
    note_settling,
    step_too_small,
    worst_of,
)
from hybond.engine.methods.explicit.one_instant import jump_lies_between
from hybond.engine.methods.implicit.radau import (
    RADAU_GROW,
    STEP_MADE,
    begin_radau,
    retry_radau,
    step_radau,
)
from hybond.engine.methods.implicit.radau_factors import BUTCHER_INVERSE
from hybond.engine.methods.implicit.radau_room import ERROR_BLAMED, STAGES_BLAMED, Radau
from hybond.engine.methods.implicit.radau_stages import rate_at, stage_time
from hybond.engine.methods.implicit.stiffness import watch_implicit
from hybond.engine.methods.tolerances.defects import apart_at_end, end_levels
from hybond.engine.methods.tolerances.scale import controlled, tolerance
from hybond.engine.model import Model
from hybond.engine.reasons.warned import SWINGS, add_about, begin_warning
from hybond.engine.words import Floats

OFF: Final = 1e-3
"""Part of the largest rate of its kind by which one may be off without a word."""


def radau_start(e: Engine, t: float, y: Floats, t_bound: float, jumped: bool) -> int:
    """Begin, or go on after an event."""
    s = e.step
    n = e.states
    forget = jumped or not s.started
    if goes_elsewhere(e, t, y, forget):
        if rate_at(e, n, t, s.y, s.f) != OK:
            if e.model.tells != 0 and not e.refusal:
                return no_rate(e, n, 0.0, s.f, s.f)
            return not_finite(e)
        begin_radau(e.radau, forget)
    tolerance(e, s.y, s.y, s.scale)
    s.controlled = controlled(n, s.scale)
    if forget:
        limit = min(e.model.max_step, t_bound - t) if t_bound > t else e.model.max_step
        s.h = first_step(e, limit, 3.0)
    return OK


def radau_step(e: Engine, t_end: float) -> int:
    """Make one step that satisfies the tolerance, not beyond `t_end`."""
    s = e.step
    r = e.radau
    begin_step(e)
    r.t0 = s.t0
    copy_floats(e.states, s.y0, r.y0)
    copy_floats(e.states, s.f0, r.f0)
    r.next = s.h
    made = step_radau(e, r, e.model.rtol, t_end, min(e.model.max_step, e.longest))
    if made != STEP_MADE:
        return radau_failed(e)
    s.h = r.next
    s.rejected = r.rejected
    if e.model.method != RADAU and r.h >= 0.99 * r.trial:
        watch_implicit(e, r)
    accept_radau(e)
    return OK


def radau_failed(e: Engine) -> int:
    """Say why no step is small enough."""
    if e.model.tells != 0 and not e.refusal and e.radau.beyond:
        return no_rate(e, e.states, e.radau.h, e.radau.end, e.radau.f1)
    if e.radau.beyond:
        return not_finite(e)
    if e.model.tells != 0:
        return radau_too_small(e, e.radau)
    return say_fault(e, "HB-N201", "step size underflow", "")


def radau_too_small(e: Engine, r: Radau) -> int:
    """Refuse a step that would have to be too small, with the state that is to blame.

    And with how soon that settles by itself, where that is over before the time is another number.
    """
    n = r.n
    for i in range(n):
        last = max(math.fabs(r.last[i]), math.fabs(r.last[n + i]))
        r.shifted[i] = r.f0[i]
        if r.blamed == STAGES_BLAMED:
            r.shifted[i] = max(last, math.fabs(r.last[2 * n + i]))
        elif r.blamed == ERROR_BLAMED:
            r.shifted[i] = r.error_vector[i]
    tolerance(e, r.y0, r.y0, r.other)
    worst = worst_of(n, r.shifted, r.other)
    found = step_too_small(e, r.h, worst)
    if worst >= 0:
        note_settling(e, r.t0, r.jacobian[worst * n + worst])
    return found


def radau_retry(e: Engine, t_end: float) -> int:
    """Repeat the last step, ending at `t_end`.

    Where that takes too many shorter steps, or one that is too short, it is refused, and the step
    ends where they have led.
    """
    # what begins where it does has the size that it had then
    e.step.t = e.radau.start
    made = retry_radau(e, e.radau, e.model.rtol, t_end, min(e.model.max_step, e.longest))
    if e.step.off > 1.0:
        accept_radau(e)
        # the run goes on as they did
        last = e.radau.pieces - 1
        e.step.h = min(e.step.h, RADAU_GROW * (e.radau.t1 - e.radau.piece_t0[last]))
    if made != STEP_MADE:
        return radau_failed(e)
    accept_radau(e)
    return OK


def accept_radau(e: Engine) -> None:
    """Keep the step just made."""
    s = e.step
    r = e.radau
    s.t1 = r.t1
    s.t = r.t1
    copy_floats(e.states, r.y1, s.y1)
    copy_floats(e.states, r.y1, s.y)
    copy_floats(e.states, r.f1, s.f)
    count_apart(e, r)
    if r.pieces > 1:
        count_last_piece(e, r)


def count_last_piece(e: Engine, r: Radau) -> None:
    """Let the rates that a step ends with count for as long as its last piece, which moved so."""
    m = e.model
    s = e.step
    # where shorter steps were too many, the next of them had begun
    before = r.piece_t0[r.pieces - 1] - s.t0
    for k in range(m.storages):
        if m.storage_pseudo[k] == 0:
            s.apart += 0.5 * s.level1[k] * before * s.f[k]


def count_apart(e: Engine, r: Radau) -> None:
    """Find by how much the rates at the end of the step made may not be those that it ends with.

    Its error is no more than the tolerance by the same estimate: that says nothing of the energy
    beyond it. Of a step that was repeated in pieces, the last one is looked at.
    """
    s = e.step
    n = e.states
    c = r.coefficients
    end_levels(e)
    s.defect = 0.0
    s.apart = 0.0
    s.rates_known = e.slide.k == 0
    for k in range(e.model.storages):
        led = 0.0
        for j in range(3):
            led += BUTCHER_INVERSE[6 + j] * r.z[j * n + k]
        s.moves[k] = led / r.h
        # where an edge was left the curve between the ends is led without a turn: stages say how
        # it ends
        moved = led if s.left_edge else c[k] + 2.0 * c[n + k] + 3.0 * c[2 * n + k]
        apart_at_end(e, k, moved)
    if e.model.tells != 0 and r.swings and not e.warned.swings and not swings_about_jump(e, r):
        warn_of_swings(e)


def swings_about_jump(e: Engine, r: Radau) -> bool:
    """Whether stages have gone to and fro over a jump, or began at one: a step is to end there."""
    n = r.n
    found = False
    for stage in range(3):
        for i in range(n):
            half = 0.5 * r.last[stage * n + i]
            r.stage[i] = r.y[stage * n + i] + half
            r.end[i] = r.y[stage * n + i] - half
        found = found or jump_lies_between(e, stage_time(r, stage), r.stage, r.end)
    return found or jump_lies_between(e, r.t1, r.y0, r.end)


def warn_of_swings(e: Engine) -> None:
    """Say once that the rates at the end of steps are off, where these swing within the tolerance.

    By how much it leads elsewhere than the rate that it is said to end with, or that differs at
    the end of what swings: how far rates move within a step is none of it, as what is stopped, or
    breaks loose, in one has them move much. The way through stages alone tells too little: stages
    are put where they swing about, and a law may have the rate that leads there in between.
    """
    m = e.model
    s = e.step
    r = e.radau
    most = OFF
    which = -1
    for k in range(m.storages):
        size = e.checks.largest[m.bond_class[m.storage_bond[k] + rate_kind(m, k)]]
        moved = 0.0
        for j in range(3):
            moved += BUTCHER_INVERSE[6 + j] * r.z[j * r.n + k]
        off = math.fabs(s.f[k] - moved / r.h)
        off = max(off, math.fabs(s.f[k] - r.f[2 * r.n + k]))
        if off > most * size and size > 0.0:
            most = off / size
            which = k
    if which < 0:
        return
    e.warned.swings = True
    size = e.checks.largest[m.bond_class[m.storage_bond[which] + rate_kind(m, which)]]
    begin_warning(e.warned, SWINGS, s.t1)
    add_about(e.warned, float(which))
    add_about(e.warned, most * size)
    add_about(e.warned, size)


def rate_kind(m: Model, k: int) -> int:
    """Return where rates of a storage of that kind begin among bond variables."""
    return m.bonds if m.storage_kind[k] == 0 else 0
