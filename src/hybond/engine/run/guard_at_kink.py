"""A guard that holds at a kink: the step ends before the kink, and is carried over to the guard.

Where a law jumps just where a guard fires, as the weight of a block that rocks does where it lands,
a step that ends past the guard has stages behind the jump. What it says of the motion up to there
is off by as much as its error control lets pass. So it is repeated to end before the kink, of which
nothing shows then, and goes the rest of the instant by the rates there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import atom_at, holds_at, terms_here
from hybond.engine.guards.locator import NO_KINK, Locator
from hybond.engine.guards.naps import is_asleep
from hybond.engine.guards.together import LAST_PLACES
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import is_root, room_of_instant
from hybond.engine.methods.stepping import between, by_radau, go_straight, reach, retry
from hybond.engine.run.kinks_passed import end_out_of_sight
from hybond.engine.run.run_records import Run
from hybond.engine.surfaces.values import field

INSTANTS: Final = 16.0
"""Instants in which a motion at a kink may pass what is rounding there, at the most: where what is
compared has lost a digit or so it takes as many times longer than one to become another number."""
BEYOND: Final = 1.0 / 16.0
"""How exactly the end is found at which a guard begins to hold: to this part of the way there."""
HALVINGS: Final = 60
"""Of a step: then its halves are no numbers between."""


def is_over_kink(e: Engine, g: Locator, at: float) -> bool:
    """Whether the step that ends at a guard at `at`, or a little behind it, goes over a kink."""
    if e.model.kinks == 0 or e.slide.k > 0 or g.tied:
        return False
    over = False
    for k in range(g.guards):
        over = over or goes_over(e, g, k, at)
    return over


def goes_over(e: Engine, g: Locator, k: int, at: float) -> bool:
    """Whether guard k is a kink that the step goes over up to there, or up to its end.

    A root, however steep, has one value from both sides: there nothing jumps.
    """
    if g.side[k] == NO_KINK or is_root(e.model, g.atom[g.atom_first[k]] - e.model.kink_atom):
        return False
    return holds_at(e, g, k, at) or holds_at(e, g, k, e.step.t1)


def last_before_kink(e: Engine, g: Locator, at: float) -> float:
    """Return how far the step goes from `at` before it passes a kink; not beyond its end."""
    low = at
    high = e.step.t1
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        passed = False
        for k in range(g.guards):
            passed = passed or (goes_over(e, g, k, at) and holds_at(e, g, k, middle))
        if passed:
            high = middle
        else:
            low = middle
    return low


def end_short_of_kink(e: Engine, r: Run, at: float) -> int:
    """End the step at a guard that holds at `at` before what is behind a kink shows.

    What holds there is in `r.locator.done`. Where it does not hold in what the step has become, it
    was the kink that brought it so near.
    """
    g = r.locator
    room = room_of_instant(e, at)
    before = clear_of_kinks(e, g, at)
    apart = before <= e.step.t0 or at - before > room
    for k in range(g.guards):
        g.done[k] = 1 if holds_at(e, g, k, at) else 0
    made = retry(e, at if apart else before)
    if made == OK and e.step.off > 1.0 and (not apart or before - e.step.t0 > room):
        made = end_out_of_sight(e, before, at)
        before = e.step.t1
        apart = at - before > room
    g.looked = math.nan
    if made == OK and not by_radau(e) and noted_hold(e, g):
        back_to_guard(e, g)
    elif made == OK and not apart and at > before:
        made = carry_to_guard(e, r, at, room)
    elif made == OK and apart and at - e.step.t0 <= room:
        made = lead_to_guard(e, r, at, room)
    elif made == OK and apart and by_radau(e):
        if is_led_over(e, g):
            made = stay_before_kink(e, r, at, room)
        elif not noted_hold(e, g):
            made = carry_from(e, r, at, at, room)
    return made


def back_to_guard(e: Engine, g: Locator) -> None:
    """Let the step end where all that is in `done`, and holds at its end, begins to hold.

    The step has become another one than that in which the instant was found, and may go past it by
    what its error control lets pass: what slides to rest would slide back.
    """
    low = e.step.t0
    high = e.step.t1
    if all_hold_at(e, g, low):
        return
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if all_hold_at(e, g, middle):
            high = middle
        else:
            low = middle
    if high < e.step.t1:
        between(e, high, e.step.y1)
        reach(e, high)
        g.looked = math.nan


def clear_of_kinks(e: Engine, g: Locator, at: float) -> float:
    """Return the last instant, up to `at`, at which no kink that the step goes over is near.

    Within rounding of where it is, stages see what is behind.
    """
    reach = LAST_PLACES * spacing(at)
    before = at
    while before > e.step.t0 and is_near_kink(e, g, at, before):
        before = at - reach
        reach = 2.0 * reach
    return before


def is_near_kink(e: Engine, g: Locator, at: float, t: float) -> bool:
    """Whether a kink that the step goes over is passed at `t`, or there but for rounding."""
    for k in range(g.guards):
        if goes_over(e, g, k, at):
            here = atom_at(e, g, g.atom_first[k], t)
            terms = terms_here(e, g, k, g.atom_first[k])
            if not float(g.side[k]) * here > ROUNDING * terms:
                return True
    return False


def carry_to_guard(e: Engine, r: Run, at: float, room: float) -> int:
    """Carry the end of the step over to where all that is in `done` holds, within the instant.

    Not far beyond where it begins to: what comes to rest there would have turned round. What is
    compared at a kink with fewer digits has passed it as well.
    """
    begin = e.step.t1
    if field(e, e.mode, begin, e.step.y1, r.rate) != OK:
        return REFUSED
    for i in range(e.states):
        r.after[i] = e.step.y1[i]
    short = 0.0
    way = at - begin
    carry_by(e, r, begin, way)
    while not is_there(e, r.locator) and begin + 2.0 * way <= at + room:
        short = way
        way = max(2.0 * way, LAST_PLACES * spacing(at))
        carry_by(e, r, begin, way)
    if not is_there(e, r.locator):
        return OK
    while way - short > max(BEYOND * way, LAST_PLACES * spacing(at)):
        middle = 0.5 * (short + way)
        carry_by(e, r, begin, middle)
        if is_there(e, r.locator):
            way = middle
        else:
            short = middle
    carry_by(e, r, begin, way)
    return OK


def is_there(e: Engine, g: Locator) -> bool:
    """Whether all that is in `done` holds at the end of the step, and it has come to no kink."""
    return noted_hold(e, g) and not stands_on_kink(e, g)


def stands_on_kink(e: Engine, g: Locator) -> bool:
    """Whether what is compared at a kink has become zero: what it is behind that is still open."""
    stands = False
    for k in range(g.guards):
        if g.side[k] != NO_KINK and not is_asleep(g, k):
            a = g.atom_first[k]
            before = atom_at(e, g, a, e.step.t0)
            stands = stands or (before != 0.0 and atom_at(e, g, a, e.step.t1) == 0.0)
    return stands


def carry_by(e: Engine, r: Run, begin: float, way: float) -> None:
    """Let the step end so long after `begin` where `r.rate` leads in that time from `r.after`."""
    for i in range(e.states):
        e.step.y1[i] = r.after[i] + way * r.rate[i]
    reach(e, begin + way)
    r.locator.looked = math.nan


def lead_to_guard(e: Engine, r: Run, at: float, room: float) -> int:
    """Lead a step within the instant that begins before the kink to where all holds, or soon after.

    It goes by the rates where it begins: of those behind the kink nothing may show.
    """
    g = r.locator
    s = e.step
    if field(e, e.mode, s.t0, s.y0, r.rate) != OK:
        return REFUSED
    way = at - s.t0
    while s.t0 + way <= at + INSTANTS * room:
        go_straight(e, way, r.rate)
        g.looked = math.nan
        if noted_hold(e, g):
            return OK
        way = 2.0 * way
    return retry(e, at)


def stay_before_kink(e: Engine, r: Run, at: float, room: float) -> int:
    """Let an implicit step that has gone over a kink end before it, and lead it from there.

    With stages on either side of a jump it has no solution but for the error that it may make, and
    what it says of where the guard holds is off by as much.
    """
    g = r.locator
    refusal = e.refusal
    low = e.step.t0
    high = at
    made = OK
    while high - low > room:
        middle = 0.5 * (low + high)
        made = retry(e, middle)
        g.looked = math.nan
        if made != OK or is_led_over(e, g):
            high = middle
        else:
            low = middle
    e.refusal = refusal
    if low == e.step.t0:
        return lead_to_guard(e, r, high, room)
    if made != OK or e.step.t1 != low:
        made = retry(e, low)
    return made if made != OK else carry_from(e, r, low, high, room)


def carry_from(e: Engine, r: Run, end: float, at: float, room: float) -> int:
    """Carry an implicit step that ends at `end`, before a kink, to where all holds; else not.

    Where it ends elsewhere it stays as it is.
    """
    refusal = e.refusal
    if e.step.t1 != end or carry_to_guard(e, r, at, INSTANTS * room) != OK:
        e.refusal = refusal
        return OK
    return OK if noted_hold(e, r.locator) else retry(e, end)


def is_led_over(e: Engine, g: Locator) -> bool:
    """Whether the step ends behind a kink, by whatever: laws read numbers."""
    over = False
    for k in range(g.guards):
        if g.side[k] == NO_KINK or is_asleep(g, k):
            continue
        a = g.atom_first[k]
        if not is_root(e.model, g.atom[a] - e.model.kink_atom):
            before = atom_at(e, g, a, e.step.t0)
            over = over or before * atom_at(e, g, a, e.step.t1) < 0.0
    return over


def noted_hold(e: Engine, g: Locator) -> bool:
    """Whether all that is in `done` holds at the end of the step."""
    return all_hold_at(e, g, e.step.t1)


def all_hold_at(e: Engine, g: Locator, t: float) -> bool:
    """Whether all that is in `done` holds at a time within the step."""
    for k in range(g.guards):
        if g.done[k] != 0 and not holds_at(e, g, k, t):
            return False
    return True


def some_guard_holds(e: Engine, g: Locator) -> bool:
    """Whether a guard that is no kink holds at the end of the step."""
    for k in range(g.guards):
        if g.side[k] == NO_KINK and holds_at(e, g, k, e.step.t1):
            return True
    return False
