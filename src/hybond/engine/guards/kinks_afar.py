"""Kinks that a step comes nowhere near: they are not sampled.

What is compared may be a sum of the state, as where a table of a storage bends: a polynomial of the
step, which is clear of zero all over it. Of what does not turn again and again as signals move,
three looks tell enough, where the step begins, in its middle and where it ends, if what is compared
is farther from zero in all of them than they are from each other: what a step follows to within its
error does not turn so sharply in between. A kink that it does pass there and back is no event; the
error of the step sees what that does.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.bracket import bracket
from hybond.engine.guards.far_guards import is_far
from hybond.engine.guards.guard_values import atom_here, look_at_sample, test_here
from hybond.engine.guards.locator import FRACTION, NO_KINK, NONE, SAMPLES, Locator
from hybond.engine.guards.naps import is_asleep
from hybond.engine.model import Model

STRAIGHT: Final = 0.25
"""Part of its way in a step by which what is compared may be off a straight one in the middle."""
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
    for k in range(g.guards):
        g.done[k] = 0
    if e.slide.k > 0:
        return False
    for k in range(g.guards):
        if g.solved[k] == 0 and not is_told(e.model, g, k):
            return False
    for turn in range(2):
        row = MIDDLE if turn == 0 else SAMPLES - 1
        t = e.step.t0 + (e.step.t1 - e.step.t0) * FRACTION[row]
        look_at_sample(e, g, t if turn == 0 else e.step.t1)
        if g.failed:
            return False
        for k in range(g.guards):
            if g.solved[k] == 0 and not is_asleep(g, k):
                a = g.atom_first[k]
                g.shape[a * SAMPLES + row] = atom_here(e, g, a)
                g.done[k] = 1 if g.done[k] != 0 or not is_clear(g, k, turn) else 0
    left = False
    for k in range(g.guards):
        g.solved[k] = 1 if g.done[k] == 0 else g.solved[k]
        left = left or g.solved[k] == 0
    return not left


def is_told(m: Model, g: Locator, k: int) -> bool:
    """Whether guard k is a kink of which three looks may tell.

    What turns again and again, as the sine that says where ``floor`` has its steps, may look alike
    in all of them, and have passed zero many times.
    """
    if g.side[k] == NO_KINK or g.side[k] == 0:
        return False
    return m.kink_plain[g.atom[g.atom_first[k]] - m.kink_atom] != 0


def only_passed(e: Engine, g: Locator) -> int:
    """Return the only guard that is left to be sampled if it is a kink plainly passed; or NONE.

    After `stay_on_sides`: what is compared there runs through zero nearly straight.
    """
    only = NONE
    for k in range(g.guards):
        if g.solved[k] == 0:
            if only != NONE or g.done[k] == 0 or is_asleep(g, k):
                return NONE
            only = k
    if e.slide.k > 0 or only == NONE or g.failed or g.looked != e.step.t1:
        return NONE
    at = g.atom_first[only] * SAMPLES
    side = float(g.side[only])
    begin = side * g.shape[at]
    end = side * atom_here(e, g, g.atom_first[only])
    bent = side * g.shape[at + MIDDLE] - (begin + FRACTION[MIDDLE] * (end - begin))
    plain = begin > 0.0 and end < 0.0 and math.fabs(bent) <= STRAIGHT * (begin - end)
    return only if plain else NONE


def passed_at(e: Engine, g: Locator, k: int) -> float:
    """Return when a kink is passed that is plainly passed in the step; infinity if it is not.

    The two samples that it lies between are found by halves, and no others asked for.
    """
    a = g.atom_first[k]
    for i in range(SAMPLES):
        g.t[i] = e.step.t0 + (e.step.t1 - e.step.t0) * FRACTION[i]
    g.t[SAMPLES - 1] = e.step.t1
    low = 0
    high = SAMPLES - 1
    g.shape[a * SAMPLES + high] = atom_here(e, g, a)
    if not test_here(e, g, k):
        return math.inf
    while high - low > 1:
        i = (low + high) // 2
        look_at_sample(e, g, g.t[i])
        g.shape[a * SAMPLES + i] = atom_here(e, g, a)
        if test_here(e, g, k):
            high = i
        else:
            low = i
    g.sampled = True
    return bracket(e, g, k, g.t[low], g.t[high])


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
