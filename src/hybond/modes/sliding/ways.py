"""How a state on switching surfaces goes on: `filippov` asked about the fields of a graph."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.combinations import Kind, corners_of, flipped
from hybond.equations.surfaces import Surface, SurfaceLaws, coincide
from hybond.errors import HybondError, NumericsError
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.sliding.branches import BranchesBeside
from hybond.modes.sliding.crossings import Crossings, sides_of
from hybond.modes.sliding.filippov import (
    ABOVE,
    BELOW,
    FEW,
    SLIDES,
    Future,
    future,
    futures,
    futures_of,
)
from hybond.modes.sliding.meeting import meet
from hybond.programs.combined import Combined
from hybond.programs.program import Program
from hybond.programs.sliding_program import (
    MOST_PRODUCT,
    additive,
    combine,
)
from hybond.trace import Trace

Vector = NDArray[np.float64]

PUSHED = 1e-9
"""A side leads to a surface if more than this part of both sides' speed does: less is rounding."""
MOVES_ALIKE = 1e-12
"""Two states of a machine move what is stored alike if their rates differ by less: rounding."""
SAME_WEIGHTS = 1e-9
"""Weights lie in [0, 1], and come from solved equations: ways closer than this are one."""
CLEAR = 1e-9
"""A way leaves its surface at more than this part of the largest speed: less is rounding."""


class WaysOn:
    """Decides for one run; warns where there is no way on, or more than one."""

    def __init__(self, program: Program, trace: Trace, laws: SurfaceLaws) -> None:
        self.program = program
        self.graph = program.graph
        self.trace = trace
        self.laws = laws
        self.crossings = Crossings(program, trace, laws)
        self.branches = BranchesBeside(program, trace)

    def decide(
        self,
        t: float,
        y: Vector,
        mode: Mode,
        met: list[Surface],
        held: Sequence[Surface],
        interval: Interval,
    ) -> tuple[Future, Kind, list[Surface]] | None:
        """Return how the state goes on from the surfaces it is on."""
        program = self.program
        branch = self.branches.at(t, y, interval)
        met = self._one_each(t, y, mode, met, interval, branch)
        met = self._agreeing(t, y, mode, met, interval, branch)
        if not met:
            return None
        combined = self._combined(met, mode, interval, t, branch)
        n = program.nx + program.ns
        v = program.values(t, interval, mode, y[: program.nx], y[program.nx : n])
        kind: Kind = "additive" if additive(combined, v) else "product"
        k = len(met)
        if kind == "additive":
            slopes = combined.surface_rates(v, combined.part_rates(v)[1])
            a, b = slopes[:, 0], slopes[:, 1:] - slopes[:, :1]
            if k <= FEW:
                ways = futures(a, b)
            else:
                way = future(a, b)
                ways = [] if way is None else [way]
            size = float(np.abs(slopes).max())

            def speed(weights: Vector) -> Vector:
                return np.asarray(a + b @ weights)

        elif k <= MOST_PRODUCT:
            combined = self._combined(met, mode, interval, t, branch, kind="product")
            corners = np.array(corners_of(k, "product"), dtype=float)
            slopes = combined.surface_rates(v, combined.part_rates(v)[1])
            size = float(np.abs(slopes).max())

            def speed(weights: Vector) -> Vector:
                shares = np.prod(corners * weights + (1.0 - corners) * (1.0 - weights), axis=1)
                return np.asarray(slopes @ shares)

            ways = futures_of(speed, k)
        else:
            ways, size = [], 0.0

        where = " and ".join(s.text for s in met)
        if not ways:
            self.trace.warn(f"no way on was found from {where} at t = {t:.9g} s: events go on")
            return None
        here = tuple(
            SLIDES if s in held else ABOVE if mode[s.machine] == s.above else BELOW for s in met
        )
        distinct = _distinct(ways)
        chosen = next((w for w in ways if w.sides == here), ways[0])
        if len(distinct) > 1 and all(_clear(w, speed(w.weights), size) for w in distinct):
            self.trace.warn(
                f"at t = {t:.9g} s the motion from {where} is not unique: "
                f"{len(distinct)} ways lead on, among them off the surface on either side; "
                f"it goes on in ({self._sides_text(met, chosen)})"
            )
        if combined.common is not None and chosen.sliding:
            chosen = _pushed(combined, v, chosen, kind)
        elif combined.common is not None and k == 1:
            self._tell_of_strokes(combined, v, met[0], t)
        return chosen, kind, met

    def _tell_of_strokes(self, combined: Combined, v: list[float], s: Surface, t: float) -> None:
        """Warn where both modes lead to a surface, but a jump there leads back too far to slide."""
        try:
            pushes = combined.blend(v).pushes
        except NumericsError:
            return
        if pushes is not None and (pushes > PUSHED).all():
            self.trace.warn(
                f"both sides push into {s.text} at t = {t:.9g} s, but the jump on crossing it "
                "throws back by more than was gained: there is no sliding along it"
            )

    def _sides_text(self, met: Sequence[Surface], way: Future) -> str:
        words = []
        for s, side in zip(met, way.sides, strict=True):
            states = self.graph.machines[s.machine].states
            words.append(
                "sliding" if side == SLIDES else states[s.above if side == ABOVE else s.below]
            )
        return ", ".join(words)

    def _one_each(
        self,
        t: float,
        y: Vector,
        mode: Mode,
        met: list[Surface],
        interval: Interval,
        branch: Callable[[Mode], Mode],
    ) -> list[Surface]:
        """Return one surface of those that coincide: that whose machine moves something."""
        kept: list[Surface] = []
        for s in met:
            twin = next((k for k in kept if coincide(s, k)), None)
            if twin is None:
                kept.append(s)
            elif self._acts(s, t, y, mode, interval, branch):
                if not self._acts(twin, t, y, mode, interval, branch):
                    kept[kept.index(twin)] = s
                    continue
                paths = [self.graph.machines[k.machine].path for k in (twin, s)]
                self.trace.warn(
                    f"{paths[0]} and {paths[1]} both switch on {s.text}: only {paths[0]} slides, "
                    "make them one machine"
                )
        return kept

    def _acts(
        self,
        s: Surface,
        t: float,
        y: Vector,
        mode: Mode,
        interval: Interval,
        branch: Callable[[Mode], Mode],
    ) -> bool:
        """Whether a machine's two states move the stored quantities differently."""
        program = self.program
        try:
            rates = [
                program.field(program.equations(m, interval, t), interval)(t, y)
                for m in map(branch, sides_of(s, mode))
            ]
        except HybondError:
            return True
        n = program.nx + program.ns
        size = np.abs(rates[0][:n]) + np.abs(rates[1][:n])
        return bool((np.abs(rates[0][:n] - rates[1][:n]) > MOVES_ALIKE * size).any())

    def _agreeing(
        self,
        t: float,
        y: Vector,
        mode: Mode,
        met: list[Surface],
        interval: Interval,
        branch: Callable[[Mode], Mode],
    ) -> list[Surface]:
        """Return the surfaces around which all modes can keep the state, with one function."""
        program = self.program
        n = program.nx + program.ns
        v = program.values(t, interval, mode, y[: program.nx], y[program.nx : n])
        while True:
            corners = [branch(flipped(mode, met, c)) for c in corners_of(len(met), "additive")]
            if self.crossings.meet(corners, t, y, interval):
                break
            sides = [[branch(m) for m in sides_of(s, mode)] for s in met]
            takes = [self.crossings.meet(pair, t, y, interval) for pair in sides]
            left = [s for s, ok in zip(met, takes, strict=True) if ok]
            met = left if len(left) < len(met) else []
            if not met:
                return []
        combined = self._combined(met, mode, interval, t, branch)
        agree = combined.outputs_agree(v)
        for s, ok in zip(met, agree, strict=True):
            if not ok:
                self.trace.warn(
                    f"{s.text} reads what {self.graph.machines[s.machine].path} itself makes "
                    "jump: there is no surface to slide on"
                )
        return [s for s, ok in zip(met, agree, strict=True) if ok]

    def _combined(
        self,
        met: Sequence[Surface],
        mode: Mode,
        interval: Interval,
        t: float,
        branch: Callable[[Mode], Mode],
        *,
        kind: Kind = "additive",
    ) -> Combined:
        return combine(
            self.program,
            met,
            mode,
            interval,
            t,
            laws=self.laws,
            meet=meet,
            branch=branch,
            kind=kind,
        )


def _pushed(combined: Combined, v: list[float], way: Future, kind: Kind) -> Future:
    """Return a way without the surfaces that a mode leads away from before any jump.

    On the mean a mode may be led back by its jumps alone; but there are none if it never returns.
    """
    here = combined.margins(v)
    sides = list(way.sides)
    if kind == "additive" and len(sides) == len(way.sliding) and (here < 0.0).any():
        for j in way.sliding:
            if here[:, j].min() < 0.0:
                sides[j] = BELOW if here[0, j] <= here[1, j] else ABOVE
    weights = np.array([1.0 if s == ABOVE else 0.0 for s in sides])
    return way if tuple(sides) == way.sides else Future(tuple(sides), weights)


def _distinct(ways: Sequence[Future]) -> list[Future]:
    """Return the ways on that differ by more than rounding: a weight of 1 is the side above."""
    found: list[Future] = []
    for w in ways:
        if not any(np.abs(w.weights - other.weights).max() <= SAME_WEIGHTS for other in found):
            found.append(w)
    return found


def _clear(way: Future, speed: Vector, size: float) -> bool:
    """Whether a way leaves its surfaces at a speed that is more than rounding."""
    return all(side == SLIDES or abs(speed[j]) > CLEAR * size for j, side in enumerate(way.sides))
