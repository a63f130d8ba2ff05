"""Kinks that a step comes nowhere near: they are not sampled.

What is compared may be a sum of the state, as where a table of a storage bends: a polynomial of the
step, which is clear of zero all over it. Of anything else, where the step begins, in its middle and
where it ends tell enough if what is compared is farther from zero in all three than they are from
each other: what a step follows to within its error does not turn so sharply in between. A kink that
it does pass there and back is no event; the error of the step sees what that does.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.far_guards import is_far
from hybond.engine.guards.guard_values import atom_here, look_at_sample
from hybond.engine.guards.locator import FRACTION, NO_KINK, SAMPLES, Locator
from hybond.engine.guards.naps import is_asleep

MIDDLE: Final = 4
"""The sample in the middle of a step."""


def stays_afar(e: Engine, g: Locator, k: int) -> bool:
    """Whether the kink of guard k is a sum of the state that keeps its sign all over the step."""
    if g.side[k] == 0 or e.slide.k > 0:
        return False
    return is_far(e, g, k) and g.sign[g.atom_first[k]] == g.side[k]


def stay_on_sides(e: Engine, g: Locator) -> bool:
    """Whether all that is left to be sampled are kinks that stay far away on their sides.

    Of several, those that do are not sampled: what is compared there may bend where another is
    passed, and no samples would show it.
    """
    if e.slide.k > 0:
        return False
    for k in range(g.guards):
        g.done[k] = 0
        if g.solved[k] == 0 and (g.side[k] == NO_KINK or g.side[k] == 0):
            return False
    some = True
    for turn in range(2):
        row = MIDDLE if turn == 0 else SAMPLES - 1
        t = e.step.t0 + (e.step.t1 - e.step.t0) * FRACTION[row]
        if some:
            look_at_sample(e, g, t if turn == 0 else e.step.t1)
        if g.failed:
            return False
        some = False
        for k in range(g.guards):
            if g.solved[k] == 0 and g.done[k] == 0 and not is_asleep(g, k):
                a = g.atom_first[k]
                g.shape[a * SAMPLES + row] = atom_here(e, g, a)
                g.done[k] = 0 if is_clear(g, k, turn) else 1
            some = some or (g.solved[k] == 0 and g.done[k] == 0)
    for k in range(g.guards):
        g.solved[k] = 1 if g.done[k] == 0 else g.solved[k]
    for k in range(g.guards):
        if g.solved[k] == 0:
            return False
    return True


def is_clear(g: Locator, k: int, turn: int) -> bool:
    """Whether what is compared stays on its side by more than it moves, in the samples so far."""
    at = g.atom_first[k] * SAMPLES
    side = float(g.side[k])
    begin = side * g.shape[at]
    middle = side * g.shape[at + MIDDLE]
    end = side * g.shape[at + SAMPLES - 1] if turn > 0 else middle
    least = min(min(begin, middle), end)
    most = max(max(begin, middle), end)
    return math.isfinite(most) and least > most - least
