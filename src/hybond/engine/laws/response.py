"""What the graph says of its ports at one state: see Response.

Of a linear graph it is known once for all states; of others it is found by differences at each.
"""

import math
from typing import Final

from hybond.engine.algebra.blocks import row_size
from hybond.engine.algebra.products import copy_floats, copy_part, times_cancelling
from hybond.engine.algebra.rounding import CANCELS, EPSILON
from hybond.engine.algebra.scaling import power_of_two
from hybond.engine.answers import value
from hybond.engine.complementarity.semidefinite import is_indefinite
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.laws.law_records import (
    Laws,
    Ports,
    Response,
)
from hybond.engine.laws.ports import (
    add_partner_terms,
    open_mode,
    partner_row,
    partner_way,
    rates_of_stored,
    solve_with,
    times_partner,
)
from hybond.engine.laws.ports_together import are_told_apart, next_together
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.digits.sizes import size_of
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.rows.sources_of_time import rate_of_source
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.mode.rows.tableau import NET
from hybond.engine.model import Model
from hybond.engine.surfaces.values import set_values
from hybond.engine.words import Floats

DIGITS: Final = 8.0 * EPSILON
"""Part of its terms up to which a difference of two solutions is rounding."""
SHORT_WHILE: Final = 1e-7
"""Time over which rates are differences in a nonlinear graph, s; of runs below 1 s that part."""
UNITS: Final = 1024.0
"""How many units of what a port gives there may be in the graph: a power of two, so that units are.
A difference over one unit has the digits that are left of it then."""
NUDGE: Final = 1e-6
"""Part of what a storage holds, or of what the energy would hold there, over which differences are
taken."""
LEAST_REACH: Final = 1e-6
"""What is stored at the most where nothing is."""


def respond(e: Engine, r: Laws, v: Floats, x: Floats, timed: bool) -> int:
    """Find the response of `r.now` at the values `v` and the stored state `x`.

    Bond variables are written into `v`. Rates are asked for if `timed`; those of a nonlinear graph
    are differences.
    """
    m = e.model
    p = r.now
    a = r.response
    n = m.ports
    a.gain = p.gain
    a.d = p.d
    a.e = p.e
    a.ce = p.ce
    for k in range(n):
        r.l[k] = 0.0
    if solve_with(e, p, v, r.l) != OK:
        return REFUSED
    copy_floats(2 * m.bonds, e.work.w, a.bonds)
    times_partner(m, p, a.bonds, a.y)
    find_sizes(e, p, a)
    rates_of_stored(m, a.bonds, 1, 0, r.field)
    for k in range(n):
        a.rate[k] = 0.0
        r.pushed[k] = 0.0
    if not p.linear:
        if find_gains(e, r, p, v, a.gain) != OK:
            return REFUSED
        couple(m, p, a.gain, a.d, a.e)
        mode = open_mode(e, p)
        hold_guess(e, mode)
        found = directional(e, r, v, x)
        if found == OK and timed:
            found = ahead_of(e, r, v, x)
        give_back_guess(e, mode)
        return found
    if not p.known and find_constant(e, r, v) != OK:
        return REFUSED
    rates_of_linear(e, r, v, a.bonds, a.rate, a.rate_size)
    return OK


def rates_of_linear(
    e: Engine, r: Laws, v: Floats, bonds: Floats, rate: Floats, terms: Floats
) -> None:
    """Put the rate of each `y` of a linear graph there, and the size of its terms.

    To be asked after a solution. `r.field` becomes the rate of what is stored, and `r.pushed` what
    sources have of each rate.
    """
    m = e.model
    p = r.now
    mode = open_mode(e, p)
    rates_of_stored(m, bonds, 1, 0, r.field)
    for i in range(m.storages):
        at = rate_bond(m, i)
        r.field_size[i] = row_size(mode.finite, mode.same[at], e.work.xi) + math.fabs(bonds[at])
    # the last ones are ports, of which there may be many
    sources = mode.sources
    while sources > 0 and mode.source[sources - 1] < 0:
        sources -= 1
    for k in range(m.ports):
        total = 0.0
        size = 0.0
        for i in range(m.storages):
            seen = p.seen[k * m.storages + i]
            total += seen * r.field[i]
            size += math.fabs(seen) * r.field_size[i]
        push = 0.0
        for s in range(sources):
            source = mode.source[s]
            if source >= 0 and m.source_rate[source] >= 0:
                through = p.through[k * m.most_sources + s]
                part = through * rate_of_source(e, source, v)
                push += part
                size += math.fabs(part)
        # a rate that is rounding must not set the scale of what a law gives or stops
        rate[k] = 0.0 if math.fabs(total + push) <= CANCELS * size else total + push
        terms[k] = size
        r.pushed[k] = push


def find_sizes(e: Engine, p: Ports, a: Response) -> None:
    """Find the size of the terms of each `y`, after a solution."""
    m = e.model
    mode = open_mode(e, p)
    for k in range(m.ports):
        row = partner_row(p, k)
        a.size[k] = 0.0
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            b = m.pair_column[i]
            a.size[k] += math.fabs(m.pair_value[i]) * size_of_terms(e, mode, b)


def couple(m: Model, p: Ports, gains: Floats, d: Floats, pushes: Floats) -> None:
    """Find D and E from the gains: what cancels is nothing."""
    for j in range(m.ports):
        rates_of_stored(m, gains, m.ports, j, pushes)
    feel_at_once(m, p, gains, d)


def feel_at_once(m: Model, p: Ports, gains: Floats, d: Floats) -> None:
    """Find how laws feel each other by no storage, from what bonds have by them; no rounding."""
    n = m.ports
    for k in range(n):
        row = partner_row(p, k)
        way = partner_way(p, k)
        for j in range(n):
            total = 0.0
            size = 0.0
            for i in range(m.pair_first[row], m.pair_first[row + 1]):
                part = way * m.pair_value[i]
                gain = gains[m.pair_column[i] * n + j]
                total += part * gain
                size += math.fabs(part) * math.fabs(gain)
            d[k * n + j] = 0.0 if math.fabs(total) <= CANCELS * size else total


def find_constant(e: Engine, r: Laws, v: Floats) -> int:
    """Find what is the same at every state of a linear graph."""
    m = e.model
    p = r.now
    mode = open_mode(e, p)
    n = m.ports
    a = r.response
    if find_gains(e, r, p, v, a.gain) != OK:
        return REFUSED
    couple(m, p, a.gain, a.d, a.e)
    for k in range(n):
        partner_by_knowns(e, r, p, k)
        for s in range(m.storages):
            p.seen[k * m.storages + s] = 0.0
        for z in range(m.storages):
            for i in range(m.stiff_first[z], m.stiff_first[z + 1]):
                at = k * m.storages + m.stiff_other[i]
                p.seen[at] += r.row[z] * m.stiff_constant[i]
        copy_part(mode.sources, r.row, m.storages, p.through, k * m.most_sources)
    times_cancelling(n, m.storages, n, p.seen, p.e, p.ce)
    # at once, and by what is stored
    through = is_indefinite(n, p.d, r.q, r.units, r.block)
    p.monotone = not through and not is_indefinite(n, p.ce, r.q, r.units, r.block)
    p.known = True
    return OK


def partner_by_knowns(e: Engine, r: Laws, p: Ports, k: int) -> None:
    """Put what the knowns give to `w` of port k into `r.row`: what cancels is nothing."""
    mode = open_mode(e, p)
    m = e.model
    for i in range(mode.knowns):
        r.row[i] = 0.0
        r.row_terms[i] = 0.0
    pair = partner_row(p, k)
    for c in range(m.pair_first[pair], m.pair_first[pair + 1]):
        part = partner_way(p, k) * m.pair_value[c]
        row = mode.same[m.pair_column[c]]
        for i in range(mode.direct.first.at[row], mode.direct.first.at[row + 1]):
            term = part * mode.direct.value.at[i]
            r.row[mode.direct.column.at[i]] += term
            r.row_terms[mode.direct.column.at[i]] += math.fabs(term)
    for i in range(mode.knowns):
        if math.fabs(r.row[i]) <= CANCELS * r.row_terms[i]:
            r.row[i] = 0.0


def find_gains(e: Engine, r: Laws, p: Ports, v: Floats, gain: Floats) -> int:
    """Put the derivatives of the bond variables by `l` there.

    Modulated two-ports and controlled sources are affine in what ports give, so that a difference
    over any step is exact, but for the rounding of what is there without it, which is no gain;
    through nonlinear resistors it is a chord. That rounding is measured by what Newton solved from:
    the voltage of a coil is what supply and modulated gyrators leave of each other.
    """
    mode = open_mode(e, p)
    m = e.model
    n = 2 * m.bonds
    if mode.dynamics == 0:
        for k in range(m.ports):
            for b in range(n):
                gain[b * m.ports + k] = 0.0
                row = mode.same[b]
                for i in range(mode.direct.first.at[row], mode.direct.first.at[row + 1]):
                    if mode.direct.column.at[i] == m.storages + p.column[k]:
                        gain[b * m.ports + k] = mode.direct.value.at[i] * p.sign[k]
        return OK
    copy_floats(2 * m.slots, v, r.kept)
    for k in range(m.ports):
        r.l[k] = 0.0
    if solve_with(e, p, v, r.l) != OK:
        return REFUSED
    for b in range(n):
        r.zero[b] = e.work.w[b]
        r.zero_terms[b] = size_of(e, mode, b, e.work.xi, v)
    # from where the last ports were asked Newton would come back with the rounding of their units
    hold_guess(e, mode)
    if are_told_apart(e, r, p):
        found = gains_together(e, r, p, v, gain)
        copy_floats(2 * m.slots, r.kept, v)
        return found
    for k in range(m.ports):
        unit = probe_of(m, p, k, r.zero)
        r.l[k] = unit
        if solve_with(e, p, v, r.l) != OK:
            return REFUSED
        r.l[k] = 0.0
        give_back_guess(e, mode)
        for b in range(n):
            moved = e.work.w[b] - r.zero[b]
            still = math.fabs(moved) <= DIGITS * max(r.zero_terms[b], size_of_terms(e, mode, b))
            gain[b * m.ports + k] = 0.0 if still else moved / unit
    copy_floats(2 * m.slots, r.kept, v)
    return OK


def gains_together(e: Engine, r: Laws, p: Ports, v: Floats, gain: Floats) -> int:
    """Do the same, with ports that act on no bond variable together at once."""
    m = e.model
    mode = open_mode(e, p)
    a = mode.port_acting
    for i in range(2 * m.bonds * m.ports):
        gain[i] = 0.0
    for g in range(a.groups):
        for k in range(m.ports):
            r.l[k] = probe_of(m, p, k, r.zero) if a.group.at[k] == g else 0.0
        if solve_with(e, p, v, r.l) != OK:
            return REFUSED
        give_back_guess(e, mode)
        for k in range(m.ports):
            for q in range(a.first.at[k], a.first.at[k + 1] if r.l[k] != 0.0 else a.first.at[k]):
                b = a.rate.at[q]
                moved = e.work.w[b] - r.zero[b]
                still = math.fabs(moved) <= DIGITS * max(r.zero_terms[b], size_of_terms(e, mode, b))
                gain[b * m.ports + k] = 0.0 if still else moved / r.l[k]
    for k in range(m.ports):
        r.l[k] = 0.0
    return OK


def size_of_terms(e: Engine, mode: Mode, b: int) -> float:
    """Return the size of the terms of a bond variable, after a solution.

    What Newton solves for, as the voltages of modulated gyrators, is among them.
    """
    w = e.work.w
    frees = mode.finite_frees if mode.dynamics > 0 else 0
    size = row_size(mode.finite, mode.same[b], e.work.xi) + math.fabs(w[b])
    for q in range(
        mode.share_first.at[b] if frees > 0 else 0, mode.share_first.at[b + 1] if frees > 0 else 0
    ):
        j = mode.share_of.at[q]
        size += math.fabs(mode.finite_free.at[b * frees + j] * w[mode.free_column[j]])
    return size


def probe_of(m: Model, p: Ports, k: int, w: Floats) -> float:
    """Return what is given by port k to see what it does: 1, or more where its kind is large."""
    own = 2 * k + 1 if p.given[k] == NET else 2 * k
    if m.pair_first[own] == m.pair_first[own + 1]:
        return 1.0  # a junction without bonds
    kind = m.bond_class[m.pair_column[m.pair_first[own]]]
    most = 0.0
    for b in range(2 * m.bonds):
        if m.bond_class[b] == kind:
            most = max(most, math.fabs(w[b]))
    if not (most > UNITS and math.isfinite(most)):
        return 1.0
    return power_of_two(most / UNITS)


def directional(e: Engine, r: Laws, v: Floats, x: Floats) -> int:
    """Find how `y` moves along the columns of E, by differences."""
    m = e.model
    p = r.now
    a = r.response
    n = m.ports
    reach = e.work.reach
    reach_of(e, open_mode(e, p), x, reach)
    copy_floats(2 * m.slots, v, r.kept)
    for k in range(n):
        r.l[k] = 0.0
    for j in range(n):
        r.width[j] = width_of(e, r, j, x)
    if are_told_apart(e, r, p):
        return directional_together(e, r, v, x)
    for j in range(n):
        h = r.width[j]
        for k in range(n):
            a.ce[k * n + j] = 0.0
            r.row_terms[k] = a.size[k]
        if not math.isfinite(h):
            continue  # it moves nothing, or by the last bit of what is denormal
        for way in range(2):
            sign = 1.0 if way == 0 else -1.0
            for s in range(m.storages):
                v[m.stored_slot + s] = x[s] + sign * h * a.e[s * n + j]
            if solve_with(e, p, v, r.l) != OK:
                return REFUSED
            times_partner(m, p, e.work.w, r.row)
            add_partner_terms(m, p, e.work.w, r.row_terms)
            for k in range(n):
                a.ce[k * n + j] += sign * r.row[k]
        for k in range(n):
            # a difference of the last digits of large terms is none
            moved = a.ce[k * n + j]
            still = math.fabs(moved) <= DIGITS * r.row_terms[k]
            a.ce[k * n + j] = 0.0 if still else moved / (2.0 * h)
    copy_floats(2 * m.slots, r.kept, v)
    return OK


def width_of(e: Engine, r: Laws, j: int, x: Floats) -> float:
    """Return how long port j is to push in differences; infinite where it moves nothing."""
    m = e.model
    n = m.ports
    h = math.inf
    most = 0.0
    for s in range(m.storages):
        rate = math.fabs(r.response.e[s * n + j])
        most = max(most, rate)
        holds = max(e.work.reach[s], math.fabs(x[s]))
        if rate > 0.0 and holds > 0.0:
            h = min(h, NUDGE * holds / rate)
    return NUDGE * LEAST_REACH / most if most > 0.0 and not math.isfinite(h) else h


def directional_together(e: Engine, r: Laws, v: Floats, x: Floats) -> int:
    """Do the same for columns at once whose motion no port feels together."""
    m = e.model
    p = r.now
    a = r.response
    n = m.ports
    mode = open_mode(e, p)
    for i in range(n * n):
        a.ce[i] = 0.0
    for j in range(n):
        r.chosen[j] = 2 if math.isfinite(r.width[j]) else 0
    while next_together(m, r, mode, a.e):
        copy_floats(n, a.size, r.row_terms)
        for way in range(2):
            sign = 1.0 if way == 0 else -1.0
            for s in range(m.storages):
                v[m.stored_slot + s] = x[s]
                j = r.stored_taken[s] - 1
                if j >= 0:
                    v[m.stored_slot + s] = x[s] + sign * r.width[j] * a.e[s * n + j]
            if solve_with(e, p, v, r.l) != OK:
                return REFUSED
            times_partner(m, p, e.work.w, r.row)
            add_partner_terms(m, p, e.work.w, r.row_terms)
            for k in range(n):
                if r.port_taken[k] > 0:
                    a.ce[k * n + r.port_taken[k] - 1] += sign * r.row[k]
        for k in range(n):
            if r.port_taken[k] > 0:
                at = k * n + r.port_taken[k] - 1
                still = math.fabs(a.ce[at]) <= DIGITS * r.row_terms[k]
                a.ce[at] = 0.0 if still else a.ce[at] / (2.0 * r.width[r.port_taken[k] - 1])
    copy_floats(2 * m.slots, r.kept, v)
    return OK


def ahead_of(e: Engine, r: Laws, v: Floats, x: Floats) -> int:
    """Find the rate of `y` as a difference over a short while."""
    m = e.model
    p = r.now
    mode = open_mode(e, p)
    a = r.response
    # runs of microseconds have motions of less
    step = SHORT_WHILE * min(e.span, 1.0)
    for k in range(m.storages):
        r.moved[k] = x[k] + step * r.field[k]
    # levers turn as well: what is integrated may be their angle
    for k in range(m.integrals):
        r.ahead[k] = r.s[k] + step * value(m, m.integral_rate[k], v)
    # what else is solved for in between must not show in the values
    for k in range(m.ports):
        r.l[k] = 0.0
    set_values(e, mode, r.later, r.t + step, r.moved, r.ahead)
    copy_part(m.slots, e.pre, 0, r.later, m.slots)
    if solve_with(e, p, r.later, r.l) != OK:
        return REFUSED
    times_partner(m, p, e.work.w, r.row)
    within = False
    room = room_of_instant(e, r.t)
    for k in range(m.ports):
        a.rate[k] = (r.row[k] - a.y[k]) / step
        within = within or (a.y[k] != 0.0 and math.fabs(a.y[k]) <= room * math.fabs(a.rate[k]))
    return pushed_of(e, r, x, step) if within else OK


def pushed_of(e: Engine, r: Laws, x: Floats, step: float) -> int:
    """Find what sources have of that rate: what is stored does not move."""
    m = e.model
    p = r.now
    set_values(e, open_mode(e, p), r.later, r.t + step, x, r.s)
    copy_part(m.slots, e.pre, 0, r.later, m.slots)
    if solve_with(e, p, r.later, r.l) != OK:
        return REFUSED
    times_partner(m, p, e.work.w, r.row)
    for k in range(m.ports):
        r.pushed[k] = (r.row[k] - r.response.y[k]) / step
    return OK
