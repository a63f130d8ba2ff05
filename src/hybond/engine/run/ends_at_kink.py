"""A step that ends at a kink, alone or with a guard, and how time goes on from there."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.guards.guard_values import look_at_state
from hybond.engine.guards.locator import NONE
from hybond.engine.guards.together import LAST_PLACES, kink_there
from hybond.engine.instant.instant import GUARD, LAW
from hybond.engine.laws.gaps_left import (
    forget_gaps,
    note_closed,
    note_gaps,
    some_closed_move,
    some_is_left,
)
from hybond.engine.methods.control import GROW
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.stepping import between, by_radau, start
from hybond.engine.methods.tolerances.along_surfaces import begin_scale
from hybond.engine.methods.tolerances.scale import is_unmoved
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.run.guard_at_kink import (
    end_short_of_kink,
    last_before_kink,
    some_guard_holds,
)
from hybond.engine.run.held_by_kinks import compared_by
from hybond.engine.run.kinks_passed import (
    count_kink,
    end_at_kink,
    has_passed,
    is_crowded,
    is_in_vain,
    see_jump,
    stuck_at_kink,
)
from hybond.engine.run.log import report_step
from hybond.engine.run.noted import note
from hybond.engine.run.roots_reached import rest_at_roots
from hybond.engine.run.run_records import Run, bound_of
from hybond.engine.run.source_jumps import jumps_onto_storage
from hybond.engine.run.struck_at_kink import (
    forget_bonds,
    jumps_onto_contact,
    kink_jumps_onto_contact,
    see_before_kink,
)
from hybond.engine.words import Floats

DOUBLED: Final = 16
"""Times that the way back from a kink is doubled: it is found where it is past by rounding."""
SHORTER: Final = 0.25
"""Part of a step that saw a kink where there was none that the next one may be."""
NEARER: Final = 0.5
"""Part of the way to a kink that a step leaves at the most where it has come nearer to it."""
CLEAR: Final = 4.0
"""Instants before a kink, at the most, at which an implicit step ends that goes up to it."""
ANEW: Final = -2
"""A step has ended, and the next begins anew behind it."""


def pass_kink(e: Engine, r: Run, at: float) -> int:
    """End the step at a kink and begin behind it: ANEW; LAW if it jumps, -1 if the run stops."""
    tried = e.step.t1 - e.step.t0
    if end_at_kink(e, r, at) != OK:
        return -1
    # what has ended the step is noted, until others are asked
    short = e.step.t1 - e.step.t0
    missed = short > room_of_instant(e, e.step.t1) and not (by_radau(e) or reaches_kink(e, r))
    struck = e.model.laws > 0 and kink_jumps_onto_contact(e, r, at)
    if jumps_onto_storage(e, r, at):
        report_step(e, r.report)
        return LAW if count_kink(e, r) == OK else -1
    if struck:
        noted = note(e, r, e.step.t1, e.step.t1) == OK
        return LAW if noted and count_kink(e, r) == OK else -1
    vain = is_in_vain(e, r)
    if vain:
        r.jumps = False
        r.leads_back = False
    found = leave_or_go(e, r, at)
    if found == ANEW and vain:
        e.step.h = min(e.step.h, SHORTER * tried)
    if found == ANEW and missed:
        e.step.h = min(e.step.h, GROW * short)
    return found


def reaches_kink(e: Engine, r: Run) -> bool:
    """Whether the step that was to end at a kink has come to it.

    As a valve closes its flow is a root of what is left: a step that is long beside that knows of
    the way there by its first stage alone, which the estimate of its error hardly sees. One that
    ends where the long one had the kink does not get there; the next is no longer than the way is.
    """
    g = r.locator
    refusal = e.refusal
    hold_guess(e, e.mode)
    look_at_state(e, g, e.step.t1, e.step.y1)
    passed = has_passed(e, g)
    give_back_guess(e, e.mode)
    g.looked = math.nan
    e.refusal = refusal
    return passed


def leave_or_go(e: Engine, r: Run, at: float) -> int:
    """Begin behind a kink that has ended the step: ANEW, or LAW if a gap jumps; -1: it stops."""
    if some_closed_move(e) and leaves_contacts(e, r, at, e.step.t1, e.step.y1):
        noted = note(e, r, e.step.t1, e.step.t1) == OK
        return LAW if noted and count_kink(e, r) == OK else -1
    return go_behind(e, r)


def see_gaps(e: Engine, r: Run) -> None:
    """See how gaps were before the instant that is to be settled, where a contact is closed.

    That is by the step that has led there: a guard beside a kink is found a little behind it.
    """
    if e.model.laws == 0 or e.laws.gaps_noted or not some_closed_move(e):
        return
    led = e.step.t0 < e.t and e.t <= e.step.t1
    if not (led and leaves_contacts(e, r, e.t, e.t, e.y)):
        note_closed(e)


def left_at_end(e: Engine, r: Run) -> bool:
    """Whether a gap jumps where a step has ended: a kink just there is in no step."""
    return some_closed_move(e) and leaves_contacts(e, r, e.t, e.t, e.y)


def leaves_contacts(e: Engine, r: Run, at: float, behind: float, y: Floats) -> bool:
    """Whether gaps of closed contacts jump open at a kink at `at`; `y` is the state behind it."""
    if e.model.kinks == 0 or e.slide.k > 0:
        return False
    reach = LAST_PLACES * spacing(at)
    for _ in range(DOUBLED):
        led_back(e, at - 2.0 * reach, r.rate)
        note_gaps(e, at - 2.0 * reach, r.rate, e.laws.gap_earlier)
        led_back(e, at - reach, r.rate)
        note_gaps(e, at - reach, r.rate, e.laws.gap_before)
        if some_is_left(e, behind, y):
            return True
        reach *= 2.0
    forget_gaps(e)
    return False


def led_back(e: Engine, t: float, y: Floats) -> None:
    """Put the state at a time of the last step into `y`; just before it, where its way leads from.

    A step may begin at a kink but for rounding, and is behind it already.
    """
    s = e.step
    if t >= s.t0:
        between(e, t, y)
        return
    between(e, min(2.0 * s.t0 - t, s.t1), y)
    for k in range(e.states):
        y[k] = 2.0 * s.y0[k] - y[k]


def meet_kink(e: Engine, r: Run, at: float) -> int:
    """End the step at a guard and a kink: GUARD, or ANEW where only the kink made it hold.

    LAW if a gap jumps there, -1 if the run stops.
    """
    g = r.locator
    kink = last_before_kink(e, g, at)
    ahead = kink_there(e, g)
    if ahead != NONE and not r.told:
        see_jump(e, r, at)  # where the guard was found, the kink was not there yet
    if e.model.laws > 0:
        see_before_kink(e, r, at)
    if end_short_of_kink(e, r, at) != OK:
        stuck_at_kink(e, r)
        return -1
    if not some_guard_holds(e, g):
        forget_bonds(e)
        # where a guard has held in vain before, it is the jump that holds the motion
        asked = ahead != NONE and r.jumps and r.idle == 0
        left = way_to_kink(e, r, ahead) if asked else math.inf
        r.leads_back = r.leads_back and left == math.inf
        return go_up_to(e, r, kink, left)
    g.at = e.step.t1
    if e.model.laws > 0:
        jumps_onto_contact(e, r)
    return GUARD


def way_to_kink(e: Engine, r: Run, k: int) -> float:
    """Return the time left to the kink of guard k, if a step has come far nearer to it.

    Infinite if not. It has ended on the side on which it began. Then no way has led back from
    behind yet, however short the steps have become: the next one may see that a guard holds there,
    as that of friction which comes to rest beside a law that jumps at rest as well.
    """
    g = r.locator
    refusal = e.refusal
    hold_guess(e, e.mode)
    copy_floats(e.states, e.step.y0, g.y)
    before = compared_by(e, g, k, e.step.t0)
    copy_floats(e.states, e.step.y1, g.y)
    after = compared_by(e, g, k, e.step.t1)
    give_back_guess(e, e.mode)
    e.refusal = refusal
    if not (before * after > 0.0 and math.fabs(after) <= NEARER * math.fabs(before)):
        return math.inf
    return (e.step.t1 - e.step.t0) * after / (before - after)


def go_up_to(e: Engine, r: Run, kink: float, left: float) -> int:
    """Begin where a step has ended in which a kink made a guard hold, as `leave_or_go` says.

    The next step ends before that kink, or where its motion meets it. As long as the last one, it
    would see the kink again, and end a little later, at what it makes of the guard then.
    """
    found = leave_or_go(e, r, e.step.t1)
    if found == ANEW and kink > e.t:
        e.step.h = min(e.step.h, kink - e.t)
    room = room_of_instant(e, e.t)
    if found == ANEW and left > room:
        # an implicit step that ends on it would have its end, a stage, on either side
        e.step.h = min(e.step.h, max(0.5 * left, left - CLEAR * room) if by_radau(e) else left)
    return found


def go_behind(e: Engine, r: Run) -> int:
    """Begin where a kink has ended the step: ANEW; LAW if a surface jumps, -1 if the run stops."""
    if note(e, r, e.step.t1, e.step.t1) != OK:
        return -1
    if count_kink(e, r) != OK:
        return -1
    if e.slide.parts_now:
        return LAW
    rest_at_roots(e, r)
    if is_unmoved(e):
        begin_scale(e, e.mode)  # nothing has moved yet, but may do from here
    learned = e.step.onset_end
    before = e.step.h
    if start(e, e.t, e.y, bound_of(e), True) != OK:
        return -1
    e.step.bent_at = e.t
    if by_radau(e) and r.kink >= 0 and e.model.kink_meets[r.kink] != 0:
        # the size that the step before has left is what the motion allows on either side
        e.step.h = min(e.step.h, before)
    if is_crowded(e, r):
        e.step.onset_end = learned  # a moment later is behind many more of them
        e.step.h = min(e.step.h, GROW * before)  # rates alone know nothing of what they are led to
    return ANEW
