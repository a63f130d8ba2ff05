"""The executive of time-stepping: what `executive` is for events, without locating any.

The whole algorithm::

    x, s, mode <- settle at t = 0                       (settle.py; an event of cause "start")
    while t < until:
      interval <- what inputs and comparisons of time are from t to the next timed event
      repeat
        one step of fixed length, the last one shortened to the timed event or `until` (moreau.py):
          all junction laws at once; branches that changed, and impacts, are noted as an event of
          cause "step" that happened somewhere in (t, t + h]
        if a guard of a machine written by hand holds at the end of the step: settle there
      until the timed event, or `until`
      settle with inputs before and after the instant

An impulse and a force that acts for the length of a step are the same here: the event says the
percussion of the step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.blocks.runners import Runner
from hybond.errors import HybondError, NumericsError
from hybond.model.expressions import Number
from hybond.model.graph import Mode
from hybond.model.interval import Interval, interval_after
from hybond.modes.laws.limits import FrictionLimits
from hybond.modes.motion import Limits, Progress
from hybond.modes.sampling import Sampling
from hybond.modes.settle import Settler, cause_at, event_of
from hybond.modes.stepping.error import BAD, StepError, compare
from hybond.modes.stepping.moreau import Advance, Point, ThetaScheme
from hybond.modes.stepping.record import event_of_step
from hybond.programs.program import Program
from hybond.trace import Cause, Event, Segment, Trace
from hybond.units import format_quantity

Vector = NDArray[np.float64]

SLACK = 1e-9
"""Part of a step within which a time counts as a point of the grid."""
ROUNDED = 4.0 * float(np.finfo(float).eps)
"""Part of the time by which the difference of two times may be off."""
FEW = 20
"""With fewer steps a run is warned about: the comparison with longer steps says nothing then."""
SAME = 1e-12
"""Two runs that differ by less may have sampled a periodic input at the same phase each time."""
INCOMMENSURATE = 0.5 * (1.0 + 5.0**0.5)
"""Then the step is compared with one longer by the ratio that no fraction comes close to."""
CHATTER = 100
"""Steps in a row at whose ends one machine fires, after which a warning says so."""


class TimeStepping:
    """Runs one program in fixed steps; `trace` holds what it did, whatever happens.

    Parameters
    ----------
    program : Program
    limits : Limits
    step : float
        s.
    theta : float
        See `moreau.ThetaScheme`.
    max_writes : int
        See `settle.Settler`.
    progress : callable
    coarser : float or None
        The run is repeated with steps longer by this factor, to estimate its error.
    runners : mapping
        See `sampling.Sampling`.
    """

    def __init__(
        self,
        program: Program,
        limits: Limits,
        *,
        step: float,
        theta: float = 0.5,
        max_writes: int = 1000,
        progress: Progress | None = None,
        coarser: float | None = 2.0,
        runners: Mapping[str, Runner] | None = None,
    ) -> None:
        self.program = program
        self.graph = program.graph
        self.limits = limits
        self.h = step
        self.progress = progress
        # with two steps in all there is nothing to compare
        # and a block may run once only
        self.coarser = coarser if limits.until > 4.0 * step and not runners else None
        self._judged = coarser is not None
        self.trace = Trace()
        self.settler = Settler(program, self.trace, max_writes=max_writes)
        self.sampling = Sampling(program, runners, until=limits.until)
        self.scheme = ThetaScheme(program, theta)
        self.frictions = FrictionLimits(program)
        self._hand = any(m.law is None for m in self.graph.machines)
        self._guards: dict[Mode, list[tuple[int, Callable[..., float]]]] = {}
        self._points: list[Point] = []
        self._row: dict[int, tuple[int, int]] = {}
        self._shared: set[str] = set()
        self._unbalanced = 0.0
        self._steps = 0

    def run(self, y: Vector) -> str:
        """Run from the state `y`; return ``"ok"``.

        Raises
        ------
        HybondError
            What stopped the run. `trace` is complete up to there.
        KeyboardInterrupt
            Likewise.
        """
        interval = interval_after(self.graph, 0.0)
        start = Point(0.0, y, np.zeros(2 * len(self.graph.bonds)), self.graph.start_mode)
        point = self._settle(start, interval, interval, "start")
        if self.frictions.laws:
            self.frictions.check(0.0, self._values(point, interval))
        self._warn_of_friction()
        try:
            while point.t < self.limits.until:
                self._points = [point]
                point = self._flow(point, interval)
                following = interval_after(self.graph, point.t)
                if point.t >= interval.end:
                    self._close(interval)
                    point = self._settle(point, interval, following, cause_at(self.graph, point.t))
                interval = following
        finally:
            self._close(interval)
            self.trace.stats.update(
                steps=float(self._steps),
                evaluations=float(self.program.evaluations),
                modes=float(self.program.built),
                energy_unbalanced=self._unbalanced,
            )
        if self.coarser is not None:
            self._compare(y, self.coarser)
        if self._judged and self._steps < FEW:
            self._warn_of_few_steps()
        return "ok"

    def _warn_of_few_steps(self) -> None:
        """Say that the step is coarse, and whether anything was estimated."""
        estimate = "error estimate means little" if self.coarser else "error cannot be estimated"
        count = f"{self._steps} step" + "s" * (self._steps != 1)
        self.trace.warn(
            f"step = {format_quantity(self.h, 's')} is coarse: the run has only {count}, and its "
            f"{estimate}; try step = {format_quantity(self.limits.until / 1000.0, 's')} or less"
        )

    def _compare(self, y: Vector, factor: float) -> None:
        """Run with a longer step, and note what the difference says."""
        error = self._apart(y, factor)
        if error is not None and max(error.end, error.mean) <= SAME:
            error = self._apart(y, INCOMMENSURATE) or error
        if error is not None:
            self.trace.stats["step_error"] = max(error.end, error.mean)
            self.trace.stats["step_advised"] = error.advised
            if max(error.end, error.mean) > BAD:
                self.trace.warn(error.text())

    def _apart(self, y: Vector, factor: float) -> StepError | None:
        """Return how far a run with steps longer by `factor` is from this one, if it can be."""
        coarse = TimeStepping(
            self.program,
            self.limits,
            step=factor * self.h,
            theta=self.scheme.theta,
            max_writes=self.settler.max_writes,
            # so that a run can be interrupted here as well
            progress=None if self.progress is None else self._progress_at_end,
            coarser=None,
        )
        try:
            coarse.run(y)
        except (HybondError, KeyboardInterrupt):
            return None
        return compare(self.graph, self.h, self.trace, coarse.trace)

    def _progress_at_end(self, _: float, __: int) -> None:
        if self.progress is not None:
            self.progress(self.limits.until, len(self.trace.events))

    # -- steps

    def _flow(self, point: Point, interval: Interval) -> Point:
        """Step to the next timed event or the end."""
        end = min(interval.end, self.limits.until)
        t0, k = point.t, 1
        while point.t < end:
            grid = t0 + k * self.h
            t1 = end if end <= grid + SLACK * self.h else grid
            k += 1
            before = point
            h = t1 - before.t
            if abs(h - self.h) <= ROUNDED * abs(t1):
                h = self.h
            try:
                advance = self.scheme.step(before, interval, t1, h=h, energy=self.trace.energy)
            except HybondError:
                # friction that pushes leaves no solution: then that is the reason
                self.frictions.check(t1, self._values(replace(before, t=t1), interval))
                raise
            point = advance.end
            self._steps += 1
            self.program.evaluations += 1
            self._look_after_energy(advance)
            if self.frictions.laws:
                self.frictions.check(point.t, self._values(point, interval))
            self._warn_of_shares(advance)
            event = event_of_step(self.program, before, advance)
            self._points.append(replace(point, mode=before.mode))
            if event is not None:
                self._note(event)
                if advance.ambiguous:
                    self.trace.warn(
                        f"the laws of {', '.join(advance.ambiguous)} have more than one solution "
                        f"(first in the step that ends at t = {t1:.9g} s); the one nearest to the "
                        "branches before was taken"
                    )
            if point.mode != before.mode:
                self._close(interval)
                self._points = [point]
            if t1 < interval.end and self._fires(point, interval):
                self._close(interval)
                point = self._settle(point, interval, interval, "guard", since=before.t)
                self._points = [point]
            if self.progress is not None:
                self.progress(point.t, len(self.trace.events))
        return point

    def _look_after_energy(self, advance: Advance) -> None:
        storage = advance.ports.equations.storage
        stored = abs(storage.energy(advance.end.y[: self.program.nx]))
        self.trace.energy = max(self.trace.energy, stored)
        self._unbalanced += max(advance.unbalanced, 0.0)

    def _fires(self, point: Point, interval: Interval) -> bool:
        """Whether a guard of a machine written by hand holds at the end of a step."""
        if not self._hand:
            return False
        program = self.program
        if point.mode not in self._guards:
            self._guards[point.mode] = [
                (m.index, program.compile(r.guard))
                for m, k in zip(self.graph.machines, point.mode, strict=True)
                for r in m.rules
                if m.law is None and r.source == k
            ]
        v = self._values(point, interval)
        # each machine once, in their order: so are the warnings
        true = dict.fromkeys(index for index, f in self._guards[point.mode] if f(v))
        for index in true:
            last, count = self._row.get(index, (-1, 0))
            count = count + 1 if last == self._steps - 1 else 1
            self._row[index] = self._steps, count
            if count == CHATTER:
                self.trace.warn(
                    f"the machine {self.graph.machines[index].path} fires at the end of every step "
                    f"since about t = {point.t:.4g} s: time-stepping looks at machines written by "
                    "hand only there; a junction law has no such limit"
                )
        return bool(true)

    def _values(self, point: Point, interval: Interval) -> list[float]:
        """Return all values at the end of a step."""
        program = self.program
        n, nx, ns = program.slots.size, program.nx, program.ns
        v = program.values(point.t, interval, point.mode, point.y[:nx], point.y[nx : nx + ns])
        v[program.slots.w] = point.w.tolist()
        v[n:] = v[:n]
        return v

    # -- instants

    def _settle(
        self,
        point: Point,
        before: Interval,
        after: Interval,
        cause: Cause,
        *,
        since: float | None = None,
    ) -> Point:
        program = self.program
        nx, ns = program.nx, program.ns
        x, s = point.y[:nx].copy(), point.y[nx : nx + ns].copy()
        held = self.sampling.held(point.t, x, s, point.mode, before, self.settler.trials)
        try:
            settled = self.settler.settle(
                point.t, x, s, point.mode, before, after, start=cause == "start", held=held
            )
        except HybondError as error:
            if self._hand or error.code not in ("HB-J110", "HB-J111"):
                raise
            # the next step decides what an instant cannot
            self.trace.warn(f"at t = {point.t:.9g} s the next step decides: {error.why}")
            ports = self.scheme.ports(point.mode, after, point.t)
            s = s if held is None else held
            v = program.values(point.t, after, point.mode, x, s)
            y = np.concatenate([x, s, point.y[nx + ns :]])
            return replace(point, y=y, w=ports.solve(v, x, np.zeros(len(ports.ports))))
        if settled.steps:
            self._note(replace(event_of(point.t, cause, settled, x, s), t0=since))
        y = np.concatenate([settled.x, settled.s, point.y[nx + ns :]])
        equations = program.equations(settled.mode, after, point.t)
        v = program.evaluate(point.t, y, after, equations)
        return Point(point.t, y, np.array(v[program.slots.w]), settled.mode)

    def _note(self, event: Event) -> None:
        self.trace.events.append(event)
        if len(self.trace.events) > self.limits.max_events:
            raise NumericsError(
                f"more than {self.limits.max_events} events by t = {event.t:.9g} s",
                code="HB-N404",
                where=self.settler.text(event.steps[-1].mode),
                hint="look for chattering, or raise max_events",
            )

    def _close(self, interval: Interval) -> None:
        """Note the points since the last event as a segment."""
        points = self._points
        if len(points) > 1 or (points and not self.trace.segments):
            self.trace.segments.append(
                Segment(
                    points[0].mode,
                    interval,
                    np.array([p.t for p in points]),
                    np.array([p.y for p in points]),
                    (),
                    bonds=np.array([p.w for p in points]),
                )
            )
        self._points = []

    def _warn_of_shares(self, advance: Advance) -> None:
        """Say once whose shares the equations leave open."""
        if not self._shared.issuperset(advance.shared):
            self._shared.update(advance.shared)
            self.trace.warn(
                f"the equations leave open how {', '.join(advance.shared)} share what they carry "
                f"(first in the step that ends at t = {advance.end.t:.9g} s); least leakage decides"
            )

    def _warn_of_friction(self) -> None:
        """Say where this scheme means something else than an impact without friction."""
        paths = [
            m.path
            for m in self.graph.machines
            if m.law is not None and m.law.limit is not None and not isinstance(m.law.limit, Number)
        ]
        contacts = any(m.law is not None and m.law.gap is not None for m in self.graph.machines)
        if paths and contacts:
            self.trace.warn(
                f"time-stepping lets the friction of {', '.join(paths)} act during impacts as well"
            )
