"""Guards that begin to hold within one instant are settled together.

Complementary gates cross one threshold by expressions that round differently. Which of them is
first is no part of the model: the instant is the last of those that cannot be told apart, and there
all of them hold.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.bracket import bracket
from hybond.engine.guards.guard_values import (
    atom_at,
    atom_here,
    holds_at,
    look,
    look_at_time,
    show,
    size_here,
    terms_here,
    test_here,
)
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, NONE, Locator
from hybond.engine.guards.quartic import COEFFICIENTS, DEGREE, horner
from hybond.engine.guards.solved_guards import is_known
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.mode.digits.part_energies import see_energy
from hybond.engine.mode.mode_records import is_constrained

LAST_PLACES: Final = 8.0
"""Units in the last place within which a jump and what is watched for it may differ."""
NEAR_ZERO: Final = 1e-6
"""Part of its terms from which on rounding has no say in a comparison."""
BY_FAR: Final = 1e-3
"""Part of its terms that is far from zero: it takes more than an instant to get there, ..."""
LONG: Final = 1e6
"""... in a step that is so many of them long."""


def last_of_instant(e: Engine, g: Locator, t: float, top: float) -> float:
    """Return the last instant in ``[t, top]`` at which a guard begins to hold, `t` if none does.

    Guards that hold at `t` must still hold there: what is only touched at `t` is an instant alone.
    """
    last = t
    if not may_others(e, g, t, top):
        return last
    look(e, g, top)
    for k in range(g.guards):
        g.done[k] = 1 if may_hold(e, g, k) else 0
    ask_done(e, g, t, False)
    ask_done(e, g, top, True)
    for k in range(g.guards):
        if g.done[k] != 0 and not g.failed:
            last = max(last, bracket(e, g, k, t, top))
    if last > t:
        for k in range(g.guards):
            g.done[k] = 1 if g.side[k] == NO_KINK else 0
        ask_done(e, g, t, True)
        ask_done(e, g, last, False)
        for k in range(g.guards):
            last = t if g.done[k] != 0 else last
    show(e, g, ALL_PARTS)
    return last


def with_its_energy(e: Engine, g: Locator, t: float, top: float) -> float:
    """Return the first instant in ``[t, top]`` at which one that holds at `t` does when settled.

    Beside junction laws rounding is measured by the largest energy there has been, and a step has
    been asked with that of its beginning. Where it has led to more, a guard that is found at the
    rim of rounding would be none once it is settled, and laws that carry nothing would be decided
    alone there. It is `t` if there is no such instant.
    """
    if e.model.laws == 0 or e.slide.k > 0:
        return t
    for k in range(g.guards):
        g.done[k] = 1 if g.side[k] == NO_KINK else 0
    ask_done(e, g, t, True)
    look(e, g, t)
    seen = e.energies_seen
    see_energy(e, g.y)
    first = t
    if e.energies_seen != seen and not g.failed:
        show(e, g, ALL_PARTS)
        g.looked = math.nan
        first = first_of_done(e, g, t, top)
    show(e, g, ALL_PARTS)
    return first


def last_at_end(e: Engine, g: Locator, t: float, top: float) -> float:
    """Return the last instant of one with a timed event at `t`, where rounding is as it is settled.

    What was found at its rim would be left for an instant of its own just after that.
    """
    first = with_its_energy(e, g, t, top)
    return first if g.failed else last_of_instant(e, g, first, top)


def first_of_done(e: Engine, g: Locator, t: float, top: float) -> float:
    """Return the first instant in ``[t, top]`` at which one of those in `g.done` holds, or `t`."""
    for k in range(g.guards):
        if g.done[k] != 0 and (g.failed or holds_at(e, g, k, t)):
            return t
    ask_done(e, g, top, True)
    first = math.inf
    for k in range(g.guards):
        if g.done[k] != 0 and not g.failed:
            first = min(first, bracket(e, g, k, t, top))
    return first if first < math.inf else t


def may_others(e: Engine, g: Locator, t: float, top: float) -> bool:
    """Whether any guard but the one that was found at `t` may begin to hold up to `top`."""
    plain = e.mode.dynamics == 0 and not is_constrained(e.mode)
    shown = plain and g.shown_to == e.step.t1
    long = (e.step.t1 - e.step.t0) > LONG * (top - t)
    for k in range(g.guards):
        if g.side[k] != NO_KINK or (plain and g.found_at == t and k == g.found):
            continue
        if not (shown and long and is_false_by_far(e, g, k)):
            return True
    return False


def is_false_by_far(e: Engine, g: Locator, k: int) -> bool:
    """Whether a guard is false in the step, and its comparisons are far from zero at its end.

    They keep their signs in the step, with which it was asked.
    """
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sums.known.at[a] == 0 or g.sign[a] == 0:
            return False
        there = horner(g.step, COEFFICIENTS * a, DEGREE, 1.0)
        if not math.fabs(there) > BY_FAR * g.extent[a]:
            return False
    return g.solved[k] != 0 and is_known(e, g, k, e.step.t1)


def is_of_time(e: Engine, g: Locator, t: float, last: float) -> bool:
    """Whether a guard holds at `last` that would not, in the state there, if the time were `t`."""
    for k in range(g.guards):
        g.done[k] = 1 if g.side[k] == NO_KINK else 0
    ask_done(e, g, last, True)
    look_at_time(e, g, t, last)
    ask_done(e, g, t, False)
    found = False
    for k in range(g.guards):
        found = found or g.done[k] != 0
    g.looked = math.nan
    show(e, g, ALL_PARTS)
    return found


def ask_done(e: Engine, g: Locator, t: float, holds: bool) -> None:
    """Leave those guards in `g.done` that hold at `t`, or those that do not.

    All at one instant: what they read is found once for each.
    """
    for k in range(g.guards):
        if g.done[k] != 0 and (g.failed or holds_at(e, g, k, t) != holds):
            g.done[k] = 0


def may_hold(e: Engine, g: Locator, k: int) -> bool:
    """Whether a guard holds where it is looked, or would if rounding counts as zero."""
    if g.side[k] != NO_KINK:
        return False
    near = test_here(e, g, k)
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if not near:
            here = math.fabs(atom_here(e, g, a))
            size = size_here(e, g, a)
            near = here <= NEAR_ZERO * size
    return near


def ends_in_rounding(e: Engine, g: Locator) -> bool:
    """Whether a guard compares what is rounding of its terms, at the end of the last step."""
    found = False
    look(e, g, e.step.t1)
    for k in range(g.guards):
        if g.side[k] == NO_KINK and g.margin[k] < 0:
            for a in range(g.atom_first[k], g.atom_first[k + 1]):
                size = terms_here(e, g, k, a)
                found = found or (size > 0.0 and math.fabs(atom_here(e, g, a)) <= ROUNDING * size)
    show(e, g, ALL_PARTS)
    return found


def is_kink_alone(e: Engine, g: Locator) -> bool:
    """Whether nothing but kinks has ended the step at the instant found."""
    alone = e.model.kinks + e.model.slide_kinks > 0
    for k in range(g.guards):
        alone = alone and (g.side[k] != NO_KINK or not holds_at(e, g, k, g.at))
    show(e, g, ALL_PARTS)
    return alone


def before_kink(e: Engine, g: Locator, at: float) -> float:
    """Return an instant at which none of the kinks that end the step there is passed.

    Those are in `g.done` then.
    """
    for k in range(g.guards):
        ends = g.side[k] != NO_KINK
        ends = ends and holds_at(e, g, k, at)
        g.done[k] = 1 if ends else 0
    reach = LAST_PLACES * spacing(at)
    before = at
    here = False
    while not here and before > e.step.t0:
        before = at - reach
        reach = 2.0 * reach
        here = True
        for k in range(g.guards):
            if here and g.done[k] != 0:
                there = atom_at(e, g, g.atom_first[k], before)
                here = float(g.side[k]) * there > 0.0
    return before


def kink_there(e: Engine, g: Locator) -> int:
    """Return the guard of the kink that has ended the step at the instant found, or NONE."""
    for k in range(g.guards):
        if g.side[k] != NO_KINK and holds_at(e, g, k, g.at):
            return k
    return NONE


def kink_of(e: Engine, g: Locator, k: int) -> int:
    """Return which of the model's kinks is watched as guard k."""
    return g.atom[g.atom_first[k]] - e.model.kink_atom
