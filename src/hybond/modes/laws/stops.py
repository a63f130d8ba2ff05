"""Where slip in the plane comes to its end.

The direction ``f / |f|`` has no limit that an integrator could step over: close to the end of slip
the speed falls to zero in a finite time, while the direction turns at a rate that goes with
``1/|f|``. So slip is left a little above zero, and the rest of the way is done in steps that fall
with the speed itself, each a fixed part of the time that is left: on a logarithmic scale the
motion is smooth. What remains then is below rounding, and is one step along a straight line. No
force is smoothed, and no speed is called zero before it is.

Slip may also pass rest closely and go on; then it is not at its end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.model.graph import Mode
from hybond.modes.laws.planar import Kept
from hybond.programs.interval import Interval
from hybond.programs.program import Program

Vector = NDArray[np.float64]
Field = Callable[[float, Vector], Vector]

LOW = 1e-4
"""Part of its largest speed at which slip is left to come to its end."""
FLOOR = 1e-7
"""The same of the largest speed that it ever had: slower ones are no better than tolerances."""
PART = 0.2
"""Part of the time that is left which one step takes."""
STRAIGHT = 0.999
"""The same while the direction does not turn."""
MOVES = 1e-3
"""Part of its largest value by which a velocity is moved to see how fast it does."""
ROUNDING = 1e-14
"""Part of the largest speed below which one straight step ends slip."""
OUTGROWN = 10.0
"""Slip has begun once it is this much faster than what its heading counts to."""
WEAK = 0.02
"""Part of the friction below which what is left to begin slip with is next to nothing."""
LONGER = 1e-5
"""Part of the speed that friction makes while the force grows by as much as friction, up to which
the heading then counts."""
SOON = 1e-7
"""Part of the run in which that growth is looked at."""
FROZEN = 1e30
"""Speed beside which any slip is nothing."""
CLOSE = 1e-9
"""Part of the largest speed within which slip that passes rest has come to rest."""
STEPS = 4000
"""Most steps of one descent."""


@dataclass(slots=True)
class Slip:
    """One planar friction: its velocity, and the largest speed since it began to slip, and ever."""

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


class Stops:
    """Ends of slip, for one program."""

    def __init__(self, program: Program, kept: Kept, until: float) -> None:
        self.program = program
        self.until = until
        self.slips = []
        for index, (heading, slow) in kept.places.items():
            law = program.graph.machines[index].law
            assert law is not None and law.second is not None
            x, y = program.compile(law.common), program.compile(law.second.common)
            self.slips.append(Slip(index, x, y, program.nx + heading, program.nx + slow))

    def armed(
        self, t: float, y: Vector, mode: Mode, interval: Interval, equations: ModeEquations
    ) -> Vector:
        """Return the state with the speeds from which slips are at their end, after a step."""
        slips = [p for p in self.slips if mode[p.machine]]
        if not slips:
            return y
        v = self.program.evaluate(t, y, interval, equations)
        new = y
        for slip in slips:
            speed = math.hypot(*slip.velocity(v))
            slip.largest = speed if y[slip.slow] < 0.0 else max(slip.largest, speed)
            slip.ever = max(slip.ever, speed)
            low = max(LOW * slip.largest, FLOOR * slip.ever)
            begun = speed > max(2.0 * low, -OUTGROWN * y[slip.slow])
            if begun and low > 4.0 * y[slip.slow]:
                new = y.copy() if new is y else new
                new[slip.slow] = low
        return new

    def begun(
        self, t: float, y: Vector, mode: Mode, interval: Interval, equations: ModeEquations
    ) -> Vector:
        """Return the state from which slip begins.

        Friction that breaks loose exactly at its limit has next to no force left to move with: at
        first its direction is that of the force, at a rate that no explicit method could follow
        and that no result depends on. There the heading counts a little longer.
        """
        new = y
        for slip in self.slips:
            if not mode[slip.machine] or y[slip.slow] >= 0.0:
                continue
            v = self.program.evaluate(t, y, interval, equations)
            if math.hypot(*slip.velocity(v)) <= -y[slip.slow]:
                slow = min(y[slip.slow], -self._weakly(slip, t, y, interval, equations))
                if slow != y[slip.slow]:
                    new = new.copy() if new is y else new
                    new[slip.slow] = slow
        return new

    def _weakly(
        self, slip: Slip, t: float, y: Vector, interval: Interval, equations: ModeEquations
    ) -> float:
        """Return the speed up to which the heading counts if slip begins with next to no force."""
        field = self.program.field(equations, interval)
        h = SOON * max(self.until - t, t)

        def push(t: float, y: Vector) -> Vector:
            """Return what the slip velocity gains in the time `h`."""
            later = y + h * field(t, y)
            before, after = (self.program.evaluate(t, z, interval, equations) for z in (y, later))
            return slip.velocity(after) - slip.velocity(before)

        frozen = y.copy()
        frozen[slip.slow] = -FROZEN
        back = frozen.copy()
        back[slip.heading] += math.pi
        now = push(t, frozen)
        friction = 0.5 * math.hypot(*(now - push(t, back)))
        if math.hypot(*now) > WEAK * friction:
            return 0.0
        grows = math.hypot(*(push(t + h, frozen + h * field(t, frozen)) - now)) / h
        lasts = self.until - t
        if grows > 0.0:
            lasts = min(lasts, friction / grows)
        return LONGER * friction / h * lasts

    def due(
        self, t: float, y: Vector, mode: Mode, interval: Interval, equations: ModeEquations
    ) -> Slip | None:
        """Return a slip that is slow enough to be led to its end."""
        slips = [p for p in self.slips if mode[p.machine] and y[p.slow] > 0.0]
        if not slips:
            return None
        v = self.program.evaluate(t, y, interval, equations)
        for slip in slips:
            if math.hypot(*slip.velocity(v)) <= y[slip.slow] * (1.0 + 1e-9):
                return slip
        return None

    def descend(
        self,
        slip: Slip,
        t: float,
        y: Vector,
        end: float,
        interval: Interval,
        equations: ModeEquations,
    ) -> tuple[float, Vector]:
        """Follow the motion to the end of slip, or past it, or to the time `end`."""
        field = self.program.field(equations, interval)
        y = y.copy()
        least = max(ROUNDING * slip.largest, 10.0 * float(np.finfo(float).tiny))

        def velocity(t: float, y: Vector) -> Vector:
            return slip.velocity(self.program.evaluate(t, y, interval, equations))

        f, rate = velocity(t, y), field(t, y)
        speed, left, hardest, ahead = math.hypot(*f), 0.0, 0.0, 0.0
        for _ in range(STEPS):
            f = velocity(t, y)
            speed = math.hypot(*f)
            rate = field(t, y)
            # a velocity follows what is stored smoothly: a difference gives its slope
            ahead = ahead or self._while(rate, y, velocity, t, f, slip)
            pull = (velocity(t + ahead, y + ahead * rate) - f) / ahead
            hardest = max(hardest, math.hypot(*pull))
            falls = -float(pull @ f) / speed if speed > 0.0 else 0.0
            if falls <= 0.0 and speed > CLOSE * slip.largest:
                y[slip.slow] = -least  # past the slowest point: slip goes on
                return t, y
            left = speed / falls if falls > 0.0 else 0.0
            if falls <= 0.0 or speed <= least or t + left == t:
                break
            across = math.sqrt(max(float(pull @ pull) - falls * falls, 0.0))
            straight = across * left <= ROUNDING * slip.largest
            h = STRAIGHT * left if straight else PART * speed / max(falls, 0.5 * hardest)
            h = min(h, end - t)
            y = _step(field, t, y, h, rate)
            t += h
            if t >= end:
                return end, y
        h = min(left, end - t)
        y = y + h * rate
        # at rest the law has the direction in which slip ended, until it is decided anew
        y[slip.heading], y[slip.slow] = math.atan2(f[1], f[0]), -max(10.0 * speed, least)
        return t + h, y

    @staticmethod
    def _while(
        rate: Vector,
        y: Vector,
        velocity: Callable[[float, Vector], Vector],
        t: float,
        f: Vector,
        slip: Slip,
    ) -> float:
        """Return a time in which the slip velocity moves by a small part of its largest value."""
        size = float(np.abs(rate).max(initial=0.0))
        h = 1e-6 * max(float(np.abs(y).max(initial=0.0)), slip.largest) / max(size, 1e-300)
        for _ in range(3):
            moved = math.hypot(*(velocity(t + h, y + h * rate) - f))
            if moved <= 0.0:
                break
            h *= MOVES * slip.largest / moved
        return h


def _step(field: Field, t: float, y: Vector, h: float, first: Vector) -> Vector:
    """Return the state a time `h` later (the classical method of order four)."""
    second = field(t + 0.5 * h, y + 0.5 * h * first)
    third = field(t + 0.5 * h, y + 0.5 * h * second)
    fourth = field(t + h, y + h * third)
    return np.asarray(y + h / 6.0 * (first + 2.0 * second + 2.0 * third + fourth))
