"""Trying a mode: its jump from the a priori state, and every signal that follows.

Nothing here decides anything; `settle` does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations, Solution, undetermined_names
from hybond.errors import CausalityError, ModelError, NumericsError
from hybond.model.expressions import compile_expression
from hybond.model.graph import FlatGraph, Machine, Mode, Node, Rule
from hybond.model.interval import Interval
from hybond.modes.dirac import DIRAC, IMPULSE_RTOL, Pair, Pairs, steady
from hybond.modes.guards import Guards
from hybond.modes.impacts.strike import strike
from hybond.modes.jump import Jump, enter, reach_of, reach_of_bonds
from hybond.modes.laws.complementarity import Complementarity, Instant
from hybond.modes.signals import impulse_floor
from hybond.programs.program import Program
from hybond.trace import Trace

Vector = NDArray[np.float64]

TURNED = 8
"""Modes that are tried with what is violated turned."""
AGAIN = 4
"""States that differ by rounding from which branches are looked for."""
STORED = 10.0
"""Rounding of a bond variable is measured by this multiple of what the energy of the run would make
of it."""
DUST = 1e-9
"""A change of what is stored below this part of what it may be is no impulse."""


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
    pairs : Pairs
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
    pairs: Pairs
    floor: Vector
    freedom: Vector
    undetermined: tuple[str, ...]
    through: Mode | None = None
    """The mode whose junction laws carried the impulses, if others last."""
    dusted: bool = False
    """Whether rounding was swept out of what is stored."""


class Trials:
    """Tries modes of one program; `trace.energy` learns the largest energy seen."""

    def __init__(self, program: Program, trace: Trace) -> None:
        self.program = program
        self.graph: FlatGraph = program.graph
        self.trace = trace
        self.laws = Complementarity(program, trace)
        self.impact_law = "newton"
        self.impact_exponent = 1.0
        self.guards = Guards(program)
        self.sweep = False
        """Whether approaches that are only rounding are taken away, as guards ask in vain."""
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
        stay: bool = False,
    ) -> Trial:
        """Enter `mode` from the state x; without `jump`, stay on x.

        Junction laws choose their branches; with `stay` they keep those of `mode`, which were just
        chosen, unless an impulse or a violation asks for others.
        """
        if self.laws.laws:
            return self._with_laws(t, x, s, mode, after, pre, jump=jump, stay=stay)
        equations = self.program.equations(mode, after, t)
        v = self._values(t, x, s, mode, after, pre)
        factors: Vector | None = None
        done = Jump(x, np.zeros(equations.tableau.unknowns), (), happened=False)
        if jump:
            factors = self._impulsive_factors(equations, v)
            done = self._jump(equations, v, x)
        return self._made(t, x, s, v, equations, done, pre, factors)

    def _values(
        self, t: float, x: Vector, s: Vector, mode: Mode, after: Interval, pre: list[float]
    ) -> list[float]:
        v = self.program.values(t, after, mode, x, s)
        v[self._offset :] = pre
        v[self.program.slots.w] = pre[self.program.slots.w]
        return v

    def _jump(self, equations: ModeEquations, v: list[float], x: Vector) -> Jump:
        self.trace.energy = max(self.trace.energy, abs(equations.storage.energy(x)))
        where = self.graph.mode_text(equations.mode)
        return enter(equations, v, x, where=where, energy=self.trace.energy)

    def _made(
        self,
        t: float,
        x: Vector,
        s: Vector,
        v: list[float],
        equations: ModeEquations,
        done: Jump,
        pre: list[float],
        factors: Vector | None,
    ) -> Trial:
        """Return the trial of a mode whose jump is known."""
        floor = np.zeros(len(done.impulses))
        self._note_energy(equations, x, done.x)
        if done.happened:
            reach = reach_of(equations.storage, x, self.trace.energy)
            floor = impulse_floor(self.graph, done.impulses, reach, x, done.x, IMPULSE_RTOL)
        pairs, solution = self._pairs(equations, v, done, s, pre, floor)
        landed = s
        if done.happened and self._rates:
            areas = np.array([self._area(f, pairs) for f in self._rates])
            if areas.any():
                landed = s + areas
                pairs, solution = self._pairs(equations, v, done, landed, pre, floor)
        if done.happened and factors is not None:
            self._check_factors(equations, v, factors, done, t)
        names = tuple(undetermined_names(self.graph, solution.freedom))
        mode = equations.mode
        return Trial(mode, equations, done, landed, v, pairs, floor, solution.freedom, names)

    def measured(self, equations: ModeEquations, x: Vector, terms: Vector) -> Vector:
        """Return what rounding of each bond variable is measured by, shape (2 * bonds,).

        `terms` are the sizes of the terms that made them. Junction laws count rounding of what is
        stored as zero (`Complementarity.clean`). Beside them every guard does, wherever it is
        asked: one that ends a step at such a zero holds when the instant is settled, too.
        """
        if not self.laws.laws:
            return terms
        return np.maximum(terms, STORED * reach_of_bonds(equations, x, self.trace.energy))

    # -- junctions with laws

    def _with_laws(
        self,
        t: float,
        x: Vector,
        s: Vector,
        mode: Mode,
        after: Interval,
        pre: list[float],
        *,
        jump: bool,
        stay: bool,
    ) -> Trial:
        """Enter `mode` with the branches that complementarity chooses: jump first, then what lasts.

        Raises
        ------
        NumericsError
            HB-J110 if there are none, HB-J111 if none stands up to its own conditions.
        """
        program = self.program
        stored = program.ports(mode, after, t).equations.storage.energy(x)
        energy = self.trace.energy = max(self.trace.energy, abs(stored))
        at = Instant(t, s, mode, after, pre)
        done, through, factors = self._struck(at, x, pre) if jump else (None, None, None)
        landed = x if done is None else done.x
        begin = landed
        if done is None and jump:
            begin = self.laws.consistent(at, x, energy)[2]
            landed = self.laws.dusted(at, begin, energy=energy) if self.sweep else begin
        tried: list[str] = []
        states = [landed]
        for state in states:
            lasting = self.laws.lasting(at, state, energy=energy)
            still = done is None or not done.happened
            settled = ((mode, False),) if stay and still and state is landed else ()
            turned: list[tuple[Mode, bool]] = []
            asked: set[Mode] = set()
            # `turned` grows while the others are tried
            for candidate, kept in chain(settled, lasting, turned):
                equations = program.equations(candidate, after, t)
                signals = self.laws.kept.after(s, candidate)
                v = self._values(t, x, signals, candidate, after, pre)
                text = f"({self.graph.mode_text(candidate)}) would need an impulse"
                try:
                    swept = self._swept(equations, list(v), state) if jump else state
                except CausalityError as error:
                    swept, text = None, str(error.why)
                if swept is None:
                    tried += [text] if text not in tried else []
                    continue
                if done is not None:
                    own = replace(done, x=swept)
                elif jump:
                    own = self._jump(equations, v, x)
                    # what an earlier answer swept up was dust, and stays swept
                    own = own if state is begin else replace(own, x=swept)
                else:
                    own = Jump(x, np.zeros(equations.tableau.unknowns), (), happened=False)
                trial = self._made(t, x, signals, v, equations, own, pre, factors if done else None)
                if kept and trial.freedom.shape[1]:
                    continue  # two that share a current at will: let one of them have it
                broken = self._violated(trial)
                if not broken:
                    trial.dusted = state is not begin
                    trial.through = through if own.happened and through != candidate else None
                    return trial
                tried += [r for m, rule in broken if (r := f"{m.path}: {rule.text}") not in tried]
                # rounding may have spoken: ask again on what these branches hold, and last of all
                # turn what is violated, which is accepted only if it stands as well
                if len(states) < AGAIN and not any(np.array_equal(swept, a) for a in states):
                    states.append(swept)
                other = list(candidate)
                for m, rule in broken:
                    other[m.index] = rule.target
                if tuple(other) not in asked and len(asked) < TURNED:
                    asked.add(tuple(other))
                    turned.append((tuple(other), False))
        raise NumericsError(
            f"no branches of the junction laws stand at t = {t:.9g} s: {'; '.join(tried)}",
            code="HB-J111",
            where=self.graph.mode_text(mode),
            hint="several answers may fit (Painleve), or values lie too far apart for the "
            "arithmetic: give contacts a stiffness, sources a resistance",
        )

    def _struck(
        self, at: Instant, x: Vector, pre: list[float]
    ) -> tuple[Jump | None, Mode | None, Vector | None]:
        """Return the jump that laws ask for, the mode that carries it, factors of impulsive laws.

        All None if no law is violated by what is stored.
        """
        if self.impact_law != "newton":
            energy = self.trace.energy
            law, exponent = self.impact_law, self.impact_exponent
            struck = strike(self.laws, law, exponent, at, x, energy=energy)
            if struck is not None:
                return *struck, None
        candidate = next(self.laws.jumping(at, x, energy=self.trace.energy), None)
        if candidate is None:
            return None, None, None
        equations = self.program.equations(candidate, at.after, at.t)
        v = self._values(at.t, x, at.s, candidate, at.after, pre)
        factors = self._impulsive_factors(equations, v)
        return self._jump(equations, v, x), candidate, factors

    def _swept(self, equations: ModeEquations, v: list[float], x: Vector) -> Vector | None:
        """Return the state on the constraints of a mode; None if that takes more than dust.

        Impulses of laws were decided before; what remains would be an impulse of dry friction.
        """
        jump = self._jump(equations, v, x)
        landed = jump.x
        if not jump.happened:
            # no more than rounding of the constraint's own terms, however little is stored yet
            return landed
        reach = reach_of(equations.storage, x, self.trace.energy)
        dust = (np.abs(landed - x) <= DUST * (np.abs(x) + reach)).all()
        return landed if dust else None

    def _violated(self, trial: Trial) -> list[tuple[Machine, Rule]]:
        """Return the rules of laws that hold in their own branches, with finite values."""
        pairs = steady(trial.pairs.finite, trial.pairs.size)
        found = []
        for index in self.laws.laws:
            machine = self.graph.machines[index]
            assert machine.law is not None
            state = trial.mode[index]
            if state == 0 and machine.law.restitution is not None:
                continue  # what still approaches strikes in the next jump of this instant
            for rule in machine.rules:
                if rule.source == state and self.guards.holds(rule, pairs, machine.path):
                    found.append((machine, rule))
        return found

    def _impulsive_factors(self, equations: ModeEquations, v: Sequence[float]) -> Vector | None:
        """Return what multiplies impulses in laws declared impulsive, None if there are none."""
        rows = [
            k
            for k, row in enumerate(equations.rows)
            if row.node >= 0 and self._declared(self.graph.nodes[row.node])
        ]
        return equations.frozen.at(v)[rows] if rows else None

    def _declared(self, node: Node) -> bool:
        """Whether a written law is impulsive; a junction's own takes the branch after the jump."""
        return node.impulsive and not node.implied

    def _check_factors(
        self, equations: ModeEquations, v: Sequence[float], before: Vector, jump: Jump, t: float
    ) -> None:
        """Refuse a factor that jumps: friction that would turn the slip round creates energy."""
        after = self._impulsive_factors(equations, v)
        assert after is not None
        nodes = [self.graph.nodes[r.node] for r in equations.rows if r.node >= 0]
        impulsive = [n for n in nodes if self._declared(n)]
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

    def _note_energy(self, equations: ModeEquations, x: Vector, after: Vector) -> None:
        """Learn how much energy the run has seen: rounding of what is stored is measured by it."""
        states = (x,) if after is x else (x, after)
        seen = (abs(equations.storage.energy(a)) for a in states)
        self.trace.energy = max(self.trace.energy, *seen)

    def _area(self, rate: Callable[[Pairs], object], pairs: Pairs) -> float:
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
    ) -> tuple[Pairs, Solution]:
        slots = self.program.slots
        v[slots.x] = jump.x.tolist()
        v[slots.s] = s.tolist()
        solution = equations.solution(v, jump.x)
        size = [abs(a) for a in v[: self._offset]]
        size[slots.w] = self.measured(equations, jump.x, solution.size).tolist()
        impulse = [0.0] * self._offset
        if jump.happened:
            impulse[slots.w] = np.where(np.abs(jump.impulses) > floor, jump.impulses, 0.0).tolist()
        return Pairs(v[: self._offset], pre, impulse, size), solution
