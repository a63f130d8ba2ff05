"""Points of a motion that are looked at, checked before the library reads them."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.engine.compiled.rows import Rows
from hybond.records import dataclass

Vector = NDArray[np.float64]
Numbers = NDArray[np.intc]


class PointsRecord(ctypes.Structure):
    """As `HybondPoints` in ``library.c``."""

    _fields_ = (
        ("many", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("t", "y", "accepted", "step")),
        *((name, ctypes.c_void_p) for name in ("step_time", "step_state", "step_dense")),
    )


@dataclass(frozen=True, slots=True)
class Points:
    """Points of a motion with their states.

    Raises
    ------
    ValueError
        For other shapes, or what is not finite.
    """

    t: Vector
    """Shape (points,). s."""
    y: Vector
    """Shape (points, states). Stored quantities, then integrated signals."""
    accepted: Numbers
    """Bool or array of bool, shape (points,). Which of the states are on the constraints of the
    mode already, as those are with which steps begin and end. The others are put back on them."""

    def __init__(self, t: ArrayLike, y: ArrayLike, *, accepted: ArrayLike = False) -> None:
        times, states = floats(t, 1, "t"), floats(y, 2, "y")
        if len(states) != len(times):
            raise ValueError(f"{len(states)} states at {len(times)} times")
        on = np.broadcast_to(np.asarray(accepted, dtype=bool), times.shape)
        object.__setattr__(self, "t", times)
        object.__setattr__(self, "y", states)
        object.__setattr__(self, "accepted", on.astype(np.intc))

    @property
    def states(self) -> int:
        """How many states there are."""
        return int(self.y.shape[1])

    def record(self, begin: int, end: int) -> PointsRecord:
        """Return points from `begin` to before `end` for the library."""
        places = {n: address(getattr(self, n)[begin:]) for n in ("t", "y", "accepted")}
        return PointsRecord(many=end - begin, **places)


@dataclass(frozen=True, slots=True)
class Steps:
    """Steps of a motion, one after the other, in one mode: rows of the log of a run.

    Raises
    ------
    ValueError
        For other shapes, what is not finite, or steps that do not go on in time.
    """

    time: Vector
    """Shape (steps, 3). Begin and end of the polynomial, and where the step was ended, s."""
    state: Vector
    """Shape (steps, 3, states). The state there."""
    dense: Vector
    """Shape (steps, 4, states). Coefficients of the polynomial ``y(t) = state[0] + dense[0] x + ...
    + dense[3] x**4``, with ``x = (t - time[0])/(time[1] - time[0])``."""

    def __init__(self, time: ArrayLike, state: ArrayLike, dense: ArrayLike) -> None:
        times, states = floats(time, 2, "time"), floats(state, 3, "state")
        terms = floats(dense, 3, "dense")
        many, n = len(times), states.shape[2]
        if times.shape != (many, 3) or states.shape != (many, 3, n) or terms.shape != (many, 4, n):
            raise ValueError("times, states and polynomials of steps do not belong together")
        t0, t1, t = times.T
        if not ((t0 < t1) & (t0 <= t) & (t <= t1)).all() or (t[1:] < t[:-1]).any():
            raise ValueError("a step ends before it begins, or beyond its polynomial")
        object.__setattr__(self, "time", times)
        object.__setattr__(self, "state", states)
        object.__setattr__(self, "dense", terms)

    @staticmethod
    def logged(time: Vector, state: Vector, dense: Vector) -> Steps:
        """Return steps of a log, which are as they should be, and may be many."""
        found = object.__new__(Steps)
        for name, rows in (("time", time), ("state", state), ("dense", dense)):
            object.__setattr__(found, name, np.ascontiguousarray(rows))
        return found

    @staticmethod
    def of(rows: Rows, which: slice = slice(None)) -> Steps:
        """Return some of the steps that a run wrote down."""
        return Steps(rows.step_time[which], rows.step_state[which], rows.step_dense[which])

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True, slots=True)
class Within:
    """Points within steps; where a step begins or was ended the state is the accepted one.

    Raises
    ------
    ValueError
        For other shapes, what is not finite, or a time outside its step.
    """

    steps: Steps
    t: Vector
    """Shape (points,). s."""
    step: Numbers
    """Shape (points,), optional. The step of each point; found if it is not given."""

    def __init__(self, steps: Steps, t: ArrayLike, step: ArrayLike | None = None) -> None:
        times = floats(t, 1, "t")
        if step is None:
            found = np.searchsorted(steps.time[:, 2], times, side="left").astype(np.intc)
        else:
            found = whole(step, "step").copy()
            if found.shape != times.shape:
                raise ValueError("step: a whole number for each point")
        if len(found) and not (found.min() >= 0 and found.max() < len(steps)):
            raise ValueError("a time outside the steps, or a step that there is not")
        if not ((steps.time[found, 0] <= times) & (times <= steps.time[found, 2])).all():
            raise ValueError("a time outside its step")
        object.__setattr__(self, "steps", steps)
        object.__setattr__(self, "t", times)
        object.__setattr__(self, "step", found)

    @property
    def states(self) -> int:
        """How many states there are."""
        return int(self.steps.state.shape[2])

    def record(self, begin: int, end: int) -> PointsRecord:
        """Return points from `begin` to before `end` for the library."""
        return PointsRecord(
            many=end - begin,
            t=address(self.t[begin:]),
            step=address(self.step[begin:]),
            step_time=address(self.steps.time),
            step_state=address(self.steps.state),
            step_dense=address(self.steps.dense),
        )


def address(a: NDArray[Any]) -> int:
    """Return where an array stands."""
    return int(a.ctypes.data)


def floats(a: ArrayLike, dimensions: int, name: str) -> Vector:
    """Return finite numbers as the library reads them.

    Raises
    ------
    ValueError
    """
    found = np.asarray(a, dtype=np.float64, order="C")
    if found.ndim != dimensions or not np.isfinite(found).all():
        raise ValueError(f"{name}: finite numbers in {dimensions} dimensions")
    return found


def whole(a: ArrayLike, name: str) -> Numbers:
    """Return whole numbers in a row as the library reads them.

    Raises
    ------
    ValueError
        For what is none, or would not fit.
    """
    found = np.asarray(a)
    if found.ndim != 1 or (found.size and found.dtype.kind not in "iu"):
        raise ValueError(f"{name}: whole numbers in a row")
    if found.size and not (found.min() >= -(2**31) and found.max() < 2**31):
        raise ValueError(f"{name}: out of range")
    return np.ascontiguousarray(found, dtype=np.intc)
