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

from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.inputs.interval import moment
from hybond.engine.instant.jump import on_constraints
from hybond.engine.methods.stepping import between, step
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.mode.storage import reach_of
from hybond.engine.mode.values import evaluate
from hybond.engine.run.guard_values import put_on_constraints
from hybond.engine.run.run_records import Run
from hybond.engine.run.together import before_kink
from hybond.engine.words import Floats

JUMPED: Final = 1e-9
"""Part of what a storage may hold by which constraints on both sides of a kink differ at least."""
AT_KINK: Final = 1e-9
"""Part of its terms below which what changes its sign at a kink is zero."""


def jumps_onto_storage(e: Engine, r: Run, at: float) -> bool:
    """Return whether the kink that has ended the step moves constraints; then `e.y` is before it.

    The step ends just behind the kink. In `e.y` what its constraints move is as they had it before.
    """
    if not is_constrained(e.mode) or e.slide.k > 0 or e.model.storages == 0:
        return False
    many = e.states
    refusal = e.refusal
    before = before_kink(e, r.locator, at) - moment(e.model, e.t)
    between(e, before, r.rate)
    for i in range(many):
        r.beside[i] = r.rate[i]
        r.beside[many + i] = e.step.y1[i]
        e.y[i] = e.step.y1[i]
    known = put_on_constraints(e, before, r.rate) == OK
    known = known and put_on_constraints(e, e.step.t1, e.y) == OK
    e.refusal = refusal
    r.locator.looked = math.nan
    if not known or not differ(e, r):
        return False
    for i in range(many):
        e.y[i] = r.beside[many + i] + (r.rate[i] - r.beside[i])
    e.t = e.step.t1
    e.early = min(e.early, before)
    return True


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
    many = e.states
    refusal = e.refusal
    early = e.early
    e.early = math.inf
    apart = evaluate(e, e.mode, e.shown, e.t, e.y) == OK and is_at_kink(e)
    if apart:
        for i in range(many):
            r.beside[i] = e.y[i]
            r.beside[many + i] = e.y[i]
            r.rate[i] = e.y[i]
        known = put_on_constraints(e, before, r.rate) == OK
        known = known and put_on_constraints(e, behind, e.y) == OK
        apart = known and differ(e, r)
        for i in range(many):
            e.y[i] = r.beside[i]
    e.early = early
    e.refusal = refusal
    return apart


def put_before_kink(e: Engine, t: float, y: Floats) -> int:
    """Put a state of the motion on its mode's constraints, at a kink on those before it.

    A step may end at the very time at which a source jumps: what happens there is for the instant.
    """
    m = e.model
    if m.kinks == 0 or not is_constrained(e.mode):
        return put_on_constraints(e, t, y)
    if evaluate(e, e.mode, e.shown, t, y) != OK:
        return REFUSED
    if is_at_kink(e):
        return put_on_constraints(e, t - moment(e.model, e.t), y)
    return on_constraints(e, e.mode, e.shown, y)


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
    reach_of(e, e.y, e.energy, e.work.reach)
    apart = False
    for i in range(e.model.storages):
        here = r.rate[i] - r.beside[i]
        there = e.y[i] - r.beside[e.states + i]
        most = max(e.work.reach[i], max(math.fabs(e.y[i]), math.fabs(r.rate[i])))
        apart = apart or math.fabs(there - here) > JUMPED * most
    return apart
