"""How everything in a mode changes with its state, with time and with parameters.

    r_w dw + r_x dx + r_t dt + r_p dp = 0          dw by dx, dt, dp: one linear solve per point
    d(x') = rates_w dw + rates_x dx + rates_t dt + rates_p dp

where storage follows other storage, r_w is singular: the rows then keep dx on their constraints,
and what they leave open of dw follows from their time derivatives along the motion,

    r_w dw' + (r_w)' dw + d(r_x x' + r_t) = 0      one more unknown dw', solved together

Every r_w is the derivative of a law as it is written; nothing is a difference.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.gradients import AREA, PRIOR, RATE, Compiled, Gradients
from hybond.analysis.sensitivity.mode_rows import ModeRows
from hybond.analysis.sensitivity.solving import (
    NO_SLOPE,
    Undetermined,
    open_ways,
    opens,
    rank_of,
    smallest,
    solved,
)
from hybond.analysis.sensitivity.steep import BESIDE, NOTHING, limits
from hybond.model.expressions import Expr

Vector = NDArray[np.float64]
Steep = NDArray[np.bool_]

LEAST = 1e-6
"""Part of currents by which their sum of squares may change along what is open, and be least."""


@dataclass(frozen=True, slots=True)
class Columns:
    """What is differentiated by: states, then time, then parameters, then a priori values.

    Parameters
    ----------
    states : list of str
    inputs : int
    parameters : list of str
    """

    states: list[str]
    inputs: int
    parameters: list[str]

    @property
    def time(self) -> int:
        """Where the column of time stands."""
        return len(self.states)

    @property
    def many(self) -> int:
        """Columns without those of a priori values."""
        return len(self.states) + 1 + len(self.parameters)


@dataclass(frozen=True, slots=True)
class At:
    """Values at points, and how inputs follow parameters there.

    Parameters
    ----------
    values : mapping
        Of every canonical name and ``p:path``: shape (points,), or a number.
    inputs : array, shape (points, inputs, parameters)
    points : int
    """

    values: Mapping[str, Vector | float]
    inputs: Vector
    points: int

    def some(self, which: slice) -> At:
        """Return the values at some of the points."""
        values = {n: v[which] if isinstance(v, np.ndarray) else v for n, v in self.values.items()}
        return At(values, self.inputs[which], len(self.inputs[which]))


class Direct:
    """What expressions change with directly, bond variables held."""

    def __init__(self, expressions: Sequence[Expr], columns: Columns) -> None:
        u = [f"u:{k}" for k in range(columns.inputs)]
        self._columns = columns
        self._own = Gradients(expressions, [*columns.states, "time", *columns.parameters])
        self._inputs = Gradients(expressions, u)

    def at(self, at: At) -> Vector:
        """Return the slopes by states, time, parameters, shape (points, expressions, columns)."""
        found = self._own.at(at.values, at.points)
        if self._inputs._places:
            by_u = self._inputs.at(at.values, at.points)
            rates = [
                np.broadcast_to(np.asarray(at.values[f"du:{k}"], dtype=float), (at.points,))
                for k in range(self._columns.inputs)
            ]
            found = np.repeat(found, at.points, axis=0) if len(found) < at.points else found
            n = self._columns.time
            found[:, :, n] += np.einsum("...ru,u...->...r", by_u, np.array(rates))
            found[:, :, n + 1 :] += by_u @ at.inputs
        return found


class Tangent:
    """The equations of a mode, differentiated."""

    def __init__(self, rows: ModeRows, columns: Columns) -> None:
        self.rows, self.columns = rows, columns
        self._by_w = Gradients(rows.rows, rows.bonds)
        self._direct = Direct(rows.rows, columns)
        self._rates = Read(self, rows.rates)
        prior = sorted(
            n.removeprefix(PRIOR)
            for n in frozenset().union(*(Compiled([e]).names for e in rows.rows))
            if n.startswith(PRIOR)
        )
        self.prior = prior
        """What is read a priori: an impact, which is no motion."""
        self._by_prior = Gradients(rows.rows, [PRIOR + n for n in prior])
        self._full: bool | None = None
        self._rank: int | None = None
        self._more = _More()

    def anew(self) -> Tangent:
        """Return the same equations, of which no number is known yet."""
        found = copy.copy(self)
        found._full = found._rank = None
        return found

    @property
    def of_entry(self) -> OfEntry:
        """The slopes of what an entry into the mode keeps to."""
        if self._more.entry is None:
            self._more.entry = OfEntry(self)
        return self._more.entry

    def slopes(self, at: At) -> tuple[Vector, Vector]:
        """Return the slopes of the rows by open bond variables, and by all columns."""
        by_w, steep = self._own(at.values, at.points)
        direct = self._direct.at(at)
        if steep.any():
            direct = np.array(np.broadcast_to(direct, (at.points, *direct.shape[1:])))
            for k, i in np.argwhere(steep & ~np.isfinite(direct).all(axis=2)).tolist():
                if not self._vanishes(at, i, int(np.argmax(by_w[k, i]))):
                    raise Undetermined(NO_SLOPE)
            direct[steep] = 0.0
        # a root at its end has no slope: who needs it is refused, and nobody is warned beside that
        with np.errstate(invalid="ignore"):
            return by_w @ self.rows.spread, direct

    def _own(self, values: Mapping[str, Vector | float], points: int) -> tuple[Vector, Steep]:
        """Return the slopes of rows by bond variables, and which rows are those of steep laws.

        A law that rises without bound says that what it is steep in does not change (`steep`).

        Raises
        ------
        Undetermined
            Where that contradicts the mode, which moves it.
        """
        by_w = self._by_w.at(values, points)
        steep: Steep = np.zeros(by_w.shape[:2], dtype=bool)
        if np.isfinite(by_w).all():
            return by_w, steep
        by_w = limits(self._by_w, self.rows.bonds, values, by_w)
        held = ~self.rows.spread.any(axis=1)
        by_w[:, :, held] = np.where(np.isinf(by_w[:, :, held]), 0.0, by_w[:, :, held])
        inf = np.isinf(by_w)
        steep = np.asarray(inf.any(axis=2) & ~np.isnan(by_w).any(axis=2))
        by_w[steep] = inf[steep]
        for k in np.flatnonzero(steep.any(axis=1)).tolist():
            own = by_w[k] @ self.rows.spread
            if own.shape[0] != own.shape[1] or rank_of(own) < own.shape[1]:
                raise Undetermined(NO_SLOPE)
        return by_w, steep

    def _vanishes(self, at: At, i: int, j: int) -> bool:
        """Whether what else a steep law changes with is nothing beside its slope, in the limit."""
        near = At({**at.values, self.rows.bonds[j]: BESIDE[0]}, at.inputs, at.points)
        steep = self._by_w.at(near.values, at.points)[:, i, j, None]
        with np.errstate(all="ignore"):
            parts = np.abs(self._direct.at(near)[:, i] / steep)
        return bool((parts <= NOTHING).all())

    def rank(self, at: At) -> int:
        """Return how many open bond variables the rows determine, at the first point."""
        if self._rank is None:
            self._rank = rank_of(self._own(at.values, at.points)[0][0] @ self.rows.spread)
        return int(self._rank - self.rows.spread.shape[1])

    def free(self, values: Mapping[str, Vector | float]) -> bool:
        """Whether the mode holds no state: its rows determine all bond variables, and only them.

        Parameters
        ----------
        values : mapping
            At a point; of parameters alone where nothing else is read.
        """
        if self._full is None:
            by_w = self._own(values, 1)[0][0] @ self.rows.spread
            self._full = by_w.shape[0] == by_w.shape[1] == rank_of(by_w)
        return self._full

    def leaves_open(self, at: At, rows: Vector) -> bool:
        """Whether a mode leaves open what rows of bond variables say, at the first point.

        Parameters
        ----------
        rows : array, shape (many, 2 * bonds)
        """
        first = at.some(slice(0, 1))
        by_w = self._own(first.values, 1)[0] @ self.rows.spread
        if self._full or by_w.shape[1] == by_w.shape[2] == rank_of(by_w[0]):
            return False
        if self._more.second is None:
            self._more.second = _Second(self)
        left, _ = self._more.second.left(first, by_w)
        whole = np.zeros((len(rows), left.shape[2]))
        whole[:, : by_w.shape[2]] = rows @ self.rows.spread
        return opens(left[0], whole)

    def shared(self, at: At, bonds: Vector, asked: Vector) -> Vector | None:
        """Return how bond variables change where diodes share what the rows leave open.

        They share it with the least sum of squares, as runs do. None where that does not tell what
        is asked, or where a diode that would take less than nothing has none of it.

        Parameters
        ----------
        at : At
            At one point.
        bonds : array, shape (1, 2 * bonds, columns)
        asked : array, shape (many, 2 * bonds)
            Sums of bond variables.
        """
        by_w = self._own(at.values, at.points)[0] @ self.rows.spread
        if self._more.second is None:
            self._more.second = _Second(self)
        left, _ = self._more.second.left(at, by_w)
        ways = self.rows.spread @ open_ways(left[0])[: by_w.shape[2]]
        carried = self.rows.carried
        own = ways[carried]
        if not carried or opens(own, asked @ ways):
            return None
        names = self.rows.bonds
        there = np.array([float(np.ravel(at.values[names[k]])[0]) for k in carried])
        if np.abs(own.T @ there).max(initial=0.0) > LEAST * np.linalg.norm(there):
            return None
        less = np.linalg.lstsq(own, -bonds[0, carried], rcond=None)[0]
        return np.asarray(bonds + ways @ less)

    @property
    def alike(self) -> bool:
        """Whether what the mode holds is read from parameters alone."""
        return self._by_w.steady

    def by_prior(self, at: At) -> Vector:
        """Return the slopes of the rows by what they read a priori."""
        return self._by_prior.at(at.values, at.points)

    def bonds(self, at: At) -> Vector:
        """Return how bond variables change, shape (points or 1, 2 * bonds, columns).

        Raises
        ------
        Undetermined
            Where the mode leaves open what moves its states.
        """
        by_w, direct = self.slopes(at)
        if self._full is None:
            self._full = by_w.shape[1] == by_w.shape[2] == rank_of(by_w[0])
        if self._full:
            return self.rows.spread @ solved(by_w, -direct)
        if self._more.second is None:
            self._more.second = _Second(self)
        return self.rows.spread @ self._more.second.bonds(at, by_w, direct)

    def rates(self, at: At, bonds: Vector) -> Vector:
        """Return how the rates of states change, shape (points or 1, states, columns)."""
        return self._rates.at(at, bonds)


class Read:
    """How expressions of a mode change."""

    def __init__(self, tangent: Tangent, expressions: Sequence[Expr]) -> None:
        self._tangent = tangent
        self._by_w = Gradients(expressions, tangent.rows.bonds)
        self._direct = Direct(expressions, tangent.columns)

    def at(self, at: At, bonds: Vector) -> Vector:
        """Return the slopes by all columns, shape (points or 1, expressions, columns)."""
        return self._by_w.at(at.values, at.points) @ bonds + self._direct.at(at)

    def is_open(self, at: At) -> bool:
        """Whether a mode leaves open one of the expressions, at the first point."""
        rows = self.asked(at)
        return bool(rows.any()) and self._tangent.leaves_open(at, rows)

    def asked(self, at: At) -> Vector:
        """Return the slopes by bond variables at the first point."""
        return np.asarray(self._by_w.at(at.some(slice(0, 1)).values, 1)[0])

    def terms(self, at: At) -> Vector:
        """Return how large expressions were if all efforts and flows were as the largest ones.

        At one point, shape (expressions,).
        """
        names = self._tangent.rows.bonds
        size = np.abs([float(np.ravel(at.values[n])[0]) for n in names]).reshape(2, -1)
        largest = np.repeat(size.max(axis=1, initial=0.0), size.shape[1])
        return np.asarray(np.abs(self._by_w.at(at.values, 1)[0]) @ largest)


@dataclass
class _More:
    """What a mode is asked for now and then; made once."""

    second: _Second | None = None
    entry: OfEntry | None = None


class OfEntry:
    """Slopes of rates of storage by bond variables, and of rows of impulse areas."""

    def __init__(self, tangent: Tangent) -> None:
        rows = tangent.rows
        self.moves = Gradients(rows.rates[: len(rows.graph.storages)], rows.bonds)
        self.by_area = Gradients(rows.areas, [AREA + name for name in rows.bonds])
        self.by_bonds = Gradients(rows.areas, rows.bonds)
        self.direct = Direct(rows.areas, tangent.columns)


class _Second:
    """Rows together with their time derivatives, where these are needed."""

    def __init__(self, tangent: Tangent) -> None:
        rows, columns = tangent.rows, tangent.columns
        self._spread = rows.spread
        self._rate_names = [RATE + n for n in rows.bonds]
        along = rows.along(rows.rows)
        self._drift = Compiled(rows.along_held(rows.rows))
        self._by_w = Gradients(along, rows.bonds)
        self._direct = Direct(along, columns)
        self._moves = Gradients(rows.rates, rows.bonds)

    def left(self, at: At, by_w: Vector) -> tuple[Vector, At]:
        """Return the matrices of the unknowns dw and dw', and values with rates in them."""
        drift = self._drift.at(at.values, at.points)
        moving = self._spread @ smallest(by_w, -drift[:, :, None])
        more = At(
            {**at.values, **dict(zip(self._rate_names, moving[:, :, 0].T, strict=True))},
            at.inputs,
            at.points,
        )
        second = self._by_w.at(more.values, at.points) @ self._spread
        rows, n = by_w.shape[1:]
        left = np.zeros((max(len(by_w), len(second)), 2 * rows, 2 * n))
        left[:, :rows, :n] = by_w
        left[:, rows:, :n] = second
        left[:, rows:, n:] = by_w
        return left, more

    def bonds(self, at: At, by_w: Vector, direct: Vector) -> Vector:
        left, more = self.left(at, by_w)
        own = self._direct.at(more)
        rows, n = by_w.shape[1:]
        points = max(len(direct), len(left), len(own))
        right = np.zeros((points, 2 * rows, direct.shape[2]))
        right[:, :rows], right[:, rows:] = direct, own
        moves = np.zeros((self._moves.shape[0], 2 * n))
        moves[:, :n] = self._moves.at(at.values, at.points)[0] @ self._spread
        if opens(left[0], moves):
            raise Undetermined("the mode leaves open how its states move")
        return smallest(left, -right)[:, :n]


__all__ = ["At", "Columns", "Direct", "Read", "Tangent", "Undetermined"]
