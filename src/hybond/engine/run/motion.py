"""The executive: time passes in a mode until something happens, then the mode is settled.

Nothing else changes the state: a jump is made by settling alone.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.checks.bounds_held import hold_bounds
from hybond.engine.checks.energy_held import hold_last_rates, hold_rates
from hybond.engine.checks.guards_held import (
    foresee,
    hold_apart,
    keep_foreseen,
    look_at_guards,
)
from hybond.engine.checks.laws_held import look_at_entry, look_at_laws
from hybond.engine.contacts.impacts_seen import before_event, observe_event
from hybond.engine.contacts.in_turn import NONE_RESTS, RESTED, land_in_turn
from hybond.engine.contacts.landing import land_contacts, stuck
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.guards.ends_at_guard import find_within, land, shows_instants
from hybond.engine.guards.guard_values import doubt, see_where_it_begins
from hybond.engine.guards.kept_rests import begin_rests, let_hold, none_holds
from hybond.engine.guards.limits_crossed import see_stood
from hybond.engine.guards.locate import locate
from hybond.engine.guards.rests_asked import see_rests_at_end
from hybond.engine.guards.together import is_kink_alone, is_of_time, last_at_end
from hybond.engine.guards.unresolved import forget_carried, see_unresolved
from hybond.engine.guards.watching import watch
from hybond.engine.inputs.interval import interval_after, read_within
from hybond.engine.instant.doubts import warn_of_held
from hybond.engine.instant.instant import GUARD, LAW, START, TIME, begin_instant
from hybond.engine.instant.settle import settle
from hybond.engine.jumps.tied import begin_tied
from hybond.engine.laws.branches import know_around
from hybond.engine.laws.gaps_left import forget_gaps, keep_gaps, take_up_gaps
from hybond.engine.laws.laws import limits_vary, look_at_limits
from hybond.engine.method_numbers import MOREAU
from hybond.engine.methods.control import end_pace
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.implicit.stiffness import watch_cut
from hybond.engine.methods.off_kinks import lead_off_kinks
from hybond.engine.methods.stepping import retry, start, step
from hybond.engine.methods.tolerances.along_surfaces import begin_scale
from hybond.engine.mode.comparisons.standing import any_stands, find_standing
from hybond.engine.mode.comparisons.straight_rates import take_rates
from hybond.engine.mode.digits.part_energies import join_parts
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.planar.stops import begin_slips
from hybond.engine.run.carried import begin_again, cause_of_beginning, take_up, warm_up
from hybond.engine.run.contradictions import contradict_behind, meet_contradiction
from hybond.engine.run.courses_ahead import begin_courses, end_ahead
from hybond.engine.run.edges import reach_edges, rest_where_steps_crowd
from hybond.engine.run.edges_met import begin_at_edge, go_from_edge, is_at_edge
from hybond.engine.run.ends_at_kink import ANEW, left_at_end, meet_kink, pass_kink, see_gaps
from hybond.engine.run.ever_more import outruns, refuse_outrun
from hybond.engine.run.guard_at_kink import is_over_kink
from hybond.engine.run.jumps_ahead import end_at_jump
from hybond.engine.run.kinks_passed import (
    accumulates_at_kink,
    held_at_kink,
    see_crawl,
    see_crowd,
    see_jump,
    stuck_at_kink,
    switches_back,
)
from hybond.engine.run.level_jumps import end_where_levels_jump
from hybond.engine.run.log import (
    keep_left,
    report_end,
    report_event,
    report_slide,
    report_step,
)
from hybond.engine.run.noted import go_on, note, tell_at_end
from hybond.engine.run.rests_ahead import end_before_rest
from hybond.engine.run.roots_followed import begin_to_follow, follow_roots
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
    last_in_vain,
    take_locator,
    timed_cause,
    times_in_vain,
)
from hybond.engine.run.slid_at_limit import NONE_SLIDES, slide_at_limit
from hybond.engine.run.slips_followed import follow, lead_to_rest
from hybond.engine.run.source_jumps import jumps_at_end, jumps_at_once
from hybond.engine.run.step_motion import flow_in_steps, settle_in_steps
from hybond.engine.run.stranded import in_vain
from hybond.engine.run.struck_at_kink import forget_bonds
from hybond.engine.sliding.sliding import slide_after
from hybond.engine.surfaces.led_by_bonds import combine_led
from hybond.engine.surfaces.values import begin_field, field

VAIN: Final = 3
"""Instants in a row without any change after which rounding is swept out of what is stored."""
MOMENT: Final = 1e-13
"""What counts as no time for all of them together, as a part of the run."""
BEYOND: Final = 50.0
"""Steps that may touch a place where a law has no value before the law is blamed: one in ten, and
this many at once."""
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
        status = settle_late(e, r, cause) if r.late > e.t else settle_now(e, r, cause)
        if status == OK:
            status = rest_now(e, r)
        if status == OK and stuck(e):
            status = rest_in_turn(e, r)
        r.slice = r.slice - 1 if r.slice > 0 else r.slice
    if status != REFUSED:
        if mode_of(e, e.state) == OK and combine_led(e, e.state) == OK:
            look_at_laws(e)
            keep_gaps(e)
            if r.cut:
                hold_last_rates(e)
            status = status if hold_bounds(e) == OK else REFUSED
        tell_at_end(e)
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
    e.standing.goes_on = e.standing.goes_on and cause == TIME
    if cause == TIME and e.model.method != MOREAU:
        # what was settled there is not settled again
        if e.slide.many > 0:
            know_around(e, e.state)
        report_slide(e, r.report)
        return OK
    r.warm = False
    take_up_gaps(e, r.remembers and cause != START, cause == START)
    status = settle_now(e, r, cause)
    if e.model.laws > 0:
        e.laws.gaps_given = False
    return rest_now(e, r) if status == OK else status


def settle_late(e: Engine, r: Run, cause: int) -> int:
    """Settle the instant at the end of the run, at the last of the times that it lasts.

    A sawtooth that begins anew there does so an ulp later: the run goes on from there, if it does.
    """
    end = e.t
    e.t = r.late
    r.late = -math.inf
    status = settle_now(e, r, cause)
    if r.instant.steps == 0:
        e.t = end
    return status


def settle_now(e: Engine, r: Run, cause: int) -> int:
    """Settle the present instant, and report what changed."""
    if e.model.method == MOREAU:
        return settle_in_steps(e, r, cause)
    i = r.instant
    if held_at_kink(e, r, cause) != OK:
        return REFUSED
    begin_instant(i, min(e.t, e.until), cause)
    if cause != START:
        keep_left(e, r.report)
        see_gaps(e, r)
    if e.model.laws > 0:
        e.laws.sweep = r.idle >= VAIN
    before_event(e)
    if settle(e, r.settling, i) != OK:
        return REFUSED
    forget_gaps(e)
    forget_bonds(e)
    settled = i.steps > 0
    if settled:
        observe_event(e, i)
        hold_apart(e, i)
    keep_foreseen(e, i)
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
        if outruns(e, r):
            return refuse_outrun(e, r)
    see_stood(e, r.locator, i.steps > 0, cause == GUARD)
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


def rest_in_turn(e: Engine, r: Run) -> int:
    """Put contacts to rest that strike in turn, or slide; ACCUMULATES if the events are no such."""
    landed = land_in_turn(e, r.settling, r.instant)
    if landed < 0:
        return REFUSED
    if landed == RESTED:
        return OK
    if landed == NONE_RESTS:
        slid = slide_at_limit(e, r.instant)
        if slid < 0:
            return REFUSED
        if slid == NONE_SLIDES:
            return switches_back(e, r) if accumulates_at_kink(e, r) else ACCUMULATES
        report_slide(e, r.report)
    r.cut = False
    r.events += 1
    report_event(e, r.report, r.instant)
    return OK


def flow(e: Engine, r: Run) -> int:
    """Let time pass in the mode; return why it ended, -1 if the run stops."""
    m = e.model
    if m.method == MOREAU:
        return flow_in_steps(e, r)
    r.cut = False
    if not r.flowing:
        begun = begin_to_flow(e, r)
        if begun != OK:
            return begun
    g = r.locator
    r.flowing = False
    end = min(e.next_break, e.stop)
    instant = room_of_instant(e, e.t)
    while True:
        if r.slice == 0:
            r.flowing = True
            return PAUSED
        r.slice = r.slice - 1 if r.slice > 0 else r.slice
        taken = take_step(e, r, end)
        if taken == ANEW:
            continue
        if taken != OK:
            return -1
        follow_roots(e)
        # what is tied to sources is known there in closed form, on its constraints
        g.held = g.tied
        g.rough = not (g.tied or shows_instants(e))
        found = locate(e, g)
        g.rough = False
        if found != OK and find_within(e, g) != OK:
            if begin_at_edge(e, r) == OK:
                continue
            return -1
        at = g.at
        near = at < math.inf
        if at < math.inf:
            if m.kinks + m.slide_kinks > 0:
                see_jump(e, r, at)
                see_crowd(e, r, at)
                if contradict_behind(e, r, at):
                    passed = meet_contradiction(e, r, at)
                    if passed == ANEW:
                        continue
                    return passed
            g.held = True
            tries = times_in_vain(r, instant)
            if land(e, g, instant, end, last_in_vain(r), tries) != OK:
                if begin_at_edge(e, r) == OK:
                    continue
                stuck_at_kink(e, r)
                return -1
            at = g.at
            if at < math.inf and none_holds(e, g, at):
                at = math.inf
                near = False
            if at < math.inf and at >= end - instant:
                # one instant with the timed event: settled once, there
                at = math.inf
                if e.step.t1 < end:
                    g.looked = math.nan
                    if retry(e, end) != OK:
                        return -1
        if at == math.inf:
            shown = e.step.t1
            r.late = -math.inf
            if shown >= end and shown - e.step.t0 >= instant:
                # what crosses its bound just after a timed event does so with it
                shown = last_at_end(e, g, shown, shown + instant)
                near = near or shown != e.step.t1
                if g.failed:
                    return -1
            if shown > e.until and is_of_time(e, g, e.until, shown):
                r.late = shown
            if doubt(e, g, e.step.t1) != OK:
                return -1
            if near:
                let_hold(e, g, shown)
            if note(e, r, e.step.t1, shown) != OK:
                return -1
            if e.step.t1 >= end:
                see_unresolved(e, g, e.step.t1)
                foresee(e, e.t)
                # a kink that is just there is none within the step, nor within the next one
                left = left_at_end(e, r)
                if e.next_break <= end:
                    see_rests_at_end(e, g)
                    return timed_cause(e)
                if not near and (left or e.slide.parts_now or jumps_at_end(e, r)):
                    return LAW
                r.cut = not near
                return GUARD if near else STOPPED
            if e.checks.looked == e.t and e.checks.shown_at == e.t:
                look_at_guards(e)
            rest_at_roots(e, r)
            rest_where_steps_crowd(e, r)
            if e.slide.parts_now:
                return LAW
            if see_crawl(e, r) != OK or go_on(e) != OK:
                return -1
            continue
        if is_kink_alone(e, g):
            passed = pass_kink(e, r, at)
            if passed != ANEW:
                return passed
            if rest_where_steps_crowd(e, r) and go_on(e) != OK:
                return -1
            continue
        if is_over_kink(e, g, at):
            passed = meet_kink(e, r, at)
            if passed == ANEW:
                continue
            if passed != GUARD:
                return passed
            at = g.at
        see_unresolved(e, g, at)
        let_hold(e, g, at)
        if note(e, r, at, at) != OK:
            return -1
        if m.disks > 0 and lead_to_rest(e, r, end) != OK:
            return -1
        end_pace(e, at)
        watch_cut(e)
        timed = e.t >= end and e.next_break <= end
        foresee(e, min((g.began if at - g.began <= instant else at) + instant, end))
        return timed_cause(e) if timed else GUARD


def begin_to_flow(e: Engine, r: Run) -> int:
    """Begin where an instant ended; LAW if a source jumps there, -1 if the run stops."""
    again = begin_again(e, r)
    read_within(e, e.t, min(e.next_break, e.stop))
    if begin_flow(e, r) != OK:
        return -1
    if again:
        warm_up(e, r)
    if not r.vain and jumps_at_once(e, r):
        report_step(e, r.report)
        return LAW if count_step(e, r) == OK else -1
    return OK


def take_step(e: Engine, r: Run, end: float) -> int:
    """Take a step no further than `end`; ANEW if it ends at an edge, -1 if the run stops."""
    m = e.model
    soon = end_before_rest(e, r, end_ahead(e, end) if m.courses > 0 else end)
    soon = end_at_jump(e, soon)
    if step(e, soon) != OK:
        if begin_at_edge(e, r) == OK:
            return ANEW
        stuck_at_kink(e, r)
        return -1
    if is_at_edge(e, r) and reach_edges(e, r):
        return ANEW if go_from_edge(e, r) == OK else -1
    if m.disks > 0 and follow(e) != OK:
        return -1
    if end_where_levels_jump(e) != OK:
        return -1
    if count_step(e, r) != OK:
        return -1
    r.locator.held = False
    r.beyond = r.beyond + 1.0 if e.refusal else max(r.beyond - 0.1, 0.0)
    return -1 if e.refusal and r.beyond > BEYOND and m.edges == 0 else OK


def begin_flow(e: Engine, r: Run) -> int:
    """Make ready for time to pass in the mode."""
    m = e.model
    if mode_of(e, e.state) != OK or combine_led(e, e.state) != OK:
        return REFUSED
    join_parts(e, e.mode)
    report_slide(e, r.report)
    e.checks.shown_at = -math.inf
    if m.disks > 0:
        # what is looked at is what moves on: slip that begins has the direction of its heading
        begin_field(e, e.mode)
        begin_slips(e, e.t, e.y)
    look_at_entry(e)
    if hold_bounds(e) != OK:
        return REFUSED
    if m.laws > 0 and m.tells != 0:
        warn_of_held(e)
    take_locator(e, r)
    if m.laws > 0 and e.slide.k == 0:
        see_where_it_begins(e)
    watch(e, r.locator, e.state)
    r.locator.tied = begin_tied(e, e.t, e.y)
    if limits_vary(m) and look_at_limits(e) != OK:
        return REFUSED
    begin_field(e, e.mode)
    begin_to_follow(e, r.warm)
    begin_scale(e, e.mode)
    take_rates(e, e.mode)
    forget_carried(e)
    see_standing(e)
    r.beyond = 0.0
    if m.courses > 0:
        begin_courses(e, r.locator.reads)
    begin_rests(e)
    begun = start(e, e.t, e.y, bound_of(e), True)
    e.standing.goes_on = False
    if begun == OK:
        hold_rates(e)
        lead_off_kinks(e)
    return begun


def see_standing(e: Engine) -> None:
    """Find what stands in the motion that begins; nothing along surfaces, or where discs slip."""
    if e.slide.k > 0 or e.model.disks > 0:
        return
    if e.standing.goes_on:
        e.standing.some = any_stands(e.standing, e.model.storages)
        return
    refused = e.refusal
    asked = e.evaluations
    hold_guess(e, e.mode)
    if field(e, e.mode, e.t, e.y, e.step.rate) == OK:
        find_standing(e, e.step.rate)
    give_back_guess(e, e.mode)
    e.refusal = refused
    e.evaluations = asked
