"""Controllability read off the graph: causal paths and the derivative assignment.

A mode is structurally controllable (C. Sueur and G. Dauphin-Tanguy, *Bond-graph approach for
structural analysis of MIMO linear systems*, J. Franklin Institute 328(1), 1991) if

1. in the integral assignment a causal path leads from a source to each storage in integral
   causality, perhaps through other storages, and
2. in the derivative assignment, with sources dualised where that helps, every storage accepts
   derivative causality.

The second condition is about motions at rest, s = 0: as many storages as must stay integral are
combinations that no source moves. Both are read from strokes alone. They hold for nearly all values
of elements that are independent of each other: a ring of junctions and equal transformers can
cancel what a path carries, which strokes do not show.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np

from hybond.causality.assign import assign
from hybond.causality.demands import Demand, demand_of
from hybond.causality.record import Causality
from hybond.model.graph import FlatGraph, Mode, Node, Storage
from hybond.model.kinds import RESISTORS, SOURCES, STORAGES

Variable = tuple[int, str]
"""A bond and ``"e"`` or ``"f"``."""


@dataclass(frozen=True, slots=True)
class Paths:
    """What the strokes say about the controllability of one mode."""

    order: int
    """Storages in integral causality."""
    unreached: tuple[int, ...]
    """Those of them to which no causal path leads from a source."""
    stuck: tuple[int, ...]
    """Storages that stay in integral causality in the derivative assignment. Which ones is a matter
    of choice, how many is not."""
    dualised: tuple[int, ...]
    """Source nodes that were dualised for it."""
    conflicts: bool
    """Whether an assignment has causal conflicts; then nothing is claimed."""

    @property
    def controllable(self) -> bool | None:
        """Whether both conditions hold; None if the causality has conflicts."""
        return None if self.conflicts else not self.unreached and not self.stuck


def paths(
    graph: FlatGraph,
    mode: Mode,
    *,
    inputs: Collection[int] | None = None,
    causality: Causality | None = None,
) -> Paths:
    """Return what strokes say about controllability.

    Parameters
    ----------
    graph, mode
        As in `hybond.causality.assign.assign`.
    inputs : collection of int, optional
        The source nodes that count as inputs; all that are ON if not given.
    causality : Causality, optional
        The integral assignment, if it is at hand.

    Examples
    --------
    Two capacitors on one current source: each is reached, but their difference is at rest.

    >>> import hybond as hb
    >>> m = hb.Model("series")
    >>> m.add(J=hb.Sf(1), i=hb.One(), c1=hb.C(1), c2=hb.C(2))
    >>> m.bond("J -> i -> c1", "i -> c2")
    >>> graph = m.flatten()
    >>> found = paths(graph, graph.start_mode)
    >>> found.unreached, [graph.storages[k].path for k in found.stuck], found.controllable
    ((), ['c2.q'], False)
    """
    off = graph.off_nodes(mode)
    sources = [n for n in graph.nodes if n.kind in SOURCES and n.index not in off]
    chosen = [n for n in sources if inputs is None or n.index in inputs]
    causality = causality or assign(graph, mode, pins={})
    signals = SignalGraph(graph, mode, causality)
    reached = signals.after(signals.output(n, 0) for n in chosen)
    integral = [s for s in graph.storages if s.index not in causality.derivative]
    unreached = tuple(
        s.index for s in integral if signals.output(graph.nodes[s.node], s.port) not in reached
    )
    stuck, dualised, conflicts = derivative_assignment(graph, mode, chosen)
    return Paths(len(integral), unreached, stuck, dualised, bool(conflicts or causality.conflicts))


def derivative_assignment(
    graph: FlatGraph, mode: Mode, inputs: Iterable[Node]
) -> tuple[tuple[int, ...], tuple[int, ...], bool]:
    """Return the storages that stay integral, the sources dualised, whether there are conflicts.

    Derivative causality is what a C prefers if it were an I. Sources that may be dualised take
    the part of storages that come last: they keep their causality if no storage needs another.
    """
    swapped = {"C": "I", "I": "C"}
    held = {"Se": "C", "Sf": "I"}
    free = {n.index for n in inputs}
    nodes = []
    for n in graph.nodes:
        if n.kind in STORAGES:
            n = replace(n, kind=swapped[n.kind])
        elif n.index in free:
            n = replace(n, kind=held[n.kind], law=None)
        nodes.append(n)
    storages = [replace(s, kind=nodes[s.node].kind) for s in graph.storages]  # type: ignore[arg-type]
    for n in graph.nodes:
        if n.index in free:
            (end,) = n.ends
            kind = nodes[n.index].kind
            storages.append(
                Storage(len(storages), n.index, 0, end.bond, end.sign, kind, n.path, 0.0)  # type: ignore[arg-type]
            )
    other = replace(graph, nodes=tuple(nodes), storages=tuple(storages))
    # strokes that the modeller pinned are for the integral assignment
    found = assign(other, mode, pins={})
    count = len(graph.storages)
    stuck = tuple(k for k in found.derivative if k < count)
    dualised = tuple(storages[k].node for k in found.derivative if k >= count)
    return stuck, dualised, bool(found.conflicts)


class SignalGraph:
    """The variables of the bonds, each leading to those it is a cause of.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(V=hb.Se(1), i=hb.One(), r=hb.R(1), c=hb.C(1))
    >>> m.bond("V -> i -> r", "i -> c")
    >>> graph = m.flatten()
    >>> signals = SignalGraph(graph, (), assign(graph, ()))
    >>> sorted(signals.after([(0, "e")]))
    [(0, 'e'), (0, 'f'), (1, 'e'), (1, 'f'), (2, 'e'), (2, 'f')]
    """

    def __init__(self, graph: FlatGraph, mode: Mode, causality: Causality) -> None:
        self.graph = graph
        self.causality = causality
        off = graph.off_nodes(mode)
        self.next: dict[Variable, list[Variable]] = {}
        self.at: dict[Variable, int] = {}
        """The node that an edge from this variable passes through."""
        for node in graph.nodes:
            for k, m in _links(node, off):
                a = self.input(node, k)
                b = self.output(node, m)
                through = node.kind in ("0", "1", "TF")
                if node.kind in ("0", "1", "TF", "GY") and (a[1] == b[1]) != through:
                    continue
                self.next.setdefault(a, []).append(b)
                self.at[a] = node.index

    def output(self, node: Node, port: int) -> Variable:
        """Return the variable that `node` gives at a port."""
        bond = _end(node, port)
        return bond, "e" if self.causality.effort_imposed_by(bond) == node.index else "f"

    def input(self, node: Node, port: int) -> Variable:
        """Return the variable that `node` receives at a port."""
        bond, given = self.output(node, port)
        return bond, "f" if given == "e" else "e"

    def after(
        self, start: Iterable[Variable], *, through_storage: bool = True
    ) -> frozenset[Variable]:
        """Return `start` and all that it is a cause of, perhaps only within the same instant."""
        return self._reach(start, self.next, through_storage)

    def before(
        self, end: Iterable[Variable], *, through_storage: bool = True
    ) -> frozenset[Variable]:
        """Return `end` and all that is a cause of it."""
        back: dict[Variable, list[Variable]] = {}
        for a, found in self.next.items():
            for b in found:
                back.setdefault(b, []).append(a)
        return self._reach(end, back, through_storage)

    def _reach(
        self, start: Iterable[Variable], edges: dict[Variable, list[Variable]], through: bool
    ) -> frozenset[Variable]:
        seen = dict.fromkeys(start)
        queue = deque(seen)
        while queue:
            a = queue.popleft()
            for b in edges.get(a, ()):
                node = self.at[a] if edges is self.next else self.at[b]
                if b in seen or (not through and self.graph.nodes[node].kind in STORAGES):
                    continue
                seen[b] = None
                queue.append(b)
        return frozenset(seen)


def _end(node: Node, port: int) -> int:
    return next(e.bond for e in node.ends if e.port == port)


def _links(node: Node, off: Collection[int]) -> list[tuple[int, int]]:
    """List the pairs of ports (received, given) between which `node` passes something on."""
    ports = [e.port for e in node.ends]
    if node.is_junction or node.kind in ("TF", "GY"):
        if demand_of(node, frozenset(off)) is Demand.NONE:
            return []
        return [(a, b) for a in ports for b in ports if a != b]
    if node.kind in SOURCES or node.index in off:
        return []
    law = node.law
    if law is None or law.matrix is None:
        return [(a, b) for a in ports for b in ports]
    joined = np.array(law.matrix) != 0.0
    if node.kind in RESISTORS and len(ports) == 1:
        return [(0, 0)] if joined[0, 0] else []
    # which port gives what differs from the matrix as written: join all that are coupled
    joined = joined | joined.T | np.eye(len(ports), dtype=bool)
    for _ in ports:
        joined = joined @ joined
    return [(a, b) for a in ports for b in ports if joined[a, b]]
