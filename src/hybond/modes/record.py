"""Writing down what a settled instant did: transitions, impulses, energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.named_rows import NamedRows, named_rows
from hybond.model.expressions import compile_expression
from hybond.model.graph import Machine, Mode, Rule
from hybond.model.kinds import TWO_PORTS
from hybond.modes.dirac import DIRAC, Pair, Pairs
from hybond.modes.guards import Guards
from hybond.modes.trial import Trial
from hybond.programs.program import Program
from hybond.trace import Energy, Fired, Step, StepKind

Vector = NDArray[np.float64]


class Recorder:
    """Makes the records of one program's events."""

    def __init__(self, program: Program, guards: Guards) -> None:
        self.program = program
        self.guards = guards
        self.graph = program.graph
        self._reads: dict[int, tuple[Rule, list[tuple[str, Callable[[Pairs], object]]]]] = {}
        self._impact = frozenset(n.index for n in program.prior)

    @cached_property
    def named(self) -> NamedRows:
        """The signals that records name."""
        return named_rows(self.graph)

    def fired(self, machine: Machine, rule: Rule, pairs: Pairs, others: tuple[str, ...]) -> Fired:
        """Return the record of a transition, with the values that its guard read."""
        # by identity: to hash a rule takes longer than to read its values
        known = self._reads.get(id(rule))
        if known is None:
            slots = self.program.slots
            reads = [
                (name, compile_expression(e, slots.index, DIRAC, pre_offset=slots.size))
                for name, e in rule.reads
            ]
            known = self._reads[id(rule)] = rule, reads
        values, impulses = {}, {}
        for name, f in known[1]:
            pair = f(pairs)
            if isinstance(pair, Pair):
                values[name] = pair.finite
                if pair.impulsive:
                    impulses[name] = pair.impulse
            else:
                values[name] = float(bool(pair))
        return Fired(
            machine.path,
            machine.states[rule.source],
            machine.states[rule.target],
            rule.text,
            values,
            impulses,
            others,
        )

    def branch(self, machine: Machine, source: int, target: int, pairs: Pairs) -> Fired:
        """Return the record of a law that took another branch, with what its rule reads."""
        rules = [r for r in machine.rules if r.source == source]
        names = machine.states[source], machine.states[target]
        for values in (pairs.prior(), pairs):
            for rule in rules:
                if self.guards.holds(rule, values, machine.path):
                    return replace(self.fired(machine, rule, values, ()), target=names[1])
        return Fired(machine.path, *names, "complementarity", {}, {})

    def written(
        self,
        trial: Trial,
        x: Vector,
        entered: tuple[Fired, ...],
        by_law: Callable[[Mode, Trial, Mode | None], tuple[Fired, ...]],
    ) -> tuple[Step, ...]:
        """Return the records of a mode that was written.

        If the junction laws that carried the impulses are not those that last, the former are a
        pinnacle.
        """
        if trial.through is None:
            return (self.step(trial, x, entered, "continuous"),)
        struck = {f.machine: f for f in by_law(trial.mode, trial, trial.through)}
        first = tuple(
            replace(f, target=struck[f.machine].target) if f.machine in struck else f
            for f in entered
        )
        known = {f.machine for f in first}
        first += tuple(f for m, f in struck.items() if m not in known)
        first = tuple(f for f in first if f.source != f.target)
        pinnacle = self.step(replace(trial, mode=trial.through), x, first, "pinnacle")
        stored = trial.equations.storage.energy(trial.jump.x)
        rest = tuple(
            Fired(f.machine, f.target, f.source, "complementarity", {}, {}) for f in struck.values()
        )
        after = Energy(stored, stored, 0.0, 0.0)
        return (pinnacle, Step(trial.mode, "continuous", rest, {}, after, trial.undetermined))

    def step(self, trial: Trial, x: Vector, fired: tuple[Fired, ...], kind: StepKind) -> Step:
        """Return the record of a mode entered from `x`; a mythical step's values are trials."""
        jump = trial.jump
        energy: Energy | None = None
        exchanged: dict[str, float] = {}
        impulses: dict[str, float] = {}
        storage = trial.equations.storage
        if jump.happened:
            impulses = self.named.of(
                np.where(np.abs(jump.impulses) > trial.floor, jump.impulses, 0.0), trial.floor
            )
            before, after = storage.energy(x), storage.energy(jump.x)
            source = self._source_work(trial)
            energy = Energy(before, after, source, before + source - after)
            exchanged = self._exchanged(trial)
        elif kind == "continuous":
            stored = storage.energy(x)
            energy = Energy(stored, stored, 0.0, 0.0)
        return Step(
            trial.mode,
            kind,
            fired,
            impulses,
            energy,
            tuple(dict.fromkeys((*trial.undetermined, *jump.undetermined))),
            exchanged,
        )

    def _source_work(self, trial: Trial) -> float:
        """Impulse times the source's own value at the right limit; impact rows are no source."""
        slots = self.program.slots
        w = np.array(trial.v[slots.w])
        bonds = len(self.graph.bonds)
        total = 0.0
        for node in self.graph.nodes:
            if node.kind not in ("Se", "Sf") or node.index in self._impact or node.domain.pseudo:
                continue
            end = node.ends[0]
            own, other = (0, bonds) if node.kind == "Se" else (bonds, 0)
            total -= end.sign * float(w[own + end.bond] * trial.jump.impulses[other + end.bond])
        return total

    def _exchanged(self, trial: Trial) -> dict[str, float]:
        """Return what passed through source bonds and bonds of what is OFF."""
        bonds = len(self.graph.bonds)
        off = self.graph.off_nodes(trial.mode)
        found = {}
        for node in self.graph.nodes:
            if node.kind == "Se" or (node.kind == "0" and node.index in off):
                passing = ["f"] * len(node.ends)
            elif node.kind == "Sf" or (node.kind == "1" and node.index in off):
                passing = ["e"] * len(node.ends)
            elif node.kind in TWO_PORTS and node.index in off:
                # a zero modulus shorts side 1 and opens (TF) or shorts (GY) side 2
                passing = ["f", "e" if node.kind == "TF" else "f"]
            else:
                continue
            for end, variable in zip(node.ends, passing, strict=True):
                at = end.bond + (bonds if variable == "f" else 0)
                area = float(trial.jump.impulses[at])
                if abs(area) > trial.floor[at]:
                    found[f'"{self.graph.bonds[end.bond].name}".{variable}'] = area
        return found
