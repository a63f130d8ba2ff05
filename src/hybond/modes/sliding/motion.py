"""Sliding: motion along switching surfaces into which the modes on both sides push.

When a machine's rule fires without a jump, its reverse rule may push the state straight back.
Both directions then belong to one switching surface (`equations.surfaces`), and at the first such
event, not after many, the fields around decide (`modes.sliding.filippov`): through the surface, or
along it in the combined motion (`programs.combined`). While machines slide,

* their two rules rest; every other rule is watched as ever, on the averaged signals;
* their weights are watched: at 0 or 1 a machine leaves the surface on that side;
* so is whatever else their rules ask for, and time events: after each event the fields decide anew,
  about the surfaces slid on and those just met, all at once.

Modes that hold stored quantities to different constraints are slid between where all of these are
met (`meeting`, `programs.common_space`); jumps that vanish may lead there (`crossings`). A mode
whose jumps stay is not slid into, nor one whose switching function differs from the other's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.combinations import Kind, corners_of, flipped
from hybond.engine.outcome.named_rows import NamedRows, named_rows
from hybond.equations.surfaces import Surface, SurfaceLaws, coincide, surfaces_of
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.sliding.crossings import Collapse, sides_of
from hybond.modes.sliding.filippov import ABOVE, SLIDES
from hybond.modes.sliding.meeting import meet
from hybond.modes.sliding.transitions import fired_machines, moved, there_and_back, transitions
from hybond.modes.sliding.view import SlidingSettler, View, resting
from hybond.modes.sliding.ways import WaysOn
from hybond.programs.combined import Combined
from hybond.programs.program import Program
from hybond.programs.sliding_program import SlidingProgram
from hybond.trace import Cause, Energy, Event, Fired, Sliding, Step, Trace

Vector = NDArray[np.float64]

AT_ONCE = 1e-11
"""A state is on a surface if it gets there within this part of the time that has passed."""


class Slider:
    """Begins, changes and ends the sliding of one run; `view` is not None while it lasts."""

    def __init__(self, program: Program, trace: Trace, *, max_writes: int = 1000) -> None:
        self.program = program
        self.graph = program.graph
        self.trace = trace
        self.max_writes = max_writes
        self.surfaces = surfaces_of(program.graph)
        self.view: View | None = None
        self._views: dict[tuple[tuple[Surface, ...], Kind], View] = {}
        self.laws = SurfaceLaws(program.graph, program.slots)
        self.ways = WaysOn(program, trace, self.laws)
        self._plain = [program.compile(s.g) for s in self.surfaces]
        self._rests = [
            [[program.compile(e) for e in rest] for rest in (s.up_rest, s.down_rest)]
            for s in self.surfaces
        ]

    @cached_property
    def named(self) -> NamedRows:
        """The signals that records name."""
        return named_rows(self.graph)

    # -- after an event

    def after(
        self,
        t: float,
        y: Vector,
        mode: Mode,
        event: Event | None,
        interval: Interval,
        *,
        cause: Cause,
    ) -> tuple[Vector, Mode]:
        """Decide which machines slide from `t` on; return the state and mode of the motion.

        Parameters
        ----------
        t : float
        y : array, shape (nx + ns + 2,)
            The state that was settled.
        mode : Mode
            The mode that was settled; a sliding machine's state in it is the one shown.
        event : Event or None
            What happened at `t`, if it was recorded.
        interval : Interval
            From `t` on.
        cause : str
            Why time stopped at `t`.
        """
        held = self.view.surfaces if self.view is not None else ()
        if not self.surfaces or (event is None and not held and cause == "guard"):
            return y, mode
        met = self._met(t, y, mode, event, held, interval, anew=cause != "guard")
        if not met and not held:
            return y, mode
        decided = self.ways.decide(t, y, mode, met, held, interval) if met else None
        collapse: Collapse | None = None
        if decided is None and event is not None and len(met) == 1 and moved(event) and not held:
            branch = self.ways.branches.at(t, y, interval)
            sides = [branch(m) for m in sides_of(met[0], mode)]
            collapse = self.ways.crossings.collapse(met[0], t, y, sides, interval)
            if collapse is not None:
                decided = self.ways.decide(t, collapse.y, mode, met, held, interval)
                collapse = collapse if decided is not None and decided[0].sliding else None
                decided, y = (decided, collapse.y) if collapse is not None else (None, y)
        states = list(mode)
        slid: list[Surface] = []
        kind: Kind = "additive"
        if decided is not None:
            way, kind, met = decided
            fired = fired_machines(self.graph, event)
            # a crossing is what its own rule said, unless another surface has a say in it
            joint = bool(held) or bool(way.sliding)
            for s, side in zip(met, way.sides, strict=True):
                if side == SLIDES:
                    slid.append(s)
                elif s.machine in fired and moved(event) and not joint:
                    # thrown back by its own jump: it stays for no time, and is a pinnacle
                    here = s.above if side == ABOVE else s.below
                    if states[s.machine] != here:
                        states[s.machine] = here
                        y = self._onto(s, t, y, tuple(states), interval)
                elif joint and (s in held or s.machine in fired):
                    states[s.machine] = s.above if side == ABOVE else s.below
        for s in held:
            if s not in met and mode[s.machine] in (s.below, s.above):
                states[s.machine] = self._dropped(s, t, y, mode, interval)
        if self.ways.branches.any and (held or slid):
            # what is shown, and what goes on alone, has the branches of its own laws
            states = list(self.ways.branches.at(t, y, interval)(tuple(states)))
        return self._go_on(
            t, y, mode, tuple(states), tuple(slid), kind, event, interval, cause, collapse
        )

    def close(self, t: float) -> None:
        """Note that the run ends while sliding."""
        if self.view is not None:
            self._note_until(t)

    def _met(
        self,
        t: float,
        y: Vector,
        mode: Mode,
        event: Event | None,
        held: Sequence[Surface],
        interval: Interval,
        *,
        anew: bool,
    ) -> list[Surface]:
        """Return the surfaces that the state is on, one per machine.

        They are sought `anew` where the fields may have jumped, else among those just crossed.
        """
        fired = fired_machines(self.graph, event)
        jumped = moved(event)
        back: set[int] = set()
        if event is not None and jumped:
            change = (event.after - event.before)[: self.program.nx]
            if self.ways.crossings.vanishes(change, y):
                back = there_and_back(self.graph, event)
        anew = anew or jumped
        found: dict[int, Surface] = {}
        v: list[float] | None = None
        for k, s in enumerate(self.surfaces):
            if mode[s.machine] not in (s.below, s.above) or s.machine in found:
                continue
            way = fired.get(s.machine)
            crossed = way in ((s.below, s.above), (s.above, s.below))
            if not (crossed or s in held or anew):
                continue
            if v is None:
                v = self._values(t, y, mode, interval)
            if any(not f(v) for rest in self._rests[k] for f in rest):
                continue
            # at a timed event a rule may have fired because an input jumped over the surface, and
            # one that asks for more because that has come true
            alone = not (s.up_rest if way == (s.below, s.above) else s.down_rest)
            sure = ((crossed and alone and not anew) or s in held) and not jumped
            if s.machine in back:
                # there and back by a pinnacle: towards the surface, if its jumps have vanished
                crossed = sure = True
            if not sure and not self._on(k, v, y, mode, interval):
                continue
            found[s.machine] = s
        return list(found.values())

    def _values(self, t: float, y: Vector, mode: Mode, interval: Interval) -> list[float]:
        program: Program = self.program if self.view is None else self.view.program
        return program.evaluate(t, y, interval, program.equations(mode, interval, t))

    def _on(self, k: int, v: list[float], y: Vector, mode: Mode, interval: Interval) -> bool:
        """Whether the state is on a surface: it was there an instant ago, or will be."""
        s = self.surfaces[k]
        g = float(self._plain[k](v))
        if g == 0.0:
            return True
        motion = self._motion(s, v, y, mode, interval)
        return motion is not None and abs(g) <= AT_ONCE * abs(v[0]) * abs(motion[1])

    def _motion(
        self, s: Surface, v: list[float], y: Vector, mode: Mode, interval: Interval
    ) -> tuple[Vector, float] | None:
        """Return the rates of the state in `mode`, and that of a switching function."""
        program = self.program
        law = self.laws.of(s, sides_of(s, mode))
        if law is None:
            return None
        equations = program.equations(mode, interval, v[0])
        n = program.nx + program.ns
        rate = program.field(equations, interval)(v[0], y)[:n]
        speed = law.along(v, rate[None, : program.nx], rate[None, program.nx :])
        return rate, float(speed[0])

    def _onto(self, s: Surface, t: float, y: Vector, mode: Mode, interval: Interval) -> Vector:
        """Return a state put back on a surface that it is off by rounding, along the motion."""
        program = self.program
        v = program.evaluate(t, y, interval, program.equations(mode, interval, t))
        motion = self._motion(s, v, y, mode, interval)
        if motion is None or motion[1] == 0.0:
            return y
        n = len(motion[0])
        back = float(self._plain[self.surfaces.index(s)](v)) / motion[1]
        return np.concatenate([y[:n] - back * motion[0], y[n:]])

    def _dropped(self, s: Surface, t: float, y: Vector, mode: Mode, interval: Interval) -> int:
        """Return the state of a machine that slides no more: off its surface, or not allowed."""
        k = self.surfaces.index(s)
        v = self._values(t, y, mode, interval)
        up, down = (all(f(v) for f in rest) for rest in self._rests[k])
        if up != down:
            return s.above if up else s.below
        g = float(self._plain[k](v))
        return s.above if g > 0.0 else s.below if g < 0.0 else mode[s.machine]

    # -- going on

    def _go_on(
        self,
        t: float,
        y: Vector,
        before: Mode,
        mode: Mode,
        slid: tuple[Surface, ...],
        kind: Kind,
        event: Event | None,
        interval: Interval,
        cause: Cause,
        collapse: Collapse | None,
    ) -> tuple[Vector, Mode]:
        held = self.view.surfaces if self.view is not None else ()
        if self.view is not None:
            self._note_until(t)
        same = set(slid) == set(held) and self.view is not None and self.view.kind == kind
        fired = transitions(self.graph, before, mode, held, slid)
        if not same:
            self.view = self._viewed(slid, kind, t, mode) if slid else None
        if self.view is not None:
            self._branch(self.view, t, y, interval)
            equations = self.view.program.equations(mode, interval, t)
            assert isinstance(equations, Combined)
            y = equations.onto(t, y)
        if fired:
            self._write(t, y, mode, fired, event, cause, collapse)
        return y, mode

    def _branch(self, view: View, t: float, y: Vector, interval: Interval) -> None:
        """Give the modes that are combined the branches of their junction laws."""
        if not self.ways.branches.any:
            return
        view.program.branches = {}
        view.program.choose = self.ways.branches.at(t, y, interval)

    def _viewed(self, slid: tuple[Surface, ...], kind: Kind, t: float, mode: Mode) -> View:
        view = self._views.get((slid, kind))
        if view is None:
            machines = {s.machine for s in slid}
            twins = [
                s
                for s in self.surfaces
                if s.machine not in machines and any(coincide(s, other) for other in slid)
            ]
            graph = resting(self.graph, slid, twins)
            program = SlidingProgram(
                self.program, graph, slid, kind=kind, laws=self.laws, meet=meet
            )
            settler = SlidingSettler(program, self.trace, max_writes=self.max_writes)
            settler.branches = self.ways.branches
            view = self._views[slid, kind] = View(slid, kind, program, settler, {})
        view.number = len(self.trace.slidings)
        paths = tuple(self.graph.machines[s.machine].path for s in slid)
        modes = [flipped(mode, slid, corner) for corner in corners_of(len(slid), kind)]
        texts = tuple(s.text for s in slid)
        self.trace.slidings.append(Sliding(float(t), float(t), paths, texts, tuple(modes), kind))
        return view

    def _note_until(self, t: float) -> None:
        assert self.view is not None
        record = self.trace.slidings[self.view.number]
        self.trace.slidings[self.view.number] = replace(record, t1=float(t))

    def _write(
        self,
        t: float,
        y: Vector,
        mode: Mode,
        fired: tuple[Fired, ...],
        event: Event | None,
        cause: Cause,
        collapse: Collapse | None,
    ) -> None:
        """Add the decision to what is recorded of this instant."""
        stored = y[: self.program.nx + self.program.ns]
        if event is None:
            step = Step(mode, "continuous", fired, {}, None)
            self.trace.events.append(Event(float(t), cause, (step,), stored, stored))
            return
        assert self.trace.events[-1] is event
        last = event.steps[-1]
        steps: tuple[Step, ...]
        if collapse is not None:
            before, after = collapse.lost
            floor = 1e-12 * np.full_like(collapse.impulses, np.abs(collapse.impulses).max())
            areas = self.named.of(collapse.impulses, floor)
            energy = Energy(before, after, 0.0, before - after)
            steps = (
                replace(last, kind="pinnacle"),
                Step(mode, "continuous", fired, areas, energy),
            )
        elif last.impulses and mode != last.mode and self.view is None:
            left = None if last.energy is None else last.energy.after
            rest = None if left is None else Energy(left, left, 0.0, 0.0)
            steps = (
                replace(last, kind="pinnacle"),
                Step(mode, "continuous", fired, {}, rest),
            )
        else:
            steps = (replace(last, mode=mode, fired=(*last.fired, *fired)),)
        self.trace.events[-1] = replace(event, steps=(*event.steps[:-1], *steps), after=stored)
