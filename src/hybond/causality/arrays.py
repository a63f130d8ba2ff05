"""A graph compiled for causality: integer lists, so that algorithms never touch objects.

Causality is a matching problem. A bond has one bit, its stroke. Each junction or two-port that
is ON wants *exactly one* of its bonds to be its cause:

- a 0-junction the bond that brings its effort (stroke at the junction),
- a 1-junction the bond that brings its flow (stroke away from it),
- a transformer like a 0-junction; a gyrator like a 0-junction at its first port and like a
  1-junction at its second.

So a bond between two of these *vertices* is one of two things. If one stroke makes it the cause
of both and the other of neither, it is an **edge**, in the matching or not. If each stroke makes
it the cause of one of them, it is a path through a vertex of its own, the **middle**, which is
always matched to one side. A bond to a storage or resistor is an edge to a **leaf**, which may
be matched or not. A complete causality is a matching that covers all vertices and middles; a
graph whose cycles have an even number of gyrators is bipartite.
"""

from __future__ import annotations

from collections.abc import Collection

from hybond.causality.demands import Demand, demand_of, fixed_ends, imposing, preferred
from hybond.causality.record import HEAD, TAIL
from hybond.model.graph import FlatGraph
from hybond.model.kinds import RESISTORS
from hybond.records import dataclass
from hybond.uncollected import uncollected

EDGE, MIDDLE, LEAF, BARE = range(4)
"""What a bond is in the matching; BARE joins two elements and has no part in it."""


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """The integer form of a graph; never changed once made.

    Vertices are numbered ``0 .. nodes - 1`` by node and ``nodes + b`` for the middle or leaf of
    bond ``b``. A stroke that does not exist is -1.
    """

    nodes: int
    bonds: int
    """`nodes` and `bonds`: how many."""
    tail: list[int]
    head: list[int]
    """`tail` and `head`: the nodes of each bond."""
    form: list[int]
    """`EDGE`, `MIDDLE`, `LEAF` or `BARE` per bond."""
    at_tail: list[int]
    at_head: list[int]
    """`at_tail` and `at_head`: the stroke with which a bond is the cause of its tail, of its
    head."""
    near: list[list[tuple[int, int]]]
    """Per vertex: bonds and the vertices that they lead to."""
    fixed: list[tuple[int, int]]
    """Bonds and strokes that elements impose in every mode."""
    off: dict[int, list[tuple[int, int]]]
    """Bonds and strokes that a controlled vertex imposes when it is OFF."""
    wish: list[int]
    """The stroke that puts the storage at a `LEAF` bond into integral causality."""
    law: list[int]
    """The stroke in the direction of the law of the resistor at a bond."""
    stores: list[tuple[int, int]]
    """Per storage: its bond and the stroke of integral causality."""
    stored: dict[int, list[int]]
    """The storages at a bond."""
    optional: bytearray
    """Per vertex: whether it is a leaf."""
    on: list[list[frozenset[int]]]
    """Per machine and state: the vertices that are ON."""

    def cause_stroke(self, bond: int, node: int) -> int:
        """Return the stroke with which `bond` is the cause of `node`."""
        return (self.at_tail if self.tail[bond] == node else self.at_head)[bond]


@uncollected
def compile_arrays(
    graph: FlatGraph, *, unknown: Collection[int] = (), switched: Collection[int] = ()
) -> Arrays:
    """Compile `graph`.

    Parameters
    ----------
    unknown : collection of int
        Nodes that demand nothing, as if they were resistors.
    switched : collection of int
        Nodes that may be OFF besides those that are controlled.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(V=hb.Se(1), j=hb.One(), r=hb.R(1), n=hb.Zero(), c=hb.C(1))
    >>> m.bond("V -> j -> n -> c", "j -> r")
    >>> arrays = compile_arrays(m.flatten())
    >>> [("edge", "middle", "leaf", "bare")[form] for form in arrays.form]
    ['leaf', 'edge', 'leaf', 'leaf']
    """
    nodes, bonds = len(graph.nodes), len(graph.bonds)
    tail, head = [b.tail for b in graph.bonds], [b.head for b in graph.bonds]
    at_tail, at_head = [-1] * bonds, [-1] * bonds
    fixed: list[tuple[int, int]] = []
    off: dict[int, list[tuple[int, int]]] = {}
    law = [-1] * bonds
    none: frozenset[int] = frozenset()
    for node in graph.nodes:
        index = node.index
        if index in unknown:
            continue
        demand = demand_of(node, none)
        if demand is Demand.NONE:
            for k, variable, _ in fixed_ends(node, none):
                fixed.append((node.ends[k].bond, imposing(node.ends[k].inward, variable)))
            if node.kind in RESISTORS:
                output = preferred(node)
                for end in node.ends:
                    if law[end.bond] < 0:
                        law[end.bond] = imposing(end.inward, output)
            continue
        for place, end in enumerate(node.ends):
            side = HEAD if end.inward else TAIL
            flow = demand is Demand.ONE_FLOW or (demand is Demand.ALIKE and place == 1)
            (at_head if end.inward else at_tail)[end.bond] = 1 - side if flow else side
        if node.controlled or index in switched:
            off[index] = [
                (node.ends[k].bond, imposing(node.ends[k].inward, variable))
                for k, variable, _ in fixed_ends(node, frozenset((index,)))
            ]
    near: list[list[tuple[int, int]]] = [[] for _ in range(nodes + bonds)]
    form = [BARE] * bonds
    optional = bytearray(nodes + bonds)
    for bond in range(bonds):
        a, b, extra = tail[bond], head[bond], nodes + bond
        to_a, to_b = at_tail[bond], at_head[bond]
        if to_a < 0 and to_b < 0:
            continue
        if to_a < 0 or to_b < 0:
            form[bond] = LEAF
            optional[extra] = 1
            inner = a if to_b < 0 else b
            near[inner].append((bond, extra))
            near[extra].append((bond, inner))
        elif to_a == to_b:
            form[bond] = EDGE
            near[a].append((bond, b))
            near[b].append((bond, a))
        else:
            form[bond] = MIDDLE
            near[a].append((bond, extra))
            near[b].append((bond, extra))
            # By index, not by arrow: the result must not depend on how arrows point.
            near[extra] += [(bond, min(a, b)), (bond, max(a, b))]
    stores = [(s.bond, imposing(s.sign > 0, "e" if s.kind == "C" else "f")) for s in graph.storages]
    wish = [-1] * bonds
    stored: dict[int, list[int]] = {}
    for index, (bond, stroke) in enumerate(stores):
        stored.setdefault(bond, []).append(index)
        if wish[bond] < 0:
            wish[bond] = stroke
    return Arrays(
        nodes=nodes,
        bonds=bonds,
        tail=tail,
        head=head,
        form=form,
        at_tail=at_tail,
        at_head=at_head,
        near=near,
        fixed=fixed,
        off=off,
        wish=wish,
        law=law,
        stores=stores,
        stored=stored,
        optional=optional,
        on=[
            [frozenset(n for n in state if n in off) for state in machine.on]
            for machine in graph.machines
        ],
    )
