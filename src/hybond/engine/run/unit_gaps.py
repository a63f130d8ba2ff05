"""Gaps that jump where somebody else has found it, who knows of no step that has led there."""

from __future__ import annotations

import math

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.together import LAST_PLACES
from hybond.engine.laws.gaps_left import forget_gaps, note_gaps, some_closed_move, some_is_left
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.mode.equations import mode_of
from hybond.engine.run.run_records import Run
from hybond.engine.surfaces.values import begin_field, evaluate, field
from hybond.engine.words import Floats


def sees_left(e: Engine, r: Run, since: float) -> bool:
    """Whether gaps of closed contacts have jumped open; they are noted as they were before that.

    The way to the present instant is led back by its rates, as far as the instant settled last: a
    solver that does not locate what it finds is beyond by up to a step.
    """
    m = e.model
    if m.jumping_gaps == 0 or e.slide.k > 0 or not some_closed_move(e):
        return False
    if mode_of(e, e.state) != OK:
        return False
    begin_field(e, e.mode)
    if field(e, e.mode, e.t, e.y, r.rate) != OK:
        return False
    reach = LAST_PLACES * spacing(e.t)
    while reach <= max(e.t - since, LAST_PLACES * spacing(e.t)):
        note_led_back(e, r, 2.0 * reach, e.laws.gap_earlier)
        note_led_back(e, r, reach, e.laws.gap_before)
        if some_is_left(e, e.t, e.y):
            return True
        reach *= 2.0
    forget_gaps(e)
    return False


def note_led_back(e: Engine, r: Run, back: float, gaps: Floats) -> None:
    """Note gaps as they were before, by rates that are in `r.rate`."""
    for k in range(e.states):
        r.beside[k] = e.y[k] - back * r.rate[k]
    note_gaps(e, e.t - back, r.beside, gaps)


def is_at_jump(e: Engine) -> bool:
    """Whether a contact is closed where a gap jumps but for rounding, so that it has not yet."""
    m = e.model
    if m.jumping_gaps == 0 or not some_closed_move(e):
        return False
    if mode_of(e, e.state) != OK or evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return False
    at = False
    for k in range(m.jumping_gaps):
        atom = m.kink_atom + m.jumping_gap[k]
        here = math.fabs(value(m, m.atom_value[atom], e.shown))
        at = at or here <= ROUNDING * value(m, m.atom_size[atom], e.shown)
    return at
