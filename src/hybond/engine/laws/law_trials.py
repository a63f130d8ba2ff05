"""Branches of laws found by trying all of them, each a mode of its own.

What the graph answers to its laws is a linearisation. Where that has no values, as a resistor that
saturates has none for a current that no branch asks of it, few laws are tried branch by branch: a
mode stands if none of its laws is violated, neither by what lasts nor by the impulses on entering.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.laws.law_candidates import STANDS, STOPS, try_candidate
from hybond.engine.laws.law_instant import find_able, is_on, make_consistent
from hybond.engine.laws.law_records import AGAIN, Laws
from hybond.engine.laws.ports import open_mode
from hybond.engine.mode.nonlinear.newton import no_values
from hybond.engine.model import Model
from hybond.engine.words import Floats

MANY_BRANCHES: Final = 729
"""Branches of all laws together up to which all are tried."""
NOT_SO: Final = -1
"""Branches of which one is closed that may not be."""


def by_trial(e: Engine, r: Laws, x: Floats) -> int:
    """Try all branches from the state in r.here, first those of the mode, then those near it.

    Of several that stand it is one in which most laws do what they did: what a law that has come
    to its end does there is no reason for another to break loose. Before any law has struck they
    are entered with whatever impulses that takes. STANDS, or STOPS with the fault that there are
    no values at which the laws hold.
    """
    m = e.model
    many = tried_at_most(m)
    if many == 0:
        return STOPS
    if make_consistent(e, r, x) != OK or find_able(e, r) != OK:
        return STOPS
    r.asked = 0
    r.left = 0
    r.states = AGAIN
    r.shifted = False
    r.problem.doubtful = True
    r.leaps = r.jumping and not r.struck
    found = STOPS
    for ahead in range(2):
        r.looks_ahead = ahead == 0
        r.saw_ahead = False
        changed = 0
        while changed <= m.ports and found != STANDS:
            turn = 0
            while turn < many and found != STANDS:
                if nth_branches(m, r, turn) == changed:
                    found = try_candidate(e, r, x, False)
                turn += 1
            changed += 1
        if found == STANDS or not r.saw_ahead:
            break
    r.leaps = False
    if found == STANDS:
        return STANDS
    no_values(e, open_mode(e, r.now))
    e.fault.t = r.t
    return STOPS


def tried_at_most(m: Model) -> int:
    """Return how many branches all laws have together; 0 if they are too many, or ask for more.

    A gate, a gap or a limit may follow from what has no values yet, and so may a direction of slip.
    """
    many = 1
    for k in range(m.ports):
        if not knows(m, m.port_gate[k], m.port_gate_pair[k]):
            return 0
        if not knows(m, m.port_gap[k], m.port_gap_pair[k]):
            return 0
        if m.port_planar[k] != 0 or m.limit_first[2 * k] < m.limit_first[2 * k + 2]:
            return 0
        many *= 3 if m.port_two_sided[k] != 0 else 2
        if many > MANY_BRANCHES:
            return 0
    return many


def knows(m: Model, law: int, pair: int) -> bool:
    """Whether an option of a law has its value without any bond variable."""
    if law < 0:
        return True
    if pair < 0:
        return False
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        b = m.read_slot[i] - m.bond_slot
        if b >= 0 and b < 2 * m.bonds:
            return False
    return True


def nth_branches(m: Model, r: Laws, turn: int) -> int:
    """Put the branches of that number, counted from those of the mode, into `r.candidate`.

    How many laws do what they do not in the mode; NOT_SO if one is closed that may not be.
    """
    left = turn
    may = True
    changed = 0
    for k in range(m.machines):
        r.candidate[k] = r.state[k]
    for k in range(m.ports):
        machine = m.port_machine[k]
        ways = 3 if m.port_two_sided[k] != 0 else 2
        now = r.state[machine] if r.state[machine] < ways else 0
        way = left % ways
        changed += 1 if way > 0 else 0
        r.candidate[machine] = next_branch(now, way, ways)
        may = may and (r.able[k] != 0 or not is_on(m, k, r.candidate[machine]))
        left //= ways
    return changed if may else NOT_SO


def next_branch(now: int, way: int, ways: int) -> int:
    """Return the branch of a law that is `way` beyond `now`: friction comes to rest, then turns."""
    if ways == 3 and now > 0 and way > 0:
        return 0 if way == 1 else 3 - now
    return (now + way) % ways
