"""The smallest change that brings linear functions as near as can be to what is asked of them."""

from __future__ import annotations

from typing import Final

from hybond.engine.words import Floats, floats, record

TURNS: Final = 4
"""Directions for each function: as many as there are are enough but for rounding."""
ENOUGH: Final = 1e-14
"""Part of what was asked that is nothing."""


@record
class LeastStep:
    """Room for `c` functions of `n` unknowns, and the smallest step."""

    rest: Floats
    """What is asked of each function, and in the end what is left of that."""
    lead: Floats
    slope: Floats
    way: Floats
    z: Floats


def make_least_step(c: int, n: int) -> LeastStep:
    """Return such room."""
    r = LeastStep()
    r.rest = floats(c)
    r.lead = floats(c)
    r.slope = floats(n)
    r.way = floats(n)
    r.z = floats(n)
    return r


def find_least_step(r: LeastStep, c: int, n: int, a: Floats, first: int) -> None:
    """Find the smallest z for which `a z` is next to ``r.rest``, by conjugate gradients.

    `a` has c rows and n columns from `first` on; rows may depend on each other, or contradict.
    """
    for j in range(n):
        r.z[j] = 0.0
    before = 0.0
    asked = 0.0
    for turn in range(TURNS * c):
        steep = 0.0
        for j in range(n):
            r.slope[j] = 0.0
            for k in range(c):
                r.slope[j] += a[first + k * n + j] * r.rest[k]
            steep += r.slope[j] * r.slope[j]
        if turn == 0:
            asked = steep
        if steep == 0.0 or steep <= ENOUGH * ENOUGH * asked:
            return
        for j in range(n):
            r.way[j] = r.slope[j] + (steep / before * r.way[j] if turn > 0 else 0.0)
        straight = 0.0
        for k in range(c):
            r.lead[k] = 0.0
            for j in range(n):
                r.lead[k] += a[first + k * n + j] * r.way[j]
            straight += r.lead[k] * r.lead[k]
        if straight == 0.0:
            return
        far = steep / straight
        for j in range(n):
            r.z[j] += far * r.way[j]
        for k in range(c):
            r.rest[k] -= far * r.lead[k]
        before = steep
