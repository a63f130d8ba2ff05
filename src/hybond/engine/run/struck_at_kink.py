"""Sources that jump at a kink onto a contact that touches: an instant, as at a timed event.

Nothing arrives there: what the bonds of the contact were just before the kink is noted, or the jump
of the source would pass for an approach, and the body rebound from what it has touched all along.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import sign_at
from hybond.engine.guards.together import before_kink
from hybond.engine.inputs.interval import moment
from hybond.engine.laws.law_instant import CLOSED, NO_LAW_VALUE, evaluate_gap, is_on
from hybond.engine.methods.stepping import between
from hybond.engine.run.run_records import Run
from hybond.engine.surfaces.values import evaluate

JUMPED: Final = 1e-9
"""Part of its terms by which a contact approaches behind a kink if a source has jumped onto it."""


def kink_jumps_onto_contact(e: Engine, r: Run, at: float) -> bool:
    """Return whether a source jumps onto a contact at the kink that has ended the step at `at`."""
    see_before_kink(e, r, at)
    return jumps_onto_contact(e, r)


def see_before_kink(e: Engine, r: Run, at: float) -> None:
    """See what bonds of contacts are before the kink at `at` that the step goes over."""
    m = e.model
    laws = e.laws
    laws.bonds_noted = False
    for k in range(m.ports if e.slide.k == 0 else 0):
        if m.port_restitution[k] != NO_LAW_VALUE and m.port_two_sided[k] == 0:
            laws.bonds_noted = True
    if not laws.bonds_noted:
        return
    refusal = e.refusal
    before = max(before_kink(e, r.locator, at) - moment(m, at), e.step.t0)
    between(e, before, r.rate)
    laws.bonds_noted = evaluate(e, e.mode, e.shown, before, r.rate) == OK
    e.refusal = refusal
    for k in range(2 * m.bonds):
        laws.bonds_before[k] = e.shown[m.bond_slot + k]
    r.locator.looked = math.nan


def jumps_onto_contact(e: Engine, r: Run) -> bool:
    """Return whether a source has jumped onto a contact since bonds were seen, by the step's end.

    What they were is noted then, until the instant is settled.
    """
    m = e.model
    laws = e.laws
    if not laws.bonds_noted:
        return False
    refusal = e.refusal
    known = evaluate(e, e.mode, e.shown, e.step.t1, e.step.y1) == OK
    e.refusal = refusal
    laws.bonds_noted = False
    for k in range(m.ports if known else 0):
        if m.port_restitution[k] != NO_LAW_VALUE and m.port_two_sided[k] == 0:
            laws.bonds_noted = laws.bonds_noted or is_jumped_onto(e, k)
    r.locator.looked = math.nan
    return laws.bonds_noted


def is_jumped_onto(e: Engine, k: int) -> bool:
    """Whether contact k touches, and approaches by `e.shown` though it did not before."""
    m = e.model
    total = 0.0
    came = 0.0
    size = 0.0
    for i in range(m.pair_first[2 * k + 1], m.pair_first[2 * k + 2]):
        now = m.pair_value[i] * e.shown[m.bond_slot + m.pair_column[i]]
        was = m.pair_value[i] * e.laws.bonds_before[m.pair_column[i]]
        total -= now
        came -= was
        size += math.fabs(now) + math.fabs(was)
    if total >= -JUMPED * size or came < -JUMPED * size:
        return False
    return touches(e, k)


def touches(e: Engine, k: int) -> bool:
    """Whether contact k is closed, or its gap is none by `e.shown`."""
    m = e.model
    if m.port_gap[k] == NO_LAW_VALUE or is_on(m, k, e.state[m.port_machine[k]]):
        return True
    if m.port_gap_pair[k] < 0:
        return m.port_gap_constant[k] <= 0.0
    evaluate_gap(e, e.laws, k, e.shown)
    stack = e.work.stack
    gap = stack.finite[stack.top]
    return sign_at(stack, stack.top) <= 0 or gap <= CLOSED * e.laws.largest[k]


def forget_bonds(e: Engine) -> None:
    """Forget how bonds were: the instant is settled."""
    if e.model.laws > 0:
        e.laws.bonds_noted = False
