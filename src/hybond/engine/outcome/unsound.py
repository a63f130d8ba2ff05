"""Laws that do not hold, as the engine found them, in words."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.errors import NumericsError
from hybond.model.graph import FlatGraph, Node
from hybond.trace import Violation

ELEMENT, STORAGE = 0, 1
"""What a law belongs to: as in `hybond.engine.checks.laws_held`."""
SUMS = {
    "0": "one effort, and flows that add up to zero",
    "1": "one flow, and efforts that add up to zero",
}


def violation(
    graph: FlatGraph, elements: Sequence[int], t: float, about: Sequence[float]
) -> Violation:
    """Return a row of the engine as a record; `elements` are the nodes of the engine's elements."""
    what, index = int(about[0]), int(about[1])
    if what == ELEMENT:
        node = graph.nodes[elements[index]]
    elif what == STORAGE:
        node = graph.nodes[graph.storages[index].node]
    else:
        node = [n for n in graph.nodes if n.is_junction][index]
    mode = graph.mode_text(tuple(map(int, about[4 : 4 + len(graph.machines)])))
    return Violation(t, node.path, about[2], about[3], _law(node), mode)


def _law(node: Node) -> str:
    if node.is_junction:
        return SUMS[node.kind]
    return " ".join(t for t in (node.kind, node.label) if t)


def unsound_refusal(found: Sequence[Violation], t_end: float) -> NumericsError:
    """Return what a run says in which laws do not hold."""
    first = found[0]
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    return NumericsError(
        f"{first}{more}; the run went on to t = {t_end:.9g} s, and its values are wrong from there "
        "on",
        code="HB-N411",
        where=first.place,
        hint="compare with solver = 'moreau-jean', and report the model: no model should do this",
    )
