"""Laws that do not hold, as the engine found them, in words."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.engine.tables.contacts import rules_of
from hybond.errors import NumericsError
from hybond.model.graph import FlatGraph, Node
from hybond.runs.trace import CREATES, GOES_ON, ONE_SOLUTION, UNBALANCED, Violation

ELEMENT, STORAGE, JUNCTION, UNTOUCHED, UNFIRED, APART, IMPACT = range(7)
MANY, BALANCE, RATE, CREATED, ENDS, PULLS = range(7, 13)
"""What does not hold: as in `hybond.engine.reasons.noting`."""
SUMS = {
    "0": "one effort, and flows that add up to zero",
    "1": "one flow, and efforts that add up to zero",
}
KEPT = "what no constraint of a jump reaches keeps what it stores"
FIRES = "the guard holds, and fires:"
ONE_INSTANT = "what begins to hold within one instant fires in it:"
MOVES = "what is stored moves by the rate that is shown"
IMPACTS = "the law of impacts that was asked for"
MEANS = "what it carries on the mean of fast switching"
LOOP = (
    "give the loop what it has been idealised of: a small C or I where it feeds back, or a machine "
    "of two states for a comparator"
)
CLOSER = (
    "compare with solver = 'radau' and with a tenth of rtol; give what moves far faster than "
    "anything that is asked for the C or I that it has, or leave it out; and report the model"
)
REPORT = "compare with solver = 'moreau-jean', and report the model: no model should do this"


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
        return machine.path, f"{FIRES if what == UNFIRED else ONE_INSTANT} {forced.rule.said}"
    if what in (ELEMENT, MANY, ENDS):
        node = graph.nodes[elements[index]]
    elif what in (STORAGE, UNTOUCHED, BALANCE, RATE, CREATED):
        node = graph.nodes[graph.storages[index].node]
    elif what == JUNCTION:
        node = [n for n in graph.nodes if n.is_junction][index]
    else:
        ports = [law.node for m in graph.machines if m.law is not None for law in m.law.junctions]
        node = graph.nodes[ports[index]]
    if what in (MANY, ENDS):
        return node.path, ONE_SOLUTION if what == MANY else GOES_ON
    if what in (BALANCE, CREATED):
        return node.path, UNBALANCED if what == BALANCE else CREATES
    if what == RATE:
        return node.path, MOVES
    own = {UNTOUCHED: KEPT, IMPACT: IMPACTS, PULLS: MEANS}.get(what) or _law(node)
    return node.path, own


def _law(node: Node) -> str:
    if node.is_junction:
        return SUMS[node.kind]
    return " ".join(t for t in (node.kind, node.label) if t)


def unsound_refusal(found: Sequence[Violation], t_end: float) -> NumericsError:
    """Return what a run says in which laws do not hold."""
    first = found[0]
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    many = first.law in (ONE_SOLUTION, GOES_ON)
    return NumericsError(
        f"{first}{more}; the run went on to t = {t_end:.9g} s, and its values are wrong from there "
        "on",
        code="HB-N411",
        where=first.place,
        hint=LOOP if many else CLOSER if first.law == UNBALANCED else REPORT,
    )
