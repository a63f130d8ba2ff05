"""Exact propagation of a mode that is linear: one step, and the size of the first.

The ends of steps are exact but for rounding, whatever their size. What limits it is the dense
output, a polynomial of degree 4 through the state at some parts of a step with its first
derivative: it is compared with the state at another part. A motion that died away is no longer
seen, however fast it was.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite, copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.dopri import error_norm_of
from hybond.engine.methods.linear.flow_records import ORDERS, PARTS, TERMS
from hybond.engine.methods.linear.propagate import (
    pass_derivatives,
    pass_parts,
    rate_of,
    size_of_rate,
)
from hybond.engine.methods.linear.rates_off import rates_off_in_flow
from hybond.engine.methods.tolerances.defects import apart_at_end, end_levels
from hybond.engine.methods.tolerances.scale import ROUNDED, error_norm, tolerance
from hybond.engine.mode.comparisons.standing import begin_standing, find_among, hold_standing
from hybond.engine.mode.comparisons.sum_records import (
    add_entry,
    begin_sum,
    begin_sums,
    end_sum,
    make_room,
)
from hybond.engine.surfaces.values import field, set_motion
from hybond.engine.words import Floats, float_table

ASKED: Final = 3
"""The part at which it is asked how far the dense output is off: nearly the farthest, ..."""
MET: Final = float_table(2.0, 4.0, 5.0)
"""... and those at which it meets the motion."""
FIT: Final = float_table(
    125.0 / 6.0, -125.0 / 16.0, 8.0 / 3.0,
    -375.0 / 8.0, 875.0 / 32.0, -10.0,
    625.0 / 24.0, -625.0 / 32.0, 25.0 / 3.0,
)  # fmt: skip
"""From what a line along the first derivative leaves there to coefficients of ``x^2 ... x^4``."""
SUMS: Final = float_table(
    19.0 / 288.0, 1427.0 / 7200.0, -133.0 / 1200.0, 241.0 / 3600.0, -173.0 / 7200.0, 3.0 / 800.0,
    14.0 / 225.0, 43.0 / 150.0, 7.0 / 225.0, 7.0 / 225.0, -1.0 / 75.0, 1.0 / 450.0,
    51.0 / 800.0, 219.0 / 800.0, 57.0 / 400.0, 57.0 / 400.0, -21.0 / 800.0, 3.0 / 800.0,
    14.0 / 225.0, 64.0 / 225.0, 8.0 / 75.0, 64.0 / 225.0, 14.0 / 225.0, 0.0,
    19.0 / 288.0, 25.0 / 96.0, 25.0 / 144.0, 25.0 / 144.0, 25.0 / 96.0, 19.0 / 288.0,
)  # fmt: skip
"""From values at all parts to integrals up to the second, third, ... of them: of order 6."""
START: Final = float_table(-137.0 / 12.0, 25.0, -25.0, 50.0 / 3.0, -25.0 / 4.0, 1.0)
"""From values at all parts to the slope at the first one."""
BETWEEN: Final = 0.3819660112501051
"""Part at which rates that are integrated along are asked once more: the smaller golden section."""
VALUE_THERE: Final = float_table(
    -0.00481392144523942407, 0.0505246655756538168, 1.01960492401890852,
    -0.0843333823066762751, 0.0219928812296833405, -0.00297516707232997911,
)  # fmt: skip
SUM_THERE: Final = float_table(
    0.0622647640019711436, 0.286227454605591067, 0.0128685126490673483,
    0.0318897022130476564, -0.0135336089307803821, 0.00224918671120826705,
)  # fmt: skip
"""From values at all parts to the value there, and to the integral up to there."""
FARTHEST: Final = 0.00576
"""How far ``x^5`` is from the dense output that it has, at the part that is asked."""
LOOSE: Final = 100.0
"""What a generator may be off by, in units of `rtol`: powers are integrals of high order of it."""
DOUBTFUL: Final = 100.0
"""How many times faster than a step something exchanges where the slope of what was passed is
better than the rate: what is rounding of the state is multiplied by about as much there."""
HALVINGS: Final = 1100


def begin_exact(e: Engine) -> bool:
    """Make room for the motion that begins; False if what drives it has no finite value."""
    x = e.exact
    n = x.flow.n
    fit(x.b, n)
    fit(x.b2, n)
    fit(x.terms, TERMS * n)
    fit(x.parts, (PARTS + 1) * n)
    for k in range(x.flow.watches):
        x.amplitude.at[k] = 0.0
    put_start(e, e.step.t, e.step.y)
    if not all_finite(n, x.parts.at):
        return False
    stand_in_flow(e)
    return True


def stand_in_flow(e: Engine) -> None:
    """Find what stands where a motion begins, by the rows of the flow.

    There sources that time moves later only, and what else generates the flow without a rate of its
    own, are constants.
    """
    m = e.model
    if e.standing.some or e.standing.goes_on or e.step.t != e.t:
        return
    if not begin_standing(e, e.step.f):
        return
    f = e.exact.flow
    z = e.exact.parts.at
    s = e.standing.sums
    begin_sums(s, m.storages)
    for k in range(m.storages):
        begin_sum(s, k)
        make_room(s, f.rows.first.at[k + 1] - f.rows.first.at[k])
        for p in range(f.rows.first.at[k], f.rows.first.at[k + 1]):
            j = f.rows.column.at[p]
            factor = f.rows.value.at[p] * f.scale.at[k] / f.scale.at[j]
            if j < e.states:
                add_entry(s, j, factor, math.fabs(factor))
                continue
            g = f.gen[j - e.states]
            s.level.at[k] += factor * z[j]
            if m.generator_first[g + 1] > m.generator_first[g]:
                s.drift.at[k] = 1.0
        end_sum(s, k, True)
    if find_among(e, 1):
        hold_standing(e, e.step.f)


def put_start(e: Engine, t: float, y: Floats) -> None:
    """Put z at the start of a step into the first row of `parts`."""
    x = e.exact
    f = x.flow
    copy_floats(e.states, y, x.parts.at)
    set_motion(e, e.v, t, y)
    for k in range(f.gens):
        x.parts.at[e.states + k] = value(e.model, e.model.generator_value[f.gen[k]], e.v)


def first_exact(e: Engine, limit: float) -> float:
    """Choose the first step from derivatives: halved until its dense output will do."""
    x = e.exact
    f = x.flow
    m = e.model
    n = f.n
    z = x.parts.at
    c = x.terms.at
    pass_derivatives(f, ORDERS, z, c)
    for k in range(e.model.storages if e.standing.some else 0):
        for order in range(ORDERS if e.standing.stands[k] != 0 else 0):
            c[order * n + k] = 0.0
    allowed = x.size.at
    relative = x.b.at
    for i in range(n):
        allowed[i] = e.step.scale[i] if i < e.states else math.inf
        relative[i] = m.rtol
    for k in range(f.watches):
        i = f.watched.at[k]
        allowed[i] = LOOSE * m.rtol * math.fabs(z[i])
        relative[i] = LOOSE * m.rtol
    h = limit
    if not h < math.inf:
        h = max(1e3 * f.unit, 1.0)
        if not math.isfinite(h):
            h = 1.0
    for _ in range(HALVINGS):
        for i in range(n):
            size = 0.0
            off = 0.0
            power = 1.0
            for order in range(ORDERS):
                power *= h
                term = math.fabs(c[order * n + i]) * power
                if order < PARTS - 1:
                    size += term
                else:
                    off += term
            # what has not moved yet has no size but that which it will have
            x.b2.at[i] = allowed[i] + relative[i] * size
            if i < e.states:
                x.b2.at[i] += min(h, f.unit) * ROUNDED * size_of_rate(f, e.states, z, i)
            x.off.at[i] = FARTHEST * off
        if error_norm(n, x.off.at, x.b2.at) <= 1.0:
            break
        h *= 0.5
    return h


def exact_attempt(e: Engine, t1: float) -> float:
    """Make a step to t1; return the norm of its error, nan if something is not finite."""
    x = e.exact
    s = e.step
    f = x.flow
    n = e.states
    h = t1 - s.t0
    put_start(e, s.t0, s.y0)
    if not pass_parts(x, f, h) or not all_finite((PARTS + 1) * f.n, x.parts.at):
        return math.nan
    z = x.parts.at
    for k in range(e.model.storages if e.standing.some else 0):
        # powers of the matrix have a rounding of their own
        for part in range(PARTS + 1 if e.standing.stands[k] != 0 else 0):
            z[part * f.n + k] = s.y0[k]
    copy_part(n, z, PARTS * f.n, s.y1, 0)
    if x.alongs > 0 and take_along(e, t1) != OK:
        return math.nan
    if not all_finite(n, s.y1) or field(e, e.mode, t1, s.y1, s.rate) != OK:
        return math.nan
    if not all_finite(n, s.rate):
        return math.nan
    # fast rates read states that are differences of what others hold: once they have settled these
    # rates are rounding of that
    doubtful = h * f.norm > (1.0 if f.shares > 0 else DOUBTFUL)
    for k in range(n):
        first = h * s.f0[k]
        if doubtful and x.along[k] == 0:
            # a slope that is small beside its terms is rounding, times a long step
            first = 0.0
            for part in range(PARTS + 1):
                first += START[part] * z[part * f.n + k]
        s.dense[k] = first
        s.error[k] = fitted(z, f.n, k, n, first, s.dense)
    if x.alongs > 0 and ask_between(e, h) != OK:
        return math.nan
    tolerance(e, s.y0, s.y1, s.scale)
    for k in range(n):
        # a power of a sine is a sum of sines, and as right as their rounding
        rounded = ROUNDED * min(h, f.unit) * size_of_rate(f, n, z, k)
        if f.shares > 0:
            rounded += ROUNDED * x.shared.at[k] * f.scale.at[k]
        s.scale[k] = max(s.scale[k], rounded)
    error = max(error_norm_of(n, s.error, s.scale, s.controlled), unresolved(e, h))
    return max(error, rates_off_in_flow(x, e.model.storages, h, s.error, s.scale, e.lately))


def fitted(z: Floats, n: int, k: int, width: int, first: float, out: Floats) -> float:
    """Put coefficients of ``x^2 ... x^4`` of component k there; return how far they are off.

    Behind `first`, in rows of that width.
    """
    total = 0.0
    asked = float(ASKED) / float(PARTS)
    power = asked
    for row in range(3):
        c = 0.0
        for j in range(3):
            part = int(MET[j])
            left = z[part * n + k] - z[k] - float(part) / float(PARTS) * first
            c += FIT[3 * row + j] * left
        power *= asked
        total += power * c
        out[(row + 1) * width + k] = c
    return total - (z[ASKED * n + k] - z[k] - asked * first)


def take_along(e: Engine, t1: float) -> int:
    """Integrate along what is propagated: the signals whose rates are not linear."""
    x = e.exact
    s = e.step
    n = e.states
    width = x.flow.n
    h = t1 - s.t0
    copy_floats(n, s.f0, x.rates)
    for part in range(1, PARTS + 1):
        copy_part(n, x.parts.at, part * width, x.y, 0)
        at = t1 if part == PARTS else s.t0 + float(part) / float(PARTS) * h
        found = field(e, e.mode, at, x.y, x.rate)
        if found != OK:
            return found
        copy_part(n, x.rate, 0, x.rates, part * n)
    for k in range(n):
        if x.along[k] == 0:
            continue
        for part in range(1, PARTS + 1):
            total = 0.0
            for j in range(PARTS + 1):
                total += SUMS[(part - 1) * (PARTS + 1) + j] * x.rates[j * n + k]
            x.parts.at[part * width + k] = s.y0[k] + h * total
        s.y1[k] = x.parts.at[PARTS * width + k]
    return OK


def ask_between(e: Engine, h: float) -> int:
    """Estimate the errors of signals that are integrated along.

    Their rates are asked where no whole number of periods divides the step: at all parts they may
    look alike by chance.
    """
    x = e.exact
    s = e.step
    n = e.states
    at = BETWEEN
    for k in range(n):
        x.y[k] = s.y0[k] + at * (
            s.dense[k] + at * (s.dense[n + k] + at * (s.dense[2 * n + k] + at * s.dense[3 * n + k]))
        )
    for k in range(n):
        if x.along[k] == 0:
            continue
        total = 0.0
        for part in range(PARTS + 1):
            total += SUM_THERE[part] * x.rates[part * n + k]
        x.y[k] = s.y0[k] + h * total
    found = field(e, e.mode, s.t0 + at * h, x.y, x.rate)
    if found != OK:
        return found
    for k in range(n):
        if x.along[k] == 0:
            continue
        total = 0.0
        for part in range(PARTS + 1):
            total += VALUE_THERE[part] * x.rates[part * n + k]
        off = h * math.fabs(x.rate[k] - total)
        s.error[k] = max(math.fabs(s.error[k]), off) if off == off else math.inf
    return OK


def unresolved(e: Engine, h: float) -> float:
    """Return how far the generators that move are off, in what they may be."""
    x = e.exact
    f = x.flow
    many = f.watches
    if many == 0:
        return 0.0
    fit(x.off, many)
    for k in range(many):
        i = f.watched.at[k]
        x.off.at[k] = fitted(x.parts.at, f.n, i, 0, h * rate_of(f, x.parts.at, i), x.b.at)
        x.amplitude.at[k] = max(x.amplitude.at[k], math.fabs(x.parts.at[i]))
        size = x.amplitude.at[k]
        for part in range(1, PARTS + 1):
            size = max(size, math.fabs(x.parts.at[part * f.n + i]))
        x.b2.at[k] = LOOSE * e.model.rtol * size
    return error_norm(many, x.off.at, x.b2.at)


def exact_accept(e: Engine, t1: float) -> None:
    """Keep the step just made; its dense output stands there."""
    s = e.step
    s.t1 = t1
    s.t = t1
    copy_floats(e.states, s.y1, s.y)
    copy_floats(e.states, s.rate, s.f)
    end_levels(e)
    n = e.states
    s.apart = 0.0
    for k in range(e.model.storages):
        d = s.dense
        apart_at_end(e, k, d[k] + 2.0 * d[n + k] + 3.0 * d[2 * n + k] + 4.0 * d[3 * n + k])
