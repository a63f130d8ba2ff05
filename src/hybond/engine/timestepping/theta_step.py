"""One step of Moreau's time-stepping: the theta-scheme of Moreau and Jean for any bond graph.

The graph seen from its junction laws (`laws/ports`) is ``x' = f(x) + E l, w = y(x) + D l``. From
``(t, x)`` a step of length ``h`` goes to::

    x+ = x + h (theta f(x+) + (1 - theta) f(x)) + h E l
    w+ = y(x+) + D l,     0 <= l  |  w+ + eps w >= 0

`theta` averages the smooth part only; what the laws ask for holds at the *end* of the step, so that
a capacitor that is charged through a diode never overshoots. Where that is the worse formula, after
breaks and where laws give energy or lag, a step is made with ``theta = 1`` (`steps_damped`), where
``l w+`` is never positive.
``h l`` is the percussion of the step:
a force that acts during it, an impulse, or both, which the scheme does not tell apart. That is why
it needs no event location and passes through accumulation points. `eps` is Newton's restitution; a
contact takes part only if it would close in the first half of the step, ``gap + h/2 gap' <= 0``.
Integrated signals follow the same formula as what is stored.

Where everything else is linear one iteration ends; elsewhere Newton's method solves the step with
the laws inside, linearised at each iteration (Josephy-Newton).

References
----------
J. J. Moreau, *Unilateral contact and dry friction in finite freedom dynamics*, CISM 302, 1988.
M. Jean, *The non-smooth contact dynamics method*, Comput. Methods Appl. Mech. Eng. 177, 1999.
V. Acary, B. Brogliato, *Numerical Methods for Nonsmooth Dynamical Systems*, Springer 2008.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.complementarity.law_roles import ONE_SIDED
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.laws.law_instant import take_instant
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import open_mode, ports_of, solve_with, times_partner
from hybond.engine.laws.response import find_sizes
from hybond.engine.mode.digits.part_energies import join_parts, see_energy
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.model import Model
from hybond.engine.timestepping.law_work import none_carries, work_of_laws
from hybond.engine.timestepping.matrices import find_straight, implicit, rates_at, take_coupled
from hybond.engine.timestepping.step_account import balance_step, meter_step
from hybond.engine.timestepping.step_laws import (
    AT_REST,
    close_half_way,
    note_closed_gaps,
    read_step_laws,
    solve_step_laws,
)
from hybond.engine.timestepping.step_newton import (
    constrain,
    move,
    newton_step_of,
    no_convergence,
)
from hybond.engine.timestepping.step_records import Coupled, Stepping
from hybond.engine.timestepping.steps_damped import is_barred, is_damped, state_of
from hybond.engine.timestepping.touching_held import hold_touching
from hybond.engine.words import Floats, Ints

AT_END: Final = 4.0 * EPSILON
"""Part of its terms that a few operations leave of a state that laws bring to zero."""


def write_state(e: Engine, v: Floats, state: Ints) -> None:
    """Write the Booleans of a mode whose equations nobody asks for."""
    m = e.model
    for k in range(m.switches + m.state_first[m.machines]):
        v[m.on_slot + k] = 0.0
    for k in range(m.machines):
        at = m.state_first[k] + state[k]
        v[m.on_slot + m.switches + at] = 1.0
        for i in range(m.on_first[at], m.on_first[at + 1]):
            v[m.on_slot + m.on_switch[i]] = 1.0


def write_point(e: Engine, v: Floats, t: float, y: Floats, w: Floats) -> None:
    """Write all values at a point that a step ends in; a priori values are the same."""
    m = e.model
    write_state(e, v, e.state)
    set_time(e, v, t)
    copy_part(m.storages, y, 0, v, m.stored_slot)
    copy_part(m.integrals, y, m.storages, v, m.signal_slot)
    copy_part(2 * m.bonds, w, 0, v, m.bond_slot)
    for k in range(m.slots):
        v[m.slots + k] = v[k]


def theta_step(e: Engine, s: Stepping, t1: float, h: float) -> int:
    """Step from the present point to the time `t1`, and make that the present point.

    The states of laws there are in ``s.after_state``; those of the run stay for now.

    `h` is said apart, because the difference of two times is not twice the same: matrices are made
    once for each. HB-J120 if the laws have no solution, HB-N310 if Newton does not converge.
    """
    s.theta = e.model.theta
    found = end_of_step(e, s, t1, h)
    if s.theta < 1.0 and (is_barred(s) or (found == OK and is_damped(e, s))):
        s.theta = 1.0
        found = end_of_step(e, s, t1, h)
    if found != OK:
        return REFUSED
    if not all_finite(e.states, s.y) or not math.isfinite(energy_of(e, s.y)):
        return no_convergence(e)
    finish_step(e, s, e.laws.now, t1, h)
    return OK


def end_of_step(e: Engine, s: Stepping, t1: float, h: float) -> int:
    """Find the end of a step with ``s.theta``: the state in `s.y`, bond variables in `e.work.w`.

    Nothing is found where the matrices say beforehand that it is to be made with ``theta = 1``.
    """
    m = e.model
    r = e.laws
    take_instant(e, r, e.t, s.nothing_stored, e.state)
    if ports_of(e, r, e.state) != OK:
        return REFUSED
    p = r.now
    write_point(e, s.v0, e.t, e.y, s.w)
    if read_step_laws(e, s, p) != OK:
        return REFUSED
    join_parts(e, open_mode(e, p))
    see_energy(e, e.y)
    c = take_coupled(e, s, p, h)
    s.now = c
    if c.straight and not c.known and find_straight(e, s, p, c) != OK:
        return REFUSED
    if c.straight and is_barred(s):
        return OK
    # nothing but what is solved for now: laws that read pre() have none in a step
    for k in range(m.slots):
        s.v0[m.slots + k] = 0.0
        s.v1[m.slots + k] = 0.0
    copy_floats(m.slots, s.v0, s.v1)
    if rates_at(e, s, p, e.y, s.nothing, s.rate0) != OK:
        return REFUSED
    for b in range(2 * m.bonds):
        s.w0[b] = e.work.w[b]
        s.begin_w[b] = s.w[b]
        s.thrust[b] = 0.0
    set_time(e, s.v1, t1)
    for k in range(e.states):
        s.begin_y[k] = e.y[k]
        s.y[k] = e.y[k]
        s.explicit[k] = e.y[k] + h * (1.0 - s.theta) * s.rate0[k]
    for k in range(m.ports):
        s.l[k] = 0.0
    found = straight_step(e, s, p, c) if c.straight else newton_step_of(e, s, p, c)
    if found != OK:
        return REFUSED
    if c.outgrown and none_carries(m, s):
        # what a law holds does not grow
        return no_convergence(e)
    for b in range(2 * m.bonds):
        s.mean[b] = e.work.w[b] - (1.0 - s.theta) * (s.without[b] - s.w0[b])
    s.worked = work_of_laws(e, s, p, h)
    return OK


def straight_step(e: Engine, s: Stepping, p: Ports, c: Coupled) -> int:
    """Make a step in which nothing but the laws is nonlinear.

    Integrated signals do not act back here, so that they follow.
    """
    m = e.model
    theta = s.theta
    n = c.n
    if implicit(e, s, p, s.y, s.nothing) != OK:
        return REFUSED
    move(s, c)
    for k in range(n):
        s.y[k] += s.move[k]
    if constrain(e, s, p) != OK:
        return REFUSED
    copy_part(n, s.y, 0, s.v1, m.stored_slot)
    if solve_with(e, p, s.v1, s.nothing) != OK:
        return REFUSED
    a = e.laws.response
    for b in range(2 * m.bonds):
        s.base[b] = e.work.w[b]
        a.bonds[b] = s.base[b]
    find_sizes(e, p, a)
    copy_floats(m.ports, a.size, s.doubt)
    close_half_way(e, s, p, c.h, s.base)
    if solve_step_laws(e, s, p, c, s.base, True) != OK:
        return REFUSED
    y = s.y
    sizes = s.move
    column = c.push_columns.at
    for k in range(n):
        sizes[k] = math.fabs(y[k])
    for j in range(m.ports):
        given = s.l[j]
        if given != 0.0:
            at = j * n
            for k in range(n):
                term = column[at + k] * given
                y[k] += term
                sizes[k] += math.fabs(term)
    for k in range(n):
        # what laws bring to rest is at rest, and not at what rounding leaves of its terms
        if math.fabs(y[k]) <= AT_END * sizes[k]:
            y[k] = 0.0
    copy_floats(2 * m.bonds, s.base, s.without)
    if (m.integrals > 0 or theta < 1.0) and rates_at(e, s, p, s.y, s.nothing, s.rate) != OK:
        return REFUSED
    copy_floats(2 * m.bonds, e.work.w, s.without)
    if rates_at(e, s, p, s.y, s.l, s.rate_l) != OK:
        return REFUSED
    for k in range(m.integrals):
        at = m.storages + k
        ends = s.rate_l[at] - (1.0 - theta) * s.rate[at]
        s.y[at] = s.explicit[at] + c.h * ends
    return OK


def finish_step(e: Engine, s: Stepping, p: Ports, t1: float, h: float) -> None:
    """Make the end of a step the present point, and find what it did."""
    m = e.model
    w = e.work.w
    copy_floats(2 * m.bonds, w, s.w)
    if m.ports > 0:
        hold_touching(e, s, p, h)
    meter_step(m, s, h)
    balance_step(e, s)
    for k in range(m.ports):
        s.most[k] = max(s.most[k], math.fabs(s.before[k]))
        # what the law of a body at rest gives it within a step is far more than rounding
        moved = math.fabs(s.now.m.at[k * m.ports + k] * s.l[k])
        approach = s.before[k] < -AT_REST * max(s.most[k], moved)
        hit = e.laws.role[k] == ONE_SIDED and s.l[k] > 0.0 and approach
        s.struck[k] = 1 if hit else 0
    times_partner(m, p, s.w, s.wl)
    for k in range(m.ports):
        put_law_source(m, s, p, k)
        if s.struck[k] != 0 and s.restitution[k] > 0.0:
            # what bounces off is open again
            s.branch[k] = 0
    s.t0 = e.t
    e.t = t1
    copy_floats(e.states, s.y, e.y)
    s.since += 1
    note_closed_gaps(e, s)
    for k in range(m.machines):
        s.before_state[k] = e.state[k]
        s.after_state[k] = e.state[k]
    for k in range(m.ports):
        machine = m.port_machine[k]
        s.after_state[machine] = state_of(m, s, k)
        if s.struck[k] != 0 or s.after_state[machine] != s.before_state[machine]:
            s.since = 0
    see_energy(e, e.y)
    e.evaluations += 1


def put_law_source(m: Model, s: Stepping, p: Ports, k: int) -> None:
    """Put what slides, or rebounds, on the bond made for it.

    A port's own equations leave out the source that its law brought in.
    """
    if m.port_force[k] < 0 or s.branch[k] == 0:
        return
    net = -s.wl[k] if p.given[k] == COMMON else -s.l[k]
    s.w[m.port_force[k]] = float(m.port_force_sign[k]) * net


def steady_bonds(e: Engine, s: Stepping) -> int:
    """Put the bond variables of the present point into `s.w` as they are without any law's `l`."""
    m = e.model
    r = e.laws
    take_instant(e, r, e.t, s.nothing_stored, e.state)
    if ports_of(e, r, e.state) != OK:
        return REFUSED
    for b in range(2 * m.bonds):
        s.w[b] = 0.0
    write_point(e, s.v1, e.t, e.y, s.w)
    if solve_with(e, r.now, s.v1, s.nothing) != OK:
        return REFUSED
    copy_floats(2 * m.bonds, e.work.w, s.w)
    return OK
