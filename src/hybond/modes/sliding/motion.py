"""Sliding: motion along switching surfaces into which the modes on both sides push.

When a machine's rule fires without a jump, its reverse rule may push the state straight back.
Both directions then belong to one switching surface (`equations.surfaces`), and at the first such
event, not after many, the fields around decide (`modes.filippov`): through the surface, or along
it in the combined motion (`programs.combined`). While machines slide,

* their two rules rest; every other rule is watched as ever, on the averaged signals;
* their weights are watched: at 0 or 1 a machine leaves the surface on that side;
* so is whatever else their rules ask for, and time events: after each event the fields decide anew,
  about the surfaces slid on and those just met, all at once.

Sliding asks for the same state space on both sides: a mode that would make the state jump is not
slid into, nor one whose switching function itself differs between the modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.surfaces import Surface, SurfaceLaws, coincide, surfaces_of
from hybond.model.graph import FlatGraph, Mode
from hybond.modes.settle import Settler
from hybond.modes.sliding.filippov import ABOVE, SLIDES
from hybond.modes.sliding.view import View, resting
from hybond.modes.sliding.ways import WaysOn
from hybond.programs.combined import Combined, Kind
from hybond.programs.interval import Interval
from hybond.programs.program import Program
from hybond.programs.sliding_program import SlidingProgram, corners_of, flipped
from hybond.trace import Cause, Event, Fired, Sliding, Step, Trace

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
        states = list(mode)
        slid: list[Surface] = []
        kind: Kind = "additive"
        if decided is not None:
            way, kind, met = decided
            fired = _fired_machines(self.graph, event)
            # a crossing is what its own rule said, unless another surface has a say in it
            joint = bool(held) or bool(way.sliding)
            for s, side in zip(met, way.sides, strict=True):
                if side == SLIDES:
                    slid.append(s)
                elif joint and (s in held or s.machine in fired):
                    states[s.machine] = s.above if side == ABOVE else s.below
        for s in held:
            if s not in met and mode[s.machine] in (s.below, s.above):
                states[s.machine] = self._dropped(s, t, y, mode, interval)
        return self._go_on(t, y, mode, tuple(states), tuple(slid), kind, event, interval, cause)

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
        fired = _fired_machines(self.graph, event)
        moved = event is not None and any(s.impulses for s in event.steps if s.kind != "mythical")
        anew = anew or moved
        found: dict[int, Surface] = {}
        v: list[float] | None = None
        for k, s in enumerate(self.surfaces):
            if mode[s.machine] not in (s.below, s.above) or s.machine in found:
                continue
            crossed = fired.get(s.machine) in ((s.below, s.above), (s.above, s.below))
            if not (crossed or s in held or anew):
                continue
            if v is None:
                v = self._values(t, y, mode, interval)
            if any(not f(v) for rest in self._rests[k] for f in rest):
                continue
            sure = (crossed or s in held) and not moved
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
        program = self.program
        g = float(self._plain[k](v))
        if g == 0.0:
            return True
        sides = [_with(mode, s.machine, j) for j in (s.below, s.above)]
        law = self.laws.of(s, sides)
        if law is None:
            return False
        equations = program.equations(mode, interval, v[0])
        rate = program.field(equations, interval)(v[0], y)[None, :]
        n = program.nx + program.ns
        speed = float(law.along(v, rate[:, : program.nx], rate[:, program.nx : n])[0])
        return abs(g) <= AT_ONCE * abs(v[0]) * abs(speed)

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
    ) -> tuple[Vector, Mode]:
        held = self.view.surfaces if self.view is not None else ()
        if self.view is not None:
            self._note_until(t)
        same = set(slid) == set(held) and self.view is not None and self.view.kind == kind
        fired = self._transitions(before, mode, held, slid)
        if not same:
            self.view = self._viewed(slid, kind, t, mode) if slid else None
        if self.view is not None:
            equations = self.view.program.equations(mode, interval, t)
            assert isinstance(equations, Combined)
            y = equations.onto(t, y)
        if fired:
            self._write(t, y, mode, fired, event, cause)
        return y, mode

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
            program = SlidingProgram(self.program, graph, slid, kind=kind, laws=self.laws)
            settler = Settler(program, self.trace, max_writes=self.max_writes)
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

    def _transitions(
        self,
        before: Mode,
        mode: Mode,
        held: Sequence[Surface],
        slid: Sequence[Surface],
    ) -> tuple[Fired, ...]:
        """Return what the decision did to machines, as transitions to and from ``sliding``."""
        found = []
        for s in (*held, *(s for s in slid if s not in held)):
            machine = self.graph.machines[s.machine]
            if s in held and s in slid:
                continue
            if s in slid:
                why = f"{s.text}: pushed into from both sides"
                found.append(
                    Fired(machine.path, machine.states[before[s.machine]], "sliding", why, {}, {})
                )
            elif mode[s.machine] in (s.below, s.above):
                why = f"{s.text}: no longer pushed into from both sides"
                found.append(
                    Fired(machine.path, "sliding", machine.states[mode[s.machine]], why, {}, {})
                )
        changed = {s.machine for s in (*held, *slid)}
        for m, a, b in zip(self.graph.machines, before, mode, strict=True):
            if a != b and m.index not in changed:
                why = "the other surfaces push it back"
                found.append(Fired(m.path, m.states[a], m.states[b], why, {}, {}))
        return tuple(found)

    def _write(
        self,
        t: float,
        y: Vector,
        mode: Mode,
        fired: tuple[Fired, ...],
        event: Event | None,
        cause: Cause,
    ) -> None:
        """Add the decision to what is recorded of this instant."""
        stored = y[: self.program.nx + self.program.ns]
        if event is None:
            step = Step(mode, "continuous", fired, {}, None)
            self.trace.events.append(Event(float(t), cause, (step,), stored, stored))
            return
        assert self.trace.events[-1] is event
        last = event.steps[-1]
        last = replace(last, mode=mode, fired=(*last.fired, *fired))
        self.trace.events[-1] = replace(event, steps=(*event.steps[:-1], last), after=stored)


def _with(mode: Mode, machine: int, state: int) -> Mode:
    return (*mode[:machine], state, *mode[machine + 1 :])


def _fired_machines(graph: FlatGraph, event: Event | None) -> dict[int, tuple[int, int]]:
    """Return source and target of the machines that made exactly one transition."""
    if event is None:
        return {}
    by_path = {m.path: m for m in graph.machines}
    made: dict[str, list[Fired]] = {}
    for step in event.steps:
        for f in step.fired:
            made.setdefault(f.machine, []).append(f)
    found = {}
    for path, transitions in made.items():
        if len(transitions) == 1 and path in by_path:
            machine = by_path[path]
            f = transitions[0]
            found[machine.index] = (
                machine.states.index(f.source),
                machine.states.index(f.target),
            )
    return found
