"""What is watched while machines slide: the other guards, and the weights of the sliding ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.combinations import Kind
from hybond.equations.mode import ModeEquations
from hybond.equations.surfaces import Surface, moves
from hybond.errors import NumericsError
from hybond.model.expressions import Bool, Not
from hybond.model.graph import FlatGraph, Mode, Rule
from hybond.model.interval import Interval
from hybond.modes.guards import Given, Guards
from hybond.modes.locate import Locator, Watched, watch
from hybond.modes.settle import Settled, Settler
from hybond.modes.sliding.branches import BranchesBeside
from hybond.programs.combined import Combined
from hybond.programs.program import Program
from hybond.programs.sliding_program import SlidingProgram
from hybond.solvers import Step
from hybond.trace import Segment

Vector = NDArray[np.float64]

BEYOND = 1e-13
"""A weight this far beyond 0 or 1 has left."""


@dataclass(slots=True)
class SlidingLocator(Locator):
    """A locator that also finds where a weight leaves [0, 1]."""

    bounds: dict[Rule, tuple[int, bool]] = field(default_factory=dict)
    others: tuple[Locator, ...] = ()
    """Of the branches of junction laws, in each mode that is combined."""

    def first(self, step: Step) -> float | None:
        """Return the first instant at which a guard, a weight or a branch asks for an event."""
        found = Locator.first(self, step)
        for other in self.others:
            at = other.first(step)
            if at is not None and (found is None or at < found):
                found = at
        return found

    def holds(self, rule: Rule, t: float, y: Vector) -> bool:
        """Return the truth of a guard, or whether a weight is beyond its bound."""
        bound = self.bounds.get(rule)
        if bound is None:
            # not super(): a class with slots is made anew, and zero-argument super misses it
            return Locator.holds(self, rule, t, y)
        assert isinstance(self.equations, Combined)
        program = self.program
        nx, ns = program.nx, program.ns
        v = program.values(t, self.interval, self.equations.mode, y[:nx], y[nx : nx + ns])
        j, upper = bound
        return bool(_margin(self.equations, j, upper, v) < -BEYOND)


def _margin(combined: Combined, j: int, upper: bool, v: Sequence[float]) -> float:
    """Return how far a weight is from its bound; negative beyond it."""
    try:
        return float(combined.margins(v)[int(upper), j])
    except NumericsError:
        # no combination holds the state on the surfaces here
        return -1.0


class SlidingSettler(Settler):
    """Settles modes while some machines slide: a mode met there gets the branches of its laws."""

    branches: BranchesBeside | None = None

    def settle(
        self,
        t: float,
        x: Vector,
        s: Vector,
        mode: Mode,
        before: Interval,
        after: Interval,
        *,
        start: bool = False,
        held: Vector | None = None,
    ) -> Settled:
        """Return the state and mode in which time goes on from `t`."""
        program = self.program
        if self.branches is not None and self.branches.any and isinstance(program, SlidingProgram):
            signals = s if held is None else held
            program.choose = self.branches.at(t, np.concatenate([x, signals]), after)
        return super().settle(t, x, s, mode, before, after, start=start, held=held)


@dataclass(slots=True)
class View:
    """A program while some machines slide, with what settles and locates in it."""

    surfaces: tuple[Surface, ...]
    kind: Kind
    program: SlidingProgram
    settler: Settler
    watched: dict[Mode, Watched]
    number: int = 0
    """Of the record in the trace."""

    def locator(self, equations: ModeEquations, interval: Interval) -> Locator:
        """Return what finds the end of the motion."""
        if not isinstance(equations, Combined):
            watched = watch(self.settler.trials.guards, equations.mode)
            return Locator(self.program, self.settler, equations, interval, watched)
        mode = equations.mode
        if mode not in self.watched:
            self.watched[mode] = _with_rests(self.settler.trials.guards, self.surfaces, mode)
        known = self.watched[mode]
        bounds: dict[Rule, tuple[int, bool]] = {}
        margins: list[Callable[[Sequence[float]], float]] = []
        for j, s in enumerate(equations.surfaces):
            for upper in (False, True):
                text = f"weight {j} {'above 1' if upper else 'below 0'}"
                bounds[Rule(s.below, s.above, Bool(False), text)] = (j, upper)
                margins.append(_margin_at(equations, j, upper))
        arrays = _over_columns(equations)
        beyond = [
            Given(rule, _beyond(f), (f,), (many,), _beyond_many(many), (_one,))
            for rule, f, many in zip(bounds, margins, arrays, strict=True)
        ]
        watched = Watched((*known.guards, *beyond), rounded=False)
        others = self._of_branches(equations, interval)
        return SlidingLocator(
            self.program, self.settler, equations, interval, watched, bounds, others
        )

    def _of_branches(self, combined: Combined, interval: Interval) -> tuple[Locator, ...]:
        """Return what finds where a junction law in one of the modes leaves its branch."""
        whole = self.program.whole
        if all(m.law is None for m in whole.graph.machines):
            return ()
        machines = [m if m.law is not None else replace(m, rules=()) for m in whole.graph.machines]
        guards = self.settler.trials.guards
        return tuple(
            Locator(whole, self.settler, part, interval, watch(guards, part.mode, machines))
            for part in combined.parts
        )


def _one(columns: Sequence[Vector]) -> Vector:
    """Return what a weight's rounding is relative to."""
    return np.ones_like(columns[0])


def _margin_at(combined: Combined, j: int, upper: bool) -> Callable[[Sequence[float]], float]:
    return lambda v: _margin(combined, j, upper, v)


def _beyond(f: Callable[[Sequence[float]], float]) -> Callable[[Sequence[float]], float]:
    return lambda v: float(f(v) < -BEYOND)


def _beyond_many(f: Callable[[Sequence[Vector]], Vector]) -> Callable[[Sequence[Vector]], Vector]:
    return lambda columns: (f(columns) < -BEYOND).astype(float)


def _over_columns(combined: Combined) -> list[Callable[[Sequence[Vector]], Vector]]:
    """Return the margins of all weights, below and above, over columns of values."""
    last: list[tuple[bytes, Vector]] = []

    def margins(columns: Sequence[Vector]) -> Vector:
        key = columns[0].tobytes()
        if not last or last[0][0] != key:
            # no combination: as if far beyond the bound
            last[:] = [(key, np.nan_to_num(combined.margins_at(columns), nan=-1.0))]
        return last[0][1]

    def margin(j: int, upper: bool) -> Callable[[Sequence[Vector]], Vector]:
        return lambda columns: margins(columns)[int(upper), j]

    return [margin(j, up) for j in range(len(combined.surfaces)) for up in (False, True)]


def _with_rests(guards: Guards, surfaces: Sequence[Surface], mode: Mode) -> Watched:
    """Compile the rules of the machines, and what allows the switching that is averaged."""
    machines = list(guards.program.graph.machines)
    for s in surfaces:
        state = mode[s.machine]
        rests = tuple(
            Rule(state, state, Not(e), f"not ({e})") for e in (*s.up_rest, *s.down_rest) if moves(e)
        )
        machine = machines[s.machine]
        machines[s.machine] = replace(machine, rules=(*machine.rules, *rests))
    return watch(guards, mode, machines)


def resting(
    graph: FlatGraph, surfaces: Sequence[Surface], twins: Sequence[Surface] = ()
) -> FlatGraph:
    """Return a graph in which the rules between the states of `surfaces` rest.

    The rules from either state to a third hold in both. Machines that switch on the same surfaces,
    their `twins`, rest as well: there they would switch by rounding.
    """
    machines = list(graph.machines)
    for s in surfaces:
        pair = (s.below, s.above)
        rules: list[Rule] = []
        for rule in machines[s.machine].rules:
            if rule.source not in pair:
                rules.append(rule)
            elif rule.target not in pair:
                rules += [replace(rule, source=k) for k in pair]
        machines[s.machine] = replace(machines[s.machine], rules=tuple(rules))
    for s in twins:
        machine = machines[s.machine]
        rules = [r for r in machine.rules if r not in (s.up, s.down)]
        machines[s.machine] = replace(machine, rules=tuple(rules))
    return replace(graph, machines=tuple(machines))


def equations_of(program: Program, segment: Segment) -> ModeEquations:
    """Return the equations of a segment of motion: those of its mode, or of its sliding."""
    if isinstance(segment.combined, Combined):
        return segment.combined
    assert isinstance(segment.interval, Interval)
    return program.equations(segment.mode, segment.interval, float(segment.t[0]))
