"""Newton's method with the laws inside: a step in which something is nonlinear.

Slopes are difference quotients, kept from step to step while they serve.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.complementarity.law_roles import TWO_SIDED
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.jumps.jump import enter_mode
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import open_mode, solve_with
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.timestepping.matrices import NEARBY, find_slopes, implicit
from hybond.engine.timestepping.step_laws import close_half_way, no_end, solve_step_laws
from hybond.engine.timestepping.step_records import Coupled, Stepping
from hybond.engine.timestepping.step_sizes import measure_rounding, measure_step

NEWTON_ROUNDS: Final = 40
"""Iterations of one step."""
SLOW_UPDATE: Final = 0.2
"""An update that is not reduced to this part asks for new slopes."""
PATIENT_ROUNDS: Final = 8
"""Iterations in which updates may go to and fro."""
GOES_BACK: Final = 0.5
"""An update against the last one that is not reduced to this part goes to and fro."""
PART_BACK: Final = 0.4
"""Part of such an update that is gone: less than half, or what it leads to would go as far."""
NEAR_PART: Final = 1e-2
"""Part of the last update over which slopes are found where updates go to and fro."""
LEAST_NEARBY: Final = 1e-24
"""Part of a state's size over which a slope is found at least."""
UPDATED: Final = 1e-11
"""Newton ends when an update is below this part of what is updated."""
SETTLED: Final = 1e-12
"""Part of its terms by which the last iteration moves a bond variable at most: what is left of the
laws is a part of that, as slopes may be those of an earlier step. Else one more is made, ..."""
NEARER: Final = 0.5
"""... as long as it moved them by no more than this part of what the one before did: that is no
rounding yet."""
NEAR_END: Final = 1e-6
"""An update below this part of what is updated leaves slopes as they are, for what shares are to
be and what is put back on its constraints: the error of what follows is that part of the update."""
LAW_DUST_PART: Final = 1e-3
"""Part of the largest bond variable of its kind down to which the digits of `l` count, and those of
bond variables in late iterations."""


def move(s: Stepping, c: Coupled) -> None:
    """Put what is left to the end of the step there, as far as the slopes tell: `l` stays."""
    n = c.n
    for k in range(n):
        s.change[k] = s.explicit[k] + c.h * s.rate[k] - s.y[k]
    moved = s.move
    column = c.inverse_columns.at
    for i in range(n):
        moved[i] = 0.0
    # column by column: each sum in the order of its row, and no sum waits for itself
    for k in range(n):
        change = s.change[k]
        at = k * n
        for i in range(n):
            moved[i] += column[at + i] * change


def constrain(e: Engine, s: Stepping, p: Ports) -> int:
    """Put the end of the step on the constraints that hold whatever the laws do."""
    m = e.model
    mode = open_mode(e, p)
    if not is_constrained(mode):
        return OK
    copy_part(m.storages, s.y, 0, s.v1, m.stored_slot)
    if mode.structures > 0 and solve_with(e, p, s.v1, s.nothing) != OK:
        return REFUSED
    if enter_mode(e, mode, s.v1, s.y, s.x) != OK:
        return REFUSED
    for b in range(2 * m.bonds):
        s.thrust[b] += e.impulses[b]
    copy_floats(m.storages, s.x, s.y)
    return OK


def newton_step_of(e: Engine, s: Stepping, p: Ports, c: Coupled) -> int:
    """Make a step in which something is nonlinear: Newton's method with the laws inside.

    Written for laws that need not be affine in `l` (a diode in series with a nonlinear resistor).
    Each iteration solves the laws for the whole new `l`.
    """
    m = e.model
    n = c.n
    measure_step(e, s, p, c.h)
    last = math.inf
    for k in range(n):
        s.went[k] = 0.0
    for k in range(m.ports):
        s.went_l[k] = 0.0
    projected = False
    last_w = math.inf
    first = True
    of_step = not c.known
    near = NEARBY
    held = False
    for turn in range(NEWTON_ROUNDS):
        # what levers share depends on how they stand, and slopes of an earlier step do not say that
        stands = c.still <= 0 or first or (of_step and last <= NEAR_END)
        if not (c.known and stands):
            near = near_of(s, c, turn)
            if find_slopes(e, s, p, c, s.y, s.l, near) != OK:
                return REFUSED
            of_step = True
        if implicit(e, s, p, s.y, s.l) != OK:
            return REFUSED
        move(s, c)
        for k in range(n):
            s.move[k] = 0.0 if projected else s.move[k]
        for b in range(2 * m.bonds):
            total = e.work.w[b]
            for k in range(n):
                total += c.state.at[b * n + k] * s.move[k]
            for j in range(m.ports):
                if s.l[j] != 0.0:
                    total -= c.gain.at[b * m.ports + j] * s.l[j]
            s.base[b] = total
            s.mean[b] = e.work.w[b]
        if first:
            close_half_way(e, s, p, c.h, s.base)
        first = False
        for k in range(m.ports):
            s.free[k] = s.l[k]
            s.doubt[k] = 0.0
        held = False
        if solve_step_laws(e, s, p, c, s.base, False) != OK:
            if not of_step:
                begin_anew(e, s, c)
                last = math.inf
                continue
            if hold_limits(e, s, p, c) != OK:
                return REFUSED
            held = True
        before = last if of_step and not projected and turn >= PATIENT_ROUNDS else math.inf
        update = advance_newton(e, s, p, c, before, turn >= PATIENT_ROUNDS)
        if near < NEARBY:
            # steep there, and not where it leads: no step ends by them alone, none begins with them
            c.known = False
        ends = update <= UPDATED and (near >= NEARBY or last <= UPDATED)
        comes_nearer = s.went_w > SETTLED and s.went_w <= NEARER * last_w
        last_w = s.went_w
        if ends and comes_nearer and not projected and turn < NEWTON_ROUNDS - 1:
            last = update
            continue
        if projected or ends:
            copy_floats(m.storages, s.y, s.move)
            if constrain(e, s, p) != OK:
                return REFUSED
            moved = False
            far = False
            for k in range(m.storages):
                moved = moved or s.y[k] != s.move[k]
                far = far or not math.fabs(s.y[k] - s.move[k]) <= NEAR_END * s.weight[k]
            if projected or not moved:
                # slopes may be those of a point on the way
                if c.outgrown and find_slopes(e, s, p, c, s.y, s.l, NEARBY) != OK:
                    return REFUSED
                return implicit(e, s, p, s.y, s.l)
            # back on the constraints; the laws once more, from there
            projected = True
            c.known = c.known and not far
            continue
        if not update <= SLOW_UPDATE * last:
            c.known = False
            if not of_step:
                begin_anew(e, s, c)
                update = math.inf
        last = update
    c.known = False
    return no_end(e, False) if held else no_convergence(e)


def hold_limits(e: Engine, s: Stepping, p: Ports, c: Coupled) -> int:
    """Solve the laws of an iteration once more, with limits that bend as they are at its beginning.

    Along its slope a limit `max(x, 0)` may be less than nothing where the iteration ends, which no
    friction keeps. Where iterations end, limits are what they are there, along slopes or not.
    """
    m = e.model
    r = e.laws
    bends = False
    for k in range(m.ports):
        bends = bends or (r.role[k] == TWO_SIDED and m.port_affine[k] == 0)
    if not bends:
        return REFUSED
    for k in range(m.ports):
        s.l[k] = s.free[k]
    r.limits_held = True
    found = solve_step_laws(e, s, p, c, s.base, False)
    r.limits_held = False
    return found


def near_of(s: Stepping, c: Coupled, turn: int) -> float:
    """Return the part of a state's size over which slopes are found.

    Where iterations go to and fro, as at the foot of a root, it is one of the distance they go.
    """
    if turn < PATIENT_ROUNDS:
        return NEARBY
    went = 0.0
    for k in range(c.n):
        went = max(went, math.fabs(s.went[k]) / s.weight[k])
    return min(NEARBY, max(NEAR_PART * went, LEAST_NEARBY))


def begin_anew(e: Engine, s: Stepping, c: Coupled) -> None:
    """Begin the iterations of a step again, with slopes of its own.

    Those of an earlier step hold while nothing acts: a lever that has turned by then gives a law
    another mass, and what that would give leads anywhere.
    """
    c.known = False
    for k in range(e.states):
        s.y[k] = e.y[k]
        s.went[k] = 0.0
    for k in range(e.model.ports):
        s.l[k] = 0.0
        s.went_l[k] = 0.0


def advance_newton(e: Engine, s: Stepping, p: Ports, c: Coupled, last: float, late: bool) -> float:
    """Go to the end that an iteration has found; return how far that was, in its own measure.

    `s.free` is `l` before it, `s.mean` the bond variables; `s.went_w` becomes how far these went.
    What goes back most of the way that it came, by `last`, goes on but a part of it: at an orifice,
    which takes a root of the pressure, Newton's method goes to and fro without an end. Where it is
    `late`, bond variables are measured by what there has been, too: what a root makes of nothing is
    rounding.
    """
    m = e.model
    n = c.n
    update = 0.0
    back = 0.0
    for k in range(n):
        change = s.move[k]
        for j in range(m.ports):
            change += c.push.at[k * m.ports + j] * (s.l[j] - s.free[j])
        back += (change / s.weight[k]) * (s.went[k] / s.weight[k])
        s.went[k] = change
        update = max(update, math.fabs(change) / s.weight[k])
        if not math.isfinite(change):
            update = math.inf
    s.went_w = 0.0
    # where nothing acts on a bond but the rounding of other laws, that is all it has
    measure_rounding(m, s, p, c)
    for b in range(2 * m.bonds):
        rest = 0.0
        scale = math.fabs(s.mean[b]) + math.fabs(s.base[b])
        for j in range(m.ports):
            gain = c.gain.at[b * m.ports + j]
            if math.fabs(s.l[j] - s.free[j]) > s.rounded[j]:
                rest += gain * (s.l[j] - s.free[j])
            scale += math.fabs(gain) * (math.fabs(s.l[j]) + LAW_DUST_PART * s.able[j])
        if late:
            i = m.bond_island[b if b < m.bonds else b - m.bonds]
            ever = s.ever_effort[i] if b < m.bonds else s.ever_flow[i]
            scale += LAW_DUST_PART * ever
        if scale > 0.0:
            s.went_w = max(s.went_w, math.fabs(rest) / scale)
    update = max(update, 1e-2 * s.went_w)
    for j in range(m.ports):
        change = s.l[j] - s.free[j]
        back += (change / s.able[j]) * (s.went_l[j] / s.able[j])
        s.went_l[j] = change
    part = PART_BACK if back < 0.0 and update >= GOES_BACK * last and update > UPDATED else 1.0
    for k in range(n):
        s.y[k] += part * s.went[k]
    for j in range(m.ports if part < 1.0 else 0):
        s.l[j] = s.free[j] + part * s.went_l[j]
    return update


def no_convergence(e: Engine) -> int:
    """Refuse a step that Newton does not solve."""
    return say_fault(e, "HB-N310", "a step does not converge", "")
