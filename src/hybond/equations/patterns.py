"""The combinations of machine states that matter to a few switches, and their Boolean names.

A region of a graph depends on few machines, and on each of them only through what it switches in
that region. A `Space` numbers those combinations; a mode maps to one of them. Everything that is
tabulated per mode is tabulated per combination of one region, so nothing grows with the number
of modes of the whole graph.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

from hybond.model.graph import FlatGraph, Mode

MOST_PATTERNS = 64
"""Combinations above which a region is not tabulated: its switch variables stay."""


@dataclass(frozen=True, slots=True)
class Space:
    """Combinations of classes of machine states."""

    machines: tuple[int, ...]
    classes: tuple[tuple[int, ...], ...]
    """Per machine and state: the class of that state, counted from 0."""
    sizes: tuple[int, ...]
    """Per machine: the number of classes."""

    @property
    def count(self) -> int:
        """Return the number of combinations."""
        return prod(self.sizes)

    def index(self, mode: Mode) -> int:
        """Return the combination that a mode of the whole graph belongs to."""
        found = 0
        for machine, classes, size in zip(self.machines, self.classes, self.sizes, strict=True):
            found = found * size + classes[mode[machine]]
        return found

    def states(self) -> list[tuple[int, ...]]:
        """Return, per combination, one state of each machine that belongs to it."""
        firsts = [
            [classes.index(k) for k in range(size)]
            for classes, size in zip(self.classes, self.sizes, strict=True)
        ]
        return [tuple(states) for states in product(*firsts)]


def space_of(graph: FlatGraph, machines: Sequence[int], key: Callable[[int, int], object]) -> Space:
    """Return the space of `machines`, states with equal ``key(machine, state)`` in one class.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add(a=hb.C(1), j=hb.One(), b=hb.R(1))
    >>> m.bond("a -> j -> b")
    >>> m.machine("M", states={"idle": [], "wait": [], "run": ["j"]}, start="idle")
    >>> graph = m.flatten()
    >>> space = space_of(graph, [0], lambda m, k: bool(graph.machines[m].on[k]))
    >>> space.count, [space.index((k,)) for k in range(3)]
    (2, [0, 0, 1])
    """
    classes: list[tuple[int, ...]] = []
    sizes: list[int] = []
    for machine in machines:
        seen: dict[object, int] = {}
        classes.append(
            tuple(
                seen.setdefault(key(machine, state), len(seen))
                for state in range(len(graph.machines[machine].states))
            )
        )
        sizes.append(len(seen))
    return Space(tuple(machines), tuple(classes), tuple(sizes))
