"""What varies in a plan: a path and its levels, or the distribution that it is drawn from.

    factor  = levels | law
    levels  = value {"," value} | LOW ".." HIGH ":" NUMBER | LOW ":" HIGH ":" STEP
            | "lin(" LOW, HIGH, NUMBER ")" | "log(" LOW, HIGH, NUMBER ")"
    law     = LOW ".." HIGH | name "(" value {"," value} ")"

Values are numbers or quantities. Text is read, not run.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.measures.asked import split_arguments
from hybond.model.expressions.tree import FUNCTIONS, GATHER
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.sweep.laws import LAWS, frozen_of, law_of
from hybond.units import DIMENSIONLESS, Dimension, Quantity, parse_quantity, try_quantity

Vector = NDArray[np.float64]

LEVELS = 100_000_000
"""Levels that one factor may have."""
EXACT = 10_000
"""Even levels up to which decimals stay decimals: 0.1, 0.2, 0.3."""
_CALL = re.compile(r"\s*(\w+)\s*\((.*)\)\s*\Z", re.DOTALL)
_NUMBER = re.compile(r"\s*[+-]?[\d.]+([eE][+-]?\d+)?")


@dataclass(frozen=True, eq=False)
class Factor:
    """One thing that varies.

    Parameters
    ----------
    path : str
        A parameter, the value of an element, a start, an input; as in ``parameters=``.
    text : str
        What it takes, canonical.
    levels : array, shape (levels,) or tuple, or None
        Numbers in SI; or values of which one is no number, as written. None of a law.
    dimension : Dimension or None
        None if no value has a unit.
    law : Any
        A frozen distribution of SciPy; None of levels.
    """

    path: str
    text: str
    levels: Vector | tuple[Value, ...] | None
    dimension: Dimension | None = None
    law: Any = field(default=None, repr=False)

    @property
    def is_number(self) -> bool:
        """Whether all that it takes are numbers."""
        return not isinstance(self.levels, tuple)

    @property
    def many(self) -> int:
        """Number of levels, 0 of a law."""
        return 0 if self.levels is None else len(self.levels)

    def of_level(self, k: NDArray[np.intp]) -> Any:
        """Return the values of levels by number, shape (n,)."""
        assert self.levels is not None
        if isinstance(self.levels, tuple):
            return [self.levels[j] for j in k.tolist()]
        return self.levels[k]

    def quantile(self, u: Vector) -> Any:
        """Return values for parts of the whole, 0 to 1: levels have equal parts of it.

        Examples
        --------
        >>> factor_of("m", "1, 2, 4").quantile(np.array([0.1, 0.5, 0.99])).tolist()
        [1.0, 2.0, 4.0]
        """
        if self.law is not None:
            return np.asarray(self.law.ppf(u), dtype=float)
        k = np.minimum((u * self.many).astype(np.intp), self.many - 1)
        return self.of_level(k)

    def shown(self, value: float) -> Value:
        """Return a value as a model takes it, with the unit if there is one."""
        return value if self.dimension is None else f"{value!r} {self.dimension}"


def factor_of(path: str, given: Any) -> Factor:
    """Return what varies, as written, as a sequence of values or as a distribution of SciPy.

    Raises
    ------
    UsageError
        HB-P101.

    Examples
    --------
    >>> factor_of("mu", "0.2:0.3:0.025").levels.tolist()
    [0.2, 0.225, 0.25, 0.275, 0.3]
    >>> factor_of("c", "log(1e-4, 1e-2, 3)").levels.tolist()
    [0.0001, 0.001, 0.01]
    >>> float(factor_of("m", "normal(1 kg, 50 g)").law.std())
    0.05
    """
    if not isinstance(path, str) or not path.strip():
        raise _refusal(f"{path!r} is no path", "factors")
    path = path.strip()
    if isinstance(given, str):
        return _read(path, given.strip())
    if hasattr(given, "ppf"):
        law, text = frozen_of(path, given)
        return Factor(path, text, None, None, law)
    if isinstance(given, int | float) and not isinstance(given, bool):
        given = [given]
    if not isinstance(given, Iterable) or isinstance(given, Mapping):
        raise _refusal(f"{path} = {given!r} are no values", path)
    return _of_values(path, [v.item() if isinstance(v, np.generic) else v for v in given])


def _read(path: str, text: str) -> Factor:
    call = _CALL.match(text)
    given = None if call is None else split_arguments(call[2])
    name = "" if call is None or given is None else call[1]
    # log(2) is a logarithm, and log(2), log(3) are two
    if given is not None and name in (*LAWS, "lin", "log") and (name, len(given)) != ("log", 1):
        return _called(path, text, name, given)
    if ".." in text:
        span, _, count = (word.strip() for word in text.rpartition(":"))
        low, _, high = (word.strip() for word in (span or count).partition(".."))
        return _between(path, text, "lin", low, high, count if span else "")
    words = split_arguments(text)
    if words is None or not any(words):
        raise _refusal(f"{path} = {text!r} varies nothing", path)
    parts = text.split(":")
    if len(words) == 1 and len(parts) == 3:
        return _stepped(path, text, *(part.strip() for part in parts))
    known = (*FUNCTIONS, *GATHER, "if", "pre")
    if call is not None and len(words) == 1 and given and call[1] not in known:
        raise _refusal(
            f"there is no distribution {call[1]!r}",
            path,
            did_you_mean(call[1], [*LAWS, "lin", "log"]),
        )
    return _of_values(path, list(words))


def _called(path: str, text: str, name: str, words: list[str]) -> Factor:
    if name in ("lin", "log") and len(words) in (2, 3):
        return _between(path, text, name, words[0], words[1], words[2] if words[2:] else "")
    if name in ("lin", "log"):
        raise _refusal(f"{text!r} is not {name}(LOW, HIGH, NUMBER)", path)
    law, dimension = law_of(path, text, name, words)
    return Factor(path, text, None, dimension, law)


def _between(path: str, text: str, way: str, low: str, high: str, count: str) -> Factor:
    """Return evenly spaced levels, or without a number of them what is between."""
    a, b, dimension = _ends(path, text, low, high)
    if way == "log" and not (a > 0.0 and b > 0.0):
        raise _refusal(f"no ratios lead from {low!r} to {high!r}", path, "both ends above zero")
    if not count:
        law, _ = law_of(path, text, "uniform" if way == "lin" else "loguniform", [repr(a), repr(b)])
        return Factor(path, text, None, dimension, law)
    number = _whole(path, text, count)
    levels = _even(a, b, number) if way == "lin" else _ratios(a, b, number)
    return Factor(path, text, levels, dimension)


def _even(a: float, b: float, number: int) -> Vector:
    if number > EXACT or number == 1:
        return np.linspace(a, b, number)
    low, high = Fraction(repr(a)), Fraction(repr(b))
    return np.array([float(low + (high - low) * k / (number - 1)) for k in range(number)])


def _ratios(a: float, b: float, number: int) -> Vector:
    if number == 1:
        return np.array([a])
    return np.geomspace(a, b, number)


def _stepped(path: str, text: str, low: str, high: str, step: str) -> Factor:
    """Return levels from low on, a step apart; decimals stay decimals."""
    a, b, dimension = _ends(path, text, low, high)
    by = try_quantity(step)
    if by is not None and by.dimension == DIMENSIONLESS and dimension is not None:
        by = try_quantity(f"{step} {_unit(high) or _unit(low)}")
    if by is None or by.dimension != (dimension or DIMENSIONLESS):
        raise _refusal(f"{text!r} is not LOW:HIGH:STEP", path)
    first, last, width = (Fraction(repr(x)) for x in (a, b, by.value))
    if width == 0 or (last - first) / width < 0:
        raise _refusal(f"no steps of {step} lead from {low} to {high}", path)
    number = int((last - first) / width + Fraction(1, 10**9)) + 1
    if number > LEVELS:
        raise _refusal(f"{text!r} has more than {LEVELS} levels", path)
    return Factor(
        path, text, np.array([float(first + k * width) for k in range(number)]), dimension
    )


def _of_values(path: str, values: Sequence[Any]) -> Factor:
    if not values:
        raise _refusal(f"{path} has no values", path)
    found: list[Quantity | None] = []
    for value in values:
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise _refusal(f"{path} = {value!r} is no value", path)
        try:
            number = None if isinstance(value, str) else Quantity(float(value), DIMENSIONLESS)
        except OverflowError:
            raise _refusal(f"a value of {path} is larger than a float can be", path) from None
        if number is not None and not math.isfinite(number.value):
            raise _refusal(f"{path} = {value!r} is not finite", path, "numbers")
        found.append(number or try_quantity(str(value)))
    text = ", ".join(v if isinstance(v, str) else repr(v) for v in values)
    numbers = [q for q in found if q is not None]
    if len(numbers) < len(values):
        return Factor(path, text, tuple(values))
    kinds = {q.dimension for q in numbers} - {DIMENSIONLESS}
    if len(kinds) > 1:
        raise _refusal(f"the values of {path} are not of one kind", path, "values in one unit")
    return Factor(path, text, np.array([q.value for q in numbers]), next(iter(kinds), None))


def _ends(path: str, text: str, low: str, high: str) -> tuple[float, float, Dimension | None]:
    a, b = try_quantity(low), try_quantity(high)
    if a is None or b is None:
        raise _refusal(f"{text!r} is no range", path)
    # "1..5 mm" is a range in mm
    if a.dimension == DIMENSIONLESS and _unit(high) and not _unit(low):
        a = parse_quantity(f"{low} {_unit(high)}")
    if b.dimension == DIMENSIONLESS and _unit(low) and not _unit(high):
        b = parse_quantity(f"{high} {_unit(low)}")
    if a.dimension != b.dimension:
        raise _refusal(f"{low!r} and {high!r} are not of one kind", path, "both ends in one unit")
    if not (math.isfinite(a.value) and math.isfinite(b.value)):
        raise _refusal(f"{text!r} has no ends", path)
    return a.value, b.value, None if a.dimension == DIMENSIONLESS else a.dimension


def _unit(text: str) -> str:
    return _NUMBER.sub("", text, count=1).strip()


def _whole(path: str, text: str, count: str) -> int:
    if not re.fullmatch(r"\d{1,9}", count.strip()) or not 1 <= int(count) <= LEVELS:
        raise _refusal(f"{count!r} in {text!r} is no number of levels", path)
    return int(count)


def _refusal(why: str, where: str, hint: str = "") -> UsageError:
    return UsageError(
        why,
        code="HB-P101",
        where=where,
        hint=hint or "0.2:0.3:0.005, log(1e-4, 1e-2, 50), '1 kg, 2 kg' or normal(0.2, 0.01)",
    )
