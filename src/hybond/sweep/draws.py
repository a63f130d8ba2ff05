"""Points of the unit cube, part after part: at random, Latin hypercube, Sobol', and designs."""

from __future__ import annotations

import inspect
import warnings
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.names import did_you_mean

Vector = NDArray[np.float64]

METHODS: dict[str, str] = {
    "random": "independent draws",
    "lhs": "a Latin hypercube: each factor has one value in each of N equal parts",
    "sobol": "Sobol's sequence, scrambled; N a power of two keeps its balance",
    "saltelli": "N*(factors + 2) members from which Sobol indices are told",
    "ends": "one factor after the other from its middle to its ends: a tornado",
}
"""Ways to draw, each with a line that says what it is."""
BLOCK = 4096
"""Random members drawn at once: which ones does not depend on where a part begins."""
TAIL = 0.05
"""Of ``ends``: part of a distribution beyond each of its ends."""


class Draws:
    """Points of the unit cube.

    Parameters
    ----------
    method : str
        One of `METHODS`.
    count : int
        The number behind it.
    dims : int
        Factors.
    seed : int

    Examples
    --------
    >>> draws = Draws("sobol", 8, 2, 7)
    >>> (draws.part(0, 8)[3:5] == draws.part(3, 5)).all()
    np.True_
    """

    def __init__(self, method: str, count: int, dims: int, seed: int) -> None:
        self.method, self.count, self.dims, self.seed = method, count, dims, seed

    @property
    def members(self) -> int:
        """How many points there are."""
        if self.method == "saltelli":
            return self.count * (self.dims + 2)
        return 1 + 2 * self.dims if self.method == "ends" else self.count

    def part(self, first: int, last: int) -> Vector:
        """Return the points from `first` to `last` - 1, shape (points, dims)."""
        match self.method:
            case "random":
                return self._random(first, last)
            case "lhs":
                return self._latin[first:last]
            case "sobol":
                return self._sobol(self.dims, first, last)
            case "saltelli":
                return self._saltelli(first, last)
            case _:
                return self._ends[first:last]

    def _random(self, first: int, last: int) -> Vector:
        blocks = range(first // BLOCK, (last - 1) // BLOCK + 1)
        drawn = [np.random.default_rng([self.seed, k]).random((BLOCK, self.dims)) for k in blocks]
        begin = blocks.start * BLOCK
        return np.concatenate(drawn)[first - begin : last - begin]

    @cached_property
    def _latin(self) -> Vector:
        """The only ones that are drawn all at once."""
        from scipy.stats import qmc

        return np.asarray(
            qmc.LatinHypercube(self.dims, **_seeded(qmc, self.seed)).random(self.count)
        )

    def _sobol(self, dims: int, first: int, last: int) -> Vector:
        from scipy.stats import qmc

        if last <= first:
            return np.zeros((0, dims))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a number that is no power of two: METHODS says it
            sequence = qmc.Sobol(dims, scramble=True, **_seeded(qmc, self.seed))
            if first:
                sequence.fast_forward(first)
            return np.asarray(sequence.random(last - first))

    def _saltelli(self, first: int, last: int) -> Vector:
        """Return rows of A, of A with one column of B after the other, and of B, point by point.

        Source: Saltelli et al., Computer Physics Communications 181 (2010) 259-270.
        """
        wide = self.dims + 2
        begin, end = first // wide, (last - 1) // wide + 1
        pairs = self._sobol(2 * self.dims, begin, end)
        a, b = pairs[:, : self.dims], pairs[:, self.dims :]
        rows = np.repeat(a[:, None, :], wide, axis=1)
        for k in range(self.dims):
            rows[:, k + 1, k] = b[:, k]
        rows[:, -1] = b
        return rows.reshape(-1, self.dims)[first - begin * wide : last - begin * wide]

    @cached_property
    def _ends(self) -> Vector:
        rows = np.full((self.members, self.dims), 0.5)
        for k in range(self.dims):
            rows[1 + 2 * k, k], rows[2 + 2 * k, k] = TAIL, 1.0 - TAIL
        return rows


def draws_of(sample: str, dims: int, seed: int) -> Draws:
    """Return what ``METHOD:NUMBER`` asks for.

    Raises
    ------
    UsageError
        HB-P102.

    Examples
    --------
    >>> draws_of("saltelli:8", 3, 0).members
    40
    """
    method, colon, number = (word.strip() for word in str(sample).partition(":"))
    if method not in METHODS:
        raise _refusal(f"there is no way {method!r} to draw", did_you_mean(method, METHODS))
    if method == "ends" and not colon:
        return Draws(method, 1, dims, seed)
    if not number.isdecimal() or not 1 <= int(number) <= 10**9 or method == "ends":
        raise _refusal(f"{sample!r} is not {'ends' if method == 'ends' else f'{method}:NUMBER'}")
    return Draws(method, int(number), dims, seed)


def _seeded(qmc: Any, seed: int) -> dict[str, Any]:
    """Return the seed as this version of SciPy takes it."""
    takes = inspect.signature(qmc.Sobol.__init__).parameters
    generator = np.random.default_rng(seed)
    return {"rng" if "rng" in takes else "seed": generator}


def _refusal(why: str, hint: str = "") -> UsageError:
    return UsageError(
        why, code="HB-P102", where="sample", hint=hint or "lhs:1000, sobol:1024 or random:1000"
    )
