"""Guards that do not come to hold in a step for reasons that are seen at once: none is sampled.

Some compare nothing that moves, or nothing but what counts as zero all over the step, as of diodes
far down a ladder that nothing has reached yet: asked once, they are not asked again as long as that
is so, whatever rounding says.

Others are far from holding, or from ceasing to, all over the step. What a guard compares may be a
sum of the state and of sources that move by laws of time. The state is a polynomial of the step,
bounded by its coefficients, and by how far it is off its constraints where it is put on them. A
source is sampled once for all guards, and bounded as a sampled comparison is: by the polynomial
through its samples, where that leaves next to nothing of them. Where the sum of both bounds is
clear of zero, the comparison keeps its sign.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import largest
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_shape import NEAR, ROUNDED, SLACK, UNRESOLVED, rest_below
from hybond.engine.guards.guard_values import holds_at, keep_sample, put_on_constraints
from hybond.engine.guards.locator import FRACTION, KEPT, SAMPLES, Locator
from hybond.engine.guards.quartic import COEFFICIENTS
from hybond.engine.inputs.interval import set_time
from hybond.engine.jumps.tied import put_tied
from hybond.engine.methods.stepping import between
from hybond.engine.mode.digits.part_energies import find_energies, reach_of_sum
from hybond.engine.mode.mode_records import is_constrained

NARROW: Final = 1e-9
"""Part of its terms from which on a comparison is clear of zero: no rounding has a say in it."""
NOTHING: Final = 0.1
"""Part of what counts as zero below which a comparison is zero however it is evaluated, ..."""
EVALUATED: Final = 64.0 * EPSILON
"""... which may make so much of its terms."""
DRIFTS: Final = 4.0
"""Times that is taken how far a step is off constraints at every other sample."""


def see_drift(e: Engine, g: Locator) -> None:
    """See how far the states of a step are off the constraints that guards are asked on."""
    held = g.held and is_constrained(e.mode)
    if not (held or g.drifted):
        return
    g.drifted = held
    for k in range(e.states):
        g.drift[k] = 0.0
    if not held:
        return
    for i in range(0, SAMPLES, 2):
        row = i // 2 * e.states
        t = sampled_time(e, i)
        between(e, t, g.y)
        for k in range(e.states):
            g.moved[row + k] = g.y[k]
        found = True
        if g.tied:
            put_tied(e, t, g.y)
        else:
            found = put_on_constraints(e, t, g.y) == OK
        if found:
            keep_sample(e, g, t)
        for k in range(e.states):
            g.moved[row + k] = g.y[k] - g.moved[row + k]
            off = DRIFTS * math.fabs(g.moved[row + k])
            g.drift[k] = max(g.drift[k], off) if found and math.isfinite(off) else math.inf


def sampled_time(e: Engine, i: int) -> float:
    """Return the instant of a sample in the step."""
    within = e.step.t0 + (e.step.t1 - e.step.t0) * FRACTION[i]
    return e.step.t1 if i == SAMPLES - 1 else within


def is_within(e: Engine, g: Locator, a: int, room: float) -> bool:
    """Whether a comparison is off by no more than that, its states being moved together.

    What moves both sides of it by the same, as all that hangs on a capacitor, it sees nothing of.
    """
    if g.astray[a] <= room:
        return True
    if not (room > 0.0 and math.isfinite(g.astray[a])):
        return False
    s = g.sums
    for i in range(KEPT):
        g.d[i] = 0.0
    for p in range(s.first.at[a], s.first.at[a + 1]):
        k = s.column.at[p]
        if g.drift[k] != 0.0:
            factor = s.factor.at[p]
            for i in range(KEPT):
                g.d[i] += factor * g.moved[i * e.states + k]
    most = largest(KEPT, g.d)
    g.astray[a] = min(g.astray[a], DRIFTS * most + EVALUATED * g.astray[a])
    return g.astray[a] <= room


def is_still(g: Locator, a: int) -> bool:
    """Whether nothing that a comparison reads moves in the step."""
    at = COEFFICIENTS * a
    for i in range(1, COEFFICIENTS):
        if g.step[at + i] != 0.0:
            return False
    return g.astray[a] == 0.0


def is_nothing(e: Engine, g: Locator, a: int) -> bool:
    """Whether a comparison counts as zero all over the step, as large as energy makes its terms."""
    at = COEFFICIENTS * a
    largest = reach_of_sum(e.mode, g.sums, a)
    top = EVALUATED * g.extent[a]
    if largest <= 0.0 or not top <= largest:
        return False
    top = EVALUATED * max(g.extent[a] - largest, 0.0)
    for i in range(COEFFICIENTS):
        top += math.fabs(g.step[at + i])
    return is_within(e, g, a, NOTHING * ROUNDING * largest - top)


def is_idle(e: Engine, g: Locator, k: int) -> bool:
    """Whether the truth of a guard does not change in the step, and it does not hold."""
    find_energies(e, e.mode)
    known = g.still[k] != 0
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sums.known.at[a] == 0:
            return False
        value_then = g.still_value[a]
        extent_then = g.still_extent[a]
        if is_nothing(e, g, a):
            g.still_value[a] = 0.0
            g.still_extent[a] = -1.0
        elif is_still(g, a):
            g.still_value[a] = g.step[COEFFICIENTS * a]
            g.still_extent[a] = g.extent[a]
        else:
            g.still[k] = 0
            return False
        known = known and g.still_value[a] == value_then and g.still_extent[a] == extent_then
    if known:
        return True
    g.still[k] = 0 if holds_at(e, g, k, e.step.t1) else 1
    return g.still[k] != 0


def sample_waves(e: Engine, g: Locator) -> None:
    """Sample the sources that stand in comparisons, and bound them."""
    s = g.sums
    m = e.model
    sources = e.mode.sources
    for w in range(2 * sources):
        g.wave_shown[w] = 0
    for p in range(s.terms):
        g.wave_shown[s.wave_source.at[p]] = 1
    for i in range(SAMPLES):
        set_time(e, e.v, sampled_time(e, i))
        for w in range(2 * sources):
            if g.wave_shown[w] != 0:
                source = e.mode.source[w if w < sources else w - sources]
                law = m.source_value[source] if w < sources else m.source_rate[source]
                g.wave[w * SAMPLES + i] = value(m, law, e.v)
    for w in range(2 * sources):
        if g.wave_shown[w] != 0:
            bound_wave(g, w)


def bound_wave(g: Locator, w: int) -> None:
    """Bound a source by its samples; leave it as one that these do not show if they do not."""
    at = w * SAMPLES
    least = g.wave[at]
    most = least
    for i in range(SAMPLES):
        least = min(least, g.wave[at + i])
        most = max(most, g.wave[at + i])
    size = max(math.fabs(least), math.fabs(most))
    spread = most - least
    rest = rest_below(g, g.wave, at, size)
    if not (rest <= UNRESOLVED * spread or rest <= ROUNDED * size):
        g.wave_shown[w] = 0
        return
    middle = 0.5 * (least + most)
    away = (0.5 * g.swing + NEAR) * spread + 3.0 * rest + SLACK * size
    g.wave_low[w] = middle - away
    g.wave_high[w] = middle + away


def is_far(e: Engine, g: Locator, k: int) -> bool:
    """Whether all comparisons of a guard are clear of zero all over the step; notes their signs."""
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        if g.sums.known.at[a] == 0 and g.sums.waved.at[a] == 0:
            return False
        if not find_far_sign(e, g, a):
            return False
    return True


def find_far_sign(e: Engine, g: Locator, a: int) -> bool:
    """Note the sign that a comparison keeps, far from zero; False if it may come near."""
    s = g.sums
    at = COEFFICIENTS * a
    c0 = g.step[at]
    c1 = g.step[at + 1]
    c2 = g.step[at + 2]
    c3 = g.step[at + 3]
    # within the hull of its coefficients in Bernstein's basis
    b1 = c0 + 0.25 * c1
    b2 = c0 + 0.5 * c1 + c2 / 6.0
    b3 = c0 + 0.75 * c1 + 0.5 * c2 + 0.25 * c3
    b4 = c0 + c1 + c2 + c3 + g.step[at + 4]
    low = min(min(min(c0, b1), min(b2, b3)), b4)
    high = max(max(max(c0, b1), max(b2, b3)), b4)
    extent = g.extent[a]
    for p in range(s.wave_first.at[a], s.wave_first.at[a + 1]):
        w = s.wave_source.at[p]
        if g.wave_shown[w] == 0:
            return False
        one = s.wave_factor.at[p] * g.wave_low[w]
        other = s.wave_factor.at[p] * g.wave_high[w]
        low += min(one, other)
        high += max(one, other)
        extent += max(math.fabs(one), math.fabs(other))
    away = max(low, -high)
    near = NARROW * extent
    g.sign[a] = 0
    if away > near and is_within(e, g, a, away - near):
        g.sign[a] = 1 if low > 0.0 else -1
    return g.sign[a] != 0 and math.isfinite(high - low)
