"""Which branches of junction laws carry impulses, and whether any do: law_branches.py, 1."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.svd import least_squares
from hybond.engine.complementarity.law_roles import CUT, ONE_SIDED, TWO_SIDED
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.laws.jumped_onto import find_jumped_onto
from hybond.engine.laws.law_answers import LAW_DUST, put_mode, slide
from hybond.engine.laws.law_branches import (
    TRIES,
    begin_lasting,
    keep_answered,
    next_lasting,
    no_branches,
    short_step,
)
from hybond.engine.laws.law_friction import (
    jumping_role,
    may_rest,
    past_limit,
    past_with_others,
    rests_now,
)
from hybond.engine.laws.law_instant import (
    LAW_ZERO,
    LOCATED,
    NO_LAW_VALUE,
    clean,
    find_able,
    find_rounding,
    find_start,
    hold_restitution,
    is_left_by_others,
    is_stored,
    make_consistent,
    passive_role,
    quantity,
)
from hybond.engine.laws.law_parallel import find_shares
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.response import respond
from hybond.engine.laws.strike import close_gaps, largest_gap
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.mode.rows.tableau import COMMON, NET
from hybond.engine.model import Model
from hybond.engine.reasons.facts import tell_ports
from hybond.engine.words import Floats

LONGER: Final = 1e3
"""How much longer what is stored is let move to tell an impulse from what is none."""
SHORTER: Final = 1e-6
"""How much shorter."""
TOUCHING: Final = 1e-12
"""Part of the largest gap of their domain up to which bodies that move as one touch."""


def find_breaking(e: Engine, r: Laws, x: Floats) -> int:
    """Find friction that what is stored just brings to breaking loose, into `r.loose`.

    Alone, or with what other laws give. To be asked where no law is violated. Where it slides with
    less than it held with, what is stored jumps to that. Returns 1 if there is any, 0 if none, -1
    for a refusal.
    """
    m = e.model
    edge = False
    for k in range(m.ports):
        if may_rest(m, k) and m.port_impulsive[k] == 0 and rests_now(m, r, k):
            past = max(past_limit(m, r, k), past_with_others(m, r, k))
            edge = edge or r.edge[k] != 0 or past >= -LAW_ZERO * r.rounding[k]
    if not edge:
        return 0
    if begin_lasting(e, r, x) != OK:
        return -1
    if not next_lasting(e, r, TRIES):
        return 0
    found = 0
    for k in range(m.ports):
        own = may_rest(m, k) and m.port_impulsive[k] == 0
        if own and r.answer[k] != 0 and rests_now(m, r, k):
            r.loose[k] = r.answer[k]
            found = 1
    return found


def find_jumping(e: Engine, r: Laws, x: Floats) -> int:
    """Find the mode whose branches carry impulses from the state `x`, into `r.candidate`.

    Returns 1 if there is one, 0 if no law is violated by what is stored, -1 for a refusal.
    """
    m = e.model
    n = m.ports
    if make_consistent(e, r, x) != OK:
        return -1
    if respond(e, r, r.v, r.x, False) != OK:
        return -1
    e.planar.ready = False
    find_rounding(e, r)
    clean(m, r, r.y)
    if find_able(e, r) != OK:
        return -1
    reach_gaps(e, r)
    if r.at_once:
        close_gaps(m, r)
    find_jumped_onto(m, r)
    wrong = False
    doubtful = False
    who = 0
    dust = True
    for k in range(n):
        r.edge[k] = 0
        one_sided = m.port_two_sided[k] == 0
        common = r.now.given[k] == COMMON
        # asked where it decides anything: that looks at what all others give
        decides = r.y[k] < 0.0 if r.able[k] != 0 else not common
        decides = (one_sided and decides) or (m.port_restitution[k] != NO_LAW_VALUE and common)
        if r.able[k] != 0:
            stored = decides and is_stored(m, r, k)
        else:
            stored = decides and is_left_by_others(m, r, k)
        r.rebound[k] = 0.0
        # what is stored has no speed to rebound with where it is the common variable, nor where
        # what other laws give is part of it
        if m.port_restitution[k] != NO_LAW_VALUE and common and stored:
            own = quantity(m, m.port_restitution, m.port_restitution_constant, k, r.v)
            r.rebound[k] = own if r.pressed[k] == 0 else 0.0
            if r.able[k] != 0 and r.y[k] < 0.0 and hold_restitution(e, k, own, r.t) != OK:
                return -1
        # what rebounds enters one after another; what does not stays together, as in one problem
        joins = r.rebound[k] == 0.0 or r.y[k] < 0.0 or r.at_once
        taking = one_sided and r.able[k] != 0 and joins
        # OFF where the common variable follows from what is stored alone: it must be zero
        shut = one_sided and r.able[k] == 0 and stored and r.now.given[k] == NET
        # what others give without an impulse may be all that it takes
        doubtful = doubtful or (taking and r.y[k] < 0.0 and not stored)
        if (taking and r.y[k] < 0.0 and stored) or (shut and r.y[k] != 0.0):
            wrong = True
            who = k
            dust = dust and math.fabs(r.y[k]) <= LAW_DUST * r.rounding[k]
        taking = taking or m.port_impulsive[k] != 0
        r.role[k] = passive_role(r.now, k)
        if taking:
            r.role[k] = ONE_SIDED if one_sided else TWO_SIDED
        if not one_sided and m.port_impulsive[k] == 0:
            r.role[k] = jumping_role(m, r, k)
            past = past_limit(m, r, k)
            if past > LAW_ZERO * r.rounding[k]:
                wrong = True
                who = k
                dust = dust and past <= LAW_DUST * r.rounding[k]
            doubtful = doubtful or past_with_others(m, r, k) > LAW_ZERO * r.rounding[k]
        r.rebound[k] *= r.y[k]
    if not r.at_once:
        leave_parting(m, r)
    if not wrong and not doubtful:
        keep_answered(e, r, x)
        return 0
    find_start(m, r)
    h = short_step(m, r, r.y)
    r.proved = True
    turn = 0
    while turn < 4:
        if turn > 0 and r.proved:
            break
        factor = 1.0 if turn == 0 else 1e-3 if turn == 1 else 1e3 if turn == 2 else 1e-6
        if slide(e, r, r.y, factor * h, True):
            if not wrong and not moves_stored(e, r, factor * h):
                note_edges(m, r)
                return 0
            for k in range(n):
                if r.goes_apart[k] != 0 and r.now.given[k] == NET:
                    r.answer[k] = 1
            find_shares(e, r, r.y, factor * h, True)
            put_mode(m, r, r.branch, False, True)
            return 1
        turn += 1
    if dust or not wrong:
        return 0  # rounding has no solution; what lasts is decided without it
    no_branches(e, r, who)
    if m.tells != 0:
        tell_ports(e, r, True)
    return -1


def leave_parting(m: Model, r: Laws) -> None:
    """Leave what goes apart out of an impact that rebounds: it may be struck after it.

    Held together with it, a contact, a one-way clutch or a diode would make energy,
    ``P (w + w+) / 2``.
    """
    rebounds = False
    for k in range(m.ports):
        r.goes_apart[k] = 0
        rebounds = rebounds or r.rebound[k] < 0.0
    for k in range(m.ports if rebounds else 0):
        contact = m.port_gap[k] != NO_LAW_VALUE or m.port_restitution[k] != NO_LAW_VALUE
        parts = (contact and r.now.given[k] == COMMON) or is_stored(m, r, k)
        if r.role[k] == ONE_SIDED and r.y[k] > 0.0 and parts:
            # whichever of its variables is the common one, it carries nothing
            r.role[k] = CUT
            r.goes_apart[k] = 1


def reach_gaps(e: Engine, r: Laws) -> None:
    """Let contacts touch that what is stored closes within the instant: rounding orders nothing.

    So do those that move as one and are apart by what is nothing beside the other gaps of their
    domain: after a flight together a distance of zero is rounding, of either sign.
    """
    m = e.model
    room = room_of_instant(e, r.t)
    for k in range(m.ports):
        if m.port_gap_pair[k] < 0 or r.able[k] != 0 or r.now.given[k] != COMMON:
            continue
        beside = TOUCHING * largest_gap(m, r, k) if r.y[k] == 0.0 else 0.0
        if r.gap_now[k] <= max(-r.y[k] * room, beside):
            r.able[k] = 1
            r.reach[k] = r.gap_now[k]


def note_edges(m: Model, r: Laws) -> None:
    """Note the friction at rest that gives all it can: the next moment may break it loose."""
    for k in range(m.ports):
        open_end = r.answer_open[k] != 0 and r.answer[k] == 0
        r.edge[k] = 1 if open_end and may_rest(m, k) and r.resting[k] != 0 else 0


def moves_stored(e: Engine, r: Laws, h: float) -> bool:
    """Whether an answer in which what is stored moves for a time `h` has impulses.

    They move it as far whatever the time is. What laws give without them moves it the farther the
    longer that lasts, until it is used up: the current of a coil that a leak carries is gone soon.
    """
    n = e.model.ports
    moves = False
    for k in range(n):
        r.here_moved[k] = moved_in(r, n, h, k)
        moves = moves or r.here_moved[k] > LAW_DUST * r.rounding[k]
    if not moves:
        return False
    moves = moves_alike(e, r, h, LONGER)
    if moves:
        moves = moves_alike(e, r, h, SHORTER)
    return slide(e, r, r.y, h, True) and moves


def moves_alike(e: Engine, r: Laws, h: float, factor: float) -> bool:
    """Whether an answer for another time moves something as far; true where there is none."""
    m = e.model
    n = m.ports
    if not slide(e, r, r.y, factor * h, True):
        return True
    for k in range(n):
        here = r.here_moved[k]
        if here > LAW_DUST * r.rounding[k]:
            moved = moved_in(r, n, factor * h, k)
            if factor > 1.0 and moved < math.sqrt(LONGER) * here:
                return True
            # friction that is torn loose moves what is stored by what others hold it with
            if factor < 1.0 and (m.port_two_sided[k] != 0 or math.sqrt(LONGER) * moved > here):
                return True
    return False


def moved_in(r: Laws, n: int, h: float, k: int) -> float:
    """Return how far the answer moves `y` of a port in a time `h`."""
    total = 0.0
    for j in range(n):
        total += h * r.response.ce[k * n + j] * r.answer_l[j]
    return math.fabs(total)


def sweep_dust(e: Engine, r: Laws, x: Floats, after: Floats) -> int:
    """Put the state without approaches that are nothing but rounding into `after`.

    For the laws they are zero, for the guards that watch them they may not be. They are taken away
    as an impact would, along the impulses of their contacts.
    """
    m = e.model
    n = m.ports
    a = r.response
    if make_consistent(e, r, x) != OK or respond(e, r, r.v, r.x, False) != OK:
        return REFUSED
    find_rounding(e, r)
    if find_able(e, r) != OK:
        return REFUSED
    many = 0
    for k in range(n):
        slow = a.y[k] < -LOCATED * LAW_ZERO * r.rounding[k] and a.y[k] >= -LAW_ZERO * r.rounding[k]
        if slow and m.port_two_sided[k] == 0 and is_stored(m, r, k) and r.able[k] != 0:
            r.tried[many] = k
            many += 1
    for s in range(m.storages):
        after[s] = r.x[s]
    if many == 0:
        return OK
    for i in range(many):
        r.q[i] = -a.y[r.tried[i]]
        for j in range(many):
            r.block[i * many + j] = a.ce[r.tried[i] * n + r.tried[j]]
    least_squares(r.svd, many, many, r.block, -1.0, 1, r.q, r.l)
    for s in range(m.storages):
        for i in range(many):
            after[s] += a.e[s * n + r.tried[i]] * r.l[i]
    return OK
