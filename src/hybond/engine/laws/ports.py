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

from hybond.engine.answers import node_name
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.inputs.interval import configuration
from hybond.engine.laws.end_ports import choose_given, prefer_common
from hybond.engine.laws.law_records import (
    NOT_ASKED,
    OPEN_KEPT,
    Laws,
    Ports,
    make_ports,
)
from hybond.engine.method_numbers import MOREAU
from hybond.engine.mode.equations import check_depth, make_equations
from hybond.engine.mode.kept_modes import is_same
from hybond.engine.mode.mode_records import Mode, make_mode
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.mode.rows.tableau import COMMON, NET, NOT_OPEN
from hybond.engine.mode.solving import solve
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, some


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
    mode.port_acting.known = False
    p.monotone = False
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
        at = rate_bond(m, k)
        rates[k * n + column] = way_of_rate(m, k) * w[at * n + column]
