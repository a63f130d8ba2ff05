"""Random hybrid bond graphs as a strategy of hypothesis, which is not needed without it."""

from __future__ import annotations

from typing import Any

from hybond.errors import UsageError
from hybond.testing.drawing import random_recipe


def recipes(*, size: int = 6) -> Any:
    """Return a hypothesis strategy of recipes; it shrinks towards few junctions.

    Parameters
    ----------
    size : int
        Junctions at most.

    Raises
    ------
    UsageError
        HB-S121 without hypothesis, the extra ``testing``.

    Examples
    --------
    >>> recipes(size=2).example().parts[0].kind in ("0", "1")  # doctest: +SKIP
    True
    """
    try:
        from hypothesis import strategies
    except ImportError:
        raise UsageError(
            "hypothesis is not installed",
            code="HB-S121",
            where="recipes",
            hint="pip install 'hybond[testing]'; random_recipe(seed) needs nothing more",
        ) from None
    return strategies.builds(
        lambda junctions, seed: random_recipe(seed, size=junctions),
        strategies.integers(1, size),
        strategies.integers(0, 2**32 - 1),
    )
