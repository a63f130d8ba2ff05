"""Guards over cells: what an expression is worth, case by case, as affine pairs.

A value is a pair of an impulse part and a finite part, each affine in the variables of a cell;
comparisons, ``abs``, ``min`` and ``max`` look at the impulse first (MB; see the semantics). Where
the truth differs within a cell, the cell is cut.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.modes.cell import FLAT, Cell, Kind, Row
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
    simplify,
    to_text,
)

Vector = NDArray[np.float64]


class NotAffine(Exception):
    """A guard or law is not affine, so that cells have no straight edges; the text says which."""


@dataclass(frozen=True)
class Pair:
    """``impulse·δ + finite``; each part is coefficients of the variables, then a constant."""

    impulse: Vector
    finite: Vector

    @classmethod
    def number(cls, value: float, many: int) -> Pair:
        """Return a number among so many variables."""
        finite = np.zeros(many + 1)
        finite[-1] = value
        return cls(np.zeros(many + 1), finite)

    def __add__(self, other: Pair) -> Pair:
        return Pair(self.impulse + other.impulse, self.finite + other.finite)

    def times(self, factor: float) -> Pair:
        """Return the pair times a number."""
        return Pair(factor * self.impulse, factor * self.finite)

    @property
    def constant(self) -> bool:
        """Whether it is a number."""
        return not self.impulse.any() and not self.finite[:-1].any()


Read = Callable[[str], Pair | bool]
"""What a canonical name is worth: a pair, or the truth of a flag."""


@dataclass(frozen=True)
class Values:
    """What names are worth after and before."""

    now: Read
    before: Read
    many: int
    """Variables of the cells."""


def truths(e: Expr, cell: Cell, at: Values) -> Iterator[tuple[Cell, bool]]:
    """Yield the parts of a cell with the truth of a guard in each; they do not overlap."""
    match e:
        case Bool():
            yield cell, e.value
        case Not():
            for part, holds in truths(e.arg, cell, at):
                yield part, not holds
        case And() | Or():
            yield from _joined(e.args, cell, at, decides=isinstance(e, Or))
        case If():
            for part, holds in truths(e.cond, cell, at):
                yield from truths(e.then if holds else e.orelse, part, at)
        case Compare():
            for part, left in values(e.left, cell, at):
                for piece, right in values(e.right, part, at):
                    yield from _compared(e.op, left + right.times(-1.0), piece)
        case Name():
            flag = at.now(e.path)
            if not isinstance(flag, bool):
                raise NotAffine(f"{e} as a condition")
            yield cell, flag
        case Pre():
            yield from truths(e.arg, cell, Values(at.before, at.before, at.many))
        case _:
            raise NotAffine(to_text(e))


def _joined(
    args: tuple[Expr, ...], cell: Cell, at: Values, *, decides: bool
) -> Iterator[tuple[Cell, bool]]:
    """Yield the truth of ``and`` (`decides` False) or ``or`` (True), argument by argument."""
    if not args:
        yield cell, not decides
        return
    for part, holds in truths(args[0], cell, at):
        if holds is decides:
            yield part, decides
        else:
            yield from _joined(args[1:], part, at, decides=decides)


def _compared(op: str, pair: Pair, cell: Cell) -> Iterator[tuple[Cell, bool]]:
    """Yield where ``pair op 0`` holds and where not: impulse first, finite part where it is 0."""
    if op in ("==", "!="):
        raise NotAffine(f"a comparison by {op}")
    sign = -1.0 if op in (">", ">=") else 1.0
    kind: Kind = "<" if op in ("<", ">") else "<="
    finite = _row(sign * pair.finite, kind)
    scale = cell.programs.scale
    if float(np.max(np.abs(pair.impulse * np.append(scale, 1.0)))) <= FLAT * _size(pair, scale):
        yield from cell.halves(finite)
        return
    below, above = _row(sign * pair.impulse, "<"), _row(-sign * pair.impulse, "<")
    for row, holds in ((below, True), (above, False)):
        part = cell.cut(row)
        if part is not None:
            yield part, holds
    edge = cell.cut(Row(below.a, below.b, "="))
    if edge is not None:
        yield from edge.halves(finite)


def _size(pair: Pair, scale: Vector) -> float:
    """Return what rounding of an impulse part is measured by."""
    return float(np.max(np.abs(pair.finite * np.append(scale, 1.0)), initial=0.0))


def _row(pair: Vector, kind: Kind) -> Row:
    return Row(pair[:-1], -float(pair[-1]), kind)


def values(e: Expr, cell: Cell, at: Values) -> Iterator[tuple[Cell, Pair]]:
    """Yield the parts of a cell with the value of an expression in each.

    Raises
    ------
    NotAffine
    """
    match e:
        case Number():
            yield cell, Pair.number(e.value, at.many)
        case Bool():
            yield cell, Pair.number(float(e.value), at.many)
        case Name():
            found = at.now(e.path)
            pair = Pair.number(float(found), at.many) if isinstance(found, bool) else found
            yield cell, pair
        case Pre():
            yield from values(e.arg, cell, Values(at.before, at.before, at.many))
        case Neg():
            for part, pair in values(e.arg, cell, at):
                yield part, pair.times(-1.0)
        case If():
            for part, holds in truths(e.cond, cell, at):
                yield from values(e.then if holds else e.orelse, part, at)
        case Binary():
            for part, left in values(e.left, cell, at):
                for piece, right in values(e.right, part, at):
                    yield piece, _binary(e, left, right, at.many)
        case Call(function="abs"):
            for part, pair in values(e.args[0], cell, at):
                for piece, holds in _compared(">=", pair, part):
                    yield piece, pair if holds else pair.times(-1.0)
        case Call(function="sign"):
            for part, pair in values(e.args[0], cell, at):
                for piece, above in _compared(">", pair, part):
                    for bit, below in _compared("<", pair, piece):
                        yield bit, Pair.number(float(above) - float(below), at.many)
        case Call(function="min" | "max"):
            yield from _extreme(e.args, cell, at, 1.0 if e.function == "max" else -1.0)
        case Call():
            yield from _constant_call(e, cell, at)
        case Compare() | And() | Or() | Not():
            for part, holds in truths(e, cell, at):
                yield part, Pair.number(float(holds), at.many)
        case _:
            raise NotAffine(to_text(e))


def _extreme(
    args: tuple[Expr, ...], cell: Cell, at: Values, sign: float
) -> Iterator[tuple[Cell, Pair]]:
    if len(args) == 1:
        yield from values(args[0], cell, at)
        return
    for part, best in _extreme(args[1:], cell, at, sign):
        for piece, pair in values(args[0], part, at):
            difference = (pair + best.times(-1.0)).times(sign)
            for bit, larger in _compared(">=", difference, piece):
                yield bit, pair if larger else best


def _binary(e: Binary, left: Pair, right: Pair, many: int) -> Pair:
    if e.op == "+":
        return left + right
    if e.op == "-":
        return left + right.times(-1.0)
    if e.op == "*" and right.constant:
        return left.times(float(right.finite[-1]))
    if e.op == "*" and left.constant:
        return right.times(float(left.finite[-1]))
    if e.op == "/" and right.constant and right.finite[-1] != 0.0:
        return left.times(1.0 / float(right.finite[-1]))
    if left.constant and right.constant:
        ends = Number(float(left.finite[-1])), Number(float(right.finite[-1]))
        return Pair.number(_folded(Binary(e.op, *ends), e), many)
    raise NotAffine(to_text(e))


def _constant_call(e: Call, cell: Cell, at: Values) -> Iterator[tuple[Cell, Pair]]:
    cases: list[tuple[Cell, tuple[Expr, ...]]] = [(cell, ())]
    for arg in e.args:
        more = []
        for part, done in cases:
            for piece, pair in values(arg, part, at):
                if not pair.constant:
                    raise NotAffine(to_text(e))
                more.append((piece, (*done, Number(float(pair.finite[-1])))))
        cases = more
    for part, args in cases:
        yield part, Pair.number(_folded(Call(e.function, args), e), at.many)


def _folded(e: Expr, told: Expr) -> float:
    found = simplify(e)
    if not isinstance(found, Number):
        raise NotAffine(to_text(told))
    return found.value
