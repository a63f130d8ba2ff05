"""Modes ahead that have no causality, and the few switches that make each of them so.

Of many switches only a few have a part in a conflict. They are found by leaving out: a switch is
let go (its junction then demands nothing), and if a conflict is still there, it is one whatever
that switch does. What cannot be let go is a smallest set of settings with a conflict, so the
2^n modes of n switches that have no part in it are one finding.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from hybond.causality.assign import assign, assign_off
from hybond.causality.explain import describe_conflict
from hybond.causality.reachable import LIMIT, Reachable, reachable
from hybond.causality.record import Causality, Conflict
from hybond.causality.strokes import Strokes
from hybond.model.graph import FlatGraph, Mode
from hybond.records import dataclass


@dataclass(frozen=True, slots=True)
class Ahead:
    """One cause for which modes have no causality."""

    conflict: Conflict
    """The two forcing elements and their chains; its `switches` are those that make it, and no
    others."""
    mode: Mode
    """The first mode found that has it."""
    modes: int
    """How many of the modes looked at have it."""
    text: str
    """One paragraph for people."""


@dataclass(frozen=True, slots=True)
class ConflictsAhead:
    """The conflicts among reachable modes."""

    found: tuple[Ahead, ...]
    """One per cause, in the order in which they are met."""
    looked_at: Reachable
    """The modes looked at, and whether these are all."""
    modes: int
    """How many of them have no causality."""


def conflicts_ahead(
    graph: FlatGraph,
    start: Mode | None = None,
    *,
    groups: Iterable[Iterable[int]] = (),
    limit: int = LIMIT,
) -> ConflictsAhead:
    """Find the reachable modes that have no causality, one finding per cause.

    Parameters
    ----------
    graph, start, limit
        As in `reachable`.
    groups : iterable of iterables of int
        Machines that have to do with one another (those of one region of dynamic causality,
        say). If there are more modes than the limit, those that each group reaches with all
        others at rest are looked at too.

    Examples
    --------
    Two batteries on one rail, each behind a switch; a lamp has nothing to do with it:

    >>> import hybond as hb
    >>> m = hb.Model("rail")
    >>> m.add(V=hb.Se(12), W=hb.Se(24), a=hb.One(), b=hb.One(), rail=hb.Zero(),
    ...       lamp=hb.One(), r=hb.R(1), c=hb.R(2))
    >>> m.bond("V -> a -> rail", "W -> b -> rail", "rail -> lamp -> r", "rail -> c")
    >>> for name in ("a", "b", "lamp"):
    ...     m.machine("s_" + name, states={"off": [], "on": [name]}, start="off",
    ...               rules=["off -> on when time >= 1", "on -> off when time >= 2"])
    >>> ahead = conflicts_ahead(m.flatten())
    >>> ahead.looked_at.complete, len(ahead.looked_at.modes), ahead.modes
    (True, 8, 2)
    >>> print(ahead.found[0].text)
    Se V imposes effort on 0-junction rail through 'V -> a', 'a -> rail', and so does Se W through
    'W -> b', 'b -> rail'; switches: s_a = on, s_b = on.
    """
    looked_at = reachable(graph, start, limit=limit)
    if not looked_at.complete:
        parts = [reachable(graph, start, machines=group, limit=limit) for group in groups]
        looked_at = _union(looked_at, parts)
    causes: dict[tuple[tuple[str, bool], ...], Conflict] = {}
    minimal: dict[tuple[object, ...], Conflict] = {}
    first: dict[tuple[tuple[str, bool], ...], Mode] = {}
    conflicting = []
    strokes = Strokes(graph, looked_at.modes[0])
    for mode in looked_at.modes:
        strokes.switch(mode)
        if not strokes.conflict:
            continue
        conflicting.append(graph.off_nodes(mode))
        for conflict in assign(graph, mode).conflicts:
            key = (conflict.node, conflict.switches)
            if key not in minimal:
                minimal[key] = smallest(graph, mode, conflict)
            cause = minimal[key]
            causes.setdefault(cause.switches, cause)
            first.setdefault(cause.switches, mode)
    found = tuple(
        Ahead(
            conflict,
            first[switches],
            sum(_agrees(graph, switches, off) for off in conflicting),
            describe_conflict(graph, first[switches], conflict),
        )
        for switches, conflict in causes.items()
    )
    return ConflictsAhead(found, looked_at, len(conflicting))


def _union(first: Reachable, others: Iterable[Reachable]) -> Reachable:
    modes = dict.fromkeys(first.modes)
    before = dict(first.before)
    for other in others:
        modes.update(dict.fromkeys(other.modes))
        before = {**other.before, **before}
    return replace(first, modes=tuple(modes), before=before)


def smallest(graph: FlatGraph, mode: Mode, conflict: Conflict) -> Conflict:
    """Return a conflict of `mode` that needs as few switches as leaving out one by one gives.

    Parameters
    ----------
    graph, mode
        A mode without causality.
    conflict : Conflict
        One of its conflicts: the switches that had a part in it are looked at first.

    Returns
    -------
    Conflict
        It is there whatever the switches do that it does not name, and is not without any one
        of those that it names.
    """
    off = graph.off_nodes(mode)
    controlled = frozenset(n.index for n in graph.nodes if n.controlled)
    kept = frozenset(graph.by_path[path] for path, _ in conflict.switches)
    least = _with(graph, off, controlled, kept)
    if least is None:
        # A search that found no choice left may rest on more switches than its last clash shows.
        kept = controlled
        least = _with(graph, off, controlled, kept)
    if least is None:
        return conflict
    # Half of them at once, then half of that: many that do not matter cost little.
    size = len(kept)
    while size:
        for chunk in _chunks(sorted(kept), size):
            fewer = kept - frozenset(chunk)
            without = _with(graph, off, controlled, fewer)
            if without is not None:
                kept, least = fewer, without
        size //= 2
    named = tuple((graph.nodes[k].path, k not in off) for k in sorted(kept))
    return replace(least, switches=named)


def _chunks(items: list[int], size: int) -> list[list[int]]:
    return [items[k : k + size] for k in range(0, len(items), size)]


def _with(
    graph: FlatGraph, off: frozenset[int], controlled: frozenset[int], kept: frozenset[int]
) -> Conflict | None:
    """Return a conflict that is there when of all switches only those in `kept` are known."""
    unknown = controlled - kept
    causality: Causality = assign_off(graph, off - unknown, unknown=unknown)
    return causality.conflicts[0] if causality.conflicts else None


def _agrees(graph: FlatGraph, switches: tuple[tuple[str, bool], ...], off: frozenset[int]) -> bool:
    return all((graph.by_path[path] not in off) is on for path, on in switches)
