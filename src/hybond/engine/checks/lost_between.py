"""Energy lost between two points that are both right, J: by what a law says in the middle of steps.

A step is held to its ends. Between them its polynomial is coarser, and where laws are steep beside
what it stores, what they say there is another flow than moves it: `z (f(y) - y')` adds up to energy
that came from nowhere, or went there. By Simpson's rule the middle of a step counts for it alone:
at the ends rates are those of the polynomial, which others hold. It is looked at where laws bend,
and in steps that store little more than they may be off by; elsewhere it is as right as the step.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.method_numbers import RK4
from hybond.engine.methods.stepping import between
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.rows.storage import co_energy_of, with_stored
from hybond.engine.reasons.warned import LOST_BETWEEN, add_about, begin_warning
from hybond.engine.surfaces.values import field

SUSPECT: Final = 1e-3
"""Part of what a step stores from which on what it may be off by makes it worth a look."""
SIMPSON: Final = 4.0 / 6.0
AS_AUDITED: Final = 10.0
"""How many times the tolerance of a run it may be off, as in the audit."""
USUAL_TOLERANCE: Final = 1e-8
"""A tolerance that is tighter is judged by this, as in the audit."""


def see_between(e: Engine) -> None:
    """Count what is lost within the step just noted, beyond what it may be off by."""
    m = e.model
    s = e.step
    c = e.checks
    if m.tells == 0 or e.mode.dynamics == 0 or e.slide.k > 0 or e.curved:
        return
    if e.t != s.t1 or m.method >= RK4 or not s.t1 > s.t0:
        return
    moved = 0.0
    may = 0.0
    for k in range(m.storages):
        if m.storage_pseudo[k] == 0:
            level = max(math.fabs(s.level0[k]), math.fabs(s.level1[k]))
            moved += level * math.fabs(s.y1[k] - s.y0[k])
            off = level * m.rtol * e.largest_state[k]
            may += off * off
    may = math.sqrt(float(e.states) * may)
    if may < SUSPECT * moved:
        return
    refusal = e.refusal
    asked = e.evaluations
    hold_guess(e, e.mode)
    h = s.t1 - s.t0
    lost = 0.0
    between(e, s.t0 + 0.5 * h, c.beside)
    known = field(e, e.mode, s.t0 + 0.5 * h, c.beside, c.rate) == OK
    if known:
        v = with_stored(e, c.beside)
        for k in range(m.storages):
            c.middle[k] = co_energy_of(m, k, v) if m.storage_pseudo[k] == 0 else 0.0
            lost += c.middle[k] * c.rate[k] * h
        # the rate of a polynomial of the fourth degree, by five of its points
        add_way(e, 0.25, -8.0 / 3.0)
        add_way(e, 0.75, 8.0 / 3.0)
        for k in range(m.storages):
            lost -= c.middle[k] * (s.y0[k] - s.y1[k]) / 3.0
            lost -= c.middle[k] * c.along[k]
    give_back_guess(e, e.mode)
    e.refusal = refusal
    e.evaluations = asked
    lost *= SIMPSON
    if known and math.isfinite(lost) and math.fabs(lost) > may:
        c.lost_between += math.copysign(math.fabs(lost) - may, lost)
        if c.lost_since == math.inf:
            c.lost_since = s.t0


def add_way(e: Engine, part: float, weight: float) -> None:
    """Add the state at a part of the step to the rate of the polynomial; the first one begins."""
    s = e.step
    c = e.checks
    between(e, s.t0 + part * (s.t1 - s.t0), c.beside)
    for k in range(e.model.storages):
        before = c.along[k] if weight > 0.0 else 0.0
        c.along[k] = before + weight * c.beside[k]


def tell_lost_between(e: Engine) -> None:
    """Warn where a run ends of what has been lost like that, if it is more than an audit allows."""
    c = e.checks
    enough = AS_AUDITED * max(e.model.rtol, USUAL_TOLERANCE)
    if e.model.tells == 0 or not math.fabs(c.lost_between) > enough * max(c.size, c.moved):
        return
    begin_warning(e.warned, LOST_BETWEEN, c.lost_since)
    add_about(e.warned, c.lost_between)
    add_about(e.warned, max(c.size, c.moved))
    c.lost_between = 0.0
    c.lost_since = math.inf
