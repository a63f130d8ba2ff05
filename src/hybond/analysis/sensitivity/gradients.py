"""Slopes of many expressions by many names, at many points at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.model.expressions import (
    ARRAYS,
    Expr,
    Name,
    Number,
    Pre,
    compile_expression,
    differentiate,
    names,
    simplify,
    substitute,
)
from hybond.model.expressions.slots import PREFIX
from hybond.model.expressions.tree import transform

Vector = NDArray[np.float64]
Values = Mapping[str, Any]
"""Of names: a number, or an array of shape (points,)."""

PRIOR = "pre|"
RATE = "dw|"
AREA = "J|"
"""What names of a priori values, of rates of bond variables and of impulse areas begin with."""


def without_pre(e: Expr) -> Expr:
    """Return an expression in which a priori values have names of their own.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> str(without_pre(parse("x - 2*pre(x + 1)")))
    'x - 2*(pre|x + 1)'
    """

    def renamed(node: Expr) -> Expr:
        if not isinstance(node, Pre):
            return node
        return substitute(node.arg, {n: Name(PRIOR + n) for n in names(node.arg)})

    return transform(e, renamed)


class Compiled:
    """Expressions as functions of values by name."""

    def __init__(self, expressions: Sequence[Expr]) -> None:
        self.names = sorted(frozenset().union(*(names(e) for e in expressions)))
        index = {name: k for k, name in enumerate(self.names)}
        self._made: list[Callable[[Any], Any]] = [
            compile_expression(e, index, ARRAYS, pre_offset=0) for e in expressions
        ]

    def at(self, values: Values, points: int) -> Vector:
        """Return all values, shape (points, expressions)."""
        # a law that reads a priori values says nothing within a motion: its junction is OFF
        row = [
            np.asarray(values.get(name, 0.0) if name.startswith(PRIOR) else values[name], float)
            for name in self.names
        ]
        found = np.empty((points, len(self._made)))
        with np.errstate(all="ignore"):
            for k, f in enumerate(self._made):
                found[:, k] = f(row)
        return found


class Gradients:
    """The slopes of expressions by names.

    Attributes
    ----------
    steady : bool
        Whether no slope depends on anything but parameters.
    """

    def __init__(self, expressions: Sequence[Expr], by: Sequence[str]) -> None:
        column = {name: j for j, name in enumerate(by)}
        self.shape = len(expressions), len(by)
        self._places: list[tuple[int, int]] = []
        slopes: list[Expr] = []
        for i, e in enumerate(expressions):
            for name in sorted(names(e)):
                if name not in column:
                    continue
                slope = simplify(differentiate(e, name))
                if isinstance(slope, Number) and slope.value == 0.0:
                    continue
                self._places.append((i, column[name]))
                slopes.append(slope)
        self._slopes = Compiled(slopes)
        self.steady = all(n.startswith(PREFIX) for n in self._slopes.names)

    def at(self, values: Values, points: int) -> Vector:
        """Return the slopes, shape (points, expressions, names); one point if all are steady."""
        if self.steady:
            points = 1
        found = np.zeros((points, *self.shape))
        if self._places:
            rows, columns = zip(*self._places)
            found[:, rows, columns] = self._slopes.at(values, points)
        return found
