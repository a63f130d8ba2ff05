"""Tables of machines that follow others: the columns `follower*` of `hybond.engine.model.Model`."""

from __future__ import annotations

from hybond.engine.surfaces.reads import BY_BONDS, BY_STATES, BY_STORED
from hybond.engine.tables.columns import ModelTables, first_of
from hybond.engine.tables.machines import is_by_hand, owners_of
from hybond.model.expressions import names, prior_names
from hybond.model.graph import FlatGraph, Machine

STATE = "in:"
"""What the name of a state of a machine begins with; its number and that of the state follow."""
SWITCHED = "on:"
"""What that of something controlled begins with, which is ON or not; its element follows."""
KNOWN = (STATE, SWITCHED, "u:", "at:", "time")
"""What the names begin with of what is known without the state of the model."""
STORED = ("x:", "s:")
"""What those begin with of what is known of a state without a solution in its mode."""


def put_followers(t: ModelTables) -> None:
    """Put the machines that follow others with a switching surface."""
    machines = t.graph.machines
    found = followers_of(t.graph, set(t.ints["surface_machine"]))
    place = {k: j for j, k in enumerate(found)}
    readers: list[list[int]] = [[] for _ in machines] if found else []
    for k, read in found.items():
        for other in read:
            readers[other].append(place[k])
    t.numbers["followers"] = len(found)
    t.numbers["prior_followers"] = sum(
        any(prior_names(r.guard) for r in machines[k].rules) for k in found
    )
    t.ints["follower"] = list(found)
    t.ints["follower_asks"] = [_asks(machines[k]) for k in found]
    t.ints["machine_follows"] = [int(k in place) for k in range(len(machines))] if found else []
    sways = swaying(t.graph, set(t.ints["surface_machine"]))
    t.ints["swaying"] = sorted(sways & set(found))
    t.numbers["swayers"] = len(t.ints["swaying"])
    t.ints["reader_first"] = first_of(readers)
    t.ints["reader"] = [j for row in readers for j in row]


def followers_of(g: FlatGraph, switching: set[int]) -> dict[int, list[int]]:
    """Return the machines that follow some of those given, and those that each of them reads.

    What follows a follower is one as well, and so is what feeds itself, as gates that make a latch,
    and what reads bond variables, which may be others in another mode.
    """
    owners = owners_of(g)
    held = _held_by_storage(g)
    reads = {m.index: _read(m, owners) for m in g.machines if switching and _may_follow(m)}
    readers: dict[int, list[int]] = {}
    for k, read in reads.items():
        for other in read:
            readers.setdefault(other, []).append(k)
    led = {k for k in reads if any(n not in held for n in _read_of_bonds(g.machines[k]))}
    sways = swaying(g, switching)
    todo = [*switching, *led]
    while todo:
        other = todo.pop()
        for k in readers.get(other, ()):
            # the level that is moved by what follows is one level for all modes, or none
            if k not in led and not (other in sways and k in switching):
                led.add(k)
                todo.append(k)
    return {k: reads[k] for k in sorted(led)}


def swaying(g: FlatGraph, switching: set[int]) -> set[int]:
    """Return machines that make surfaces jump, and follow machines that may slide.

    Where these slide, no mode of the combination says on which side of such a surface it is.
    """
    owners = owners_of(g)
    read = {other for k in switching for other in _read(g.machines[k], owners)}
    return {k for k in read if _is_led(g, k, switching, owners)}


def _is_led(g: FlatGraph, machine: int, switching: set[int], owners: dict[int, Machine]) -> bool:
    """Whether a machine reads one with a surface, itself or by others that it reads."""
    seen: set[int] = set()
    todo = [machine]
    while todo:
        new = set(_read(g.machines[todo.pop()], owners)) - seen
        seen |= new
        todo += new
    return bool(seen & switching)


def _may_follow(m: Machine) -> bool:
    """Whether what the rules of a machine ask for is that of one mode, or a state before it."""
    return is_by_hand(m) and all(
        n.startswith((STATE, SWITCHED)) for r in m.rules for n in prior_names(r.guard)
    )


def _read(m: Machine, owners: dict[int, Machine]) -> list[int]:
    """Return the machines whose states, or what these switch, the rules of a machine read."""
    found = set()
    for name in {n for r in m.rules for n in names(r.guard)}:
        kind, _, rest = name.partition(":")
        if kind + ":" == STATE:
            found.add(int(rest.split(":")[0]))
        elif kind + ":" == SWITCHED and int(rest) in owners:
            found.add(owners[int(rest)].index)
    return sorted(found)


def _read_of_bonds(m: Machine) -> set[str]:
    """Return the bond variables that the rules of a machine read."""
    return {n for r in m.rules for n in names(r.guard) if n.startswith(("e:", "f:"))}


def _held_by_storage(g: FlatGraph) -> set[str]:
    """Return the bond variables that are a storage's in every mode: no switch makes them jump."""
    found = set()
    for storage in g.storages:
        effort = storage.kind == "C"
        todo = [storage.bond]
        while todo:
            b = todo.pop()
            name = f"{'e' if effort else 'f'}:{b}"
            if name in found:
                continue
            found.add(name)
            for end in (g.bonds[b].tail, g.bonds[b].head):
                node = g.nodes[end]
                if node.kind == ("0" if effort else "1") and not node.controlled:
                    todo += [e.bond for e in node.ends]
    return found


def _asks(m: Machine) -> int:
    """Return what the guards of a machine read."""
    read = {n for r in m.rules for n in names(r.guard) if not n.startswith(KNOWN)}
    if not read:
        return BY_STATES
    return BY_STORED if all(n.startswith(STORED) for n in read) else BY_BONDS
