"""Which variable of a junction law is the unknown of a time step: its current, its contact force.

Causality gives the variable that leaves the most storage integral, whichever it is where both
would do. A time step averages what the graph does with ``l = 0`` and takes all that `l` brings from
its end, so there the choice makes a difference, of the order of the step. Here it is the common
variable wherever that costs nothing: then ``l = 0`` is the graph with its diodes blocking and its
contacts open, as in the published schemes.
"""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.laws.law_records import Laws, Ports
from hybond.engine.mode.equations import make_equations
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.tableau import COMMON, NET, NOT_OPEN


def prefer_common(e: Engine, r: Laws, p: Ports, mode: Mode) -> None:
    """Give the common variable of one-sided laws where that costs no constraint and no freedom.

    The equations of `mode` have been made with what is given in `p`; they are again if that
    changes.
    """
    m = e.model
    bound = mode.constraints.rows + mode.agreements.rows
    frees = mode.finite_frees
    changed = False
    for k in range(m.ports):
        if m.port_two_sided[k] != 0 or p.given[k] == COMMON:
            continue
        p.given[k] = COMMON
        make_again(e, r, p, mode)
        now = mode.constraints.rows + mode.agreements.rows
        costs = now > bound or (now == bound and mode.finite_frees > frees)
        if costs or mode.too_high or reads_port(e, mode):
            p.given[k] = NET
            changed = True
        else:
            changed = False
    if changed:
        make_again(e, r, p, mode)


def choose_given(e: Engine, r: Laws, p: Ports, mode: Mode) -> None:
    """Give the other variable of a law where that costs less, one law after the other.

    For models with more settings of machines than are looked at beforehand. What is dearer than it
    had to be is right all the same: constraints that contain no `l`.
    """
    m = e.model
    improved = True
    while improved:
        improved = False
        for k in range(m.ports):
            bound = mode.constraints.rows + mode.agreements.rows
            frees = mode.finite_frees
            if bound == 0 and frees == 0:
                return
            before = p.given[k]
            p.given[k] = NET if before == COMMON else COMMON
            make_again(e, r, p, mode)
            now = mode.constraints.rows + mode.agreements.rows
            cheaper = now < bound or (now == bound and mode.finite_frees < frees)
            if cheaper and not mode.too_high and not reads_port(e, mode):
                improved = True
                continue
            p.given[k] = before
            make_again(e, r, p, mode)


def make_again(e: Engine, r: Laws, p: Ports, mode: Mode) -> None:
    """Make the equations with what is given."""
    m = e.model
    for j in range(m.junctions):
        r.given[j] = NOT_OPEN
    for k in range(m.ports):
        r.given[m.port_junction[k]] = p.given[k]
    make_equations(e, mode, r.given)


def reads_port(e: Engine, mode: Mode) -> bool:
    """Whether a constraint prescribes what the laws should decide."""
    m = e.model
    for kind in range(2):
        table = mode.constraints if kind == 0 else mode.agreements
        for i in range(table.first.at[table.rows]):
            k = table.column.at[i] - m.storages
            if k >= mode.sources:
                k -= mode.sources
            if k >= 0 and mode.source[k] < 0:
                return True
    return False
