"""Guards that begin to hold within one instant are settled together.

Complementary gates cross one threshold by expressions that round differently. Which of them is
first is no part of the model: the instant is the last of those that cannot be told apart, and there
all of them hold.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.methods.dopri import spacing
from hybond.engine.run.bracket import bracket
from hybond.engine.run.guard_values import holds_at, show
from hybond.engine.run.locator import ALL_PARTS, Locator

LEAST: Final = 8.0
"""Units in the last place that an instant lasts at least."""


def room_of_instant(e: Engine) -> float:
    """Return how long an instant lasts: `event_tol` of the run, eight last places at least."""
    now = math.fabs(e.t)
    return max(e.model.event_tol * max(e.until, now), LEAST * spacing(now))


def last_of_instant(e: Engine, g: Locator, t: float, top: float) -> float:
    """Return the last instant in ``[t, top]`` at which a guard begins to hold, `t` if none does.

    Guards that hold at `t` must still hold there: what is only touched at `t` is an instant alone.
    """
    last = t
    for k in range(g.guards):
        if not g.failed and not holds_at(e, g, k, t) and holds_at(e, g, k, top):
            last = max(last, bracket(e, g, k, t, top))
    for k in range(g.guards if last > t else 0):
        if holds_at(e, g, k, t) and not holds_at(e, g, k, last):
            last = t
    show(e, g, ALL_PARTS)
    return last
