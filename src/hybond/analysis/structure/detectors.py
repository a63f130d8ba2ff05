"""Observability read off the graph: causal paths to detectors, and detectors dualised.

A detector of effort is a 0-junction in the bond with a source of no flow on it, one of flow a
1-junction with a source of no effort. The conditions are those of `paths`, dual: a
causal path from each storage in integral causality to a detector, and derivative causality for
every storage if detectors are dualised where that helps (C. Sueur and G. Dauphin-Tanguy, J.
Franklin Institute 328(1), 1991).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybond.analysis.structure.paths import Paths, SignalGraph, Variable, derivative_assignment
from hybond.causality.assign import assign
from hybond.causality.record import Causality
from hybond.model.expressions import Expr, Name, Neg
from hybond.model.graph import Bond, End, FlatGraph, Mode, Node


def detected(graph: FlatGraph, e: Expr) -> Variable | None:
    """Return the bond variable that a signal is, or shows as well; None if it is no such one.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(c=hb.C(1), r=hb.R(1), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> graph = m.flatten()
    >>> detected(graph, graph.read("r.f")), detected(graph, graph.read("c.q"))
    ((1, 'f'), (0, 'e'))
    """
    if isinstance(e, Neg):
        return detected(graph, e.arg)
    if not isinstance(e, Name):
        return None
    kind, _, index = e.path.partition(":")
    if kind in ("e", "f"):
        return int(index), kind
    if kind == "x":
        storage = graph.storages[int(index)]
        if len(graph.nodes[storage.node].ends) == 1:
            # what a storage of one port holds tells its co-energy variable, and that tells it
            return storage.bond, "e" if storage.kind == "C" else "f"
    return None


def paths_to(
    graph: FlatGraph,
    mode: Mode,
    outputs: Sequence[Variable],
    *,
    causality: Causality | None = None,
) -> Paths:
    """Return what strokes say about observability; `unreached` are storages that no output sees.

    Examples
    --------
    Of two capacitors in series only their sum of voltages is seen:

    >>> import hybond as hb
    >>> m = hb.Model("series")
    >>> m.add(J=hb.Sf(1), i=hb.One(), c1=hb.C(1), c2=hb.C(2))
    >>> m.bond("J -> i -> c1", "i -> c2")
    >>> found = paths_to(m.flatten(), (), [(0, "e")])
    >>> found.unreached, found.stuck, found.controllable
    ((), (1,), False)
    """
    causality = causality or assign(graph, mode, pins={})
    signals = SignalGraph(graph, mode, causality)
    seen = signals.before(outputs)
    integral = [s for s in graph.storages if s.index not in causality.derivative]
    unreached = tuple(
        s.index for s in integral if signals.output(graph.nodes[s.node], s.port) not in seen
    )
    measured, detectors = with_detectors(graph, outputs)
    stuck, dualised, conflicts = derivative_assignment(measured, mode, detectors)
    return Paths(len(integral), unreached, stuck, dualised, bool(conflicts or causality.conflicts))


def with_detectors(
    graph: FlatGraph, outputs: Sequence[Variable]
) -> tuple[FlatGraph, tuple[Node, ...]]:
    """Return the graph with a detector in each of these bonds, and the detectors.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(c=hb.C(1), r=hb.R(1))
    >>> m.bond("c -> r")
    >>> graph, (detector,) = with_detectors(m.flatten(), [(0, "e")])
    >>> [b.name for b in graph.bonds], detector.kind
    (['c -> r', 'c -> r (rest)', 'c -> r (seen)'], 'Sf')
    """
    nodes, bonds, storages = list(graph.nodes), list(graph.bonds), list(graph.storages)
    found = []
    for bond, variable in dict.fromkeys(outputs):
        old = bonds[bond]
        rest, tap = len(bonds), len(bonds) + 1
        middle, detector = len(nodes), len(nodes) + 1
        head = nodes[old.head]
        ends = tuple(replace(e, bond=rest) if e.bond == bond and e.inward else e for e in head.ends)
        nodes[old.head] = replace(head, ends=ends)
        storages = [
            replace(s, bond=rest) if s.bond == bond and s.node == old.head else s for s in storages
        ]
        bonds[bond] = replace(old, head=middle)
        bonds += [
            Bond(rest, middle, old.head, f"{old.name} (rest)", old.domain),
            Bond(tap, middle, detector, f"{old.name} (seen)", old.domain),
        ]
        kind, source = ("0", "Sf") if variable == "e" else ("1", "Se")
        at = (End(bond, True, 0), End(rest, False, 1), End(tap, False, 2))
        nodes += [
            Node(middle, f"{old.name} junction", kind, at, old.domain),
            Node(detector, f"{old.name} detector", source, (End(tap, True, 0),), old.domain),
        ]
        found.append(detector)
    measured = replace(
        graph, nodes=tuple(nodes), bonds=tuple(bonds), storages=tuple(storages), pins={}
    )
    return measured, tuple(nodes[k] for k in found)
