"""Where searches begin within bounds, and which of them end in the same minimum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.fitting.record import Minimum
from hybond.fitting.varied import Scale

Vector = NDArray[np.float64]
SAME = 1e-4
"""Part of the span of its bounds within which a variable counts as the same."""
STARTS = 10_000


def starts_of(scale: Scale, many: int, seed: int) -> list[Vector]:
    """Return variables to begin with: those of the model, and a Latin hypercube within bounds.

    Raises
    ------
    UsageError
        HB-A532 for a number that is none, or bounds that are left out.

    Examples
    --------
    >>> from hybond.fitting.varied import scale_of
    >>> scale = scale_of(["R"], np.array([1.0]), {"R": (0.0, 4.0)}, [])
    >>> [z.round(2).tolist() for z in starts_of(scale, 3, 7)]
    [[1.0], [1.79], [3.55]]
    """
    for name, value, least in (("starts", many, 1), ("seed", seed, 0)):
        if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= 2**32:
            raise UsageError(
                f"{name} = {value!r}",
                code="HB-A532",
                where=name,
                hint=f"a whole number, {least} or more",
            )
    if many > STARTS:
        raise UsageError(
            f"starts = {many}", code="HB-A532", where="starts", hint=f"at most {STARTS}"
        )
    if many == 1:
        return [scale.start]
    low, high = scale.bounds
    for k, name in enumerate(scale.names):
        if not np.isfinite(low[k]) or not np.isfinite(high[k]):
            raise UsageError(
                f"several starts lie within bounds, and {name} has not both",
                code="HB-A532",
                where=name,
                hint=f"bounds={{{name!r}: (LOW, HIGH)}}"
                + (", LOW above 0 as its logarithm is looked for" if scale.logs[k] else ""),
            )
    generator = np.random.default_rng(seed)
    drawn = many - 1
    part = np.stack([generator.permutation(drawn) for _ in scale.names], axis=1)
    within = (part + generator.random(part.shape)) / drawn
    return [scale.start, *(low + within * (high - low))]


def minima_of(scale: Scale, ends: Sequence[tuple[Vector, float]]) -> tuple[Minimum, ...]:
    """Return the minima in which searches ended, the best first, and how many in each.

    Parameters
    ----------
    ends : sequence of (variables, cost)
    """
    low, high = scale.bounds
    found: list[tuple[Vector, float, int]] = []
    for z, cost in sorted(ends, key=lambda end: end[1]):
        for k, (other, least, many) in enumerate(found):
            if (np.abs(z - other) <= SAME * (high - low)).all():
                found[k] = other, least, many + 1
                break
        else:
            found.append((z, cost, 1))
    return tuple(
        Minimum(tuple(scale.values(z).tolist()), 2.0 * cost, many) for z, cost, many in found
    )
