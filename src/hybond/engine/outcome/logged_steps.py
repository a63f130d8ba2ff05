"""Steps of a run as its log has them, and the polynomials and segments that are made of them."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import overload

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.kept_rows import SharedRows, StateRows, joined_rows, joined_states
from hybond.engine.compiled.points import Steps as StepsToLook
from hybond.engine.outcome.polynomial import Polynomial
from hybond.records import dataclass
from hybond.runs.trace import Segment

Vector = NDArray[np.float64]
Root = tuple[float, list[float]]
"""A time, and bond variables then, of the solution of laws that a run followed."""


@dataclass(frozen=True, slots=True)
class Points:
    """What time-stepping tells besides: bond variables where steps end, energies of the steps.

    ``bonds[at[k]]`` are those at the end of step k, the row before those at its beginning.
    """

    bonds: Vector
    at: NDArray[np.intc]
    energy: Vector

    def part(self, first: int, last: int) -> Points:
        """Return those of the steps from `first` to `last` - 1."""
        begin = int(self.at[first]) - 1
        rows = self.bonds[begin : int(self.at[last - 1]) + 1]
        return Points(rows, self.at[first:last] - begin, self.energy[first:last])

    @staticmethod
    def joined(parts: Sequence[Points]) -> Points | None:
        """Return those of several slices as one."""
        if not parts:
            return None
        before = np.cumsum([0, *(len(p.bonds) for p in parts[:-1])])
        return Points(
            np.concatenate([p.bonds for p in parts]),
            np.concatenate([p.at + k for p, k in zip(parts, before.tolist(), strict=True)]),
            np.concatenate([p.energy for p in parts]),
        )


@dataclass(frozen=True, slots=True)
class Steps:
    """Steps in order; the columns are those of `Rows`."""

    time: Vector
    until: Vector
    state: StateRows
    dense: Vector
    place: NDArray[np.intc]
    points: Points | None = None
    """Of time-stepping."""

    def part(self, first: int, last: int) -> Steps:
        """Return the steps from `first` to `last` - 1."""
        k = slice(first, last)
        points = None if self.points is None else self.points.part(first, last)
        state = self.state
        state = state.part(first, last) if isinstance(state, SharedRows) else state[k]
        return Steps(self.time[k], self.until[k], state, self.dense[k], self.place[k], points)

    @staticmethod
    def joined(parts: Sequence[Steps]) -> Steps:
        """Return steps of several slices as one."""
        if len(parts) == 1:
            return parts[0]
        return Steps(
            joined_rows([p.time for p in parts]),
            joined_rows([p.until for p in parts]),
            joined_states([p.state for p in parts]),
            joined_rows([p.dense for p in parts]),
            joined_rows([p.place for p in parts]),
            Points.joined([p.points for p in parts if p.points is not None]),
        )


@dataclass(frozen=True, slots=True)
class Interpolants(Sequence[Callable[[float], Vector]]):
    """The polynomials of the steps from `first` to `last` - 1, made when asked for."""

    steps: Steps
    first: int
    last: int

    def __len__(self) -> int:
        return self.last - self.first

    @overload
    def __getitem__(self, k: int) -> Polynomial: ...

    @overload
    def __getitem__(self, k: slice) -> list[Polynomial]: ...

    def __getitem__(self, k: int | slice) -> Polynomial | list[Polynomial]:
        if isinstance(k, slice):
            return [self[j] for j in range(*k.indices(len(self)))]
        n = self.first + range(len(self))[k]
        t0, t1 = self.steps.time[n, :2].tolist()
        y0, y1, _ = self.steps.state[n]
        return Polynomial(t0, t1, y0, y1, self.steps.dense[n])


def steps_around(segment: Segment, t: Vector) -> tuple[StepsToLook, Vector]:
    """Return the steps in which times of a segment lie, and these."""
    made = segment.interpolants
    assert isinstance(made, Interpolants)
    times = np.asarray(t, dtype=float)
    first, last = 0, len(made)
    if len(times):
        # the first time is that of the state before the first step
        low, high = np.searchsorted(segment.t[1:], [times.min(), times.max()])
        first, last = int(low), min(int(high) + 1, last)
    steps, k = made.steps, slice(made.first + first, made.first + last)
    return StepsToLook.logged(steps.time[k], steps.state[k], steps.dense[k]), times


@dataclass(frozen=True, slots=True)
class Block:
    """Segments that are steps of one slice; made when asked for, by their number.

    Parameters
    ----------
    steps : Steps
    begins : array of int, shape (segments + 1,)
        The step with which each begins, and where the last ends.
    alone : array of bool, shape (segments,)
        Whether its bond variables are those of its mode: nothing is slid on, time is not stepped.
    make : callable
    """

    steps: Steps
    begins: NDArray[np.intp]
    alone: NDArray[np.bool_]
    make: Callable[[int], Segment]

    def __call__(self, k: int) -> Segment:
        """Return segment k."""
        return self.make(k)


def begin_later(steps: Steps, t: float) -> Steps:
    """Let the first step begin at a time within it: its polynomial is that of what is left."""
    t0, t1 = steps.time[0, :2].tolist()
    first = (t - t0) / (t1 - t0)
    left = 1.0 - first
    c = np.vstack([steps.state[0, 0], steps.dense[0]])
    powers = range(len(c))
    moved = [
        left**k * sum(math.comb(j, k) * first ** (j - k) * c[j] for j in powers if j >= k)
        for k in powers
    ]
    steps.time[0, 0] = t
    steps.dense[0] = moved[1:]
    state = steps.state
    if isinstance(state, SharedRows):
        return replace(steps, state=state.begun_at(np.asarray(moved[0])))
    state[0, 0] = moved[0]
    return steps


def roots_within(roots: Sequence[Root], segment: Segment) -> Sequence[Root]:
    """Return the points within a segment, and beside its ends, of the solution that a run told.

    Where one motion ends another begins: the last point that is there is the first of its own.
    """
    begin, end = float(segment.t[0]), float(segment.t[-1])
    first = max(bisect_right(roots, begin, key=_when) - 1, 0)
    last = bisect_left(roots, end, lo=first, key=_when) + 1
    own = roots[first:last]
    return own if own and own[0][0] <= end and own[-1][0] >= begin else []


def _when(root: Root) -> float:
    return root[0]
