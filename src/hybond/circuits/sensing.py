"""Voltages of nodes and currents of branches, as sums of what the bond graph knows."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Mapping, Sequence

from hybond.circuits.leaves import Leaf
from hybond.circuits.notices import Line
from hybond.circuits.woven import Terms, Woven
from hybond.names import did_you_mean

_COST = {"Se": 1.0, "C": 1.0, "R": 1.1, "meter": 0.9, "I": 1.2, "winding": 1.2, "Sf": 3.0}
"""Voltages are read off sources and capacitors rather than off switches."""


class Sensing:
    """What can be read in a woven circuit.

    Parameters
    ----------
    numbers : mapping
        Node key to number.
    idle_voltage : callable
        The voltage of an idle source or capacitor, from node a to node b.
    """

    def __init__(
        self,
        woven: Woven,
        leaves: Sequence[Leaf],
        ends: Sequence[tuple[int, int]],
        numbers: Mapping[str, int],
        idle_voltage: Callable[[int], Terms | None],
    ) -> None:
        self.woven, self.leaves, self.ends, self.numbers = woven, leaves, ends, numbers
        self.idle_voltage = idle_voltage
        self.by_key = {leaf.branch.key: k for k, leaf in enumerate(leaves) if not leaf.beside}
        self.beside: dict[str, list[int]] = {}
        for k, leaf in enumerate(leaves):
            if leaf.beside:
                self.beside.setdefault(leaf.beside, []).append(k)
        self._way: dict[int, tuple[int, Callable[[], Terms | None], int]] | None = None

    def voltage(self, plus: str, minus: str, line: Line) -> Terms:
        """Return the voltage between two nodes.

        Raises
        ------
        FileError
            HB-F134 (no such node), HB-F144 (nothing tells it).
        """
        if plus == minus:
            return ()
        there = self._to(plus, line)
        back = self._to(minus, line)
        return (*there, *((-sign, name) for sign, name in back))

    def current(self, key: str, line: Line) -> Terms:
        """Return the current of a branch, from node a to node b.

        Raises
        ------
        FileError
            HB-F134, HB-F144.
        """
        k = self.by_key.get(key)
        if k is None:
            k = self.by_key.get(_lettered(key))
        if k is None:
            raise line.refuse(
                f"there is no element {key!r}",
                code="HB-F134",
                hint=did_you_mean(key, self.by_key),
            )
        found = self.woven.currents.get(k)
        if found is not None and self.leaves[k].backward:
            found = tuple((-sign, name) for sign, name in found)
        for part in self.beside.get(self.leaves[k].branch.key, ()):
            more = self.woven.currents.get(part)
            if found is not None and more is not None:
                way = -1 if self.leaves[part].backward else 1
                found = (*found, *((way * sign, name) for sign, name in more))
        if found is None:
            raise line.refuse(
                f"no bond has the current of {key!r} alone",
                code="HB-F144",
                hint="put a source of 0 V in series with it",
            )
        return found

    def _to(self, key: str, line: Line) -> Terms:
        n = self.numbers.get(key)
        if n is None:
            raise line.refuse(
                f"there is no node {key!r} in a loop or at a source",
                code="HB-F134",
                hint=did_you_mean(key, self.numbers),
            )
        if self._way is None:
            self._way = self._ways()
        terms: list[tuple[int, str]] = []
        while n != 0:
            if n not in self._way:
                raise line.refuse(
                    f"nothing determines the voltage of node {key!r}",
                    code="HB-F144",
                    hint="connect a resistor from it to ground",
                )
            n, step, sign = self._way[n]
            terms += [(sign * s, name) for s, name in step() or ()]
        return tuple(terms)

    def _ways(self) -> dict[int, tuple[int, Callable[[], Terms | None], int]]:
        """Return of each node the neighbour nearer to ground, and what lies between."""
        woven = self.woven
        at: dict[int, list[tuple[int, float, Callable[[], Terms | None], int]]] = {}

        def join(a: int, b: int, cost: float, step: Callable[[], Terms | None]) -> None:
            at.setdefault(a, []).append((b, cost, step, -1))
            at.setdefault(b, []).append((a, cost, step, 1))

        idle = set(woven.idle)
        for k, leaf in enumerate(self.leaves):
            a, b = self.ends[k]
            if k in woven.drops:
                terms = woven.drops[k]
                join(a, b, _COST.get(leaf.role, 10.0), lambda terms=terms: terms)  # type: ignore[misc]
            elif k in idle and leaf.role in ("Se", "C"):
                join(a, b, 1.0, lambda k=k: self.idle_voltage(k))  # type: ignore[misc]
        for n, reference, name in woven.potentials:
            held: Terms = ((1, f"{name}.e"),)
            join(n, reference, 0.5, lambda held=held: held)  # type: ignore[misc]
        way: dict[int, tuple[int, Callable[[], Terms | None], int]] = {}
        best = {0: 0.0}
        heap = [(0.0, 0)]
        while heap:
            far, n = heapq.heappop(heap)
            if far > best[n]:
                continue
            for other, cost, step, sign in at.get(n, ()):
                if far + cost < best.get(other, float("inf")):
                    best[other] = far + cost
                    # v(other) = v(n) + sign * step; a step is v(a) - v(b)
                    way[other] = (n, step, sign)
                    heapq.heappush(heap, (far + cost, other))
        return way


def _lettered(key: str) -> str:
    """Return ``x1.v1`` for ``v.x1.v1``, as ngspice calls an element inside a subcircuit."""
    letter, _, path = key.partition(".")
    own = path.rpartition(".")
    return path if own[1] and len(letter) == 1 and own[2].startswith(letter) else key
