"""A mode that comes to leave something open while time passes in it.

A law that bends is flat from some point on, a modulus that follows time or what is stored is zero
there. What depends on it is asked at an instant, as where a mode is entered.
"""

from __future__ import annotations

from hybond.engine.engine import OK, Engine
from hybond.engine.mode.left_free.leakage import is_undetermined
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.reasons.warned import OPENS, add_about, begin_warning
from hybond.engine.surfaces.averages import freedom_here, solve_here
from hybond.engine.surfaces.values import set_state


def comes_open(e: Engine) -> bool:
    """Whether more is open at the end of a step than where its mode was settled last; tell it."""
    m = e.model
    mode = e.mode
    if mode.dynamics == 0 or mode.loose <= e.trial.loose or e.slide.k > 0:
        return False
    if m.decided != 0 and m.tells == 0:
        return False
    refused = e.refusal
    asked = e.evaluations
    hold_guess(e, mode)
    set_state(e, mode, e.v, e.t, e.y)
    many = freedom_here(e, mode, e.v) if solve_here(e, mode, e.v) == OK else 0
    give_back_guess(e, mode)
    e.refusal = refused
    e.evaluations = asked
    if many <= e.trial.loose:
        return False
    if m.tells != 0:
        begin_warning(e.warned, OPENS, e.t)
        for k in range(m.machines):
            add_about(e.warned, float(e.state[k]))
        for k in range(2 * m.bonds):
            if is_undetermined(2 * m.bonds, many, e.work.freedom.at, k):
                add_about(e.warned, float(k))
    return True
