"""The executive: time passes in a mode until something happens, then the mode is settled.

The whole algorithm::

    x, s, mode <- settle at t = 0                       (settle.py; an event of cause "start")
    while t < until:
      let the kernel run through events as far as it is sure of them (marching.py)
      interval <- what inputs and comparisons of time are from t to the next timed event
      start the solver in mode's field; it is told that field or state jumped
      repeat
        let the kernel make steps as far as it is sure (marching.py); where it stops, make one here:
        step, not beyond the next timed event or `until`
        find the first instant t* of the step at which a guard that leaves mode holds (locate.py)
        if there is one: repeat the step so that it ends just past t*, find t* again on it, end
          the step there; a t* within `event_tol` of the timed event belongs to the timed event
        put the state back on the mode's constraints, if it has drifted off by rounding
        note the step
      until a guard holds, or the timed event, or `until`
      settle with inputs before and after the instant; note the event if anything changed
      slide along surfaces into which both sides push (sliding.py), leave those that they do not
      land what was hit and whose next flight would be none (landing.py), at the extrapolated limit
      write events to the journal, let go of what need not be kept
      if events still follow each other ever faster: stop, status "accumulation"

Nothing else changes the state: a jump is made by `settle` alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations, undetermined_names
from hybond.errors import NumericsError
from hybond.model.graph import Mode
from hybond.modes.flows import Flows
from hybond.modes.journal import Journal
from hybond.modes.jump import on_constraints
from hybond.modes.landing.landing import MOMENT, Landings
from hybond.modes.laws.limits import FrictionLimits
from hybond.modes.laws.stops import Stops
from hybond.modes.locate import Locator, Watched, watch
from hybond.modes.marching import Course, March, Marched
from hybond.modes.recall import Recall
from hybond.modes.sampling import Runner, Sampling
from hybond.modes.settle import Settler, cause_at, event_of
from hybond.modes.sliding.motion import Slider
from hybond.modes.sliding.view import View
from hybond.programs.combined import Combined
from hybond.programs.interval import Interval, interval_after
from hybond.programs.program import Program
from hybond.solvers import Field, Solver, Step, StepFailure
from hybond.solvers.dense import Polynomial
from hybond.solvers.fixed import FixedStep
from hybond.trace import Cause, Segment, Trace
from hybond.uncollected import uncollected

Vector = NDArray[np.float64]
Progress = Callable[[float, int], None]

VAIN = 3
"""Instants in a row without any change after which rounding is swept out of what is stored."""
IDLE = 100
"""Instants in a row without any change that end a run."""
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
class _Recorder:
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


class Executive:
    """Runs one program with one solver; `trace` holds what it did, whatever happens."""

    @uncollected
    def __init__(
        self,
        program: Program,
        solver: Solver,
        limits: Limits,
        *,
        max_writes: int = 1000,
        progress: Progress | None = None,
        sliding: bool = True,
        impact: tuple[str, float] = ("newton", 1.0),
        rtol: float = 0.0,
        started: Callable[[Vector], None] | None = None,
        march: March | None = None,
        keep: int | None = None,
        journal: Journal | None = None,
        runners: Mapping[str, Runner] | None = None,
    ) -> None:
        self.program = program
        self.solver = solver
        self.limits = limits
        self.progress = progress
        self.started = started
        self.march = march
        self.trace = Trace()
        self.settler = Settler(program, self.trace, max_writes=max_writes)
        self.slider = Slider(program, self.trace, max_writes=max_writes) if sliding else None
        self.settler.trials.impact_law, self.settler.trials.impact_exponent = impact
        step = solver.h if isinstance(solver, FixedStep) else None
        self._linear = Flows(program.linear)
        self.stops = Stops(
            program, self.settler.trials.laws.kept, limits.until, step=step, rtol=rtol
        )
        self.frictions = FrictionLimits(program)
        self.sampling = Sampling(program, runners, until=limits.until)
        self.t = 0.0
        self.mode: Mode = program.graph.start_mode
        self._recorder: _Recorder | None = None
        self.landings = Landings(program, self.settler, self.trace, limits.until)
        self._watched: dict[tuple[Mode, tuple[str, ...]], Watched] = {}
        self._steps = 0
        self._rejected = 0
        self._marched = 0
        self._crossed = 0
        self.keep = keep
        self.journal = journal
        self._recall = Recall(program, max_writes=max_writes, cause=self._timed_cause)
        self._course = Course(
            self.settler,
            self.landings,
            self._watch,
            tuple(self.slider.surfaces) if self.slider is not None else (),
            limits.until,
            limits.event_tol,
            limits.max_events,
        )
        self._idle: list[float] = []
        """Instants in a row at which a guard held and nothing changed."""

    def run(self, y: Vector) -> str:
        """Run from the state `y`; return ``"ok"`` or ``"accumulation"``.

        Raises
        ------
        HybondError
            What stopped the run. `trace` is complete up to there.
        KeyboardInterrupt
            Likewise.
        """
        program = self.program
        interval = interval_after(program.graph, 0.0)
        y = self._settle(y, interval, interval, "start")
        interval = interval_after(program.graph, 0.0)
        y = self._rest(y, interval)
        try:
            while self.t < self.limits.until:
                y, interval = self._passed(y, interval)
                y, cause = self._flow(y, interval)
                self._close()
                following = interval_after(program.graph, self.t)
                y = self._settle(y, interval, following, cause)
                interval = following
                y = self._rest(y, interval)
                self._tidy()
                if self.landings.stuck(self.t):
                    return "accumulation"
        finally:
            self._close()
            self._tidy()
            if self.slider is not None:
                self.slider.close(self.t)
            self.trace.stats.update(
                steps=float(self._steps),
                rejected=float(self._rejected),
                marched=float(self._marched),
                events=float(self.trace.events.total),
                crossed=float(self._crossed),
                evaluations=float(program.evaluations),
                modes=float(program.built),
            )
            if self.march is not None:
                done = f"{self._marched} of {self._steps} steps"
                done += f", {self._crossed} of {self.trace.events.total} events"
                self.trace.kernel = "; ".join([done, *self.march.reasons()])
            if self.solver.propagates:
                self.trace.method = program.linear.report("rk45")
                self.trace.stats["propagated"] = float(program.linear.found[""])
        return "ok"

    def _passed(self, y: Vector, interval: Interval) -> tuple[Vector, Interval]:
        """Let the kernel run through whole segments; return where it leaves the run."""
        while self._passable() and self.march is not None:
            last = self.trace.events.times[-1] if self.trace.events else -math.inf
            found = self.march.cross(
                self._course,
                mode=self.mode,
                t=self.t,
                y=y,
                interval=interval,
                last=last,
                events=self.trace.events.total,
            )
            if found is None:
                break
            if len(found.t):
                self._tidy()
                self._recall.note(found, self.trace)
                if self.journal is not None:
                    self.journal.passage(found, self._recall.causes(found))
                self._tidy()
                self.landings.observe_many(
                    found.t[found.changed],
                    found.approach[found.changed],
                    found.fired[found.changed],
                )
                self.t, self.mode = float(found.t[-1]), found.mode[-1]
                y, interval = found.after[-1].copy(), found.around(len(found.t) - 1)[1]
                self._idle = []
                for mode in dict.fromkeys(found.mode):
                    equations = self.program.equations(mode, interval, self.t)
                    names = undetermined_names(self.program.graph, equations.freedom)
                    self.settler.note_open(mode, names)
                self._steps += len(found.marched.t)
                self._marched += len(found.marched.t)
                self._rejected += found.marched.rejected
                self._crossed += int(found.changed.sum())
                if self.progress is not None:
                    self.progress(self.t, self.trace.events.total)
            if not found.again:
                break
        return y, interval

    def _tidy(self) -> None:
        """Write events to the journal, and let go of what need not be kept."""
        events, segments = self.trace.events, self.trace.segments
        if self.journal is not None:
            for k in range(self.journal.written - events.forgotten, len(events)):
                self.journal.event(events[k])
            self.journal.flush()
        if self.keep is not None:
            # in large pieces: to take one from the front of a list moves all others
            for record in (events, segments):
                if len(record) > 2 * self.keep:
                    record.forget(len(record) - self.keep)

    def _passable(self) -> bool:
        """Whether nothing but the kernel has to see the instants at which segments end."""
        slider = self.slider
        return not (
            self.frictions.laws
            or self.landings.landed
            or (slider is not None and slider.view is not None)
            or self.program.selective
        )

    def _watch(self, mode: Mode) -> Watched:
        """Return the guards that leave a mode, with the rules in force."""
        key = mode, self.landings.names
        if key not in self._watched:
            guards = self.settler.trials.guards
            self._watched[key] = watch(guards, mode, self.landings.machines)
        return self._watched[key]

    # -- continuous motion

    def _flow(self, y: Vector, interval: Interval) -> tuple[Vector, Cause]:
        """Let time pass in the mode; return the state at the instant that ends it, and why."""
        program = self.program
        view = None if self.slider is None else self.slider.view
        equations = (view.program if view else program).equations(self.mode, interval, self.t)
        locator = (
            view.locator(equations, interval)
            if view
            else Locator(program, self.settler, equations, interval, self._watch(self.mode))
        )
        end = min(interval.end, self.limits.until)
        tolerance = self.limits.event_tol * max(self.limits.until, abs(self.t))
        landed = self.landings.names
        if self.frictions.laws:
            self.frictions.check(self.t, self.program.evaluate(self.t, y, interval, equations))
        y = self.stops.begun(self.t, y, self.mode, interval, equations)
        self._recorder = _Recorder(self.mode, interval, [self.t], [y], [], landed, view, equations)
        if self.started is not None and view is None:
            self.started(self._terms(y, interval, equations))
        field: Field | None = None
        beyond = 0.0
        march = self._marching(view)
        begins = True
        while True:
            self._check_steps()
            if march is not None:
                start = (self.t, y) if begins else None
                taken = march.march(
                    equations,
                    self._watch(self.mode),
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
                        return y, self._timed_cause(interval) if interval.end <= end else "guard"
                    if taken.event:
                        return y, "guard"
                    if taken.interrupted:
                        continue
            if field is None:
                field = self._begun(y, end, interval, equations, jumped=begins)
                begins = False
            step = self._followed(self._guarded(lambda: self.solver.step(end)), interval, equations)
            self._steps += 1
            self._rejected += step.rejected
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
                    return y, self._timed_cause(interval) if interval.end <= end else "guard"
                self._continue(field, y, step)
                continue
            state = step.y1 if at == step.t1 else step.interpolant(at)
            y = self._note(step, at, np.asarray(state), equations)
            y = self._to_rest(y, end, equations)
            timed = self.t >= end and interval.end <= end
            return y, self._timed_cause(interval) if timed else "guard"

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
        self._guarded(lambda: self.solver.start(field, self.t, y, t_bound=end, jumped=jumped))
        return field

    def _check_steps(self) -> None:
        """Refuse to fill the memory with steps of one segment."""
        assert self._recorder is not None
        begin, now = self._recorder.t[0], self.t
        if len(self._recorder.t) <= self.limits.max_steps:
            return
        mean = (now - begin) / len(self._recorder.t)
        raise NumericsError(
            f"{self.limits.max_steps} steps without an event by t = {now:.9g} s, "
            f"of {mean:.3g} s in the mean",
            code="HB-N409",
            where=self.settler.text(self.mode),
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
        t = [self.t, *taken.t.tolist()]
        rows = [y, *taken.y]
        for k, dense in enumerate(taken.dense):
            recorder.interpolants.append(
                Polynomial(t[k], float(taken.stop[k]), rows[k], taken.end[k], dense)
            )
        recorder.t += t[1:]
        recorder.y += rows[1:]
        self.t = t[-1]
        self._steps += len(taken.t)
        self._marched += len(taken.t)
        self._rejected += taken.rejected
        laws = self.settler.trials.laws
        if laws.laws:
            laws.observed(taken.gaps)
            if equations.storage.linear:
                stored = equations.storage.linear_energy(taken.y[:, : self.program.nx])
                self.trace.energy = max(self.trace.energy, float(np.abs(stored).max()))
        if self.progress is not None:
            self.progress(self.t, self.trace.events.total)
        return np.asarray(rows[-1])

    def _terms(self, y: Vector, interval: Interval, equations: ModeEquations) -> Vector:
        """Return the size of what the rate of each stored quantity cancels from.

        Where all is still and nothing pushes yet, that of a moment later, so that a force that
        grows from zero like a high power of time has a size.
        """
        program = self.program
        nx, ns = program.nx, program.ns
        soon = min(SHORT * self.limits.until, 0.5 * (interval.end - self.t))
        for t in (self.t, self.t + soon):
            v = program.values(t, interval, self.mode, y[:nx], y[nx : nx + ns])
            size = equations.solution(v, y[:nx]).size[equations.storage.bond]
            if size.any():
                break
        return np.asarray(size)

    def _followed(self, step: Step, interval: Interval, equations: ModeEquations) -> Step:
        """Repeat a step shorter until it follows slip in the plane."""
        for _ in range(SHORTER):
            if self.stops.follows(step, self.mode, interval, equations):
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
                    where=", ".join(s.path for s in self.stops.slips if self.mode[s.machine]),
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
            laws.observe(self.program.values(t, interval, self.mode, y[:nx], y[nx : nx + ns]))
            if equations.storage.linear:
                stored = equations.storage.energy(y[:nx])
                self.trace.energy = max(self.trace.energy, abs(stored))
        y = self.stops.armed(t, y, self.mode, self._recorder.interval, equations)
        self._recorder.t.append(t)
        self._recorder.y.append(y)
        self._recorder.interpolants.append(step.interpolant)
        self.t = t
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
        descent = self.stops.descent(self.t, y, self.mode, interval, equations)
        if descent is None:
            return y
        y = y.copy()
        machines = [
            replace(m, rules=()) if m.law is not None and m.law.planar else m
            for m in self.landings.machines or self.program.graph.machines
        ]
        watched = watch(self.settler.trials.guards, self.mode, machines)
        locator = Locator(self.program, self.settler, equations, interval, watched)
        while self.t < end and (step := descent.step(self.t, y, end)) is not None:
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
        y = descent.ended(self.t, y)
        self._recorder.y[-1] = y
        return y

    def _continue(self, field: Field, y: Vector, step: Step) -> None:
        """Tell the solver of a state that was put back on its constraints: no jump, no history."""
        if not np.array_equal(y, step.y1):
            self.solver.start(field, self.t, y, t_bound=self.limits.until, jumped=False)

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

    def _timed_cause(self, interval: Interval) -> Cause:
        return cause_at(self.program.graph, interval.end)

    def _close(self) -> None:
        if self._recorder is not None:
            if len(self._recorder.t) > 1 or not self.trace.segments:
                self.trace.segments.append(self._recorder.segment())
            self._recorder = None

    # -- instants

    def _settle(self, y: Vector, before: Interval, after: Interval, cause: Cause) -> Vector:
        nx, ns = self.program.nx, self.program.ns
        x, s = y[:nx].copy(), y[nx : nx + ns].copy()
        view = None if self.slider is None else self.slider.view
        self.settler.trials.sweep = len(self._idle) >= VAIN
        settler = view.settler if view else self.settler
        held = self.sampling.held(self.t, x, s, self.mode, before, settler.trials)
        settled = settler.settle(
            self.t, x, s, self.mode, before, after, start=cause == "start", held=held
        )
        if settled.steps:
            noted = event_of(self.t, cause, settled, x, s)
            self.landings.observe(noted, self.mode, before)
            self.trace.events.append(replace(noted, landed=self.landings.names))
        self._idle = [] if settled.steps or cause != "guard" else [*self._idle[-IDLE:], self.t]
        if len(self._idle) > IDLE and self.t - self._idle[0] <= MOMENT * self.limits.until:
            raise self._stands_still(y, before)
        if self.trace.events.total > self.limits.max_events:
            raise NumericsError(
                f"more than {self.limits.max_events} events by t = {self.t:.9g} s",
                code="HB-N404",
                where=self.settler.text(self.mode),
                hint="look for chattering, or raise max_events",
            )
        self.mode = settled.mode
        y = np.concatenate([settled.x, settled.s, y[nx + ns :]])
        if self.slider is not None:
            event = self.trace.events[-1] if settled.steps else None
            y, self.mode = self.slider.after(self.t, y, self.mode, event, after, cause=cause)
        return y

    def _stands_still(self, y: Vector, interval: Interval) -> NumericsError:
        """Return the refusal of guards that hold again and again without any change."""
        equations = self.program.equations(self.mode, interval, self.t)
        watched = watch(self.settler.trials.guards, self.mode, self.landings.machines)
        locator = Locator(self.program, self.settler, equations, interval, watched)
        texts = [rule.text for rule in watched.rules if locator.holds(rule, self.t, y)]
        return NumericsError(
            f"a guard holds {IDLE} times in a row at t = {self.t:.9g} s, and nothing changes",
            code="HB-N406",
            where=", ".join(texts) or self.settler.text(self.mode),
            hint="what it compares is within rounding of its bound: let another guard lead on "
            "from there, or keep values that differ by many orders of magnitude apart",
        )

    def _rest(self, y: Vector, interval: Interval) -> Vector:
        """Land what was hit and does not rebound: time goes on from the limit of its impacts."""
        view = None if self.slider is None else self.slider.view
        if view is None:
            self.landings.use(self.program, self.settler)
        else:
            self.landings.use(view.program, view.settler)
        while (landed := self.landings.land(self.t, y, self.mode, interval)) is not None:
            self.t, y, self.mode, event = landed
            self.trace.events.append(event)
        return y
