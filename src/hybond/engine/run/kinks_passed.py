"""Kinks of laws, sources and rates: a step ends there, and nothing happens.

A law that jumps there and drives back to where it came from would slide; it is refused.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.answers import node_name, stored_name
from hybond.engine.contacts.accumulation import push_time, since_start
from hybond.engine.contacts.landing_records import LAST_TIMES
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import atom_at, has_crossed, holds_at, show, terms_here
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, NONE, Locator
from hybond.engine.guards.naps import LONGEST_NAP, pass_step
from hybond.engine.guards.together import LAST_PLACES, before_kink, kink_of, kink_there
from hybond.engine.instant.instant import GUARD, LAW
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.stepping import between, by_radau, reach, retry
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.model import Model
from hybond.engine.reasons.facts import add_fact
from hybond.engine.run.held_by_kinks import (
    JUMPS,
    SEEN,
    compared_by,
    dust_of_rate,
    is_held,
)
from hybond.engine.run.run_records import IDLE, PATIENCE, Run
from hybond.engine.surfaces.averages import solve_read_here
from hybond.engine.surfaces.values import field, set_motion

BACK_AT_ONCE: Final = 1e-9
"""Part of the run in which so many kinks as instants that end it are one that leads nowhere."""
BACK: Final = 3
"""Kinks in a row with a jump behind which the way leads back, so that nobody gets past it."""
SOON_BACK: Final = 1e-3
"""Part of it after a kink in which that is to blame for steps that become too small."""
NEXT_TO: Final = 1e-3
"""Part of a step after which a kink is next to where the step began."""
CROWD: Final = 8
"""So many of those in a row are rounding of what is compared, or a place that is all kinks."""
FEW_STEPS: Final = 3
"""Steps between two kinks that are too few to follow what turns there ..."""
DENSE: Final = 32
"""... if that goes on for so many kinks: what a law like a root has brought to rest swings about
zero by the error of the steps, which sees what the kink does."""
NO_NEARER: Final = 0.5
"""Part of the way to a kink that is left behind a step which has led to it in vain."""
LONGEST_WAIT: Final = 64
"""Kinks after which it is asked again whether one holds the motion, at the most."""
CRAWL: Final = 1e-6
"""Part of the run that a step is which leads nowhere."""
SOONER: Final = 1.0 / 32.0
"""Part of that way after which it is asked where rates lead, too: what is compared may turn."""
SHRINKS: Final = 0.9
"""What a flight and the one back take at most, as a part of the two before, ..."""
STEADY: Final = 0.01
"""... by how much of itself that may vary: of those that just happen to be ever shorter it does;
..."""
AT_LIMIT: Final = 1e-6
"""... and of the time that is left to their limit then. Of contacts it may be a tenth, but steps of
laws are no shorter than about that."""
FADES: Final = "instants at which its law jumps come ever faster, to a limit,"
ASIDE: Final = 0.25
"""Part of the way to an end of the step, on either side of a kink, at which rates are compared."""


def end_at_kink(e: Engine, r: Run, at: float) -> int:
    """End the step just behind a kink; REFUSED where it leads nowhere.

    Where only far shorter steps lead there, it ends before, and the run makes them. What is behind
    the kink must not show before it. Where the two are one instant, the step ends before the kink,
    and is carried over by the rates there: the next one begins behind it.
    """
    g = r.locator
    passed = kink_there(e, g)
    if passed != NONE:
        r.kink = kink_of(e, g, passed)
    r.kink_guard = passed
    before = before_kink(e, g, at)
    behind = at + LAST_PLACES * spacing(at)
    room = room_of_instant(e, at)
    apart = before <= e.step.t0 or behind - before > room
    for k in range(g.guards):
        g.done[k] = 1 if g.side[k] != NO_KINK and holds_at(e, g, k, at) else 0
    refusal = e.refusal
    made = retry(e, at if apart else before)
    if made != OK and by_radau(e) and e.step.off > 1.0:
        e.refusal = refusal
        return OK
    if made == OK and e.step.off > 1.0 and (not apart or before - e.step.t0 > room):
        made = end_out_of_sight(e, before, behind)
        before = e.step.t1
        apart = behind - before > room
        r.told = r.told and not apart  # it is not there yet
    if made != OK:
        return stuck_at_kink(e, r)
    if not apart:
        carry_over_kink(e, r, behind - before)
    return OK


def end_out_of_sight(e: Engine, before: float, behind: float) -> int:
    """Let the step end where no stage of it has seen the jump, or at `before` where each has.

    One at the end of the step may be a last place beyond what is compared at that time. What a long
    step says of where the kink is may be off by more than an instant: then the step ends farther
    before it, and the next one, which is shorter, meets it.
    """
    refusal = e.refusal
    # where nothing that is compared shows the jump, what is behind may be where the step ends
    way = max(behind - before, LAST_PLACES * spacing(behind))
    made = retry(e, before) if e.step.t1 > before else OK
    while made == OK and e.step.off > 1.0 and behind - 2.0 * way > e.step.t0:
        way = 2.0 * way
        made = retry(e, behind - way)
    unseen = made == OK and e.step.off <= 1.0
    e.refusal = refusal
    return OK if unseen else retry(e, before)


def is_in_vain(e: Engine, r: Run) -> bool:
    """Whether a step has ended at a jump that seemed to lead back, and has come no nearer to it.

    What waits at a limit by next to nothing, as an integral that has stopped there, seems to pass
    it in a step that reaches over where it is let go: what the polynomial is off by does that.
    Implicit steps may be solved by either side of the jump, and where they begin at the limit by
    the wrong one.
    """
    if not (r.jumps and r.leads_back) or r.kink_guard == NONE or by_radau(e):
        return False
    g = r.locator
    refusal = e.refusal
    copy_floats(e.states, e.step.y0, g.y)
    before = compared_by(e, g, r.kink_guard, e.step.t0)
    copy_floats(e.states, e.step.y1, g.y)
    after = compared_by(e, g, r.kink_guard, e.step.t1)
    e.refusal = refusal
    return before * after > 0.0 and math.fabs(after) > NO_NEARER * math.fabs(before)


def carry_over_kink(e: Engine, r: Run, h: float) -> None:
    """Carry the end of the last step over for a time, longer where rounding swallows that."""
    g = r.locator
    refusal = e.refusal
    room = room_of_instant(e, e.step.t1)
    known = field(e, e.mode, e.step.t1, e.step.y1, r.rate) == OK
    passed = False
    straight = True
    h = 0.5 * h
    while known and straight and not passed and h < room:
        h = 2.0 * h
        for i in range(e.states):
            g.y[i] = e.step.y1[i] + h * r.rate[i]
        show(e, g, ALL_PARTS)
        set_motion(e, e.v, e.step.t1 + h, g.y)
        known = solve_read_here(e, e.mode, g.reads, e.v) == OK
        passed = known and has_passed(e, g)
        # twice as far, rates would be others: what is that fast is left to the next step
        straight = passed or leads_straight_on(e, r, h)
    for i in range(e.states if known else 0):
        e.step.y1[i] = g.y[i]
    e.refusal = refusal
    g.looked = math.nan
    if known:
        reach(e, e.step.t1 + h)


def leads_straight_on(e: Engine, r: Run, h: float) -> bool:
    """Whether rates stay what they are, within the tolerance of steps, for twice the time `h`."""
    g = r.locator
    hold_guess(e, e.mode)
    straight = field(e, e.mode, e.step.t1 + h, g.y, r.beside) == OK
    give_back_guess(e, e.mode)
    for i in range(e.states if straight else 0):
        off = 2.0 * h * math.fabs(r.beside[i] - r.rate[i])
        straight = straight and off <= max(e.step.scale[i], ROUNDING * math.fabs(g.y[i]))
    return straight


def has_passed(e: Engine, g: Locator) -> bool:
    """Whether a kink that has ended the step is behind, at the values of the motion."""
    passed = False
    for k in range(g.guards):
        passed = passed or (g.done[k] != 0 and has_crossed(e, g, k))
    return passed


def count_kink(e: Engine, r: Run) -> int:
    """Count the kink that the step just noted has ended at; REFUSED if it leads nowhere."""
    r.kink_at[r.kinks % (IDLE + 1)] = e.t
    r.kinks += 1
    if r.told:
        r.back = r.back + 1 if r.leads_back else 0
    if r.jumps and r.back >= BACK:
        return switches_back(e, r)
    if r.crowd >= CROWD:
        if is_held(e, r):
            return switches_back(e, r)
        r.locator.asleep = r.nap
        r.nap = min(2 * r.nap, LONGEST_NAP)
        return OK
    first = r.kink_at[(r.kinks - 1 - DENSE) % (IDLE + 1)] if r.kinks > DENSE else -math.inf
    if r.dense >= DENSE and all_go_on(e.model) and e.t - first <= SOON_BACK * e.span:
        if is_held(e, r):
            return switches_back(e, r)
        r.locator.asleep = r.lull
        r.lull = min(2 * r.lull, LONGEST_NAP)
        r.dense = 0
        return OK
    lately = e.t - r.kink_at[r.kinks % (IDLE + 1)] if r.kinks > IDLE else math.inf
    if r.jumps and lately <= BACK_AT_ONCE * e.span:
        return switches_back(e, r)
    if lately > SOON_BACK * e.span:
        r.hold_waits = 1
        return OK
    if r.kinks < r.hold_due:
        return OK
    # what goes on passing kinks is asked ever more rarely whether one holds it
    r.hold_due = r.kinks + r.hold_waits
    r.hold_waits = min(2 * r.hold_waits, LONGEST_WAIT)
    return switches_back(e, r) if is_held(e, r) else OK


def all_go_on(m: Model) -> bool:
    """Whether laws have values beyond all edges, as where a valve shuts: steps may pass them."""
    on = True
    for k in range(m.edges):
        on = on and m.edge_met[k] != 0
    return on


def is_crowded(e: Engine, r: Run) -> bool:
    """Whether kinks are so many in next to no part of the run that a moment passes many."""
    return r.kinks > IDLE and e.t - r.kink_at[r.kinks % (IDLE + 1)] <= SOON_BACK * e.span


def events_held(e: Engine, r: Run) -> bool:
    """Whether a kink that a law jumps at has ended in one event after the other.

    Friction that a junction has, beside a law that jumps at rest as well, changes its way each time
    that the motion is driven back: neither of them holds it alone. A diode may open each time in
    vain, and let go what rounding left behind the kink.
    """
    many = IDLE + 1
    if e.model.kinks == 0:
        return False
    # an odd number: where two modes take turns, either is looked at
    if r.events >= many and r.events % many == 0:
        if e.t - r.event_at[r.events % many] <= SOON_BACK * e.span and is_held(e, r):
            return True
    if r.idle < many or r.idle % many != 0:
        return False
    return e.t - r.idle_at[r.idle % many] <= SOON_BACK * e.span and is_held(e, r)


def held_at_kink(e: Engine, r: Run, cause: int) -> int:
    """Refuse an instant where events lead nowhere, or come to the limit of ever shorter flights."""
    if cause == GUARD and events_held(e, r):
        return switches_back(e, r)
    if cause == LAW:
        r.flown = push_time(r.flights, r.flown, 0, e.t)
        if flights_fade(e, r):
            node = e.model.kink_node[r.kink] if r.kink >= 0 else -1
            place = node_name(e.model, node) if node >= 0 else ""
            say_fault(e, "HB-N410", FADES, place)
            return REFUSED
    return OK


def flights_fade(e: Engine, r: Run) -> bool:
    """Whether instants at which what is stored jumps with a law have come to their limit.

    A yo-yo whose string winds up on the other side turns back each time, and loses a part of its
    speed as the modulus jumps. There and back, which may differ, take less by one ratio; beyond the
    limit nothing is left but the error of steps, which goes on for ever.
    """
    if r.flown < LAST_TIMES:
        return False
    t = r.flights
    last = LAST_TIMES - 1
    lasts = t[last] - t[last - 2]
    ratio = lasts / (t[last - 2] - t[last - 4])
    if not (lasts > 0.0 and ratio < SHRINKS):
        return False
    for k in range(last // 2 - 1):
        both = t[2 * k + 4] - t[2 * k + 2]
        if not math.fabs(both - ratio * (t[2 * k + 2] - t[2 * k])) <= STEADY * both:
            return False
    return lasts * ratio <= AT_LIMIT * since_start(t[last], e.span) * (1.0 - ratio)


def accumulates_at_kink(e: Engine, r: Run) -> bool:
    """Whether events that come ever faster are those of a law that a kink drives back each time."""
    return e.model.kinks > 0 and is_held(e, r)


def see_crawl(e: Engine, r: Run) -> int:
    """Count the step just noted if it is next to nothing; REFUSED if a kink holds the motion.

    Errors of steps that reach over a jump keep them so short, or end them so close to it, that no
    step is seen to begin on one side and to end on the other.
    """
    pass_step(r.locator)
    r.since += 1 if r.locator.asleep == 0 else 0
    if e.model.kinks == 0 or e.step.t1 - e.step.t0 > CRAWL * e.span:
        r.crawled = 0
        r.patience = PATIENCE
        return OK
    r.crawled += 1
    if r.crawled < r.patience:
        return OK
    r.patience = 2 * r.patience
    return switches_back(e, r) if is_held(e, r) else OK


def see_crowd(e: Engine, r: Run, at: float) -> None:
    """Count kinks in a row that are found next to where the step begins.

    A flow that follows the root of next to nothing has digits for half of what it is made of: its
    sign is that of rounding, and would end step after step. Nothing jumps there: the error of the
    step sees what such a kink does.
    """
    passed = kink_there(e, r.locator)
    if passed != NONE and r.locator.timed[passed] != 0:
        return
    if r.jumps or r.since > FEW_STEPS:
        r.dense = 0
        r.lull = 1
    else:
        r.dense += 1
    r.since = 0
    near = at - e.step.t0 <= NEXT_TO * (e.step.t1 - e.step.t0)
    if near and not r.jumps:
        r.crowd += 1
        return
    r.crowd = 0
    r.nap = 1


def see_jump(e: Engine, r: Run, at: float) -> None:
    """See whether rates jump at a kink, into `r.jumps`, where there is room to tell.

    A step may see a kink that the next one sees again: it is counted where one ends at it.
    """
    reach = ASIDE * min(at - e.step.t0, e.step.t1 - at)
    passed = kink_there(e, r.locator)
    r.told = passed != NONE
    if not r.told:
        return  # a guard
    kink = kink_of(e, r.locator, passed)
    if e.model.kink_meets[kink] != 0:
        r.jumps = False
        r.leads_back = False
        return
    r.told = 0.25 * reach > room_of_instant(e, at)
    if not r.told:
        return  # so near, rounding speaks; what was seen last holds
    refusal = e.refusal
    known = True
    for k in range(4):
        way = reach * (1.0 if k % 2 == 0 else -1.0) * (1.0 if k < 2 else 0.25)
        between(e, at + way, r.locator.y)
        known = known and field(e, e.mode, at + way, r.locator.y, r.rate) == OK
        for i in range(e.states):
            r.beside[k * e.states + i] = r.rate[i]
    r.locator.looked = math.nan
    e.refusal = refusal
    jumped = r.jumps
    r.jumps = False
    for i in range(e.states if known else 0):
        if math.fabs(r.beside[2 * e.states + i]) <= dust_of_rate(e, i):
            if math.fabs(r.beside[3 * e.states + i]) <= dust_of_rate(e, i):
                continue
        wide = math.fabs(r.beside[i] - r.beside[e.states + i])
        near = math.fabs(r.beside[2 * e.states + i] - r.beside[3 * e.states + i])
        size = math.fabs(r.beside[2 * e.states + i]) + math.fabs(r.beside[3 * e.states + i])
        r.jumps = r.jumps or (near > JUMPS * wide and near > SEEN * size)
    if r.jumps and is_lost_in_rounding(e, r, kink, at, reach):
        r.told = False
        r.jumps = jumped
        return
    r.leads_back = r.jumps and leads_back(e, r, at, reach)


def is_lost_in_rounding(e: Engine, r: Run, kink: int, at: float, reach: float) -> bool:
    """Whether what is compared at a kink moves by no more than its rounding from side to side.

    Then rates differ by rounding as well: of levels that are the same but for their last places,
    what flows between them has few digits.
    """
    g = r.locator
    refusal = e.refusal
    hold_guess(e, e.mode)
    moved = math.inf
    rounding = 0.0
    for k in range(g.guards):
        a = g.atom_first[k]
        if g.side[k] != NO_KINK and kink_of(e, g, k) == kink:
            moved = atom_at(e, g, a, at + reach)
            moved = math.fabs(moved - atom_at(e, g, a, at - reach))
            rounding = ROUNDING * terms_here(e, g, k, a)
    give_back_guess(e, e.mode)
    e.refusal = refusal
    g.looked = math.nan
    return moved <= rounding


def leads_back(e: Engine, r: Run, at: float, reach: float) -> bool:
    """Whether the rates behind a kink lead back to it, from what the step makes of its end.

    What is compared may jump itself, as where ``mod`` begins anew: then the kink is left behind,
    wherever the way leads. So is one to which the rates before it would lead as well, as the peak
    of a wave: it is not the jump that leads back. The rates a quarter of `reach` behind it are in
    the third row of `r.beside`, those before it in the fourth.
    """
    g = r.locator
    k = kink_there(e, g)
    if k == NONE:
        return False
    before = kink_between(e, g, k, at - reach)
    after = kink_between(e, g, k, at + reach)
    h = 0.25 * reach
    ahead = kink_between(e, g, k, at - h)
    beyond = kink_between(e, g, k, at + h)
    if math.fabs(beyond - ahead) > JUMPS * math.fabs(after - before):
        g.looked = math.nan
        return False
    copy_floats(e.states, g.y, r.after)
    back = beyond * (led_to(e, r, k, at + h, 2.0 * h, 2) - beyond) < 0.0
    back = back and beyond * (led_to(e, r, k, at + h, SOONER * h, 2) - beyond) < 0.0
    # the rates before it lead on from there
    back = back and not beyond * (led_to(e, r, k, at + h, 2.0 * h, 3) - beyond) < 0.0
    g.looked = math.nan
    return back


def led_to(e: Engine, r: Run, k: int, t: float, h: float, row: int) -> float:
    """Return what the kink of guard k compares where rates lead to in a time from `r.after`.

    They are those in a row of `r.beside`.
    """
    for i in range(e.states):
        r.locator.y[i] = r.after[i] + h * r.beside[row * e.states + i]
    return compared_by(e, r.locator, k, t + h)


def kink_between(e: Engine, g: Locator, k: int, t: float) -> float:
    """Return what the kink of guard k compares, at a time of the last step."""
    between(e, t, g.y)
    return compared_by(e, g, k, t)


def stuck_at_kink(e: Engine, r: Run) -> int:
    """Say of a step that is too small that it gets no farther than the kink just passed."""
    if e.refusal or e.model.kinks == 0:
        return REFUSED
    if is_held(e, r):
        return switches_back(e, r)
    if r.kinks == 0 or not r.jumps:
        return REFUSED
    if e.t - r.kink_at[(r.kinks - 1) % (IDLE + 1)] > SOON_BACK * e.span:
        return REFUSED
    return switches_back(e, r)


def switches_back(e: Engine, r: Run) -> int:
    """Refuse a jump inside a law that would slide."""
    m = e.model
    if r.jumping < 0:
        is_held(e, r)
    node = m.kink_node[r.kink] if r.kink >= 0 else -1
    place = node_name(m, node) if node >= 0 else ""
    why = "a jump of a law or a source switches back at once, again and again"
    if r.jumping < m.storages:
        return say_fault(e, "HB-N410", why, place)
    why = "the rate of a signal jumps and switches back at once, again and again"
    say_fault(e, "HB-N410", why, stored_name(m, r.jumping))
    if m.tells != 0:
        add_fact(e.fault, float(r.jumping - m.storages))
    return REFUSED
