"""Fourier coefficients of a signal of a run, window after window, and whether they have settled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.periods import Window
from hybond.draw.impulses import impulses_of
from hybond.result import Result

Complex = NDArray[np.complex128]

NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)
A_TURN = 16
"""Pieces into which a period of the sine is divided at the least, besides steps and events."""


def coefficients(run: Result, name: str, window: Window, orders: tuple[int, ...]) -> Complex:
    """Return ``2/T`` times the integral of ``y exp(-i k w t)`` over each whole window of a run.

    Between events and the ends of steps the signal is smooth: each piece is integrated by five
    points of Gauss, which are exact for polynomials of degree nine. Impulses add their areas.

    Parameters
    ----------
    orders : tuple of int
        Each k.
    """
    many = int(np.floor(run.t_end / window.length * (1.0 + 1e-12)))
    edges = np.arange(many + 1) * window.length
    pieces = np.linspace(0.0, 1.0, A_TURN * window.turns + 1)[1:]
    grid = (edges[:-1, None] + window.length * pieces).ravel()
    own = np.concatenate([[0.0], edges, grid, *(s.t for s in run.segments)])
    cuts = np.unique(own[own <= edges[-1]])
    # what is shorter than rounding has no inside
    half = 0.5 * np.diff(cuts)
    wide = half > 4.0 * np.spacing(cuts[1:])
    middle, half = 0.5 * (cuts[1:] + cuts[:-1])[wide], half[wide]
    t = (middle[:, None] + half[:, None] * NODES).ravel()
    y = run.sample(t, [name])[name]
    weight = (half[:, None] * WEIGHTS).ravel()
    where = np.minimum((middle / window.length).astype(int), many - 1).repeat(len(NODES))
    found = np.zeros((many, len(orders)), dtype=complex)
    areas = impulses_of(run, name)
    for j, k in enumerate(orders):
        turn = 2.0 * np.pi * k * window.turns / window.length
        terms = weight * y * np.exp(-1j * turn * t)
        found[:, j] = _summed(terms, where, many)
        for at, area in areas[areas[:, 0] < edges[-1]]:
            found[int(at / window.length), j] += area * np.exp(-1j * turn * at)
    return np.asarray(2.0 / window.length * found)


def _summed(terms: Complex, where: NDArray[np.int_], many: int) -> Complex:
    real = np.bincount(where, terms.real, minlength=many)
    return np.asarray(real + 1j * np.bincount(where, terms.imag, minlength=many))


def left_over(values: Complex) -> float:
    """Return how far the last of a series of coefficients still is from its limit, as a part of it.

    The largest change in the last quarter of the windows, against the largest in the quarter before
    it, says by which ratio ``r`` changes shrink from window to window: they then add up to at most
    ``r/(1 - r)`` times that change. Where they do not shrink nothing is known, and it is infinite.

    Examples
    --------
    >>> round(left_over(1.0 + 0.5 ** np.arange(16.0) + 0j) * 2.0**12, 2)
    1.0
    >>> left_over(np.arange(9.0) + 0j)
    inf
    """
    part = len(values) // 4
    if part < 2:
        return float("inf")
    change = np.abs(np.diff(values))
    newer, older = float(change[-part:].max()), float(change[-2 * part : -part].max())
    size = float(np.abs(values[-1]))
    if newer <= ROUNDING * size:
        return newer / size if size else 0.0
    if newer >= older or not size:
        return float("inf")
    ratio = (newer / older) ** (1.0 / part)
    return float(newer * max(ratio / (1.0 - ratio), 1.0) / size)


ROUNDING = 1e-7
"""Part of a coefficient by which it may change from window to window without end: the tolerances of
a run leave about as much."""
