"""Sources that jump at a kink onto what is stored: an instant, as at a timed event.

A kink ends a step and nothing happens, but for one case: where a source, or what modulates one,
jumps there and a constraint ties what is stored to it. To put the state on its constraints behind
the kink would be a jump that nobody is told of. So what the constraints hold is taken from before
the kink, everything else from behind it, and the instant is settled: the state jumps by
conservation, with impulses.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import AT_KINK
from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import atom_at, put_on_constraints, terms_here
from hybond.engine.guards.locator import NONE
from hybond.engine.guards.together import before_kink
from hybond.engine.inputs.interval import moment
from hybond.engine.jumps.jump import on_constraints
from hybond.engine.jumps.tied import put_tied
from hybond.engine.methods.stepping import between, step
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.run.run_records import Run
from hybond.engine.surfaces.values import evaluate, field

JUMPED: Final = 1e-9
"""Part of what a storage may hold by which constraints on both sides of a kink differ at least."""
DOUBLED: Final = 16
"""Times that the way back to before a kink is doubled."""
LONGER: Final = 4.0
"""Over so many times the time, what moves but does not jump is so many times as far apart, ..."""
JUMPS: Final = 0.75
"""... and this part of what jumps is there already over the shorter one."""


def jumps_onto_storage(e: Engine, r: Run, at: float) -> bool:
    """Return whether the kink that has ended the step moves constraints; then `e.y` is before it.

    The step ends just behind the kink. In `e.y` what its constraints move is as they had it before.
    """
    if not is_constrained(e.mode) or e.slide.k > 0 or e.model.storages == 0:
        return False
    many = e.states
    refusal = e.refusal
    before = on_this_side(e, r, before_kink(e, r.locator, at) - moment(e.model, e.t))
    # a step may be shorter than a moment: its polynomial says nothing of what was before it
    between(e, max(before, e.step.t0), r.rate)
    for i in range(many):
        r.beside[i] = r.rate[i]
        r.beside[many + i] = e.step.y1[i]
        e.y[i] = e.step.y1[i]
    known = put_on_constraints(e, before, r.rate) == OK
    known = known and put_on_constraints(e, e.step.t1, e.y) == OK
    jumps = known and differ(e, r) and jumps_farther(e, r, e.step.t1 - before)
    e.refusal = refusal
    r.locator.looked = math.nan
    if not jumps:
        return False
    for i in range(many):
        e.y[i] = r.beside[many + i] + (r.rate[i] - r.beside[i])
    e.t = e.step.t1
    e.early = min(e.early, before)
    return True


def on_this_side(e: Engine, r: Run, before: float) -> float:
    """Return a time, `before` or sooner, at which the step has not come to the kink that ended it.

    What is compared may depend on the motion. The step that was repeated to end at the kink comes
    to it a little sooner than the longer one did, which has told where it is: at `before` it may be
    beyond, or away from it by rounding that does not tell, but what jumps there has jumped. Where
    it is on no side however far back, `before` is as good as any.
    """
    g = r.locator
    k = r.kink_guard
    if k == NONE:
        return before
    first = g.atom_first[k]
    side = float(g.side[k])
    found = before
    way = e.step.t1 - before
    doubled = 0
    hold_guess(e, e.mode)
    here = atom_at(e, g, first, max(found, e.step.t0))
    dust = ROUNDING * terms_here(e, g, k, first)
    while not side * here > dust and doubled < DOUBLED and found > e.step.t0:
        way = 2.0 * way
        doubled += 1
        found = e.step.t1 - way
        here = atom_at(e, g, first, max(found, e.step.t0))
    give_back_guess(e, e.mode)
    g.looked = math.nan
    return found if side * here > dust else before


def jumps_at_once(e: Engine, r: Run) -> bool:
    """Return whether time begins to pass at a kink behind which constraints are others.

    Then a step has been made that is no time, and ends behind it.

    What is a whole number just now, or has no sign, has another value as soon as time passes.
    """
    soon = e.t + moment(e.model, e.t)
    if not are_apart(e, r, e.t, soon) or step(e, soon) != OK:
        return False
    for i in range(e.states):
        e.y[i] = e.step.y1[i]
    e.t = e.step.t1
    return True


def jumps_at_end(e: Engine, r: Run) -> bool:
    """Return whether the run ends at a kink from which on constraints are others.

    What happens at the very end belongs to the run.
    """
    a_moment = moment(e.model, e.t)
    return are_apart(e, r, e.t - a_moment, e.t + a_moment)


def are_apart(e: Engine, r: Run, before: float, behind: float) -> bool:
    """Whether now is a kink, and constraints at two times around it hold different states."""
    m = e.model
    if m.kinks == 0 or not is_constrained(e.mode) or e.slide.k > 0 or m.storages == 0:
        return False
    refusal = e.refusal
    early = e.early
    e.early = math.inf
    apart = evaluate(e, e.mode, e.shown, e.t, e.y) == OK and is_at_kink(e)
    apart = apart and jump_between(e, r, e.t, before, behind)
    e.early = early
    e.refusal = refusal
    return apart


def jump_between(e: Engine, r: Run, t: float, before: float, behind: float) -> bool:
    """Whether constraints at two times around `t` hold the present state at different places.

    And nearly as far apart as over a time that is longer: what only moves fast is not.
    """
    many = e.states
    apart = put_apart(e, r, t, before, behind) and differ(e, r)
    for i in range(many):
        there = i < e.model.storages and differs(e, r, i)
        r.beside[2 * many + i] = apart_by(e, r, i) if there else 0.0
        e.y[i] = r.beside[3 * many + i]
    if not apart:
        return False
    known = put_apart(e, r, t, t - LONGER * (t - before), t + LONGER * (behind - t))
    jumps = False
    for i in range(many):
        jumps = jumps or r.beside[2 * many + i] > JUMPS * apart_by(e, r, i)
        e.y[i] = r.beside[3 * many + i]
    return known and jumps


def put_apart(e: Engine, r: Run, t: float, before: float, behind: float) -> bool:
    """Put the state at `t` on the constraints at two times, into `r.rate` and `e.y`.

    It is led there by its rates: what jumps with a signal has one value at the signal's own. As it
    was led it is in the first two rows of `r.beside`, as it was in the last one; False where there
    are no such states.
    """
    many = e.states
    led = field(e, e.mode, t, e.y, r.after) == OK
    for i in range(many):
        rate = r.after[i] if led else 0.0
        r.beside[3 * many + i] = e.y[i]
        r.beside[i] = e.y[i] + (before - t) * rate
        r.beside[many + i] = e.y[i] + (behind - t) * rate
        r.rate[i] = r.beside[i]
        e.y[i] = r.beside[many + i]
    known = put_on_constraints(e, before, r.rate) == OK
    return known and put_on_constraints(e, behind, e.y) == OK


def put_before_kink(e: Engine, r: Run, t: float) -> int:
    """Put the state of the motion on its mode's constraints, on those before a jump of a source.

    A step may end at the very time at which a source jumps: what happens there is for the instant.
    At a kink where none jumps constraints are those of the time itself: a moment before, what
    passes through zero fast is a thousand times off what is left of it. What is read of the state
    that was put before a jump is read before it, too: `e.early`, until the caller gives it back.
    From a jump at which the step has begun the motion comes, and never goes back.
    """
    m = e.model
    if r.locator.tied:
        put_tied(e, t, e.y)
        return OK
    if m.kinks == 0 or not is_constrained(e.mode):
        return put_on_constraints(e, t, e.y)
    if evaluate(e, e.mode, e.shown, t, e.y) != OK:
        return REFUSED
    if not is_at_kink(e):
        return on_constraints(e, e.mode, e.shown, e.y)
    a_moment = moment(m, e.t)
    refusal = e.refusal
    early = e.early
    e.early = math.inf
    before = max(t - a_moment, min(e.step.t0, t))
    apart = jump_between(e, r, t, before, t + a_moment)
    e.early = min(early, before) if apart else early
    e.refusal = refusal
    return put_on_constraints(e, t, e.y)


def is_at_kink(e: Engine) -> bool:
    """Whether the values in `e.shown` are those of a kink."""
    m = e.model
    found = False
    for a in range(m.kink_atom, m.kink_atom + m.kinks):
        size = math.fabs(value(m, m.atom_size[a], e.shown))
        found = found or math.fabs(value(m, m.atom_value[a], e.shown)) <= AT_KINK * size
    return found


def differ(e: Engine, r: Run) -> bool:
    """Return whether constraints on two sides of a kink move what is stored to other places.

    Before it they have moved the first row of `r.beside` to `r.rate`, behind it the second to
    `e.y`.
    """
    reach_of(e, e.mode, e.y, e.work.reach)
    apart = False
    for i in range(e.model.storages):
        apart = apart or differs(e, r, i)
    return apart


def differs(e: Engine, r: Run, i: int) -> bool:
    """Return whether they do so to storage i."""
    most = max(e.work.reach[i], max(math.fabs(e.y[i]), math.fabs(r.rate[i])))
    return apart_by(e, r, i) > JUMPED * most


def apart_by(e: Engine, r: Run, i: int) -> float:
    """Return by how much the two sides move storage i to other places."""
    here = r.rate[i] - r.beside[i]
    there = e.y[i] - r.beside[e.states + i]
    return math.fabs(there - here)


def jumps_farther(e: Engine, r: Run, h: float) -> bool:
    """Return whether that is more than what moves on does from one side to the other.

    What moves fast is as far from its constraints as rounding of the time is long, and behind the
    kink it may move faster.
    """
    known = field(e, e.mode, e.step.t1, e.step.y1, r.after) == OK
    farther = not known
    for i in range(e.model.storages):
        moved = math.fabs(r.beside[e.states + i] - r.beside[i])
        if known and differs(e, r, i):
            farther = farther or apart_by(e, r, i) > max(moved, h * math.fabs(r.after[i]))
    return farther
