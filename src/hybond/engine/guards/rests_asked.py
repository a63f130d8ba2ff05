"""What rests on a threshold where something else asks for it: time, a sample, or a crossing beside.

Such a comparison is kept on the side on which it was clear last, see `sides_seen`.
"""

from __future__ import annotations

import math

from hybond.engine.engine import Engine
from hybond.engine.guards.at_rest import (
    MOST,
    ZERO,
    find_slopes,
    how_it_rests,
    is_slow,
    keep_side,
)
from hybond.engine.guards.guard_values import look_at_state
from hybond.engine.guards.locator import NO_KINK, Locator
from hybond.engine.guards.rest_records import make_room
from hybond.engine.guards.sides_seen import is_near
from hybond.engine.methods.stepping import between
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess


def see_rests_at_end(e: Engine, g: Locator) -> None:
    """See which comparisons have come to rest on zero by a timed event, whose instant asks them."""
    m = e.model
    q = e.rests
    if e.slide.k > 0 or m.disks > 0 or e.states > MOST or g.failed:
        return
    for k in range(g.guards):
        rule = g.rule[k]
        if rule < 0 or q.follows[rule] == 0 or g.part[k] >= 0 or g.side[k] != NO_KINK:
            continue
        near = False
        for a in range(m.atom_first[rule], m.atom_first[rule + 1]):
            near = near or (q.atom[a] == 0 and is_near(e, a))
        if near:
            look_for_rests(e, g, k)


def see_rests_beside(e: Engine, g: Locator) -> bool:
    """Whether a comparison has come to rest on zero beside one that crosses in the step."""
    m = e.model
    q = e.rests
    if e.slide.k > 0 or m.disks > 0 or e.states > MOST:
        return False
    found = False
    for k in range(g.guards):
        rule = g.rule[k]
        if rule < 0 or q.follows[rule] == 0 or g.part[k] >= 0 or g.side[k] != NO_KINK:
            continue
        near = False
        crosses = False
        for a in range(m.atom_first[rule], m.atom_first[rule + 1]):
            near = near or (q.atom[a] == 0 and is_near(e, a))
            crosses = crosses or q.crosses[a] != 0
        found = (near and crosses and look_for_rests(e, g, k)) or found
    return found


def look_for_rests(e: Engine, g: Locator, k: int) -> bool:
    """Whether comparisons of a guard rest on zero where the step ends that were not known to."""
    refused = e.refusal
    evaluations = e.evaluations
    hold_guess(e, e.mode)
    found = find_rests(e, g, k)
    give_back_guess(e, e.mode)
    g.failed = False
    e.refusal = refused
    e.evaluations = evaluations
    g.looked = math.nan
    return found


def find_rests(e: Engine, g: Locator, k: int) -> bool:
    """Keep the comparisons of a guard that rest on zero there; whether there are any."""
    q = e.rests
    n = e.states
    t = e.step.t1
    many = g.atom_first[k + 1] - g.atom_first[k]
    make_room(q, n, e.model.rule_first[e.model.machines], many)
    between(e, t, q.y)
    look_at_state(e, g, t, q.y)
    if not is_slow(e, g, k, t) or not find_slopes(e, g, k, t):
        return False
    found = False
    for a in range(many):
        if q.atom[g.atom[g.atom_first[k] + a]] == 0:
            q.kind[a] = how_it_rests(e, g, k, a, t)
            if q.kind[a] == ZERO:
                keep_side(e, g, k, a)
                found = True
    return found
