"""Boolean factors: which combinations of switch positions a term belongs to, in few products.

A value per combination of a region becomes a sum of terms ``product of κ and (1 - κ)`` times
coefficient. The products are disjoint, so the sum is ordinary arithmetic; combinations that no
machine can take are free to choose, which shortens them.
"""

from __future__ import annotations

from dataclasses import dataclass

from hybond.equations.patterns import Space
from hybond.model.graph import FlatGraph, Mode


@dataclass(frozen=True, slots=True)
class Boolean:
    """A Boolean variable: true in some states of one machine.

    Parameters
    ----------
    name : str
        The controlled node that it is the switch of, or ``machine = state``.
    machine : int
    states : frozenset of int
        The states in which it is 1.
    """

    name: str
    machine: int
    states: frozenset[int]

    def at(self, mode: Mode) -> bool:
        """Whether it is 1 in a mode."""
        return mode[self.machine] in self.states


Cube = tuple[tuple[int, bool], ...]
"""A product: positions of Booleans in `Naming.booleans`, True for κ and False for 1 - κ."""


class Naming:
    """The Boolean variables of a graph, and the products that describe sets of combinations.

    Two junctions that a machine always switches together have one variable.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add(a=hb.C(1), j=hb.One(), k=hb.One(), b=hb.R(1))
    >>> m.bond("a -> j -> k -> b")
    >>> m.machine("M", states={"idle": [], "run": ["j", "k"]}, start="idle")
    >>> [b.name for b in Naming(m.flatten()).booleans]
    ['j']
    """

    def __init__(self, graph: FlatGraph) -> None:
        self.graph = graph
        self.booleans: list[Boolean] = []
        self.of_node: dict[int, int] = {}
        """Controlled node to the position of its variable."""
        self._by_states: dict[tuple[int, frozenset[int]], int] = {}
        self._at_machine: dict[int, list[int]] = {}
        for node in graph.nodes:
            if not node.controlled or node.machine is None:
                continue
            on = graph.machines[node.machine].on
            states = frozenset(k for k, nodes in enumerate(on) if node.index in nodes)
            self.of_node[node.index] = self._variable(node.machine, states, node.path)

    def _variable(self, machine: int, states: frozenset[int], name: str) -> int:
        known = self._by_states.get((machine, states))
        if known is not None:
            return known
        self.booleans.append(Boolean(name, machine, states))
        position = len(self.booleans) - 1
        self._by_states[machine, states] = position
        self._at_machine.setdefault(machine, []).append(position)
        return position

    def variables(self, space: Space) -> list[int]:
        """Return the variables that tell the combinations of `space` apart.

        States that switch the same but differ in a law have a variable ``machine = state``.
        """
        found: list[int] = []
        for machine, classes, size in zip(space.machines, space.classes, space.sizes, strict=True):
            if size == 1:
                continue
            blocks = [frozenset(k for k, c in enumerate(classes) if c == b) for b in range(size)]
            mine = [
                v
                for v in self._at_machine.get(machine, [])
                if all(
                    b <= self.booleans[v].states or not b & self.booleans[v].states for b in blocks
                )
                and 0 < len(self.booleans[v].states) < len(classes)
            ]
            alike: dict[tuple[bool, ...], list[frozenset[int]]] = {}
            for block in blocks:
                told = tuple(bool(block & self.booleans[v].states) for v in mine)
                alike.setdefault(told, []).append(block)
            about = self.graph.machines[machine]
            for same in alike.values():
                # switched alike, but a law reads the state itself
                for block in same[1:]:
                    name = " or ".join(about.states[k] for k in sorted(block))
                    mine.append(self._variable(machine, block, f"{about.path} = {name}"))
            found += mine
        return found

    def rows(self, space: Space, variables: list[int]) -> list[tuple[bool, ...]]:
        """Return the values of `variables` in each combination of `space`."""
        where = {m: i for i, m in enumerate(space.machines)}
        return [
            tuple(
                states[where[self.booleans[v].machine]] in self.booleans[v].states
                for v in variables
            )
            for states in space.states()
        ]

    def cubes(
        self, space: Space, on: frozenset[int], void: frozenset[int] = frozenset()
    ) -> tuple[Cube, ...]:
        """Return disjoint products that are 1 in the combinations `on` of `space`, 0 in others.

        In the combinations `void` they may be either.
        """
        variables = self.variables(space)
        rows = self.rows(space, variables)
        here = frozenset(range(len(rows))) - void
        found = _split(here, on - void, rows, tuple(range(len(variables))), {})
        wide = tuple(_widened(cube, rows, here) for cube in found)
        return tuple(tuple(sorted((variables[v], value) for v, value in cube)) for cube in wide)


_Parts = tuple[tuple[tuple[int, bool], ...], ...]


def _split(
    here: frozenset[int],
    on: frozenset[int],
    rows: list[tuple[bool, ...]],
    free: tuple[int, ...],
    known: dict[frozenset[int], _Parts],
) -> _Parts:
    """Shannon expansion along the variable that gives the fewest products."""
    if not here & on:
        return ()
    if here <= on:
        return ((),)
    if here in known:
        return known[here]
    best: _Parts | None = None
    for v in free:
        true = frozenset(k for k in here if rows[k][v])
        if not true or true == here:
            continue
        rest = tuple(w for w in free if w != v)
        found = tuple(
            ((v, value), *cube)
            for value, part in ((True, true), (False, here - true))
            for cube in _split(part, on, rows, rest, known)
        )
        if best is None or (len(found), sum(map(len, found))) < (len(best), sum(map(len, best))):
            best = found
    assert best is not None, "the variables do not tell these combinations apart"
    known[here] = best
    return best


def _widened(
    cube: tuple[tuple[int, bool], ...], rows: list[tuple[bool, ...]], here: frozenset[int]
) -> tuple[tuple[int, bool], ...]:
    """Return a product without the factors that no possible combination needs."""

    def covered(literals: tuple[tuple[int, bool], ...]) -> frozenset[int]:
        return frozenset(k for k in here if all(rows[k][v] == value for v, value in literals))

    own = covered(cube)
    for literal in cube:
        less = tuple(other for other in cube if other != literal)
        if covered(less) == own:
            cube = less
    return cube
