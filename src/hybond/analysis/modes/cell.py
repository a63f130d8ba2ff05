"""Convex cells of a state space, cut by linear programs; each keeps a point that lies inside.

`conditions` has them in words.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Kind = Literal["<", "<=", "="]

FLAT = 1e-10
"""A coefficient counts as zero below this part of the largest term of its row."""
SLACK = 1e-8
"""An open cell whose widest ball is smaller than this, in scaled units, counts as empty."""

CUTS = 25
"""Cuts for each linear program that is allowed."""
DIGITS = 6


@dataclass(frozen=True)
class Row:
    """``a @ x kind b``."""

    a: Vector
    b: float
    kind: Kind

    def __neg__(self) -> Row:
        """Return what holds where this does not; not for equalities."""
        return Row(-self.a, -self.b, "<" if self.kind == "<=" else "<=")


@dataclass
class Programs:
    """Counts linear programs, and refuses more than `most`.

    Parameters
    ----------
    scale : array, shape (variables,)
        A usual size of each variable.
    most : int
        Cuts may be that many times `CUTS`: most need no program.
    """

    scale: Vector
    most: int
    made: int = 0
    cuts: int = 0

    @property
    def spent(self) -> bool:
        """Whether no more may be solved."""
        return self.made >= self.most or self.cuts >= CUTS * self.most

    def inside(self, rows: tuple[Row, ...]) -> Vector | None:
        """Return a point well inside of the rows, None if there is none.

        Raises
        ------
        Spent
        """
        found = _ranges(rows, self.scale)
        if found is not None:
            return _between(*found, self.scale, small=False)
        if self.made >= self.most:
            raise Spent
        self.made += 1
        return _widest(rows, self.scale)

    def near(self, rows: tuple[Row, ...]) -> Vector | None:
        """Return a point inside of the rows whose variables are small, None if there is none."""
        found = _ranges(rows, self.scale)
        if found is not None:
            return _between(*found, self.scale, small=True)
        point = self.inside(rows)
        if point is None:
            return None
        self.made += 1
        return _small(rows, point, self.scale)


class Spent(Exception):
    """More linear programs are asked for than were allowed."""


@dataclass(frozen=True)
class Cell:
    """A convex part of the state space.

    Parameters
    ----------
    rows : tuple of Row
    point : array, shape (variables,)
        Inside of it.

    Examples
    --------
    >>> line = Programs(np.ones(1), 100)
    >>> whole = Cell((), np.zeros(1), line)
    >>> left = whole.cut(Row(np.ones(1), -1.0, "<"))
    >>> left is not None and float(left.point[0]) < -1.0
    True
    >>> left.cut(Row(-np.ones(1), 0.0, "<")) is None
    True
    """

    rows: tuple[Row, ...]
    point: Vector
    programs: Programs = field(repr=False)

    def cut(self, row: Row) -> Cell | None:
        """Return the part in which a row holds, None if there is none.

        Raises
        ------
        Spent
        """
        if self.programs.spent:
            raise Spent
        self.programs.cuts += 1
        scale = self.programs.scale
        size = float(np.max(np.abs(row.a * scale), initial=0.0))
        if size <= FLAT * abs(row.b) or size == 0.0:
            # a number beside a number
            holds = {"<": row.b > 0.0, "<=": row.b >= 0.0, "=": row.b == 0.0}[row.kind]
            return self if holds else None
        rows = (*self.rows, row)
        if row.kind != "=" and row.b - float(row.a @ self.point) > SLACK * size:
            return Cell(rows, self.point, self.programs)
        point = self.programs.inside(rows)
        return None if point is None else Cell(rows, point, self.programs)

    def halves(self, row: Row) -> Iterator[tuple[Cell, bool]]:
        """Yield the part in which a row holds, and the part in which it does not."""
        for own, holds in ((row, True), (-row, False)):
            part = self.cut(own)
            if part is not None:
                yield part, holds

    def needed(self) -> tuple[Row, ...]:
        """Return the rows that are not told by the others."""
        kept = list(self.rows)
        for row in self.rows:
            if row.kind == "=" or self.programs.spent:
                continue
            others = tuple(r for r in kept if r is not row)
            if len(others) < len(kept) and self.programs.inside((*others, -row)) is None:
                kept = list(others)
        return tuple(kept)


def _ranges(rows: tuple[Row, ...], scale: Vector) -> tuple[Vector, Vector, Vector] | None:
    """Return the range of each variable if no row joins two; whether it has to be an open one."""
    low, high = np.full(len(scale), -np.inf), np.full(len(scale), np.inf)
    strict = np.zeros(len(scale), dtype=bool)
    ends: dict[tuple[int, bool], list[tuple[float, bool]]] = {}
    for row in rows:
        places = np.flatnonzero(row.a)
        if len(places) > 1:
            return None
        if len(places) == 0:
            continue
        k = int(places[0])
        end = row.b / float(row.a[k])
        above = row.a[k] > 0.0
        if row.kind == "=" or above:
            ends.setdefault((k, True), []).append((end, row.kind == "<"))
        if row.kind == "=" or not above:
            ends.setdefault((k, False), []).append((end, row.kind == "<"))
    for (k, above), own in ends.items():
        end = min(e for e, _ in own) if above else max(e for e, _ in own)
        (high if above else low)[k] = end
        strict[k] |= any(s and e == end for e, s in own)
    return low, high, strict


def _between(
    low: Vector, high: Vector, strict: Vector, scale: Vector, *, small: bool
) -> Vector | None:
    """Return a point between ends, None if there is none; a small one if asked for."""
    room = (high - low) / scale
    if np.any(np.where(strict, room <= 2.0 * SLACK, room < 0.0)):
        return None
    point = np.zeros(len(scale))
    for k, (a, b, size) in enumerate(zip(low, high, scale, strict=True)):
        inside = min(0.5 * (b - a), 0.5 * float(size))
        if a > -inside:
            point[k] = 0.5 * (a + b) if b - a < size and not small else a + inside
        elif b < inside:
            point[k] = 0.5 * (a + b) if b - a < size and not small else b - inside
    return point


def _matrices(
    rows: tuple[Row, ...], scale: Vector
) -> tuple[list[Vector], list[float], list[bool], list[Vector], list[float]]:
    upper: list[Vector] = []
    bound: list[float] = []
    strict: list[bool] = []
    equal: list[Vector] = []
    level: list[float] = []
    for row in rows:
        a = row.a * scale
        size = float(np.max(np.abs(a), initial=0.0))
        if size == 0.0:
            continue
        if row.kind == "=":
            equal.append(a / size)
            level.append(row.b / size)
        else:
            upper.append(a / size)
            bound.append(row.b / size)
            strict.append(row.kind == "<")
    return upper, bound, strict, equal, level


def _widest(rows: tuple[Row, ...], scale: Vector) -> Vector | None:
    """Return a point with the largest slack in all inequalities; strict ones need some."""
    from scipy.optimize import linprog

    upper, bound, strict, equal, level = _matrices(rows, scale)
    n = len(scale)
    if not upper and not equal:
        return np.zeros(n)
    # the slack is asked of strict rows first: weak ones may leave none
    for asked in (np.ones(len(upper)), np.array(strict, dtype=float)):
        found = linprog(
            np.append(np.zeros(n), -1.0),
            A_ub=np.column_stack([np.array(upper), asked]) if upper else None,
            b_ub=bound or None,
            A_eq=np.column_stack([np.array(equal), np.zeros(len(equal))]) if equal else None,
            b_eq=level or None,
            bounds=[(None, None)] * n + [(0.0, 1.0)],
            method="highs",
            options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
        )
        if found.status == 0 and (found.x[-1] > SLACK or not any(strict)):
            return np.asarray(found.x[:n] * scale)
        if found.status == 0 and not (any(strict) and not all(strict)):
            return None
    return None


def _small(rows: tuple[Row, ...], point: Vector, scale: Vector) -> Vector:
    """Return a point inside with small variables, at half the slack of another or at one."""
    from scipy.optimize import linprog

    upper, bound, strict, equal, level = _matrices(rows, scale)
    n = len(scale)
    z = point / scale
    room = [
        min(b - float(a @ z), 1.0) / 2.0 if s else min(max(b - float(a @ z), 0.0), 1.0) / 2.0
        for a, b, s in zip(upper, bound, strict, strict=True)
    ]
    # |x| below s, the sum of all s least
    eye = np.eye(n)
    blocks = [np.hstack([eye, -eye]), np.hstack([-eye, -eye])]
    limits = [np.zeros(n), np.zeros(n)]
    if upper:
        blocks.append(np.hstack([np.array(upper), np.zeros((len(upper), n))]))
        limits.append(np.array(bound) - np.array(room))
    found = linprog(
        np.append(np.zeros(n), np.ones(n)),
        A_ub=np.vstack(blocks),
        b_ub=np.concatenate(limits),
        A_eq=np.hstack([np.array(equal), np.zeros((len(equal), n))]) if equal else None,
        b_eq=level or None,
        bounds=[(None, None)] * (2 * n),
        method="highs",
    )
    return np.asarray(found.x[:n] * scale) if found.status == 0 else point


def conditions(cell: Cell, names: Sequence[str]) -> tuple[str, ...]:
    """Return the rows of a cell that tell something, as conditions on named variables.

    Examples
    --------
    >>> import numpy as np
    >>> from hybond.analysis.modes.cell import Programs
    >>> line = Programs(np.ones(1), 100)
    >>> whole = Cell((), np.zeros(1), line)
    >>> part = whole.cut(Row(np.array([2.0]), 6.0, "<")).cut(Row(np.array([-1.0]), 1.0, "<="))
    >>> conditions(part, ["ball.p"])
    ('-1 <= ball.p < 3',)
    """
    bounds: dict[int, dict[str, Row]] = {}
    others: list[str] = []
    for row in cell.needed():
        places = np.flatnonzero(row.a)
        if len(places) != 1:
            others.append(_sum(row, names))
            continue
        k = int(places[0])
        side = "=" if row.kind == "=" else ("above" if row.a[k] > 0 else "below")
        bounds.setdefault(k, {})[side] = row
    told = [_bound(names[k], bounds[k], k) for k in sorted(bounds)]
    return tuple([*told, *others])


def _number(value: float) -> str:
    return f"{value + 0.0:.{DIGITS}g}"


def _bound(name: str, rows: dict[str, Row], k: int) -> str:
    value = {side: _number(row.b / float(row.a[k])) for side, row in rows.items()}
    if "=" in rows:
        return f"{name} = {value['=']}"
    if len(rows) == 2 and value["below"] == value["above"]:
        return f"{name} = {value['above']}"
    if len(rows) == 2:
        low, high = rows["below"].kind, rows["above"].kind
        return f"{value['below']} {low} {name} {high} {value['above']}"
    if "above" in rows:
        return f"{name} {rows['above'].kind} {value['above']}"
    return f"{name} {'>' if rows['below'].kind == '<' else '>='} {value['below']}"


def _sum(row: Row, names: Sequence[str]) -> str:
    """Return a row with a leading coefficient of one."""
    places = np.flatnonzero(row.a)
    lead = float(row.a[places[0]])
    terms: list[str] = []
    for k in places.tolist():
        c = float(row.a[k]) / lead
        size = "" if abs(abs(c) - 1.0) < 1e-12 else f"{_number(abs(c))}*"
        sign = (" - " if c < 0 else " + ") if terms else ("-" if c < 0 else "")
        terms.append(f"{sign}{size}{names[k]}")
    kind = row.kind
    if lead < 0 and kind != "=":
        kind_text = ">" if kind == "<" else ">="
    else:
        kind_text = kind
    return f"{''.join(terms)} {kind_text} {_number(row.b / lead)}"
