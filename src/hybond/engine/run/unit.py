"""A run that somebody else drives: in pieces of time, or with a solver of their own.

What a functional mock-up unit does, without the words of that standard. Driven in pieces, a run is
the same as in one go, but for where its steps end. With somebody else's solver it gives the rates
of its states, what guards compare, and settles the instants that it is told of.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.guards.in_force import is_asked
from hybond.engine.inputs.interval import interval_after
from hybond.engine.instant.instant import GUARD, INPUT, START
from hybond.engine.method_numbers import MOREAU
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.rows.storage import own_stiffness, with_stored
from hybond.engine.run.motion import flow, rest_now, settle_now
from hybond.engine.run.run_records import STOPPED, Run, begin, timed_cause
from hybond.engine.run.unit_gaps import is_at_jump, sees_left
from hybond.engine.surfaces.values import begin_field, evaluate, field
from hybond.engine.timestepping.step_shown import show_point
from hybond.engine.words import Floats

INSTANT: Final = 1e-12
"""What is one instant with a timed event, as a part of the time."""
LATE: Final = 1e-9
"""How far beyond the instant of an importer a guard is followed until it acts, likewise."""
TINY: Final = 1e-300
"""What an indicator is instead of zero, so that it changes its sign where a guard its truth."""


def begin_unit(e: Engine, r: Run) -> int:
    """Settle the start, with the inputs that were set."""
    begin(e)
    e.samples_end = math.inf
    interval_after(e, 0.0)
    return settled(e, r, START)


def settled(e: Engine, r: Run, cause: int) -> int:
    """Settle the present instant, and let come to rest what does."""
    if settle_now(e, r, cause) == REFUSED:
        return REFUSED
    return OK if rest_now(e, r) != REFUSED else REFUSED


def set_input(e: Engine, k: int, level: float) -> None:
    """Set an input from the present instant on; `take_inputs` makes it so."""
    e.asked[k] = level


def take_inputs(e: Engine, r: Run) -> int:
    """Settle the present instant if inputs were set to something else."""
    changed = False
    for k in range(e.model.inputs):
        changed = changed or e.asked[k] != e.level[k]
    return settled(e, r, INPUT) if changed else OK


def advance(e: Engine, r: Run, t: float) -> int:
    """Run to `t`, through all events up to there."""
    while e.t < t:
        e.stop = t
        cause = flow(e, r)
        if cause < 0:
            return REFUSED
        if cause != STOPPED and settled(e, r, cause) != OK:
            return REFUSED
    return OK


def output_now(e: Engine, k: int) -> float:
    """Return output k at the present instant; nan if it has no value."""
    in_steps = e.model.method == MOREAU
    if (not in_steps and mode_of(e, e.state) != OK) or show_point(e, e.t, e.y) != OK:
        return math.nan
    return value(e.model, e.model.output_value[k], e.shown)


def nominal_now(e: Engine, k: int) -> float:
    """Return what state k is measured by: what a flow or effort of 1 stores, but no more than 1."""
    m = e.model
    if k >= m.storages:
        return 1.0
    stiffness = math.fabs(own_stiffness(m, k, with_stored(e, e.y)))
    return 1.0 / stiffness if 1.0 < stiffness and stiffness < math.inf else 1.0


def rates_now(e: Engine, rate: Floats) -> int:
    """Put the time derivatives of the states into `rate`."""
    if mode_of(e, e.state) != OK:
        return REFUSED
    begin_field(e, e.mode)
    return field(e, e.mode, e.t, e.y, rate)


def indicators_now(e: Engine, out: Floats) -> int:
    """Put what guards compare into `out`: differences, 1 for guards of other states.

    Behind them are those at whose zeros gaps of contacts jump.
    None is zero: the root that an importer finds lies where ``a > b`` holds, not where a is b.
    """
    m = e.model
    if mode_of(e, e.state) != OK or evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return REFUSED
    at = first_jumping_gap(e)
    for k in range(m.jumping_gaps):
        out[at + k] = value(m, m.atom_value[m.kink_atom + m.jumping_gap[k]], e.shown)
        if out[at + k] == 0.0:
            out[at + k] = TINY
    for machine in range(m.machines):
        for rule in range(m.rule_first[machine], m.rule_first[machine + 1]):
            here = m.rule_source[rule] == e.state[machine] and m.rule_watched[rule] != 0
            for k in range(m.atom_first[rule], m.atom_first[rule + 1]):
                out[k] = value(m, m.atom_value[k], e.shown) if here else 1.0
                if out[k] == 0.0:
                    out[k] = TINY * float(m.atom_zero[k])
    return OK


def first_jumping_gap(e: Engine) -> int:
    """Return how many differences guards compare."""
    return e.model.atom_first[e.model.rule_first[e.model.machines]]


def indicators_of(e: Engine) -> int:
    """Return how many differences an importer watches."""
    return first_jumping_gap(e) + e.model.jumping_gaps


def settle_unit(e: Engine, r: Run) -> int:
    """Settle the present instant, which somebody else's solver has found."""
    if math.fabs(e.t - e.next_break) <= INSTANT * max(e.span, math.fabs(e.t)):
        e.t = e.next_break
        return settled(e, r, timed_cause(e))
    for k in range(e.model.inputs):
        if e.asked[k] != e.level[k]:
            return settled(e, r, INPUT)
    return settle_guard(e, r)


def settle_guard(e: Engine, r: Run) -> int:
    """Settle the instant at which an importer has found that a guard holds.

    What exceeds its bound by no more than rounding does not switch. A run of the unit would meet
    the guard again at once, an importer never: so the unit runs on until it acts.
    """
    since = r.instant.t
    sees_left(e, r, since)
    if settled(e, r, GUARD) != OK:
        return REFUSED
    part = INSTANT
    while part <= LATE and (guard_holds(e) or is_at_jump(e)):
        if advance(e, r, e.t + part * max(e.span, math.fabs(e.t))) != OK:
            return REFUSED
        if sees_left(e, r, since) and settled(e, r, GUARD) != OK:
            return REFUSED
        part *= 10.0
    return OK


def guard_holds(e: Engine) -> bool:
    """Whether a guard of the present mode holds, which time would not go on with."""
    m = e.model
    if mode_of(e, e.state) != OK or evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return False
    for machine in range(m.machines):
        for rule in range(m.rule_first[machine], m.rule_first[machine + 1]):
            if m.rule_watched[rule] == 0 or not is_asked(e, machine, rule, e.state[machine]):
                continue
            if value(m, m.rule_test[rule], e.shown) != 0.0:
                return True
    return False
