"""What dry friction may do at an instant: rest, slide on, or slide through a jump."""

from __future__ import annotations

import math

from hybond.engine.complementarity.law_roles import CUT, SHUT, TWO_SIDED
from hybond.engine.jumps.jump import JUMPS
from hybond.engine.laws.law_instant import NO_LAW_VALUE, is_stored, quantity
from hybond.engine.laws.law_records import Laws
from hybond.engine.mode.rows.tableau import COMMON, NET
from hybond.engine.model import Model


def may_rest(m: Model, k: int) -> bool:
    """Whether a port is friction that holds more at rest than in motion."""
    return m.port_breakaway[k] != NO_LAW_VALUE and m.port_planar[k] == 0


def rests_now(m: Model, r: Laws, k: int) -> bool:
    """Whether a friction junction is at rest: by what is stored, else by the branch before.

    What slid is at rest as well where the force that is stored now drives it back. What an impulse
    of this instant has torn loose goes on sliding if it can: nothing that is stored has stopped it.
    """
    if r.loose[k] != 0:
        return False
    way = slid(m, r, k)
    if is_stored(m, r, k):
        if r.now.given[k] == NET:
            return r.y[k] == 0.0
        return way == 0 or (r.y[k] > 0.0 if way > 0 else r.y[k] < 0.0)
    torn = r.struck and r.struck_moved == JUMPS and r.through[m.port_machine[k]] != 0
    return way == 0 and not torn


def slid(m: Model, r: Laws, k: int) -> int:
    """Return which way a friction junction slid before this instant; 0 at rest."""
    state = r.state[m.port_machine[k]]
    return -1 if state == 2 else state


def turns_round(m: Model, r: Laws, k: int) -> bool:
    """Whether friction that slid would slide the other way at once, and was not held yet."""
    if not may_rest(m, k) or is_stored(m, r, k) or r.loose[k] != 0 or r.halted[k] != 0:
        return False
    return slid(m, r, k) * r.problem.branch[k] < 0


def jumping_role(m: Model, r: Laws, k: int) -> int:
    """Return how friction that is no impulse takes part in a jump: its net variable has none.

    Where that changes nothing but rates, its junction slides through the jump. Else it holds, or
    slides with its limit, by an impulse of its common variable if it must. A limit of what other
    laws give is not known before they last: then it goes on as it did.
    """
    common = r.now.given[k] == COMMON
    if m.port_planar[k] != 0:
        return SHUT if common else CUT
    if limit_follows(m, r, k):
        return SHUT if common and r.state[m.port_machine[k]] != 0 else CUT
    n = m.ports
    slow = not common
    for j in range(n):
        slow = slow and r.response.d[j * n + k] == 0.0
    return CUT if slow else TWO_SIDED


def limit_follows(m: Model, r: Laws, k: int) -> bool:
    """Whether a limit of friction depends on what laws give."""
    n = m.ports
    for i in range(m.limit_first[2 * k], m.limit_first[2 * k + 2]):
        for j in range(n):
            if r.response.gain[m.limit_column[i] * n + j] != 0.0:
                return True
    return False


def past_limit(m: Model, r: Laws, k: int) -> float:
    """Return by how much what is stored alone asks more of friction than it can hold.

    Minus infinity where that is no matter of what is stored.
    """
    if m.port_planar[k] != 0 or r.now.given[k] == NET or not is_stored(m, r, k):
        return -math.inf
    if limit_follows(m, r, k):
        return -math.inf
    return math.fabs(r.y[k]) - most_held(m, r, k)


def past_with_others(m: Model, r: Laws, k: int) -> float:
    """Return by how much friction may be asked for more than it can hold, all laws together.

    What is stored asks for it, and what other laws may add to that; an impulse of its own would
    change it. Minus infinity where that is no matter of what is stored, or of that alone.
    """
    n = m.ports
    own = k * n + k
    if m.port_planar[k] != 0 or r.now.given[k] == NET or is_stored(m, r, k):
        return -math.inf
    if r.response.d[own] != 0.0 or not r.response.ce[own] > 0.0 or limit_follows(m, r, k):
        return -math.inf
    asked = math.fabs(r.y[k])
    for j in range(n):
        if r.response.d[k * n + j] != 0.0:
            asked += math.fabs(r.response.d[k * n + j]) * most_given(m, r, j)
    return asked - most_held(m, r, k)


def most_held(m: Model, r: Laws, k: int) -> float:
    """Return the most that friction holds: more at rest than in motion."""
    if may_rest(m, k) and rests_now(m, r, k):
        return quantity(m, m.port_breakaway, m.port_breakaway_constant, k, r.v)
    return quantity(m, m.port_limit, m.port_limit_constant, k, r.v)


def most_given(m: Model, r: Laws, j: int) -> float:
    """Return the most that law j gives: friction, of its net variable, what it holds."""
    known = m.port_two_sided[j] != 0 and m.port_planar[j] == 0 and r.now.given[j] == NET
    return most_held(m, r, j) if known and not limit_follows(m, r, j) else math.inf


def slides_through(m: Model, r: Laws, k: int) -> bool:
    """Whether a friction junction slides through the jump asked for, whatever else happens."""
    if m.port_impulsive[k] != 0 or r.role[k] == TWO_SIDED:
        return False
    return r.now.given[k] == NET or r.role[k] == SHUT
