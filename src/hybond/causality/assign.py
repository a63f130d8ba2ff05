"""Causality of one mode: fixed, pinned, preferred, then free; each step propagated at once.

The sequential causality assignment procedure of Karnopp and Rosenberg, with OFF junctions among
the fixed ones as in HYBRSIM (P. J. Mosterman, SIMULATION 78(1), 2002).
"""

from __future__ import annotations

from collections.abc import Mapping

from hybond.causality.demands import fixed_ends, imposing
from hybond.causality.propagate import UNSET, Clash, Propagation
from hybond.causality.record import Causality, Conflict, Origin, Reason
from hybond.causality.search import Search
from hybond.model.graph import FlatGraph, Mode
from hybond.model.kinds import RESISTORS, TWO_PORTS, Variable


def assign(graph: FlatGraph, mode: Mode, *, pins: Mapping[int, int] | None = None) -> Causality:
    """Assign causality to all bonds of `graph` in `mode`.

    Parameters
    ----------
    graph : FlatGraph
        The flat graph.
    mode : tuple of int
        The state of each machine.
    pins : mapping, optional
        Bond index to `TAIL` or `HEAD`: strokes set after the fixed ones, before storage.

    Returns
    -------
    Causality
        Complete even if there are conflicts: it lists them, and keeps the first of two causes.

    Notes
    -----
    The ports of a field are taken one by one, as if each could have either causality.

    Examples
    --------
    Two capacitors in parallel: the second one follows the first.

    >>> import hybond as hb
    >>> m = hb.Model("two")
    >>> m.add(J=hb.Sf(1), c1=hb.C(1), c2=hb.C(2), node=hb.Zero())
    >>> m.bond("J -> node -> c1", "node -> c2")
    >>> graph = m.flatten()
    >>> causality = assign(graph, graph.start_mode)
    >>> [graph.storages[k].path for k in causality.derivative]
    ['c2.q']
    >>> graph.nodes[causality.stroke_at(1)].path, causality.chain(2)
    ('node', (1, 2))
    """
    off = graph.off_nodes(mode)
    state = Propagation(graph, off)
    clashes: list[Clash] = []
    for node in graph.nodes:
        for k, variable, rule in fixed_ends(node, off):
            end = node.ends[k]
            stroke = imposing(end.inward, variable)
            if state.strokes[end.bond] == UNSET:
                state.set(end.bond, stroke, node.index, rule)
            elif state.strokes[end.bond] != stroke:
                own = Origin(node.index, rule)
                clashes.append(Clash(node.index, end.bond, end.bond, "over", own))
    clashes += state.run(stop=False)
    for bond, stroke in sorted((pins or {}).items()):
        place = state.ends[bond][stroke]
        if state.strokes[bond] == UNSET:
            state.set(bond, stroke, place, "pin")
            clashes += state.run(stop=False)
        elif state.strokes[bond] != stroke:
            clashes.append(Clash(place, bond, bond, "over", Origin(place, "pin")))
    search = Search(graph, state)
    search.run()
    return _record(graph, state, search, clashes + search.clashes, off)


def _record(
    graph: FlatGraph,
    state: Propagation,
    search: Search,
    clashes: list[Clash],
    off: frozenset[int],
) -> Causality:
    strokes = tuple(state.strokes)
    reasons: dict[int, Reason] = {}
    for bond in state.trail:
        start, parent = state.starts[bond], state.parent[bond]
        if parent >= 0:
            reasons[bond] = Reason(reasons[parent].origin, parent, state.via[bond])
        else:
            assert start is not None
            reasons[bond] = Reason(start)
    for choice in search.choices:
        start = reasons[choice.bond].origin
        reasons[choice.bond] = Reason(start, refused=choice.refused, ruled_out=choice.ruled_out)
    resistors: dict[tuple[int, int], Variable] = {
        (node.index, end.port): "f" if strokes[end.bond] == int(end.inward) else "e"
        for node in graph.nodes
        if node.kind in RESISTORS
        for end in node.ends
    }
    return Causality(
        strokes=strokes,
        reasons=tuple(reasons[bond] for bond in range(len(strokes))),
        derivative=tuple(
            s.index
            for s in graph.storages
            if strokes[s.bond] != imposing(s.sign > 0, "e" if s.kind == "C" else "f")
        ),
        resistors=resistors,
        loops=tuple(
            c.bond for c in search.choices if c.rule in ("resistor", "free") and not c.refused
        ),
        conflicts=tuple(_conflict(graph, state, clash, off) for clash in clashes),
        ends=tuple(state.ends),
        gave_up=search.gave_up,
    )


def _conflict(graph: FlatGraph, state: Propagation, clash: Clash, off: frozenset[int]) -> Conflict:
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
    involved = {clash.node}
    for bond in state.culprits(clash):
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
