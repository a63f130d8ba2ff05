"""Which way a state on switching surfaces goes on: through them, or along some of them.

With weights in [0, 1] of the states above, Filippov's inclusion asks for functions that move up
only where the weight is 1 and down only where it is 0. After modes/sliding/filippov.py.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import Engine

FEW: Final = 6
"""Most surfaces for which all choices are tried."""
SLIDES: Final = 0
ABOVE: Final = 1
BELOW: Final = 2


def find_ways(e: Engine) -> int:
    """Find the way on from the surfaces ``side[0 .. k - 1]``; return how many there are.

    The speeds of their functions are in ``part_speed``. The way is put into ``best``: that of the
    `sides` asked for if it is one, else the first of those that slide most.
    """
    s = e.slide
    if s.k > FEW:
        return 1 if pivot(e) else 0
    ways = 0
    most = -1
    asked = False
    total = 1
    for _ in range(s.k):
        total *= 3
    for number in range(total):
        rest = number
        slides = 0
        for j in range(s.k):
            p = s.k - 1 - j
            s.trial_side[p] = rest % 3
            rest = rest // 3
            slides += 1 if s.trial_side[p] == SLIDES else 0
        if not is_way(e):
            continue
        ways += 1
        same = True
        for j in range(s.k):
            same = same and s.trial_side[j] == s.sides[j]
        if asked or not (same or slides > most):
            continue
        asked = same
        most = max(most, slides)
        for j in range(s.k):
            s.best[j] = s.trial_side[j]
            s.best_weight[j] = s.weight[j]
    return ways


def is_way(e: Engine) -> bool:
    """Whether the sides in `trial_side` agree with the speeds that they lead to."""
    return weigh(e) and wrong_at(e, 0) < 0


def pivot(e: Engine) -> bool:
    """Find a way on for many surfaces by pivoting, into ``best``; False if there is none.

    After modes/sliding/filippov.py, future (Judice and Pires 1992).
    """
    s = e.slide
    for j in range(s.k):
        s.trial_side[j] = SLIDES
    for _ in range(40 + 20 * s.k):
        if not weigh(e):
            return False
        j = wrong_at(e, 0)
        if j < 0:
            for p in range(s.k):
                s.best[p] = s.trial_side[p]
                s.best_weight[p] = s.weight[p]
            return True
        if s.trial_side[j] != SLIDES:
            s.trial_side[j] = SLIDES
        else:
            s.trial_side[j] = BELOW if s.weight[j] < 0.0 else ABOVE
    return False


def weigh(e: Engine) -> bool:
    """Find the weights with which the surfaces that slide stay where they are."""
    s = e.slide
    free = 0
    many = count_slides(e)
    for j in range(s.k):
        s.weight[j] = 1.0 if s.trial_side[j] == ABOVE else 0.0
    for j in range(s.k):
        if s.trial_side[j] != SLIDES:
            continue
        s.right[free] = -speed_of(e, j)
        column = 0
        for p in range(s.k):
            if s.trial_side[p] == SLIDES:
                s.matrix[free * many + column] = added(e, j, p)
                column += 1
        free += 1
    if free == 0:
        return True
    if lu_factor(free, s.matrix, s.pivot) == SINGULAR:
        return False
    lu_solve(free, s.matrix, s.pivot, 1, s.right)
    if not all_finite(free, s.right):
        return False
    at = 0
    for j in range(s.k):
        if s.trial_side[j] == SLIDES:
            s.weight[j] = s.right[at]
            at += 1
    return True


def wrong_at(e: Engine, first: int) -> int:
    """Return the first surface, from `first` on, whose side does not fit the weights; -1: none."""
    s = e.slide
    for j in range(first, s.k):
        speed = speed_of(e, j)
        if s.trial_side[j] == SLIDES:
            if s.weight[j] < 0.0 or s.weight[j] > 1.0:
                return j
        elif s.trial_side[j] == ABOVE:
            if speed < 0.0:
                return j
        elif speed > 0.0:
            return j
    return -1


def count_slides(e: Engine) -> int:
    """Return how many of the sides tried slide."""
    many = 0
    for j in range(e.slide.k):
        many += 1 if e.slide.trial_side[j] == SLIDES else 0
    return many


def added(e: Engine, j: int, p: int) -> float:
    """Return what machine p being above adds to the speed of function j."""
    s = e.slide
    return s.part_speed[(p + 1) * s.k + j] - s.part_speed[j]


def speed_of(e: Engine, j: int) -> float:
    """Return the speed of function j at the weights."""
    s = e.slide
    total = s.part_speed[j]
    for p in range(s.k):
        total += added(e, j, p) * s.weight[p]
    return total
