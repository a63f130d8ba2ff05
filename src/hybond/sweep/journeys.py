"""The modes that runs wrote, one after the other: how long, how often, when first, in which order.

A mode is written if time passes in it, or as a pinnacle if it is left at the same instant; mythical
modes are not. All is told of many runs at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.model.graph import FlatGraph
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]
PERIODS = 8
"""Modes in a cycle that a sequence tells once, with how often it repeats, at the most."""
LONG = 2000
"""Characters of a sequence; what is longer ends in how many modes are left out."""


@dataclass(frozen=True, slots=True)
class Journeys:
    """The modes that runs wrote.

    Parameters
    ----------
    stays : array of int, shape (runs,)
    since : array, shape (modes,)
        s.
    modes : array of int, shape (modes, machines)
    end : array, shape (runs,)
        When the runs ended, s.
    """

    stays: NDArray[np.intp]
    since: Vector
    modes: NDArray[np.intc]
    end: Vector

    @property
    def first(self) -> NDArray[np.intp]:
        """Where the modes of each run begin."""
        return np.cumsum(self.stays) - self.stays

    def time_in(self, machine: int, states: Sequence[int]) -> Vector:
        """Return for how long a machine was in one of some states, s, shape (runs,)."""
        within = np.isin(self.modes[:, machine], states)
        found = np.zeros(len(self.stays))
        there = np.flatnonzero(self.stays)
        if not len(there):
            return found
        until = np.append(self.since[1:], 0.0)
        until[self.first[there] + self.stays[there] - 1] = self.end[there]
        lasted = np.where(within, until - self.since, 0.0)
        found[there] = np.add.reduceat(lasted, self.first[there])
        return found

    def first_in(self, machine: int, states: Sequence[int]) -> Vector:
        """Return when a machine was first in one of some states, s; nan if it never was."""
        found = np.full(len(self.stays), np.nan)
        within = np.flatnonzero(np.isin(self.modes[:, machine], states))
        run, at = np.unique(
            np.repeat(np.arange(len(self.stays)), self.stays)[within], return_index=True
        )
        found[run] = self.since[within[at]]
        return found

    def changes_of(self, machine: int) -> NDArray[np.intp]:
        """Return how often the state of a machine changed, shape (runs,)."""
        state = self.modes[:, machine]
        changed = np.append(False, state[1:] != state[:-1])
        there = np.flatnonzero(self.stays)
        changed[self.first[there]] = False
        found = np.zeros(len(self.stays), dtype=np.intp)
        if len(there):
            found[there] = np.add.reduceat(changed.astype(np.intp), self.first[there])
        return found

    def sequences(self, graph: FlatGraph) -> list[str]:
        """Return the modes of each run in order, cycles with how often they repeat."""
        known: dict[bytes, int] = {}
        number = [known.setdefault(row.tobytes(), len(known)) for row in self.modes]
        names = [mode_name(graph, np.frombuffer(row, dtype=self.modes.dtype)) for row in known]
        made: dict[tuple[int, ...], str] = {}
        found = []
        for first, many in zip(self.first.tolist(), self.stays.tolist(), strict=True):
            own = tuple(number[first : first + many])
            if own not in made:
                made[own] = sequence_text([names[k] for k in own])
            found.append(made[own])
        return found

    def last_modes(self, graph: FlatGraph) -> list[str]:
        """Return the mode in which each run ended."""
        ends = (self.first + self.stays - 1).tolist()
        return [
            mode_name(graph, self.modes[k]) if many else ""
            for k, many in zip(ends, self.stays.tolist(), strict=True)
        ]


def journey_of(run: Result) -> Journeys:
    """Return that of one run."""
    rows = [(e.t, s.mode) for e in run.trace.events for s in e.steps if s.kind != "mythical"]
    return Journeys(
        np.array([len(rows)]),
        np.array([t for t, _ in rows], dtype=float),
        np.array([mode for _, mode in rows], dtype=np.intc).reshape(
            len(rows), len(run.graph.machines)
        ),
        np.array([run.t_end]),
    )


def mode_name(graph: FlatGraph, mode: Sequence[int] | NDArray[np.intc]) -> str:
    """Return the states of the machines as one text; empty if there is no machine."""
    return ", ".join(m.states[k] for m, k in zip(graph.machines, mode, strict=True))


def sequence_text(names: Sequence[str]) -> str:
    """Return names in order, each once where it stays; cycles with how often they repeat.

    Examples
    --------
    >>> sequence_text(["free", "stuck", "free", "stuck", "free", "left"])
    '(free > stuck) x2 > free > left'
    >>> sequence_text(["away", "away"])
    'away'
    """
    kept = [n for k, n in enumerate(names) if not k or names[k - 1] != n]
    words, k = [], 0
    while k < len(kept):
        best, period = 1, 0
        for p in range(2, min(PERIODS, (len(kept) - k) // 2) + 1):
            if kept[k] != kept[k + p]:
                continue
            block, times = kept[k : k + p], 1
            while kept[k + times * p : k + (times + 1) * p] == block:
                times += 1
            if times > 1 and times * p > best * max(period, 1):
                best, period = times, p
        if period:
            words.append(f"({' > '.join(kept[k : k + period])}) x{best}")
            k += best * period
        else:
            words.append(kept[k])
            k += 1
    text = " > ".join(words)
    return text if len(text) <= LONG else f"{text[:LONG]} ... of {len(kept)} modes"
