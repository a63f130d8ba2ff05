"""Impacts in a graph by a law that sees all closed contacts at once, put into bonds and storage.

Newton's law contact after contact needs none of this: it is a branch of the contact's own law.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.answers import node_name
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.impacts.impact_laws import exchange_impulses
from hybond.engine.impacts.impact_records import (
    CANNOT_STOP,
    CREATES_ENERGY,
    DEPENDS,
    EXCHANGED,
    NEWTON_SIMULTANEOUS,
    Impact,
)
from hybond.engine.jumps.jump import JUMPS
from hybond.engine.laws.jumped_onto import find_jumped_onto
from hybond.engine.laws.law_instant import (
    CLOSED,
    NO_LAW_VALUE,
    clean,
    find_able,
    find_rounding,
    hold_restitution,
    make_consistent,
    quantity,
)
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.ports import solve_with, times_partner
from hybond.engine.laws.response import respond
from hybond.engine.model import Model
from hybond.engine.words import Floats

REACHED: Final = 1e-6
"""Part of the velocities by which storage that is not linear may miss what the law asks for."""
NOTHING_STRIKES: Final = 0
STRIKES: Final = 1
REFUSES: Final = -1


def strike_at_once(e: Engine, r: Laws, x: Floats) -> int:
    """Find the jump of an impact at all closed contacts: STRIKES, NOTHING_STRIKES, or REFUSES.

    The state after it is put into `r.landed`, impulses of bonds into `r.struck_impulses`, the
    branches that carry it into `r.through`.
    """
    m = e.model
    if make_consistent(e, r, x) != OK:
        return REFUSES
    # what sources alone ask for is an impulse as well
    copy_floats(2 * m.bonds, e.impulses, r.struck_impulses)
    if respond(e, r, r.v, r.x, False) != OK:
        return REFUSES
    find_rounding(e, r)
    clean(m, r, r.y)
    if find_able(e, r) != OK:
        return REFUSES
    close_gaps(m, r)
    some = False
    for k in range(m.ports):
        rebounds = m.port_restitution[k] != NO_LAW_VALUE
        some = some or (rebounds and r.able[k] != 0 and r.y[k] < 0.0)
    if not some:
        return NOTHING_STRIKES
    i = r.impact
    find_jumped_onto(m, r)
    take_contacts(m, r, i)
    for at in range(i.n):
        if i.v[at] < 0.0 and hold_restitution(e, r.tried[at], i.eps[at], r.t) != OK:
            return REFUSES
    found = exchange_impulses(i, m.impact)
    if found != EXCHANGED:
        return refuse_impact(e, r, found)
    put_impulses_of(m, r, i)
    return STRIKES if is_reached(e, r, i) == OK else REFUSES


def close_gaps(m: Model, r: Laws) -> None:
    """Close gaps below the tolerance, measured by what contacts of their domain have been open.

    Bodies that flew together and come back together have gaps that were never more than rounding;
    those that should meet at one instant are apart by the error of the run. Contact after contact
    it does not matter which of them closes first; at once it does.
    """
    for k in range(m.ports):
        if r.able[k] != 0 or m.port_gap[k] == NO_LAW_VALUE:
            continue
        largest = largest_gap(m, r, k)
        if quantity(m, m.port_gap, m.port_gap_constant, k, r.v) <= max(CLOSED, m.rtol) * largest:
            r.able[k] = 1


def largest_gap(m: Model, r: Laws, k: int) -> float:
    """Return how far any contact of the domain of port k has been open in this run."""
    largest = 0.0
    for j in range(m.ports):
        if m.port_domain[j] == m.port_domain[k]:
            largest = max(largest, r.largest[j])
    return largest


def take_contacts(m: Model, r: Laws, i: Impact) -> None:
    """Put the contacts that are closed, or about to be, into the impact."""
    n = m.ports
    a = r.response
    i.n = 0
    i.exponent = m.impact_exponent
    for k in range(n):
        touches = m.port_gap[k] != NO_LAW_VALUE or r.y[k] <= 0.0
        moves = a.d[k * n + k] == 0.0 and a.ce[k * n + k] > 0.0
        if r.able[k] == 0 or not touches or not moves or m.port_two_sided[k] != 0:
            continue
        at = i.n
        r.tried[at] = k
        i.v[at] = r.y[k]
        i.eps[at] = 0.0
        # Newton's law reads the approach before the instant, others what there is to compress
        reads = m.impact != NEWTON_SIMULTANEOUS or r.pressed[k] == 0
        if reads and m.port_restitution[k] != NO_LAW_VALUE:
            i.eps[at] = quantity(m, m.port_restitution, m.port_restitution_constant, k, r.v)
        i.stiffness[at] = 1.0
        if m.port_stiffness[k] != NO_LAW_VALUE:
            i.stiffness[at] = quantity(m, m.port_stiffness, m.port_stiffness_constant, k, r.v)
        i.n += 1
    for p in range(i.n):
        for q in range(i.n):
            there = a.ce[r.tried[p] * n + r.tried[q]]
            back = a.ce[r.tried[q] * n + r.tried[p]]
            i.w[p * i.n + q] = 0.5 * (there + back)


def put_impulses_of(m: Model, r: Laws, i: Impact) -> None:
    """Let the impulses of contacts act on what is stored, and through all bonds."""
    n = m.ports
    a = r.response
    copy_floats(m.storages, r.x, r.landed)
    copy_places(m.machines, r.state, 0, r.through, 0)
    for p in range(i.n):
        k = r.tried[p]
        nu = i.impulses[p]
        for s in range(m.storages):
            r.landed[s] += a.e[s * n + k] * nu
        for b in range(2 * m.bonds):
            r.struck_impulses[b] += a.gain[b * n + k] * nu
        r.through[m.port_machine[k]] = carrying(m, k) if nu > 0.0 else 0
    r.struck = True
    r.struck_moved = JUMPS
    r.factors = 0


def carrying(m: Model, k: int) -> int:
    """Return the branch in which the contact of port k carries an impulse."""
    return 2 if m.port_restitution[k] != NO_LAW_VALUE else 1


def is_reached(e: Engine, r: Laws, i: Impact) -> int:
    """Refuse storage that does not follow the law: HB-J206."""
    m = e.model
    copy_places(m.machines, r.state, 0, e.trial.state, 0)
    copy_floats(2 * m.slots, r.v, r.later)
    copy_part(m.storages, r.landed, 0, r.later, m.stored_slot)
    for k in range(m.ports):
        r.l[k] = 0.0
    if solve_with(e, r.now, r.later, r.l) != OK:
        return REFUSED
    times_partner(m, r.now, e.work.w, r.row)
    missed = 0.0
    fastest = 0.0
    for p in range(i.n):
        missed = max(missed, math.fabs(r.row[r.tried[p]] - i.after[p]))
        fastest = max(fastest, math.fabs(i.v[p]))
    if missed <= REACHED * fastest:
        return OK
    found = say_fault(e, "HB-J206", "the velocities are not those that the law asks for", "")
    e.fault.t = r.t
    return found


def refuse_impact(e: Engine, r: Laws, found: int) -> int:
    """Refuse an impact that its law has no answer to.

    The place is the first of the contacts that it is about; in the mode that is then said to be
    tried, these are the only one-sided laws that are not in their first branch.
    """
    m = e.model
    i = r.impact
    copy_places(m.machines, r.state, 0, e.trial.state, 0)
    for k in range(m.ports):
        if m.port_two_sided[k] == 0:
            e.trial.state[m.port_machine[k]] = 0
    for q in range(i.n):
        if i.blamed[q] != 0:
            e.trial.state[m.port_machine[r.tried[q]]] = carrying(m, r.tried[q])
    code = "HB-J204"
    why = "the contacts are still active after many phases of compression and expansion"
    if found == CREATES_ENERGY:
        code = "HB-J201"
        why = "the impact law would create energy: contacts that meet differ in restitution"
    if found == DEPENDS:
        code = "HB-J202"
        why = "these contacts depend on each other, but their restitution differs"
    if found == CANNOT_STOP:
        code = "HB-J203"
        why = "no impulses stop the approach: nothing that can move gives way"
    p = 0
    while p < i.n - 1 and i.blamed[p] == 0:
        p += 1
    say_fault(e, code, why, node_name(m, m.port_node[r.tried[p]]))
    e.fault.t = r.t
    return REFUSES
