"""What makes a machine change its state: its rules, or those of the law that it stands for."""

from __future__ import annotations

from dataclasses import dataclass

from hybond.errors import ModelError
from hybond.export.modelica.live import Live
from hybond.model.expressions import And, Compare, Expr, Number, Pre
from hybond.model.graph import FlatGraph, Machine


@dataclass(frozen=True, slots=True)
class Transition:
    """A machine goes from one state to another when a guard holds."""

    machine: int
    source: int
    target: int
    guard: Expr


def transitions(graph: FlatGraph, machine: Machine, live: Live) -> list[Transition]:
    """Return the transitions of a machine, in the order in which they count."""
    prefix = machine.path.rpartition(".")[0]
    found = [
        Transition(machine.index, r.source, r.target, live.expression(r.text, prefix, r.guard))
        for r in machine.rules
    ]
    law = machine.law
    if law is None or "impact" not in machine.states:
        return found
    open_, impact = machine.states.index("open"), machine.states.index("impact")
    closed = machine.states.index("closed")
    if not isinstance(law.restitution, Number):
        raise ModelError(
            "a restitution that is no constant",
            code="HB-E680",
            where=graph.nodes[law.node].path,
            hint="give it as a parameter",
        )
    if law.restitution.value == 0.0:
        return found  # an impact that leaves nothing is a closed contact
    approach = next(t for t in found if t.source == open_ and t.target == closed)
    # contacts that approached before: an impact next door is not felt before it is written
    faster = Compare(">", Pre(law.net), Number(0.0))
    near = [Compare("<=", law.gap, Number(0.0))] if law.gap is not None else []
    struck = Transition(machine.index, open_, impact, And((*near, faster)) if near else faster)
    # the impact has been written once the contact parts
    parts = Compare("<=", Pre(law.net), Number(0.0))
    left = Transition(machine.index, impact, open_, parts)
    others = [t for t in found if t is not approach]
    return [struck, left, *others]
