"""Polynomials through values at Gauss nodes: their errors have no integral, to a high order."""

from __future__ import annotations

from typing import Final

from hybond.engine.words import Floats, float_table

BESIDE: Final = float_table(0.0, 0.0, 0.28867513459481287, 0.3872983346207417)
"""How far the outer of one to three nodes on [0, 1] are from its middle."""


def node_at(n: int, k: int) -> float:
    """Return node k of n, as a part of the time."""
    if n == 3 and k == 1:
        return 0.5
    return 0.5 - BESIDE[n] if k == 0 else 0.5 + BESIDE[n]


def through_nodes(n: int, h: float, values: Floats, at: int, width: int, out: Floats) -> None:
    """Put the coefficients of the polynomial through values at n nodes of (0, h) there.

    The values stand in `values` from `at` on, so far apart.
    """
    first = values[at]
    if n == 1:
        out[0] = first
        return
    last = values[at + width * (n - 1)]
    middle = values[at + width] if n == 3 else 0.5 * (first + last)
    beside = BESIDE[n]
    slope = (last - first) / (2.0 * beside)
    curve = 0.0
    if n == 3:
        curve = ((last - middle) - (middle - first)) / (2.0 * beside * beside)
        out[2] = curve / h / h
    # from powers of what is behind the middle to powers of what is behind the beginning
    out[0] = middle - 0.5 * slope + 0.25 * curve
    out[1] = (slope - curve) / h
