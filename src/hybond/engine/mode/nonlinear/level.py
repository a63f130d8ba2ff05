"""Bond variables of which what is known leaves nothing but the rounding of its terms."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import row_size
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.words import Floats

ROUNDED: Final = 2.0 * EPSILON
"""What stored quantities leave in a difference of them, as a part of its terms."""


def is_level(e: Engine, mode: Mode, v: Floats, base: Floats, first: int) -> bool:
    """Whether what is known of a bond variable, the first of those that are one, is rounding."""
    m = e.model
    if base[first] == 0.0:
        return False
    size = row_size(mode.finite, first, e.work.xi)
    for p in range(mode.finite.first.at[first], mode.finite.first.at[first + 1]):
        known = mode.finite.column.at[p]
        if known < m.storages and m.co_rounding[known] >= 0:
            terms = mode.finite.size.at[p] * value(m, m.co_rounding[known], v)
            size += terms if math.isfinite(terms) else 0.0
    return math.fabs(base[first]) <= ROUNDED * size


def put_level(e: Engine, mode: Mode, base: Floats, first: int) -> None:
    """Let what is known of all that are one with it be zero."""
    for k in range(first, 2 * e.model.bonds):
        if mode.same[k] == first:
            base[k] = 0.0


def put_together(e: Engine, mode: Mode, base: Floats, one: int, other: int) -> None:
    """Let two that differ by rounding of what is stored be equal, where both are known.

    They are the first of those that are one with each: two pressures that a valve compares. The
    other one is known as well if it is a source; whichever is, laws say the same of both.
    """
    if are_level(mode, base, one, other):
        for k in range(2 * e.model.bonds):
            if mode.same[k] == one:
                base[k] = base[other]


def are_level(mode: Mode, base: Floats, one: int, other: int) -> bool:
    """Whether two that are both known differ, but by no more than their rounding."""
    if one == other or base[one] == base[other] or mode.finite_frees == 0:
        return False
    shares = mode.share_first.at
    if shares[one] != shares[one + 1] or shares[other] != shares[other + 1]:
        return False
    size = math.fabs(base[one]) + math.fabs(base[other])
    return math.fabs(base[one] - base[other]) <= ROUNDED * size
