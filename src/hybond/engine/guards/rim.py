"""The rim of a guard: up to where its comparison counts as rounding, beside the root of that.

It may be a million times as wide as last places of the time. Asking by doubles and halves takes
fifty questions then; what is compared tells where it is, and two or three confirm it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import (
    atom_at,
    holds_at,
    level_in_motion,
    terms_here,
)
from hybond.engine.guards.locator import Locator
from hybond.engine.methods.explicit.dopri import spacing

STEPS: Final = 4
"""Steps towards the rim, at the most."""
WIDER: Final = 8.0
"""How many times as wide each look beyond it is as the one before."""


def forget_asked(g: Locator) -> None:
    """Let nothing be known of where a guard holds."""
    g.not_yet = -math.inf
    g.already = math.inf


def asked_at(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Ask a guard that begins to hold once, where that is not known.

    It does not before an instant at which it does not, and does behind one at which it does.
    """
    if t <= g.not_yet:
        return False
    if t >= g.already:
        return True
    held = holds_at(e, g, k, t)
    if held:
        g.already = t
    else:
        g.not_yet = t
    return held


def find_rim(e: Engine, g: Locator, k: int, a: int, rate: float, t: float) -> None:
    """Narrow down where guard k begins to hold, by its comparison a, which moves at about `rate`.

    What is found is what `asked_at` knows. The guard has been asked at `t`, beside the root.
    """
    low = max(g.bracket_low, g.not_yet)
    high = min(g.bracket_high, g.already)
    if not math.isfinite(rate) or rate == 0.0:
        return
    # the rim before the root has the side that it comes from
    side = -1.0 if g.already < math.inf else 1.0
    side = side if rate > 0.0 else -side
    at = t
    before = t
    value_before = 0.0
    for i in range(STEPS):
        here = atom_at(e, g, a, at)
        limit = ROUNDING * terms_here(e, g, k, a)
        limit = max(limit, math.fabs(level_in_motion(e, g, k)))
        if i > 0 and at != before:
            slope = (here - value_before) / (at - before)
            if slope * rate > 0.0:
                rate = slope
        before = at
        value_before = here
        at = at + (side * limit - here) / rate
        wide = 4.0 * spacing(at)
        if not (at > low and at < high):
            return
        if math.fabs(at - before) <= wide:
            break
    look_beyond(e, g, k, at)


def look_beyond(e: Engine, g: Locator, k: int, t: float) -> None:
    """Ask guard k at `t`, and on both sides of it, until it is known to begin between two."""
    reach = 8.0 * spacing(t)
    at = t
    if asked_at(e, g, k, t):
        while at > g.bracket_low and not g.failed and asked_at(e, g, k, at):
            at = t - reach
            reach = WIDER * reach
        return
    while at < g.bracket_high and not g.failed and not asked_at(e, g, k, at):
        at = t + reach
        reach = WIDER * reach
