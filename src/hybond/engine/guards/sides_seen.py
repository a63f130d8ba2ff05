"""On which side of zero the comparisons of guards were clear last, step after step.

What rounding leaves of a comparison has no sign of its own: it counts as what it was. A comparison
that comes up to zero by leaps, from one instant to the next, as the error of a sampled controller
does, is one that creeps: in the proportion of the last two differences the next would be rounding.
A counter does not: it comes to its threshold in steps that are all alike.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.far_guards import NARROW
from hybond.engine.guards.guard_values import atom_at, size_here
from hybond.engine.guards.locator import NO_KINK, Locator
from hybond.engine.guards.quartic import COEFFICIENTS
from hybond.engine.guards.rest_records import SWINGS
from hybond.engine.methods.control import is_propagated
from hybond.engine.methods.stepping import by_radau

TOLD: Final = 100.0
"""Times the tolerance of explicit steps from which on a comparison is clear of their error."""
LEFT: Final = 4.0
"""Times its rounding that is left of a comparison which creeps."""


def note_sides(e: Engine, g: Locator) -> bool:
    """Note the sides of comparisons where the step begins, and where it ends unless at a guard.

    Whether one that was kept on its side moves, and is kept no more.
    """
    q = e.rests
    if e.slide.k > 0 or e.model.disks > 0 or g.failed:
        return False
    moved = False
    begins = e.step.t0 == q.began_at and q.seen_at != e.step.t0
    clear = NARROW
    if not is_propagated(e) and not by_radau(e):
        clear = max(clear, TOLD * e.model.rtol)
    # one instant after the other: to go to and fro between them is to solve for each comparison
    for k in range(g.guards):
        for a in range(g.atom_first[k], g.atom_first[k + 1] if has_sides(e, g, k) else 0):
            if not is_known_between(e, g, a) and g.solved[k] == 0:
                here = atom_at(e, g, a, e.step.t0)
                q.before[g.atom[a]] = here
    for k in range(g.guards):
        for a in range(g.atom_first[k], g.atom_first[k + 1] if has_sides(e, g, k) else 0):
            note_side(e, g, k, a, clear, begins)
            moved = leaves_zero(e, g.rule[k], g.atom[a]) or moved
    if begins:
        q.seen_at = e.step.t0
    return moved


def has_sides(e: Engine, g: Locator, k: int) -> bool:
    """Whether sides of the comparisons of a guard are noted: it is that of a rule, and followed."""
    rule = g.rule[k]
    return rule >= 0 and e.rests.follows[rule] != 0 and g.part[k] < 0 and g.side[k] == NO_KINK


def is_known_between(e: Engine, g: Locator, a: int) -> bool:
    """Whether a comparison is known as a polynomial of the step."""
    return g.sums.known.at[a] != 0 and g.shown_to == e.step.t1


def leaves_zero(e: Engine, rule: int, which: int) -> bool:
    """Whether a comparison that was kept on its side has moved by more than rounding.

    What a guard was passed over for is not told from its limit at instants, either way.
    """
    q = e.rests
    if q.atom[which] == 0 or q.away[which] != 0:
        return False
    moved = math.fabs(q.here[which] - q.before[which])
    if moved <= LEFT * ROUNDING * q.extent[which] and math.fabs(q.here[which]) <= q.band[which]:
        return False
    if q.since[rule] != 0:
        q.away[which] = 1
    else:
        q.atom[which] = 0
    return True


def note_side(e: Engine, g: Locator, k: int, a: int, clear: float, begins: bool) -> None:
    """Note the side of one of them."""
    q = e.rests
    which = g.atom[a]
    if is_known_between(e, g, a):
        at = COEFFICIENTS * a
        before = g.step[at]
        here = before + g.step[at + 1] + g.step[at + 2] + g.step[at + 3] + g.step[at + 4]
        size = g.extent[a] + sampled_terms(e, g, a)
    elif g.solved[k] != 0:
        # nowhere near zero in the step
        q.here[which] = math.inf
        q.before[which] = 0.0
        q.crosses[which] = 0
        q.side[which] = g.sign[a] if g.sign[a] != 0 else q.side[which]
        q.creeps[which] = 0
        return
    else:
        before = q.before[which]
        here = atom_at(e, g, a, e.step.t1)
        size = size_here(e, g, a)
    if begins:
        see_leap(e, which, before, size)
    if math.fabs(before) > clear * size:
        put_side(e, which, before)
    if g.at == math.inf and math.fabs(here) > clear * size:
        put_side(e, which, here)
    q.crosses[which] = 1 if before * here < 0.0 and math.fabs(here) > ROUNDING * size else 0
    if here * q.last[which] < 0.0 and math.fabs(here) > ROUNDING * size:
        q.creeps[which] = 0
    q.here[which] = here
    q.before[which] = before
    q.extent[which] = size


def put_side(e: Engine, which: int, here: float) -> None:
    """Note the side on which a comparison is clear."""
    q = e.rests
    side = 1 if here > 0.0 else -1
    if q.side[which] == -side:
        q.turns[which] = min(q.turns[which] + 1, SWINGS)
    q.side[which] = side


def sampled_terms(e: Engine, g: Locator, a: int) -> float:
    """Return the size of what sampled signals in a comparison were made of."""
    s = g.sums
    m = e.model
    total = 0.0
    for p in range(s.first.at[a], s.first.at[a + 1] if m.samples > 0 else s.first.at[a]):
        k = s.column.at[p] - m.storages
        if k >= 0:
            total += s.size.at[p] * e.sample_terms[k]
    return total


def see_leap(e: Engine, which: int, here: float, size: float) -> None:
    """See what a comparison has become since time went on last: whether it creeps up to zero.

    What was elsewhere meanwhile does not, however close to zero its instants are: it crosses there.
    """
    q = e.rests
    near = ROUNDING * size
    if not math.fabs(here) > near:
        return
    meanwhile = q.here[which]
    q.older[which] = q.last[which]
    q.last[which] = here
    q.creeps[which] = 0
    low = min(q.older[which], here) - near
    between = meanwhile >= low and meanwhile <= max(q.older[which], here) + near
    if between and q.older[which] * here > 0.0 and math.fabs(here) < math.fabs(q.older[which]):
        left = here * (here / q.older[which])
        q.creeps[which] = 1 if math.fabs(left) <= LEFT * near else 0
        q.some = q.some or q.creeps[which] != 0


def creeps_in(e: Engine, g: Locator, a: int, t: float) -> bool:
    """Whether a comparison that is zero in the step creeps, and is not beyond zero at its end."""
    q = e.rests
    which = g.atom[a]
    if q.creeps[which] == 0:
        return False
    near = LEFT * ROUNDING * q.extent[which]
    here = atom_at(e, g, a, t)
    end = atom_at(e, g, a, e.step.t1)
    beyond = -end if q.last[which] > 0.0 else end
    return math.fabs(here) <= near and beyond <= near


def is_near(e: Engine, which: int) -> bool:
    """Whether a comparison ends the step so near to zero that the run may not tell it from that."""
    q = e.rests
    rtol = e.model.rtol if e.model.rtol == e.model.rtol else 0.0
    return math.fabs(q.here[which]) <= max(NARROW, TOLD * rtol) * q.extent[which]
