"""Friction of several junctions that one velocity has: it breaks loose where all have given all.

Two brakes on one shaft share what they hold at rest in any way, and a rigid shaft does not say how.
What they hold together it does say: they rest as long as some shares keep each within its
breakaway, and then all of them slide. So each one's rule looks at what all take, measured at the
shaft, against the sum of their breakaways.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybond.model.expressions import Binary, Compare, Expr, Neg, Number, simplify
from hybond.model.graph import Bond, Machine, Node, Rule
from hybond.model.laws import JunctionLaw


def held_together(
    machines: tuple[Machine, ...], nodes: Sequence[Node], bonds: Sequence[Bond]
) -> tuple[Machine, ...]:
    """Return the machines, those of friction on one velocity with rules of what all hold.

    Junctions are on one velocity that are bonded to one ordinary 1-junction, to some that are
    bonded to each other, or through a transformer with a constant modulus.
    """
    groups: dict[int, list[tuple[float, Machine]]] = {}
    for machine in machines:
        law = machine.law
        if law is None or law.kind != "coulomb" or law.second is not None or law.planar:
            continue
        found = _shaft(nodes[law.node], law, nodes, bonds)
        if found is not None:
            groups.setdefault(found[0], []).append((found[1], machine))
    changed = {
        machine.index: _together(machine, ratio, group)
        for group in groups.values()
        if len(group) > 1 and any(m.law and m.law.breakaway is not None for _, m in group)
        for ratio, machine in group
    }
    return tuple(changed.get(m.index, m) for m in machines)


def _shaft(
    node: Node, law: JunctionLaw, nodes: Sequence[Node], bonds: Sequence[Bond]
) -> tuple[int, float] | None:
    """Return the 1-junction that a friction junction turns with, and its velocity over its own."""
    if node.kind != "1":
        return None
    own = nodes[law.source].ends[0].bond if law.source is not None else -1
    outer = [end.bond for end in node.ends if end.bond != own]
    if len(outer) != 1:
        return None
    at = _beyond(bonds[outer[0]], node.index)
    ratio = 1.0
    if nodes[at].kind == "TF" and not nodes[at].controlled:
        two_port = nodes[at]
        gear = two_port.law
        if gear is None or gear.matrix is None or gear.matrix[0][0] == 0.0:
            return None
        one, two = two_port.ends
        modulus = gear.matrix[0][0] * one.sign * -two.sign
        mine = one if one.bond == outer[0] else two
        other = two if mine is one else one
        ratio = modulus if mine is two else 1.0 / modulus
        at = _beyond(bonds[other.bond], two_port.index)
    if nodes[at].kind != "1" or nodes[at].controlled:
        return None
    return _first(at, nodes, bonds), ratio


def _beyond(bond: Bond, node: int) -> int:
    return bond.head if bond.tail == node else bond.tail


def _first(at: int, nodes: Sequence[Node], bonds: Sequence[Bond]) -> int:
    """Return the first of the ordinary 1-junctions that are bonded to each other."""
    met = {at}
    waiting = [at]
    while waiting:
        node = nodes[waiting.pop()]
        for end in node.ends:
            other = nodes[_beyond(bonds[end.bond], node.index)]
            if other.kind == "1" and not other.controlled and other.index not in met:
                met.add(other.index)
                waiting.append(other.index)
    return min(met)


def _together(machine: Machine, ratio: float, group: list[tuple[float, Machine]]) -> Machine:
    """Return the machine of one of a group, breaking loose where all do."""
    force: Expr = Number(0.0)
    most: Expr = Number(0.0)
    texts, limits = [], []
    reads = []
    for own, other in group:
        law = other.law
        assert law is not None and law.limit is not None
        rest = law.breakaway if law.breakaway is not None else law.limit
        force = Binary("+", force, Binary("*", Number(own), law.net))
        most = Binary("+", most, Binary("*", Number(abs(own)), rest))
        name = f"{other.path}.e"
        texts.append(name if own == 1.0 else f"{own:.9g}*{name}")
        limits.append(str(rest) if abs(own) == 1.0 else f"{abs(own):.9g}*{rest}")
        reads.append((name, law.net))
    force, most = simplify(force), simplify(most)
    rules = []
    for rule in machine.rules:
        if rule.source != 0:
            rules.append(rule)
            continue
        # forward is 1, backward 2, as this junction counts them
        ahead = (rule.target == 1) == (ratio > 0.0)
        said = " + ".join(texts)
        text = f"{said if ahead else f'-({said})'} > {' + '.join(limits)}"
        guard = Compare(">", force if ahead else Neg(force), most)
        rules.append(replace(rule, guard=guard, text=text, reads=tuple(reads)))
    return replace(machine, rules=tuple[Rule, ...](rules))
