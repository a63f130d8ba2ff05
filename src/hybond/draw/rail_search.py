"""A good placement of a circuit on rails: begun at its sources, then moved about by cost.

The moves are those of a draughtsman: a part to another column, a net to another row, a row put in
or taken out. Moves that cost something are accepted less and less (Dueck, Scheuer 1990). The seed
is fixed: the same circuit is always drawn the same.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

from hybond.draw.rails import Circuit, Placing, cost

_EFFORT, _LEAST, _MOST = 200_000, 400, 4500
"""Parts looked at in a search; moves that are tried at least, and at most."""
_STARTS: tuple[tuple[int, float], ...] = ((1, 6.0), (2, 3.0), (2, 10.0), (2, 10.0), (1, 14.0))
"""Searches: whether all nets begin on a row, 1, or bridges on rows of theirs, 2; and how much more
a move may cost at first."""
_SMALL, _FEW, _LARGE = 14, 3, 90
"""Branches up to which a few searches are enough, how many, and from which on there is one."""
_LOWEST, _HIGHEST = -2, 14


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
    steps = min(_MOST, max(_LEAST, _EFFORT // size))
    found = []
    starts = _STARTS[:_FEW] if size <= _SMALL else _STARTS
    if size > _LARGE:  # one is enough, as long as little is lost of what it begins with
        high, hot = _STARTS[1 if circuit.legs else 0]
        starts = ((high, hot / 4.0),)
    for k, (high, hot) in enumerate(starts):
        start = begun(circuit, high=high)
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
    for b in circuit.branches:
        if b.role == "source" and b.plus == circuit.zero:
            rows[b.minus] = -1  # a supply below zero
    if high > 1:
        _spread(circuit, rows)
    return Placing(order, rows, [max(high - 1, 0)] * len(circuit.cores))


def _spread(circuit: Circuit, rows: list[int]) -> None:
    """Give the rails of bridges rows of their own, between them one for the middle of each leg."""
    of: dict[tuple[int, int], list[int]] = {}
    for middle, upper, lower in circuit.legs:
        of.setdefault((upper, lower), []).append(middle)
    uppers = {upper for upper, _ in of}
    known: dict[int, int] = {circuit.zero: 0}
    # bridges in series stand one upon the other
    for upper, lower in sorted(of, key=lambda rails: (rails[1] in uppers, rails)):
        middles = of[upper, lower]
        least = known.setdefault(lower, 1)
        for k, middle in enumerate(middles):
            known.setdefault(middle, least + len(middles) - k)
        known.setdefault(upper, least + len(middles) + 1)
    for net, row in known.items():
        rows[net] = row


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
    kind = rng.random()
    if kind < 0.45:
        return _reordered(placing.order, rng)
    if kind < 0.85:
        return _lifted(circuit, placing, rng)
    if kind < 0.93 and placing.bases:
        core, by = rng.randrange(len(placing.bases)), rng.choice((-1, 1))
        placing.bases[core] = max(_LOWEST, min(_HIGHEST, placing.bases[core] + by))
        if rng.random() < 0.5:
            _follow(circuit, placing, core)
        return True
    return _row_changed(placing, rng.randrange(1, _HIGHEST), rng.choice((-1, 1)))


def _reordered(order: list[int], rng: random.Random) -> bool:
    """Take a few items that follow each other to another place, or turn them round."""
    many = len(order)
    long = 1 if rng.random() < 0.6 else rng.randrange(1, 5)
    if many <= long:
        return False
    one = rng.randrange(many - long + 1)
    part = order[one : one + long]
    del order[one : one + long]
    if long > 1 and rng.random() < 0.3:
        order[one:one] = part[::-1]
        return True
    to = rng.randrange(len(order) + 1)
    if rng.random() < 0.6:
        to = max(0, min(len(order), one + rng.choice((-2, -1, 1, 2))))
    order[to:to] = part
    return to != one


def _lifted(circuit: Circuit, placing: Placing, rng: random.Random) -> bool:
    """Give a net another row: one beside its own, that of a net near it, or in exchange."""
    rows, zero = placing.rows, circuit.zero
    net = rng.randrange(circuit.nets)
    if net == zero:
        return False
    kind = rng.random()
    if kind < 0.2:
        other = rng.randrange(circuit.nets)
        if other == zero or rows[other] == rows[net]:
            return False
        rows[net], rows[other] = rows[other], rows[net]
        return True
    near = circuit.branches[rng.randrange(len(circuit.branches))]
    if kind < 0.4 and net in (near.plus, near.minus):
        new = rows[near.minus if net == near.plus else near.plus]
    else:
        new = rows[net] + rng.choice((-1, 1))
    if new == rows[net] or not _LOWEST <= new <= _HIGHEST or new == rows[zero]:
        return False
    rows[net] = new
    return True


def _follow(circuit: Circuit, placing: Placing, core: int) -> None:
    """Give the nets of the coils of a core the rows at which the coils end."""
    for coil, (above, first) in circuit.slots[core].items():
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
    rounds = 3 if len(circuit.branches) <= _LARGE else 1
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
