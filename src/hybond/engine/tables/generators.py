"""Functions of time that solve linear equations of their own, as what they drive then does.

A *term* is ``c m exp(rate t + shift)``: a complex factor, a monomial of names, an exponential.
Names are time and inputs, each a straight line between two timed events, or what is stored. Sums of
terms contain constants, ramps, polynomials, sines and exponentials of time, and their products;
what moves with time alone is closed under derivatives, all that the exponential of a matrix needs.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from hybond.engine.tables.expressions import number_of
from hybond.model.expressions import (
    And,
    Binary,
    Bool,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    Pre,
    Table,
    simplify,
)
from hybond.model.expressions.slots import plain, settled
from hybond.model.expressions.tree import fold, with_children
from hybond.records import dataclass

Matrix = NDArray[np.float64]
Key: TypeAlias = tuple[complex, float, tuple[str, ...]]
"""Rate and shift of the exponential, and the names of the monomial, sorted."""
Terms: TypeAlias = dict[Key, complex]
Found: TypeAlias = "Terms | str"
"""Terms, or the reason why there are none."""

OVERFLOWS = "a value that overflows"
SOLVED = "a source whose motion is solved exactly"
CONSTANT: Key = (0j, 0.0, ())
TIME: Key = (0j, 0.0, ("time",))
HIGHEST = 8
"""Degree of a monomial."""
WHILE = "at:"
"""How names of comparisons of time begin: 1 while they hold, else 0, between two timed events."""
UNLESS = "not at:"
"""How those of their opposites do."""


def constant(value: float) -> Terms:
    """Return a constant as terms."""
    return {CONSTANT: value} if value else {}


def of_name(path: str) -> Terms:
    """Return a name as terms."""
    return {(0j, 0.0, (path,)): 1.0}


def value_of(terms: Terms) -> float | None:
    """Return the value of terms that are constant, else None."""
    return terms.get(CONSTANT, 0.0).real if terms.keys() <= {CONSTANT} else None


def combined(parts: Iterable[tuple[complex, Terms]]) -> Terms:
    """Return a sum of terms with factors."""
    total: Terms = {}
    for factor, terms in parts:
        for key, c in terms.items():
            total[key] = total.get(key, 0.0) + factor * c
    return {key: c for key, c in total.items() if c}


def terms_of(e: Expr, known: Callable[[str], Found]) -> Found:
    """Return an expression as terms, or why it is none.

    Parameters
    ----------
    known : callable
        The terms of a name, or why it has none.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> terms_of(parse("2*time + 1"), of_name)
    {(0j, 0.0, ('time',)): 2.0, (0j, 0.0, ()): 1.0}
    >>> sorted(key[0].imag for key in terms_of(parse("sin(3*time)^2"), of_name))
    [-6.0, 0.0, 6.0]
    >>> terms_of(parse("sqrt(time)"), of_name)
    'sqrt of what varies'
    """

    def of(node: Expr, prior: bool, below: list[Found]) -> Found:
        if isinstance(node, Name):
            return "an a priori value" if prior else known(node.path)
        if isinstance(node, Number | Bool):
            return constant(number_of(node.value))
        if isinstance(node, If):
            return _chosen(below)
        reason = next((b for b in below if isinstance(b, str)), None)
        return reason or _of_node(node, [b for b in below if not isinstance(b, str)])

    found = fold(e, of)
    if isinstance(found, dict) and not all(map(_is_finite, found.values())):
        return OVERFLOWS
    return found


def _is_finite(c: complex) -> bool:
    return cmath.isfinite(complex(plain(c.real), plain(c.imag)))


def _chosen(below: list[Found]) -> Found:
    """Return the branch that is taken, if that never changes."""
    condition, then, orelse = below
    truth = value_of(condition) if isinstance(condition, dict) else None
    if truth is not None:
        return then if truth else orelse
    if not isinstance(condition, dict) or not _is_truth(condition):
        return "a condition that varies"
    if isinstance(then, str) or isinstance(orelse, str):
        return then if isinstance(then, str) else orelse
    chosen = _product(condition, then), _product(_otherwise(condition, orelse), orelse)
    refused = next((c for c in chosen if isinstance(c, str)), None)
    return refused or combined((1.0, c) for c in chosen if isinstance(c, dict))


def _is_truth(terms: Terms) -> bool:
    """Whether terms are made of comparisons of time: 0 or 1 between two timed events."""
    return all(not rate and not shift and _held(names) for rate, shift, names in terms)


def _held(names: tuple[str, ...]) -> bool:
    return all(name.startswith((WHILE, UNLESS)) for name in names)


def _otherwise(condition: Terms, orelse: Terms) -> Terms:
    """Return the opposite of a condition, as a factor of the other branch.

    An exponential that has yet to begin, or is over, may be beyond all others: less itself it would
    leave its rounding, so there the opposite is a factor that is zero. What else moves with time is
    taken off what it is all the time, which makes fewer generators.
    """
    if any(rate.real or shift for rate, shift, _ in orelse):
        return _opposite(condition)
    return combined([(1.0, constant(1.0)), (-1.0, condition)])


def _opposite(terms: Terms) -> Terms:
    """Return the opposite of a truth, as products of which no two are 1 at one time."""
    if any(c != 1.0 for c in terms.values()):
        return combined([(1.0, constant(1.0)), (-1.0, terms)])
    found = constant(1.0)
    for _, _, names in terms:
        # not a; a, but not b; a and b, but not c; ...
        parts: Terms = {
            (0j, 0.0, tuple(sorted((*names[:k], _turned(name))))): 1.0
            for k, name in enumerate(names)
        }
        both = _product(found, parts)
        if isinstance(both, str):
            return combined([(1.0, constant(1.0)), (-1.0, terms)])
        found = both
    return found


def _turned(name: str) -> str:
    return WHILE + name[len(UNLESS) :] if name.startswith(UNLESS) else f"not {name}"


def _connected(parts: list[Terms], *, every: bool) -> Found:
    """Return whether all, or any, of some truths hold."""
    found: Found = constant(1.0)
    for part in parts:
        if isinstance(found, str):
            return found
        found = _product(found, part if every else _opposite(part))
    return found if every or isinstance(found, str) else _opposite(found)


def _of_node(node: Expr, below: list[Terms]) -> Found:
    values = [value_of(b) for b in below]
    numbers = [v for v in values if v is not None]
    match node:
        case Pre():
            return below[0]
        case Neg():
            return combined([(-1.0, below[0])])
        case Binary("+"):
            return combined([(1.0, below[0]), (1.0, below[1])])
        case Binary("-"):
            return combined([(1.0, below[0]), (-1.0, below[1])])
        case Binary("*"):
            return _product(below[0], below[1])
        case Binary("/"):
            if values[1] is None or values[1] == 0.0:
                return "a division by what varies"
            return combined([(1.0 / values[1], below[0])])
        case Binary("^") if values[1] is not None and len(numbers) < len(below):
            return _power(below[0], values[1])
        case Call(function, _) if len(numbers) < len(below):
            return _wave(function, below[0]) if len(below) == 1 else f"{function} of what varies"
        case Not() | And() | Or() if len(numbers) < len(below) and all(map(_is_truth, below)):
            if isinstance(node, Not):
                return _opposite(below[0])
            return _connected(below, every=isinstance(node, And))
    if len(numbers) < len(below):
        return f"{_NAMES.get(type(node), 'an operation')} of what varies"
    return _constant_node(node, numbers)


_NAMES: dict[type[Expr], str] = {
    Binary: "a power",
    Compare: "a comparison",
    And: "a condition",
    Or: "a condition",
    Not: "a condition",
    Table: "a table",
}


def _constant_node(node: Expr, values: list[float]) -> Found:
    """Return a node all of whose arguments are constants."""
    if isinstance(node, And | Or):
        return constant(float(all(values) if isinstance(node, And) else any(values)))
    found = simplify(with_children(node, tuple(map(Number, values))))
    return constant(number_of(found.value)) if isinstance(found, Number | Bool) else OVERFLOWS


def _product(a: Terms, b: Terms) -> Found:
    found: Terms = {}
    for (rate, shift, one), c in a.items():
        for (other_rate, other_shift, other), d in b.items():
            if len(one) + len(other) > HIGHEST:
                return "a product of too many factors that vary"
            both = one + other
            truths = {n for n in both if n.startswith((WHILE, UNLESS))}
            if truths:
                # what is 0 or 1 is its own square, and with its opposite nothing
                if any(_turned(n) in truths for n in truths):
                    continue
                both = tuple(n for n in both if n not in truths) + tuple(truths)
            key = (rate + other_rate, shift + other_shift, tuple(sorted(both)))
            found[key] = found.get(key, 0.0) + c * d
    return {key: c for key, c in found.items() if c}


def _power(base: Terms, exponent: float) -> Found:
    if exponent not in range(HIGHEST + 1):
        return "a power that is no small whole number"
    found: Found = constant(1.0)
    for _ in range(int(exponent)):
        if isinstance(found, str):
            break
        found = _product(found, base)
    return found


def _wave(function: str, argument: Terms) -> Found:
    """Return sine, cosine or exponential of a straight line in time."""
    if function not in ("sin", "cos", "exp", "sinh", "cosh"):
        return f"{function} of what varies"
    if not argument.keys() <= {CONSTANT, TIME}:
        return f"{function} of what is no line in time"
    a, b = (settled(argument.get(key, 0.0).real, SOLVED) for key in (TIME, CONSTANT))
    if function in ("sin", "cos"):
        turned = cmath.exp(1j * b) / (2j if function == "sin" else 2.0)
        return {(a * 1j, 0.0, ()): turned, (-a * 1j, 0.0, ()): turned.conjugate()}
    if function == "exp":
        return {(complex(a), b, ()): 1.0 + 0j}
    falling = 0.5 if function == "cosh" else -0.5
    return {(complex(a), b, ()): 0.5 + 0j, (complex(-a), -b, ()): complex(falling)}


@dataclass(frozen=True, slots=True)
class Generators:
    """What drives a motion: ``g' = matrix g``, each a real function of time and inputs.

    A key with a rate off the real axis has two, the parts with cosine and sine.

    Parameters
    ----------
    place : dict
        Keys to the (first) place of each.
    expressions : tuple of Expr
        What each is at any time.
    matrix : array, shape (n, n)
    moving : array of bool, shape (n,)
        Which of them are no polynomials of time.
    """

    place: dict[Key, int]
    expressions: tuple[Expr, ...]
    matrix: Matrix
    moving: NDArray[np.bool_]

    def row(self, terms: Terms) -> dict[int, float]:
        """Return what terms are by generators: a factor of each, but for those that are zero."""
        row: dict[int, float] = {}
        for key, c in terms.items():
            k = self.place.get(key)
            if k is None:
                continue  # below the real axis: the other half of its pair stands for both
            if key[0].imag:
                row[k], row[k + 1] = 2.0 * c.real, -2.0 * c.imag
            else:
                row[k] = c.real
        return {k: c for k, c in row.items() if c}


def generators(wanted: Iterable[Key], rate_of: Callable[[str], str | None]) -> Generators:
    """Return all that some keys need.

    Parameters
    ----------
    wanted : iterable of Key
        None with what is stored.
    rate_of : callable
        The name of the slope of an input; None if it is constant.

    Examples
    --------
    >>> found = generators([(0j, 0.0, ("time", "time"))], lambda name: None)
    >>> [str(e) for e in found.expressions]
    ['1', 'time', 'time*time']
    >>> found.matrix.tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]
    """
    lower: dict[Key, list[Key]] = {}
    open_ = [key for key in wanted if key[0].imag >= 0.0]
    while open_:
        key = open_.pop()
        if key not in lower:
            lower[key] = _lower(key, rate_of)
            open_ += lower[key]
    keys = sorted(lower, key=lambda k: (k[0].real, k[0].imag, k[1], len(k[2]), k[2]))
    place: dict[Key, int] = {}
    expressions: list[Expr] = []
    moving: list[bool] = []
    for key in keys:
        place[key] = len(expressions)
        made = _expressions(key)
        expressions += made
        moving += [key[0] != 0.0] * len(made)
    matrix = np.zeros((len(expressions), len(expressions)))
    for key, k in place.items():
        rate = key[0]
        for part in range(2 if rate.imag else 1):
            matrix[k + part, k + part] += rate.real
            for other in lower[key]:
                matrix[k + part, place[other] + part] += 1.0
        if rate.imag:
            matrix[k, k + 1], matrix[k + 1, k] = -rate.imag, rate.imag
    return Generators(place, tuple(expressions), matrix, np.array(moving, dtype=bool))


def _lower(key: Key, rate_of: Callable[[str], str | None]) -> list[Key]:
    """Return the keys that the derivative of a monomial adds, one for each of its factors."""
    rate, shift, names = key
    found: list[Key] = []
    for k, name in enumerate(names):
        others = names[:k] + names[k + 1 :]
        if name == "time":
            found.append((rate, shift, others))
        elif (slope := rate_of(name)) is not None:
            found.append((rate, shift, tuple(sorted((*others, slope)))))
    return found


def _expressions(key: Key) -> list[Expr]:
    rate, shift, names = key
    factors = [_factor(name) for name in names]
    time = Name("time")
    if rate.real or shift:
        grows = Binary("+", Binary("*", Number(rate.real), time), Number(shift))
        factors.append(Call("exp", (grows,)))
    if not rate.imag:
        return [_times(factors)]
    turned = Binary("*", Number(rate.imag), time)
    return [_times([*factors, Call(f, (turned,))]) for f in ("cos", "sin")]


def _factor(name: str) -> Expr:
    if name.startswith(UNLESS):
        return Binary("-", Number(1.0), Name(_turned(name)))
    return Name(name)


def _times(factors: list[Expr]) -> Expr:
    if not factors:
        return Number(1.0)
    product = factors[0]
    for factor in factors[1:]:
        product = Binary("*", product, factor)
    return product
