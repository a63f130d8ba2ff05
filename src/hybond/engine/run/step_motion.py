"""The executive of time-stepping: what `run/motion` is for events, without locating any.

The whole algorithm::

    x, s, mode <- settle at t = 0
    while t < until:
      interval <- what inputs and comparisons of time are from t to the next timed event
      repeat
        one step of fixed length, the last one shortened to the timed event or `until`:
          all junction laws at once; branches that changed, and impacts, are noted as an event of
          cause "step" that happened somewhere in (t, t + h]
        if a guard of a machine written by hand holds at the end of the step: settle there
      until the timed event, or `until`
      settle with inputs before and after the instant

An impulse and a force that acts for the length of a step are the same here: the event says the
percussion of the step.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.guards.in_force import is_asked
from hybond.engine.instant.instant import (
    CONTINUOUS,
    GUARD,
    START,
    begin_instant,
    note_fired,
    note_step,
)
from hybond.engine.instant.settle import settle
from hybond.engine.instant.told import STEP_ENDS, say_why
from hybond.engine.jumps.jump import on_constraints
from hybond.engine.laws.gaps_held import hold_gaps
from hybond.engine.laws.laws import check_limits, limits_vary
from hybond.engine.methods.explicit.fixed import SLACK
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.reasons.warned import (
    FIRES_ALWAYS,
    NEXT_DECIDES,
    SHARES_OPEN,
    add_about,
    begin_warning,
)
from hybond.engine.run.courses_ahead import watch_courses
from hybond.engine.run.log import keep_left, report_event, report_step
from hybond.engine.run.others_told import see_left_by_steps
from hybond.engine.run.run_records import (
    PAUSED,
    STOPPED,
    Run,
    begin_count,
    count_step,
    timed_cause,
)
from hybond.engine.surfaces.values import evaluate
from hybond.engine.timestepping.step_event import note_event
from hybond.engine.timestepping.step_records import Stepping
from hybond.engine.timestepping.theta_step import steady_bonds, theta_step, write_point

OFF_BY: Final = 4.0 * EPSILON
"""Part of the time by which the difference of two times may be off."""
CHATTER: Final = 100
"""Steps in a row at whose ends one machine fires, after which a warning says so."""
FAILED: Final = -1


def flow_in_steps(e: Engine, r: Run) -> int:
    """Step to the next timed event, to a guard that holds, or the end; return why it ended.

    STOPPED where the stretch of the run ends and nothing happened; FAILED if the run stops.
    """
    m = e.model
    s = e.stepping
    if s.grid_new:
        s.grid = e.t
        s.grid_next = 1
        s.grid_new = False
    r.flowing = False
    end = min(e.next_break, e.stop)
    while e.t < end:
        if r.slice == 0:
            r.flowing = True
            return PAUSED
        r.slice = r.slice - 1 if r.slice > 0 else r.slice
        point = s.grid + float(s.grid_next) * m.step
        t1 = end if end <= point + SLACK * m.step else point
        s.grid_next += 1
        h = t1 - e.t
        if math.fabs(h - m.step) <= OFF_BY * math.fabs(t1):
            h = m.step
        if m.courses > 0:
            watch_courses(e, end)
        if make_step(e, r, t1, h) != OK:
            return FAILED
        if e.t < e.next_break and guard_fires(e, s):
            return GUARD
    s.grid_new = True
    if m.courses > 0:
        e.courses.end = -math.inf
    return timed_cause(e) if e.next_break <= end else STOPPED


def make_step(e: Engine, r: Run, t1: float, h: float) -> int:
    """Make one step, and note it with what happened in it."""
    m = e.model
    s = e.stepping
    vary = limits_vary(m)
    if theta_step(e, s, t1, h) != OK:
        e.fault.t = t1
        if vary:
            # friction that pushes leaves no solution: then that is the reason
            write_point(e, e.shown, t1, e.y, s.w)
            check_limits(e, t1, e.shown)
        return REFUSED
    if count_step(e, r) != OK:
        return REFUSED
    s.steps += 1
    put_step(e, s)
    report_step(e, r.report)
    s.begins = False
    copy_places(m.machines, s.after_state, 0, e.state, 0)
    write_point(e, e.shown, e.t, e.y, s.w)
    if vary and check_limits(e, e.t, e.shown) != OK:
        return REFUSED
    see_left_by_steps(e, s.w)
    warn_of_shares(e, s)
    if m.laws > 0 and hold_gaps(e, e.shown) != OK:
        return REFUSED
    if note_event(e, s, r.instant, h):
        r.events += 1
        report_event(e, r.report, r.instant)
        begin_count(e, r)
        if r.events > m.max_events:
            return say_fault(e, "HB-N404", "too many events", "")
    return OK


def put_step(e: Engine, s: Stepping) -> None:
    """Put the step where those of other methods stand: a straight line."""
    step = e.step
    n = e.states
    step.t0 = s.t0
    step.t1 = e.t
    for k in range(n):
        step.y0[k] = s.begin_y[k]
        step.y1[k] = e.y[k]
        step.dense[k] = e.y[k] - s.begin_y[k]
        for p in range(1, 4):
            step.dense[p * n + k] = 0.0


def warn_of_shares(e: Engine, s: Stepping) -> None:
    """Say once whose shares the equations leave open."""
    m = e.model
    new = False
    for k in range(m.ports):
        new = new or (s.shared[k] != 0 and s.shared_said[k] == 0)
    if not new or m.tells == 0:
        return
    begin_warning(e.warned, SHARES_OPEN, e.t)
    for k in range(m.ports):
        if s.shared[k] != 0:
            s.shared_said[k] = 1
            add_about(e.warned, float(k))


def guard_fires(e: Engine, s: Stepping) -> bool:
    """Whether a guard of a machine written by hand holds at the end of a step, in `e.shown`."""
    m = e.model
    if not s.hand and m.ends < 0:
        return False
    fires = False
    for k in range(m.machines):
        if m.is_law[k] != 0:
            continue
        own = False
        for rule in range(m.rule_first[k], m.rule_first[k + 1]):
            if is_asked(e, k, rule, e.state[k]):
                own = own or value(m, m.rule_value[rule], e.shown) != 0.0
        if not own:
            continue
        fires = True
        s.row_count[k] = s.row_count[k] + 1 if s.row_last[k] == s.steps - 1 else 1
        s.row_last[k] = s.steps
        if s.row_count[k] == CHATTER and m.tells != 0:
            begin_warning(e.warned, FIRES_ALWAYS, e.t)
            add_about(e.warned, float(k))
    return fires


def end_run(e: Engine, r: Run) -> None:
    """End the run where what ends it holds: laws that cannot decide have no say in that."""
    m = e.model
    i = r.instant
    rule = m.rule_first[m.ends]
    while rule < m.rule_first[m.ends + 1] and value(m, m.rule_value[rule], e.shown) == 0.0:
        rule += 1
    if rule == m.rule_first[m.ends + 1]:
        return
    begin_instant(i, e.t, GUARD)
    i.since = e.stepping.t0
    note_fired(i, m.ends, e.state[m.ends], m.rule_target[rule])
    say_why(i.told, STEP_ENDS)
    e.state[m.ends] = m.rule_target[rule]
    note_step(i, CONTINUOUS)
    r.events += 1
    report_event(e, r.report, i)


def drop_dust(e: Engine) -> None:
    """Put what laws hold still on their constraints, which a step keeps but for rounding.

    Laws look at the signs of speeds: what sticks would slide on by what is left of its own.
    """
    if mode_of(e, e.state) == OK and is_constrained(e.mode):
        if evaluate(e, e.mode, e.shown, e.t, e.y) == OK:
            on_constraints(e, e.mode, e.shown, e.y)


def settle_in_steps(e: Engine, r: Run, cause: int) -> int:
    """Settle the present instant, and report what changed.

    Where the laws cannot decide and no machine was written by hand, the next step does.
    """
    m = e.model
    s = e.stepping
    i = r.instant
    begin_instant(i, e.t, cause)
    s.since = 0
    if cause == GUARD:
        i.since = s.t0
    else:
        begin_count(e, r)
    if cause != START:
        keep_left(e, r.report)
    if m.laws > 0:
        e.laws.undecided = False
        if cause != START:
            drop_dust(e)
    if settle(e, r.settling, i) != OK:
        if s.hand or m.laws == 0 or not e.laws.undecided:
            return REFUSED
        for k in range(m.samples):
            at = m.sample_signal[k]
            if at >= 0:
                e.y[m.storages + at] = r.settling.s[at]
        for k in range(m.blocks):
            for j in range(m.block_set[k], m.block_set[k + 1]):
                e.y[m.storages + m.block_signal[j]] = r.settling.s[m.block_signal[j]]
        if cause == GUARD and m.ends >= 0:
            end_run(e, r)
        elif m.tells != 0:
            begin_warning(e.warned, NEXT_DECIDES, e.t)
        s.begins = True
        return steady_bonds(e, s)
    if mode_of(e, e.state) != OK or evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return REFUSED
    copy_part(2 * m.bonds, e.shown, m.bond_slot, s.w, 0)
    s.begins = True
    if i.steps > 0:
        r.events += 1
        report_event(e, r.report, i)
        begin_count(e, r)
        if r.events > m.max_events:
            return say_fault(e, "HB-N404", "too many events", "")
    if cause == START and limits_vary(m):
        return check_limits(e, e.t, e.shown)
    return OK
