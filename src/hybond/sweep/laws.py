"""Distributions by name, those of SciPy with the words of the field; and what they are given."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from hybond.errors import UsageError
from hybond.units import DIMENSIONLESS, Dimension, try_quantity

Make = Callable[..., Any]


def _stats(name: str) -> Any:
    from scipy import stats

    return getattr(stats, name)


def _triangular(low: float, mode: float, high: float) -> Any:
    return _stats("triang")((mode - low) / (high - low), low, high - low)


def _within(mean: float, sd: float, low: float, high: float) -> Any:
    return _stats("truncnorm")((low - mean) / sd, (high - mean) / sd, mean, sd)


LAWS: Mapping[str, tuple[Make, tuple[str, ...]]] = {
    "uniform": (lambda a, b: _stats("uniform")(a, b - a), ("LOW", "HIGH")),
    "loguniform": (lambda a, b: _stats("loguniform")(a, b), ("LOW", "HIGH")),
    "normal": (lambda m, s: _stats("norm")(m, s), ("MEAN", "SD")),
    "truncnormal": (_within, ("MEAN", "SD", "LOW", "HIGH")),
    "lognormal": (lambda m, s: _stats("lognorm")(s, 0.0, m), ("MEDIAN", "sigma")),
    "triangular": (_triangular, ("LOW", "MODE", "HIGH")),
    "beta": (lambda a, b, c, d: _stats("beta")(a, b, c, d - c), ("a", "b", "LOW", "HIGH")),
    "gamma": (lambda k, s: _stats("gamma")(k, 0.0, s), ("k", "SCALE")),
    "weibull": (lambda k, s: _stats("weibull_min")(k, 0.0, s), ("k", "SCALE")),
    "exponential": (lambda m: _stats("expon")(0.0, m), ("MEAN",)),
}
"""Each with what makes it, and what it is given: in capitals what has the unit of the factor."""


def law_of(path: str, text: str, name: str, words: Sequence[str]) -> tuple[Any, Dimension | None]:
    """Return a frozen distribution, in SI, and the dimension of what is drawn.

    Raises
    ------
    UsageError
        HB-P101.

    Examples
    --------
    >>> law, dimension = law_of("c", "", "lognormal", ["2 mF", "0.1"])
    >>> float(law.median()), str(dimension)
    (0.002, 'F')
    """
    make, takes = LAWS[name]
    call = f"{name}({', '.join(takes)})"
    if len(words) != len(takes):
        raise _refusal(f"{text!r} is not {call}", path, call)
    numbers: list[float] = []
    kinds = set()
    for word, take in zip(words, takes, strict=True):
        found = try_quantity(word)
        if found is None or not math.isfinite(found.value):
            raise _refusal(f"{word!r} in {text!r} is no quantity", path, call)
        if take.isupper():
            kinds.add(found.dimension)
        elif found.dimension != DIMENSIONLESS:
            raise _refusal(f"{take} of {text!r} has no unit", path, call)
        numbers.append(found.value)
    if len(kinds) > 1:
        raise _refusal(f"{text!r} is of more than one kind", path, "all in one unit")
    named = dict(zip(takes, numbers, strict=True))
    wrong = [n for n in ("SD", "sigma", "SCALE", "a", "b", "k") if named.get(n, 1.0) <= 0.0]
    wrong += [n for n in ("MEDIAN",) if named.get(n, 1.0) <= 0.0]
    if name == "exponential" and named["MEAN"] <= 0.0:
        wrong.append("MEAN")
    if wrong:
        raise _refusal(f"{wrong[0]} of {text!r} is not above zero", path, call)
    low, high = named.get("LOW", 0.0), named.get("HIGH", 1.0)
    fits = low < high and low <= named.get("MODE", low) <= high
    if "LOW" in named and (not fits or (name == "loguniform" and low <= 0.0)):
        raise _refusal(f"{text!r} is no range", path, call)
    kind = kinds.pop()
    return make(*numbers), None if kind == DIMENSIONLESS else kind


def frozen_of(path: str, given: Any) -> tuple[Any, str]:
    """Return a frozen distribution of SciPy, and a text that says which it is.

    Raises
    ------
    UsageError
        HB-P101 for what has no name: only what SciPy knows can be told to others.
    """
    kind = getattr(given, "dist", None)
    name = getattr(kind, "name", "")
    if not name or not hasattr(_scipy_stats(), name):
        raise _refusal(f"{path} is drawn from {given!r}, which SciPy has no name for", path, "")
    options = given.kwds.items()
    words = [repr(float(a)) for a in given.args]
    words += [f"{key}={float(value)!r}" for key, value in sorted(options)]
    return given, f"scipy.{name}({', '.join(words)})"


def from_name(name: str, args: Sequence[float], options: Mapping[str, float]) -> Any:
    """Return a distribution of SciPy that `frozen_of` has told of."""
    return _stats(name)(*args, **options)


def _scipy_stats() -> Any:
    from scipy import stats

    return stats


def _refusal(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-P101", where=where, hint=hint or "uniform(1 mm, 2 mm)")
