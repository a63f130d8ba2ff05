"""A graph with the laws of its junctions left open.

Each junction with a law (ideal diode, contact, dry friction) is a *port*. One variable of its pair
is given from outside, the other follows from the graph::

    x' = f(x, u) + E l,     w = y(x, u) + D l

`l` and `w` are the common variable and minus the net variable, or the other way round. Which of the
two is given is chosen so that as much storage as possible is in integral causality: then no
constraint on what is stored contains `l`, and an impulse of `l` is a jump of the state by ``E``
times its area. Source: Heemels, Schumacher and Weiland (2000).
"""

import math
from typing import Final

from hybond.engine.algebra.blocks import row_size
from hybond.engine.algebra.rounding import CANCELS, EPSILON
from hybond.engine.algebra.scaling import power_of_two
from hybond.engine.answers import node_name, value
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.inputs.interval import configuration
from hybond.engine.laws.law_records import (
    NOT_ASKED,
    OPEN_KEPT,
    Laws,
    Ports,
    Response,
    make_ports,
)
from hybond.engine.mode.equations import check_depth, make_equations
from hybond.engine.mode.guess import give_back_guess, hold_guess
from hybond.engine.mode.kept_modes import is_same
from hybond.engine.mode.mode_records import Mode, make_mode
from hybond.engine.mode.solving import solve
from hybond.engine.mode.storage import reach_of
from hybond.engine.mode.tableau import COMMON, NET, NOT_OPEN
from hybond.engine.mode.values import set_values
from hybond.engine.model import Model
from hybond.engine.timestepping.end_ports import choose_given, prefer_common
from hybond.engine.timestepping.step_records import MOREAU
from hybond.engine.words import Floats, Ints, some

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


def base_mode(m: Model, state: Ints, base: Ints) -> None:
    """Put the states there with every junction law in its first branch."""
    for k in range(m.machines):
        base[k] = 0 if m.is_law[k] != 0 else state[k]


def ports_of(e: Engine, r: Laws, state: Ints) -> int:
    """Take the equations of a mode with its laws open into `r.now`, made once."""
    m = e.model
    base_mode(m, state, r.base)
    configuration(e, r.base, r.key)
    e.clock += 1
    oldest = 0
    for k in range(r.made):
        p = some(r.open[k])
        if is_same(m.machines + m.discrete, p.key, r.key):
            p.used = e.clock
            r.now = p
            return OK
        if p.used < some(r.open[oldest]).used:
            oldest = k
    if r.made < OPEN_KEPT:
        oldest = r.made
        r.open[oldest] = make_ports(oldest, m)
        e.open_modes[oldest] = make_mode(m)
        r.made += 1
    p = some(r.open[oldest])
    p.used = e.clock
    mode = some(e.open_modes[oldest])
    for k in range(m.machines + m.discrete):
        p.key[k] = r.key[k]
        mode.state[k] = r.key[k]
    r.now = p
    return open_ports(e, r, p, mode)


def open_mode(e: Engine, p: Ports) -> Mode:
    """Return the equations of a configuration with open laws."""
    return some(e.open_modes[p.place])


def orientation(m: Model, base: Ints, given: Ints) -> None:
    """Put which variable of each port is given into `given`.

    The choice is the reference mode of causality, which the tables hold for all that the
    machines beside the laws switch; of too many settings for the start alone.
    """
    number = 0
    # a model without ports, which time-stepping asks for them too, has no places either
    for k in range(m.machines if m.ports > 0 else 0):
        if m.is_law[k] == 0:
            number += m.orient_place[m.state_first[k] + base[k]]
    for p in range(m.ports):
        given[p] = NET if m.orient[number * m.ports + p] != 0 else COMMON


def open_ports(e: Engine, r: Laws, p: Ports, mode: Mode) -> int:
    """Make the equations of a configuration with open laws."""
    m = e.model
    orientation(m, r.base, p.given)
    tries = 0
    while True:
        for j in range(m.junctions):
            r.given[j] = NOT_OPEN
        for k in range(m.ports):
            r.given[m.port_junction[k]] = p.given[k]
        mode.opened = True
        make_equations(e, mode, r.given)
        if check_depth(e, mode) != OK:
            return REFUSED
        find_columns(m, p, mode)
        tied = untie(m, r, p, mode)
        if tied < 0:
            break
        tries += 1
        if tries > 2 * m.ports:
            why = "the law is tied to a constraint that holds in every mode"
            return say_fault(e, "HB-C104", why, node_name(m, m.port_node[tied]))
    if m.oriented == 0:
        choose_given(e, r, p, mode)
    if m.method == MOREAU:
        prefer_common(e, r, p, mode)
        find_columns(m, p, mode)
    e.modes_built += 1
    p.stamp = e.modes_built
    p.linear = mode.dynamics == 0 and m.groups == 0
    p.known = False
    p.moves = NOT_ASKED
    return OK


def find_columns(m: Model, p: Ports, mode: Mode) -> None:
    """Find where ports stand among the sources."""
    for s in range(mode.sources):
        if mode.source[s] < 0:
            for k in range(m.ports):
                if m.port_junction[k] == -1 - mode.source[s]:
                    p.column[k] = s
                    p.sign[k] = 1.0 if p.given[k] == COMMON else -1.0


def untie(m: Model, r: Laws, p: Ports, mode: Mode) -> int:
    """Give the other variable of ports that a constraint contains; return one of them, or -1.

    Causality counts variables; around a loop without a reference potential they depend on one
    another by value.
    """
    for k in range(m.ports):
        r.tried[k] = 0
    found = -1
    rows = mode.constraints.rows
    for c in range(rows + mode.agreements.rows):
        table = mode.constraints if c < rows else mode.agreements
        at = c if c < rows else c - rows
        first = -1
        for i in range(table.first.at[at], table.first.at[at + 1]):
            for k in range(m.ports):
                own = table.column.at[i] == m.storages + p.column[k]
                if own and (first < 0 or p.column[k] < p.column[first]):
                    first = k
        if first >= 0:
            r.tried[first] = 1
            found = first if found < 0 else found
    for k in range(m.ports):
        if r.tried[k] != 0:
            p.given[k] = NET if p.given[k] == COMMON else COMMON
    return found


def partner_row(p: Ports, k: int) -> int:
    """Return the row of pairs that `w` of port k is: minus the net variable, or the common one."""
    return 2 * k + 1 if p.given[k] == COMMON else 2 * k


def partner_way(p: Ports, k: int) -> float:
    """Return what that row is multiplied by."""
    return -1.0 if p.given[k] == COMMON else 1.0


def solve_with(e: Engine, p: Ports, v: Floats, given: Floats) -> int:
    """Solve for the bond variables with the ports' `l` given, into `e.work.w` and `v`."""
    mode = open_mode(e, p)
    m = e.model
    for k in range(m.ports):
        mode.source_level[p.column[k]] = p.sign[k] * given[k]
    found = solve(e, mode, v)
    for k in range(m.ports):
        mode.source_level[p.column[k]] = 0.0
    if found != OK:
        e.laws.unanswered = True
        return REFUSED
    return OK


def find_gains(e: Engine, r: Laws, p: Ports, v: Floats, gain: Floats) -> int:
    """Put the derivatives of the bond variables by `l` there.

    Modulated two-ports and controlled sources are affine in what ports give, so that a difference
    over any step is exact, but for the rounding of what is there without it; through nonlinear
    resistors it is a chord.
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
    for i in range(2 * m.slots):
        r.kept[i] = v[i]
    for k in range(m.ports):
        r.l[k] = 0.0
    if solve_with(e, p, v, r.l) != OK:
        return REFUSED
    for b in range(n):
        r.zero[b] = e.work.w[b]
    for k in range(m.ports):
        unit = unit_of(m, p, k, r.zero)
        r.l[k] = unit
        if solve_with(e, p, v, r.l) != OK:
            return REFUSED
        r.l[k] = 0.0
        for b in range(n):
            moved = e.work.w[b] - r.zero[b]
            gain[b * m.ports + k] = moved / unit
    for i in range(2 * m.slots):
        v[i] = r.kept[i]
    return OK


def unit_of(m: Model, p: Ports, k: int, w: Floats) -> float:
    """Return what is given by port k to see what it does: 1, or more where its kind is large."""
    own = 2 * k + 1 if p.given[k] == NET else 2 * k
    kind = m.bond_class[m.pair_column[m.pair_first[own]]]
    most = 0.0
    for b in range(2 * m.bonds):
        if m.bond_class[b] == kind:
            most = max(most, math.fabs(w[b]))
    if not (most > UNITS and math.isfinite(most)):
        return 1.0
    return power_of_two(most / UNITS)


def times_partner(m: Model, p: Ports, w: Floats, y: Floats) -> None:
    """Put `w` of all ports there, of bond variables."""
    for k in range(m.ports):
        row = partner_row(p, k)
        total = 0.0
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            total += m.pair_value[i] * w[m.pair_column[i]]
        y[k] = partner_way(p, k) * total


def add_partner_terms(m: Model, p: Ports, w: Floats, terms: Floats) -> None:
    """Add the size of the terms of `w` of all ports, of bond variables."""
    for k in range(m.ports):
        row = partner_row(p, k)
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            terms[k] += math.fabs(m.pair_value[i] * w[m.pair_column[i]])


def rates_of_stored(m: Model, w: Floats, n: int, column: int, rates: Floats) -> None:
    """Put the rates that a column of bond variables, of n, makes there, in the same column."""
    for k in range(m.storages):
        at = m.storage_bond[k] + (m.bonds if m.storage_kind[k] == 0 else 0)
        sign = float(m.storage_sign[k]) if m.storage_kind[k] == 0 else 1.0
        rates[k * n + column] = sign * w[at * n + column]


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
    for b in range(2 * m.bonds):
        a.bonds[b] = e.work.w[b]
    times_partner(m, p, a.bonds, a.y)
    find_sizes(e, p, a)
    rates_of_stored(m, a.bonds, 1, 0, r.field)
    for k in range(n):
        a.rate[k] = 0.0
    if not p.linear:
        if find_gains(e, r, p, v, a.gain) != OK:
            return REFUSED
        couple(m, p, a)
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

    To be asked after a solution. `r.field` becomes the rate of what is stored.
    """
    m = e.model
    p = r.now
    mode = open_mode(e, p)
    rates_of_stored(m, bonds, 1, 0, r.field)
    for i in range(m.storages):
        at = m.storage_bond[i] + (m.bonds if m.storage_kind[i] == 0 else 0)
        r.field_size[i] = row_size(mode.finite, mode.same[at], e.work.xi) + math.fabs(bonds[at])
    for k in range(m.ports):
        total = 0.0
        size = 0.0
        for i in range(m.storages):
            seen = p.seen[k * m.storages + i]
            total += seen * r.field[i]
            size += math.fabs(seen) * r.field_size[i]
        push = 0.0
        for s in range(mode.sources):
            source = mode.source[s]
            if source >= 0 and m.source_rate[source] >= 0:
                through = p.through[k * m.most_sources + s]
                part = through * value(m, m.source_rate[source], v)
                push += part
                size += math.fabs(part)
        # a rate that is rounding must not set the scale of what a law gives or stops
        rate[k] = 0.0 if math.fabs(total + push) <= CANCELS * size else total + push
        terms[k] = size


def find_sizes(e: Engine, p: Ports, a: Response) -> None:
    """Find the size of the terms of each `y`: of knowns, and of bond variables themselves."""
    m = e.model
    mode = open_mode(e, p)
    for k in range(m.ports):
        row = partner_row(p, k)
        a.size[k] = 0.0
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            b = m.pair_column[i]
            size = row_size(mode.finite, mode.same[b], e.work.xi) + math.fabs(a.bonds[b])
            a.size[k] += math.fabs(m.pair_value[i]) * size


def couple(m: Model, p: Ports, a: Response) -> None:
    """Find D and E from the gains: what cancels is nothing."""
    n = m.ports
    for j in range(n):
        rates_of_stored(m, a.gain, n, j, a.e)
    for k in range(n):
        row = partner_row(p, k)
        way = partner_way(p, k)
        for j in range(n):
            total = 0.0
            size = 0.0
            for i in range(m.pair_first[row], m.pair_first[row + 1]):
                part = way * m.pair_value[i]
                gain = a.gain[m.pair_column[i] * n + j]
                total += part * gain
                size += math.fabs(part) * math.fabs(gain)
            a.d[k * n + j] = 0.0 if math.fabs(total) <= CANCELS * size else total


def find_constant(e: Engine, r: Laws, v: Floats) -> int:
    """Find what is the same at every state of a linear graph."""
    m = e.model
    p = r.now
    mode = open_mode(e, p)
    n = m.ports
    a = r.response
    if find_gains(e, r, p, v, a.gain) != OK:
        return REFUSED
    couple(m, p, a)
    for k in range(n):
        partner_by_knowns(e, r, p, k)
        for s in range(m.storages):
            p.seen[k * m.storages + s] = 0.0
        for z in range(m.storages):
            for i in range(m.stiff_first[z], m.stiff_first[z + 1]):
                at = k * m.storages + m.stiff_other[i]
                p.seen[at] += r.row[z] * m.stiff_constant[i]
        for s in range(mode.sources):
            p.through[k * m.most_sources + s] = r.row[m.storages + s]
    for k in range(n):
        for j in range(n):
            total = 0.0
            size = 0.0
            for s in range(m.storages):
                total += p.seen[k * m.storages + s] * p.e[s * n + j]
                size += math.fabs(p.seen[k * m.storages + s] * p.e[s * n + j])
            p.ce[k * n + j] = 0.0 if math.fabs(total) <= CANCELS * size else total
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


def directional(e: Engine, r: Laws, v: Floats, x: Floats) -> int:
    """Find how `y` moves along the columns of E, by differences."""
    m = e.model
    p = r.now
    a = r.response
    n = m.ports
    reach = e.work.reach
    reach_of(e, x, e.energy, reach)
    for i in range(2 * m.slots):
        r.kept[i] = v[i]
    for k in range(n):
        r.l[k] = 0.0
    for j in range(n):
        h = math.inf
        most = 0.0
        for s in range(m.storages):
            rate = math.fabs(a.e[s * n + j])
            most = max(most, rate)
            holds = max(reach[s], math.fabs(x[s]))
            if rate > 0.0 and holds > 0.0:
                h = min(h, NUDGE * holds / rate)
        if most > 0.0 and not math.isfinite(h):
            h = NUDGE * LEAST_REACH / most
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
    for i in range(2 * m.slots):
        v[i] = r.kept[i]
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
    for k in range(m.slots):
        r.later[m.slots + k] = e.pre[k]
    if solve_with(e, p, r.later, r.l) != OK:
        return REFUSED
    times_partner(m, p, e.work.w, r.row)
    for k in range(m.ports):
        a.rate[k] = (r.row[k] - a.y[k]) / step
    return OK
