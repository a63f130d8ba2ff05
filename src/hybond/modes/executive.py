"""The executive: time passes in a mode until something happens, then the mode is settled.

The whole algorithm::

    x, s, mode <- settle at t = 0                       (settle.py; an event of cause "start")
    while t < until:
      let the kernel run through events as far as it is sure of them (marching.py)
      interval <- what inputs and comparisons of time are from t to the next timed event
      move through one segment (motion.py):
        start the solver in mode's field; it is told that field or state jumped
        repeat
          let the kernel make steps as far as it is sure (marching.py); where it stops, make one:
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
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.blocks.runners import Runner
from hybond.engine.outcome.journal import Journal
from hybond.equations.mode import undetermined_names
from hybond.errors import NumericsError
from hybond.model.interval import Interval, interval_after
from hybond.modes.landing.landing import MOMENT, Landings
from hybond.modes.locate import Locator, watch
from hybond.modes.marching import Course, March, Passage
from hybond.modes.motion import Limits, Motion, Now, Progress
from hybond.modes.recall import Recall
from hybond.modes.sampling import Sampling
from hybond.modes.settle import Settler, event_of
from hybond.modes.sliding.motion import Slider
from hybond.programs.program import Program
from hybond.solvers import Solver
from hybond.trace import Cause, Trace
from hybond.uncollected import uncollected

Vector = NDArray[np.float64]
VAIN = 3
"""Instants in a row without any change after which rounding is swept out of what is stored."""
IDLE = 100
"""Instants in a row without any change that end a run."""


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
        self.march = march
        self.trace = Trace()
        self.settler = Settler(program, self.trace, max_writes=max_writes)
        self.slider = Slider(program, self.trace, max_writes=max_writes) if sliding else None
        self.settler.trials.impact_law, self.settler.trials.impact_exponent = impact
        self.sampling = Sampling(program, runners, until=limits.until)
        self.now = Now(program.graph.start_mode)
        self.landings = Landings(program, self.settler, self.trace, limits.until)
        self.motion = Motion(
            program,
            solver,
            limits,
            self.now,
            self.trace,
            self.settler,
            self.landings,
            self.slider,
            rtol=rtol,
            march=march,
            started=started,
            progress=progress,
        )
        self.keep = keep
        self.journal = journal
        self._recall = Recall(program, max_writes=max_writes, cause=self.motion.timed_cause)
        self._course = Course(
            self.settler,
            self.landings,
            self.motion.watched,
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
            while self.now.t < self.limits.until:
                y, interval = self._passed(y, interval)
                y, cause = self.motion.flow(y, interval)
                self.motion.close()
                following = interval_after(program.graph, self.now.t)
                y = self._settle(y, interval, following, cause)
                interval = following
                y = self._rest(y, interval)
                self._tidy()
                if self.landings.stuck(self.now.t):
                    return "accumulation"
        finally:
            self.motion.close()
            self._tidy()
            if self.slider is not None:
                self.slider.close(self.now.t)
            self.trace.stats.update(
                steps=float(self.now.steps),
                rejected=float(self.now.rejected),
                marched=float(self.now.marched),
                events=float(self.trace.events.total),
                crossed=float(self.now.crossed),
                evaluations=float(program.evaluations),
                modes=float(program.built),
            )
            if self.march is not None:
                done = f"{self.now.marched} of {self.now.steps} steps"
                done += f", {self.now.crossed} of {self.trace.events.total} events"
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
                mode=self.now.mode,
                t=self.now.t,
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
                self._write(found)
                self._tidy()
                self.landings.observe_many(
                    found.t[found.changed],
                    found.approach[found.changed],
                    found.fired[found.changed],
                )
                self.now.t, self.now.mode = float(found.t[-1]), found.mode[-1]
                y, interval = found.after[-1].copy(), found.around(len(found.t) - 1)[1]
                self._idle = []
                for mode in dict.fromkeys(found.mode):
                    equations = self.program.equations(mode, interval, self.now.t)
                    names = undetermined_names(self.program.graph, equations.freedom)
                    self.settler.note_open(mode, names)
                self.now.steps += len(found.marched.t)
                self.now.marched += len(found.marched.t)
                self.now.rejected += found.marched.rejected
                self.now.crossed += int(found.changed.sum())
                if self.progress is not None:
                    self.progress(self.now.t, self.trace.events.total)
            if not found.again:
                break
        return y, interval

    def _write(self, passage: Passage) -> None:
        """Write the events of a passage to the journal, with the cause of each segment's end."""
        if self.journal is None:
            return
        causes = self._recall.causes(passage)
        stored = passage.after[:, : passage.before.shape[1]].tolist()
        for k, changed in enumerate(passage.changed.tolist()):
            if changed:
                self.journal.row(float(passage.t[k]), causes[k], passage.mode[k], stored[k])

    def _tidy(self) -> None:
        """Write events to the journal, and let go of what need not be kept."""
        events, segments = self.trace.events, self.trace.segments
        if self.journal is not None:
            for k in range(self.journal.written - events.forgotten, len(events)):
                e = events[k]
                self.journal.row(e.t, e.cause, e.steps[-1].mode, e.after.tolist())
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
            self.motion.frictions.laws
            or self.landings.landed
            or (slider is not None and slider.view is not None)
            or self.program.selective
        )

    # -- instants

    def _settle(self, y: Vector, before: Interval, after: Interval, cause: Cause) -> Vector:
        nx, ns = self.program.nx, self.program.ns
        x, s = y[:nx].copy(), y[nx : nx + ns].copy()
        view = None if self.slider is None else self.slider.view
        self.settler.trials.sweep = len(self._idle) >= VAIN
        settler = view.settler if view else self.settler
        held = self.sampling.held(self.now.t, x, s, self.now.mode, before, settler.trials)
        settled = settler.settle(
            self.now.t, x, s, self.now.mode, before, after, start=cause == "start", held=held
        )
        if settled.steps:
            noted = event_of(self.now.t, cause, settled, x, s)
            self.landings.observe(noted, self.now.mode, before)
            self.trace.events.append(replace(noted, landed=self.landings.names))
        self._idle = [] if settled.steps or cause != "guard" else [*self._idle[-IDLE:], self.now.t]
        if len(self._idle) > IDLE and self.now.t - self._idle[0] <= MOMENT * self.limits.until:
            raise self._stands_still(y, before)
        if self.trace.events.total > self.limits.max_events:
            raise NumericsError(
                f"more than {self.limits.max_events} events by t = {self.now.t:.9g} s",
                code="HB-N404",
                where=self.settler.text(self.now.mode),
                hint="look for chattering, or raise max_events",
            )
        self.now.mode = settled.mode
        y = np.concatenate([settled.x, settled.s, y[nx + ns :]])
        if self.slider is not None:
            event = self.trace.events[-1] if settled.steps else None
            y, self.now.mode = self.slider.after(
                self.now.t, y, self.now.mode, event, after, cause=cause
            )
        return y

    def _stands_still(self, y: Vector, interval: Interval) -> NumericsError:
        """Return the refusal of guards that hold again and again without any change."""
        equations = self.program.equations(self.now.mode, interval, self.now.t)
        watched = watch(self.settler.trials.guards, self.now.mode, self.landings.machines)
        locator = Locator(self.program, self.settler, equations, interval, watched)
        texts = [rule.text for rule in watched.rules if locator.holds(rule, self.now.t, y)]
        return NumericsError(
            f"a guard holds {IDLE} times in a row at t = {self.now.t:.9g} s, and nothing changes",
            code="HB-N406",
            where=", ".join(texts) or self.settler.text(self.now.mode),
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
        while (landed := self.landings.land(self.now.t, y, self.now.mode, interval)) is not None:
            self.now.t, y, self.now.mode, event = landed
            self.trace.events.append(event)
        return y
