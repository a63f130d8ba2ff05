"""What is known of guards whose thresholds are where the motion comes to rest, and room for it."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record

SWINGS: Final = 2
"""Times that what comes to rest has changed its side if it swings: an overshoot is one."""


@record
class Rests:
    """Of each rule: whether its guard holds in the last step by rounding alone."""

    any: bool
    rule: Ints
    since: Ints
    """... whether it did since something jumped, ..."""
    said: Ints
    """... and whether the run has warned of it."""
    atom: Ints
    """Of each comparison: whether it is one that comes to rest on zero, ..."""
    band: Floats
    """... and how far from it rounding and the error of the run may put it."""
    some: bool
    """Whether a comparison rests, or creeps."""
    follows: Ints
    """Of each rule: whether it is known what its comparisons were, ..."""
    side: Ints
    """... and of each of these the sign that it had when it was clear of zero last, 0 if it never
    was since something jumped, ..."""
    turns: Ints
    """... how often it has changed, ..."""
    away: Ints
    """... whether it has moved since it was seen to rest, ..."""
    before: Floats
    here: Floats
    extent: Floats
    crosses: Ints
    """... what it is where the step begins and where it ends, the size of its terms, and whether
    its sign is another one there."""
    last: Floats
    older: Floats
    """Of each: what it was where time went on after the last instants, while it was clear."""
    creeps: Ints
    """Whether the next one, in the same proportion to the last, would be within its digits."""
    seen_at: float
    signals: Floats
    """What a guard reads, while it is asked with other values."""
    kept: Floats
    """Of each rule that rests, and each state: where that rests, not a number if it does not, and
    how far aside comparisons are clear of zero, and so on the other side where none is known."""
    aside: Floats
    across: Floats
    crossed: Floats
    """Of each expression: what it was where a guard that compares it with zero found it past that,
    0 if none did; when that was, and whether it ever was."""
    crossed_at: Floats
    some_crossed: bool
    by_hand: Ints
    """Of each rule: whether it is one of a machine that stands for no law, and compares once; up to
    where that counts as zero, as the state it leaves was entered with what had not moved since."""
    within: Floats
    of_law: Ints
    """Of each rule: whether it is one of a law, and compares once; it counts as zero up to where
    the law stood when it was asked last, if any did since something changed."""
    some_stand: bool
    waits_until: Floats
    stands_on: Floats
    some_wait: bool
    """Of each rule: up to when it waits at most, as what it compares was at its threshold and
    leaves it on the other side; of each comparison: where it was; whether any rule waits."""
    began: Floats
    """Each state as the last jump has left it, or the start; and when the motion began."""
    begun: bool
    taken: bool
    """Whether that is known of a run from which this one goes on."""
    began_at: float
    y: Floats
    """The state that is asked, ..."""
    rest: Floats
    """... with what comes to rest where it does so, ..."""
    beyond: Floats
    """... and a little farther, where something slow may go on from there, ..."""
    shifted: Floats
    rate: Floats
    other: Floats
    tell: Floats
    """... and how far from there it cannot be told from it."""
    jacobian: Floats
    """The slopes of the rates, and those of each comparison of the guard."""
    slope: Floats
    level: Floats
    inside: Ints
    """Whether a state has a part in a comparison, and the places of those that have."""
    place: Ints
    kind: Ints
    """How each comparison of the guard comes to rest, if it does."""
    driver: Ints
    """Of each: the state that it is shifted by; what the terms of each add up to at most, and how
    far from its limit the run cannot tell it from that."""
    size: Floats
    near: Floats
    limit: Floats
    matrix: Floats
    inverse: Floats
    largest: Floats
    flow: Floats
    """What a linear motion leaves after some time, that after twice as long, and of a state."""
    twice: Floats
    power: Floats
    left: Floats
    kept_inverse: Floats
    kept_flow: Floats
    fast: float
    room: int


def make_rests(m: Model) -> Rests:
    """Return knowledge of nothing."""
    q = Rests()
    n = m.storages + m.integrals
    rules = m.rule_first[m.machines]
    q.rule = ints(rules)
    q.since = ints(rules)
    q.said = ints(rules)
    q.atom = ints(m.atom_first[rules])
    q.band = floats(m.atom_first[rules])
    atoms = m.atom_first[rules]
    q.follows = ints(rules)
    q.side = ints(atoms)
    q.turns = ints(atoms)
    q.away = ints(atoms)
    q.before = floats(atoms)
    q.here = floats(atoms)
    q.extent = floats(atoms)
    q.last = floats(atoms)
    q.older = floats(atoms)
    q.creeps = ints(atoms)
    q.crosses = ints(atoms)
    q.seen_at = -math.inf
    most = 0
    for r in range(rules):
        most = max(most, m.read_first[r + 1] - m.read_first[r])
    q.signals = floats(2 * most)
    values = 0
    for a in range(m.atom_first[rules]):
        values = max(values, m.atom_value[a] + 1)
    q.crossed = floats(values)
    q.crossed_at = floats(values)
    q.within = floats(rules)
    q.waits_until = floats(rules)
    for r in range(rules):
        q.waits_until[r] = -math.inf
    q.stands_on = floats(atoms)
    q.by_hand = ints(rules)
    q.of_law = ints(rules)
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            once = m.atom_first[r + 1] - m.atom_first[r] == 1
            q.by_hand[r] = 1 if once and m.is_law[k] == 0 else 0
            q.of_law[r] = 1 if once and m.is_law[k] != 0 else 0
    q.began = floats(n)
    q.began_at = -math.inf
    put_followed(q, m)
    return q


def put_followed(q: Rests, m: Model) -> None:
    """Put there which rules are followed: of machines written by hand.

    A single comparison that holds is seen where it begins to, unless time or samples decide.
    """
    for k in range(m.machines):
        if m.is_law[k] != 0 or m.leads_on[k] != 0:
            continue
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            several = m.atom_first[r + 1] - m.atom_first[r] > 1 or m.samples > 0
            for p in range(m.read_first[r], m.read_first[r + 1]):
                several = several or m.read_slot[p] >= m.at_slot
            q.follows[r] = 1 if several and m.rule_watched[r] != 0 else 0


def make_room(q: Rests, n: int, rules: int, atoms: int) -> None:
    """Make room to look at a guard of so many comparisons."""
    if q.room == 0:
        q.y = floats(n)
        q.rest = floats(n)
        q.shifted = floats(n)
        q.beyond = floats(n)
        q.rate = floats(n)
        q.other = floats(n)
        q.tell = floats(n)
        q.jacobian = floats(n * n)
        q.inside = ints(n)
        q.place = ints(n)
        q.matrix = floats(n * n)
        q.inverse = floats(n * n)
        q.largest = floats(n)
        q.flow = floats(n * n)
        q.twice = floats(n * n)
        q.power = floats(n * n)
        q.left = floats(n)
        q.kept = floats(rules * n)
        q.aside = floats(rules * n)
        q.across = floats(rules * n)
        q.kept_inverse = floats(n * n)
        q.kept_flow = floats(n * n)
    if atoms > q.room:
        q.slope = floats(atoms * n)
        q.level = floats(atoms)
        q.kind = ints(atoms)
        q.driver = ints(atoms)
        q.size = floats(atoms)
        q.near = floats(atoms)
        q.limit = floats(atoms)
        q.room = atoms


def side_of(q: Rests, a: int) -> int:
    """Return the side on which a comparison is kept, 0 if it has none.

    What swings, or has been elsewhere, has none of its own.
    """
    return q.side[a] if q.turns[a] < SWINGS and q.away[a] == 0 else 0
