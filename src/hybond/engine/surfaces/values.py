"""Values that expressions read: of a mode, at a time, with a state."""

from __future__ import annotations

from hybond.engine.algebra.products import copy_part
from hybond.engine.answers import value
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.mode.comparisons.standing import hold_standing
from hybond.engine.mode.comparisons.straight_rates import put_rates
from hybond.engine.mode.digits.closely import rate_closely, rate_twofold
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.agreement import check_agreement
from hybond.engine.mode.reading import rates_by_knowns
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.mode.solving import solve_in_step
from hybond.engine.surfaces.averages import blended_field, solve_here
from hybond.engine.words import Floats


def set_values(e: Engine, mode: Mode, v: Floats, t: float, x: Floats, s: Floats) -> None:
    """Write all but bond variables; the a priori copy is left alone."""
    m = e.model
    set_time(e, v, t)
    copy_part(m.switches + m.state_first[m.machines], mode.flags, 0, v, m.on_slot)
    copy_part(m.storages, x, 0, v, m.stored_slot)
    copy_part(m.integrals, s, 0, v, m.signal_slot)


def set_state(e: Engine, mode: Mode, v: Floats, t: float, y: Floats) -> None:
    """Write all but bond variables, the state being stored quantities, then signals."""
    m = e.model
    copy_part(m.switches + m.state_first[m.machines], mode.flags, 0, v, m.on_slot)
    set_motion(e, v, t, y)


def set_motion(e: Engine, v: Floats, t: float, y: Floats) -> None:
    """Write what changes while time passes in a mode, but bond variables."""
    m = e.model
    set_time(e, v, t)
    copy_part(m.storages, y, 0, v, m.stored_slot)
    copy_part(m.integrals, y, m.storages, v, m.signal_slot)


def evaluate(e: Engine, mode: Mode, v: Floats, t: float, y: Floats) -> int:
    """Write all values of a motion, the a priori copy being the same.

    If time passes in a pinnacle's mode, a machine has landed: what its law reads is at its limit.
    """
    m = e.model
    set_state(e, mode, v, t, y)
    put_limits(e, mode, v)
    status = solve_here(e, mode, v)
    copy_part(m.slots, v, 0, v, m.slots)
    put_limits(e, mode, v)
    return status


def field(e: Engine, mode: Mode, t: float, y: Floats, rate: Floats) -> int:
    """Put ``y'`` into `rate`; NOT_FINITE where a law has no value.

    Of bond variables only those are evaluated that rates read.
    """
    m = e.model
    v = e.v
    e.evaluations += 1
    if e.slide.k > 0:
        status = blended_field(e, t, y, rate)
        e.refusal = e.refusal or status != OK
        return status
    if e.straight and not mode.closely:
        put_rates(e, t, y, rate)
        if e.standing.some:
            hold_standing(e, rate)
        return OK
    set_motion(e, v, t, y)
    if mode.dynamics == 0:
        rates_by_knowns(e, mode, v, rate)
    elif solve_in_step(e, mode, v) != OK:
        # a trial point beyond where the laws hold: the solver shortens its step; where sources have
        # come to contradict each other laws have no part in it
        if mode.agreements.rows > 0:
            check_agreement(e, mode, v)
        e.refusal = True
        return NOT_FINITE
    else:
        w = e.work.w
        for k in range(m.storages):
            at = rate_bond(m, k)
            way = way_of_rate(m, k)
            total = w[at]
            if mode.closely:
                total = rate_twofold(e, mode, at, w)
                e.rate_rest[k] = way * e.work.over
            rate[k] = way * total
        for i in range(mode.signals.many if mode.closely else 0):
            b = mode.signals.bond[i]
            v[m.bond_slot + b] = rate_closely(e, mode, b, w)
    for k in range(m.integrals):
        rate[m.storages + k] = value(m, m.integral_rate[k], v)
    if e.standing.some:
        hold_standing(e, rate)
    return OK


def begin_field(e: Engine, mode: Mode) -> None:
    """Write what does not change while time passes in a mode: its Booleans; nothing stands yet."""
    m = e.model
    e.standing.some = False
    for k in range(2 * m.slots):
        e.v[k] = 0.0
    copy_part(m.switches + m.state_first[m.machines], mode.flags, 0, e.v, m.on_slot)
    put_limits(e, mode, e.v)
