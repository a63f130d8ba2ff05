"""Laws that do not hold, as the engine found them, in words."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.engine.tables.contacts import rules_of
from hybond.errors import NumericsError
from hybond.model.graph import FlatGraph, Node
from hybond.runs.trace import ONE_SOLUTION, Violation

ELEMENT, STORAGE, JUNCTION, UNTOUCHED, UNFIRED, APART, IMPACT, MANY = range(8)
"""What does not hold: as in `hybond.engine.checks.noting`."""
SUMS = {
    "0": "one effort, and flows that add up to zero",
    "1": "one flow, and efforts that add up to zero",
}
KEPT = "what no constraint of a jump reaches keeps what it stores"
FIRES = "the guard holds, and fires:"
ONE_INSTANT = "what begins to hold within one instant fires in it:"
IMPACTS = "the law of impacts that was asked for"


def violation(
    graph: FlatGraph, elements: Sequence[int], t: float, about: Sequence[float]
) -> Violation:
    """Return a row of the engine as a record; `elements` are the nodes of the engine's elements."""
    what, index = int(about[0]), int(about[1])
    mode = graph.mode_text(tuple(map(int, about[4 : 4 + len(graph.machines)])))
    place, law = _said(graph, elements, what, index)
    return Violation(t, place, about[2], about[3], law, mode)


def _said(graph: FlatGraph, elements: Sequence[int], what: int, index: int) -> tuple[str, str]:
    """Return a place and what should hold there."""
    if what in (UNFIRED, APART):
        ruled = [
            (m, f) for m, own in zip(graph.machines, rules_of(graph), strict=True) for f in own
        ]
        machine, forced = ruled[index]
        return machine.path, f"{FIRES if what == UNFIRED else ONE_INSTANT} {forced.rule.text}"
    if what in (ELEMENT, MANY):
        node = graph.nodes[elements[index]]
    elif what in (STORAGE, UNTOUCHED):
        node = graph.nodes[graph.storages[index].node]
    elif what == JUNCTION:
        node = [n for n in graph.nodes if n.is_junction][index]
    else:
        ports = [law.node for m in graph.machines if m.law is not None for law in m.law.junctions]
        node = graph.nodes[ports[index]]
    if what == MANY:
        return node.path, ONE_SOLUTION
    own = KEPT if what == UNTOUCHED else IMPACTS if what == IMPACT else _law(node)
    return node.path, own


def _law(node: Node) -> str:
    if node.is_junction:
        return SUMS[node.kind]
    return " ".join(t for t in (node.kind, node.label) if t)


def unsound_refusal(found: Sequence[Violation], t_end: float) -> NumericsError:
    """Return what a run says in which laws do not hold."""
    first = found[0]
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    many = first.law == ONE_SOLUTION
    return NumericsError(
        f"{first}{more}; the run went on to t = {t_end:.9g} s, and its values are wrong from there "
        "on",
        code="HB-N411",
        where=first.place,
        hint="give the loop what it has been idealised of: a small C or I where it feeds back, or "
        "a machine of two states for a comparator"
        if many
        else "compare with solver = 'moreau-jean', and report the model: no model should do this",
    )
