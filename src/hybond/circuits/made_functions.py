"""Functions of other simulators, written with those that models have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from hybond.model.expressions import Binary, Call, Compare, Expr, If, Number


def _whole(x: Expr) -> Expr:
    """Return a number without what is behind its point."""
    return Binary("*", Call("sign", (x,)), Call("floor", (Call("abs", (x,)),)))


def _rounded(x: Expr) -> Expr:
    return Call("floor", (Binary("+", x, Number(0.5)),))


def _signed_power(x: Expr, y: Expr) -> Expr:
    """Return a power of the magnitude, with the sign."""
    return Binary("*", Call("sign", (x,)), Binary("^", Call("abs", (x,)), y))


def _is_true(x: Expr) -> Expr:
    """Return 1 for what is above one half, as gates of LTspice see it."""
    return If(Compare(">", x, Number(0.5)), Number(1.0), Number(0.0))


def _is_false(x: Expr) -> Expr:
    return If(Compare(">", x, Number(0.5)), Number(0.0), Number(1.0))


def _asinh(x: Expr) -> Expr:
    """Return the inverse of sinh, for large numbers of either sign alike."""
    size = Call("abs", (x,))
    root = Call("sqrt", (Binary("+", Binary("*", x, x), Number(1.0)),))
    return Binary("*", Call("sign", (x,)), Call("log", (Binary("+", size, root),)))


def _acosh(x: Expr) -> Expr:
    root = Call("sqrt", (Binary("-", Binary("*", x, x), Number(1.0)),))
    return Call("log", (Binary("+", x, root),))


def _atanh(x: Expr) -> Expr:
    parts = Binary("/", Binary("+", Number(1.0), x), Binary("-", Number(1.0), x))
    return Binary("*", Number(0.5), Call("log", (parts,)))


MADE: Final[Mapping[str, tuple[int, Callable[..., Expr]]]] = {
    "int": (1, _whole),
    "round": (1, _rounded),
    "pwrs": (2, _signed_power),
    "buf": (1, _is_true),
    "inv": (1, _is_false),
    "asinh": (1, _asinh),
    "acosh": (1, _acosh),
    "atanh": (1, _atanh),
}
"""Of how many arguments each is, and how it is written."""
