"""How a circuit stands on paper as textbooks have it, and what a reader minds in it.

Each net is a *rail*: a level line on a row. A part between two rows stands upright between them,
one between two nets of the same row lies in it. The zero of the circuit is the lowest rail, sources
stand at the left with their positive side up, coils of one core stand back to back. Parts have an
order from left to right; what a placement costs is counted from that order and from the rows alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

OVERLAP, CROSSING, TAIL = 14.0, 5.0, 1.5
"""What a column costs in which two rails are one, a wire across a rail, a row that a wire passes."""
ASKEW, UPSIDE_DOWN, LYING = 3.0, 12.0, 6.0
"""A coil whose end is on the wrong side, a source with its positive side down, one that lies."""
UPRIGHT, BACKWARDS, REVERSED = 1.0, 1.0, 1.5
"""Upright though not at the zero; lying and leading back to the sources; a diode that does."""
LEG = 4.0
"""A leg of a bridge that does not lead from its upper rail down to its lower one."""
BELOW, HIGH = 5.0, 0.4
"""A row below the zero, and each row above it that is used."""
SOURCE_RIGHT, LOAD_LEFT, CONTROL_LEFT = 0.3, 0.06, 0.3
"""Each column that a source stands from the left, a load or what controls from the right."""

Leg = tuple[int, int, int]
"""The middle of a leg, its upper and its lower rail."""
ROLES = ("source", "control", "load", "diode", "switch", "plain", "coil")


@dataclass(frozen=True, slots=True)
class Branch:
    """A part with two ends: the nets of its plus and of its minus, and what it is.

    Parameters
    ----------
    role : str
        One of `ROLES`. A control is a source that nothing else is wired to.
    """

    plus: int
    minus: int
    role: str


@dataclass(frozen=True, slots=True)
class Core:
    """The coils of one core: which stand left of it, and right, from above."""

    left: tuple[int, ...]
    right: tuple[int, ...]


@dataclass(frozen=True, slots=True)
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


    @property
    def in_legs(self) -> frozenset[tuple[int, int]]:
        """Pairs of nets between which there is a part of a leg."""
        return _in_legs(self.legs)


@lru_cache(maxsize=8)
def _in_legs(legs: tuple[Leg, ...]) -> frozenset[tuple[int, int]]:
    pairs = [(m, end) for m, upper, lower in legs for end in (upper, lower)]
    return frozenset(pairs + [(b, a) for a, b in pairs])


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


@dataclass(frozen=True, slots=True)
class Stand:
    """How a branch stands: in which column, from which row up to which, its body, its ends."""

    column: int
    low: int
    high: int
    slot: float
    """Row of the middle of its symbol."""
    first: int
    """The net at its upper end; of one that lies, at its left."""
    lies: bool


def slots_of(circuit: Circuit, core: Core) -> dict[int, int]:
    """Return of each coil of a core how many rows above its base it stands.

    Coils one upon the other have a row between them, unless they have a net in common there.
    """
    found: dict[int, int] = {}
    for side in (core.left, core.right):
        at = 0
        for k, coil in enumerate(reversed(side)):
            if k:
                below = circuit.branches[side[len(side) - k]]
                own = circuit.branches[coil]
                common = {own.plus, own.minus} & {below.plus, below.minus}
                at += 1 if common else 2
            found[coil] = at
    tall = max(found.values())
    for side in (core.left, core.right):
        spare = tall - max((found[coil] for coil in side), default=tall)
        for coil in side:
            found[coil] += spare  # both sides begin at the same height
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
        if k in slots:
            slot = slots[k]
            upper = b.plus if p > m or (p == m and b.plus != circuit.zero) else b.minus
            ends = (p, m, slot, slot + 1)
            found.append(Stand(x, min(ends), max(ends), slot + 0.5, upper, lies=False))
        elif p == m:
            one, two = _mean(total, count, b.plus, x), _mean(total, count, b.minus, x)
            if one is None and two is None:
                one = 0.0
            first = b.plus if (one is None and two > x) or (  # type: ignore[operator]
                one is not None and (one < x if two is None else one <= two)
            ) else b.minus
            found.append(Stand(x, p, p, float(p), first, lies=True))
        else:
            upper = b.plus if p > m else b.minus
            found.append(Stand(x, min(p, m), max(p, m), (p + m) / 2.0, upper, lies=False))
    return found


def _mean(total: Sequence[int], count: Sequence[int], net: int, x: int) -> float | None:
    """Return where the other parts of a net stand."""
    return (total[net] - x) / (count[net] - 1) if count[net] > 1 else None


def _columns(circuit: Circuit, placing: Placing) -> tuple[list[int], dict[int, int]]:
    """Return the column of each branch, and of coils the row below them."""
    columns = [0] * len(circuit.branches)
    slots: dict[int, int] = {}
    at = 0
    for item in placing.order:
        if item >= 0:
            columns[item] = at
            at += 1
            continue
        core = circuit.cores[-1 - item]
        for coil, above in slots_of(circuit, core).items():
            slots[coil] = placing.bases[-1 - item] + above
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
    rows, far, zero = placing.rows, circuit.far, circuit.zero
    base = rows[zero]
    low, high = [1 << 30] * circuit.nets, [-1] * circuit.nets
    taken: dict[int, int] = {}
    total = 0.0
    last = len(found) - 1

    def reach(net: int, bit: int) -> None:
        low[net] = min(low[net], bit)
        high[net] = max(high[net], bit)

    for b, s in zip(circuit.branches, found, strict=True):
        bit = 2 * s.column + 1
        if b.role == "source":
            total += SOURCE_RIGHT * s.column
        elif b.role == "control":
            total += CONTROL_LEFT * (last - s.column)
        elif b.role == "load":
            total += LOAD_LEFT * (last - s.column)
        second = b.minus if s.first == b.plus else b.plus
        if s.lies:
            reach(s.first, bit - 1)
            reach(second, bit + 1)
            total += OVERLAP * ((taken.get(s.low, 0) >> bit) & 1)
            taken[s.low] = taken.get(s.low, 0) | (1 << bit)
            if far[s.first] > far[second]:
                total += BACKWARDS
            if b.role == "diode" and s.first == b.minus:
                total += REVERSED
            if b.role in ("source", "control"):
                total += LYING
            continue
        reach(b.plus, bit)
        reach(b.minus, bit)
        if b.role in ("source", "control"):
            total += UPSIDE_DOWN * (s.first == b.minus)
        if b.role == "coil":
            top, bottom = round(s.slot + 0.5), round(s.slot - 0.5)
            total += TAIL * (abs(rows[s.first] - top) + abs(rows[second] - bottom))
            total += ASKEW * ((rows[s.first] < top) + (rows[second] > bottom))
        else:
            total += TAIL * (s.high - s.low - 1)
            if base not in (s.low, s.high) and (b.plus, b.minus) not in circuit.in_legs:
                total += UPRIGHT
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
