"""Marching: the smooth part of a motion, in the kernel."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.kernel.bytecode import Declined
from hybond.kernel.library import library
from hybond.kernel.plan import plan
from hybond.kernel.structs import Filled, Motion, Sampling, Trail
from hybond.model.expressions import Expr
from hybond.modes import locate
from hybond.modes.locate import Watched
from hybond.modes.marching import Marched, Scale
from hybond.modes.settle import Settler
from hybond.programs.interval import Interval
from hybond.programs.program import Program
from hybond.solvers.dopri import DormandPrince, State

Vector = NDArray[np.float64]
ARRIVED, FULL, EVENT, UNSURE, DECLINED, NO_MEMORY = range(6)
MOST = 1024
"""Steps of one call: between calls a run can be interrupted."""
REPORTED = 16
"""Steps of one call where someone wants to be told how far a run is."""
BUDGET = 2e7
"""Operations of one call, about: some hundredths of a second."""
LOOKS = 50.0
"""Evaluations of a step, those of its guards included, about."""
KEPT = 256
"""Modes that are kept ready."""


class Marcher:
    """Marches one program with one solver; see `hybond.modes.marching`.

    Parameters
    ----------
    program : Program
    solver : DormandPrince
    scale : ErrorScale
    most : int
        Steps of one call.
    """

    def __init__(
        self,
        kernel: ctypes.CDLL,
        program: Program,
        solver: DormandPrince,
        scale: Scale,
        *,
        most: int = MOST,
    ) -> None:
        self._kernel = kernel
        self.program = program
        self.solver = solver
        self.scale = scale
        self.most = most
        self.declined: dict[str, int] = {}
        """Why modes were left to the reference, and how many."""
        self._plans: dict[tuple[int, int], tuple[object, object, Filled | None]] = {}
        self._sampling = _sampling()
        self._motion = Filled(Motion())
        self._trail = Filled(Trail())
        self._size = (0, 0, 0)

    def march(
        self,
        equations: ModeEquations,
        watched: Watched,
        *,
        interval: Interval,
        settler: Settler,
        end: float,
        instant: float,
        start: tuple[float, Vector] | None,
    ) -> Marched | None:
        """Return the steps up to `end`, or up to one in which something may happen.

        None if the kernel was not made for this mode.
        """
        laws = settler.trials.laws
        gaps = laws.gaps
        mode = self._plan(equations, watched, tuple(gaps.values()), lawful=bool(laws.laws))
        if mode is None:
            return None
        state = self.solver.state()
        if start is not None:
            state = State(start[0], start[1], np.zeros(len(start[1])), 0.0, 0.0, 0)
        motion = self._prepare(state, equations, interval)
        motion.structure.run_energy, motion.structure.instant = settler.trace.energy, instant
        most = max(1, min(self.most, int(BUDGET / _cost(mode))))
        trail = self._room(most, len(motion.arrays["y"]), len(gaps))
        count = ctypes.c_int32()
        why = self._kernel.hb_march(
            mode.structure,
            motion.structure,
            self._sampling.structure,
            end,
            most,
            start is not None,
            trail.structure,
            count,
        )
        if why == NO_MEMORY:
            raise MemoryError
        return self._taken(equations, trail, count.value, list(gaps), why)

    def reasons(self) -> list[str]:
        """Return why modes were left to the reference, a text each."""
        return [
            f"{n} mode{'s' * (n > 1)} left to the reference: {why}"
            for why, n in sorted(self.declined.items())
        ]

    def _plan(
        self,
        equations: ModeEquations,
        watched: Watched,
        gaps: tuple[Expr, ...],
        *,
        lawful: bool,
    ) -> Filled | None:
        key = id(equations), id(watched)
        known = self._plans.get(key)
        if known is None or known[0] is not equations or known[1] is not watched:
            found: Filled | None = None
            try:
                found = plan(self.program, equations, watched, gaps, lawful=lawful)
            except Declined as reason:
                self.declined[str(reason)] = self.declined.get(str(reason), 0) + 1
            if len(self._plans) >= KEPT:
                self._plans.clear()
            known = self._plans[key] = equations, watched, found
        return known[2]

    def _prepare(self, state: State, equations: ModeEquations, interval: Interval) -> Filled:
        motion, solver, scale, program = self._motion, self.solver, self.scale, self.program
        m = motion.structure
        m.t, m.h, m.error_before = state.t, state.h, state.error_before
        m.controlled, m.max_step = state.controlled, solver.max_step
        m.energy, m.rtol, m.atol = scale.energy, scale.rtol, scale.atol_or_nan
        m.negligible, m.idle = scale.negligible, scale.idle
        m.input_time, m.evaluations = state.t, 0
        motion.put("y", state.y.copy())
        motion.put("f", state.f.copy())
        motion.put("largest", scale.largest.copy())
        motion.put("rounding", scale.rounding)
        free = equations.n2.shape[1] if equations.rows else 0
        motion.put("free", np.zeros(free) if equations.guess is None else equations.guess.copy())
        pieces = list(zip(program.graph.inputs, interval.pieces, strict=True))
        motion.put("input", [i.waveform.value(state.t, p) for i, p in pieces])
        motion.put("input_rate", [i.waveform.rate(state.t, p) for i, p in pieces])
        nx, ns = program.nx, program.ns
        v = program.values(state.t, interval, equations.mode, state.y[:nx], state.y[nx : nx + ns])
        motion.put("v", v)
        return motion

    def _room(self, most: int, states: int, outputs: int) -> Filled:
        """Return a trail for so many steps: in a large graph few of them fill much memory."""
        room, *others = self._size
        if room < most or others != [states, outputs]:
            self._size = most, states, outputs
            self._trail.put("t", np.zeros(most))
            self._trail.put("y", np.zeros((most, states)))
            self._trail.put("stop", np.zeros(most))
            self._trail.put("end", np.zeros((most, states)))
            self._trail.put("dense", np.zeros((most, 4, states)))
            self._trail.put("outputs", np.zeros((most, outputs)))
            self._trail.put("rejected", np.zeros(most))
        return self._trail

    def _taken(
        self,
        equations: ModeEquations,
        trail: Filled,
        count: int,
        gaps: list[int],
        why: int,
    ) -> Marched:
        motion, scale = self._motion, self.scale
        m, arrays = motion.structure, motion.arrays
        self.program.evaluations += m.evaluations
        scale.energy = m.energy
        scale.largest = arrays["largest"].copy()
        if equations.rows:
            equations.guess = arrays["free"].copy()
        names = ("t", "y", "stop", "end", "dense")
        t, y, stop, end, dense = (trail.arrays[a][:count].copy() for a in names)
        if count:
            f = arrays["f"].copy()
            self.solver.resume(State(m.t, y[-1], f, m.h, m.error_before, m.controlled))
        sizes = np.abs(trail.arrays["outputs"][:count]).max(axis=0, initial=0.0)
        return Marched(
            t,
            y,
            stop,
            end,
            dense,
            int(trail.arrays["rejected"][:count].sum()),
            dict(zip(gaps, sizes.tolist(), strict=True)),
            arrived=why == ARRIVED,
            interrupted=why == FULL,
            event=why == EVENT,
        )


def marcher(
    program: Program, solver: object, scale: Scale, *, reporting: bool = False
) -> Marcher | str:
    """Return what marches this program, or why nothing does.

    `reporting` says that someone is told of progress.
    """
    kernel = library()
    if isinstance(kernel, str):
        return kernel
    if not isinstance(solver, DormandPrince):
        return "the kernel has rk45 only"
    return Marcher(kernel, program, solver, scale, most=REPORTED if reporting else MOST)


def _cost(mode: Filled) -> float:
    """Return about how many operations a step takes: its evaluations, and those for its guards."""
    m, arrays = mode.structure, mode.arrays
    once = len(arrays["solved.value"]) + len(arrays["code"]) + m.free**3 + m.rows * m.free
    return float(1.0 + LOOKS * once)


def _sampling() -> Filled:
    filled = Filled(Sampling())
    filled.put("fractions", locate.FRACTIONS)
    filled.put("left_over", locate.LEFT_OVER)
    filled.put("fine", locate.FINE)
    s = filled.structure
    s.unresolved, s.near_zero, s.rounding = locate.UNRESOLVED, locate.NEAR, locate.ROUNDED
    return filled
