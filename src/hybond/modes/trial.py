"""Trying a mode: its jump from the a priori state, and every signal that follows.

Nothing here decides anything; `settle` does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations, undetermined_names
from hybond.errors import ModelError
from hybond.model.expressions import compile_expression
from hybond.model.graph import FlatGraph, Mode
from hybond.modes.dirac import DIRAC, IMPULSE_RTOL, Pair
from hybond.modes.jump import Jump, enter, reach_of
from hybond.modes.signals import impulse_floor
from hybond.programs.interval import Interval
from hybond.programs.program import Program
from hybond.trace import Trace

Vector = NDArray[np.float64]


@dataclass(slots=True)
class Trial:
    """A mode being tried: its equations, its jump, and the signals that follow.

    Parameters
    ----------
    mode : Mode
    equations : ModeEquations
    jump : Jump
    s : array
        Integrated signals after the jump.
    v : list of float
        Finite values, then a priori values.
    pairs : list of Pair
        The same with impulses.
    floor : array, shape (2 * bonds,)
        Below it a bond variable's impulse counts as zero.
    freedom : array, shape (2 * bonds, k)
        Directions in which finite values are undetermined.
    undetermined : tuple of str
        The bond variables that they move.
    """

    mode: Mode
    equations: ModeEquations
    jump: Jump
    s: Vector
    v: list[float]
    pairs: list[Pair]
    floor: Vector
    freedom: Vector
    undetermined: tuple[str, ...]


class Trials:
    """Tries modes of one program; `trace.energy` learns the largest energy seen."""

    def __init__(self, program: Program, trace: Trace) -> None:
        self.program = program
        self.graph: FlatGraph = program.graph
        self.trace = trace
        slots = program.slots
        self._offset = slots.size
        self._rates = [
            compile_expression(i.rate, slots.index, DIRAC, pre_offset=slots.size)
            for i in self.graph.integrals
        ]

    def a_priori(self, t: float, x: Vector, s: Vector, mode: Mode, before: Interval) -> list[float]:
        """Return all signals at the left limit: what ``pre()`` reads."""
        equations = self.program.equations(mode, before, t)
        v = self.program.values(t, before, mode, x, s)
        equations.solve(v, x)
        self._store(v, equations, x)
        return v[: self._offset]

    def _store(self, v: list[float], equations: ModeEquations, x: Vector) -> None:
        """Let storages read what they store, even if the state is not consistent yet."""
        z = equations.storage.co_energy(x)
        start = self.program.slots.w.start
        bonds = len(self.graph.bonds)
        for k in self.graph.storages:
            at = k.bond if k.kind == "C" else bonds + k.bond
            v[start + at] = float(z[k.index]) * (1 if k.kind == "C" else k.sign)

    def enter(
        self,
        t: float,
        x: Vector,
        s: Vector,
        mode: Mode,
        after: Interval,
        pre: list[float],
        *,
        jump: bool,
    ) -> Trial:
        """Enter `mode` from the state x; without `jump`, stay on x."""
        program = self.program
        equations = program.equations(mode, after, t)
        v = program.values(t, after, mode, x, s)
        v[self._offset :] = pre
        v[program.slots.w] = pre[program.slots.w]
        nothing = np.zeros(equations.tableau.unknowns)
        done = Jump(x, nothing, (), happened=False)
        factors: Vector | None = None
        if jump:
            self.trace.energy = max(self.trace.energy, abs(equations.storage.energy(x)))
            factors = self._impulsive_factors(equations, v)
            where = self.graph.mode_text(mode)
            done = enter(equations, v, x, where=where, energy=self.trace.energy)
        floor = impulse_floor(
            self.graph, done.impulses, self._reach(equations, x, done.x), x, done.x, IMPULSE_RTOL
        )
        pairs = self._pairs(equations, v, done, s, pre, floor)
        landed = s
        if done.happened and self._rates:
            areas = np.array([self._area(f, pairs) for f in self._rates])
            if areas.any():
                landed = s + areas
                pairs = self._pairs(equations, v, done, landed, pre, floor)
        solution = equations.solution(v, done.x)
        if done.happened and factors is not None:
            self._check_factors(equations, v, factors, done, t)
        names = tuple(undetermined_names(self.graph, solution.freedom))
        return Trial(mode, equations, done, landed, v, pairs, floor, solution.freedom, names)

    def _impulsive_factors(self, equations: ModeEquations, v: Sequence[float]) -> Vector | None:
        """Return what multiplies impulses in laws declared impulsive, None if there are none."""
        rows = [
            k
            for k, row in enumerate(equations.rows)
            if row.node >= 0 and self.graph.nodes[row.node].impulsive
        ]
        return equations.frozen.at(v)[rows] if rows else None

    def _check_factors(
        self, equations: ModeEquations, v: Sequence[float], before: Vector, jump: Jump, t: float
    ) -> None:
        """Refuse a factor that jumps: friction that would turn the slip round creates energy."""
        after = self._impulsive_factors(equations, v)
        assert after is not None
        nodes = [self.graph.nodes[r.node] for r in equations.rows if r.node >= 0]
        impulsive = [n for n in nodes if n.impulsive]
        change = np.abs(after - before) > 1e-9 * (np.abs(after) + np.abs(before))
        for node, moved in zip(impulsive, change, strict=True):
            if (moved & (jump.impulses != 0.0)).any():
                raise ModelError(
                    f"the impulsive law of {node.kind} {node.path} multiplies an impulse by a "
                    f"factor that the jump at t = {t:.9g} s changes",
                    code="HB-J103",
                    where=node.path,
                    hint="the slip would stop or turn round during the impact: add a state that "
                    "sticks",
                )
        names = ", ".join(n.path for n in impulsive)
        self.trace.warn(f"impulsive laws enter the jump equations: {names}")

    def _reach(self, equations: ModeEquations, x: Vector, after: Vector) -> Vector:
        """Return what each storage would hold with all the energy seen so far in the run."""
        storage = equations.storage
        self.trace.energy = max(
            self.trace.energy, abs(storage.energy(x)), abs(storage.energy(after))
        )
        return reach_of(storage, x, self.trace.energy)

    def _area(self, rate: Callable[[Sequence[Pair]], object], pairs: list[Pair]) -> float:
        value = rate(pairs)
        return value.impulse if isinstance(value, Pair) and value.impulsive else 0.0

    def _pairs(
        self,
        equations: ModeEquations,
        v: list[float],
        jump: Jump,
        s: Vector,
        pre: list[float],
        floor: Vector,
    ) -> list[Pair]:
        slots = self.program.slots
        v[slots.x] = jump.x.tolist()
        v[slots.s] = s.tolist()
        solution = equations.solution(v, jump.x)
        size = [abs(a) for a in v[: self._offset]]
        size[slots.w] = solution.size.tolist()
        impulse = [0.0] * self._offset
        if jump.happened:
            impulse[slots.w] = np.where(np.abs(jump.impulses) > floor, jump.impulses, 0.0).tolist()
        now = [Pair(a, p, b, c, abs(p)) for a, p, b, c in zip(v, impulse, pre, size, strict=False)]
        return now + [Pair(b, 0.0, b, max(abs(b), c), 0.0) for b, c in zip(pre, size, strict=True)]
