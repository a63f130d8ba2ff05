"""The executive: time passes in a mode until something happens, then the mode is settled.

Nothing else changes the state: a jump is made by settling alone.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.checks.bounds_held import hold_bounds
from hybond.engine.checks.guards_held import foresee, hold_apart, look_at_guards
from hybond.engine.checks.laws_held import look_at_entry, look_at_laws, look_now_and_then
from hybond.engine.contacts.impacts_seen import before_event, observe_event
from hybond.engine.contacts.landing import keep_still, land_contacts, stuck
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.inputs.interval import interval_after, read_within
from hybond.engine.instant.doubts import warn_of_held
from hybond.engine.instant.instant import GUARD, LAW, START, TIME, begin_instant
from hybond.engine.instant.settle import settle
from hybond.engine.laws.laws import limits_vary, look_at_limits, observe
from hybond.engine.methods.control import end_pace
from hybond.engine.methods.one_instant import room_of_instant
from hybond.engine.methods.scale import start_scale
from hybond.engine.methods.stepping import between, retry, start, step
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.straight_rates import take_rates
from hybond.engine.mode.values import begin_field, set_state
from hybond.engine.planar.descent import (
    ENDLESS,
    IS_DOWN,
    any_ends,
    begin_descent,
    end_descent,
    step_descent,
)
from hybond.engine.planar.stops import arm_slips, begin_slips, follows_slip
from hybond.engine.run.carried import begin_again, cause_of_beginning, take_up, warm_up
from hybond.engine.run.edges import reach_edges, straight_on, time_at_once
from hybond.engine.run.ends_at_guard import find_within, land, shows_instants
from hybond.engine.run.guard_values import doubt
from hybond.engine.run.kinks_passed import (
    count_kink,
    end_at_kink,
    events_held,
    see_crawl,
    see_crowd,
    see_jump,
    stuck_at_kink,
    switches_back,
)
from hybond.engine.run.locate import locate
from hybond.engine.run.locator import watch
from hybond.engine.run.log import (
    keep_left,
    report_end,
    report_event,
    report_slide,
    report_step,
)
from hybond.engine.run.roots_reached import rest_at_roots
from hybond.engine.run.run_records import (
    FRESH,
    IDLE,
    PAUSED,
    STOPPED,
    Run,
    begin,
    begin_count,
    bound_of,
    count_step,
    is_over,
    timed_cause,
)
from hybond.engine.run.source_jumps import (
    jumps_at_end,
    jumps_at_once,
    jumps_onto_storage,
    put_before_kink,
)
from hybond.engine.run.stranded import in_vain, no_slip
from hybond.engine.run.together import is_kink_alone, last_of_instant
from hybond.engine.sliding.branches import know_around
from hybond.engine.sliding.combine import combine_here
from hybond.engine.sliding.onto import onto_surfaces
from hybond.engine.sliding.sliding import slide_after
from hybond.engine.timestepping.step_motion import flow_in_steps, settle_in_steps
from hybond.engine.timestepping.step_records import MOREAU

SHORTER: Final = 30
"""Times that a step is repeated, each time a quarter as long, if it does not follow slip."""
VAIN: Final = 3
"""Instants in a row without any change after which rounding is swept out of what is stored."""
MOMENT: Final = 1e-13
"""What counts as no time for all of them together, as a part of the run."""
BEYOND: Final = 50.0
"""Steps that may touch a place where a law has no value before the law is blamed: one in ten, and
this many at once."""
EDGES: Final = 100
"""Edges in a row with next to no time between them that are reached."""
ACCUMULATES: Final = 3


def run_to_end(e: Engine, r: Run) -> int:
    """Run to the end: OK, REFUSED with a fault, ACCUMULATES, or PAUSED where a slice ends."""
    status = OK
    if not r.begun:
        r.begun = True
        status = begin_now(e, r)
    while status == OK and (e.t < e.until or r.flowing) and not is_over(e):
        cause = flow(e, r)
        if cause < 0:
            return REFUSED
        if cause == PAUSED:
            return PAUSED
        if cause == STOPPED:
            break
        status = settle_now(e, r, cause)
        if status == OK and r.instant.steps == 0 and r.late > e.t:
            status = settle_late(e, r)
        if status == OK:
            status = rest_now(e, r)
        if status == OK and stuck(e):
            status = ACCUMULATES
        r.slice = r.slice - 1 if r.slice > 0 else r.slice
    if status != REFUSED:
        if mode_of(e, e.state) == OK and combine_here(e, e.state) == OK:
            look_at_laws(e)
            status = status if hold_bounds(e) == OK else REFUSED
        report_end(e, r.report)
    return status


def begin_now(e: Engine, r: Run) -> int:
    """Begin as the model says, or as was put in, and settle the first instant."""
    if r.way == FRESH:
        begin(e)
    e.samples_end = e.until
    interval_after(e, e.t)
    if r.way != FRESH and take_up(e, r) != OK:
        return REFUSED
    cause = cause_of_beginning(e, r)
    if cause == TIME and e.model.method != MOREAU:
        # what was settled there is not settled again
        if e.slide.many > 0:
            know_around(e, e.state)
        report_slide(e, r.report)
        return OK
    r.warm = False
    status = settle_now(e, r, cause)
    return rest_now(e, r) if status == OK else status


def settle_late(e: Engine, r: Run) -> int:
    """Settle what happens at the end of the run but for rounding of the time it is read from.

    A sawtooth that begins anew there does so an ulp later: the run goes on from there, if it does.
    """
    end = e.t
    e.t = r.late
    r.late = -math.inf
    status = settle_now(e, r, GUARD)
    if r.instant.steps == 0:
        e.t = end
    return status


def settle_now(e: Engine, r: Run, cause: int) -> int:
    """Settle the present instant, and report what changed."""
    if e.model.method == MOREAU:
        return settle_in_steps(e, r, cause)
    i = r.instant
    if cause == GUARD and events_held(e, r):
        return switches_back(e, r)
    begin_instant(i, min(e.t, e.until), cause)
    if cause != START:
        keep_left(e, r.report)
    if e.model.laws > 0:
        e.laws.sweep = r.idle >= VAIN
    before_event(e)
    if settle(e, r.settling, i) != OK:
        return REFUSED
    settled = i.steps > 0
    if settled:
        observe_event(e, i)
        hold_apart(e, i)
    # where nothing changed there was no instant
    e.checks.foreseen = e.checks.foreseen and settled
    for k in range(e.states):
        r.before[k] = e.landings.before[k]
    if slide_after(e, i, r.before) != OK:
        return REFUSED
    report_slide(e, r.report)
    if i.steps > 0:
        r.cut = False
        r.event_at[r.events % (IDLE + 1)] = e.t
        r.events += 1
        report_event(e, r.report, i)
    r.vain = cause == LAW and not settled
    if settled or (cause != GUARD and cause != LAW):
        r.idle = 0
        begin_count(e, r)
    elif cause == GUARD:
        r.idle_at[r.idle % (IDLE + 1)] = e.t
        r.idle += 1
        if r.idle > IDLE and e.t - r.idle_at[r.idle % (IDLE + 1)] <= MOMENT * e.span:
            why = "a guard holds again and again, and nothing changes"
            if e.model.tells != 0:
                return in_vain(e, why)
            return say_fault(e, "HB-N406", why, "")
    if r.events > e.model.max_events:
        return say_fault(e, "HB-N404", "too many events", "")
    return OK


def rest_now(e: Engine, r: Run) -> int:
    """Land what was hit and does not rebound: time goes on from the limit of its impacts."""
    landed = 1
    while landed > 0:
        if e.landings.touches == 0:
            return OK
        landed = land_contacts(e, r.settling, r.instant)
        if landed < 0:
            return REFUSED
        if landed > 0:
            r.cut = False
            r.events += 1
            report_event(e, r.report, r.instant)
    return OK


def flow(e: Engine, r: Run) -> int:
    """Let time pass in the mode; return why it ended, -1 if the run stops."""
    m = e.model
    if m.method == MOREAU:
        return flow_in_steps(e, r)
    g = r.locator
    r.cut = False
    if not r.flowing:
        again = begin_again(e, r)
        read_within(e, e.t, min(e.next_break, e.stop))
        if begin_flow(e, r) != OK:
            return -1
        if again:
            warm_up(e, r)
        if not r.vain and jumps_at_once(e, r):
            report_step(e, r.report)
            return LAW if count_step(e, r) == OK else -1
    r.flowing = False
    end = min(e.next_break, e.stop)
    instant = room_of_instant(e, e.t)
    while True:
        if r.slice == 0:
            r.flowing = True
            return PAUSED
        r.slice = r.slice - 1 if r.slice > 0 else r.slice
        if step(e, end) != OK:
            if begin_at_edge(e, r) == OK:
                continue
            stuck_at_kink(e, r)
            return -1
        if is_at_edge(e, r) and reach_edges(e, r):
            if go_from_edge(e, r) != OK:
                return -1
            continue
        if m.disks > 0 and follow(e) != OK:
            return -1
        if count_step(e, r) != OK:
            return -1
        g.held = False
        r.beyond = r.beyond + 1.0 if e.refusal else max(r.beyond - 0.1, 0.0)
        if e.refusal and r.beyond > BEYOND and m.edges == 0:
            return -1
        g.rough = not shows_instants(e)
        found = locate(e, g)
        g.rough = False
        if found != OK and find_within(e, g) != OK:
            if begin_at_edge(e, r) == OK:
                continue
            return -1
        at = g.at
        near = at < math.inf
        if at < math.inf:
            if m.kinks > 0:
                see_jump(e, r, at)
                see_crowd(e, r, at)
            g.held = True
            if land(e, g, instant, end, times_in_vain(r, at, instant)) != OK:
                if begin_at_edge(e, r) == OK:
                    continue
                stuck_at_kink(e, r)
                return -1
            at = g.at
            if at < math.inf and at >= end - instant:
                # one instant with the timed event: settled once, there
                at = math.inf
                if e.step.t1 < end:
                    g.looked = math.nan
                    if retry(e, end) != OK:
                        return -1
        if at == math.inf:
            shown = e.step.t1
            if shown >= end and shown - e.step.t0 >= instant:
                # what crosses its bound just after a timed event does so with it
                shown = last_of_instant(e, g, shown, shown + instant)
                near = near or shown != e.step.t1
                if g.failed:
                    return -1
            if doubt(e, g, e.step.t1) != OK:
                return -1
            if note(e, r, e.step.t1, shown) != OK:
                return -1
            r.late = shown if e.t >= e.until else -math.inf
            if e.step.t1 >= end:
                foresee(e, e.t)
                if e.next_break <= end:
                    return timed_cause(e)
                if not near and jumps_at_end(e, r):
                    return LAW
                r.cut = not near
                return GUARD if near else STOPPED
            if e.checks.looked == e.t:
                look_at_guards(e)
            rest_at_roots(e, r)
            if see_crawl(e, r) != OK or go_on(e) != OK:
                return -1
            continue
        if is_kink_alone(e, g):
            if end_at_kink(e, r, at) != OK:
                return -1
            if jumps_onto_storage(e, r, at):
                report_step(e, r.report)
                return LAW if count_kink(e, r) == OK else -1
            if note(e, r, e.step.t1, e.step.t1) != OK:
                return -1
            if count_kink(e, r) != OK:
                return -1
            rest_at_roots(e, r)
            if e.scale_energy == 0.0:
                start_scale(e, e.mode)  # nothing has moved yet, but may do from here
            if start(e, e.t, e.y, bound_of(e), True) != OK:
                return -1
            continue
        if note(e, r, at, at) != OK:
            return -1
        if m.disks > 0 and lead_to_rest(e, r, end) != OK:
            return -1
        end_pace(e, at)
        timed = e.t >= end and e.next_break <= end
        foresee(e, min(at + instant, end))
        return timed_cause(e) if timed else GUARD


def times_in_vain(r: Run, at: float, instant: float) -> int:
    """Return how often a guard held at this instant already, and nothing changed."""
    if r.idle == 0 or at - r.idle_at[(r.idle - 1) % (IDLE + 1)] > instant:
        return 0
    return r.idle


def begin_flow(e: Engine, r: Run) -> int:
    """Make ready for time to pass in the mode."""
    m = e.model
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return REFUSED
    report_slide(e, r.report)
    look_at_entry(e)
    if hold_bounds(e) != OK:
        return REFUSED
    if m.laws > 0 and m.tells != 0:
        warn_of_held(e)
    watch(e, r.locator, e.state)
    if limits_vary(m) and look_at_limits(e) != OK:
        return REFUSED
    begin_field(e, e.mode)
    if m.disks > 0:
        begin_slips(e, e.t, e.y)
        begin_field(e, e.mode)
    if e.slide.k == 0:
        start_scale(e, e.mode)
    take_rates(e, e.mode)
    r.beyond = 0.0
    return start(e, e.t, e.y, bound_of(e), True)


def follow(e: Engine) -> int:
    """Repeat a step shorter until it follows slip in the plane."""
    for _ in range(SHORTER):
        if follows_slip(e):
            return OK
        h = 0.25 * (e.step.t1 - e.step.t0)
        if e.step.t0 + h == e.step.t0:
            if e.model.tells != 0:
                return no_slip(e)
            return say_fault(e, "HB-N408", "no step follows the slip", "")
        if retry(e, e.step.t0 + h) != OK:
            return REFUSED
    return OK


def is_at_edge(e: Engine, r: Run) -> bool:
    """Whether an edge has made a step as short as what is no time away from it; once at a time."""
    s = e.step
    short = s.t1 - s.t0 < time_at_once(e)
    near = e.model.edges > 0 and e.refusal and short and r.edge_at != e.t
    return near and not is_driven_on(e, r)


def begin_at_edge(e: Engine, r: Run) -> int:
    """Begin anew where a root in a law comes to nothing, if that is now."""
    if is_driven_on(e, r) or not reach_edges(e, r):
        return REFUSED
    return go_from_edge(e, r)


def is_driven_on(e: Engine, r: Run) -> bool:
    """Whether edges follow each other at once: what is led beyond where laws have values."""
    return r.edges > EDGES and e.t - r.edge_t <= time_at_once(e)


def go_from_edge(e: Engine, r: Run) -> int:
    """Note the way to the edges that was gone, in the time that it takes, and begin there."""
    if count_step(e, r) != OK:
        return REFUSED
    r.edges = r.edges + 1 if e.t - r.edge_t <= time_at_once(e) else 0
    r.edge_t = e.t
    if straight_on(e, r) and note(e, r, e.step.t1, e.step.t1) != OK:
        return REFUSED
    r.edge_at = e.t
    return start(e, e.t, e.y, bound_of(e), True)


def lead_to_rest(e: Engine, r: Run, end: float) -> int:
    """Lead slip in the plane to its end, if it is about to end."""
    m = e.model
    p = e.planar
    if not begin_descent(e, e.t, e.y):
        return OK
    p.leading = True
    watch(e, r.locator, e.state)
    p.leading = False
    begin_field(e, e.mode)
    while e.t < end:
        found = step_descent(e, e.t, e.y, end)
        if found == ENDLESS:
            return REFUSED
        if found == IS_DOWN or e.step.t1 == e.step.t0:
            break
        r.locator.held = False
        if locate(e, r.locator) != OK:
            return REFUSED
        if r.locator.at < math.inf:
            for d in range(m.disks):
                p.ends[d] = 0
            if note(e, r, r.locator.at, r.locator.at) != OK:
                return REFUSED
            break
        if note(e, r, e.step.t1, e.step.t1) != OK:
            return REFUSED
        if any_ends(e):
            break
    end_descent(e, e.t, e.y)
    return OK


def note(e: Engine, r: Run, t: float, shown: float) -> int:
    """Note a step that ends at `t`, with the state at `shown`, put back on its constraints.

    The two are one instant.
    """
    m = e.model
    for k in range(e.states):
        e.y[k] = e.step.y1[k]
    if shown != e.step.t1:
        between(e, shown, e.y)
    if put_before_kink(e, r, t) != OK:
        return REFUSED
    if e.slide.k > 0 and onto_surfaces(e, t, e.y) != OK:
        return REFUSED
    keep_still(e, e.y)
    if m.laws > 0:
        set_state(e, e.mode, e.shown, t, e.y)
        observe(e, e.shown)
    if m.disks > 0:
        arm_slips(e, t, e.y)
    e.t = t
    if t > r.resumed:
        report_step(e, r.report)
    look_now_and_then(e)
    if hold_bounds(e) != OK:
        return REFUSED
    if limits_vary(m) and look_at_limits(e) != OK:
        return REFUSED
    return OK


def go_on(e: Engine) -> int:
    """Tell the solver of a state that was put back on its constraints: no jump, no history."""
    for k in range(e.states):
        if e.y[k] != e.step.y1[k]:
            return start(e, e.t, e.y, e.until, False)
    return OK
