"""Hints at machines: states without a way in or out, junctions that switch nothing."""

from __future__ import annotations

from collections.abc import Iterator

from hybond.hints.never import never_holds
from hybond.hints.uses import texts_of, used_in
from hybond.model.arrays import base_of, is_array
from hybond.model.builder import Model
from hybond.model.checked import Hint
from hybond.model.expressions import names
from hybond.model.graph import FlatGraph, Machine


def machine_hints(model: Model, graph: FlatGraph) -> Iterator[Hint]:
    """Yield the hints at machines of the model itself."""
    texts = (text for text in texts_of(model) if ".state" in text)
    read = {name for text in texts for name in used_in(text)}
    arrays = {base_of(key) for key in model.machines if is_array(key)}
    for machine in graph.machines:
        base = base_of(machine.path)
        if machine.law is not None or (machine.path not in model.machines and base not in arrays):
            continue
        arrays.discard(base)  # one member speaks for all
        yield from _states(machine)
        yield from _switching(machine, graph, f"{base}.state" in read)
        yield from _rules(machine)


def _states(machine: Machine) -> Iterator[Hint]:
    if len(machine.states) < 2:
        return
    where = f"machines.{machine.path}"
    into = {r.target for r in machine.rules if r.source != r.target}
    out = {r.source for r in machine.rules if r.source != r.target}
    # where states only follow each other, as gears or breakages do, one of them is the last
    turning = _has_cycle(machine)
    for k, state in enumerate(machine.states):
        if k not in into and k != machine.start:
            yield Hint(
                "HB-H109",
                f"{where}.states.{state}",
                f"no rule leads to the state {state!r}, and the machine does not start there",
                "write a rule that leads there, or take the state out",
            )
        elif k not in out and turning and not _by_time(machine, k):
            yield Hint(
                "HB-H102",
                f"{where}.states.{state}",
                f"no rule leads out of the state {state!r}: the machine stays there",
                f'write one, "{state} -> {machine.states[0 if k else 1]} when ...", '
                "if it is not the end",
            )


def _rules(machine: Machine) -> Iterator[Hint]:
    for rule in machine.rules:
        if never_holds(rule.guard):
            source, target = (machine.states[k] for k in (rule.source, rule.target))
            yield Hint(
                "HB-H111",
                f"machines.{machine.path}",
                f"the guard of {source} -> {target}, {rule.said!r}, holds for no values of what it "
                "reads: the rule never fires",
                "look at its signs and at which side is larger; take the rule out if that is meant",
            )


def _has_cycle(machine: Machine) -> bool:
    """Whether rules lead from a state back to it."""
    left = {(r.source, r.target) for r in machine.rules if r.source != r.target}
    while left:
        sources = {a for a, _ in left}
        kept = {(a, b) for a, b in left if b in sources}
        if kept == left:
            return True
        left = kept
    return False


def _by_time(machine: Machine, state: int) -> bool:
    """Whether a state is entered at times only: a switch that is thrown once is meant so."""
    entering = [r for r in machine.rules if r.target == state]
    return bool(entering) and all(
        all(name == "time" or name.startswith("at:") for name in names(r.guard)) for r in entering
    )


def _switching(machine: Machine, graph: FlatGraph, read: bool) -> Iterator[Hint]:
    where = f"machines.{machine.path}"
    switched = sorted(frozenset().union(*machine.on))
    bare = [graph.nodes[k].path for k in switched if not graph.nodes[k].ends]
    if bare:
        yield Hint(
            "HB-H107",
            where,
            f"the machine {machine.path!r} switches {', '.join(bare)}, which no bond connects",
            "connect it, or let the machine switch another junction",
        )
    held = frozenset(machine.on[0]).intersection(*machine.on)
    if held == frozenset(switched) and not read and not _asked_for(machine, graph):
        yield Hint(
            "HB-H107",
            where,
            f"the machine {machine.path!r} switches nothing, and nobody reads its state",
            "list in states the junctions that each switches ON",
        )


def _asked_for(machine: Machine, graph: FlatGraph) -> bool:
    """Whether a guard or a law asks for the state of a machine."""
    named = f"in:{machine.index}:"
    if any(named in name for m in graph.machines for r in m.rules for name in names(r.guard)):
        return True
    laws = (n.law.expressions for n in graph.nodes if n.law is not None)
    return any(n.startswith(named) for es in laws for e in es for n in names(e))
