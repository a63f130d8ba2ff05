"""Where the parts of an electrical circuit stand in its schematic, and which way round.

A circuit of parts with two ends between nodes is placed on rails (`rails`); other models are laid
out as bond graphs are.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from hybond.draw.folded import Folds, cuts, folds, plain
from hybond.draw.geometry import Box, Point
from hybond.draw.measure import width
from hybond.draw.rail_search import settled
from hybond.draw.rails import Branch, Circuit, Core, Leg, Stand, stands, together, where_nets
from hybond.draw.scene import Line
from hybond.model.symbol import Symbol

ROW, GRID = 110.0, 10.0
HALF = 40.0
"""Half the length of a symbol with two pins."""
LEVEL, BESIDE, BARE = 50.0, 22.0, 30.0
"""Pixels that are wanted on both sides of what lies, left of what stands, and right of it."""
BACK_TO_BACK = 60.0
"""Pixels between the coils of a core."""
BAR, BARS = 3.0, 24.0
"""Half the distance of the bars of a core; how far they go beyond the middle of a coil."""
DROP = 30.0
"""Pixels from the lowest rail to the middle of the sign for ground."""
LABEL = 10.5


@dataclass(frozen=True, slots=True)
class Part:
    """A part with two ends as a schematic knows it.

    Parameters
    ----------
    plus, minus : str
        Names of the nodes it is between.
    ports : tuple of str
        Names of its ports, plus first.
    core : str
        Names of the couplings of a coil, divided by spaces.
    """

    name: str
    plus: str
    minus: str
    ports: tuple[str, str]
    role: str
    words: tuple[str, ...] = ()
    core: str = ""


@dataclass(frozen=True, slots=True)
class Plan:
    """Where all stands, in pixels.

    Parameters
    ----------
    at : mapping of name to (x, y)
    toward : mapping of ``part.port`` to (x, y)
        The way in which a pin points.
    facing : mapping of part to (x, y)
        The way in which the upper side of a symbol points, of coils that stand back to back.
    bars : tuple of Line
        The bars of cores.
    cores : tuple of Box
        What is between the coils of cores: no wire goes there.
    """

    at: dict[str, Point]
    toward: dict[str, Point] = field(default_factory=dict)
    facing: dict[str, Point] = field(default_factory=dict)
    bars: tuple[Line, ...] = ()
    cores: tuple[Box, ...] = ()
    folds: Folds | None = None

    def way(self, a: Point, b: Point, node: str) -> tuple[Point, ...]:
        """Return the way from a place to another, straight to the rail of a node and along it."""
        if self.folds is not None:
            return self.folds.way(a, b, node, self.at[node])
        rail = self.at[node][1]
        return plain((a, (a[0], rail), (b[0], rail), b))


def two_ended(symbol: Symbol | None) -> bool:
    """Whether a symbol has two pins that look away from each other, as far as others."""
    if symbol is None or len(symbol.pins) != 2 or symbol.upright:
        return False
    return sorted(symbol.pins.values()) == [(-2.0, 0.0), (2.0, 0.0)]


def circuit_places(
    parts: Sequence[Part], nodes: Sequence[str], grounds: Mapping[str, str]
) -> Plan | None:
    """Return the plan of a circuit, None of one that has no parts.

    Parameters
    ----------
    grounds : mapping of name to node
        Signs for ground, and the nodes at which they are.

    Examples
    --------
    >>> v = Part("v", "a", "0", ("plus", "minus"), "source")
    >>> r = Part("r", "a", "0", ("plus", "minus"), "plain")
    >>> plan = circuit_places([v, r], ["a", "0"], {})
    >>> plan.at["v"][0] < plan.at["r"][0], plan.toward["v.plus"]
    (True, (0.0, -1.0))
    """
    if not parts or not nodes:
        return None
    number = {name: k for k, name in enumerate(nodes)}
    circuit = _circuit(parts, number, grounds)
    placing = settled(circuit)
    found = stands(circuit, placing)
    columns = together(circuit, placing)
    xs = _across(circuit, parts, columns, found)
    rows, top = placing.rows, max(placing.rows)
    spans = _spans(circuit, columns)
    plan = Plan({})
    for k, part in enumerate(parts):
        s = found[k]
        middle = s.slot
        if not s.lies and middle % 1.0 == 0.0 and _crossed(rows, spans, columns[k], middle):
            middle += 0.5
        plan.at[part.name] = (xs[columns[k]], (top - middle) * ROW)
        ways = ((-1.0, 0.0), (1.0, 0.0)) if s.lies else ((0.0, -1.0), (0.0, 1.0))
        forward = s.first == number[part.plus]
        for port, way in zip(part.ports, ways if forward else ways[::-1], strict=True):
            plan.toward[f"{part.name}.{port}"] = way
    for name, k in zip(nodes, where_nets(circuit, placing, columns), strict=True):
        x = xs[columns[k]] if k >= 0 else 0.0
        if k >= 0 and found[k].lies:
            x += -LEVEL if found[k].first == number[name] else LEVEL
        plan.at[name] = (x, (top - rows[number[name]]) * ROW)
    lowest = (top - min(rows)) * ROW
    zero = nodes[circuit.zero]
    folded = None
    own = [span for n, span in enumerate(spans) if n != circuit.zero]
    starts = cuts(xs, lowest + ROW, own, {columns[core.left[0]] for core in circuit.cores})
    if starts:
        band = [bisect_right(starts, c) for c in range(len(xs))]
        left = [xs[c] for c in (0, *starts)]
        wide = max(x - left[k] for x, k in zip(xs, band, strict=True))
        by_name = {name: spans[n] for name, n in number.items()}
        folded = folds(by_name, zero, starts, wide + LEVEL, (lowest, lowest))
        where = {part.name: columns[k] for k, part in enumerate(parts)}
        middles = where_nets(circuit, placing, columns)
        where |= {name: columns[k] for name, k in zip(nodes, middles, strict=True) if k >= 0}
        for name, c in where.items():
            x, y = plan.at[name]
            plan.at[name] = (x - left[band[c]] + LEVEL, y + band[c] * folded.tall)
    _ground_signs(plan, parts, grounds)
    return Plan(plan.at, plan.toward, plan.facing, *_cores(plan, circuit, parts), folded)


def _circuit(
    parts: Sequence[Part], number: Mapping[str, int], grounds: Mapping[str, str]
) -> Circuit:
    """Return the circuit as it is placed."""
    ends = [(number[p.plus], number[p.minus]) for p in parts]
    count = [0] * len(number)
    for pair in ends:
        for net in set(pair):
            count[net] += 1
    zero = number[next(iter(grounds.values()))] if grounds else _zero(parts, ends, count)
    roles = [_role(p.role, pair, count, zero) for p, pair in zip(parts, ends, strict=True)]
    cores = _couplings(parts)
    far = _far(ends, roles, len(number), zero)
    side = _sides(ends, roles, len(number), zero)
    grouped = []
    for coils in cores:
        for coil in coils:
            roles[coil] = "coil"
        left = [c for c in coils if any(side[n] for n in ends[c] if n != zero)]
        right = [c for c in coils if c not in left]
        if not left or not right:
            left, right = coils[:1], coils[1:]
        grouped.append(Core(_chained(left, ends), _chained(right, ends)))
    branches = tuple(Branch(a, b, role) for (a, b), role in zip(ends, roles, strict=True))
    legs = _legs(branches, far, zero)
    return Circuit(branches, len(number), zero, tuple(grouped), tuple(far), legs)


def _zero(parts: Sequence[Part], ends: Sequence[tuple[int, int]], count: Sequence[int]) -> int:
    """Return what stands for zero in a circuit without a sign for it: where most sources end."""
    low = [0] * len(count)
    for part, (_, minus) in zip(parts, ends, strict=True):
        low[minus] += part.role == "source"
    return max(range(len(count)), key=lambda n: (low[n], count[n], -n))


def _role(role: str, ends: tuple[int, int], count: Sequence[int], zero: int) -> str:
    if role == "source" and any(count[n] == 1 for n in ends if n != zero):
        return "control"
    if role == "load" and zero not in ends:
        return "plain"
    return role


def _couplings(parts: Sequence[Part]) -> list[list[int]]:
    """Return the coils that are on one core, by the names of couplings that they share."""
    found: list[tuple[set[str], list[int]]] = []
    for k, part in enumerate(parts):
        words = set(part.core.split())
        if not words:
            continue
        joined = [f for f in found if f[0] & words]
        rest = [f for f in found if not f[0] & words]
        coils = [c for _, own in joined for c in own] + [k]
        found = [*rest, (words.union(*(w for w, _ in joined)), coils)]
    return sorted(sorted(coils) for _, coils in found if len(coils) > 1)


def _far(ends: Sequence[tuple[int, int]], roles: Sequence[str], nets: int, zero: int) -> list[int]:
    """Return of each net how many parts away from the sources it is; across cores last."""
    near: list[list[int]] = [[] for _ in range(nets)]
    for a, b in ends:
        near[a].append(b)
        near[b].append(a)
    far = [-1] * nets
    far[zero] = 0
    start = [n for (a, b), r in zip(ends, roles, strict=True) if r == "source" for n in (a, b)]
    rest = [n for n in range(nets) if n != zero]
    behind = 0
    for begin in [[n for n in start if n != zero], *[[n] for n in rest]]:
        queue = deque(n for n in begin if far[n] < 0)
        for n in queue:
            far[n] = behind
        while queue:
            n = queue.popleft()
            for m in near[n]:
                if far[m] < 0:
                    far[m] = far[n] + 1
                    queue.append(m)
        behind = max(far) + 1
    return far


def _sides(
    ends: Sequence[tuple[int, int]], roles: Sequence[str], nets: int, zero: int
) -> list[bool]:
    """Return of each net whether a source feeds it other than across a core."""
    fed = [False] * nets
    for (a, b), role in zip(ends, roles, strict=True):
        if role == "source":
            fed[a] = fed[b] = True
    fed[zero] = False
    changed = True
    while changed:
        changed = False
        for a, b in ends:
            if zero not in (a, b) and fed[a] != fed[b]:
                fed[a] = fed[b] = changed = True
    return fed


def _legs(branches: Sequence[Branch], far: Sequence[int], zero: int) -> tuple[Leg, ...]:
    """Return the legs that are in parallel: two parts that switch, between the same two rails.

    A diode says which of the rails is the upper one, else it is the one that is not the zero.
    """
    up: dict[int, list[int]] = {}
    down: dict[int, list[int]] = {}
    for b in branches:
        if b.role == "diode":
            up.setdefault(b.plus, []).append(b.minus)
            down.setdefault(b.minus, []).append(b.plus)
        elif b.role == "switch":
            for one, other in ((b.plus, b.minus), (b.minus, b.plus)):
                if other != zero:
                    up.setdefault(one, []).append(other)
                down.setdefault(one, []).append(other)
    of: dict[tuple[int, int], list[int]] = {}
    for middle in sorted(up.keys() & down.keys()):
        if middle == zero:
            continue
        for upper in dict.fromkeys(up[middle]):
            for lower in dict.fromkeys(down[middle]):
                if upper != lower and (lower == zero or far[lower] >= 0):
                    of.setdefault((upper, lower), []).append(middle)
    many = {rails: middles for rails, middles in of.items() if len(middles) > 1}
    # between two rails of which none is the zero switches do not say which is the upper one
    return tuple(
        (middle, upper, lower)
        for (upper, lower), middles in many.items()
        if (lower, upper) not in many
        for middle in middles
    )


def _chained(coils: Sequence[int], ends: Sequence[tuple[int, int]]) -> tuple[int, ...]:
    """Return coils in such an order that those with a net in common follow each other."""
    rest = list(coils)
    found: list[int] = []
    while rest:
        last = set(ends[found[-1]]) if found else set()
        found.append(next((c for c in rest if last & set(ends[c])), rest[0]))
        rest.remove(found[-1])
    return tuple(found)


def _spans(circuit: Circuit, columns: Sequence[int]) -> list[tuple[int, int]]:
    """Return from which column to which each net goes."""
    of: list[list[int]] = [[] for _ in range(circuit.nets)]
    for b, column in zip(circuit.branches, columns, strict=True):
        of[b.plus].append(column)
        of[b.minus].append(column)
    return [(min(own, default=0), max(own, default=-1)) for own in of]


def _crossed(
    rows: Sequence[int], spans: Sequence[tuple[int, int]], column: int, row: float
) -> bool:
    """Whether a rail passes a column on a row."""
    return any(at == row and a <= column <= b for at, (a, b) in zip(rows, spans, strict=True))


def _across(
    circuit: Circuit, parts: Sequence[Part], columns: Sequence[int], found: Sequence[Stand]
) -> list[float]:
    """Return where columns are, so far apart that what is written beside parts has room."""
    many = max(columns) + 1
    left, right = [0.0] * many, [0.0] * many
    sides = {
        c: side
        for core in circuit.cores
        for side, own in (("left", core.left), ("right", core.right))
        for c in own
    }
    for k, part in enumerate(parts):
        at = columns[k]
        words = max((width(w, LABEL) for w in part.words), default=0.0)
        if found[k].lies:  # what is written stands below
            more = max(LEVEL, words / 2.0 + 4.0)
            left[at], right[at] = max(left[at], more), max(right[at], more)
        elif sides.get(k) == "left":
            left[at] = max(left[at], BARE + words)
        else:
            left[at] = max(left[at], BESIDE)
            right[at] = max(right[at], BARE + words)
    facing = {columns[core.left[0]] for core in circuit.cores}
    xs = [0.0]
    for k in facing:
        left[k] = max(left[k], right[k])
    for k in range(1, many):
        apart = BACK_TO_BACK if k - 1 in facing else right[k - 1] + left[k]
        xs.append(xs[-1] + GRID * math.ceil(apart / GRID))
    return xs


def _ground_signs(plan: Plan, parts: Sequence[Part], grounds: Mapping[str, str]) -> None:
    """Put the signs for ground below the rail of their node, below what stands there first."""
    for k, (name, node) in enumerate(grounds.items()):
        rail = plan.at[node][1]
        wired = [plan.at[p.name] for p in parts if node in (p.plus, p.minus)]
        xs = [x for x, y in wired if abs(y - rail) < 2.5 * ROW]
        x = min(xs, default=0.0) + 3.0 * HALF * k
        if any(y > rail and u < x + HALF for u, y in plan.at.values()):
            x = min(u for u, _ in plan.at.values()) - 1.5 * HALF  # something stands there
        plan.at[name] = (x, rail + DROP)


def _cores(
    plan: Plan, circuit: Circuit, parts: Sequence[Part]
) -> tuple[tuple[Line, ...], tuple[Box, ...]]:
    """Let the coils of cores face each other, and return the bars between them."""
    bars: list[Line] = []
    boxes: list[Box] = []
    for core in circuit.cores:
        for side, way in ((core.left, 1.0), (core.right, -1.0)):
            for coil in side:
                plan.facing[parts[coil].name] = (way, 0.0)
        places = [plan.at[parts[c].name] for c in (*core.left, *core.right)]
        x = (plan.at[parts[core.left[0]].name][0] + plan.at[parts[core.right[0]].name][0]) / 2.0
        y0, y1 = min(y for _, y in places) - BARS, max(y for _, y in places) + BARS
        bars += [Line("symbol", ((x + u, y0), (x + u, y1))) for u in (-BAR, BAR)]
        half = BACK_TO_BACK / 4.0
        boxes.append(Box(x - half, y0, x + half, y1))
    return tuple(bars), tuple(boxes)
