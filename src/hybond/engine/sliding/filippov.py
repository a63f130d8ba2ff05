"""Which way a state on switching surfaces goes on: through them, or along some of them.

With weights in [0, 1] of the states above, Filippov's inclusion asks for functions that move up
only where the weight is 1 and down only where it is 0.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import Engine
from hybond.engine.surfaces.corners import put_coefficients, speed_at

FEW: Final = 6
"""Most surfaces for which all choices are tried."""
ROUNDS: Final = 30
STILL: Final = 1e-14
SOLVED: Final = 1e-10
"""Steps of Newton's method below these are the last; are small enough after the last."""
FAR: Final = 1e6
"""It does not lead on from further away."""
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
        return 1 if not s.product and pivot(e) else 0
    ways = 0
    most = -1
    asked = False
    total = 1
    for _ in range(s.k):
        total *= 3
    for number in range(total):
        slides = put_sides(e, number)
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


def put_sides(e: Engine, number: int) -> int:
    """Put the sides of a choice, by its number, into ``trial_side``; return how many slide."""
    s = e.slide
    slides = 0
    for j in range(s.k):
        p = s.k - 1 - j
        s.trial_side[p] = number % 3
        number = number // 3
        slides += 1 if s.trial_side[p] == SLIDES else 0
    return slides


def is_way(e: Engine) -> bool:
    """Whether the sides in `trial_side` agree with the speeds that they lead to."""
    return weigh(e) and wrong_at(e) < 0


def pivot(e: Engine) -> bool:
    """Find a way on for many surfaces by pivoting, into ``best``; False if there is none.

    Source: Judice and Pires, J. Optim. Theory Appl. 74, 1992.
    """
    s = e.slide
    for j in range(s.k):
        s.trial_side[j] = SLIDES
    for _ in range(40 + 20 * s.k):
        if not weigh(e):
            return False
        j = wrong_at(e)
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
    if s.product:
        return weigh_product(e)
    free = 0
    many = count_slides(e)
    for j in range(s.k):
        s.weight[j] = 1.0 if s.trial_side[j] == ABOVE else 0.0
    for j in range(s.k):
        if s.trial_side[j] != SLIDES:
            continue
        speed = speed_of(e, j)
        s.right[free] = -speed
        column = 0
        for p in range(s.k):
            if s.trial_side[p] == SLIDES:
                s.matrix[free * many + column] = speed_added(e, j, p)
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


def weigh_product(e: Engine) -> bool:
    """Find those of a product combination, by Newton's method from the middle."""
    s = e.slide
    many = count_slides(e)
    for j in range(s.k):
        slides = s.trial_side[j] == SLIDES
        s.weight[j] = 0.5 if slides else 1.0 if s.trial_side[j] == ABOVE else 0.0
    step = 0.0
    for _ in range(ROUNDS if many > 0 else 0):
        put_residual(e, many)
        if lu_factor(many, s.matrix, s.pivot) == SINGULAR:
            return False
        lu_solve(many, s.matrix, s.pivot, 1, s.right)
        step = 0.0
        at = 0
        for j in range(s.k):
            if s.trial_side[j] == SLIDES:
                s.weight[j] -= s.right[at]
                step = max(step, math.fabs(s.right[at]))
                at += 1
        if not all_finite(many, s.right) or not step < FAR:
            return False
        if step <= STILL:
            return True
    return step <= SOLVED


def put_residual(e: Engine, many: int) -> None:
    """Put the speeds of the functions that are to stay there, and their slopes by the weights."""
    s = e.slide
    row = 0
    for j in range(s.k):
        if s.trial_side[j] != SLIDES:
            continue
        s.right[row] = speed_of(e, j)
        column = 0
        for p in range(s.k):
            if s.trial_side[p] != SLIDES:
                continue
            # exact in each weight alone, whatever the step
            weight = s.weight[p]
            s.weight[p] = weight + 1.0
            ahead = speed_of(e, j)
            s.matrix[row * many + column] = ahead - s.right[row]
            s.weight[p] = weight
            column += 1
        row += 1


def wrong_at(e: Engine) -> int:
    """Return the first surface whose side does not fit the weights; -1: none."""
    s = e.slide
    for j in range(s.k):
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


def speed_added(e: Engine, j: int, p: int) -> float:
    """Return what machine p being above adds to the speed of function j."""
    s = e.slide
    return s.part_speed[(p + 1) * s.k + j] - s.part_speed[j]


def speed_of(e: Engine, j: int) -> float:
    """Return the speed of function j at the weights."""
    s = e.slide
    if s.product:
        put_coefficients(s, s.weight, s.tilted_coefficient)
        return speed_at(s, s.part_speed, s.tilted_coefficient, j)
    total = s.part_speed[j]
    for p in range(s.k):
        total += speed_added(e, j, p) * s.weight[p]
    return total
