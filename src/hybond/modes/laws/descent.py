"""The last part of a slip in the plane, down to rest.

Close to rest the speed falls to zero in a finite time, while the direction turns at a rate that
goes with the friction over the speed. The rest of the way is done in steps that fall with the
speed itself: on a logarithmic scale the motion is smooth. Once the direction does not turn any
more it is held, and what remains is motion on a straight line. No force is smoothed, and no speed
is called zero before it is.

Each step is compared with two of half its length, like those of any other solver, and everything
else is watched on it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.errors import NumericsError
from hybond.solvers import Field, Step

Vector = NDArray[np.float64]

PART = 0.2
"""Part of the time in which the direction turns, or the speed is gone, which one step takes."""
STRAIGHT = 0.999
"""Part of the time that is left which one step takes where the direction does not turn."""
MOVES = 1e-3
"""Part of its largest value by which a velocity is moved to see how fast it does."""
ROUNDING = 1e-14
"""Part of the largest speed below which one straight step ends slip."""
CLOSE = 1e-9
"""Part of the largest speed within which slip that passes rest has come to rest."""
FROZEN = 1e30
"""Speed beside which any slip is nothing."""
STEPS = 20_000
"""Most steps of one descent."""
HALVINGS = 40
"""Most halvings of one step."""
WRONG = 1e-6
"""Part of its own change by which a step may be wrong."""
FINE = 1e-9
"""The same of what is stored."""
NOTHING = 1e-12
"""The same of the largest change of all."""


@dataclass(slots=True, eq=False)
class Slip:
    """One planar friction: its velocity, and the largest speed since it began to slip, and ever."""

    path: str
    machine: int
    x: Callable[[Sequence[float]], float]
    y: Callable[[Sequence[float]], float]
    heading: int
    slow: int
    largest: float = 0.0
    ever: float = 0.0

    def velocity(self, v: Sequence[float]) -> Vector:
        """Return the slip velocity, shape (2,)."""
        return np.array([self.x(v), self.y(v)])

    @property
    def least(self) -> float:
        """The speed below which one straight step is the rest of the way."""
        return max(ROUNDING * self.largest, 10.0 * float(np.finfo(float).tiny))


@dataclass(frozen=True, slots=True)
class _Approach:
    """How one slip comes to rest."""

    f: Vector
    speed: float
    falls: float
    left: float
    turns: float
    across: float

    def rests(self, t: float, slip: Slip) -> bool:
        """Whether one straight step is the rest of the way."""
        if self.falls <= 0.0 or self.speed <= slip.least:
            return True
        # or friction would stop it within the rounding of time
        return t + PART * self.speed / self.turns == t


class Descent:
    """Steps to the end of slips that have become slow.

    Parameters
    ----------
    field : callable
        Of the mode.
    values : callable
        All signals, by time and state.
    slips : list of Slip
        All that slip and may come to rest.
    """

    def __init__(
        self,
        field: Field,
        values: Callable[[float, Vector], Sequence[float]],
        slips: Sequence[Slip],
    ) -> None:
        self.field = field
        self.values = values
        self.waiting = list(slips)
        self.slips: list[Slip] = []
        self.resting: list[Slip] = []
        """What the last step has brought to rest."""
        self._steps = 0
        self._headings: dict[Slip, float] = {}
        self._ahead: dict[Slip, float] = {}

    def due(self, t: float, y: Vector) -> bool:
        """Whether any slip is slow enough; those that are belong to the descent from now on."""
        v = self.values(t, y)
        for slip in list(self.waiting):
            if math.hypot(*slip.velocity(v)) <= y[slip.slow] * (1.0 + FINE):
                self.waiting.remove(slip)
                self.slips.append(slip)
        return bool(self.slips)

    def step(self, t: float, y: Vector, end: float) -> Step | None:
        """Return the next step, None if no slip is on its way to rest any more.

        Raises
        ------
        NumericsError
            HB-N408 if the end of a slip is not found.
        """
        self.due(t, y)
        self._steps += 1
        rate = self.field(t, y)
        found = {slip: self._approach(slip, t, y, rate) for slip in self.slips}
        for slip, a in list(found.items()):
            if a.falls <= 0.0 and a.speed > CLOSE * slip.largest:
                # past the slowest point: slip goes on
                y[slip.slow] = -slip.least
                self.slips.remove(slip)
                del found[slip]
        if not found:
            return None
        if self._steps > STEPS:
            raise self._endless(t, self.slips)
        at_rest = [slip for slip, a in found.items() if a.rests(t, slip)]
        if at_rest:
            h = min(min(found[slip].left for slip in at_rest), end - t)
            for slip in at_rest:
                f = found[slip].f
                self._headings[slip] = math.atan2(f[1], f[0])
            self.resting = at_rest if t + h < end or t + h == t else []
            return _line(t, y, h, rate)
        if all(a.across * a.left <= ROUNDING * slip.largest for slip, a in found.items()):
            held = y
            for slip, a in found.items():
                held = frozen(held, slip, math.atan2(a.f[1], a.f[0]))
            h = STRAIGHT * min(a.left for a in found.values())
        else:
            held = y
            h = PART * min(a.speed / max(a.falls, a.turns) for a in found.values())
        return self._controlled(t, y, held, min(h, end - t))

    def ended(self, t: float, y: Vector) -> Vector:
        """Return the state at the end of the descent, wherever that is."""
        y = y.copy()
        v = self.values(t, y)
        for slip in self.slips:
            speed = math.hypot(*slip.velocity(v))
            if slip in self.resting:
                # the law has the direction in which slip ended, until it is decided anew
                y[slip.heading] = self._headings[slip]
                y[slip.slow] = -max(10.0 * speed, slip.least)
            else:
                y[slip.slow] = 0.5 * speed
        return y

    def _approach(self, slip: Slip, t: float, y: Vector, rate: Vector) -> _Approach:
        f = slip.velocity(self.values(t, y))
        speed = math.hypot(*f)
        # a velocity follows what is stored smoothly: a difference gives its slope
        ahead = self._ahead.get(slip) or self._while(slip, t, y, f, rate)
        self._ahead[slip] = ahead

        def gained(rate: Vector) -> Vector:
            return slip.velocity(self.values(t + ahead, y + ahead * rate))

        pull = (gained(rate) - f) / ahead
        angle = math.atan2(f[1], f[0])
        ways = [self.field(t, frozen(y, slip, a)) for a in (angle, angle + math.pi)]
        friction = 0.5 * math.hypot(*(gained(ways[0]) - gained(ways[1]))) / ahead
        falls = -float(pull @ f) / speed if speed > 0.0 else 0.0
        across = abs(float(pull[0] * f[1] - pull[1] * f[0])) / speed if speed > 0.0 else 0.0
        left = speed / falls if falls > 0.0 else 0.0
        return _Approach(f, speed, falls, left, max(friction, math.hypot(*pull)), across)

    def _while(self, slip: Slip, t: float, y: Vector, f: Vector, rate: Vector) -> float:
        """Return a time in which the slip velocity moves by a small part of its largest value."""
        size = float(np.abs(rate).max(initial=0.0))
        h = 1e-6 * max(float(np.abs(y).max(initial=0.0)), slip.largest) / max(size, 1e-300)
        for _ in range(3):
            moved = math.hypot(*(slip.velocity(self.values(t + h, y + h * rate)) - f))
            if moved <= 0.0:
                break
            h *= MOVES * slip.largest / moved
        return h

    def _controlled(self, t: float, y: Vector, held: Vector, h: float) -> Step:
        """Return a step of at most `h` that agrees with two of half its length.

        `held` is `y` with what is held on the way: directions.
        """
        field = self.field
        own = np.flatnonzero(held != y)
        first = field(t, held)
        for _ in range(HALVINGS):
            whole = _runge_kutta(field, t, held, h, first)
            middle = _runge_kutta(field, t, held, 0.5 * h, first)
            second = field(t + 0.5 * h, middle)
            halves = _runge_kutta(field, t + 0.5 * h, middle, 0.5 * h, second)
            apart = np.abs(halves - whole)
            change = np.abs(h * first)
            allowed = WRONG * change + FINE * np.abs(held) + NOTHING * change.max(initial=0.0)
            if (apart <= allowed).all():
                end = halves + (halves - whole) / 15.0
                last = field(t + h, end)
                end[own] = y[own]
                return _curve(t, y, h, end, first, last)
            h *= 0.5
        raise self._endless(t, self.slips)

    @staticmethod
    def _endless(t: float, slips: Sequence[Slip]) -> NumericsError:
        return NumericsError(
            f"the end of this slip is not found, from t = {t:.9g} s on",
            code="HB-N408",
            where=", ".join(s.path for s in slips),
            hint="what drives it is within a hair of the limit, or a law has no value near rest",
        )


def frozen(y: Vector, slip: Slip, angle: float) -> Vector:
    """Return the state with the direction of slip held."""
    held = y.copy()
    held[slip.heading], held[slip.slow] = angle, -FROZEN
    return held


def _runge_kutta(field: Field, t: float, y: Vector, h: float, first: Vector) -> Vector:
    """Return the state a time `h` later (the classical method of order four)."""
    second = field(t + 0.5 * h, y + 0.5 * h * first)
    third = field(t + 0.5 * h, y + 0.5 * h * second)
    fourth = field(t + h, y + h * third)
    return np.asarray(y + h / 6.0 * (first + 2.0 * second + 2.0 * third + fourth))


def _line(t: float, y: Vector, h: float, rate: Vector) -> Step:
    return _curve(t, y, h, y + h * rate, rate, rate)


def _curve(t0: float, y0: Vector, h: float, y1: Vector, first: Vector, last: Vector) -> Step:
    """Return a step with Hermite's cubic as dense output."""
    t1 = t0 + h

    def at(t: float | Vector) -> Vector:
        s = (np.asarray(t) - t0) / h
        a, b, p, q = (c if s.ndim == 0 else c[:, None] for c in (y0, y1, first, last))
        bend = (1.0 - 2.0 * s) * (b - a) + h * ((s - 1.0) * p + s * q)
        found = (1.0 - s) * a + s * b + s * (s - 1.0) * bend
        for mark, value in ((0.0, a), (1.0, b)):
            found = np.where(s == mark, value, found)
        return np.asarray(found)

    return Step(t0, t1, y0, y1, at, float("nan"), 0, 0)
