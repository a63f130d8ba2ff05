"""Numbers written into the slots of a model: what follows from its parameters, in many at once."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.model.expressions import (
    ARRAYS,
    FOLDED,
    FUNCTIONS,
    Binary,
    Call,
    Expr,
    Table,
    compile_expression,
)
from hybond.model.expressions.slots import PREFIX, Slots, Slotted
from hybond.model.expressions.tree import walk
from hybond.records import dataclass

Vector = NDArray[np.float64]
AS_MADE = tuple(
    replace(a, call={f: call for f, call in a.call.items() if f in FUNCTIONS})
    for a in (FOLDED, ARRAYS)
)
"""Numbers and arrays as numbers of a model are folded: function by function, each as it is written.
Forms of `stable`, log1p(x) for log(x + 1), differ from them in the last bit."""
ROUNDED = ("abs", "sign", "min", "max", "sqrt", "floor", "ceil")
"""Functions that give the same bits wherever they are computed, as sums and products do."""


class Writing:
    """Expressions of the parameters of a model, for many members at once.

    Parameters
    ----------
    slots : Slots
        Of the model.
    wanted : sequence of Expr

    Examples
    --------
    >>> from hybond.model.expressions import Number
    >>> slots = Slots()
    >>> r = slots.follow("R", Number(2.0)).value
    >>> r > 0.0
    True
    >>> fits, found = Writing(slots, [(1/r).tree]).of({"R": np.array([4.0, -1.0, 0.5])}, 3)
    >>> fits.tolist(), found.tolist()
    ([True, False, True], [[0.25], [-1.0], [2.0]])
    """

    def __init__(self, slots: Slots, wanted: Sequence[Expr] = ()) -> None:
        self.parameters = list(slots.parameters.values())
        self.conditions = slots.conditions
        """More of them, when more is made of the model."""
        self.wanted = list(wanted)
        self._place = {PREFIX + p.path: k for k, p in enumerate(self.parameters)}
        self.plain: dict[int, object] = {}
        """Parts of graph and tables without slots, by their identity."""
        self._scalars: dict[Expr, Callable[[Sequence[float]], Any]] = {}

    def of(self, given: Mapping[str, Vector], many: int) -> tuple[NDArray[np.bool_], Vector]:
        """Return which members are made of the same parts, and of each what is wanted.

        Parameters
        ----------
        given : mapping of path to array, shape (members,)
            Parameters in SI; others are what they are made of, or as they were.
        many : int
            Members.
        """
        fits = np.ones(many, dtype=bool)
        columns: list[Vector] = []
        for p in self.parameters:
            if p.path in given:
                columns.append(given[p.path])
            elif p.made_of is not None:
                columns.append(self._column(p.made_of, columns, many))
            else:
                columns.append(np.full(many, p.start))
            fits &= np.isfinite(columns[-1])
        for condition in self.conditions:
            fits &= self._column(condition, columns, many) != 0.0
        found = np.empty((many, len(self.wanted)))
        for k, e in enumerate(self.wanted):
            found[:, k] = self._column(e, columns, many)
        return fits & np.isfinite(found).all(axis=1), found

    def _column(self, e: Expr, columns: list[Vector], many: int) -> Vector:
        if _is_rounded(e):
            value = compile_expression(e, self._place, AS_MADE[1], pre_offset=0)(columns)
            return np.broadcast_to(np.asarray(value, dtype=float), (many,))
        # as the model is made: functions of arrays may differ in the last bit
        scalar = self._scalar(e)
        if not columns:
            return np.full(many, float(scalar(())))
        return np.array([float(scalar(row)) for row in zip(*(c.tolist() for c in columns))])

    def row(self, given: Mapping[str, float]) -> list[float] | None:
        """Return all parameters of one member; None if it is made of other parts."""
        found: list[float] = []
        for p in self.parameters:
            if p.path in given:
                found.append(given[p.path])
            elif p.made_of is not None:
                found.append(float(self._scalar(p.made_of)(found)))
            else:
                found.append(p.start)
        return found if all(map(math.isfinite, found)) and self.fits(found) else None

    def fits(self, row: Sequence[float]) -> bool:
        """Whether a member with these parameters is made of the same parts, as far as is known."""
        return all(self._scalar(e)(row) for e in self.conditions)

    def value(self, e: Expr, row: Sequence[float]) -> float:
        """Return an expression of the parameters of one member."""
        return float(self._scalar(e)(row))

    def _scalar(self, e: Expr) -> Callable[[Sequence[float]], Any]:
        found = self._scalars.get(e)
        if found is None:
            found = self._scalars[e] = compile_expression(e, self._place, AS_MADE[0], pre_offset=0)
        return found


@dataclass(frozen=True, slots=True)
class Written:
    """One set of numbers for the slots of a model.

    Parameters
    ----------
    graph : Any
        The flat graph with slots.
    writing : Writing
    row : sequence of float
        All parameters.
    """

    graph: Any
    writing: Writing
    row: Sequence[float]

    def put(self, value: Any, *, stays: bool = False) -> Any:
        """Return a record, and what it is made of, with numbers where there are slots.

        What `stays`, as graph and tables do, is looked through once for parts without any.

        Raises
        ------
        ArithmeticError
            If one of the numbers is not finite.
        """
        if isinstance(value, Slotted):
            number = self.writing.value(value.tree, self.row)
            if not math.isfinite(number):
                raise ArithmeticError(f"{value.tree} is {number}")
            return number
        if isinstance(value, str | float | int) or id(value) in self.writing.plain:
            return value
        new = value
        if isinstance(value, tuple | list):
            parts = [self.put(v, stays=stays) for v in value]
            if not all(map(operator.is_, value, parts)):
                new = type(value)(parts)
        elif isinstance(value, dict):
            row = {k: self.put(v, stays=stays) for k, v in value.items()}
            if any(row[k] is not v for k, v in value.items()):
                new = row
        elif is_dataclass(value) and not isinstance(value, type):
            own = ((name, getattr(value, name)) for name in _names(type(value)))
            put = {name: (old, self.put(old, stays=stays)) for name, old in own}
            changed = {name: now for name, (old, now) in put.items() if now is not old}
            if changed:
                new = replace(value, **changed)
        if stays and new is value:
            self.writing.plain[id(value)] = value
        return new


@cache
def _names(kind: type) -> tuple[str, ...]:
    return tuple(f.name for f in fields(kind) if f.init)


def _is_rounded(e: Expr) -> bool:
    """Whether numbers and arrays give the same bits."""
    return not any(
        isinstance(node, Table)
        or (isinstance(node, Binary) and node.op == "^")
        or (isinstance(node, Call) and node.function not in ROUNDED)
        for node, _ in walk(e)
    )
