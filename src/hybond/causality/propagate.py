"""Propagation: what the strokes set so far force, at a cost of the ends touched.

A stroke that is set joins the queue. Taking a bond from the queue tells both its nodes; a node
then closes its other ends (it has its cause) or opens the last one left (which must be the
cause). Which stroke to choose where nothing is forced is not decided here.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from hybond.causality.demands import Demand, demand_of
from hybond.causality.record import HEAD, TAIL, Because, Origin
from hybond.model.graph import FlatGraph
from hybond.records import dataclass

UNSET = -1


@dataclass(frozen=True, slots=True)
class Clash:
    """Where propagation met two causes or none.

    `first` and `second` are the two bonds that disagree; `first` is -1 if no bond brings a cause.
    `own` is set if the second cause is the node itself, on the bond `first`.
    """

    node: int
    first: int
    second: int
    kind: Literal["over", "under"]
    own: Origin | None = None


class Propagation:
    """The strokes of one mode while they are being assigned.

    Parameters
    ----------
    graph : FlatGraph
        The graph; not changed.
    off : frozenset of int
        The nodes that are OFF.
    """

    def __init__(self, graph: FlatGraph, off: frozenset[int]) -> None:
        count = len(graph.bonds)
        self.ends = [(b.tail, b.head) for b in graph.bonds]
        self.demand = [demand_of(n, off) for n in graph.nodes]
        self.kinds = list(self.demand)
        """The demands that `demand` starts with: some nodes may be let go later."""
        self.at = [
            [(e.bond, HEAD if e.inward else TAIL) for e in n.ends] if self.demand[n.index] else []
            for n in graph.nodes
        ]
        self.strokes = [UNSET] * count
        self.parent = [-1] * count
        self.via = [-1] * count
        self.starts: list[Origin | None] = [None] * count
        self.trail: list[int] = []
        self.done = 0
        self.open = [len(at) for at in self.at]
        self.cause = [-1] * len(self.at)

    def forget(self, nodes: Iterable[int]) -> None:
        """Let `nodes` join nothing; before the first stroke is set."""
        for node in nodes:
            self.demand[node] = Demand.NONE

    def set(self, bond: int, stroke: int, node: int, rule: Because) -> None:
        """Give `bond` a stroke that starts a chain at `node`, and queue it."""
        self.strokes[bond] = stroke
        self.starts[bond] = Origin(node, rule)
        self.parent[bond] = self.via[bond] = -1
        self.trail.append(bond)

    def origin_of(self, bond: int) -> Origin:
        """Return the element that the chain of `bond` starts at."""
        origin = self.starts[self.chain(bond)[0]]
        assert origin is not None
        return origin

    def chain(self, bond: int) -> tuple[int, ...]:
        """Return the bonds from the forcing element to `bond`."""
        found = [bond]
        while (bond := self.parent[bond]) >= 0:
            found.append(bond)
        return tuple(reversed(found))

    def run(self) -> list[Clash]:
        """Propagate all that is queued; list the clashes, at which the first cause stays."""
        clashes: list[Clash] = []
        while self.done < len(self.trail):
            bond = self.trail[self.done]
            self.done += 1
            tail, head = self.ends[bond]
            # Nodes are told in the order of their index, whichever way the arrow points.
            sides = ((tail, TAIL), (head, HEAD)) if tail < head else ((head, HEAD), (tail, TAIL))
            for node, side in sides:
                if self.demand[node]:
                    clash = self._tell(node, bond, side)
                    if clash is not None:
                        clashes.append(clash)
        return clashes

    def causing(self, node: int, side: int) -> int:
        """Return the stroke that makes a bond, at `side` of which `node` is, its cause."""
        return 1 - side if self.demand[node] is Demand.ONE_FLOW else side

    def premises(self, bond: int) -> list[int]:
        """List the bonds that together forced `bond`."""
        via, parent = self.via[bond], self.parent[bond]
        if via < 0:
            return []
        if self.demand[via] is Demand.ALIKE or self.cause[via] == parent:
            return [parent]
        return [other for other, _ in self.at[via] if other != bond]

    def ancestry(self, bonds: Iterable[int]) -> list[int]:
        """List `bonds` and all that forced them, each once."""
        found = list(dict.fromkeys(bonds))
        seen = set(found)
        for bond in found:
            for premise in self.premises(bond):
                if premise not in seen:
                    seen.add(premise)
                    found.append(premise)
        return found

    def culprits(self, clash: Clash) -> list[int]:
        """List the bonds that a clash follows from."""
        if clash.first >= 0:
            return self.ancestry([clash.first, clash.second])
        return self.ancestry(bond for bond, _ in self.at[clash.node])

    def _tell(self, node: int, bond: int, side: int) -> Clash | None:
        demand = self.demand[node]
        self.open[node] -= 1
        left = self.open[node]
        if demand is Demand.ALIKE:
            return self._tell_gyrator(node, bond, receives=self.strokes[bond] == side)
        if self.strokes[bond] == self.causing(node, side):
            if self.cause[node] >= 0:
                return Clash(node, self.cause[node], bond, "over")
            self.cause[node] = bond
            if left:
                for other, at in self.at[node]:
                    if self.strokes[other] == UNSET:
                        stroke = 1 - self.causing(node, at)
                        self._pass(other, stroke, parent=bond, via=node)
        elif self.cause[node] < 0:
            if left == 0:
                return Clash(node, -1, bond, "under")
            if left == 1:
                for other, at in self.at[node]:
                    if self.strokes[other] == UNSET:
                        self._pass(other, self.causing(node, at), parent=bond, via=node)
        return None

    def _tell_gyrator(self, node: int, bond: int, *, receives: bool) -> Clash | None:
        for other, at in self.at[node]:
            if other == bond:
                continue
            if self.strokes[other] == UNSET:
                self._pass(other, at if receives else 1 - at, parent=bond, via=node)
            elif self.open[node] == 0 and (self.strokes[other] == at) != receives:
                return Clash(node, other, bond, "over")
        return None

    def _pass(self, bond: int, stroke: int, *, parent: int, via: int) -> None:
        self.strokes[bond] = stroke
        self.parent[bond] = parent
        self.via[bond] = via
        self.trail.append(bond)
