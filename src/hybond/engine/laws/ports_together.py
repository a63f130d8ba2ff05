"""Ports that can be tried together: of those that act on no bond variable together.

What a port gives acts on its own bonds, and through laws of resistors on others; what is stored
acts on ports in the same way. In a row of a hundred tanks with check valves between them a port
acts on the levels beside it alone, and two solutions tell of all ports what a hundred would.
It is told from what laws read, whether their slopes are zero or not.

Source: A. R. Curtis, M. J. D. Powell, J. K. Reid, "On the estimation of sparse Jacobian matrices",
J. Inst. Math. Appl. 13 (1974).
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import fit_places, grow_places
from hybond.engine.engine import Engine
from hybond.engine.laws.law_records import Laws, Ports
from hybond.engine.laws.ports import open_mode, partner_row
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.acting import MOST_ROOM, add_state, spread, take_bond
from hybond.engine.model import Model
from hybond.engine.words import Floats

FEWEST: Final = 4
"""Ports below which it is not worth it."""


def are_told_apart(e: Engine, r: Laws, p: Ports) -> bool:
    """Whether it is known which ports can be tried together; found once for a configuration."""
    m = e.model
    mode = open_mode(e, p)
    a = mode.port_acting
    if mode.dynamics == 0 or mode.rank != mode.structures or mode.loose > 0:
        return False
    if not a.known:
        a.known = True
        a.groups = 0
        n = m.storages + m.integrals + m.ports
        rows = mode.sources + mode.apart.groups + 2 * m.bonds
        if m.ports < FEWEST or mode.apart.groups < 2 or rows * n > MOST_ROOM:
            return False
        fit_places(r.truths, rows * n)
        find_acting(m, r, p, mode, n)
    return a.groups > 0


def find_acting(m: Model, r: Laws, p: Ports, mode: Mode, n: int) -> None:
    """List what ports, and what is stored, act on; n states and ports are told apart."""
    sets = mode.sources + mode.apart.groups
    room = r.truths.at
    for i in range((sets + 2 * m.bonds) * n):
        room[i] = 0
    first = m.storages + m.integrals
    for k in range(m.ports):
        add_state(room, n, first + k, p.column[k])
    grows = True
    while grows:
        grows = spread(m, mode, room, n)
    for b in range(2 * m.bonds):
        take_bond(m, mode, room, n, b, sets + b)
    list_bonds(m, r, mode, n, sets)
    list_ports(m, r, p, mode, n, sets)
    group_ports(m, r, mode)


def list_bonds(m: Model, r: Laws, mode: Mode, n: int, sets: int) -> None:
    """List the bond variables that each port acts on."""
    a = mode.port_acting
    room = r.truths.at
    first = m.storages + m.integrals
    many = 0
    for b in range(2 * m.bonds):
        for k in range(m.ports):
            many += room[(sets + b) * n + first + k]
    fit_places(a.first, m.ports + 1)
    fit_places(a.rate, many)
    many = 0
    for k in range(m.ports):
        a.first.at[k] = many
        for b in range(2 * m.bonds):
            if room[(sets + b) * n + first + k] != 0:
                a.rate.at[many] = b
                many += 1
    a.first.at[m.ports] = many


def list_ports(m: Model, r: Laws, p: Ports, mode: Mode, n: int, sets: int) -> None:
    """List the ports of which what is stored acts on `w`."""
    a = mode.stored_acting
    room = r.truths.at
    fit_places(a.first, m.storages + 1)
    many = 0
    for s in range(m.storages):
        a.first.at[s] = many
        for k in range(m.ports):
            row = partner_row(p, k)
            acts = False
            for i in range(m.pair_first[row], m.pair_first[row + 1]):
                acts = acts or room[(sets + m.pair_column[i]) * n + s] != 0
            if acts:
                grow_places(a.rate, many + 1)
                a.rate.at[many] = k
                many += 1
    a.first.at[m.storages] = many


def group_ports(m: Model, r: Laws, mode: Mode) -> None:
    """Put each port into the first group of which no other acts on what it acts on."""
    a = mode.port_acting
    room = r.truths.at
    many = 2 * m.bonds
    for i in range(m.ports * many):
        room[i] = 0
    fit_places(a.group, m.ports)
    for k in range(m.ports):
        g = 0
        while g < a.groups and is_met(m, r, mode, k, g * many):
            g += 1
        a.group.at[k] = g
        a.groups = max(a.groups, g + 1)
        for q in range(a.first.at[k], a.first.at[k + 1]):
            room[g * many + a.rate.at[q]] = 1


def is_met(m: Model, r: Laws, mode: Mode, k: int, begin: int) -> bool:
    """Whether a group acts on a bond variable that port k acts on."""
    a = mode.port_acting
    for q in range(a.first.at[k], a.first.at[k + 1]):
        if r.truths.at[begin + a.rate.at[q]] != 0:
            return True
    return False


def next_together(m: Model, r: Laws, mode: Mode, pushes: Floats) -> bool:
    """Choose ports, of those left, whose pushes on what is stored are felt by no port together.

    Column j of `pushes` is what port j moves. Those chosen are 1 in `r.chosen`, those left for
    later are 2, all others 0; whether any was left.
    """
    for s in range(m.storages):
        r.stored_taken[s] = 0
    for k in range(m.ports):
        r.port_taken[k] = 0
    some = False
    for j in range(m.ports):
        r.chosen[j] = 2 if r.chosen[j] == 2 else 0
        if r.chosen[j] == 2 and not is_taken(m, r, mode, pushes, j):
            r.chosen[j] = 1
            some = True
            mark_pushed(m, r, mode, pushes, j)
    return some


def is_taken(m: Model, r: Laws, mode: Mode, pushes: Floats, j: int) -> bool:
    """Whether those chosen move what port j moves, or act on what that acts on."""
    a = mode.stored_acting
    for s in range(m.storages):
        if pushes[s * m.ports + j] == 0.0:
            continue
        if r.stored_taken[s] != 0:
            return True
        for q in range(a.first.at[s], a.first.at[s + 1]):
            if r.port_taken[a.rate.at[q]] != 0:
                return True
    return False


def mark_pushed(m: Model, r: Laws, mode: Mode, pushes: Floats, j: int) -> None:
    """Take for port j, as the number ``j + 1``, what it moves and which ports feel that."""
    a = mode.stored_acting
    for s in range(m.storages):
        if pushes[s * m.ports + j] != 0.0:
            r.stored_taken[s] = j + 1
            for q in range(a.first.at[s], a.first.at[s + 1]):
                r.port_taken[a.rate.at[q]] = j + 1
