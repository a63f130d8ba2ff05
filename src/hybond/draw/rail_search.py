"""A good placement of a circuit on rails: begun at its sources, then moved about by cost.

The moves are those of a draughtsman: a part to another column, a net to another row, a row put in
or taken out. Moves that cost something are accepted less and less (Dueck, Scheuer 1990). The seed
is fixed: the same circuit is always drawn the same.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

from hybond.draw.rails import Circuit, Placing, cost, slots_of

_EFFORT, _LEAST, _MOST = 300_000, 600, 5000
"""Parts looked at in a search; moves that are tried at least, and at most."""
_HOT = 6.0
_STARTS = 2
_HIGHEST = 9


def settled(circuit: Circuit, *, seed: int = 1) -> Placing:
    """Return a placement that few moves would better.

    Examples
    --------
    >>> from hybond.draw.rails import Branch
    >>> parts = (Branch(2, 0, "load"), Branch(1, 2, "plain"), Branch(1, 0, "source"))
    >>> settled(Circuit(parts, 3, 0, far=(0, 0, 1))).order
    [2, 1, 0]
    """
    size = max(len(circuit.branches), 1)
    steps = min(_MOST, max(_LEAST, _EFFORT // (size * _STARTS)))
    found = []
    for k in range(_STARTS):
        start = begun(circuit, high=1 + k)
        hot = _HOT if size <= 60 else _HOT / 4.0
        found.append(_better(circuit, start, steps, random.Random(seed + k), hot))
    return min(found, key=lambda f: f[0])[1]


def begun(circuit: Circuit, *, high: int) -> Placing:
    """Return branches in the order in which power reaches them, all nets on one row."""
    of_core = {
        coil: -1 - k
        for k, core in enumerate(circuit.cores)
        for side in (core.left, core.right)
        for coil in side
    }

    def rank(k: int) -> tuple[float, int, int]:
        b = circuit.branches[k]
        ends = [circuit.far[n] for n in (b.plus, b.minus) if n != circuit.zero]
        late = {"source": -1.0, "control": 1e9, "load": 0.4}.get(b.role, 0.2)
        joins = circuit.zero not in (b.plus, b.minus)
        return (sum(ends) / len(ends) if ends else 0.0) + late, joins, k

    order: list[int] = []
    for k in sorted(range(len(circuit.branches)), key=rank):
        item = of_core.get(k, k)
        if item not in order:
            order.append(item)
    rows = [0 if n == circuit.zero else high for n in range(circuit.nets)]
    if high > 1:
        _spread(circuit, rows)
    return Placing(order, rows, [max(high - 1, 0)] * len(circuit.cores))


def _spread(circuit: Circuit, rows: list[int]) -> None:
    """Give the rails of bridges rows of their own, between them one for the middle of each leg."""
    of: dict[tuple[int, int], list[int]] = {}
    for middle, upper, lower in circuit.legs:
        of.setdefault((upper, lower), []).append(middle)
    for (upper, lower), middles in of.items():
        least = 0 if lower == circuit.zero else 1
        rows[lower] = least
        for k, middle in enumerate(middles):
            if middle != circuit.zero:
                rows[middle] = least + len(middles) - k
        if upper != circuit.zero:
            rows[upper] = least + len(middles) + 1


def _better(
    circuit: Circuit, start: Placing, steps: int, rng: random.Random, hot: float
) -> tuple[float, Placing]:
    here, now = start, cost(circuit, start)
    best, least = here, now
    for step in range(steps):
        new = here.copy()
        if not _moved(circuit, new, rng):
            continue
        price = cost(circuit, new)
        if price <= now + hot * (1.0 - step / steps) ** 2 * rng.random():
            here, now = new, price
            if now < least - 1e-9:
                best, least = here, now
    return _settled(circuit, best, least)


def _moved(circuit: Circuit, placing: Placing, rng: random.Random) -> bool:
    """Make a move at random; return whether there was one."""
    kind, rows, order = rng.random(), placing.rows, placing.order
    if kind < 0.5 and len(order) > 1:
        one = rng.randrange(len(order))
        other = rng.randrange(len(order))
        if rng.random() < 0.6:
            other = max(0, min(len(order) - 1, one + rng.choice((-2, -1, 1, 2))))
        if one == other:
            return False
        item = order.pop(one)
        order.insert(other, item)
        return True
    if kind < 0.85:
        net = rng.randrange(circuit.nets)
        if net == circuit.zero:
            return False
        near = circuit.branches[rng.randrange(len(circuit.branches))]
        if rng.random() < 0.4 and net in (near.plus, near.minus):
            new = rows[near.minus if net == near.plus else near.plus]
        else:
            new = rows[net] + rng.choice((-1, 1))
        if new == rows[net] or not -2 <= new <= _HIGHEST or new == rows[circuit.zero]:
            return False
        rows[net] = new
        return True
    if kind < 0.93 and placing.bases:
        core = rng.randrange(len(placing.bases))
        by = rng.choice((-1, 1))
        placing.bases[core] = max(-2, min(_HIGHEST, placing.bases[core] + by))
        if rng.random() < 0.5:
            _follow(circuit, placing, core)
        return True
    return _row_changed(placing, rng.randrange(1, _HIGHEST), rng.choice((-1, 1)))


def _follow(circuit: Circuit, placing: Placing, core: int) -> None:
    """Give the nets of the coils of a core the rows at which the coils end."""
    for coil, (above, first) in slots_of(circuit, circuit.cores[core]).items():
        b, row = circuit.branches[coil], placing.bases[core] + above
        up = placing.rows[b.plus] > placing.rows[b.minus] if first < 0 else first == b.plus
        for net, at in ((b.plus, row + up), (b.minus, row + 1 - up)):
            if net != circuit.zero and at != placing.rows[circuit.zero]:
                placing.rows[net] = at


def _row_changed(placing: Placing, at: int, by: int) -> bool:
    """Put a row in above the zero, or take one out."""
    if by > 0 and max(placing.rows) >= _HIGHEST:
        return False
    if by < 0 and at <= 1:
        return False
    placing.rows = [row + by if row >= at else row for row in placing.rows]
    placing.bases = [base + by if base >= at else base for base in placing.bases]
    return True


def _settled(circuit: Circuit, placing: Placing, price: float) -> tuple[float, Placing]:
    """Try each part in the places near it until nothing is better; large circuits once."""
    rounds = 3 if len(circuit.branches) <= 60 else 1
    for _ in range(rounds):
        before = price
        for item in list(placing.order):
            at = placing.order.index(item)
            for to in _near(at, len(placing.order)):
                new = placing.copy()
                new.order.insert(to, new.order.pop(at))
                if (other := cost(circuit, new)) < price - 1e-9:
                    placing, price, at = new, other, to
        for net in range(circuit.nets):
            for by in (-1, 1):
                new = placing.copy()
                new.rows[net] += by
                if net == circuit.zero or new.rows[net] == new.rows[circuit.zero]:
                    continue
                if (other := cost(circuit, new)) < price - 1e-9:
                    placing, price = new, other
        if price > before - 1e-9:
            break
    return price, placing


def _near(at: int, size: int) -> Sequence[int]:
    return [to for to in range(max(0, at - 4), min(size, at + 5)) if to != at]
