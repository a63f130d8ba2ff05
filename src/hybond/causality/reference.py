"""The reference mode: the one with most storage in integral causality.

Modes are not searched one by one. A junction that is OFF is a junction that has no cause, so if
each controlled junction may have a cause or not as suits, one matching gives the most integral
storages over all settings of the junctions at once, then the most junctions ON (see
`hybond.causality.matching`). Where the machines can make those settings, that is the best mode.
Machines that switch several junctions together may not be able to; for them it is an upper
bound, and their states are chosen one after another, then by trying out: all modes of a small
connected part, single and paired exchanges in a large one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping

from hybond.causality.arrays import Arrays, compile_arrays
from hybond.causality.live import LiveAssignment
from hybond.causality.matching import EXPOSED
from hybond.causality.record import Causality
from hybond.causality.strokes import Strokes
from hybond.model.graph import FlatGraph, Mode
from hybond.model.joined import Joined
from hybond.records import dataclass
from hybond.uncollected import uncollected

WHOLE = 1024
"""Modes of one connected part up to which all of them are tried."""
PAIRED = 40
"""Machines of one connected part up to which pairs of them are exchanged; beyond, neighbours."""
NEXT = 4
"""Neighbours (in the order of their names) that a machine is paired with in a larger part."""


@dataclass(frozen=True, slots=True)
class Reference:
    """The mode that all others are compared with.

    Parameters
    ----------
    mode : tuple of int
        The state of each machine.
    causality : Causality
        The causality of that mode.
    integral, storages : int
        Storages in integral causality, and all storages.
    how : str
        ``"given by the user"``; ``"proved best"``: no mode has more storages in integral
        causality; ``"best found"``; or ``"no mode has a causality"``.
    steps : int
        Settings that were tried.
    """

    mode: Mode
    causality: Causality
    integral: int
    storages: int
    how: str
    steps: int


@uncollected
def reference_mode(
    graph: FlatGraph,
    *,
    mode: Mode | None = None,
    pins: Mapping[int, int] | None = None,
    arrays: Arrays | None = None,
) -> Reference:
    """Return the mode with most storage in integral causality.

    Of several, the one with most junctions ON; then the one with most machines in their start
    state; then by the names of the machines.

    Parameters
    ----------
    mode : tuple of int, optional
        The reference mode if the user gives one; without it that of the graph, if it has one.
    pins : mapping, optional
        Pinned strokes; without it those of the graph.
    arrays : Arrays, optional
        The compiled graph.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("clutch")
    >>> m.add(a=hb.I(1), v=hb.One(), clutch=hb.Zero(), w=hb.One(), b=hb.I(2))
    >>> m.bond("v -> a", "v -> clutch -> w -> b")
    >>> m.machine("S", states={"engaged": ["clutch"], "open": []}, start="engaged")
    >>> best = reference_mode(m.flatten())
    >>> best.mode, best.integral, best.storages, best.how
    ((1,), 2, 2, 'proved best')
    """
    arrays = arrays or compile_arrays(graph)
    pins = graph.pins if pins is None else pins
    mode = graph.reference if mode is None else mode
    steps, how = 1, "given by the user"
    if mode is None:
        search = _searched(graph, arrays, pins)
        mode, how, steps = tuple(search.states), search.how, search.steps
    causality = Strokes(graph, mode, pins=pins, arrays=arrays).record()
    return Reference(
        mode=mode,
        causality=causality,
        integral=len(graph.storages) - len(causality.derivative),
        storages=len(graph.storages),
        how=how,
        steps=steps,
    )


@uncollected
def best_mode(graph: FlatGraph, arrays: Arrays) -> Mode:
    """Return the mode that `reference_mode` would find without pins, and nothing else of it."""
    return tuple(_searched(graph, arrays, {}).states)


def _searched(graph: FlatGraph, arrays: Arrays, pins: Mapping[int, int]) -> _Search:
    search = _Search(graph, arrays, pins)
    search.run()
    return search


Score = tuple[int, int, int, int]
"""Less what is broken, less what is derivative; junctions ON; machines in their start state."""


class _Search:
    """The states of the machines while they are being chosen."""

    def __init__(self, graph: FlatGraph, arrays: Arrays, pins: Mapping[int, int]) -> None:
        self.graph, self.arrays, self.pins = graph, arrays, pins
        self.order = sorted(range(len(graph.machines)), key=lambda m: graph.machines[m].path)
        """Machines by name: the result must not depend on the order in which they were added."""
        self.states = list(graph.start_mode)
        self.steps = 1
        self.how = "proved best"

    def run(self) -> None:
        """Choose the state of every machine."""
        arrays, graph = self.arrays, self.graph
        free: list[int] = []
        for m in self.order:
            varying = _varying(arrays.on[m])
            junctions = [v for v in varying if graph.nodes[v].is_junction]
            free += sorted(junctions, key=lambda v: graph.nodes[v].path)
        # Covered first, so preferred: those that are ON at the start.
        starts = {v for m, k in enumerate(graph.start_mode) for v in arrays.on[m][k]}
        free.sort(key=lambda v: v not in starts)
        never = set(arrays.off).difference(*(on for states in arrays.on for on in states))
        work = LiveAssignment(arrays, off=never, pins=self.pins, either=free)
        if work.conflict:
            self.how = "no mode has a causality"
            return
        bound = set(work.derivative)
        tied = [m for m in self.order if not self._take(work, m)]
        if tied:
            self._settle(work, tied)
            self._improve(bound, tied)

    def _take(self, work: LiveAssignment, m: int) -> bool:
        """Put machine `m` into a state that makes the settings of `work`, if it has one."""
        mate = work.matching.mate
        sets = self.arrays.on[m]
        wanted = {v for v in frozenset().union(*sets) if mate[v] != EXPOSED}
        able = [k for k, on in enumerate(sets) if on == wanted]
        if able:
            start = self.graph.machines[m].start
            self.states[m] = start if start in able else able[0]
        return bool(able)

    def _settle(self, work: LiveAssignment, tied: list[int]) -> None:
        """Choose the states of machines one after another, those that cannot have theirs first."""
        first = set(tied)
        for m in tied + [m for m in self.order if m not in first]:
            if m not in first and self._take(work, m):
                self._decide(work, m, self.states[m])
                continue
            best: tuple[Score, int] | None = None
            for k in self._states_of(m):
                self._decide(work, m, k)
                score = self._score(work, m, k)
                work.undo()
                if best is None or score > best[0]:
                    best = score, k
            assert best is not None
            self.states[m] = best[1]
            self._decide(work, m, best[1])

    def _states_of(self, m: int) -> Iterable[int]:
        """List the states of `m` that differ for causality: of equals the start, or the first."""
        start = self.graph.machines[m].start
        sets = self.arrays.on[m]
        found = {sets[start]: start}
        for k, on in enumerate(sets):
            found.setdefault(on, k)
        return found.values()

    def _decide(self, work: LiveAssignment, m: int, k: int) -> None:
        self.steps += 1
        work.begin()
        sets = self.arrays.on[m]
        optional = work.matching.optional
        for v in sorted(frozenset().union(*sets)):
            if optional[v]:
                work.decide(v, on=v in sets[k])
            elif v not in sets[k]:
                work.turn(v, on=False)
        work.settle()

    def _score(self, work: LiveAssignment, m: int, k: int) -> Score:
        """Return how good `work` is, as far as it can differ by the state of `m`."""
        start = self.graph.machines[m].start
        return -work.broken, -work.dependent, len(self.arrays.on[m][k]), k == start

    def _improve(self, bound: set[int], tied: list[int]) -> None:
        """Try out modes of the connected parts that are not as good as the bound."""
        strokes = Strokes(self.graph, tuple(self.states), pins=self.pins, arrays=self.arrays)
        part = _parts(self.arrays)
        parts: dict[int, list[int]] = {}
        for m in self.order:
            on = frozenset().union(*self.arrays.on[m])
            if on:
                parts.setdefault(part[min(on)], []).append(m)
        stores = [part[self._vertex(k)] for k in range(len(self.arrays.stores))]
        best = [0] * self.arrays.nodes
        for k in bound:
            best[stores[k]] += 1
        for where, machines in parts.items():
            if not set(machines).intersection(tied):
                continue
            here = sum(stores[k] == where for k in strokes.derivative)
            if here == best[where] and not strokes.conflict:
                continue
            modes = 1
            for m in machines:
                modes *= len(list(self._states_of(m)))
            if modes <= WHOLE:
                self._try_all(strokes, machines)
            else:
                self.how = "best found"
                self._exchange(strokes, machines)
        self.states = list(strokes.mode)
        if strokes.conflict:
            self.how = "best found"

    def _vertex(self, storage: int) -> int:
        bond = self.arrays.stores[storage][0]
        return self.arrays.tail[bond]

    def _total(self, strokes: Strokes, machines: list[int]) -> Score:
        self.steps += 1
        on = started = 0
        mode = strokes.states
        for m in machines:
            on += len(self.arrays.on[m][mode[m]])
            started += mode[m] == self.graph.machines[m].start
        return -strokes.broken, -strokes.dependent, on, started

    def _try_all(self, strokes: Strokes, machines: list[int]) -> None:
        best, kept = self._total(strokes, machines), {m: strokes.states[m] for m in machines}
        for states in itertools.product(*(self._states_of(m) for m in machines)):
            strokes.turn(dict(zip(machines, states, strict=True)))
            score = self._total(strokes, machines)
            if score > best:
                best, kept = score, dict(zip(machines, states, strict=True))
        strokes.turn(kept)

    def _exchange(self, strokes: Strokes, machines: list[int]) -> None:
        reach = len(machines) if len(machines) <= PAIRED else NEXT
        groups: list[tuple[int, ...]] = [(m,) for m in machines]
        for k, m in enumerate(machines):
            groups += [(m, other) for other in machines[k + 1 : k + 1 + reach]]
        best = self._total(strokes, machines)
        moved = True
        while moved:
            moved = False
            for group in groups:
                for states in itertools.product(*(self._states_of(m) for m in group)):
                    strokes.turn(dict(zip(group, states, strict=True)))
                    score = self._total(strokes, machines)
                    if score > best:
                        best, moved = score, True
                    else:
                        strokes.undo()


def _varying(sets: list[frozenset[int]]) -> list[int]:
    """List the vertices that are ON in some of the states and OFF in others."""
    return sorted(frozenset().union(*sets).difference(frozenset(sets[0]).intersection(*sets)))


def _parts(arrays: Arrays) -> list[int]:
    """Return, per node, the least node of its part of the graph that hangs together."""
    parts = Joined(range(arrays.nodes))
    for ends in zip(arrays.tail, arrays.head, strict=True):
        parts.join(ends)
    for sets in arrays.on:
        parts.join(frozenset().union(*sets))
    least = {v: part[0] for part in parts.groups() for v in part}
    return [least[v] for v in range(arrays.nodes)]
