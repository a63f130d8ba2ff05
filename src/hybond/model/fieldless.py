"""Fieldless states: states that make a law active which reads ``pre()``.

Such a law (Newton's restitution) holds at an instant and describes no motion, so its state is a
pinnacle and must be left by what the write made true. Source: Mosterman & Biswas 2002, section 4
(time-scale abstraction).
"""

from __future__ import annotations

from dataclasses import replace

from hybond.errors import ModelError
from hybond.model.expressions import Expr, Name, names, posterior_names, uses_pre
from hybond.model.graph import FlatGraph, Machine, Node
from hybond.model.resolve import prior


def reads_pre(node: Node) -> bool:
    """Whether the node's law reads a priori values."""
    return node.law is not None and any(uses_pre(e) for e in node.law.expressions)


def switches_of(graph: FlatGraph, node: Node) -> list[Node]:
    """Return the controlled nodes that must be ON for `node`'s law to act."""
    found = [node] if node.controlled else []
    for end in node.ends:
        bond = graph.bonds[end.bond]
        other = graph.nodes[bond.head if bond.tail == node.index else bond.tail]
        if other.controlled:
            found.append(other)
    return found


def _reads_in(node: Node, machine: Machine, state: int) -> bool:
    """Whether the law still reads ``pre()`` when `machine` is in this state.

    A source that the law of a junction brought in does so in the state ``impact`` only.
    """
    if machine.law is None or machine.law.source != node.index:
        return not node.implied
    return machine.states[state] == "impact"


def checked(graph: FlatGraph) -> FlatGraph:
    """Return the graph with each machine's fieldless states marked.

    Raises
    ------
    ModelError
        HB-M170 a law that reads ``pre()`` in every mode, or of an element that may not;
        HB-M171 an exit from a fieldless state that reads a posteriori values; HB-M172 a
        fieldless state without exit; HB-M207 a restitution that reads what the impact changes.
    """
    for machine in graph.machines:
        _check_restitution(graph, machine)
    laws = [n for n in graph.nodes if reads_pre(n)]
    for node in laws:
        where = f"elements.{node.path}"
        if node.kind not in ("Se", "Sf"):
            raise ModelError(
                f"the law of {node.kind} {node.path!r} reads pre(); only a source may",
                code="HB-M170",
                where=where,
                hint="impact laws are sources on a controlled junction",
            )
        if not switches_of(graph, node):
            raise ModelError(
                f"{node.kind} {node.path!r} reads pre() in every mode, so no mode has a field",
                code="HB-M170",
                where=where,
                hint="attach it to a controlled junction",
            )
    machines = []
    for machine in graph.machines:
        flags = tuple(_is_fieldless(graph, machine, k, laws) for k in range(len(machine.states)))
        for k, flag in enumerate(flags):
            if flag and machine.law is None:
                _check_exits(graph, machine, k)
        machines.append(replace(machine, fieldless=flags))
    return replace(graph, machines=tuple(machines))


def _is_fieldless(graph: FlatGraph, machine: Machine, state: int, laws: list[Node]) -> bool:
    for node in laws:
        switches = [s.index for s in switches_of(graph, node)]
        mine = [s for s in switches if s in machine.controls]
        if not _reads_in(node, machine, state):
            continue
        if mine and all(s in machine.on[state] for s in mine):
            return True
    return False


def _check_exits(graph: FlatGraph, machine: Machine, state: int) -> None:
    where = f"machines.{machine.path}.states.{machine.states[state]}"
    exits = [r for r in machine.rules if r.source == state]
    if not exits:
        raise ModelError(
            f"the state {machine.states[state]!r} is fieldless (an active law reads pre()) and has "
            "no exit",
            code="HB-M172",
            where=where,
            hint="add a rule that leaves it once the jump is written",
        )
    for rule in exits:
        later = {n for n in posterior_names(rule.guard) if not n.startswith(("at:", "in:"))}
        early, hint = "", ""
        if later:
            early, hint = "reads a posteriori values", "wrap what it reads in pre(...)"
        elif not uses_pre(rule.guard):
            early = "waits for nothing"
            hint = "ask whether the state was there when something was written last: "
            hint += f'pre({machine.path}.state == "{machine.states[state]}")'
        if early:
            raise ModelError(
                f"the exit {rule.said!r} of a fieldless state {early}, so the state would be left "
                "before its jump is written",
                code="HB-M171",
                where=where,
                hint=hint,
            )
        for argument in prior(rule.guard):
            for name in sorted(names(argument)):
                if not _is_stored(graph, name):
                    raise ModelError(
                        f"the exit {rule.said!r} reads {describe(graph, Name(name))} in a "
                        "fieldless state, where it has no value",
                        code="HB-M171",
                        where=where,
                        hint="read stored quantities, their co-energy variables or integrals",
                    )


def _check_restitution(graph: FlatGraph, machine: Machine) -> None:
    """Refuse a restitution that the impact itself would change: it is decided before."""
    eps = None if machine.law is None else machine.law.restitution
    if eps is None:
        return
    for name in sorted(posterior_names(eps)):
        if _is_jumping(graph, name):
            said = describe(graph, Name(name))
            raise ModelError(
                f"the restitution of {machine.path!r} reads {said}, which the impact changes",
                code="HB-M207",
                where=f"elements.{machine.path}.restitution",
                hint=f"pre({said}) is what it was before the impact",
            )


def _is_jumping(graph: FlatGraph, name: str) -> bool:
    """Whether an impact changes a variable: momentum, a flow, an effort that no C decides."""
    kind, _, index = name.partition(":")
    if kind == "x":
        return graph.storages[int(index)].kind == "I"
    return kind == "f" or (kind == "e" and not _is_stored(graph, name))


def _is_stored(graph: FlatGraph, name: str) -> bool:
    """Whether a canonical name is fixed by the stored state alone."""
    kind, _, index = name.partition(":")
    if kind not in ("e", "f"):
        return True
    bond = graph.bonds[int(index)]
    for at in (bond.tail, bond.head):
        node = graph.nodes[at]
        if node.about.energy and node.about.imposes == kind:
            return True
        common = {"0": "e", "1": "f"}.get(node.kind)
        if common == kind and not node.controlled:
            ends = [graph.bonds[end.bond] for end in node.ends]
            around = [graph.nodes[m] for b in ends for m in (b.tail, b.head)]
            if any(n.about.energy and n.about.imposes == kind for n in around):
                return True
    return False


def describe(graph: FlatGraph, e: Expr) -> str:
    """Return an expression with bond variables written as bonds are."""
    from hybond.model.expressions import substitute, to_text

    written = {}
    for name in names(e):
        kind, _, index = name.partition(":")
        if kind in ("e", "f"):
            written[name] = Name(f'"{graph.bonds[int(index)].name}".{kind}')
        elif kind == "x":
            written[name] = Name(graph.storages[int(index)].path)
        elif kind == "s":
            written[name] = Name(graph.integrals[int(index)].path)
        elif kind == "u":
            written[name] = Name(graph.inputs[int(index)].path)
    return to_text(substitute(e, written))
