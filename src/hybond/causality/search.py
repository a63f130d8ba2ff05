"""Choosing strokes that nothing forces: storage first, then resistors, then what is left.

A choice is propagated at once. If it clashes, the other stroke is tried (a storage falls into
derivative causality); if both clash, the search goes back to the latest choice that had a part
in the clash and turns that one (conflict-directed backjumping, P. Prosser, *Hybrid algorithms
for the constraint satisfaction problem*, Computational Intelligence 9(3), 1993). Procedures as
taught never go back; on rings of junctions they end in conflicts that are none.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable
from dataclasses import dataclass, replace

from hybond.causality.demands import Demand, imposing, preferred
from hybond.causality.propagate import UNSET, Clash, Propagation
from hybond.causality.record import Because
from hybond.model.graph import End, FlatGraph, Node
from hybond.model.kinds import RESISTORS

BACKJUMP_WORK = 100
"""Strokes that backjumps may take back, per bond of the graph, before a conflict is accepted."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A stroke that propagation left open.

    `node` is the storage, resistor or junction that the choice is made for. `refused` says that
    the preferred stroke clashed, given the choices `ruled_out`; `accepted` that both clashed and
    nothing was left to turn. `start` and `clashes` are how much had been assigned and recorded
    before.
    """

    bond: int
    stroke: int
    rule: Because
    node: int
    start: int = 0
    clashes: int = 0
    refused: bool = False
    ruled_out: tuple[int, ...] = ()
    accepted: bool = False


class Search:
    """The choices for one mode.

    Parameters
    ----------
    graph : FlatGraph
        The graph.
    state : Propagation
        With all fixed strokes propagated; `run` completes it.
    """

    def __init__(self, graph: FlatGraph, state: Propagation) -> None:
        self.graph = graph
        self.state = state
        self.clashes: list[Clash] = []
        self.choices: list[Choice] = []
        self.place: dict[int, int] = {}
        """Position in `choices` by bond."""
        self.budget = BACKJUMP_WORK * max(len(graph.bonds), 100)
        self.gave_up = False
        self.learned: dict[int, tuple[int, dict[int, int]]] = {}
        """By bond: a stroke that clashes, and the strokes of the chosen bonds it clashes with."""
        self.resistors: list[tuple[Node, End]] = [
            (node, end) for node in graph.nodes if node.kind in RESISTORS for end in node.ends
        ]
        self.loose: list[int] = []
        """A heap with (among others) the tight junctions that have no resistor left."""
        self._rewind()

    def run(self) -> None:
        """Choose until every bond has a stroke."""
        steps = (
            self._next_storage,
            self._next_forcing_resistor,
            self._next_followed,
            self._next_resistor,
            self._next_junction,
            self._next_bond,
        )
        while True:
            choice = next((c for step in steps if (c := step()) is not None), None)
            if choice is None:
                return
            self._settle(choice)

    def _settle(self, choice: Choice) -> None:
        """Take `choice`, or what is left when it clashes."""
        state = self.state
        blame: set[int] = set()
        known = self._known(choice)
        if known is not None:
            blame = known
            choice = _turned(choice, blame)
        while True:
            start = len(state.trail)
            choice = replace(choice, start=start, clashes=len(self.clashes))
            clashes = self._take(choice, stop=True)
            if not clashes:
                self._keep(choice)
                return
            blame |= self._blame(clashes[0], choice.bond)
            state.undo(start)
            if not choice.refused:
                choice = self._turn(choice, blame)
                continue
            back = max((self.place[bond] for bond in blame), default=-1)
            if back < 0 or self.budget < 0:
                self.gave_up |= back >= 0
                choice = replace(
                    choice, stroke=1 - choice.stroke, refused=False, ruled_out=(), accepted=True
                )
                self.clashes += self._take(choice, stop=False)
                self._keep(choice)
                return
            earlier = self.choices[back]
            self.budget -= state.undo(earlier.start)
            for later in self.choices[back:]:
                del self.place[later.bond]
                if later.accepted:
                    # What was learned while its clash stood might hold no longer.
                    self.learned.clear()
            del self.choices[back:], self.clashes[earlier.clashes :]
            self._rewind()
            blame.remove(earlier.bond)
            choice = self._turn(earlier, blame)

    def _take(self, choice: Choice, *, stop: bool) -> list[Clash]:
        self.state.set(choice.bond, choice.stroke, choice.node, choice.rule)
        return self.state.run(stop=stop)

    def _keep(self, choice: Choice) -> None:
        self.place[choice.bond] = len(self.choices)
        self.choices.append(choice)

    def _turn(self, choice: Choice, blame: set[int]) -> Choice:
        """Return the other stroke of `choice`, and remember what rules this one out."""
        strokes = {bond: self.choices[self.place[bond]].stroke for bond in sorted(blame)}
        self.learned[choice.bond] = (choice.stroke, strokes)
        return _turned(choice, blame)

    def _known(self, choice: Choice) -> set[int] | None:
        """Return what rules `choice` out, if that was found before a backjump and still holds."""
        stroke, against = self.learned.get(choice.bond, (UNSET, {}))
        strokes = self.state.strokes
        if stroke != choice.stroke or any(strokes[b] != s for b, s in against.items()):
            return None
        return self._chosen(self.state.ancestry(against))

    def _blame(self, clash: Clash, own: int) -> set[int]:
        """Return the bonds of the choices, but for `own`, that `clash` follows from."""
        return self._chosen(self.state.culprits(clash)) - {own}

    def _chosen(self, bonds: Iterable[int]) -> set[int]:
        """Return the choices among `bonds` that can still be turned."""
        found: set[int] = set()
        for bond in bonds:
            if bond in self.place:
                choice = self.choices[self.place[bond]]
                # A choice that was ruled out cannot be turned again: those that did it can.
                if not choice.accepted:
                    found.update(choice.ruled_out if choice.refused else (bond,))
        return found

    def _rewind(self) -> None:
        """Look again from the start for what has no stroke."""
        self.at_storage = self.at_resistor = self.at_bond = 0
        self.follow = -1

    def _next_storage(self) -> Choice | None:
        """Return the first storage left, in integral causality."""
        for k in range(self.at_storage, len(self.graph.storages)):
            self.at_storage = k
            storage = self.graph.storages[k]
            if self.state.strokes[storage.bond] == UNSET:
                node = self.graph.nodes[storage.node]
                stroke = imposing(storage.sign > 0, preferred(node))
                return Choice(storage.bond, stroke, "storage", storage.node)
        self.at_storage = len(self.graph.storages)
        return None

    def _next_forcing_resistor(self) -> Choice | None:
        """Return a resistor at a junction where its choice settles the other end.

        Growing from what is known, in this order, keeps meshes of resistors free of dead ends.
        """
        tight = self.state.tight
        while tight:
            node = tight[0]
            if self.state.is_tight(node):
                for bond, _ in self.state.at[node]:
                    if self.state.strokes[bond] == UNSET:
                        for end in self.state.ends[bond]:
                            if self.graph.nodes[end].kind in RESISTORS:
                                return self._resistor(bond, end)
                heapq.heappush(self.loose, node)
            heapq.heappop(tight)
        return None

    def _next_followed(self) -> Choice | None:
        """Return the junction that the last resistor chosen left with two ends, if it did."""
        node, self.follow = self.follow, -1
        return self._junction(node) if node >= 0 and self.state.is_tight(node) else None

    def _next_resistor(self) -> Choice | None:
        """Return the first resistor left, in the direction of its law."""
        for k in range(self.at_resistor, len(self.resistors)):
            self.at_resistor = k
            node, end = self.resistors[k]
            if self.state.strokes[end.bond] == UNSET:
                tail, head = self.state.ends[end.bond]
                self.follow = tail if end.inward else head
                return self._resistor(end.bond, node.index)
        self.at_resistor = len(self.resistors)
        return None

    def _next_junction(self) -> Choice | None:
        """Return a junction with two ends left."""
        while self.loose:
            if self.state.is_tight(self.loose[0]):
                return self._junction(self.loose[0])
            heapq.heappop(self.loose)
        return None

    def _next_bond(self) -> Choice | None:
        """Return the first bond left, as the cause of the first junction that it ends at."""
        strokes = self.state.strokes
        for bond in range(self.at_bond, len(strokes)):
            self.at_bond = bond
            if strokes[bond] == UNSET:
                (first, at_first), (second, at_second) = self.state.sides[bond]
                alike = (Demand.NONE, Demand.ALIKE)
                if self.state.demand[first] in alike and self.state.demand[second] not in alike:
                    first, at_first = second, at_second
                return Choice(bond, self.state.causing(first, at_first), "free", first)
        self.at_bond = len(strokes)
        return None

    def _resistor(self, bond: int, node: int) -> Choice:
        head = self.state.ends[bond][1] == node
        stroke = imposing(head, preferred(self.graph.nodes[node]))
        return Choice(bond, stroke, "resistor", node)

    def _junction(self, node: int) -> Choice:
        bond, side = min(
            (bond, side) for bond, side in self.state.at[node] if self.state.strokes[bond] == UNSET
        )
        return Choice(bond, self.state.causing(node, side), "free", node)


def _turned(choice: Choice, ruled_out: set[int]) -> Choice:
    """Return the other stroke of `choice`, given what rules this one out."""
    return replace(
        choice, stroke=1 - choice.stroke, refused=True, ruled_out=tuple(sorted(ruled_out))
    )
