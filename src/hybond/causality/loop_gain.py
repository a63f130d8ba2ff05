"""How fast a resistor makes the storage around it, by the loops of causality through both.

What a resistor gives to its bond travels along the causal strokes, scaled by moduli, until a
storage integrates it; the answer of the storage comes back the same way, for a junction structure
conserves power. So the loop gain of a resistor and a storage is the square of the gain between
them, times the storage's stiffness (1/C or 1/I), times 1/R if the resistor gives the flow, or R
if it gives the effort (F. T. Brown, *Direct application of the loop rule to bond graphs*, J.
Dynamic Systems, Measurement and Control 94(3), 1972).
"""

from __future__ import annotations

from collections.abc import Mapping

from hybond.causality.record import HEAD
from hybond.model.graph import End, FlatGraph, Node
from hybond.model.kinds import STORAGES, TWO_PORTS, Variable


def loop_gain(
    graph: FlatGraph,
    strokes: tuple[int, ...],
    off: frozenset[int],
    bond: int,
    stiffness: Mapping[int, float],
) -> float | None:
    """Return the sum of gain² times stiffness over the storages that a resistor drives.

    Parameters
    ----------
    graph, strokes, off
        A graph, the strokes of a mode, and what is OFF in it.
    bond : int
        The bond of the resistor, which is at its head.
    stiffness : mapping
        Storage to 1/C or 1/I.

    Returns
    -------
    float or None
        The rate of the fastest loop is this times R or 1/R. None if it is not known as a number:
        a storage with a nonlinear law, a modulated two-port on the way.

    Examples
    --------
    A resistor between two capacitors of 2 and 3: their series is what it charges.

    >>> import hybond as hb
    >>> from hybond.causality.assign import assign
    >>> m = hb.Model("two")
    >>> m.add(j=hb.One(), a=hb.C(2), b=hb.C(3), r=hb.R(1))
    >>> m.bond("j -> a", "j -> b", "j -> r")
    >>> graph = m.flatten()
    >>> strokes = assign(graph, ()).strokes
    >>> round(loop_gain(graph, strokes, frozenset(), 2, {0: 1 / 2, 1: 1 / 3}), 6)
    0.833333
    """
    gives: Variable = "f" if strokes[bond] == HEAD else "e"
    gains: dict[int, float] = {}
    modulated: list[int] = []
    by_bond = {s.bond: s for s in graph.storages}

    def reach(node: Node, end: End, variable: Variable, gain: float, path: frozenset[int]) -> None:
        """Tell `node` that `variable` of its bond `end` has this gain."""
        if end.bond in path:
            return
        path = path | {end.bond}
        storage = by_bond.get(end.bond)
        if node.kind in STORAGES and storage is not None and storage.node == node.index:
            if variable == ("f" if node.kind == "C" else "e"):
                gains[storage.index] = gains.get(storage.index, 0.0) + gain
            return
        if node.kind in TWO_PORTS and (node.law is None or node.law.matrix is None):
            modulated.append(node.index)
        for other, passed, factor in _passed(node, end, variable, strokes, off):
            across = graph.bonds[other.bond]
            far = graph.nodes[across.tail if other.inward else across.head]
            far_end = next(
                e for e in far.ends if e.bond == other.bond and e.inward is not other.inward
            )
            reach(far, far_end, passed, gain * factor, path)

    start = graph.nodes[graph.bonds[bond].tail]
    reach(start, next(e for e in start.ends if e.bond == bond), gives, 1.0, frozenset())
    if modulated or any(gain != 0.0 and k not in stiffness for k, gain in gains.items()):
        return None
    return sum(gain**2 * stiffness[k] for k, gain in gains.items() if gain != 0.0)


def _passed(
    node: Node, end: End, variable: Variable, strokes: tuple[int, ...], off: frozenset[int]
) -> list[tuple[End, Variable, float]]:
    """Return to which ends a node passes a variable on, as what, and scaled by what."""
    if node.index in off:
        return []
    others = [e for e in node.ends if e.bond != end.bond or e.port != end.port]
    if node.is_junction:
        common: Variable = "e" if node.kind == "0" else "f"
        if variable == common:  # told to all
            return [(e, common, 1.0) for e in others]
        for e in others:  # joins the balance, which is told to the one that gives the common
            receives_effort = (strokes[e.bond] == HEAD) is e.inward
            if receives_effort is (common == "e"):
                return [(e, variable, -float(e.sign * end.sign))]
        return []
    if node.kind in TWO_PORTS and node.law is not None and node.law.matrix is not None:
        other = others[0]
        m = node.law.matrix[0][0]
        if m == 0.0:
            return []
        # Flows count as through the two-port: in at port 1, out at port 2.
        way = float(node.ends[0].sign * -node.ends[1].sign)
        first = end.port == 0
        if node.kind == "TF":
            if variable == "e":
                return [(other, "e", 1.0 / m if first else m)]
            return [(other, "f", way * (m if first else 1.0 / m))]
        sign = float(end.sign if first else -end.sign)
        back = float(-other.sign if first else other.sign)
        if variable == "f":
            return [(other, "e", m * sign)]
        return [(other, "f", back / m)]
    return []
