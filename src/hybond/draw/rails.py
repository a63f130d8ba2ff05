"""How a circuit stands on paper as textbooks have it, and what a reader minds in it.

Each net is a *rail*: a level line on a row. A part between two rows stands upright between them,
one between two nets of the same row lies in it. The zero of the circuit is the lowest rail, sources
stand at the left with their positive side up, coils of one core stand back to back. Parts have an
order from left to right; what a placement costs is counted from that order and from the rows alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

OVERLAP, CROSSING, TAIL, OFF = 14.0, 5.0, 1.0, 1.5
"""What a column costs in which two rails are one, a wire across a rail, a row that a wire passes,
a row that the rail of a coil is from its end."""
ASKEW, UPSIDE_DOWN, LYING = 8.0, 25.0, 9.0
"""A coil whose end is on the wrong side, a source with its positive side down, one that lies."""
UPRIGHT, BACKWARDS, REVERSED = 2.5, 1.0, 1.5
"""Upright though not at the zero; lying and leading back to the sources; a diode that does."""
ACROSS = 20.0
"""A rail that would lead through a core."""
LEG = 8.0
"""A leg of a bridge that does not lead from its upper rail down to its lower one."""
BELOW, HIGH = 9.0, 0.4
"""A row below the zero, and each row above it that is used."""
SOURCE_RIGHT, LOAD_LEFT, CONTROL_LEFT = 0.6, 0.06, 0.3
"""Each column that a source stands from the left, a load or what controls from the right."""

Leg = tuple[int, int, int]
"""The middle of a leg, its upper and its lower rail."""


@dataclass(frozen=True, slots=True)
class Branch:
    """A part with two ends: the nets of its plus and of its minus, and what it is.

    Parameters
    ----------
    role : str
        ``"source"``, ``"control"``, ``"load"``, ``"diode"``, ``"switch"``, ``"plain"`` or
        ``"coil"``. A control is a source that nothing else is wired to.
    """

    plus: int
    minus: int
    role: str


@dataclass(frozen=True, slots=True)
class Core:
    """The coils of one core: which stand left of it, and right, from above."""

    left: tuple[int, ...]
    right: tuple[int, ...]


@dataclass(frozen=True)
class Circuit:
    """What is placed: branches between nets, cores of coils, and which net is the zero."""

    branches: tuple[Branch, ...]
    nets: int
    zero: int
    cores: tuple[Core, ...] = ()
    far: tuple[int, ...] = ()
    """Of each net how many parts away from the sources it is."""
    legs: tuple[Leg, ...] = ()
    """Legs that are in parallel, as those of bridges."""

    @cached_property
    def in_legs(self) -> frozenset[tuple[int, int]]:
        """Pairs of nets between which there is a part of a leg."""
        pairs = [(m, end) for m, upper, lower in self.legs for end in (upper, lower)]
        return frozenset(pairs + [(b, a) for a, b in pairs])

    @cached_property
    def slots(self) -> tuple[dict[int, tuple[int, int]], ...]:
        """Of each core, where its coils stand: see `slots_of`."""
        return tuple(slots_of(self, core) for core in self.cores)


@dataclass(slots=True)
class Placing:
    """An order of items, each a branch or a core, and the rows of nets and cores.

    Items are branches by their numbers, and cores by -1, -2, ...
    """

    order: list[int]
    rows: list[int]
    bases: list[int] = field(default_factory=list)
    """Of each core the row below its lowest coil."""

    def copy(self) -> Placing:
        """Return another with the same places."""
        return Placing(list(self.order), list(self.rows), list(self.bases))


class Stand(NamedTuple):
    """How a branch stands: in which column, from which row up to which, its body, its ends."""

    column: int
    low: int
    high: int
    slot: float
    """Row of the middle of its symbol."""
    first: int
    """The net at its upper end; of one that lies, at its left."""
    lies: bool


def slots_of(circuit: Circuit, core: Core) -> dict[int, tuple[int, int]]:
    """Return of each coil of a core how many rows above its base it stands, and its upper net.

    Coils one upon the other have a row between them, unless they have a net in common: that is
    between them. The upper net is -1 of coils that may be turned.
    """
    found: dict[int, tuple[int, int]] = {}
    branches = circuit.branches
    tall = 0
    for side in (core.left, core.right):
        at = 0
        for k, coil in enumerate(reversed(side)):
            own = {branches[coil].plus, branches[coil].minus}
            upper = -1
            if k:
                below = side[len(side) - k]
                other = branches[below]
                common = own & {other.plus, other.minus}
                at += 1 if common else 2
                if common:
                    net = min(common)
                    if found[below][1] in (-1, net):
                        found[below] = (found[below][0], net)
                    upper = min(own - {net}, default=-1)
            found[coil] = (at, upper)
        tall = max(tall, at)
    for side in (core.left, core.right):
        spare = tall - max((found[coil][0] for coil in side), default=tall)
        for coil in side:
            found[coil] = (found[coil][0] + spare, found[coil][1])  # both begin at one height
    return found


def stands(circuit: Circuit, placing: Placing) -> list[Stand]:
    """Return how each branch stands, in columns in which nothing else is."""
    columns, slots = _columns(circuit, placing)
    rows, branches = placing.rows, circuit.branches
    total, count = [0] * circuit.nets, [0] * circuit.nets
    for b, x in zip(branches, columns, strict=True):
        for net in (b.plus, b.minus):
            total[net] += x
            count[net] += 1
    found = []
    for k, (b, x) in enumerate(zip(branches, columns, strict=True)):
        p, m = rows[b.plus], rows[b.minus]
        upper = b.plus if p > m else b.minus
        if k in slots:
            slot, fixed = slots[k]
            upper = fixed if fixed >= 0 else upper
            low = min(p, m, slot)
            found.append(Stand(x, low, max(p, m, slot + 1), slot + 0.5, upper, False))
        elif p == m:
            first = b.plus if _leads(total, count, b, x) else b.minus
            found.append(Stand(x, p, p, float(p), first, True))
        else:
            found.append(Stand(x, min(p, m), max(p, m), (p + m) / 2.0, upper, False))
    return found


def _leads(total: Sequence[int], count: Sequence[int], b: Branch, x: int) -> bool:
    """Whether the plus of a part that lies is at its left: where the rest of its net is."""
    one, two = count[b.plus] - 1, count[b.minus] - 1
    if not one:
        return not two or total[b.minus] - x > x * two
    if not two:
        return total[b.plus] - x < x * one
    return (total[b.plus] - x) * two <= (total[b.minus] - x) * one


def _columns(circuit: Circuit, placing: Placing) -> tuple[list[int], dict[int, tuple[int, int]]]:
    """Return the column of each branch, and of coils the row below them and the upper net."""
    columns = [0] * len(circuit.branches)
    slots: dict[int, tuple[int, int]] = {}
    at = 0
    for item in placing.order:
        if item >= 0:
            columns[item] = at
            at += 1
            continue
        core = circuit.cores[-1 - item]
        for coil, (above, upper) in circuit.slots[-1 - item].items():
            slots[coil] = (placing.bases[-1 - item] + above, upper)
        for side in (core.left, core.right):
            for coil in side:
                columns[coil] = at
            at += 1
    return columns, slots


def cost(circuit: Circuit, placing: Placing) -> float:
    """Return what a reader minds in a placement.

    Examples
    --------
    A source, a resistor that goes on, a load; then the source at the right:

    >>> one = Circuit((Branch(1, 0, "source"), Branch(1, 2, "plain"), Branch(2, 0, "load")), 3, 0,
    ...     far=(0, 0, 1))
    >>> good, bad = Placing([0, 1, 2], [0, 1, 1]), Placing([2, 1, 0], [0, 1, 1])
    >>> cost(one, good) < cost(one, bad)
    True
    """
    found = stands(circuit, placing)
    rows, far, in_legs = placing.rows, circuit.far, circuit.in_legs
    base, last = rows[circuit.zero], len(found) - 1
    low, high = [1 << 30] * circuit.nets, [-1] * circuit.nets
    taken: dict[int, int] = {}
    total = 0.0
    for b, s in zip(circuit.branches, found, strict=True):
        bit = left = right = 2 * s.column + 1
        first, role = s.first, b.role
        second = b.minus if first == b.plus else b.plus
        if role == "source":
            total += SOURCE_RIGHT * s.column
        elif role == "control":
            total += CONTROL_LEFT * (last - s.column)
        elif role == "load":
            total += LOAD_LEFT * (last - s.column)
        if s.lies:
            left, right = bit - 1, bit + 1
            there = taken.get(s.low, 0)
            total += OVERLAP * ((there >> bit) & 1)
            taken[s.low] = there | (1 << bit)
            if far[first] > far[second]:
                total += BACKWARDS
            if role == "diode" and first == b.minus:
                total += REVERSED
            elif role in ("source", "control"):
                total += LYING
        elif role == "coil":
            top = round(s.slot + 0.5)
            up, down = rows[first] - top, top - 1 - rows[second]
            total += OFF * (abs(up) + abs(down)) + ASKEW * ((up < 0) + (down < 0))
        else:
            total += TAIL * (s.high - s.low - 1)
            if role in ("source", "control"):
                total += UPSIDE_DOWN * (first == b.minus)
            elif base not in (s.low, s.high) and (b.plus, b.minus) not in in_legs:
                total += UPRIGHT
        for net, at in ((first, left), (second, right)):
            if at < low[net]:
                low[net] = at
            if at > high[net]:
                high[net] = at
    for net, row in enumerate(rows):
        if high[net] < 0:
            continue
        rail = (1 << (high[net] + 1)) - (1 << low[net])
        there = taken.get(row, 0)
        if there & rail:
            total += OVERLAP * (there & rail).bit_count()
        taken[row] = there | rail
        total += 0.5 * (high[net] - low[net])
        if row < base:
            total += BELOW * (base - row)
    for s in found:
        for row in range(s.low + 1, s.high):
            total += CROSSING * ((taken.get(row, 0) >> (2 * s.column + 1)) & 1)
    for middle, upper, lower in circuit.legs:
        total += LEG * ((rows[upper] <= rows[middle]) + (rows[middle] <= rows[lower]))
    for core in circuit.cores:
        slots = [round(found[c].slot - 0.5) for c in (*core.left, *core.right)]
        between = 2 * found[core.left[0]].column + 2
        for row in range(min(slots) + 1, max(slots) + 1):
            total += ACROSS * ((taken.get(row, 0) >> between) & 1)
    return total + HIGH * (max(rows) - min(rows)) + _stacked(circuit, found)


def _stacked(circuit: Circuit, found: Sequence[Stand]) -> float:
    """Return what it costs that wires of coils pass others of the same side."""
    total = 0.0
    for core in circuit.cores:
        for side in (core.left, core.right):
            for k, one in enumerate(side):
                for other in side[:k]:
                    a, b = found[one], found[other]
                    total += CROSSING * max(0, min(a.high, b.high) - max(a.low, b.low))
    return total


def together(circuit: Circuit, placing: Placing) -> list[int]:
    """Return the columns of branches closer together: parts that do not touch share one.

    The order from left to right stays, so that no rail comes onto another.
    """
    found = stands(circuit, placing)
    columns = [0] * len(found)
    at = 0
    here: list[int] = []
    for item in placing.order:
        sides: Sequence[Sequence[int]] = [(item,)]
        if item < 0:
            core = circuit.cores[-1 - item]
            sides = (core.left, core.right)
        for k, own in enumerate(sides):
            if here and (k or any(_touch(circuit, found, a, b) for a in own for b in here)):
                at += 1
                here = []
            for part in own:
                columns[part] = at
            here += own
    return columns


def _touch(circuit: Circuit, found: Sequence[Stand], a: int, b: int) -> bool:
    """Whether two branches cannot stand in one column."""
    one, two = found[a], found[b]
    if one.high < two.low or two.high < one.low:
        return False
    if one.lies or two.lies:
        return True
    upper, lower = (a, b) if one.low >= two.high else (b, a)
    if found[upper].low != found[lower].high:
        return True
    ends = _ends(circuit.branches[upper], found[upper])
    return ends[1] != found[lower].first


def _ends(branch: Branch, stand: Stand) -> tuple[int, int]:
    """Return the nets at the upper and the lower end."""
    return stand.first, branch.minus if stand.first == branch.plus else branch.plus


def where_nets(
    circuit: Circuit, placing: Placing, columns: Mapping[int, int] | Sequence[int]
) -> list[int]:
    """Return of each net the branch in whose column its name stands: the middle one."""
    of: list[list[int]] = [[] for _ in range(circuit.nets)]
    lies = [s.lies for s in stands(circuit, placing)]
    for k, b in enumerate(circuit.branches):
        of[b.plus].append(k)
        of[b.minus].append(k)
    found = []
    for own in of:
        ranked = sorted(own, key=lambda k: (columns[k], k))
        upright = [k for k in ranked if not lies[k]] or ranked
        found.append(upright[len(upright) // 2] if upright else -1)
    return found
