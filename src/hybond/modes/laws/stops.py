"""Where slip in the plane comes to its end.

The direction ``f / |f|`` has no limit that an integrator could step over. So slip is left a little
above zero, and led to its end by steps of its own (`descent`).

Slip may also pass rest closely and go on; then it is not at its end.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.model.planar_friction import TINY
from hybond.modes.laws.descent import CLOSE, Descent, Slip, frozen
from hybond.modes.laws.planar import Kept
from hybond.programs.program import Program
from hybond.solvers import Step

Vector = NDArray[np.float64]

LOW = 1e-4
"""Part of its largest speed at which slip is left to come to its end."""
COARSE = 300.0
"""The same in tolerances of the solver."""
HIGHEST = 0.3
"""The same at any tolerance: slip must have begun before it can end."""
FLOOR = 1e-7
"""The same of the largest speed that it ever had: slower ones are no better than tolerances."""
OUTGROWN = 10.0
"""Slip has begun once it is this much faster than what its heading counts to."""
WEAK = 0.02
"""Part of the friction below which what is left to begin slip with is next to nothing."""
LONGER = 1e-5
"""Part of the speed that friction makes while the force grows by as much as friction, up to which
the heading then counts."""
TURNS = 0.5
"""Cosine of the angle by which slip may turn in one step."""
ASTRAY = 0.1
"""Part of its largest change by which a velocity may be off, as an estimate says, in one step."""
STEPS = 5.0
"""Fixed steps in which friction could stop a slip that is at its end then."""
PROBE = 1e-6
"""Part of a step in which it is seen what drives slip."""
FIRST = 1e-2
"""Part of what slip gains in that time up to which its heading counts in any case."""
SOON = 1e-7
"""Part of the run in which that growth is looked at."""


class Stops:
    """Ends of slip, for one program.

    Parameters
    ----------
    program : Program
    kept : Kept
    until : float
        s.
    step : float or None
        Length of the solver's steps, s, if it is fixed: no such step may pass rest.
    rtol : float
        Of the solver: slip that is slow beside its errors has no direction.
    """

    def __init__(
        self,
        program: Program,
        kept: Kept,
        until: float,
        *,
        step: float | None = None,
        rtol: float = 0.0,
    ) -> None:
        self.program = program
        self.until = until
        self.step = step
        self.low = min(max(LOW, COARSE * rtol), HIGHEST)
        self.slips = []
        for index, (heading, slow) in kept.places.items():
            law = program.graph.machines[index].law
            assert law is not None and law.second is not None
            x, y = program.compile(law.common), program.compile(law.second.common)
            path = program.graph.machines[index].path
            self.slips.append(Slip(path, index, x, y, program.nx + heading, program.nx + slow))

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
            low = max(self.low * slip.largest, FLOOR * slip.ever)
            begun = speed > max(2.0 * low, -OUTGROWN * y[slip.slow])
            if begun and low > 4.0 * y[slip.slow]:
                new = y.copy() if new is y else new
                new[slip.slow] = low
        return self._within_a_step(t, new, interval, equations, slips)

    def follows(self, step: Step, mode: Mode, interval: Interval, equations: ModeEquations) -> bool:
        """Whether a step follows slip: without turning it round, at the rate of what drives it.

        Where slip is slow its direction changes faster than any error estimate tells that looks
        at the speed beside the speeds of the whole run.
        """
        slips = [p for p in self.slips if mode[p.machine]]
        if not slips:
            return True
        field = self.program.field(equations, interval)
        h = step.t1 - step.t0
        middle = step.t0 + 0.5 * h
        points = [
            (t, np.asarray(y))
            for t, y in (
                (step.t0, step.y0),
                (middle, step.interpolant(middle)),
                (step.t1, step.y1),
            )
        ]
        probes = [(t + PROBE * h, y + PROBE * h * field(t, y)) for t, y in points]
        now, later = (
            [self.program.evaluate(t, y, interval, equations) for t, y in some]
            for some in (points, probes)
        )
        for slip in slips:
            f = [slip.velocity(v) for v in now]
            gains = [(slip.velocity(v) - a) / PROBE for v, a in zip(later, f, strict=True)]
            ways = [self._way(slip, a, y) for a, (_, y) in zip(f, points, strict=True)]
            turned = any(a @ b < TURNS for a, b in itertools.pairwise(ways))
            # what drives it over the step, by Simpson's rule
            gain = (gains[0] + 4.0 * gains[1] + gains[2]) / 6.0
            astray = math.hypot(*(f[2] - f[0] - gain))
            most = max(math.hypot(*g) for g in gains)
            if turned or astray > ASTRAY * most + CLOSE * slip.largest:
                return False
        return True

    @staticmethod
    def _way(slip: Slip, f: Vector, y: Vector) -> Vector:
        """Return the direction that friction acts against."""
        ahead = max(-float(y[slip.slow]), TINY)
        angle = float(y[slip.heading])
        way = f + ahead * np.array([math.cos(angle), math.sin(angle)])
        return np.asarray(way / math.hypot(*way))

    def _within_a_step(
        self,
        t: float,
        y: Vector,
        interval: Interval,
        equations: ModeEquations,
        slips: Sequence[Slip],
    ) -> Vector:
        """Return the state with slips at their end that fixed steps might pass."""
        if self.step is None:
            return y
        rate = self.program.field(equations, interval)(t, y)
        h = PROBE * self.step
        new = y
        for slip in slips:
            now, after = (
                slip.velocity(self.program.evaluate(a, z, interval, equations))
                for a, z in ((t, y), (t + h, y + h * rate))
            )
            speed = math.hypot(*now)
            pull = (after - now) / h
            if pull @ now < 0.0 and speed < STEPS * self.step * math.hypot(*pull):
                new = y.copy() if new is y else new
                new[slip.slow] = 2.0 * speed
                slip.largest = max(slip.largest, speed)
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
                slow = min(y[slip.slow], -self._heading_counts_to(slip, t, y, interval, equations))
                if slow != y[slip.slow]:
                    new = new.copy() if new is y else new
                    new[slip.slow] = slow
        slips = [p for p in self.slips if mode[p.machine] and y[p.slow] >= 0.0]
        return self._within_a_step(t, new, interval, equations, slips)

    def _heading_counts_to(
        self, slip: Slip, t: float, y: Vector, interval: Interval, equations: ModeEquations
    ) -> float:
        """Return the speed up to which the heading counts where slip begins."""
        field = self.program.field(equations, interval)
        h = SOON * max(self.until - t, t)

        def push(t: float, y: Vector) -> Vector:
            """Return what the slip velocity gains in the time `h`."""
            later = y + h * field(t, y)
            before, after = (self.program.evaluate(t, z, interval, equations) for z in (y, later))
            return slip.velocity(after) - slip.velocity(before)

        angle = float(y[slip.heading])
        held = frozen(y, slip, angle)
        now = push(t, held)
        friction = 0.5 * math.hypot(*(now - push(t, frozen(y, slip, angle + math.pi))))
        if math.hypot(*now) > WEAK * friction:
            return FIRST * math.hypot(*now)
        grows = math.hypot(*(push(t + h, held + h * field(t, held)) - now)) / h
        lasts = friction / grows if grows > 0.0 else self.until - t
        return LONGER * friction / h * lasts

    def descent(
        self, t: float, y: Vector, mode: Mode, interval: Interval, equations: ModeEquations
    ) -> Descent | None:
        """Return the way to the end of what slips slowly enough, None if nothing does."""
        slips = [p for p in self.slips if mode[p.machine] and y[p.slow] > 0.0]
        if not slips:
            return None

        def values(t: float, y: Vector) -> Sequence[float]:
            return self.program.evaluate(t, y, interval, equations)

        found = Descent(self.program.field(equations, interval), values, slips)
        return found if found.due(t, y) else None
