"""Samples of guards in a block of a step, and what they show."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.guard_values import (
    atom_here,
    look,
    look_at_sample,
    show,
    size_here,
    terms_here,
    test_here,
)
from hybond.engine.guards.locator import (
    FRACTION,
    GRID,
    NO_KINK,
    SAMPLES,
    TERMS,
    Locator,
    is_sampled,
)
from hybond.engine.guards.naps import is_asleep, let_sleep
from hybond.engine.guards.noise import is_noise
from hybond.engine.words import Floats

UNRESOLVED: Final = 0.02
"""A block whose samples leave more than this part of their spread unexplained is halved."""
ROUNDED: Final = 1e-9
"""... unless that is less than this part of the largest sample."""
NEAR: Final = 0.05
"""An extremum is searched if the polynomial comes this near to zero, as a part of the spread."""
SLACK: Final = 1e-12
"""Part of samples that rounding may add to the polynomial through them."""
ROUNDING: Final = 1e-13
"""Part of the terms of a comparison that rounding leaves unexplained."""
ASKED_EVERY: Final = 3
"""Of the depths of blocks, the first included, one in so many at which noise is looked for: what
halving shows does not pay for it each time."""


def sample(e: Engine, g: Locator) -> None:
    """Sample all guards of the block."""
    g.sampled = True
    for i in range(SAMPLES):
        look_at_sample(e, g, g.t[i])
        for k in range(g.asked_from, g.asked_until):
            if not is_sampled(g, k):
                continue
            asleep = is_asleep(g, k)
            g.truth[k * SAMPLES + i] = 1 if not asleep and test_here(e, g, k) else 0
            for a in range(g.atom_first[k], g.atom_first[k + 1]):
                g.shape[a * SAMPLES + i] = 0.0 if asleep else atom_here(e, g, a)
            for a in range(g.turn_first[k], g.turn_first[k + 1]):
                g.shape[a * SAMPLES + i] = 0.0 if asleep else atom_here(e, g, a)


def find_shape(g: Locator) -> None:
    """Say what the samples of all comparisons look like. After _Shape.of."""
    for k in range(g.asked_from, g.asked_until):
        g.calm[k] = 1
        g.turn[k] = math.inf
        sampled = is_sampled(g, k)
        for a in range(g.atom_first[k], g.atom_first[k + 1] if sampled else 0):
            if not stays(g, a):
                g.calm[k] = 0
            g.turn[k] = min(g.turn[k], first_turn(g, a))
        for a in range(g.turn_first[k], g.turn_first[k + 1] if sampled else 0):
            if g.calm[k] != 0 and not stays(g, a):
                g.calm[k] = 0


def stays(g: Locator, a: int) -> bool:
    """Whether a comparison stays away from zero; note whether its samples show what it does."""
    at = a * SAMPLES
    least = g.shape[at]
    most = g.shape[at]
    size = 0.0
    finite = True
    for i in range(SAMPLES):
        finite = finite and math.isfinite(g.shape[at + i])
        least = min(least, g.shape[at + i])
        most = max(most, g.shape[at + i])
        size = max(size, math.fabs(g.shape[at + i]))
    spread = most - least
    up = 1.0 if g.shape[at] > 0.0 else -1.0 if g.shape[at] < 0.0 else 0.0
    rest = rest_below(g, g.shape, at, size)
    if finite and rest <= UNRESOLVED * spread:
        if floor_of(g, least, most, up) > NEAR * spread + 3.0 * rest:
            g.doubtful[a] = 0
            return True
    rest = rest_of(g, a)
    g.rest[a] = rest
    shown = rest <= UNRESOLVED * spread or rest <= ROUNDED * size or not finite
    g.doubtful[a] = 0 if shown else 1
    if size == 0.0:
        return True
    low = least if up > 0.0 else -most if up < 0.0 else 0.0
    bound = NEAR * spread + 3.0 * rest
    if not low > bound:
        return False
    if floor_of(g, least, most, up) > bound:
        return True
    for i in range(GRID):
        total = 0.0
        for j in range(SAMPLES):
            total += g.fine[i * SAMPLES + j] * g.shape[at + j]
        if not up * total > bound:
            return False
    return True


def rest_of(g: Locator, a: int) -> float:
    """Return what a polynomial leaves of the samples of a comparison."""
    rest = 0.0
    for i in range(SAMPLES):
        total = 0.0
        for j in range(SAMPLES):
            total += g.left_over[i * SAMPLES + j] * g.shape[a * SAMPLES + j]
        rest = max(rest, math.fabs(total))
    return rest


def rest_below(g: Locator, samples: Floats, at: int, size: float) -> float:
    """Return what it leaves no more than: the length of that, of samples of such a size."""
    total = 0.0
    for j in range(SAMPLES - TERMS):
        part = 0.0
        for i in range(SAMPLES):
            part += g.beyond[j * SAMPLES + i] * samples[at + i]
        total += part * part
    return math.sqrt(total) + SLACK * size


def floor_of(g: Locator, least: float, most: float, sign: float) -> float:
    """Return what ``sign * polynomial`` is nowhere below, of the least and the largest sample."""
    middle = 0.5 * (least + most)
    away = g.swing * 0.5 * (most - least) + SLACK * math.fabs(middle)
    return sign * middle - away


def first_turn(g: Locator, a: int) -> float:
    """Return where samples that begin positive first become negative, or the other way round."""
    at = a * SAMPLES
    up = 1.0 if g.shape[at] > 0.0 else -1.0 if g.shape[at] < 0.0 else 0.0
    for i in range(1, SAMPLES):
        if up * g.shape[at + i] < 0.0:
            before = up * g.shape[at + i - 1]
            share = before / (before - up * g.shape[at + i])
            return FRACTION[i - 1] + share * (FRACTION[i] - FRACTION[i - 1])
    return math.inf


def is_resolved(e: Engine, g: Locator, depth: int) -> bool:
    """Whether the samples show all that the guards do, rounding left out."""
    for k in range(g.asked_from, g.asked_until):
        for a in range(g.atom_first[k], g.atom_first[k + 1] if is_sampled(g, k) else 0):
            if g.doubtful[a] == 0 or is_rounding(e, g, k, a):
                continue
            if depth % ASKED_EVERY != 1 or not is_noise(e, g, k, a):
                return False
    return True


def give_up_kinks(e: Engine, g: Locator) -> bool:
    """Let kinks sleep that samples do not show; whether guards show all that they do.

    Rounding may change the sign of what is compared anywhere in a step, as where laws leave it open
    which of them flows. Nothing jumps there by more than the error of the step sees.
    """
    shown = True
    for k in range(g.asked_from, g.asked_until):
        resolved = True
        for a in range(g.atom_first[k], g.atom_first[k + 1] if is_sampled(g, k) else 0):
            resolved = resolved and (g.doubtful[a] == 0 or is_rounding(e, g, k, a))
        if resolved:
            continue
        if g.side[k] == NO_KINK:
            shown = False
            continue
        if turns_within(g, k):
            continue  # that is known of it, whatever samples show
        let_sleep(g, k)
        g.calm[k] = 1
        g.turn[k] = math.inf
        for i in range(SAMPLES):
            g.truth[k * SAMPLES + i] = 0
    return shown


def turns_within(g: Locator, k: int) -> bool:
    """Whether something of which it is known that a guard turns there is zero in the block."""
    for a in range(g.turn_first[k], g.turn_first[k + 1]):
        if first_turn(g, a) < math.inf:
            return True
    return False


def is_rounding(e: Engine, g: Locator, k: int, a: int) -> bool:
    """Whether what a polynomial leaves of the samples of a comparison is rounding of its terms."""
    if g.margin[k] >= 0:
        size = size_here(e, g, a)
        return size * ROUNDING >= g.rest[a]
    largest = 0.0
    for i in range(SAMPLES):
        look(e, g, g.t[i])
        show(e, g, g.part[k])
        largest = max(largest, terms_here(e, g, k, a))
    return largest * ROUNDING >= g.rest[a]
