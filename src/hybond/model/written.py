"""Numbers written into the slots of a model: what follows from its parameters, in many at once."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.model.expressions import (
    ARRAYS,
    FLOATS,
    Binary,
    Call,
    Expr,
    Table,
    compile_expression,
)
from hybond.model.expressions.slots import PREFIX, Slots, Slotted
from hybond.model.expressions.tree import walk

Vector = NDArray[np.float64]
ROUNDED = ("abs", "sign", "min", "max", "sqrt", "floor", "ceil")
"""Functions that give the same bits wherever they are computed, as sums and products do."""


class Writing:
    """Expressions of the parameters of a model, for many members at once.

    Parameters
    ----------
    slots : Slots
        Of the model; nothing more is asked of them.
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
        self.conditions = list(slots.conditions)
        self.wanted = list(wanted)
        self._place = {PREFIX + p.path: k for k, p in enumerate(self.parameters)}
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
            value = compile_expression(e, self._place, ARRAYS, pre_offset=0)(columns)
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
        fits = all(map(math.isfinite, found))
        return found if fits and all(self._scalar(e)(found) for e in self.conditions) else None

    def value(self, e: Expr, row: Sequence[float]) -> float:
        """Return an expression of the parameters of one member."""
        return float(self._scalar(e)(row))

    def _scalar(self, e: Expr) -> Callable[[Sequence[float]], Any]:
        found = self._scalars.get(e)
        if found is None:
            found = self._scalars[e] = compile_expression(e, self._place, FLOATS, pre_offset=0)
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

    def number(self, x: Any) -> float:
        """Return a number that may be slotted as it is with these parameters."""
        return self.writing.value(x.tree, self.row) if isinstance(x, Slotted) else x

    def put(self, value: Any) -> Any:
        """Return a record, and what it is made of, with numbers where there are slots."""
        if isinstance(value, Slotted):
            return self.number(value)
        if isinstance(value, tuple | list):
            new = [self.put(v) for v in value]
            return value if all(map(operator.is_, value, new)) else type(value)(new)
        if isinstance(value, dict):
            row = {k: self.put(v) for k, v in value.items()}
            return value if all(row[k] is v for k, v in value.items()) else row
        if is_dataclass(value) and not isinstance(value, type):
            kinds = _kept_fields(type(value))
            changed = {}
            for name in kinds:
                old = getattr(value, name)
                now = self.put(old)
                if now is not old:
                    changed[name] = now
            return replace(value, **changed) if changed else value
        return value


@cache
def _kept_fields(kind: type) -> tuple[str, ...]:
    return tuple(f.name for f in fields(kind) if f.init)


def _is_rounded(e: Expr) -> bool:
    """Whether numbers and arrays give the same bits."""
    return not any(
        isinstance(node, Table)
        or (isinstance(node, Binary) and node.op == "^")
        or (isinstance(node, Call) and node.function not in ROUNDED)
        for node, _ in walk(e)
    )
