"""Marching: the smooth part of a motion, in the kernel."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.causality.orientation import base_mode
from hybond.equations.mode import ModeEquations
from hybond.kernel.bytecode import Declined
from hybond.kernel.common import Common
from hybond.kernel.crossing import KEPT, ROWS, Ahead, Modes, log_for, mode_of
from hybond.kernel.library import library
from hybond.kernel.plan import LARGEST, plan
from hybond.kernel.settling import Shared, drifting, simple
from hybond.kernel.structs import Filled, Motion, Sampling, Trail
from hybond.model.expressions import Expr
from hybond.model.graph import Mode
from hybond.model.inputs import line
from hybond.model.interval import Interval
from hybond.modes import locate
from hybond.modes.landing.contacts import approach
from hybond.modes.locate import Watched
from hybond.modes.marching import Course, Marched, Passage, Scale
from hybond.modes.settle import Settler
from hybond.programs.linear import LinearForm
from hybond.programs.program import Program
from hybond.solvers.base import State, Twinned

Vector = NDArray[np.float64]
ARRIVED, FULL, EVENT, UNSURE, DECLINED, NO_MEMORY, UNKNOWN = range(7)
MOST = 1024
"""Steps of one call: between calls a run can be interrupted."""
REPORTED = 16
"""Steps of one call where someone wants to be told how far a run is."""
BUDGET = 2e7
"""Operations of one call, about: some hundredths of a second."""
METHODS = ("rk45", "radau", "exact")
"""Solvers that the kernel has, in the order of `METHODS` in `c/method.c`."""
ONLY = f"the kernel has {', '.join(METHODS[:-1])} and {METHODS[-1]} only"
TIMES = {0: "", 1: " (once)"}
ROOM = 6.4e7
"""Bytes of the steps of one passage."""
PATIENCE = 64
"""Segments at the most after which a passage is tried again where one came to nothing."""


class Marcher:
    """Marches one program with one solver; see `hybond.modes.marching`.

    Parameters
    ----------
    program : Program
    solver : Twinned
        One of `METHODS`.
    scale : ErrorScale
    most : int
        Steps of one call.
    """

    def __init__(
        self,
        kernel: ctypes.CDLL,
        program: Program,
        solver: Twinned,
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
        self._plans: dict[tuple[object, ...], tuple[object, object, Filled | None]] = {}
        self._sampling = _sampling()
        self._motion = self._fresh()
        self._left: Vector | None = None
        """The state that the kernel left the solver at, if it remembers the way there."""
        self._trail = Filled(Trail())
        self._size = (0, 0, 0)
        self._shared = Shared()
        self._modes: Modes | None = None
        self._ahead: Ahead | None = None
        self._log: Filled | None = None
        self._wait = self._waited = self._failed = 0
        self._common: Common | None = None
        self._drifting: dict[Mode, frozenset[int]] = {}
        self._passed_over: dict[str, int] = {}
        self._simple = simple(program.graph)

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
        mode = self._plan(
            equations, watched, interval, tuple(gaps.values()), lawful=bool(laws.laws)
        )
        if mode is None:
            return None
        state = self.solver.state()
        if start is not None:
            state = State(start[0], start[1], np.zeros(len(start[1])))
        motion = self._prepare(state, equations, interval)
        motion.structure.run_energy, motion.structure.instant = settler.trace.energy, instant
        most = max(1, min(self.most, int(BUDGET / mode.structure.cost)))
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

    def cross(
        self,
        course: Course,
        *,
        mode: Mode,
        t: float,
        y: Vector,
        interval: Interval,
        last: float,
        events: int,
    ) -> Passage | None:
        """Return the segments from where one begins, None if nothing is known of its end."""
        if not self._simple:
            self._passed_over["contacts or friction as junction laws"] = 0
            return None
        if self._waited < self._wait:
            self._waited += 1
            return None
        if self._modes is None or self._ahead is None or self._log is None:
            self._begin(course)
        modes, ahead, log = self._modes, self._ahead, self._log
        assert modes is not None and ahead is not None and log is not None
        place = modes.place(mode, interval, t)
        if place is None:
            self._in_vain()
            return None
        equations = self.program.equations(mode, interval, t)
        modes.look()
        intervals = ahead.look(t, interval)
        motion = self._prepare(State(t, y, np.zeros(len(y))), equations, interval)
        motion.structure.run_energy = course.settler.trace.energy
        # a passage is short by its budget: fewer steps might not reach the end of a segment
        most = max(1, min(MOST, int(ROOM / (6 * 8 * len(y)))))
        trail = self._room(most, len(y), 0)
        record = log.structure
        record.last = last
        why = self._kernel.hb_run(
            modes.atlas.structure,
            motion.structure,
            self._sampling.structure,
            ahead.schedule.structure,
            place,
            most,
            min(ROWS, course.max_events - events),
            ctypes.c_double(BUDGET),
            trail.structure,
            record,
        )
        if why == NO_MEMORY:
            raise MemoryError
        if why in (DECLINED, UNSURE):
            self._over("in doubt")
        modes.hand_back()
        passage = self._passed((t, y, mode), modes, log, list(intervals))
        again = why in (EVENT, FULL) and record.rows > 0
        if why == UNKNOWN:
            wanted = mode_of(log.arrays["wanted"])
            new = not modes.knows(wanted)
            again = new and modes.place(wanted, interval, t) is not None
        if not record.rows and not again:
            self._in_vain()
            return None
        self._wait = self._waited = self._failed = 0
        course.settler.trace.energy = motion.structure.run_energy
        return replace(passage, again=again)

    def _begin(self, course: Course) -> None:
        program = self.program
        laws = course.settler.trials.laws
        lawful = bool(laws.laws)
        approaches = [approach(program.graph, c) for c in course.landings.contacts()]
        self._shared = Shared.of(program, approaches, course.surfaces)
        self._plans.clear()
        self._ahead = Ahead(program.graph, course.until)
        self._log = log_for(ROWS, program.nx + program.ns, len(program.graph.machines))

        def make(mode: Mode, interval: Interval, t: float) -> Filled | None:
            if lawful:
                found = drifting(laws, mode, interval, t)
                if found is None:
                    self._over("diodes whose branches may be ambiguous")
                    return None
                self._drifting[base_mode(program.graph, mode)] = found
            equations = program.equations(mode, interval, t)
            return self._plan(equations, course.watch(mode), interval, (), lawful=lawful)

        self._modes = Modes(program, course, make, rounded=self.scale.rounded)

    def _over(self, why: str) -> None:
        self._passed_over[why] = self._passed_over.get(why, 0) + 1

    def _in_vain(self) -> None:
        """Wait the longer, the more often there was nothing to pass.

        An even number of segments, or else one of two that take turns would never be tried.
        """
        self._failed += 1
        # the first time, what the reference does now may be all that was not known
        self._wait = min(2 * self._wait + 2, PATIENCE) if self._failed > 1 else 0
        self._waited = 0

    def _passed(
        self,
        start: tuple[float, Vector, Mode],
        modes: Modes,
        log: Filled,
        intervals: list[Interval],
    ) -> Passage:
        """Return what the kernel left behind."""
        n = log.structure.rows
        row = {name: a[:n].copy() for name, a in log.arrays.items() if name != "wanted"}
        steps = int(row["steps"][-1]) if n else 0
        after = [modes.mode(k) for k in row["mode"].tolist()]
        marched = self._made(self._trail, steps, {})
        return Passage(
            start,
            row["t"],
            row["before"],
            row["after"],
            after,
            row["timed"].astype(bool),
            row["changed"].astype(bool),
            row["struck"].astype(bool),
            row["interval"],
            intervals,
            row["energy"],
            row["approach"],
            row["fired"].astype(bool),
            row["steps"],
            marched,
            again=False,
        )

    def reasons(self) -> list[str]:
        """Return why modes and events were left to the reference, a text each."""
        modes = [
            f"{n} mode{'s' * (n > 1)} left to the reference: {why}"
            for why, n in sorted(self.declined.items())
        ]
        events = [
            f"events left to the reference: {why}" + TIMES.get(n, f" ({n} times)")
            for why, n in sorted(self._passed_over.items())
        ]
        return modes + events

    def _plan(
        self,
        equations: ModeEquations,
        watched: Watched,
        interval: Interval,
        gaps: tuple[Expr, ...],
        *,
        lawful: bool,
    ) -> Filled | None:
        drifting = self._drifting.get(base_mode(self.program.graph, equations.mode))
        shared = replace(self._shared, drifting=drifting or frozenset())
        key = id(equations), id(watched), drifting
        known = self._plans.get(key)
        if known is None or known[0] is not equations or known[1] is not watched:
            found: Filled | None = None
            try:
                if self._common is None:
                    self._common = Common(self.program)
                found = plan(
                    self.program,
                    equations,
                    watched,
                    gaps,
                    shared,
                    self._common,
                    lawful=lawful,
                    implicit=self.solver.implicit,
                    form=self._form(equations, interval),
                )
            except Declined as reason:
                self.declined[str(reason)] = self.declined.get(str(reason), 0) + 1
            if len(self._plans) >= KEPT:
                self._plans.clear()
            known = self._plans[key] = equations, watched, found
        return known[2]

    def _fresh(self) -> Filled:
        """Return a motion, with room for what its method keeps from step to step."""
        motion = Filled(Motion())
        motion.structure.method = METHODS.index(self.solver.name)
        n = self.program.nx + self.program.ns
        if self.solver.implicit and n <= LARGEST:
            for name in ("jacobian", "real", "re", "im"):
                motion.put(name, np.zeros((n, n)), part="memory")
            for name in ("real_row", "pair_row"):
                motion.put(name, np.zeros(n), part="memory")
            motion.put("polynomial", np.zeros((3, n + 2)), part="memory")
        return motion

    def _forget(self) -> None:
        """Let a motion go on without what its method keeps: something else made steps since."""
        memory = self._motion.structure.memory
        memory.left, memory.span, memory.served = 1.0, 0.0, 0.0
        memory.matrix = memory.slow = 0

    def _form(self, equations: ModeEquations, interval: Interval) -> LinearForm | None:
        """Return the motion of a mode as a matrix, if the solver propagates by that."""
        program = self.program
        if not self.solver.propagates or program.fieldless(equations.mode):
            return None
        form = program.linear.of(equations, interval)
        return form if isinstance(form, LinearForm) else None

    def _prepare(self, state: State, equations: ModeEquations, interval: Interval) -> Filled:
        motion, solver, scale, program = self._motion, self.solver, self.scale, self.program
        m = motion.structure
        if state.y is not self._left:
            self._forget()
        self._left = None
        m.t, m.h = state.t, state.h
        m.error_before, m.h_before = state.error_before, state.h_before
        m.controlled, m.max_step = state.controlled, solver.max_step
        m.energy, m.rtol, m.atol = scale.energy, scale.rtol, scale.atol_or_nan
        m.negligible, m.idle = scale.negligible, scale.idle
        m.evaluations = 0
        motion.put("y", state.y.copy())
        motion.put("f", state.f.copy())
        motion.put("largest", scale.largest.copy())
        motion.put("rounding", scale.rounding.copy())
        free = equations.n2.shape[1] if equations.rows else 0
        motion.put("free", np.zeros(free) if equations.guess is None else equations.guess.copy())
        pieces = zip(program.graph.inputs, interval.pieces, strict=True)
        lines = np.array([line(i.waveform, state.t, p) for i, p in pieces]).reshape(-1, 3)
        for k, name in enumerate(("input_time", "input", "input_rate")):
            motion.put(name, lines[:, k])
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
        motion = self._motion
        m, arrays = motion.structure, motion.arrays
        if equations.rows:
            equations.guess = arrays["free"].copy()
        sizes = np.abs(trail.arrays["outputs"][:count]).max(axis=0, initial=0.0)
        taken = self._made(trail, count, dict(zip(gaps, sizes.tolist(), strict=True)), why)
        if count:
            y, f = taken.y[-1], arrays["f"].copy()
            state = State(m.t, y, f, m.h, m.error_before, m.h_before, m.controlled)
            self.solver.resume(state)
            self._left = y if why == FULL else None
        return taken

    def _made(self, trail: Filled, count: int, gaps: dict[int, float], why: int = FULL) -> Marched:
        """Return the first steps on the trail, and let the reference know what they saw."""
        m, arrays = self._motion.structure, self._motion.arrays
        self.program.evaluations += m.evaluations
        self.scale.energy = m.energy
        self.scale.largest = arrays["largest"].copy()
        names = ("t", "y", "stop", "end", "dense")
        t, y, stop, end, dense = (trail.arrays[a][:count].copy() for a in names)
        return Marched(
            t,
            y,
            stop,
            end,
            dense,
            int(trail.arrays["rejected"][:count].sum()),
            gaps,
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
    if not isinstance(solver, Twinned) or solver.name not in METHODS:
        return ONLY
    if solver.own:
        return "a function gives the Jacobian"
    return Marcher(kernel, program, solver, scale, most=REPORTED if reporting else MOST)


def _sampling() -> Filled:
    filled = Filled(Sampling())
    filled.put("fractions", locate.FRACTIONS)
    filled.put("left_over", locate.LEFT_OVER)
    filled.put("fine", locate.FINE)
    s = filled.structure
    s.unresolved, s.near_zero, s.rounding = locate.UNRESOLVED, locate.NEAR, locate.ROUNDED
    # weights add up to one: with their magnitudes adding up to more, extremes are exceeded
    s.overshoot = 0.5 * (float(np.abs(locate.FINE).sum(axis=1).max()) - 1.0) + 1e-9
    return filled
