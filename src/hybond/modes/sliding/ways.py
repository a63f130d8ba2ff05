"""How a state on switching surfaces goes on: `filippov` asked about the fields of a graph."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.equations.surfaces import Surface, SurfaceLaws, coincide
from hybond.errors import HybondError
from hybond.model.graph import Mode
from hybond.modes.jump import enter
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
from hybond.programs.combined import Kind
from hybond.programs.interval import Interval
from hybond.programs.program import Program
from hybond.programs.sliding_program import (
    MOST_PRODUCT,
    additive,
    combine,
    corners_of,
    flipped,
)
from hybond.trace import Trace

Vector = NDArray[np.float64]


class WaysOn:
    """Decides for one run; warns where there is no way on, or more than one."""

    def __init__(self, program: Program, trace: Trace, laws: SurfaceLaws) -> None:
        self.program = program
        self.graph = program.graph
        self.trace = trace
        self.laws = laws

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
        met = self._one_each(t, y, mode, met, interval)
        met = self._agreeing(t, y, mode, met, interval)
        if not met:
            return None
        combined = combine(program, met, mode, interval, t, laws=self.laws)
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
            combined = combine(program, met, mode, interval, t, laws=self.laws, kind="product")
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
        return chosen, kind, met

    def _sides_text(self, met: Sequence[Surface], way: Future) -> str:
        words = []
        for s, side in zip(met, way.sides, strict=True):
            states = self.graph.machines[s.machine].states
            words.append(
                "sliding" if side == SLIDES else states[s.above if side == ABOVE else s.below]
            )
        return ", ".join(words)

    def _one_each(
        self, t: float, y: Vector, mode: Mode, met: list[Surface], interval: Interval
    ) -> list[Surface]:
        """Return one surface of those that coincide: that whose machine moves something."""
        kept: list[Surface] = []
        for s in met:
            twin = next((k for k in kept if coincide(s, k)), None)
            if twin is None:
                kept.append(s)
            elif self._acts(s, t, y, mode, interval):
                if not self._acts(twin, t, y, mode, interval):
                    kept[kept.index(twin)] = s
                    continue
                paths = [self.graph.machines[k.machine].path for k in (twin, s)]
                self.trace.warn(
                    f"{paths[0]} and {paths[1]} both switch on {s.text}: only {paths[0]} slides, "
                    "make them one machine"
                )
        return kept

    def _acts(self, s: Surface, t: float, y: Vector, mode: Mode, interval: Interval) -> bool:
        """Whether a machine's two states move the stored quantities differently."""
        program = self.program
        sides = [(*mode[: s.machine], k, *mode[s.machine + 1 :]) for k in (s.below, s.above)]
        try:
            rates = [
                program.field(program.equations(m, interval, t), interval)(t, y) for m in sides
            ]
        except HybondError:
            return True
        n = program.nx + program.ns
        size = np.abs(rates[0][:n]) + np.abs(rates[1][:n])
        return bool((np.abs(rates[0][:n] - rates[1][:n]) > 1e-12 * size).any())

    def _agreeing(
        self, t: float, y: Vector, mode: Mode, met: list[Surface], interval: Interval
    ) -> list[Surface]:
        """Return the surfaces around which all modes have one state space and one function."""
        program = self.program
        n = program.nx + program.ns
        v = program.values(t, interval, mode, y[: program.nx], y[program.nx : n])
        while True:
            corners = [flipped(mode, met, c) for c in corners_of(len(met), "additive")]
            holds = [self._held_to(m, t, y, interval) for m in corners]
            if holds[0] is not None and all(h == holds[0] for h in holds):
                break
            left = [s for s in met if self._same_space(s, t, y, mode, interval)]
            met = left if len(left) < len(met) else []
            if not met:
                return []
        combined = combine(program, met, mode, interval, t, laws=self.laws)
        agree = combined.outputs_agree(v)
        for s, ok in zip(met, agree, strict=True):
            if not ok:
                self.trace.warn(
                    f"{s.text} reads what {self.graph.machines[s.machine].path} itself makes "
                    "jump: there is no surface to slide on"
                )
        return [s for s, ok in zip(met, agree, strict=True) if ok]

    def _same_space(self, s: Surface, t: float, y: Vector, mode: Mode, interval: Interval) -> bool:
        """Whether both sides of a surface take the state as it is, and hold it to the same."""
        sides = [(*mode[: s.machine], k, *mode[s.machine + 1 :]) for k in (s.below, s.above)]
        below, above = (self._held_to(m, t, y, interval) for m in sides)
        return below is not None and below == above

    def _held_to(self, mode: Mode, t: float, y: Vector, interval: Interval) -> object:
        """Return what a mode holds stored quantities to; None if they would have to jump."""
        program = self.program
        if program.fieldless(mode):
            return None
        try:
            e = program.equations(mode, interval, t)
            if e.tableau.constraints or e.structure or e.tableau.agreements:
                v = program.evaluate(t, y, interval, e)
                where = self.graph.mode_text(mode)
                x = y[: program.nx]
                if enter(e, v, x, where=where, energy=self.trace.energy).happened:
                    return None
        except HybondError:
            return None
        last = e.tableau.unknowns + len(self.graph.storages)
        rows = [{k: c for k, c in r.items() if k < last} for r in e.tableau.constraints]
        return e.rank - len(e.structure), *sorted(tuple(sorted(r.items())) for r in rows)


def _distinct(ways: Sequence[Future]) -> list[Future]:
    """Return the ways on that differ by more than rounding: a weight of 1 is the side above."""
    found: list[Future] = []
    for w in ways:
        if not any(np.abs(w.weights - other.weights).max() <= 1e-9 for other in found):
            found.append(w)
    return found


def _clear(way: Future, speed: Vector, size: float) -> bool:
    """Whether a way leaves its surfaces at a speed that is more than rounding."""
    return all(side == SLIDES or abs(speed[j]) > 1e-9 * size for j, side in enumerate(way.sides))
