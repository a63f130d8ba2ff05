"""Junction laws at one instant: the values there, what each law may do, what is rounding."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.answers import node_name, value
from hybond.engine.complementarity.law_roles import CUT, SHUT
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.expressions.paired import evaluate_pair, holds
from hybond.engine.expressions.pairs import clear, sign_at
from hybond.engine.jumps.jump import enter_mode
from hybond.engine.laws.gaps import check_gaps
from hybond.engine.laws.law_records import Laws, Ports
from hybond.engine.laws.ports import open_mode, partner_row, ports_of
from hybond.engine.method_numbers import MOREAU
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import LEAST, room_of_instant
from hybond.engine.mode.digits.part_energies import (
    STORED,
    find_energies_at,
    part_of_bond,
    see_energy,
    settled_terms,
)
from hybond.engine.mode.digits.sizes import measure_values, seen_of
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.model import Model
from hybond.engine.reasons.facts import add_fact
from hybond.engine.surfaces.values import set_values
from hybond.engine.words import Floats, Ints

LAW_ZERO: Final = 1e-12
"""Part of its terms below which a value counts as zero; guards are located a tenth before that, so
that what passes through zero at an event is decided by its rate."""
LOCATED: Final = 0.02
"""Part of that zero from which on guards may be located."""
CLOSED: Final = 1e-10
"""Part of the largest gap so far below which a gap is closed."""
JUMPED: Final = 1e-9
"""Part of the largest gap, and of its terms, by which a gap opens at least that jumps, ..."""
STEEPER: Final = 16.0
"""... and times as much as in an interval just before: what time does, or drift, is no jump."""
GIVEN_APART: Final = 1e-6
"""Part of a gap's terms by which a contact that is given as closed may be apart, ..."""
GIVEN_IN_STEPS: Final = 1e-2
"""... and in time-stepping, which closes it at up to half a step's motion."""
NO_LAW_VALUE: Final = -2
"""What stands for an option that a law does not have; -1 is a constant."""


def quantity(m: Model, law: Ints, constant: Floats, k: int, v: Floats) -> float:
    """Return the value of an option of law k."""
    return constant[k] if law[k] < 0 else value(m, law[k], v)


def hold_restitution(e: Engine, k: int, eps: float, t: float) -> int:
    """Refuse an impact whose restitution is below zero, or none: the body would go on into it."""
    if eps >= 0.0:
        return OK
    m = e.model
    why = "the restitution of this impact is below zero"
    if eps != eps:
        why = "the restitution of this impact has no value"
    say_fault(e, "HB-N412", why, node_name(m, m.port_node[k]))
    if m.tells != 0:
        add_fact(e.fault, float(m.port_machine[k]))
        add_fact(e.fault, eps)
    e.fault.t = t
    return REFUSED


def take_instant(e: Engine, r: Laws, t: float, s: Floats, state: Ints) -> None:
    """Take the instant that is looked at, and the mode that it begins with."""
    m = e.model
    r.answered = False
    r.parting = False
    r.t = t
    copy_floats(m.integrals, s, r.s)
    copy_places(m.machines, state, 0, r.state, 0)


def make_consistent(e: Engine, r: Laws, x: Floats) -> int:
    """Take the ports into `r.now`, the values into `r.v`, the state into `r.x`.

    The state is put on what the machines' mode alone asks for.
    """
    m = e.model
    r.answered = False
    if ports_of(e, r, r.state) != OK:
        return REFUSED
    mode = open_mode(e, r.now)
    set_values(e, mode, r.v, r.t, x, r.s)
    copy_part(m.slots, e.pre, 0, r.v, m.slots)
    for k in range(2 * m.bonds):
        r.v[m.bond_slot + k] = 0.0
    energy = e.energy
    copy_floats(e.parts, e.part_energy, r.kept_energy)
    see_energy(e, x)
    found = OK
    if not r.gaps_known:
        found = check_gaps(e, r, x)
        r.gaps_known = found == OK
    if found == OK:
        found = enter_mode(e, mode, r.v, x, r.x)
    e.energy = energy
    copy_floats(e.parts, r.kept_energy, e.part_energy)
    e.energies_seen += 1.0
    copy_part(m.storages, r.x, 0, r.v, m.stored_slot)
    return found


def find_able(e: Engine, r: Laws) -> int:
    """Find which laws may take their ON branch at all: contacts closed, thyristors fired."""
    m = e.model
    stack = e.work.stack
    stack.now = r.v
    stack.was = r.v
    stack.was_first = 0
    stack.jumps = False
    stack.terms = r.terms
    stack.prior_terms = r.terms
    for k in range(m.ports if r.reach_t != r.t else 0):
        r.reach[k] = 0.0
    r.reach_t = r.t
    for k in range(m.ports):
        on = is_on(m, k, r.state[m.port_machine[k]])
        r.able[k] = 1
        if m.port_gap[k] != NO_LAW_VALUE:
            gap = m.port_gap_constant[k]
            sign = 1 if gap > 0.0 else -1 if gap < 0.0 else 0
            if m.port_gap_pair[k] >= 0:
                # rounding of a gap is that of its terms, as for the guards that watch it
                evaluate_gap(e, r, k, r.v)
                gap = stack.finite[stack.top]
                sign = sign_at(stack, stack.top)
                if stack.refused != 0:
                    place = node_name(m, m.port_node[k])
                    return say_fault(e, "HB-J101", "a gap is not a number", place)
                if not math.isfinite(gap):
                    # nothing touches at no distance, and nothing is known of what is beyond any
                    place = node_name(m, m.port_node[k])
                    say_fault(e, "HB-N302", "the gap of the contact is infinite", place)
                    e.fault.t = r.v[0]
                    return REFUSED
            r.largest[k] = max(r.largest[k], math.fabs(gap))
            stays = on and not is_left(e, r, k, gap)
            touches = sign <= 0 or gap <= CLOSED * r.largest[k] or gap <= r.reach[k]
            r.able[k] = 1 if stays or touches else 0
            r.gap_now[k] = gap
        if m.port_gate[k] != NO_LAW_VALUE:
            gate = quantity(m, m.port_gate, m.port_gate_constant, k, r.v) != 0.0
            if m.port_gate_pair[k] >= 0:
                # what it compares is zero by rounding where its law's own rule counts it as zero
                measure_values(m, m.port_gate_pair[k], r.v, r.terms)
                stack.was = e.pre
                gate = holds(m, m.port_gate_pair[k], stack)
                stack.was = r.v
                if stack.refused != 0:
                    place = node_name(m, m.port_node[k])
                    return say_fault(e, "HB-J101", "a gate is not a number", place)
            r.able[k] = 1 if on or gate else 0
    return OK


def evaluate_gap(e: Engine, r: Laws, k: int, v: Floats) -> None:
    """Put the gap of contact k, no constant, on ``e.work.stack`` with the size of its terms."""
    stack = e.work.stack
    stack.now = v
    stack.was = v
    stack.was_first = 0
    stack.jumps = False
    stack.terms = r.terms
    stack.prior_terms = r.terms
    measure_values(e.model, e.model.port_gap_pair[k], v, r.terms)
    clear(stack)
    evaluate_pair(e.model, e.model.port_gap_pair[k], stack)


def is_left(e: Engine, r: Laws, k: int, gap: float) -> bool:
    """Whether contact k has been left by its gap, which was another just before the instant.

    So is what was given as closed where it is not. The gap is on the stack.
    """
    size = max(r.largest[k], e.work.stack.size[e.work.stack.top])
    given = GIVEN_IN_STEPS if e.model.method == MOREAU else GIVEN_APART
    if r.gaps_given and gap > given * size:
        return True
    if not r.gaps_noted or e.model.port_gap_pair[k] < 0:
        return False
    least = JUMPED * size
    steady = STEEPER * math.fabs(r.gap_before[k] - r.gap_earlier[k])
    return gap - r.gap_before[k] > max(least, steady) and gap > least


def is_on(m: Model, k: int, state: int) -> bool:
    """Whether a state of the machine of port k switches anything ON."""
    at = m.state_first[m.port_machine[k]] + state
    return m.on_first[at + 1] > m.on_first[at]


def find_rounding(e: Engine, r: Laws) -> None:
    """Find what rounding of each `y` is measured by."""
    m = e.model
    mode = open_mode(e, r.now)
    root = e.work.part_root
    find_energies_at(e, mode, r.x, root)
    for p in range(mode.parts + 1):
        root[p] = math.sqrt(root[p])
    seen_of(e, mode, r.v, r.x)
    for k in range(m.ports):
        row = partner_row(r.now, k)
        stored = 0.0
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            b = m.pair_column[i]
            reach = root[part_of_bond(m, mode, b)] * mode.seen[b]
            reach += settled_terms(m, mode, b, e.work.xi)
            stored += math.fabs(m.pair_value[i]) * reach
        r.rounding[k] = r.response.size[k] + STORED * stored
    add_moved_within(e, r)


def add_moved_within(e: Engine, r: Laws) -> None:
    """Add what friction that slides moves of each `y` in the last places of the time.

    No instant says more of it. What is stored counts for more than that, unless all of it settles
    within a moment. What sources move where laws act at once, as the voltage at a bridge that
    crosses zero, is known to no more than the instant lasts.
    """
    m = e.model
    n = m.ports
    room = room_of_instant(e, r.t) / LAW_ZERO
    for k in range(n):
        if not is_stored(m, r, k):
            r.rounding[k] += math.fabs(r.pushed[k]) * room
    for j in range(n):
        most = slides_within(e, r, j) / LAW_ZERO
        for k in range(n if most > 0.0 else 0):
            r.rounding[k] += math.fabs(r.response.ce[k * n + j]) * most


def slides_within(e: Engine, r: Laws, j: int) -> float:
    """Return what friction that slides gives in the last places of the time; 0 of other laws."""
    m = e.model
    if m.port_two_sided[j] == 0 or r.state[m.port_machine[j]] == 0:
        return 0.0
    limit = math.fabs(quantity(m, m.port_limit, m.port_limit_constant, j, r.v))
    return limit * LEAST * spacing(r.t)


def clean(m: Model, r: Laws, y: Floats) -> None:
    """Put `y` of the response there, rounding counted as zero."""
    for k in range(m.ports):
        own = r.response.y[k]
        y[k] = 0.0 if math.fabs(own) <= LAW_ZERO * r.rounding[k] else own


def find_start(m: Model, r: Laws) -> None:
    """Find the branches of the mode: 0 OFF or at rest, 1 ON or forward, -1 backward."""
    for k in range(m.ports):
        state = r.state[m.port_machine[k]]
        r.start[k] = 1 if is_on(m, k, state) else 0
        if m.port_two_sided[k] != 0 and m.port_planar[k] == 0 and state == 2:
            r.start[k] = -1


def passive_role(p: Ports, k: int) -> int:
    """Return how a port takes part that is OFF."""
    return CUT if p.given[k] == COMMON else SHUT


def is_stored(m: Model, r: Laws, k: int) -> bool:
    """Whether `w` of a port follows from what is stored, and no `l`."""
    n = m.ports
    for j in range(n):
        if r.response.d[k * n + j] != 0.0:
            return False
    return True


def is_left_by_others(m: Model, r: Laws, k: int) -> bool:
    """Whether `w` of a port follows from what is stored, as laws beside it may carry nothing.

    Of thyristors without a gate that feed one coil the last has all of its current.
    """
    n = m.ports
    for j in range(n):
        cut = m.port_two_sided[j] == 0 and r.able[j] == 0 and r.now.given[j] == COMMON
        if r.response.d[k * n + j] != 0.0 and not cut:
            return False
    return True
