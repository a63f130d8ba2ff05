"""What samples and modes repeat: the period of a motion, and what happens in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Word = tuple[int, ...]
"""The mode at a sample, and those written up to the next one, each as a number."""
NEAR = 1e-9
"""Part of a period: a mode that is written so near to a sample is the one at it."""
ROUNDING = 1e-11
"""Of the scale: what differences may grow by while they shrink."""
LEAST = 1e-10
"""Of the scale: differences that grow count from there on."""
LEFT = 0.05
"""Part of the last difference that may be left in the limit of those that settle: extrapolated
they are not exact, as motions of several rates settle together."""


@dataclass(frozen=True, slots=True)
class Orbit:
    """What a motion repeats.

    Parameters
    ----------
    period : int
        In samples; 0 if it repeats nothing within what was looked at.
    settled : bool
        Whether it repeats within the tolerance; else differences still shrink to nothing.
    words : tuple of Word
        The modes from sample to sample of one turn, begun where that is the first in order; empty
        if nothing repeats.
    events : float
        Modes written from sample to sample, on average.
    """

    period: int
    settled: bool
    words: tuple[Word, ...]
    events: float

    @property
    def kind(self) -> tuple[int, tuple[Word, ...]]:
        """What is the same all over a window."""
        return self.period, self.words


def words_of(when: Vector, since: Vector, modes: Sequence[int]) -> tuple[Word, ...]:
    """Return the modes from sample to sample.

    Parameters
    ----------
    when : array, shape (samples + 1,)
        When samples were taken; behind the last one the end.
    since : array
        When modes were written, the first one at the first sample.

    Examples
    --------
    A switch is closed at each sample (mode 1), and opens between the first two only.

    >>> words_of(np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 0.7, 1.0, 3.0]), [1, 0, 1, 1])
    ((1, 0), (1,), (1,))
    """
    near = NEAR * np.diff(when)
    first = np.searchsorted(since, when[:-1] + near, side="right")
    last = np.searchsorted(since, when[1:] - near, side="left")
    own = list(modes)
    found = []
    for a, b in zip(first.tolist(), last.tolist()):
        word = own[max(a - 1, 0) : max(b, a)]
        found.append(tuple(m for k, m in enumerate(word) if not k or m != word[k - 1]))
    return tuple(found)


def orbit_of(
    samples: Vector, words: Sequence[Word], scale: Vector, tolerance: float, longest: int
) -> Orbit:
    """Return the shortest period of samples and words.

    A period is one if samples differ by no more than `tolerance` of the scale from those a period
    later, all of them; or if these differences are smaller in each turn than in the one before, and
    what they shrink to, extrapolated, is no more than that or a twentieth of the last ones: close
    to where an orbit loses its stability it settles slowly. One from which differences grow in
    each turn, however small, is none: it is about to be left. Words repeat in the last turns. What
    winds into an orbit comes near itself after some turns of a longer period; its own is the one to
    which all of them shrink.

    Parameters
    ----------
    samples : array, shape (signals, samples)
    scale : array, shape (signals,)
    longest : int
        Periods up to this one are looked for, and up to half the samples.

    Examples
    --------
    >>> x = np.array([[1.0, 2.0] * 8])
    >>> orbit_of(x, [(0,)] * 16, np.array([2.0]), 1e-6, 8).period
    2
    >>> slow = 1.0 + 0.1 * (-0.98) ** np.arange(48.0)  # -0.98 a sample: it settles to a period of 1
    >>> found = orbit_of(slow[None, :], [(0,)] * 48, np.array([1.0]), 1e-6, 8)
    >>> found.period, found.settled
    (1, False)
    """
    many = samples.shape[1]
    events = sum(len(w) - 1 for w in words) / max(len(words), 1)
    scaled = samples / np.where(scale > 0.0, scale, 1.0)[:, None]
    if not np.isfinite(scaled).all():
        return Orbit(0, False, (), events)
    for p in range(1, min(longest, many // 2) + 1):
        apart = np.abs(scaled[:, p:] - scaled[:, :-p]).max(axis=0)
        settled = bool(apart.max() <= tolerance)
        if settled and _grows(apart, p):
            continue
        if not settled and not _shrinks(apart, p, tolerance):
            continue
        turns = max(2 * p, len(words) // 2) if settled else 2 * p
        own = list(words[-turns:])
        if own[p:] != own[:-p]:
            continue
        if not settled:
            p = _shorter(scaled, own, p)
        return Orbit(p, settled, turned(own[-p:]), sum(len(w) - 1 for w in own[-p:]) / p)
    return Orbit(0, False, (), events)


def _shorter(scaled: Vector, words: Sequence[Word], p: int) -> int:
    """Return the divisor of a period to which its turns shrink: a spiral into a shorter orbit.

    Points of an orbit stay apart; those of a spiral come nearer as fast as its turns do.
    """
    far = np.abs(scaled[:, p:] - scaled[:, :-p]).max(axis=0)
    for d in range(1, p):
        if p % d == 0 and list(words[d:]) == list(words[:-d]):
            apart = np.abs(scaled[:, d:] - scaled[:, :-d]).max(axis=0)
            if _left(apart) <= math.sqrt(_left(far)):
                return d
    return p


def _left(apart: Vector) -> float:
    """Return what is left of differences in the last third, as a part of those in the first."""
    third = max(len(apart) // 3, 1)
    first = float(apart[:third].mean())
    return float(apart[-third:].mean()) / first if first > 0.0 else 0.0


def _turns(apart: Vector, p: int) -> Vector:
    """Return the largest difference in each turn."""
    found: Vector = apart[: len(apart) // p * p].reshape(-1, p).max(axis=1)
    return found


def _grows(apart: Vector, p: int) -> bool:
    """Whether differences are larger in each turn than in the one before, and not by rounding."""
    turns = _turns(apart, p)
    return len(turns) > 5 and bool((np.diff(turns) > 0.0).all()) and turns[-1] > LEAST


def _shrinks(apart: Vector, p: int, tolerance: float) -> bool:
    """Whether differences go to nothing: extrapolated from three thirds of the turns, means."""
    turns = _turns(apart, p)
    third = len(turns) // 3
    if third < 2 or not (np.diff(turns) < ROUNDING).all():
        return False
    a, b, c = (float(turns[k * third : (k + 1) * third].mean()) for k in range(3))
    slower = (a - b) - (b - c)
    limit = c - (b - c) ** 2 / slower if slower > 0.0 else c
    return abs(limit) <= max(tolerance, LEFT * c)


def turned(words: Sequence[Word]) -> tuple[Word, ...]:
    """Return a turn begun where that is the first in order.

    Examples
    --------
    >>> turned([(1, 0), (0, 1), (1,)])
    ((0, 1), (1,), (1, 0))
    """
    return min(tuple(words[k:]) + tuple(words[:k]) for k in range(len(words)))
