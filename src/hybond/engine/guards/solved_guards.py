"""Guards whose comparisons are polynomials of the step: where they begin to hold is solved for.

Between two neighbouring roots of its comparisons the truth of a guard does not change, and it is
that of the signs that these have there. So a guard is asked once between any two; not at all with
signs that it was asked with before in the same motion, and did not hold. At a root it has the truth
of one of both sides, but where several comparisons are zero, or one of them only touches it: there
it is asked as well.

Comparisons that are nowhere near zero in the step keep their signs too, whatever else stands in
them (`far_guards`).

What begins at zero, and has no slope there, leaves it by a power of time: near its beginning the
polynomial is what the step is off by, and has the sign of that. It is asked from where it has one
of its own. So it is a few steps later, where each makes so many times as much of it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.bracket import around, bracket, halve
from hybond.engine.guards.candidates import keep, sort
from hybond.engine.guards.far_guards import NARROW, is_far, is_idle, sample_waves, see_drift
from hybond.engine.guards.guard_values import (
    atom_at,
    holds_at,
    keeps,
    level_in_motion,
    rests,
    terms_here,
)
from hybond.engine.guards.kinks_afar import stays_afar
from hybond.engine.guards.locator import NO_KINK, Locator
from hybond.engine.guards.quartic import (
    COEFFICIENTS,
    DEGREE,
    horner,
    solve_monotone,
    solve_quartic,
    turns,
)
from hybond.engine.guards.step_polynomials import MOVES, take_step
from hybond.engine.guards.unresolved import see_carried
from hybond.engine.method_numbers import RK4
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.stepping import by_radau
from hybond.engine.mode.mode_records import is_constrained

FEW: Final = 4
"""Comparisons of a guard whose signs are remembered; there is a bit for all signs together."""
OFF: Final = 300.0
"""How many times the error of a step its dense output may be off in a coefficient: where a power of
five is left, that has 0.0058 at three fifths of the step, and 1.5 in the cube, ..."""
ROUNDED: Final = 2.0**-42
"""... and part of the terms of a comparison that rounding leaves there."""
GROWS: Final = 8.0
"""How many times what a step begins with it ends with at the least, where it still leaves zero."""
TERMS: Final = 16.0
"""How many times its terms are rounded a sum of rates may be."""


def solve_guards(e: Engine, g: Locator) -> bool:
    """Find the first instant at which any of these guards holds; whether others are left."""
    left = False
    cubic = by_radau(e) and not e.curved
    shown = e.slide.k == 0 and (not cubic or put_dense_of_stages(e))
    # what is put on constraints is no polynomial any more
    may = shown and not (g.held and is_constrained(e.mode))
    waves = g.sums.terms > 0
    if shown:
        see_drift(e, g)
        take_step(e, g)
        g.shown_to = e.step.t1
        if waves:
            sample_waves(e, g)
        if e.model.laws > 0 and e.model.tells != 0:
            see_carried(e, g)
    for k in range(g.guards):
        own = may and g.side[k] == NO_KINK and (not cubic or begins_clear(g, k))
        g.solved[k] = 1 if own and is_solved(g, k) else 0
        if g.solved[k] == 0:
            if g.side[k] == NO_KINK:
                quiet = shown and never_holds(e, g, k, waves or not may)
            else:
                quiet = shown and stays_afar(e, g, k)
            g.solved[k] = 1 if quiet and not g.failed else 0
            left = left or g.solved[k] == 0
        elif not g.failed and not is_quiet(e, g, k):
            at = of_polynomials(e, g, k, g.at)
            if at < g.at:
                g.at = at
                g.found = k
                g.found_at = math.nan if g.about else at
    return left


def never_holds(e: Engine, g: Locator, k: int, far: bool) -> bool:
    """Whether it is seen at once that a guard does not come to hold in the step."""
    return is_idle(e, g, k) or (far and is_far(e, g, k) and is_quiet(e, g, k))


def put_dense_of_stages(e: Engine) -> bool:
    """Put the dense output of Radau IIA where that of other methods is, if it is of one piece."""
    r = e.radau
    n = e.states
    if r.pieces > 1:
        return False
    copy_floats(4 * n, r.piece_polynomial, e.step.dense)
    return True


def begins_clear(g: Locator, k: int) -> bool:
    """Whether all comparisons of a guard are clear of zero where the step begins.

    The dense output of Radau IIA has the slope there but for rounding, with which what rises from
    zero may dip below it.
    """
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sums.known.at[a] != 0 and not math.fabs(g.step[COEFFICIENTS * a]) > (
            NARROW * g.extent[a]
        ):
            return False
    return True


def is_solved(g: Locator, k: int) -> bool:
    """Whether all comparisons of a guard are polynomials, and more than rounding in the step.

    Notes the signs that they keep.
    """
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sums.known.at[a] == 0 or not find_sign(g, a):
            return False
    return True


def find_sign(g: Locator, a: int) -> bool:
    """Note the sign that a comparison keeps in the step; False if it is no more than rounding.

    A polynomial is within the hull of its coefficients in Bernstein's basis.
    """
    at = COEFFICIENTS * a
    c0 = g.step[at]
    c1 = g.step[at + 1]
    c2 = g.step[at + 2]
    c3 = g.step[at + 3]
    b1 = c0 + 0.25 * c1
    b2 = c0 + 0.5 * c1 + c2 / 6.0
    b3 = c0 + 0.75 * c1 + 0.5 * c2 + 0.25 * c3
    b4 = c0 + c1 + c2 + c3 + g.step[at + 4]
    low = min(min(min(c0, b1), min(b2, b3)), b4)
    high = max(max(max(c0, b1), max(b2, b3)), b4)
    near = NARROW * g.extent[a]
    g.sign[a] = 1 if low > near else -1 if high < -near else 0
    return (low < -near or high > near) and math.isfinite(high - low)


def is_quiet(e: Engine, g: Locator, k: int) -> bool:
    """Whether a guard does not hold in the step, all of whose comparisons keep their signs."""
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sign[a] == 0:
            return False
    if is_known(e, g, k, e.step.t1):
        return True
    if holds_at(e, g, k, e.step.t1):
        return False
    remember(e, g, k, e.step.t1)
    return True


def of_polynomials(e: Engine, g: Locator, k: int, before: float) -> float:
    """Return the first instant of the step at which a guard holds, infinity if none.

    `before` is one at which another guard does.
    """
    end = math.inf
    if before < math.inf and not holds_at(e, g, k, before):
        # unless it holds and ceases to before that, it becomes true later than another guard
        end = before
    touches = find_zeros(e, g, k)
    low = e.step.t0
    quiet = low
    for i in range(g.mark.count + 1):
        last = i == g.mark.count
        high = e.step.t1 if last else g.mark.at[i]
        middle = 0.5 * (low + high)
        if low >= min(before, end) or g.failed:
            break
        hidden = is_hidden(e, g, k, middle)
        told = not hidden and has_begun(e, g, k, middle)
        within = middle > low and middle < high and middle < end
        if within and told and not is_known(e, g, k, middle):
            if holds_at(e, g, k, middle):
                if i == 0:
                    # no sooner than the step tells from its beginning
                    soon = low + EPSILON * (e.step.t1 - low)
                    return max(bracket(e, g, k, low, middle), min(soon, middle))
                return begin_near(e, g, k, quiet, low, middle)
            remember(e, g, k, middle)
        quiet = max(quiet, middle) if middle < high and not hidden else quiet
        unclear = count_unclear(e, g, k, high)
        asked = touches or unclear > (0 if last else 1) or not told
        # a root in the last place of the step has nothing behind it but the end
        asked = asked or (last and high > e.step.t0 and not (low < middle and middle < high))
        if not last and asked:
            asked = has_begun(e, g, k, high) and not is_hidden(e, g, k, high)
        if high < end and asked and holds_at(e, g, k, high):
            return begin_near(e, g, k, quiet, high, high)
        low = high
    return math.inf


def has_begun(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Whether what a guard compares has left zero, where it begins there, by a part that is known.

    A coefficient that is no more than what the step is off by is not known. The lowest one that is
    tells the sign, from where those that are not could not outweigh it any more, and before they
    do again.
    """
    x = (t - e.step.t0) / (e.step.t1 - e.step.t0)
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sign[a] != 0 or g.step[COEFFICIENTS * a] != 0.0:
            continue
        off = error_of(e, g, a)
        sloped = slope_rounding(e, g, a)
        at = COEFFICIENTS * a
        hidden = 0.0
        known = 0.0
        power = x
        for i in range(1, COEFFICIENTS):
            size = math.fabs(g.step[at + i])
            if not size > (sloped if i == 1 else off):
                hidden += size * power
            elif known == 0.0:
                known = size * power
            power *= x
        if not known > 2.0 * hidden:
            return False
    return True


def is_hidden(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Whether a guard compares something that the step makes many times what it begins with.

    If that is less than the step may be off by, it has no sign of its own where what is known of it
    is outweighed by what is not. Where the step ends it has that of the state, and if that is
    another than where it begins, there is a root between.
    """
    x = (t - e.step.t0) / (e.step.t1 - e.step.t0)
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        at = COEFFICIENTS * a
        begins = g.step[at]
        ends = horner(g.step, at, DEGREE, 1.0)
        if g.sign[a] != 0 or begins == 0.0 or (begins > 0.0) != (ends > 0.0):
            continue
        if not math.fabs(ends) > GROWS * math.fabs(begins):
            continue
        off = error_of(e, g, a)
        if math.fabs(begins) > off:
            continue
        sloped = slope_rounding(e, g, a)
        hidden = 0.0
        known = begins
        power = x
        for i in range(1, COEFFICIENTS):
            size = math.fabs(g.step[at + i])
            if size > (sloped if i == 1 else off):
                known += g.step[at + i] * power
            else:
                hidden += size * power
            power *= x
        if not math.fabs(known) > 2.0 * hidden:
            return True
    return False


def error_of(e: Engine, g: Locator, a: int) -> float:
    """Return how far a coefficient of a comparison may be off; a fixed step does not know that."""
    s = g.sums
    off = 0.0
    known = e.model.method < RK4
    for p in range(s.first.at[a], s.first.at[a + 1] if known else s.first.at[a]):
        k = s.column.at[p]
        if g.motion[k] == MOVES:
            off += math.fabs(s.factor.at[p] * e.step.error[k])
    return max(OFF * off, ROUNDED * g.extent[a])


def slope_rounding(e: Engine, g: Locator, a: int) -> float:
    """Return the rounding of the first coefficient, which is the rate where the step begins."""
    s = g.sums
    size = 0.0
    for p in range(s.first.at[a], s.first.at[a + 1]):
        size += math.fabs(s.factor.at[p] * e.step.dense[s.column.at[p]])
    return TERMS * EPSILON * size


def begin_near(e: Engine, g: Locator, k: int, low: float, here: float, high: float) -> float:
    """Return when a guard begins to hold, about `here`; at `low` it does not yet."""
    if g.rough:
        g.about = True
        return here
    g.bracket_low = low
    g.bracket_high = high
    # if not there then a last place further on the comparison has changed its sign
    known = holds_at(e, g, k, here)
    around(e, g, k, here if known else min(here + spacing(here), high), known, -1, 0.0)
    return halve(e, g, k)


def find_zeros(e: Engine, g: Locator, k: int) -> bool:
    """Mark the instants at which comparisons of a guard are zero; whether one only touches it."""
    touches = False
    g.mark.count = 0
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sign[a] != 0:
            continue
        q = g.quartic
        if turns(g.step, COEFFICIENTS * a):
            solve_quartic(q, g.step, COEFFICIENTS * a)
        else:
            solve_monotone(q, g.step, COEFFICIENTS * a)
        for i in range(q.roots):
            keep(g.mark, instant_of(e, q.root[i]))
        for i in range(q.turns):
            value = horner(g.step, COEFFICIENTS * a, DEGREE, q.turn[i])
            if math.fabs(value) <= NARROW * g.extent[a]:
                touches = True
                keep(g.mark, instant_of(e, q.turn[i]))
    sort(g.mark)
    return touches


def instant_of(e: Engine, x: float) -> float:
    """Return the instant at a part of the step."""
    return min(e.step.t0 + x * (e.step.t1 - e.step.t0), e.step.t1)


def sign_there(e: Engine, g: Locator, a: int, t: float) -> int:
    """Return the sign of a comparison at an instant; 0 where it is not clear of zero."""
    if g.sign[a] != 0:
        return g.sign[a]
    x = (t - e.step.t0) / (e.step.t1 - e.step.t0)
    value = horner(g.step, COEFFICIENTS * a, DEGREE, x)
    near = NARROW * g.extent[a]
    return 1 if value > near else -1 if value < -near else 0


def count_unclear(e: Engine, g: Locator, k: int, t: float) -> int:
    """Return how many comparisons of a guard are not clear of zero at an instant."""
    many = 0
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        many += 1 if sign_there(e, g, a, t) == 0 else 0
    return many


def signs_there(e: Engine, g: Locator, k: int, t: float) -> int:
    """Return the bit that stands for the signs of all comparisons of a guard; 0: some have none."""
    first = g.atom_first[k]
    place = 0
    if g.atom_first[k + 1] - first > FEW:
        return 0
    for a in range(first, g.atom_first[k + 1]):
        sign = sign_there(e, g, a, t)
        if sign == 0:
            return 0
        place = 2 * place + (1 if sign > 0 else 0)
    return 1 << place


def is_known(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Whether a guard was asked with the signs that its comparisons have, and did not hold."""
    return (g.denied[k] & signs_there(e, g, k, t)) != 0


def remember(e: Engine, g: Locator, k: int, t: float) -> None:
    """Remember that a guard does not hold with the signs that its comparisons have.

    Not where one of them counts as zero, which is measured by what energy makes of its terms: where
    these have died away it may be clear of zero in the step, and is nothing all the same. A little
    later the guard holds with that very sign.
    """
    if rests(e, g, k) or keeps(e, g, k) or level_in_motion(e, g, k) != 0.0:
        return
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        here = atom_at(e, g, a, t)
        size = terms_here(e, g, k, a)
        if not math.fabs(here) > ROUNDING * size:
            return
    g.denied[k] = g.denied[k] | signs_there(e, g, k, t)
