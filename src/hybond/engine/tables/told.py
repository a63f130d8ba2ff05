"""Tables of what explains events: what the guards read, and which sources give energy at a jump."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

from hybond.engine.tables.contacts import rules_of
from hybond.model.expressions import Expr, posterior_names
from hybond.model.fieldless import reads_pre
from hybond.model.kinds import SOURCES

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables


def put_told(t: ModelTables, *, tells: bool) -> None:
    """Put the tables there; without `tells` those of explanations are empty.

    Which sources give is asked of every run: what a jump has stored is held against it.
    """
    t.numbers["tells"] = int(tells)
    rules = [f.rule for own in rules_of(t.graph) for f in own] if tells else []
    place: dict[Expr, int] = {}
    shown = []
    for rule in rules:
        for _, e in rule.reads:
            if e not in place:
                place[e] = len(t.pairs)
                t.pairs.append(e)
            shown.append(place[e])
    t.ints["told_first"] = [0, *accumulate(len(rule.reads) for rule in rules)]
    t.ints["told_pair"] = shown
    rows = range(len(t.ints["dynamic_node"]))
    t.ints["dynamic_pair"] = [_of_jumps(t, d, tells=tells) for d in rows]
    own, other, sign, follows = [], [], [], []
    bonds = len(t.graph.bonds)
    for node in t.graph.nodes:
        # what reads a priori values is an impact law, and no source; nor is friction, whose value
        # behind the jump is that of the branch that lasts, and not of the one that slid
        own_work = not node.implied and not reads_pre(node)
        if node.kind in ("Se", "Sf") and own_work and not node.domain.pseudo:
            end = node.ends[0]
            first = 0 if node.kind == "Se" else bonds
            own.append(first + end.bond)
            other.append(bonds - first + end.bond)
            sign.append(float(end.sign))
            laws = node.law.expressions if node.law is not None else ()
            read = {name for law in laws for name in posterior_names(law)}
            follows.append(int(any(name.startswith(("x:", "e:", "f:")) for name in read)))
    t.numbers["givers"] = len(own)
    t.ints.update(giver_own=own, giver_other=other, giver_follows=follows)
    t.floats["giver_sign"] = sign


def _of_jumps(t: ModelTables, d: int, *, tells: bool) -> int:
    """Return the pair of a dynamic row that has to say if it leaves out an impulse, or -1.

    That friction and resistors act with finite forces only is what they are known for.
    """
    node = t.graph.nodes[t.ints["dynamic_node"][d]]
    if not tells or node.kind not in SOURCES or node.implied or node.finite:
        return -1
    t.pairs.append(t.values.all[t.ints["dynamic_value"][d]])
    return len(t.pairs) - 1
