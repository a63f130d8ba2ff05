"""Why each bond has the stroke it has: choices, and what propagates from them.

The strokes are known when this starts. What is fixed is propagated first, with its conflicts;
then storages, resistors and bare junctions whose bond has no reason yet are taken as choices,
and each is propagated at once. So every stroke gets a chain that ends at what forces it, as in
the sequential causality assignment procedure of D. C. Karnopp and R. C. Rosenberg, but no
choice is ever a dead end.
"""

from __future__ import annotations

from collections.abc import Mapping

from hybond.causality.arrays import LEAF, compile_arrays
from hybond.causality.assignment import Assignment
from hybond.causality.demands import Demand, fixed_ends, imposing, preferred
from hybond.causality.matching import SETTLED
from hybond.causality.propagate import UNSET, Clash, Propagation
from hybond.causality.record import Because, Causality, Conflict, Origin, Reason
from hybond.model.graph import FlatGraph
from hybond.model.kinds import RESISTORS, TWO_PORTS, Variable
from hybond.records import dataclass

NEARBY = 300
"""Vertices that a conflict is told from, beyond those of its own search."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A stroke that propagation left open.

    `refused` says that the preferred stroke is infeasible, given the chosen bonds `ruled_out`.
    """

    bond: int
    rule: Because
    node: int
    refused: bool = False
    ruled_out: tuple[int, ...] = ()


def account(
    graph: FlatGraph,
    work: Assignment,
    *,
    off: frozenset[int],
    pins: Mapping[int, int],
    unknown: frozenset[int] = frozenset(),
) -> Causality:
    """Return the record of an assignment: its strokes, with reasons, loops and conflicts.

    Parameters
    ----------
    work : Assignment
        The strokes. If it has conflicts, they are replaced by those that fixed causes lead to,
        propagated in the order of the nodes.
    off : frozenset of int
        The nodes that are OFF.
    unknown : frozenset of int
        Nodes that demand nothing.
    """
    state, clashes = _fixed(graph, off, pins, unknown)
    involved: dict[int, _Region] = {}
    broken: list[int] = []
    if work.conflict:
        told = unknown | {clash.node for clash in clashes}
        arrays = compile_arrays(graph, unknown=told, switched=off)
        fixed = {bond: state.strokes[bond] for bond in state.trail}
        work = Assignment(arrays, off=off, pins=fixed)
        for v in sorted(work.exposed):
            node, region = _broken(work, v)
            broken.append(node)
            involved[node] = region
            state.demand[node] = Demand.NONE
    choices = _Choices(graph, state, work).run()
    place = {bond: k for k, bond in enumerate(state.trail)}
    clashes += [_clash(state, node, place) for node in sorted(set(broken))]
    return _record(graph, state, choices, clashes, involved, off)


def _fixed(
    graph: FlatGraph, off: frozenset[int], pins: Mapping[int, int], unknown: frozenset[int]
) -> tuple[Propagation, list[Clash]]:
    """Propagate what is fixed, then the pins; the first of two causes has the stroke."""
    state = Propagation(graph, off)
    state.forget(unknown)
    clashes: list[Clash] = []
    for node in graph.nodes:
        if node.index in unknown:
            continue
        for k, variable, rule in fixed_ends(node, off):
            end = node.ends[k]
            stroke = imposing(end.inward, variable)
            if state.strokes[end.bond] == UNSET:
                state.set(end.bond, stroke, node.index, rule)
            elif state.strokes[end.bond] != stroke:
                own = Origin(node.index, rule)
                clashes.append(Clash(node.index, end.bond, end.bond, "over", own))
    clashes += state.run()
    for bond, stroke in sorted(pins.items()):
        place = state.ends[bond][stroke]
        if state.strokes[bond] == UNSET:
            state.set(bond, stroke, place, "pin")
            clashes += state.run()
        elif state.strokes[bond] != stroke:
            clashes.append(Clash(place, bond, bond, "over", Origin(place, "pin")))
    return state, clashes


@dataclass(frozen=True, slots=True)
class _Region:
    """What shows that a junction cannot be given a cause.

    Junctions that share too few causes, and the fixed bonds that keep others from them.
    """

    nodes: tuple[int, ...]
    fixed: tuple[int, ...]


def _broken(work: Assignment, v: int) -> tuple[int, _Region]:
    """Return the node at which the exposed vertex `v` shows, and what shows that it must."""
    arrays, m = work.arrays, work.matching
    node = v
    if v >= arrays.nodes:
        bond = v - arrays.nodes
        node = min(arrays.tail[bond], arrays.head[bond])
        m.put(bond, arrays.cause_stroke(bond, node))
    tree_of = work.hard.tree_of
    first = tree_of[v]
    assert first is not None
    # A search that stopped at the region of another one rests on that region too; of very many
    # conflicts in one place each is told from what is near.
    region = list(first.vertices)
    trees = {first}
    fixed: set[int] = set()
    for u in region:
        for bond, w in arrays.near[u]:
            if not m.free[bond]:
                fixed.add(bond)
            elif m.mate[w] == SETTLED:
                fixed.update(b for b, _ in arrays.near[w] if not m.free[b])
            elif len(region) < NEARBY and (other := tree_of[w]) not in trees and other:
                trees.add(other)
                region += other.vertices
    nodes = tuple(sorted(w for w in region if w < arrays.nodes))
    return node, _Region(nodes, tuple(sorted(fixed)))


class _Choices:
    """The choices taken so far."""

    def __init__(self, graph: FlatGraph, state: Propagation, work: Assignment) -> None:
        self.graph, self.state, self.work = graph, state, work
        self.taken: list[Choice] = []
        self._preferred: set[int] = set()

    def run(self) -> list[Choice]:
        """Take as choices, in order, the bonds that have no reason, and propagate each."""
        self._storages()
        self._resistors()
        strokes = self.state.strokes
        for bond in range(len(strokes)):
            if strokes[bond] == UNSET:
                self._take(Choice(bond, "free", _first_vertex(self.state, bond)))
        return self.taken

    def _take(self, choice: Choice) -> None:
        self.taken.append(choice)
        if not choice.refused:
            self._preferred.add(choice.bond)
        stroke = self.work.matching.stroke[choice.bond]
        self.state.set(choice.bond, stroke, choice.node, choice.rule)
        clashes = self.state.run()
        assert not clashes

    def _storages(self) -> None:
        graph, arrays, strokes = self.graph, self.work.arrays, self.work.matching.stroke
        derivative = []
        for k, (bond, wanted) in enumerate(arrays.stores):
            if self.state.strokes[bond] == UNSET:
                if strokes[bond] == wanted:
                    self._take(Choice(bond, "storage", graph.storages[k].node))
                else:
                    derivative.append((bond, graph.storages[k].node))
        for bond, node in derivative:
            if self.state.strokes[bond] == UNSET:
                against = self._against(bond) or ()
                self._take(Choice(bond, "storage", node, True, against))

    def _resistors(self) -> None:
        """Take the resistors in order; those taken are shut to those that follow."""
        arrays, m = self.work.arrays, self.work.matching
        shut = []
        for resistor in self.graph.nodes:
            if resistor.kind not in RESISTORS:
                continue
            for end in resistor.ends:
                bond, node = end.bond, resistor.index
                if self.state.strokes[bond] == UNSET:
                    if m.stroke[bond] == imposing(end.inward, preferred(resistor)):
                        self._take(Choice(bond, "resistor", node))
                    elif (against := self._against(bond)) is None:
                        # It could be the other way: a change near the switch was enough.
                        self._take(Choice(bond, "free", node))
                    else:
                        self._take(Choice(bond, "resistor", node, True, against))
                m.shut[arrays.nodes + bond] = True
                shut.append(arrays.nodes + bond)
        for leaf in shut:
            m.shut[leaf] = False

    def _against(self, bond: int) -> tuple[int, ...] | None:
        """Return the choices that keep `bond` from its preferred stroke; None if it could be."""
        if self.work.arrays.form[bond] != LEAF:
            return ()
        blockers = self.work.blockers(bond)
        if blockers is None:
            return None
        return tuple(sorted(self._preferred.intersection(self.state.ancestry(blockers))))


def _first_vertex(state: Propagation, bond: int) -> int:
    """Return the first junction that `bond` ends at; by index, not by arrow."""
    first, second = sorted(state.ends[bond])
    alike = (Demand.NONE, Demand.ALIKE)
    if state.demand[first] in alike and state.demand[second] not in alike:
        return second
    return first


def _clash(state: Propagation, node: int, place: Mapping[int, int]) -> Clash:
    """Return what is wrong at a node that the best assignment leaves without its one cause."""
    at = sorted((place[bond], bond, side) for bond, side in state.at[node])
    kind = state.kinds[node]
    last = at[-1][1]
    if kind is Demand.ALIKE:
        return Clash(node, at[0][1], last, "over")
    flow = kind is Demand.ONE_FLOW
    causes = [bond for _, bond, side in at if state.strokes[bond] == (1 - side if flow else side)]
    if causes:
        return Clash(node, causes[0], causes[1], "over")
    return Clash(node, -1, last, "under")


def _record(
    graph: FlatGraph,
    state: Propagation,
    choices: list[Choice],
    clashes: list[Clash],
    involved: Mapping[int, _Region],
    off: frozenset[int],
) -> Causality:
    strokes = tuple(state.strokes)
    reasons: list[Reason] = [Reason(Origin(-1, "free"))] * len(strokes)
    for bond in state.trail:
        start, parent = state.starts[bond], state.parent[bond]
        if parent >= 0:
            reasons[bond] = Reason(reasons[parent].origin, parent, state.via[bond])
        else:
            assert start is not None
            reasons[bond] = Reason(start)
    for choice in choices:
        if choice.refused:
            start = reasons[choice.bond].origin
            reasons[choice.bond] = Reason(start, refused=True, ruled_out=choice.ruled_out)
    resistors: dict[tuple[int, int], Variable] = {
        (node.index, end.port): "f" if strokes[end.bond] == int(end.inward) else "e"
        for node in graph.nodes
        if node.kind in RESISTORS
        for end in node.ends
    }
    return Causality(
        strokes=strokes,
        reasons=tuple(reasons),
        derivative=tuple(
            s.index
            for s in graph.storages
            if strokes[s.bond] != imposing(s.sign > 0, "e" if s.kind == "C" else "f")
        ),
        resistors=resistors,
        loops=tuple(c.bond for c in choices if c.rule in ("resistor", "free") and not c.refused),
        conflicts=tuple(
            _conflict(graph, state, clash, involved.get(clash.node), off) for clash in clashes
        ),
        ends=tuple(state.ends),
    )


def _conflict(
    graph: FlatGraph,
    state: Propagation,
    clash: Clash,
    region: _Region | None,
    off: frozenset[int],
) -> Conflict:
    node = graph.nodes[clash.node]
    a, b = clash.first, clash.second
    bonds: tuple[int, ...] = (a, b)
    kind = clash.kind
    if clash.kind == "under":
        bonds = tuple(bond for bond, _ in state.at[clash.node])
        # Two causes that differ tell more than two that share a forcing element.
        a = bonds[0]
        forcing = state.origin_of(a)
        b = next((bond for bond in reversed(bonds) if state.origin_of(bond) != forcing), bonds[-1])
        if node.kind in TWO_PORTS:
            # Both sides impose the same variable: two causes for it, though none for the other.
            kind, a, b = "over", min(bonds), max(bonds)
    involved = {clash.node, *(region.nodes if region else ())}
    for bond in state.ancestry(region.fixed) if region else state.culprits(clash):
        start = state.starts[bond] if state.parent[bond] < 0 else None
        involved.add(start.node if start else state.via[bond])
    switches = tuple(
        (graph.nodes[k].path, k not in off) for k in sorted(involved) if graph.nodes[k].controlled
    )
    gives_a = _received(state, a, clash.node)
    return Conflict(
        node=clash.node,
        bonds=tuple(dict.fromkeys(bonds)),
        kind=kind,
        chain_a=state.chain(a),
        chain_b=(b,) if clash.own else state.chain(b),
        origin_a=state.origin_of(a),
        origin_b=clash.own or state.origin_of(b),
        gives=(gives_a, gives_a if clash.own else _received(state, b, clash.node)),
        switches=switches,
    )


def _received(state: Propagation, bond: int, node: int) -> Variable:
    """Return the variable of `bond` that is imposed on `node`."""
    return "e" if state.ends[bond][state.strokes[bond]] == node else "f"
