"""Which modes the machines can reach, as far as structure tells.

A guard counts as possible unless structure alone decides it: a constant, or what it asks of the
machines themselves (``other.state == "open"``, ``valve.on``). Values of signals are not looked
at, so every mode that a run can meet is among the modes found; the converse need not hold.

Breadth first from one mode. All machines fire together, so a step may move any of them; but
machines that do not ask for each other's states get everywhere one at a time as well, and only
those that do are moved together. Source of the firing rule: P. J. Mosterman and G. Biswas,
SIMULATION 78(1), 2002, algorithms 2 and 3.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations, product

from hybond.model.expressions import And, Bool, Compare, Expr, If, Name, Not, Or, names, simplify
from hybond.model.graph import FlatGraph, Mode
from hybond.model.joined import Joined
from hybond.records import dataclass

LIMIT = 1000
"""Modes looked at before the search says "at least"."""

WORK = 200
"""Steps tried per mode of the limit: machines that wait for each other have many."""


@dataclass(frozen=True, slots=True)
class Reachable:
    """The modes that machines can reach."""

    modes: tuple[Mode, ...]
    """In the order in which they were found: fewest steps first."""
    complete: bool
    """Whether these are all; if not, there are at least these."""
    before: Mapping[Mode, Mode]
    """For each mode but the first one, the mode it was found from."""
    machines: tuple[int, ...]
    """The machines that moved; the others stayed in their state."""

    def path(self, mode: Mode) -> tuple[Mode, ...]:
        """Return the modes passed through from the first one to `mode`, both included."""
        found = [mode]
        while found[-1] in self.before:
            found.append(self.before[found[-1]])
        return tuple(reversed(found))


def reachable(
    graph: FlatGraph,
    start: Mode | None = None,
    *,
    machines: Iterable[int] | None = None,
    limit: int = LIMIT,
) -> Reachable:
    """Return the modes that the machines of `graph` can reach.

    Parameters
    ----------
    start : tuple of int, optional
        Where the search begins; the start mode of the graph if not given.
    machines : iterable of int, optional
        Move only these machines (those of one region, say). What their guards ask of the
        others then counts as possible.
    limit : int
        How many modes to look at.

    Examples
    --------
    A pump that starts when its valve is open, which never closes while the pump runs:

    >>> import hybond as hb
    >>> m = hb.Model("pump")
    >>> m.add(P=hb.Se(1), pump=hb.One(), valve=hb.One(), n=hb.Zero(), r=hb.R(1), s=hb.R(1))
    >>> m.bond("P -> pump -> n -> valve -> r", "n -> s")
    >>> m.machine("p", states={"runs": ["pump"], "rests": []}, start="rests",
    ...           rules=["rests -> runs when time >= 1 and valve.on"])
    >>> m.machine("v", states={"open": ["valve"], "shut": []}, start="shut",
    ...           rules=["shut -> open when time >= 2", "open -> shut when not pump.on"])
    >>> graph = m.flatten()
    >>> found = reachable(graph)
    >>> [", ".join(graph.mode_names(mode).values()) for mode in found.modes]
    ['rests, shut', 'rests, open', 'runs, shut', 'runs, open']

    The pump can run with the valve shut: both machines may fire together, each by what it sees
    of the other before.
    """
    first = graph.start_mode if start is None else tuple(start)
    moved = tuple(range(len(graph.machines)) if machines is None else sorted(set(machines)))
    steps = _Steps(graph, moved)
    before: dict[Mode, Mode] = {}
    found: dict[Mode, None] = {first: None}
    queue = deque([first])
    work = max(limit, 1) * WORK
    while queue:
        mode = queue.popleft()
        for after in steps.after(mode):
            work -= 1
            if after not in found:
                if len(found) >= limit:
                    return Reachable(tuple(found), False, before, moved)
                found[after] = None
                before[after] = mode
                queue.append(after)
            if work < 0:
                return Reachable(tuple(found), False, before, moved)
    return Reachable(tuple(found), True, before, moved)


class _Steps:
    """The steps from one mode to the next."""

    def __init__(self, graph: FlatGraph, moved: tuple[int, ...]) -> None:
        self.graph = graph
        self.moved = moved
        self.rest = frozenset(range(len(graph.machines))) - set(moved)
        self.owner = {n: m.index for m in graph.machines for n in m.controls}
        self.groups = self._groups()
        self.alone = set(moved) - self._asking(moved)
        self.always: dict[tuple[int, int], tuple[list[int], bool]] = {}
        """What machines that ask for no other state may do, by machine and state."""

    def after(self, mode: Mode) -> Iterator[Mode]:
        """Yield the modes that may follow `mode`: one machine moved first, then more of them."""
        choices = {m: self._choices(m, mode) for m in self.moved}
        must = [m for m, (_, stays) in choices.items() if not stays]
        # What must leave its state takes part in every step, so then all may move with it.
        groups = [self.moved] if must else self.groups
        for group in groups:
            free = [m for m in group if m not in must and choices[m][0]]
            for count in range(0 if must else 1, len(free) + 1):
                for some in combinations(free, count):
                    firing = (*must, *some)
                    for targets in product(*(choices[m][0] for m in firing)):
                        after = list(mode)
                        for m, state in zip(firing, targets, strict=True):
                            after[m] = state
                        yield tuple(after)

    def _choices(self, machine: int, mode: Mode) -> tuple[list[int], bool]:
        key = (machine, mode[machine])
        if key in self.always:
            return self.always[key]
        found = self._targets(machine, mode)
        if machine in self.alone:
            self.always[key] = found
        return found

    def _targets(self, machine: int, mode: Mode) -> tuple[list[int], bool]:
        """Return the states that may follow, and whether the machine may stay where it is."""
        targets: dict[int, None] = {}
        for rule in self.graph.machines[machine].rules:
            if rule.source != mode[machine]:
                continue
            holds = truth(rule.guard, self._known(mode))
            if holds is not False:
                targets[rule.target] = None
            if holds:
                return list(targets), False
        return list(targets), True

    def _asking(self, moved: tuple[int, ...]) -> set[int]:
        """Return the machines whose guards ask for the state of any machine, their own too."""
        return {
            m
            for m in moved
            for rule in self.graph.machines[m].rules
            if any(_asked(name, self.owner) >= 0 for name in names(rule.guard))
        }

    def _known(self, mode: Mode) -> _States:
        return _States(self.graph, self.owner, mode, self.rest)

    def _groups(self) -> list[tuple[int, ...]]:
        """Return the machines joined by asking for one another's states."""
        joined = Joined(self.moved)
        for m in self.moved:
            for rule in self.graph.machines[m].rules:
                for name in sorted(names(rule.guard)):
                    other = _asked(name, self.owner)
                    if other in self.moved:
                        joined.join((m, other))
        return [tuple(g) for g in joined.groups()]


@dataclass(frozen=True, slots=True)
class _States:
    """What one mode says of ``in:m:k`` and ``on:n``; None of machines in `rest`."""

    graph: FlatGraph
    owner: Mapping[int, int]
    mode: Mode
    rest: frozenset[int]

    def __call__(self, name: str) -> bool | None:
        machine = _asked(name, self.owner)
        if machine < 0 or machine in self.rest:
            return None
        state = self.mode[machine]
        if name.startswith("in:"):
            return state == int(name.rpartition(":")[2])
        return int(name.partition(":")[2]) in self.graph.machines[machine].on[state]


def _asked(name: str, owner: Mapping[int, int]) -> int:
    """Return the machine whose state a canonical name tells, or -1."""
    kind, _, rest = name.partition(":")
    if kind == "in":
        return int(rest.partition(":")[0])
    return owner.get(int(rest), -1) if kind == "on" else -1


def truth(guard: Expr, known: _States) -> bool | None:
    """Return what structure says of a guard: it holds, does not, or None: that depends.

    A priori values (``pre``) are of an earlier mode, so they are only known if constant.
    """
    match guard:
        case Bool():
            return guard.value
        case Name():
            return known(guard.path)
        case Not():
            inner = truth(guard.arg, known)
            return None if inner is None else not inner
        case And() | Or():
            decides = isinstance(guard, Or)
            parts = [truth(part, known) for part in guard.args]
            if decides in parts:
                return decides
            return None if None in parts else not decides
        case If():
            condition = truth(guard.cond, known)
            sides = [
                truth(side, known)
                for side, taken in ((guard.then, True), (guard.orelse, False))
                if condition is None or condition is taken
            ]
            return sides[0] if len(set(sides)) == 1 else None
        case Compare():
            folded = simplify(guard)
            return folded.value if isinstance(folded, Bool) else None
        case _:
            return None
