"""Which switches and comparisons have an effect at once on what they read.

A switch that looks at its own voltage, or a comparator that drives one, makes what it compares jump
when it switches. Between it and its effect stands nothing that stores. So the voltages of
capacitors and the currents of coils are taken as given here, with those of sources, and what is
left are blocks of which each voltage may depend on all that switches in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from hybond.circuits.blocks import blocks
from hybond.circuits.given import Given
from hybond.circuits.leaves import Leaf
from hybond.circuits.opened import GROUND

Part = tuple[str, int]
"""A block or a branch, by its number."""


class Feedback:
    """What has an effect at once on what.

    Parameters
    ----------
    as in `Given`
    """

    def __init__(
        self,
        leaves: Sequence[Leaf],
        ends: Sequence[tuple[int, int]],
        numbers: Mapping[str, int],
        values: Mapping[str, float],
    ) -> None:
        self.leaves, self.ends, self.numbers = leaves, ends, numbers
        given = Given(leaves, ends, numbers, values, stored=True)
        self.together, self.at, self.by_key = given.together, given.at, given.by_key
        edges, which = [], []
        for k, (a, b) in enumerate(ends):
            if self.together[a] != self.together[b]:
                edges.append((self.together[a], self.together[b]))
                which.append(k)
        ground = self.together[numbers[GROUND]]
        found = blocks(len(self.together), edges, ground)[0] if edges else []
        self.members = [[which[edge] for edge in block.edges] for block in found]
        self.block = {k: j for j, members in enumerate(self.members) for k in members}
        self.windings = [k for k, leaf in enumerate(leaves) if leaf.winding is not None]
        self.ways: dict[int, list[tuple[int, int]]] = {}
        for (a, b), k in zip(edges, which, strict=True):
            self.ways.setdefault(a, []).append((b, k))
            self.ways.setdefault(b, []).append((a, k))

    def on_itself(self, k: int) -> bool:
        """Whether a switch, or a source that computes, has an effect at once on what it reads."""
        seen: set[Part] = set()
        left = list(self._read_by(k))
        while left:
            part = left.pop()
            if part == ("branch", k):
                return True
            if part not in seen:
                seen.add(part)
                left += self._behind(part)
        return False

    def _behind(self, part: Part) -> Iterator[Part]:
        """Yield what a block or a branch depends on at once."""
        kind, n = part
        if kind == "branch":
            yield from self._read_by(n)
            if n in self.windings:
                yield from (("block", self.block[k]) for k in self.windings if k in self.block)
        else:
            yield from (("branch", k) for k in self.members[n])

    def _read_by(self, k: int) -> Iterator[Part]:
        """Yield the blocks and branches that tell what a branch follows."""
        branch = self.leaves[k].branch
        if branch.law is not None:
            for read in branch.law.reads:
                if read.kind == "v":
                    yield from self._voltage(read.first, read.second)
                else:
                    yield from self._current(read.first.lower())
        elif branch.kind in "egsa" and len(branch.senses) == 2:
            yield from self._voltage(*branch.senses)
        elif branch.kind in "fhw" and branch.senses:
            yield from self._current(branch.senses[0])

    def _voltage(self, first: str, second: str) -> Iterator[Part]:
        """Yield the blocks between two nodes: any way from one to the other leads through them."""
        a, b = (self.numbers.get(key, 0) for key in (first, second))
        start, goal = self.together[a], self.together[b]
        came: dict[int, tuple[int, int]] = {start: (start, -1)}
        left = [start]
        while left and goal not in came:
            n = left.pop()
            for other, k in self.ways.get(n, ()):
                if other not in came:
                    came[other] = (n, k)
                    left.append(other)
        while goal in came and goal != start:
            goal, k = came[goal]
            yield "block", self.block[k]

    def _current(self, key: str) -> Iterator[Part]:
        """Yield what tells the current of a branch: all that meets it at its nodes."""
        seen: set[int] = set()
        left = [self.by_key[key]] if key in self.by_key else []
        while left:
            k = left.pop()
            if k in seen or self.leaves[k].role == "I":
                continue
            seen.add(k)
            yield "branch", k
            if k in self.block:
                yield "block", self.block[k]
            elif self.leaves[k].role != "R":
                left += [other for n in self.ends[k] if n for other in self.at[n]]
