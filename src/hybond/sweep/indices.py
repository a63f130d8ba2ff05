"""Sobol indices: which parts of the variance of an outcome come from which factor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.records import dataclass

Vector = NDArray[np.float64]
DRAWN = 200
"""Samples of the sample from which confidence is told."""


@dataclass(frozen=True, slots=True)
class SobolIndices:
    """First-order and total indices of the factors of a sweep.

    Parameters
    ----------
    names : tuple of str
        Factors.
    first, total : array, shape (factors,)
        The part of the variance that a factor makes alone, and with all others.
    first_error, total_error : array, shape (factors,)
        Half the width of the interval that 95 % of resampled points give.
    points, left_out : int
        Points of the sample, and those without a number: one of their members failed.
    """

    names: tuple[str, ...]
    first: Vector
    total: Vector
    first_error: Vector
    total_error: Vector
    points: int
    left_out: int

    def __str__(self) -> str:
        rows = [("factor", "first", "total")]
        each = zip(self.names, self.first, self.first_error, self.total, self.total_error)
        rows += [(n, f"{f:.3f} ± {fe:.3f}", f"{t:.3f} ± {te:.3f}") for n, f, fe, t, te in each]
        wide = [max(len(row[k]) for row in rows) for k in range(3)]
        lines = ["  ".join(w.ljust(n) for w, n in zip(row, wide)).rstrip() for row in rows]
        if self.left_out:
            lines.append(f"{self.left_out} of {self.points} points left out: a member failed")
        return "\n".join(lines)


def sobol_indices(names: tuple[str, ...], y: Vector, seed: int = 0) -> SobolIndices:
    """Return the indices of outcomes of a plan ``saltelli:N``.

    Parameters
    ----------
    y : array, shape (points * (factors + 2),)
        Point by point: of A, of A with one column of B after the other, of B.

    Notes
    -----
    First order: Saltelli et al., Computer Physics Communications 181 (2010) 259-270, table 2 (b);
    total: Jansen's, table 2 (f).

    Examples
    --------
    Of x + 2z with equal spreads a fifth of the variance is that of x.

    >>> from hybond.sweep.plan import Plan
    >>> rows = Plan({"x": "0..1", "z": "0..1"}, sample="saltelli:256").rows(0, 1024)
    >>> sobol_indices(("x", "z"), rows["x"] + 2.0*rows["z"]).first.round(2).tolist()
    [0.2, 0.8]
    """
    rows = y.reshape(-1, len(names) + 2)
    there = np.isfinite(rows).all(axis=1)
    good = rows[there]
    first, total = _indices(good)
    generator = np.random.default_rng(seed)
    drawn = [
        _indices(good[generator.integers(0, len(good), len(good))])
        for _ in range(DRAWN if len(good) else 0)
    ]
    low, high = (
        np.percentile(np.array(drawn), (2.5, 97.5), axis=0)
        if drawn
        else np.full((2, 2, len(names)), np.nan)
    )
    half = 0.5 * (high - low)
    return SobolIndices(
        names, first, total, half[0], half[1], len(rows), len(rows) - int(there.sum())
    )


def _indices(rows: Vector) -> tuple[Vector, Vector]:
    if not len(rows):
        none = np.full(rows.shape[1] - 2, np.nan)
        return none, none
    a, mixed, b = rows[:, :1], rows[:, 1:-1], rows[:, -1:]
    variance = np.var(np.concatenate([a, b]))
    if variance == 0.0:
        none = np.full(mixed.shape[1], np.nan)
        return none, none
    first = np.mean((b - b.mean()) * (mixed - a), axis=0) / variance
    total = 0.5 * np.mean((a - mixed) ** 2, axis=0) / variance
    return first, total
