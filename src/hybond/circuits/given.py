"""Which voltages and currents of a circuit are given: what sources and resistors alone decide.

A gate seen through a divider, a bleed resistor or a driver with gain is as much given as its source
is. So nodes are put together whose voltages against each other are given: those at the ends of
sources, of sources that follow what is given, and those within a block of resistors. What is left
of such a block between nodes that stand together is a block of its own, so more comes to them until
nothing does. What stores, switches or conducts one way alone is never part of it.

What is given is known as a sum of sources, where it is one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hybond.circuits.blocks import blocks
from hybond.circuits.leaves import Leaf
from hybond.circuits.levels import ONE, OPEN, Levels
from hybond.circuits.opened import GROUND

Sum = dict[int, float]
"""Branch to its part in a sum; `ONE` to what does not depend on any, `OPEN` if it is no sum."""
_ACROSS = ("Se", "meter", "C")
"""What imposes a voltage, if anything."""
_STORES = "cl"
"""Kinds that store: at rest, sources stand for them."""


def times(factor: float, terms: Sum) -> Sum:
    """Return a multiple of a sum."""
    return {k: factor * x for k, x in terms.items()}


def plus(a: Sum, b: Sum, factor: float = 1.0) -> Sum:
    """Return a sum and a multiple of another; what cancels but for rounding is gone.

    Examples
    --------
    >>> plus({0: 1.0, 1: 2.0}, {1: 1.0}, -2.0)
    {0: 1.0}
    """
    found = dict(a)
    for k, x in b.items():
        before = found.pop(k, 0.0)
        after = before + factor * x
        if abs(after) > 1e-13 * abs(before) or k == OPEN:
            found[k] = after
    return found


LARGEST = 1000
"""Nodes of a block that are solved for with dense matrices; those of a larger one are not given."""


class Given:
    """What is given of a circuit.

    Parameters
    ----------
    ends : sequence of (int, int)
        Nodes of each branch.
    numbers : mapping
        Node key to number.
    values : mapping
        Parameters, which laws of sources are written with.
    stored : bool
        Take what is stored as given, too, and no comparison of anything else.
    """

    def __init__(
        self,
        leaves: Sequence[Leaf],
        ends: Sequence[tuple[int, int]],
        numbers: Mapping[str, int],
        values: Mapping[str, float],
        *,
        stored: bool = False,
    ) -> None:
        self.leaves, self.ends, self.numbers, self.stored = leaves, ends, numbers, stored
        count = 1 + max(numbers.values())
        self.together = list(range(count))
        """Of each node the first of those that its voltage is given against, ..."""
        self.against: list[Sum] = [{} for _ in range(count)]
        """... and that voltage."""
        self.group = {n: [n] for n in range(count)}
        self.flows: dict[int, Sum] = {}
        """The currents that are given, from node a to node b."""
        self.levels = Levels(leaves, values)
        self.by_key = {leaf.branch.key: k for k, leaf in enumerate(leaves) if not leaf.beside}
        self.at: list[list[int]] = [[] for _ in range(count)]
        for k, (a, b) in enumerate(ends):
            self.at[a].append(k)
            self.at[b].append(k)
        for self.levels.with_truths in (False,) if stored else (False, True):
            while self._by_sources() | self._by_currents() | self._by_blocks():
                pass

    def voltage(self, first: str, second: str) -> Sum | None:
        """Return the voltage between two nodes, None if it is not given."""
        a, b = self.numbers.get(first), self.numbers.get(second)
        return None if a is None or b is None else self._between(a, b)

    def current(self, key: str) -> Sum | None:
        """Return the current of a branch from node a to node b, None if it is not given."""
        k = self.by_key.get(key)
        if k is None or any(leaf.beside == key for leaf in self.leaves):
            return None
        found = self.flows.get(k)
        return times(-1.0, found) if found is not None and self.leaves[k].backward else found

    def _between(self, a: int, b: int) -> Sum | None:
        if self.together[a] != self.together[b]:
            return None
        return plus(self.against[a], self.against[b], -1.0)

    def _join(self, a: int, b: int, voltage: Sum) -> None:
        """Put two nodes together, of which the voltage from a to b is given."""
        if len(self.group[self.together[a]]) < len(self.group[self.together[b]]):
            a, b, voltage = b, a, times(-1.0, voltage)
        first, second = self.together[a], self.together[b]
        # that of b against its first is known, and so is that of a
        offset = plus(plus(self.against[a], voltage, -1.0), self.against[b], -1.0)
        for n in self.group[second]:
            self.together[n] = first
            self.against[n] = plus(offset, self.against[n])
        self.group[first] += self.group.pop(second)

    # what sources say

    def _imposed(self, k: int) -> Sum | None:
        """Return what a source imposes, None if it is none, or what it follows is not given."""
        leaf = self.leaves[k]
        branch = leaf.branch
        if branch.kind in _STORES and leaf.winding is None:
            return {OPEN: 1.0} if self.stored else None
        if leaf.role not in ("Se", "Sf", "meter"):
            return None
        if leaf.role == "meter":
            return {}
        if leaf.drive is not None:
            constant = branch.wave is None and not leaf.drive.ramp
            return {ONE: leaf.drive.initial} if constant else {k: 1.0}
        if branch.law is not None:
            reads = []
            for read in branch.law.reads:
                if read.kind == "v":
                    reads.append(self.voltage(read.first, read.second))
                else:
                    reads.append(self.current(read.first.lower()))
            return {k: 1.0} if self.levels.computed(k, reads) else None
        if branch.value is None:
            return None
        if branch.kind in "eg":
            followed = self.voltage(*branch.senses[:2]) if len(branch.senses) == 2 else None
        else:
            followed = self.current(branch.senses[0])
        return None if followed is None else times(branch.value.number, followed)

    def _by_sources(self) -> bool:
        """Put nodes together at the ends of sources of voltage; return whether there were any."""
        found = False
        for k, (a, b) in enumerate(self.ends):
            if self.leaves[k].role in _ACROSS and self.together[a] != self.together[b]:
                imposed = self._imposed(k)
                if imposed is not None:
                    self._join(a, b, imposed)
                    found = True
        return found

    def _by_currents(self) -> bool:
        """Find currents: of sources, of resistors, and what is left at a node for a source."""
        found = False
        for k, (a, b) in enumerate(self.ends):
            if k in self.flows:
                continue
            leaf = self.leaves[k]
            flow: Sum | None = None
            if leaf.role in ("Sf", "I"):
                flow = self._imposed(k)
            elif leaf.role == "R":
                across = self._between(a, b)
                if across is not None:
                    flow = self._through(k, across)
            elif leaf.role in ("Se", "meter") and leaf.branch.kind not in _STORES:
                flow = self._left(k, a, -1.0)
                if flow is None:
                    flow = self._left(k, b, 1.0)
            if flow is not None:
                self.flows[k] = flow
                found = True
        return found

    def _through(self, k: int, across: Sum) -> Sum:
        """Return the current of a resistor."""
        value = self.leaves[k].branch.value
        if value is None or self.leaves[k].formula is not None or not value.number:
            return {OPEN: 1.0}
        return times(1.0 / value.number, across)

    def _left(self, k: int, n: int, sign: float) -> Sum | None:
        """Return what the others at a node leave for a branch, `sign` times what leaves it."""
        total: Sum = {}
        for other in self.at[n]:
            if other == k:
                continue
            flow = self.flows.get(other)
            if flow is None:
                return None
            total = plus(total, flow, sign if self.ends[other][0] == n else -sign)
        return total

    # what resistors say

    def _by_blocks(self) -> bool:
        """Put nodes together within blocks of resistors; return whether there were any."""
        edges = []
        which = []
        for k, (a, b) in enumerate(self.ends):
            first, second = self.together[a], self.together[b]
            if first != second:
                edges.append((first, second))
                which.append(k)
        if not edges:
            return False
        found = False
        parts, _ = blocks(len(self.together), edges, self.together[self.numbers[GROUND]])
        for part in parts:
            branches = [which[edge] for edge in part.edges]
            if len(branches) == 1:
                k = branches[0]
                if self.leaves[k].role == "R":  # no current passes it
                    self._join(*self.ends[k], {})
                    found = True
                if k not in self.flows and self.leaves[k].role != "Sf":
                    self.flows[k] = {}
                    found = True
            elif all(self.leaves[k].role == "R" or k in self.flows for k in branches):
                found = self._solve(part.reference, branches) or found
        return found

    def _solve(self, reference: int, branches: Sequence[int]) -> bool:
        """Put the nodes of a block together: Kirchhoff's law of currents at each of them."""
        ends = [(self.ends[k], [self.together[n] for n in self.ends[k]]) for k in branches]
        others = sorted({n for _, firsts in ends for n in firsts} - {reference})
        if len(others) > LARGEST:
            return False
        place = {n: j for j, n in enumerate(others)}
        matrix = np.zeros((len(others), len(others)))
        pushed: list[Sum] = [{} for _ in others]
        for k, ((a, b), firsts) in zip(branches, ends, strict=True):
            here, there = (place.get(n) for n in firsts)
            if k in self.flows:
                flow = self.flows[k]
            else:  # of what its nodes have against the first of theirs; the rest is solved for
                flow = self._through(k, plus(self.against[a], self.against[b], -1.0))
                value = self.leaves[k].branch.value
                slope = 1.0 if OPEN in flow or value is None else 1.0 / value.number
                if here is not None:
                    matrix[here, here] += slope
                if there is not None:
                    matrix[there, there] += slope
                if here is not None and there is not None:
                    matrix[here, there] -= slope
                    matrix[there, here] -= slope
            if here is not None:
                pushed[here] = plus(pushed[here], flow, -1.0)
            if there is not None:
                pushed[there] = plus(pushed[there], flow)
        keys = sorted({key for terms in pushed for key in terms})
        given = np.array([[terms.get(key, 0.0) for key in keys] for terms in pushed])
        try:
            solved = np.linalg.solve(matrix, given)
        except np.linalg.LinAlgError:
            return False  # currents alone: nothing says their voltage
        for n, row in zip(others, solved, strict=True):
            largest = float(np.abs(row).max(initial=0.0))
            terms = {key: float(x) for key, x in zip(keys, row, strict=True)}
            if OPEN not in terms:
                terms = {key: x for key, x in terms.items() if abs(x) > 1e-13 * largest}
            self._join(n, reference, terms)
        return True
