"""What the operations of the language mean: on floats, on arrays.

An `Algebra` is a table of functions; `compile` builds closures over one of them.
"""

from __future__ import annotations

import math
import operator
import sys
from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

from hybond.model.expressions.turns import exact_cos, exact_sin, exact_tan
from hybond.records import dataclass

Closure = Callable[[Any], Any]
Points = tuple[float, ...]


def same(value: Any) -> Any:
    """Return the value: what an algebra does where there is nothing to do."""
    return value


@dataclass(frozen=True, slots=True)
class Algebra:
    """What the operations of the language mean on one kind of value.

    No operation may raise on floats out of range; an algebra of other values may refuse, and then
    the closure passes its exception on.
    """

    add: Callable[[Any, Any], Any]
    sub: Callable[[Any, Any], Any]
    mul: Callable[[Any, Any], Any]
    div: Callable[[Any, Any], Any]
    pow: Callable[[Any, Any], Any]
    neg: Callable[[Any], Any]
    """`add`, `sub`, `mul`, `div`, `pow` and `neg`: arithmetic."""
    compare: Callable[[str], Callable[[Any, Any], Any]]
    """``compare(op)`` returns the function of two values for ``"<"``, ``"<="``, ``">"``, ``">="``,
    ``"=="`` or ``"!="``."""
    and_: Callable[[Any, Any], Any]
    or_: Callable[[Any, Any], Any]
    not_: Callable[[Any], Any]
    """`and_`, `or_` and `not_`: logic of two values (one for `not_`). A value may be a number:
    nonzero is true."""
    where: Callable[[Any, Any, Any], Any]
    """``where(c, a, b)``, `a` where `c` is true, else `b`."""
    call: Mapping[str, Callable[..., Any]]
    """From each name of `FUNCTIONS` to its function. Where those of `stable` are beside them,
    `compile_expression` takes forms in which nothing on the way overflows."""
    const: Callable[[float], Any]
    """The value of a Python float or bool of the text."""
    table: Callable[[Points, Points, str], Closure]
    slope: Callable[[Points, Points, str], Closure]
    """`table` and `slope`: ``table(x, y, extrapolate)`` returns the function of one value that
    reads the table; `slope` likewise reads the slope of its segments."""
    pre: Callable[[Any], Any] = same
    """Applied to every value read inside `Pre`."""
    lazy: bool = False
    """Values are single and have a truth value: `if`, `and` and `or` evaluate only what they need,
    and `where`, `and_` and `or_` are not called."""
    wrap: Callable[[Closure], Closure] = same
    """Applied once to the finished closure."""


def _quiet(exact: Callable[..., float], ufunc: Callable[..., Any]) -> Callable[..., float]:
    """Return `exact`, with NumPy's nan or infinity where the function of `math` raises."""

    def total(*args: float) -> float:
        try:
            return exact(*args)
        except (ValueError, OverflowError, ZeroDivisionError):
            with np.errstate(all="ignore"):
                return float(ufunc(*[float(a) for a in args]))

    return total


def _div(a: float, b: float) -> float:
    try:
        return a / b
    except ZeroDivisionError:
        if a != a or a == 0.0:
            return math.nan
        return math.copysign(math.inf, a) * math.copysign(1.0, b)


def _least(*args: float) -> float:
    low = args[0]
    for a in args[1:]:
        if a < low or a != a:
            low = a
    return low


def _most(*args: float) -> float:
    high = args[0]
    for a in args[1:]:
        if a > high or a != a:
            high = a
    return high


def _sign(a: float) -> float:
    return 1.0 if a > 0.0 else -1.0 if a < 0.0 else abs(a) * 0.0


def _segment(x: Points, at: float, extrapolate: str) -> int:
    """Return the index of the segment that holds `at`, or -1 where there is none."""
    if at != at or (extrapolate == "error" and not x[0] <= at <= x[-1]):
        return -1
    return min(max(bisect_right(x, at) - 1, 0), len(x) - 2)


def _slopes(x: Points, y: Points) -> list[float]:
    return [(y[k + 1] - y[k]) / (x[k + 1] - x[k]) for k in range(len(x) - 1)]


def _table(x: Points, y: Points, extrapolate: str) -> Callable[[float], float]:
    slopes = _slopes(x, y)

    def read(at: float) -> float:
        k = _segment(x, at, extrapolate)
        if k < 0:
            return math.nan
        # from the nearer point: beside one at zero no digit is lost
        near = k + (x[k + 1] - at < at - x[k])
        return y[near] + slopes[k] * (at - x[near])

    return read


def _slope(x: Points, y: Points, extrapolate: str) -> Callable[[float], float]:
    slopes = _slopes(x, y)

    def read(at: float) -> float:
        k = _segment(x, at, extrapolate)
        return slopes[k] if k >= 0 else math.nan

    return read


def _segments(x: Any, at: Any, extrapolate: str) -> tuple[Any, Any]:
    outside = np.isnan(at)
    if extrapolate == "error":
        outside |= (at < x[0]) | (at > x[-1])
    return np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2), outside


def _table_arrays(x: Points, y: Points, extrapolate: str) -> Closure:
    xs, ys, slopes = np.array(x), np.array(y), np.array(_slopes(x, y))

    def read(at: Any) -> Any:
        k, outside = _segments(xs, at, extrapolate)
        near = k + (xs[k + 1] - at < at - xs[k])
        return np.where(outside, np.nan, ys[near] + slopes[k] * (at - xs[near]))

    return read


def _slope_arrays(x: Points, y: Points, extrapolate: str) -> Closure:
    xs, slopes = np.array(x), np.array(_slopes(x, y))

    def read(at: Any) -> Any:
        k, outside = _segments(xs, at, extrapolate)
        return np.where(outside, np.nan, slopes[k])

    return read


_COMPARE: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}

_UFUNC: dict[str, Callable[..., Any]] = {
    **{f: getattr(np, f) for f in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log")},
    **{f: getattr(np, f) for f in ("log10", "sqrt", "sign", "floor", "ceil", "hypot", "mod")},
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "abs": np.abs,
}


_MOST = math.log(sys.float_info.max)
_BELOW = 64.0 * sys.float_info.epsilon


# the engine has the same functions, to the last bit, in the language that it is translated from
def _softplus(a: float) -> float:
    return max(a, 0.0) + math.log1p(math.exp(-abs(a)))


def _log_cosh(a: float) -> float:
    size = abs(a)
    if size < 1.0:
        half = math.sinh(0.5 * size)
        return math.log1p(2.0 * half * half)
    return size + (math.log1p(math.exp(-2.0 * size)) - math.log(2.0))


def _exp_less_one(a: float) -> float:
    return math.inf if a > _MOST else math.expm1(a)


def _log_beside_one(a: float) -> float:
    return math.log1p(a) if a > -1.0 else -math.inf if a == -1.0 else math.nan


def _cleared(a: float, size: float) -> float:
    return 0.0 if 0.0 > a >= -_BELOW * size > -math.inf else a


def _cleared_arrays(a: Any, size: Any) -> Any:
    least = -_BELOW * np.asarray(size, dtype=np.float64)
    return np.where((a < 0.0) & (a >= least) & np.isfinite(least), 0.0, a)


def _softplus_arrays(a: Any) -> Any:
    return np.logaddexp(0.0, a, dtype=np.float64)


def _log_cosh_arrays(a: Any) -> Any:
    size = np.abs(a, dtype=np.float64)
    near = np.log1p(2.0 * np.sinh(0.5 * np.minimum(size, 1.0)) ** 2)
    return np.where(size < 1.0, near, size + (np.log1p(np.exp(-2.0 * size)) - math.log(2.0)))


def _real(ufunc: Callable[..., Any]) -> Callable[..., Any]:
    # bool - bool is an error in NumPy and bool + bool is `or`: a comparison counts as 0 or 1.
    return lambda *args: ufunc(*args, dtype=np.float64)


def _fold(ufunc: Callable[[Any, Any], Any]) -> Callable[..., Any]:
    def folded(*args: Any) -> Any:
        value = args[0]
        for a in args[1:]:
            value = ufunc(value, a)
        return value

    return folded


def _no_warnings(f: Closure) -> Closure:
    def quiet(v: Any) -> Any:
        with np.errstate(all="ignore"):
            return f(v)

    return quiet


FLOATS = Algebra(
    add=operator.add,
    sub=operator.sub,
    mul=operator.mul,
    div=_div,
    pow=_quiet(math.pow, np.power),
    neg=operator.neg,
    compare=_COMPARE.__getitem__,
    and_=lambda a, b: bool(a) and bool(b),
    or_=lambda a, b: bool(a) or bool(b),
    not_=operator.not_,
    where=lambda c, a, b: a if c else b,
    call={
        **{
            f: _quiet(getattr(math, f), _UFUNC[f])
            for f in _UFUNC
            if f not in ("abs", "sign", "floor", "ceil", "mod")
        },
        "abs": math.fabs,
        "sign": _sign,
        "floor": _quiet(lambda a: float(math.floor(a)), np.floor),
        "ceil": _quiet(lambda a: float(math.ceil(a)), np.ceil),
        "mod": _quiet(operator.mod, np.mod),
        "min": _least,
        "max": _most,
        "softplus": _softplus,
        "log_cosh": _log_cosh,
        "expm1": _exp_less_one,
        "log1p": _log_beside_one,
        "cleared": _cleared,
    },
    const=same,
    table=_table,
    slope=_slope,
    lazy=True,
)
"""Python floats: lazy, and nan or an infinity where the mathematics has no value."""


def _turned(function: Callable[..., float], exact: Callable[[float], float | None]) -> Closure:
    """Return a function of an angle that is exact where that is a known part of a turn."""

    def of(angle: float) -> float:
        known = exact(angle)
        return function(angle) if known is None else known

    return of


_EXACT = {"sin": exact_sin, "cos": exact_cos, "tan": exact_tan}
FOLDED = replace(
    FLOATS, call={**FLOATS.call, **{f: _turned(FLOATS.call[f], g) for f, g in _EXACT.items()}}
)
"""The same where numbers of a model are folded: angles that are parts of a turn are exact."""

ARRAYS = Algebra(
    add=_real(np.add),
    sub=_real(np.subtract),
    mul=_real(np.multiply),
    div=_real(np.true_divide),
    pow=_real(np.power),
    neg=_real(np.negative),
    compare=_COMPARE.__getitem__,
    and_=np.logical_and,
    or_=np.logical_or,
    not_=np.logical_not,
    where=lambda c, a, b: np.where(np.not_equal(c, 0), a, b),
    call={
        **{f: _real(ufunc) for f, ufunc in _UFUNC.items()},
        "min": _fold(np.minimum),
        "max": _fold(np.maximum),
        "softplus": _softplus_arrays,
        "log_cosh": _log_cosh_arrays,
        "expm1": _real(np.expm1),
        "log1p": _real(np.log1p),
        "cleared": _cleared_arrays,
    },
    const=cast("Callable[[float], Any]", np.asarray),
    table=_table_arrays,
    slope=_slope_arrays,
    wrap=_no_warnings,
)
"""NumPy arrays, elementwise; the same values as `FLOATS`."""
