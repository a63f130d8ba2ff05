"""Tables of machines that follow others: the columns `follower*` of `hybond.engine.model.Model`."""

from __future__ import annotations

from hybond.engine.tables.columns import ModelTables, first_of
from hybond.engine.tables.machines import is_by_hand
from hybond.model.expressions import names, prior_names
from hybond.model.graph import FlatGraph, Machine

STATE = "in:"
"""What the name of a state of a machine begins with; its number and that of the state follow."""
KNOWN = (STATE, "u:", "at:", "time")
"""What the names that they read begin with: nothing that a mode would have to be solved for."""


def put_followers(t: ModelTables) -> None:
    """Put the machines that follow others, where some of those have a switching surface."""
    found = followers_of(t.graph) if t.numbers["surfaces"] else {}
    t.numbers["followers"] = len(found)
    t.ints["follower"] = list(found)
    t.ints["follower_first"] = first_of([list(read) for read in found.values()])
    t.ints["follower_reads"] = [k for read in found.values() for k in read]


def followers_of(g: FlatGraph) -> dict[int, list[int]]:
    """Return the machines of two states that follow others, and which.

    Those read are followed as well. What feeds itself, as gates that make a latch, is none.
    """
    reads = {m.index: _read(m) for m in g.machines if _may_follow(m)}
    followed: dict[int, list[int]] = {}
    for k in reads:
        seen: set[int] = set()
        todo = list(reads[k])
        while todo:
            other = todo.pop()
            if other not in seen:
                seen.add(other)
                todo += reads.get(other, ())
        if seen and k not in seen:
            followed[k] = sorted(seen)
    return followed


def _may_follow(m: Machine) -> bool:
    """Whether a machine has two states, and rules that read nothing that has to be solved for."""
    return (
        is_by_hand(m)
        and len(m.states) == 2
        and all(
            not prior_names(r.guard) and all(n.startswith(KNOWN) for n in names(r.guard))
            for r in m.rules
        )
    )


def _read(m: Machine) -> list[int]:
    """Return the machines whose states the rules of a machine read."""
    read = {n for r in m.rules for n in names(r.guard) if n.startswith(STATE)}
    return sorted({int(n.split(":")[1]) for n in read})
