"""Signals that jump: a finite part and an impulse part, compared lexicographically.

At a jump a signal is ``impulse * delta + finite``. Pairs add; a pair times a factor that does not
jump scales both parts; comparisons, ``abs``, ``min``, ``max`` and ``sign`` look at the impulse
first. Anything else on an impulse has no meaning and is refused. Each value also carries the size
of the terms it was made of, because rounding is relative to these: a difference of two equal
velocities is zero, not 1e-17.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from hybond.errors import ModelError
from hybond.model.expressions import FLOATS, Algebra

ROUNDING = 1e-13
"""A difference below this part of its terms is rounding, hence zero."""
IMPULSE_RTOL = 1e-9
"""An impulse below this part of the largest one or stored quantity of its kind is zero."""


@dataclass(frozen=True, slots=True)
class Pair:
    """A value at a jump.

    Parameters
    ----------
    finite : float
        Right limit of the finite part.
    impulse : float
        Area of the impulse part.
    before : float
        The a priori value: a factor may scale an impulse only if it equals `finite`.
    size, impulse_size : float
        Magnitudes of the terms that made `finite` and `impulse`.
    """

    finite: float
    impulse: float
    before: float
    size: float
    impulse_size: float

    def __bool__(self) -> bool:
        return self.finite != 0.0

    @property
    def impulsive(self) -> bool:
        """Whether the impulse part is more than rounding."""
        return abs(self.impulse) > ROUNDING * self.impulse_size

    @property
    def sign(self) -> int:
        """-1, 0 or 1: the lexicographic sign."""
        if self.impulsive:
            return 1 if self.impulse > 0 else -1
        if abs(self.finite) > ROUNDING * self.size:
            return 1 if self.finite > 0 else -1
        if self.finite != self.finite:
            raise _meaningless("a comparison with a value that is not a number")
        return 0

    @property
    def steady(self) -> bool:
        """Whether the value is the same before and after."""
        return not self.impulsive and abs(self.finite - self.before) <= 1e-9 * max(
            self.size, abs(self.before)
        )


@dataclass(frozen=True, slots=True)
class Pairs:
    """All signals at one instant, then their a priori values; a `Pair` is made when it is read.

    Parameters
    ----------
    finite, before, impulse, size : sequence of float, shape (at least n,)
        See `Pair`; `size` has n entries, and entry ``n + k`` of the whole is ``before[k]``.
    """

    finite: Sequence[float]
    before: Sequence[float]
    impulse: Sequence[float]
    size: Sequence[float]

    def __len__(self) -> int:
        return 2 * len(self.size)

    def __getitem__(self, k: int) -> Pair:
        n = len(self.size)
        if k >= n:
            b = self.before[k - n]
            return Pair(b, 0.0, b, max(abs(b), self.size[k - n]), 0.0)
        p = self.impulse[k]
        return Pair(self.finite[k], p, self.before[k], self.size[k], abs(p))

    def __iter__(self) -> Iterator[Pair]:
        return (self[k] for k in range(len(self)))

    def prior(self) -> Pairs:
        """Return the a priori values, as if nothing had jumped."""
        return Pairs(self.before, self.before, [0.0] * len(self.size), self.size)


def steady(values: Sequence[float], size: Sequence[float]) -> Pairs:
    """Return signals that do not jump, with the sizes of the terms that made them."""
    return Pairs(values, values, [0.0] * len(size), size)


def still(value: float) -> Pair:
    """Return a value that does not jump."""
    value = float(value)
    return Pair(value, 0.0, value, abs(value), 0.0)


def _meaningless(what: str) -> ModelError:
    return ModelError(
        f"{what} has no meaning at a jump",
        code="HB-J101",
        hint="wrap the factor in pre(...), or compare impulses directly",
    )


def _add(a: Pair, b: Pair) -> Pair:
    return Pair(
        a.finite + b.finite,
        a.impulse + b.impulse,
        a.before + b.before,
        a.size + b.size,
        a.impulse_size + b.impulse_size,
    )


def _neg(a: Pair) -> Pair:
    return Pair(-a.finite, -a.impulse, -a.before, a.size, a.impulse_size)


def _sub(a: Pair, b: Pair) -> Pair:
    return _add(a, _neg(b))


def _scaled(a: Pair, factor: Pair, k: Callable[[float, float], float]) -> Pair:
    impulse = k(a.impulse, factor.finite) if a.impulsive else 0.0
    size = k(a.impulse_size, abs(factor.finite)) if a.impulsive else 0.0
    return Pair(
        k(a.finite, factor.finite),
        impulse,
        k(a.before, factor.before),
        k(a.size, abs(factor.finite)),
        abs(size),
    )


def _mul(a: Pair, b: Pair) -> Pair:
    if a.impulsive and b.impulsive:
        raise _meaningless("a product of two impulses")
    if b.impulsive:
        a, b = b, a
    if a.impulsive and not b.steady:
        raise _meaningless("an impulse times a factor that jumps")
    product = _scaled(a, b, operator.mul)
    return Pair(
        product.finite, product.impulse, product.before, a.size * b.size, product.impulse_size
    )


def _quotient(a: float, b: float) -> float:
    try:
        return a / b
    except ZeroDivisionError:
        return math.nan if a == 0.0 else math.copysign(math.inf, a)


def _div(a: Pair, b: Pair) -> Pair:
    if b.impulsive:
        raise _meaningless("a division by an impulse")
    if a.impulsive and not b.steady:
        raise _meaningless("an impulse divided by a factor that jumps")
    return _scaled(a, b, _quotient)


def _function(name: str) -> Callable[..., Pair]:
    plain = FLOATS.call[name]

    def f(*args: Pair) -> Pair:
        if any(a.impulsive for a in args):
            raise _meaningless(f"{name}() of an impulse")
        value = float(plain(*(a.finite for a in args)))
        before = float(plain(*(a.before for a in args)))
        return Pair(value, 0.0, before, abs(value), 0.0)

    return f


def _abs(a: Pair) -> Pair:
    return _neg(a) if a.sign < 0 else a


def _sign(a: Pair) -> Pair:
    return still(a.sign)


def _hypot(a: Pair, b: Pair) -> Pair:
    """``|(a, b)|``: along the impulse if there is one, which the finite part cannot turn."""
    p, q = (c.impulse if c.impulsive else 0.0 for c in (a, b))
    impulse = math.hypot(p, q)
    along = (a.finite * p + b.finite * q) / impulse if impulse else math.hypot(a.finite, b.finite)
    return Pair(
        along,
        impulse,
        math.hypot(a.before, b.before),
        math.hypot(a.size, b.size),
        math.hypot(a.impulse_size, b.impulse_size),
    )


def _min(*args: Pair) -> Pair:
    best = args[0]
    for a in args[1:]:
        best = a if _sub(a, best).sign < 0 else best
    return best


def _max(*args: Pair) -> Pair:
    return _neg(_min(*(_neg(a) for a in args)))


def _pow(a: Pair, b: Pair) -> Pair:
    if a.impulsive or b.impulsive:
        if not b.impulsive and b.finite == 1.0:
            return a
        raise _meaningless("a power of an impulse")
    return _function_pair(FLOATS.pow, a, b)


def _function_pair(plain: Callable[[float, float], float], a: Pair, b: Pair) -> Pair:
    value = float(plain(a.finite, b.finite))
    return Pair(value, 0.0, float(plain(a.before, b.before)), abs(value), 0.0)


def _compare(op: str) -> Callable[[Pair, Pair], bool]:
    test = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}.get(
        op, operator.eq if op == "==" else operator.ne
    )
    return lambda a, b: bool(test(_sub(a, b).sign, 0))


def _table(kind: Callable[..., Any]) -> Callable[..., Callable[[Pair], Pair]]:
    def make(x: Any, y: Any, extrapolate: str) -> Callable[[Pair], Pair]:
        plain = kind(x, y, extrapolate)

        def read(a: Pair) -> Pair:
            if a.impulsive:
                raise _meaningless("a table read at an impulse")
            value = float(plain(a.finite))
            return Pair(value, 0.0, float(plain(a.before)), abs(value), 0.0)

        return read

    return make


DIRAC = Algebra(
    add=_add,
    sub=_sub,
    mul=_mul,
    div=_div,
    pow=_pow,
    neg=_neg,
    compare=_compare,
    and_=lambda a, b: bool(a) and bool(b),
    or_=lambda a, b: bool(a) or bool(b),
    not_=operator.not_,
    where=lambda c, a, b: a if c else b,
    call={
        **{name: _function(name) for name in FLOATS.call},
        "abs": _abs,
        "sign": _sign,
        "hypot": _hypot,
        "min": _min,
        "max": _max,
    },
    const=lambda value: value if isinstance(value, bool) else still(value),
    table=_table(FLOATS.table),
    slope=_table(FLOATS.slope),
    lazy=True,
)
"""The algebra of pairs for `compile_expression`."""
