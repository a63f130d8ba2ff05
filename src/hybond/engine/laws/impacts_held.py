"""The law of impacts put back: the speeds after a jump of contacts, of those before it.

Each law of `impacts/impact_laws` says something that can be seen without solving it again:

Newton's, contact after contact
    who carries an impulse leaves by its restitution, ``v+ = -eps v``
Newton's, all at once
    so it does, and no closed contact leaves slower than that, ``v+ >= -eps v``
Poisson's, and springs
    no closed contact approaches after it, ``v+ >= 0``; one that is alone leaves by its restitution

No impulse pulls. Looked at are contacts whose speed what is stored decides.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import OK, Engine
from hybond.engine.impacts.impact_records import NEWTON, NEWTON_SIMULTANEOUS
from hybond.engine.laws.law_instant import NO_LAW_VALUE, is_stored, quantity
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.ports import open_mode, partner_row, solve_with, times_partner
from hybond.engine.method_numbers import MOREAU
from hybond.engine.mode.digits.part_energies import find_energies_at, part_of_bond
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.reasons.noting import IMPACT, note_violation
from hybond.engine.words import Floats

MISSED: Final = 1e-6
"""Part of the fastest speed by which one may miss its law, as where storage is not linear."""
ROUNDED: Final = 64.0 * EPSILON
"""Likewise, of the two speeds that it is the difference of: balls side by side approach by what is
rounding of theirs."""
CARRIES: Final = 1e-9
"""Part of the largest impulse from which on one is more than rounding."""


def hold_impact(e: Engine, r: Laws, by_branches: bool) -> None:
    """Hold the jump from `r.x` to `r.landed` against the law of impacts that the run asks for.

    Where branches of laws carry it, restitution is of the approach that ``pre()`` reads: of none
    where a contact went apart before a source has jumped, of what is left where that is less.
    """
    m = e.model
    c = e.checks
    if not has_contacts(e, r):
        return
    for k in range(m.ports):
        c.terms[k] = 0.0
    if not show_speeds(e, r, r.x, c.before):
        return
    if by_branches:
        copy_part(2 * m.bonds, e.pre, m.bond_slot, c.prior, 0)
        times_partner(m, r.now, c.prior, c.before)
        for k in range(m.ports):
            c.before[k] += r.gone[k]
    for k in range(m.ports):
        if not by_branches and m.impact == NEWTON_SIMULTANEOUS and r.pressed[k] != 0:
            c.before[k] = 0.0
    if not show_speeds(e, r, r.landed, c.after):
        return
    fastest = 0.0
    strongest = 0.0
    closed = 0
    for k in range(m.ports):
        if is_contact(e, r, k):
            fastest = max(fastest, max(math.fabs(c.before[k]), math.fabs(c.after[k])))
            strongest = max(strongest, math.fabs(impulse_of(e, r, k)))
            closed += 1
    if not strikes(e, r, MISSED * fastest):
        return
    for k in range(m.ports):
        if by_branches:
            c.before[k] = min(c.before[k], 0.0)
        if is_contact(e, r, k):
            hold_contact(e, r, k, closed == 1, MISSED * fastest, CARRIES * strongest)


def hold_contact(e: Engine, r: Laws, k: int, alone: bool, may: float, least: float) -> None:
    """Hold the contact of port k against it, speeds being off by no more than `may`."""
    m = e.model
    c = e.checks
    nu = impulse_of(e, r, k)
    eps = 0.0
    if m.port_restitution[k] != NO_LAW_VALUE:
        eps = quantity(m, m.port_restitution, m.port_restitution_constant, k, r.v)
    target = -eps * c.before[k]
    carries = nu > least
    # time-stepping has this one built in, and settles its start by it
    asked = NEWTON_SIMULTANEOUS if m.method == MOREAU else m.impact
    off = 0.0
    if nu < -least:
        off = math.fabs(nu)
    elif carries and (alone or asked == NEWTON or asked == NEWTON_SIMULTANEOUS):
        off = math.fabs(c.after[k] - target)
    elif asked == NEWTON_SIMULTANEOUS:
        off = max(target - c.after[k], 0.0)
    elif asked != NEWTON:
        off = max(-c.after[k], 0.0)
    if nu < -least:
        # an impulse is a difference of momenta, of which energy over speed tells the size
        held = energy_at(e, r, k)
        wrong = off * c.terms[k] > ROUNDED * held
    else:
        wrong = off > may + ROUNDED * c.terms[k]
    if wrong:
        size = math.fabs(c.after[k]) + math.fabs(target)
        note_violation(e, e.mode, r.t, IMPACT, k, off, size)


def energy_at(e: Engine, r: Laws, k: int) -> float:
    """Return the largest energy that the part of port k has held, J."""
    m = e.model
    mode = open_mode(e, r.now)
    energies = e.work.part_root
    find_energies_at(e, mode, r.x, energies)
    return energies[part_of_bond(m, mode, m.end_bond[m.end_first[m.port_junction[k]]])]


def strikes(e: Engine, r: Laws, least: float) -> bool:
    """Whether any contact with a restitution approached by more than `least`."""
    found = False
    for k in range(e.model.ports):
        rebounds = e.model.port_restitution[k] != NO_LAW_VALUE
        found = found or (rebounds and is_contact(e, r, k) and e.checks.before[k] < -least)
    return found


def has_contacts(e: Engine, r: Laws) -> bool:
    """Whether any contact that is looked at has a restitution."""
    found = False
    for k in range(e.model.ports):
        rebounds = e.model.port_restitution[k] != NO_LAW_VALUE
        found = found or (rebounds and is_contact(e, r, k))
    return found


def is_contact(e: Engine, r: Laws, k: int) -> bool:
    """Whether port k is a contact that is closed, and what is stored decides its speed."""
    m = e.model
    if m.port_two_sided[k] != 0 or r.able[k] == 0 or r.now.given[k] != COMMON:
        return False
    return m.port_gap[k] != NO_LAW_VALUE and is_stored(m, r, k)


def impulse_of(e: Engine, r: Laws, k: int) -> float:
    """Return the impulse of the contact of port k: that of its common variable."""
    m = e.model
    j = m.port_junction[k]
    if m.end_first[j] == m.end_first[j + 1]:
        return 0.0
    return r.struck_impulses[
        m.end_bond[m.end_first[j]] + (m.bonds if m.junction_kind[j] != 0 else 0)
    ]


def show_speeds(e: Engine, r: Laws, x: Floats, speed: Floats) -> bool:
    """Put what ports read with `x` stored into `speed`, nothing being given to them.

    What it is made of is in `e.checks.terms`, if that is more than it was.
    """
    m = e.model
    mode = open_mode(e, r.now)
    copy_floats(2 * m.slots, r.v, r.later)
    copy_part(m.storages, x, 0, r.later, m.stored_slot)
    for k in range(m.ports):
        r.l[k] = 0.0
    hold_guess(e, mode)
    found = solve_with(e, r.now, r.later, r.l)
    give_back_guess(e, mode)
    if found != OK:
        e.laws.unanswered = False
        return False
    times_partner(m, r.now, e.work.w, speed)
    for k in range(m.ports):
        row = partner_row(r.now, k)
        size = 0.0
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            size += math.fabs(m.pair_value[i] * e.work.w[m.pair_column[i]])
        e.checks.terms[k] = max(e.checks.terms[k], size)
    return True
