"""The modes that a combination is made of, and how much of each its weights take.

Of k machines between two states each, a combination takes either all below, then each one alone
above (*additive*), or all corners of the cube of weights (*product*).
"""

from __future__ import annotations

from typing import Final

from hybond.engine.model import Model
from hybond.engine.surfaces.slide_records import Slide
from hybond.engine.words import Floats, Ints

MOST_PRODUCT: Final = 6
"""Most surfaces of a product combination, which takes 2^k fields."""


def most_combined(laws: int, surfaces: int) -> int:
    """Return how many modes can be combined where laws of junctions have branches."""
    if laws == 0 or surfaces == 0:
        return 0
    return max(surfaces + 1, 1 << min(surfaces, MOST_PRODUCT))


def count_corners(k: int, product: bool) -> int:
    """Return how many modes are combined."""
    return 1 << k if product else k + 1


def is_above(k: int, product: bool, part: int, j: int) -> bool:
    """Whether machine j of k is above its surface in a part."""
    if product:
        return ((part >> (k - 1 - j)) & 1) == 1
    return part == j + 1


def put_corner(
    m: Model, base: Ints, part: int, k: int, product: bool, side: Ints, out: Ints
) -> None:
    """Put the states of machines in a part there, those that do not slide being as in `base`."""
    for machine in range(m.machines):
        out[machine] = base[machine]
    for j in range(k):
        put_side(m, side[j], is_above(k, product, part, j), out)


def put_side(m: Model, surface: int, above: bool, out: Ints) -> None:
    """Put the machine of a surface on one side, and those that always cross it together."""
    out[m.surface_machine[surface]] = (
        m.surface_above[surface] if above else m.surface_below[surface]
    )
    for other in range(m.surfaces):
        if not cross_as_one(m, surface, other):
            continue
        now = out[m.surface_machine[other]]
        if now == m.surface_below[other] or now == m.surface_above[other]:
            same = m.surface_twin[surface * m.surfaces + other] > 0
            out[m.surface_machine[other]] = (
                m.surface_above[other] if above == same else m.surface_below[other]
            )


def cross_as_one(m: Model, surface: int, other: int) -> bool:
    """Whether the machines of two surfaces cross what is one surface together, whatever holds."""
    return (
        m.surface_twin[surface * m.surfaces + other] != 0
        and m.surface_rest[2 * surface] == m.surface_rest[2 * surface + 2]
        and m.surface_rest[2 * other] == m.surface_rest[2 * other + 2]
    )


def put_coefficients(s: Slide, weight: Floats, out: Floats) -> None:
    """Put the share of each part at some weights there."""
    if not s.product:
        out[0] = 1.0
        for j in range(s.k):
            out[0] -= weight[j]
            out[j + 1] = weight[j]
        return
    for part in range(s.parts):
        out[part] = 1.0
        for j in range(s.k):
            out[part] *= weight[j] if is_above(s.k, True, part, j) else 1.0 - weight[j]


def put_slopes(s: Slide) -> None:
    """Put the slopes of the coefficients by the weights into `by`, a row for each part."""
    for part in range(s.parts):
        for j in range(s.k):
            above = is_above(s.k, s.product, part, j)
            if s.product:
                slope = 1.0 if above else -1.0
                for p in range(s.k):
                    if p != j:
                        up = is_above(s.k, True, part, p)
                        slope *= s.weight[p] if up else 1.0 - s.weight[p]
            else:
                slope = -1.0 if part == 0 else 1.0 if above else 0.0
            s.by[part * s.k + j] = slope


def speed_at(s: Slide, speed: Floats, coefficient: Floats, j: int) -> float:
    """Return how fast function j moves, a row of `speed` being that of a part."""
    total = 0.0
    for part in range(s.parts):
        total += coefficient[part] * speed[part * s.k + j]
    return total
