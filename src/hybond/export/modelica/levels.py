"""Machines as equations of levels: which of the transitions that hold counts."""

from __future__ import annotations

from collections.abc import Iterator

from hybond.export.modelica.rules import Transition
from hybond.export.modelica.variables import Variables
from hybond.model.expressions import Bool, Expr, names, simplify


def machine_equations(variables: Variables) -> Iterator[str]:
    """Yield one equation per machine: levels, of which the first in the list counts."""
    draft = variables.draft
    turning: list[str] = []
    for machine in draft.graph.machines:
        name, rules = draft.machine(machine.index), draft.rules[machine.index]
        if not rules:
            yield f"{name} = pre({name});"
            continue
        fires = [(_fires(variables, t), t) for t in rules]
        parts = []
        if machine.law is not None:
            turns = draft.ids.of(f"turns:{machine.index}", f"{machine.path}_turns")
            either = " or ".join(f"({condition})" for condition, _ in fires)
            earlier = f" and not ({' or '.join(turning)})" if turning else ""
            draft.declared.append(f"Boolean {turns};")
            yield f"{turns} = pre({draft.calm}) >= 1{earlier} and ({either});"
            turning.append(turns)
            parts.append(f"if not {turns} then pre({name})")
        elif draft.careful:
            parts.append(f"if pre({draft.calm}) < {draft.quiet} then pre({name})")
        for condition, t in fires:
            parts.append(f"if {condition} then {t.target + 1}")
        yield f"{name} = {' else'.join(parts)} else pre({name});"


def _fires(variables: Variables, t: Transition) -> str:
    """Return the condition that a transition takes place."""
    state = variables.state(t.machine, t.source)
    if simplify(t.guard) == Bool(True):
        return state
    law = variables.graph.machines[t.machine].law

    def slack(e: Expr) -> str:
        """Return what a value of a law must pass to be told from zero."""
        read = sorted(n for n in names(e) if n.startswith(("e:", "f:")))
        if not read:
            return ""
        return f"{variables.draft.slack}*({' + '.join(map(variables.size, read))})"

    return f"{state} and ({variables.pairs.condition(t.guard, None if law is None else slack)})"
