"""Sources that contradict each other behind a kink: the mode has no motion there, and is left.

While a source and ground both hold a junction through diodes they agree; where one of them jumps
they do not, and no step goes over that. It ends before the kink, and is carried over by its rates:
what is settled there is a mode that cannot be, as where a source jumps at a timed event.
"""

from __future__ import annotations

import math

from hybond.engine.engine import OK, Engine
from hybond.engine.guards.together import LAST_PLACES, before_kink, is_kink_alone
from hybond.engine.instant.instant import LAW
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.stepping import between, retry, start
from hybond.engine.mode.nonlinear.agreement import check_agreement
from hybond.engine.run.edges import step_straight
from hybond.engine.run.ends_at_kink import ANEW
from hybond.engine.run.log import report_step
from hybond.engine.run.noted import note
from hybond.engine.run.run_records import Run, bound_of
from hybond.engine.surfaces.values import field, set_state
from hybond.engine.words import Floats


def contradict_behind(e: Engine, r: Run, at: float) -> bool:
    """Whether the step passes nothing at `at` but a kink behind which sources contradict."""
    if e.model.kinks == 0 or e.mode.agreements.rows == 0 or e.slide.k > 0:
        return False
    if not is_kink_alone(e, r.locator):
        return False
    between(e, at, r.rate)
    return contradict(e, at, r.rate)


def contradict(e: Engine, t: float, y: Floats) -> bool:
    """Whether sources of the present mode contradict each other in a state."""
    refusal = e.refusal
    set_state(e, e.mode, e.shown, t, y)
    found = check_agreement(e, e.mode, e.shown) != OK
    e.refusal = refusal
    return found


def meet_contradiction(e: Engine, r: Run, at: float) -> int:
    """End the step before a kink at `at`, and carry the state over it: LAW, -1 if the run stops.

    ANEW where the step that ends there has not come to it yet.
    """
    g = r.locator
    before = before_kink(e, g, at)
    g.looked = math.nan
    moved = before > e.step.t0
    if moved and (retry_before(e, before) != OK or note(e, r, e.step.t1, e.step.t1) != OK):
        return -1
    if is_carried_over(e, r):
        return LAW
    return ANEW if moved and start(e, e.t, e.y, bound_of(e), True) == OK else -1


def retry_before(e: Engine, t: float) -> int:
    """Repeat the step to end where sources agree, at `t` at the latest.

    What a polynomial says of a signal within a step is not what a step that ends there makes of it.
    """
    way = LAST_PLACES * spacing(t)
    made = retry(e, t)
    while made == OK and contradict(e, e.step.t1, e.step.y1) and t - way > e.step.t0:
        made = retry(e, t - way)
        way = 2.0 * way
    return made


def is_carried_over(e: Engine, r: Run) -> bool:
    """Whether sources contradict each other within an instant: then the state is carried there."""
    if e.mode.agreements.rows == 0 or e.slide.k > 0 or e.stop <= e.t:
        return False
    n = e.states
    refusal = e.refusal
    known = field(e, e.mode, e.t, e.y, r.rate) == OK
    h = spacing(e.t)
    room = room_of_instant(e, e.t)
    found = False
    while known and not found and h <= room:
        for i in range(n):
            r.beside[i] = e.y[i] + h * r.rate[i]
        found = contradict(e, e.t + h, r.beside)
        h = h if found else 2.0 * h
    e.refusal = refusal
    if not found:
        return False
    step_straight(e, e.t + h, e.y, r.beside)
    for k in range(n):
        e.y[k] = r.beside[k]
    e.early = min(e.early, e.t)
    e.t = e.step.t1
    report_step(e, r.report)
    return True
