"""What is known from step to step, and from instant to instant, of guards that hold by rounding."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.guard_values import holds_at, keeps
from hybond.engine.guards.limits_crossed import note_limits
from hybond.engine.guards.locator import Locator

SAME: Final = 1e-6
"""Part of a state that it jumps by at least."""


def begin_rests(e: Engine) -> None:
    """Note where a motion begins: each state as it was when something made it jump last."""
    q = e.rests
    if q.taken:
        # a run that goes on from another: nothing has jumped
        q.taken = False
        return
    jumped = False
    for k in range(e.states):
        size = max(math.fabs(e.y[k]), e.largest_state[k])
        if not q.begun or math.fabs(e.y[k] - e.step.y1[k]) > SAME * size:
            q.began[k] = e.y[k]
            jumped = jumped or not is_sampled(e, k)
    rules = e.model.rule_first[e.model.machines]
    for r in range(rules if jumped else 0):
        q.since[r] = 0
    for a in range(e.model.atom_first[rules] if jumped else 0):
        q.atom[a] = 0
        q.side[a] = 0
        q.turns[a] = 0
        q.away[a] = 0
        q.creeps[a] = 0
        q.last[a] = 0.0
    q.begun = True
    q.began_at = e.t


def is_sampled(e: Engine, k: int) -> bool:
    """Whether a state is a signal that is sampled: beside what rests it jumps again and again."""
    m = e.model
    for s in range(m.samples):
        if m.sample_signal[s] == k - m.storages:
            return True
    return False


def forget_rests(e: Engine) -> None:
    """Know of no guard that it holds by rounding: another step is looked at."""
    q = e.rests
    m = e.model
    if not q.any:
        return
    q.any = False
    for r in range(m.rule_first[m.machines]):
        q.rule[r] = 0


def let_hold(e: Engine, g: Locator, t: float) -> None:
    """Let guards hold at an instant that do so whatever rounding says of what rests.

    What they compare has come to its limit there.
    """
    q = e.rests
    note_limits(e, g, t)
    for k in range(g.guards):
        rule = g.rule[k]
        if rule >= 0 and q.since[rule] != 0 and holds_at(e, g, k, t):
            q.rule[rule] = 0
            q.since[rule] = 0
            if not keeps(e, g, k):
                for a in range(e.model.atom_first[rule], e.model.atom_first[rule + 1]):
                    q.atom[a] = 0


def none_holds(e: Engine, g: Locator, t: float) -> bool:
    """Whether what was found to hold at an instant does so by rounding alone."""
    for k in range(g.guards if e.rests.any else 0):
        if holds_at(e, g, k, t):
            return False
    return e.rests.any
