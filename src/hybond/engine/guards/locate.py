"""Locating guards inside a step, on its dense output.

A guard is a level: none that leaves the current state is true when a step begins. Where
its comparisons are polynomials of the step, it is solved (`solved_guards`). Of others the
comparisons are sampled; where one changes sign, or has an extremum on its way to zero, the
guard itself is asked, so that an even number of crossings or a touch is not lost. The instant found
is the first at which the guard holds, on the comparison that made it true (Illinois method),
confirmed by the test that settling applies.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.at_rest import see_rests
from hybond.engine.guards.blurred import forget_blurred, let_blurred_pass
from hybond.engine.guards.bracket import bracket
from hybond.engine.guards.candidates import beside, between_roots, extrema, keep, sort
from hybond.engine.guards.guard_shape import find_shape, give_up_kinks, is_resolved, sample
from hybond.engine.guards.guard_values import (
    atom_at,
    holds_at,
    look,
    show,
    terms_here,
    waits_still,
)
from hybond.engine.guards.kept_rests import forget_rests
from hybond.engine.guards.kinks_on_surfaces import lies_on_surfaces
from hybond.engine.guards.locator import (
    ALL_PARTS,
    BLOCKS,
    DEEPEST,
    FRACTION,
    MOST_BLOCKS,
    NO_KINK,
    SAMPLES,
    SHALLOW,
    Locator,
    begin_looks,
    has_failed,
)
from hybond.engine.guards.moved_off import moves_off
from hybond.engine.guards.rests_asked import see_rests_beside
from hybond.engine.guards.sides_seen import note_sides
from hybond.engine.guards.solved_guards import solve_guards
from hybond.engine.guards.turns import between_turns, mark_turns
from hybond.engine.guards.unresolved import see_borne, see_held_back
from hybond.engine.guards.waiting import may_wait, wake

SOON: Final = 1e-3
"""Part of a step after which what begins at a kink is on one of its sides."""


def locate(e: Engine, g: Locator) -> int:
    """Find the first instant of the last step at which a guard holds, or infinity, into `g.at`."""
    forget_rests(e)
    forget_blurred(e, g)
    status = search(e, g)
    while status == OK and g.at < math.inf and let_blurred_pass(e, g):
        status = search(e, g)
    if status == OK:
        if note_sides(e, g):
            status = search(e, g)
        if status == OK and see_rests_beside(e, g):
            status = search(e, g)
    while status == OK and g.at < math.inf and see_rests(e, g):
        status = search(e, g)
    if status == OK:
        see_held_back(e, g)
        see_borne(e, g)
        see_waits(e, g)
    show(e, g, ALL_PARTS)
    g.sampled = False
    return status


def see_waits(e: Engine, g: Locator) -> None:
    """Let rules be asked again whose comparisons are elsewhere at the end of the step."""
    for k in range(g.guards if e.rests.some_wait and g.at == math.inf else 0):
        if g.rule[k] >= 0 and may_wait(e, g.rule[k], e.step.t1):
            look(e, g, e.step.t1)
            if not waits_still(e, g, k, e.step.t1):
                wake(e, g.rule[k])


def search(e: Engine, g: Locator) -> int:
    """Look for it, block after block."""
    g.at = math.inf
    g.failed = False
    g.about = False
    g.found_at = math.nan
    g.shown_to = math.nan
    begin_looks(e.model, g)
    if g.guards == 0:
        return OK
    if e.model.kinks + e.model.slide_kinks > 0:
        take_sides_of_kinks(e, g)
    left = 1 if solve_guards(e, g) else 0
    if has_failed(g):
        return REFUSED
    blocks = 0
    g.low[0] = e.step.t0
    g.high[0] = e.step.t1
    g.depth[0] = 0
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


def take_sides_of_kinks(e: Engine, g: Locator) -> None:
    """Note on which side of each kink the step begins; of one the motion begins at, where to.

    All are looked at in one instant before any is in the next: there the motion is solved for.
    """
    begins = False
    for k in range(g.guards):
        g.done[k] = 0
        if g.side[k] == NO_KINK:
            continue
        a = g.atom_first[k]
        here = atom_at(e, g, a, e.step.t0)
        if e.slide.k > 0 and lies_on_surfaces(e, g, k):
            g.side[k] = 0
            g.sleep[k] = max(g.sleep[k], 1)
            continue
        if math.isfinite(here) and math.fabs(here) <= ROUNDING * terms_here(e, g, k, a):
            if g.side[k] == 0:
                g.done[k] = 1
                begins = True
            continue  # not passed yet
        g.side[k] = side_of(here)
    if begins:
        take_sides_soon(e, g)


def take_sides_soon(e: Engine, g: Locator) -> None:
    """Note where the motion goes to from the kinks that it begins at, those in `g.done`."""
    soon = SOON * (e.step.t1 - e.step.t0)
    for k in range(g.guards):
        if g.done[k] != 0:
            a = g.atom_first[k]
            here = atom_at(e, g, a, e.step.t0 + soon)
            g.side[k] = side_of(here)
            if math.fabs(here) <= ROUNDING * terms_here(e, g, k, a):
                g.side[k] = 0
    for k in range(g.guards):
        if g.done[k] != 0 and g.side[k] != 0 and not moves_off(e, g, k, soon):
            g.side[k] = 0


def side_of(here: float) -> int:
    """Return on which side of a kink this is."""
    return 1 if here > 0.0 else -1 if here < 0.0 else 0


def first_of_block(e: Engine, g: Locator) -> None:
    """Find the first instant of the block at which a guard holds: the likeliest first."""
    for k in range(g.guards):
        g.done[k] = g.solved[k]
    while True:
        next_one = -1
        for k in range(g.guards):
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
