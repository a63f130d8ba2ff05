"""Continuous motion: time passes in a mode until a guard holds, or a timed event, or the end.

The steps are made by the kernel as far as it is sure, and by the solver. On each the locator looks
for the first instant at which a guard holds; the step is repeated so that it ends just past that,
and ended there. Then the state is put back on the mode's constraints, if it has drifted off by
rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.polynomial import Polynomial
from hybond.equations.mode import ModeEquations
from hybond.errors import NumericsError
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.flows import Flows
from hybond.modes.jump import on_constraints
from hybond.modes.landing.landing import Landings
from hybond.modes.laws.limits import FrictionLimits
from hybond.modes.laws.stops import Stops
from hybond.modes.locate import Locator, Watched, watch
from hybond.modes.marching import March, Marched
from hybond.modes.settle import Settler, cause_at
from hybond.modes.sliding.motion import Slider
from hybond.modes.sliding.view import View
from hybond.programs.combined import Combined
from hybond.programs.program import Program
from hybond.solvers import Field, Solver, Step, StepFailure
from hybond.solvers.fixed import FixedStep
from hybond.trace import Cause, Segment, Trace

Vector = NDArray[np.float64]
Progress = Callable[[float, int], None]

SHORTER = 30
"""Times that a step is repeated, each time a quarter as long, if it does not follow slip."""
SHORT = 1e-6
"""Part of the run after which a force that grows from zero has a size."""
BEYOND = 50
"""Steps that may touch a place where a law has no value before the law is blamed: one in ten,
and this many at once."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Where a run ends, and what counts as one instant.

    Parameters
    ----------
    until : float
        s.
    event_tol : float
        A guard this close to a timed event belongs to it, as a part of `until`.
    max_events : int
    max_steps : int
        Steps between two events.
    """

    until: float
    event_tol: float = 1e-12
    max_events: int = 1_000_000
    max_steps: int = 4_000_000


@dataclass(slots=True)
class Now:
    """How far a run is.

    Parameters
    ----------
    mode : tuple of int
    t : float
        s.
    steps, rejected, marched, crossed : int
        Steps made and rejected, those made by the kernel, events that it settled.
    """

    mode: Mode
    t: float = 0.0
    steps: int = 0
    rejected: int = 0
    marched: int = 0
    crossed: int = 0


@dataclass(slots=True)
class Recorder:
    """The points of the segment under way."""

    mode: Mode
    interval: Interval
    t: list[float]
    y: list[Vector]
    interpolants: list[Callable[[float], Vector]]
    landed: tuple[str, ...] = ()
    view: View | None = None
    equations: ModeEquations | None = None

    def segment(self) -> Segment:
        """Return the segment so far."""
        return Segment(
            self.mode,
            self.interval,
            np.array(self.t),
            np.array(self.y),
            tuple(self.interpolants),
            self.landed,
            sliding=None if self.view is None else self.view.number,
            combined=None if self.view is None else self.equations,
        )


class Motion:
    """What moves one run through its segments.

    Parameters
    ----------
    program : Program
    solver : Solver
    limits : Limits
    now : Now
        How far the run is; each step moves it.
    trace : Trace
        Takes the segments.
    settler : Settler
    landings : Landings
    slider : Slider or None
    """

    def __init__(
        self,
        program: Program,
        solver: Solver,
        limits: Limits,
        now: Now,
        trace: Trace,
        settler: Settler,
        landings: Landings,
        slider: Slider | None,
        *,
        rtol: float = 0.0,
        march: March | None = None,
        started: Callable[[Vector], None] | None = None,
        progress: Progress | None = None,
    ) -> None:
        self.program = program
        self.solver = solver
        self.limits = limits
        self.now = now
        self.trace = trace
        self.settler = settler
        self.landings = landings
        self.slider = slider
        self.march = march
        self.started = started
        self.progress = progress
        step = solver.h if isinstance(solver, FixedStep) else None
        self.stops = Stops(program, settler.trials.laws.kept, limits.until, step=step, rtol=rtol)
        self.frictions = FrictionLimits(program)
        self._linear = Flows(program.linear)
        self._recorder: Recorder | None = None
        self._watched: dict[tuple[Mode, tuple[str, ...]], Watched] = {}

    # -- continuous motion

    def flow(self, y: Vector, interval: Interval) -> tuple[Vector, Cause]:
        """Let time pass in the mode; return the state at the instant that ends it, and why."""
        program = self.program
        view = None if self.slider is None else self.slider.view
        equations = (view.program if view else program).equations(
            self.now.mode, interval, self.now.t
        )
        locator = (
            view.locator(equations, interval)
            if view
            else Locator(program, self.settler, equations, interval, self.watched(self.now.mode))
        )
        end = min(interval.end, self.limits.until)
        tolerance = self.limits.event_tol * max(self.limits.until, abs(self.now.t))
        landed = self.landings.names
        if self.frictions.laws:
            self.frictions.check(
                self.now.t, self.program.evaluate(self.now.t, y, interval, equations)
            )
        y = self.stops.begun(self.now.t, y, self.now.mode, interval, equations)
        self._recorder = Recorder(
            self.now.mode, interval, [self.now.t], [y], [], landed, view, equations
        )
        if self.started is not None and view is None:
            self.started(self._terms(y, interval, equations))
        field: Field | None = None
        beyond = 0.0
        march = self._marching(view)
        begins = True
        while True:
            self._check_steps()
            if march is not None:
                start = (self.now.t, y) if begins else None
                taken = march.march(
                    equations,
                    self.watched(self.now.mode),
                    interval=interval,
                    settler=self.settler,
                    end=end,
                    instant=tolerance,
                    start=start,
                )
                march = None if taken is None else march
                begins &= taken is None or not len(taken.t)
                if taken is not None and len(taken.t):
                    y = self._note_march(taken, y, equations)
                    beyond = max(beyond - 0.1 * len(taken.t), 0.0)
                    if taken.arrived:
                        return y, self.timed_cause(interval) if interval.end <= end else "guard"
                    if taken.event:
                        return y, "guard"
                    if taken.interrupted:
                        continue
            if field is None:
                field = self._begun(y, end, interval, equations, jumped=begins)
                begins = False
            step = self._followed(self._guarded(lambda: self.solver.step(end)), interval, equations)
            self.now.steps += 1
            self.now.rejected += step.rejected
            beyond = max(beyond - 0.1, 0.0) if program.refused is None else beyond + 1.0
            if program.refused is not None and beyond > BEYOND:
                raise program.refused
            at = locator.first(step)
            if at is not None:
                step, at = self._land(step, at, locator)
                if at >= end - tolerance:
                    # one instant with the timed event: settled once, there
                    at = None
                    if step.t1 < end:
                        step = self._guarded(lambda: self.solver.retry(end))
            if at is None:
                y = self._note(step, step.t1, np.asarray(step.y1), equations)
                if step.t1 >= end:
                    return y, self.timed_cause(interval) if interval.end <= end else "guard"
                self._continue(field, y, step)
                continue
            state = step.y1 if at == step.t1 else step.interpolant(at)
            y = self._note(step, at, np.asarray(state), equations)
            y = self._to_rest(y, end, equations)
            timed = self.now.t >= end and interval.end <= end
            return y, self.timed_cause(interval) if timed else "guard"

    def _begun(
        self, y: Vector, end: float, interval: Interval, equations: ModeEquations, *, jumped: bool
    ) -> Field:
        """Tell the solver where it starts, and return the field that it was given."""
        view = None if self.slider is None else self.slider.view
        field = (view.program if view else self.program).field(equations, interval)
        if self.solver.propagates:
            self.solver.linear = None if view else self._linear.of(equations, interval)
            if view:
                self.program.linear.slid(view.number)
        self._guarded(lambda: self.solver.start(field, self.now.t, y, t_bound=end, jumped=jumped))
        return field

    def _check_steps(self) -> None:
        """Refuse to fill the memory with steps of one segment."""
        assert self._recorder is not None
        begin, now = self._recorder.t[0], self.now.t
        if len(self._recorder.t) <= self.limits.max_steps:
            return
        mean = (now - begin) / len(self._recorder.t)
        raise NumericsError(
            f"{self.limits.max_steps} steps without an event by t = {now:.9g} s, "
            f"of {mean:.3g} s in the mean",
            code="HB-N409",
            where=self.settler.text(self.now.mode),
            hint="a model as stiff as that wants solver = 'auto' or 'radau'; else raise max_steps",
        )

    def _marching(self, view: View | None) -> March | None:
        """Return what marches, if nothing else has to see every step."""
        slow = view is not None or self.landings.landed or self.frictions.laws or self.stops.slips
        return None if slow else self.march

    def _note_march(self, taken: Marched, y: Vector, equations: ModeEquations) -> Vector:
        """Note the steps of a march from the state `y`."""
        recorder = self._recorder
        assert recorder is not None
        t = [self.now.t, *taken.t.tolist()]
        rows = [y, *taken.y]
        for k, dense in enumerate(taken.dense):
            recorder.interpolants.append(
                Polynomial(t[k], float(taken.stop[k]), rows[k], taken.end[k], dense)
            )
        recorder.t += t[1:]
        recorder.y += rows[1:]
        self.now.t = t[-1]
        self.now.steps += len(taken.t)
        self.now.marched += len(taken.t)
        self.now.rejected += taken.rejected
        laws = self.settler.trials.laws
        if laws.laws:
            laws.observed(taken.gaps)
            if equations.storage.linear:
                stored = equations.storage.linear_energy(taken.y[:, : self.program.nx])
                self.trace.energy = max(self.trace.energy, float(np.abs(stored).max()))
        if self.progress is not None:
            self.progress(self.now.t, self.trace.events.total)
        return np.asarray(rows[-1])

    def _terms(self, y: Vector, interval: Interval, equations: ModeEquations) -> Vector:
        """Return the size of what the rate of each stored quantity cancels from.

        Where all is still and nothing pushes yet, that of a moment later, so that a force that
        grows from zero like a high power of time has a size.
        """
        program = self.program
        nx, ns = program.nx, program.ns
        soon = min(SHORT * self.limits.until, 0.5 * (interval.end - self.now.t))
        for t in (self.now.t, self.now.t + soon):
            v = program.values(t, interval, self.now.mode, y[:nx], y[nx : nx + ns])
            size = equations.solution(v, y[:nx]).size[equations.storage.bond]
            if size.any():
                break
        return np.asarray(size)

    def _followed(self, step: Step, interval: Interval, equations: ModeEquations) -> Step:
        """Repeat a step shorter until it follows slip in the plane."""
        for _ in range(SHORTER):
            if self.stops.follows(step, self.now.mode, interval, equations):
                return step
            h = 0.25 * (step.t1 - step.t0)
            if self.stops.step is not None:
                self.trace.warn(
                    f"fixed steps are too long for slip in the plane (first at t = {step.t0:.4g} s)"
                    ": it turns or stops within one of them"
                )
                return step
            if step.t0 + h == step.t0:
                raise NumericsError(
                    f"no step follows the slip at t = {step.t0:.9g} s",
                    code="HB-N408",
                    where=", ".join(s.path for s in self.stops.slips if self.now.mode[s.machine]),
                    hint="tighten rtol, or take solver = 'rk45'",
                )
            step = self._guarded(lambda end=step.t0 + h: self.solver.retry(end))  # type: ignore[misc]
        return step

    def _land(self, step: Step, at: float, locator: Locator) -> tuple[Step, float]:
        """Repeat the step so that it ends just past `at`, for the full accuracy of a step."""
        h = step.t1 - step.t0
        for past in (1e-6, 1e-3):
            end = at + past * (at - step.t0)
            if end >= step.t1 or end - step.t0 <= 1e-9 * h:
                break
            shorter = self._guarded(lambda end=end: self.solver.retry(end))  # type: ignore[misc]
            again = locator.first(shorter)
            if again is not None:
                return shorter, again
        return step, at

    def _note(self, step: Step, t: float, y: Vector, equations: ModeEquations) -> Vector:
        """Note a step that ends at `t`, and put the state back on its constraints."""
        assert self._recorder is not None
        y = on_constraints(
            self.program,
            equations,
            self._recorder.interval,
            t,
            y,
            energy=self.trace.energy,
        )
        if isinstance(equations, Combined):
            y = equations.onto(t, y)
        y = self.landings.still(y, equations)
        laws = self.settler.trials.laws
        if laws.laws:
            nx, ns = self.program.nx, self.program.ns
            interval = self._recorder.interval
            laws.observe(self.program.values(t, interval, self.now.mode, y[:nx], y[nx : nx + ns]))
            if equations.storage.linear:
                stored = equations.storage.energy(y[:nx])
                self.trace.energy = max(self.trace.energy, abs(stored))
        y = self.stops.armed(t, y, self.now.mode, self._recorder.interval, equations)
        self._recorder.t.append(t)
        self._recorder.y.append(y)
        self._recorder.interpolants.append(step.interpolant)
        self.now.t = t
        if self.frictions.laws:
            v = self.program.evaluate(t, y, self._recorder.interval, equations)
            self.frictions.check(t, v)
        if self.progress is not None:
            self.progress(t, self.trace.events.total)
        return y

    def _to_rest(self, y: Vector, end: float, equations: ModeEquations) -> Vector:
        """Lead slip in the plane to its end, if it is about to end."""
        assert self._recorder is not None
        interval = self._recorder.interval
        descent = self.stops.descent(self.now.t, y, self.now.mode, interval, equations)
        if descent is None:
            return y
        y = y.copy()
        machines = [
            replace(m, rules=()) if m.law is not None and m.law.planar else m
            for m in self.landings.machines or self.program.graph.machines
        ]
        watched = watch(self.settler.trials.guards, self.now.mode, machines)
        locator = Locator(self.program, self.settler, equations, interval, watched)
        while self.now.t < end and (step := descent.step(self.now.t, y, end)) is not None:
            if step.t1 == step.t0:
                break
            at = locator.first(step)
            if at is not None:
                descent.resting = []
                y = self._note(step, at, np.asarray(step.interpolant(at)), equations).copy()
                break
            y = self._note(step, step.t1, np.asarray(step.y1), equations).copy()
            if descent.resting:
                break
        y = descent.ended(self.now.t, y)
        self._recorder.y[-1] = y
        return y

    def _continue(self, field: Field, y: Vector, step: Step) -> None:
        """Tell the solver of a state that was put back on its constraints: no jump, no history."""
        if not np.array_equal(y, step.y1):
            self.solver.start(field, self.now.t, y, t_bound=self.limits.until, jumped=False)

    def _guarded(self, action: Callable[[], object]) -> Step:
        self.program.refused = None
        try:
            return action()  # type: ignore[return-value]
        except StepFailure as error:
            if error.code == "HB-N202" and self.program.refused is not None:
                raise self.program.refused from None
            if error.component is not None:
                error.where = self._component(error.component)
            raise

    def _component(self, k: int) -> str:
        graph = self.program.graph
        if k < len(graph.storages):
            return graph.storages[k].path
        k -= len(graph.storages)
        return graph.integrals[k].path if k < len(graph.integrals) else "energy"

    def watched(self, mode: Mode) -> Watched:
        """Return the guards that leave a mode, with the rules in force."""
        key = mode, self.landings.names
        if key not in self._watched:
            guards = self.settler.trials.guards
            self._watched[key] = watch(guards, mode, self.landings.machines)
        return self._watched[key]

    def timed_cause(self, interval: Interval) -> Cause:
        """Return what the timed event is that ends an interval."""
        return cause_at(self.program.graph, interval.end)

    def close(self) -> None:
        """Write down the segment under way, if there is one."""
        if self._recorder is not None:
            if len(self._recorder.t) > 1 or not self.trace.segments:
                self.trace.segments.append(self._recorder.segment())
            self._recorder = None
