"""Contacts whose gap jumps away from them: the edge of a table, a hole that opens in a floor.

A contact that is closed stays so for what it carries. Its gap is not asked, as it is zero but for
what integration leaves of it. Where the gap has another value behind a kink than before it, with
the same state, there is no contact any more: there it is asked as that of an open one.
"""

from __future__ import annotations

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.inputs.interval import moment
from hybond.engine.laws.law_instant import evaluate_gap, is_left, is_on
from hybond.engine.mode.equations import mode_of
from hybond.engine.surfaces.values import set_state
from hybond.engine.words import Floats


def some_closed_move(e: Engine) -> bool:
    """Whether there is a closed contact whose gap is not a constant."""
    m = e.model
    found = False
    for k in range(m.ports):
        found = found or (m.port_gap[k] >= 0 and is_on(m, k, e.state[m.port_machine[k]]))
    return found


def note_closed(e: Engine) -> None:
    """Note gaps as they are with the present state just before an instant that is to be settled."""
    # a run that begins with a change has no mode yet
    if mode_of(e, e.state) == OK:
        before = moment(e.model, e.t)
        note_gaps(e, e.t - 2.0 * before, e.y, e.laws.gap_earlier)
        note_gaps(e, e.t - before, e.y, e.laws.gap_before)


def keep_gaps(e: Engine) -> None:
    """Keep gaps as they are at the end of a run, for one that goes on with a change."""
    if e.model.laws > 0:
        note_gaps(e, e.t, e.y, e.laws.gap_before)
        e.laws.gaps_noted = False


def take_up_gaps(e: Engine, known: bool, given: bool) -> None:
    """Let gaps before the first instant be those at the end of the run before, if these are known.

    Where a state is `given`, nothing is known, and what it has closed may be apart. A change of
    what a gap is made of is none of what it was.
    """
    if e.model.laws == 0:
        return
    e.laws.gaps_noted = known
    e.laws.gaps_given = given
    for k in range(e.model.ports if known else 0):
        e.laws.gap_earlier[k] = e.laws.gap_before[k]


def note_gaps(e: Engine, t: float, y: Floats, gaps: Floats) -> None:
    """Note all gaps as they are at a time before the instant that is to be settled."""
    m = e.model
    set_state(e, e.mode, e.shown, t, y)
    for k in range(m.ports):
        gaps[k] = value(m, m.port_gap[k], e.shown) if m.port_gap[k] >= 0 else 0.0
    e.laws.gaps_noted = True


def some_is_left(e: Engine, t: float, y: Floats) -> bool:
    """Whether a closed contact has been left by its gap since gaps were noted."""
    m = e.model
    r = e.laws
    set_state(e, e.mode, e.shown, t, y)
    found = False
    for k in range(m.ports):
        if m.port_gap_pair[k] >= 0 and is_on(m, k, e.state[m.port_machine[k]]):
            evaluate_gap(e, r, k, e.shown)
            found = found or is_left(e, r, k, e.work.stack.finite[e.work.stack.top])
    return found


def forget_gaps(e: Engine) -> None:
    """Forget how gaps were: the instant is settled."""
    if e.model.laws > 0:
        e.laws.gaps_noted = False
