"""States that somebody says, settled by the engine: what a witness is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.modes.records import Known
from hybond.analysis.modes.steps import Fired, Met
from hybond.engine.outcome.apart import Apart
from hybond.errors import HybondError
from hybond.model.graph import FlatGraph, Mode
from hybond.runs.trace import Event, Visit
from hybond.simulation import simulate

Vector = NDArray[np.float64]

MOMENT = 1e-9
"""How long a run may last that should stop where it begins, s."""


@dataclass(frozen=True)
class Asked:
    """A model that is asked how instants are settled."""

    graph: FlatGraph

    @cached_property
    def apart(self) -> Apart:
        """The same, apart from any run."""
        return Apart(self.graph)

    @cached_property
    def _numbers(self) -> dict[tuple[str, str, str, str], tuple[int, int]]:
        return {
            (m.path, m.states[r.source], m.states[r.target], r.text): (m.index, k)
            for m in self.graph.machines
            for k, r in enumerate(m.rules)
        }

    def fired(self, step: Visit) -> Fired:
        """Return the rules that led to a step, by number."""
        return tuple(
            self._numbers[f.machine, f.source, f.target, f.guard]
            for f in step.fired
            if (f.machine, f.source, f.target, f.guard) in self._numbers
        )

    def settled(self, y: Vector, mode: Mode) -> Event | HybondError:
        """Return how an instant is settled, or the refusal."""
        try:
            return self.apart.settled(np.asarray(y, dtype=float), mode)
        except HybondError as error:
            return error

    def after(self, y: Vector, mode: Mode) -> Vector | None:
        """Return the state to which an instant is settled; None if it is refused."""
        try:
            return self.apart.after(np.asarray(y, dtype=float), mode)
        except HybondError:
            return None

    def stops(self, y: Vector, mode: Mode, code: str = "") -> bool:
        """Whether a run from a state stops where it begins, with this code."""
        graph = self.apart.begun(y, mode)
        run = simulate(graph, MOMENT, on_error="return", max_events=100)
        if run.error is None or run.t_end > 0.0:
            return False
        return not code or run.error.code == code

    def note(
        self,
        met: Met,
        event: Event,
        before: Mode,
        known: Known,
        *,
        witness: dict[str, float] | None = None,
    ) -> Mode:
        """Put what happened at an instant into what was met; return the mode that holds."""
        last = before
        # where machines begin or cease to slide, or land, the mode at the end is a convention
        rules = all(len(self.fired(s)) == len(s.fired) for s in event.steps)
        for k, step in enumerate(event.steps):
            tried = step.kind == "mythical" and not (k or step.fired)
            if rules and not (tried and step.mode == before):
                met.mode(step.mode, step.kind)
            if step.mode != last:
                fired = self.fired(step)
                if fired or self._by_laws(last, step.mode):
                    met.edge(last, step.mode, fired, known, begin=before, witness=witness)
            last = step.mode
        met.mode(last, "continuous")
        return last

    def _by_laws(self, old: Mode, new: Mode) -> bool:
        """Whether junctions with laws of their own lead from one mode to another."""
        pairs = zip(self.graph.machines, old, new, strict=True)
        return all(m.law is not None for m, a, b in pairs if a != b)


def modes_of(event: Event, before: Mode) -> list[Mode]:
    """Return the modes of an instant in order, the one before it first, none twice in a row."""
    found = [before]
    for step in event.steps:
        if step.mode != found[-1]:
            found.append(step.mode)
    return found


def without_repeats(modes: Sequence[Mode]) -> list[Mode]:
    """Return modes in order, none twice in a row."""
    return [m for k, m in enumerate(modes) if k == 0 or m != modes[k - 1]]
