"""The first instant of a step at which a guard holds, looked for block after block by samples.

A block whose samples do not show what a comparison does is halved.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.guards.bracket import bracket
from hybond.engine.guards.candidates import beside, between_roots, extrema, keep, sort
from hybond.engine.guards.guard_shape import find_shape, give_up_kinks, is_resolved, sample
from hybond.engine.guards.guard_values import holds_at
from hybond.engine.guards.locator import (
    BLOCKS,
    DEEPEST,
    FRACTION,
    MOST_BLOCKS,
    SAMPLES,
    SHALLOW,
    Locator,
    has_failed,
    is_sampled,
)
from hybond.engine.guards.turns import between_turns, mark_turns

NOTHING: Final = 1e-9
"""Part of what a comparison is elsewhere in a block that rounding may make zero."""


def look_in_blocks(e: Engine, g: Locator) -> int:
    """Look for the guards that are asked, into `g.at`; it may hold the instant of another."""
    blocks = 0
    g.low[0] = e.step.t0
    g.high[0] = e.step.t1
    g.depth[0] = 0
    left = 1
    while left > 0:
        left -= 1
        low = g.low[left]
        high = g.high[left]
        depth = g.depth[left]
        for k in range(SAMPLES):
            g.t[k] = low + (high - low) * FRACTION[k]
        g.t[SAMPLES - 1] = high
        sample(e, g)
        find_shape(g)
        if has_failed(g):
            return REFUSED
        blocks += 1
        resolved = is_resolved(e, g, depth) if blocks <= BLOCKS else give_up_kinks(e, g)
        deepest = DEEPEST if blocks <= MOST_BLOCKS else SHALLOW
        if depth < deepest and not resolved:
            middle = 0.5 * (low + high)
            g.low[left] = middle
            g.high[left] = high
            g.depth[left] = depth + 1
            g.low[left + 1] = low
            g.high[left + 1] = middle
            g.depth[left + 1] = depth + 1
            left += 2
            continue
        first_of_block(e, g)
        if has_failed(g):
            return REFUSED
        if g.at <= high:
            return OK
    return OK


def first_of_block(e: Engine, g: Locator) -> None:
    """Find the first instant of the block at which a guard holds: the likeliest first."""
    for k in range(g.asked_from, g.asked_until):
        g.done[k] = 0 if is_sampled(g, k) else 1
    while True:
        next_one = -1
        for k in range(g.asked_from, g.asked_until):
            if g.done[k] == 0 and (next_one < 0 or g.turn[k] < g.turn[next_one]):
                next_one = k
        if next_one < 0:
            return
        g.done[next_one] = 1
        quiet = g.calm[next_one] != 0
        for i in range(SAMPLES):
            quiet = quiet and g.truth[next_one * SAMPLES + i] == 0
        if not quiet:
            g.at = min(g.at, of_rule(e, g, next_one, g.at))
        if g.failed:
            return


def ends_at_zero(g: Locator, first: int, stop: int) -> bool:
    """Whether one of these comparisons is next to nothing where the block ends.

    Rounding may make it zero there, with which the guard holds; its sign does not tell.
    """
    for a in range(first, stop):
        at = a * SAMPLES
        most = 0.0
        for i in range(SAMPLES):
            most = max(most, math.fabs(g.shape[at + i]))
        if math.fabs(g.shape[at + SAMPLES - 1]) <= NOTHING * most:
            return True
    return False


def of_rule(e: Engine, g: Locator, k: int, before: float) -> float:
    """Return the first instant of the block at which guard k holds, infinity if none.

    `before` is one at which another guard does.
    """
    first = g.atom_first[k]
    stop = g.atom_first[k + 1]
    end = math.inf
    if before < math.inf and not holds_at(e, g, k, before):
        # unless it holds and ceases to before that, it becomes true later than another guard
        end = before
    c = g.candidate
    c.count = 0
    g.mark.count = 0
    for i in range(1, SAMPLES):
        if g.truth[k * SAMPLES + i] != 0:
            keep(c, g.t[i])
    if ends_at_zero(g, first, stop):
        keep(c, g.t[SAMPLES - 1])
    turned = mark_turns(e, g, k, end)
    for a in range(first, stop):
        begin = c.count
        extrema(e, g, a, end)
        for i in range(begin, c.count):
            if stop - first > 1:
                beside(e, g, a, c.at[i])
    if turned:
        between_turns(e, g, k, end)
    elif stop - first > 1:
        between_roots(e, g, first, stop, end)
    sort(c)
    for i in range(c.count):
        if g.failed:
            break
        # true there: it may have become so at any time after the candidate before
        at = c.at[i]
        low = g.t[0]
        for j in range(SAMPLES):
            if g.t[j] < at:
                low = max(low, g.t[j])
        for j in range(i):
            if c.at[j] < at:
                low = max(low, c.at[j])
        if at >= end or low >= before:
            break
        if at > e.step.t0 and holds_at(e, g, k, at):
            return bracket(e, g, k, low, at)
    return math.inf
