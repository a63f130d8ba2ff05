"""What events and decisions did to machines, as transitions to and from ``sliding``."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.equations.surfaces import Surface
from hybond.model.graph import FlatGraph, Mode
from hybond.trace import Event, Fired


def transitions(
    graph: FlatGraph,
    before: Mode,
    mode: Mode,
    held: Sequence[Surface],
    slid: Sequence[Surface],
) -> tuple[Fired, ...]:
    """Return what the decision did to machines, as transitions to and from ``sliding``."""
    found = []
    for s in (*held, *(s for s in slid if s not in held)):
        machine = graph.machines[s.machine]
        if s in held and s in slid:
            continue
        if s in slid:
            why = f"{s.text}: pushed into from both sides"
            found.append(
                Fired(machine.path, machine.states[before[s.machine]], "sliding", why, {}, {})
            )
        elif mode[s.machine] in (s.below, s.above):
            why = f"{s.text}: no longer pushed into from both sides"
            found.append(
                Fired(machine.path, "sliding", machine.states[mode[s.machine]], why, {}, {})
            )
    changed = {s.machine for s in (*held, *slid)}
    for m, a, b in zip(graph.machines, before, mode, strict=True):
        if a != b and m.index not in changed:
            several = bool(held or slid)
            why = "the other surfaces push it back" if several else "its jump throws it back"
            why = "complementarity" if m.law is not None else why
            found.append(Fired(m.path, m.states[a], m.states[b], why, {}, {}))
    return tuple(found)


def moved(event: Event | None) -> bool:
    """Whether what is stored jumped."""
    return event is not None and any(s.impulses for s in event.steps if s.kind != "mythical")


def fired_machines(graph: FlatGraph, event: Event | None) -> dict[int, tuple[int, int]]:
    """Return source and target of the machines that made exactly one transition."""
    if event is None:
        return {}
    by_path = {m.path: m for m in graph.machines}
    found = {}
    for path, (first, *rest) in _by_machine(event).items():
        if not rest and path in by_path:
            machine = by_path[path]
            found[machine.index] = (
                machine.states.index(first.source),
                machine.states.index(first.target),
            )
    return found


def there_and_back(graph: FlatGraph, event: Event) -> set[int]:
    """Return the machines that made a transition and its reverse at one instant."""
    turned = {
        path
        for path, (first, *rest) in _by_machine(event).items()
        if [(f.target, f.source) for f in rest] == [(first.source, first.target)]
    }
    return {m.index for m in graph.machines if m.path in turned}


def _by_machine(event: Event) -> dict[str, list[Fired]]:
    """Return the transitions that each machine made at one instant, in their order, by path."""
    made: dict[str, list[Fired]] = {}
    for step in event.steps:
        for f in step.fired:
            made.setdefault(f.machine, []).append(f)
    return made
