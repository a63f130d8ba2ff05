"""Random models that machines switch: networks with comparators, masses that hit."""

from __future__ import annotations

import numpy as np

import hybond as hb


def converter(seed: int) -> hb.Model:
    """Return a random network with switches: comparators with hysteresis, pulses, timers, a latch.

    Bonds point either way. Capacitors may be joined by a switch, inductors cut off by one: then
    impulses pass, and some machines read them.
    """
    rng = np.random.default_rng(seed)
    nodes = int(rng.integers(2, 5))
    m = hb.Model("converter", domain="electrical")

    def size(spread: float = 0.5) -> float:
        return float(np.round(10.0 ** rng.uniform(-spread, spread), 3))

    m.add(**{f"n{k}": hb.Zero() for k in range(nodes)})
    for k in range(nodes):
        store = hb.C(size(), e=float(np.round(rng.uniform(-1.0, 1.0), 2)))
        m.add(**{f"c{k}": store, f"g{k}": hb.R(size())})
        m.bond(f"n{k} -> c{k}" if rng.random() < 0.7 else f"c{k} -> n{k}", f"n{k} -> g{k}")
    m.add(V=hb.Se(f"{size()}*sin({3 * size()}*time) + {size()}"), feed=hb.One(), r=hb.R(size()))
    m.bond("V -> feed -> n0", "feed -> r")
    m.signal(charge=hb.Integral("feed.f"))
    period = float(np.round(rng.uniform(0.11, 0.4), 3))
    m.input(gate=hb.Input(pwm={"period": period, "duty": 0.4}))
    for j in range(int(rng.integers(2, 6))):
        a, b = (int(k) for k in rng.choice(nodes, 2, replace=False))
        m.add(**{f"b{j}": hb.One()})
        m.bond(f"n{a} -> b{j} -> n{b}")
        kind = str(rng.choice(["R", "R", "L", "wire"]))
        if kind == "R":
            m.add(**{f"r{j}": hb.R(size())})
            m.bond(f"b{j} -> r{j}")
        elif kind == "L":
            m.add(**{f"l{j}": hb.I(size())})
            m.bond(f"b{j} -> l{j}")
        _switch(m, rng, j, nodes)
    return m


def _switch(m: hb.Model, rng: np.random.Generator, j: int, nodes: int) -> None:
    """Give branch j its machine."""
    read = f"c{int(rng.integers(nodes))}.e"
    at = float(np.round(rng.uniform(-0.5, 0.8), 2))
    band = float(np.round(rng.uniform(0.05, 0.4), 2))
    match int(rng.integers(5)):
        case 0:
            rules = [
                f"open -> closed when {read} > {at + band}",
                f"closed -> open when {read} < {at}",
            ]
        case 1:
            rules = ["open -> closed when gate > 0.5", "closed -> open when gate < 0.5"]
        case 2:
            off = float(np.round(rng.uniform(0.3, 1.5), 2))
            rules = [
                f"open -> closed when time >= {off / 2} and time < {off}",
                f"closed -> open when time >= {off}",
            ]
        case 3:
            rules = [
                f"open -> closed when charge > {band} and gate > 0.5",
                f"closed -> open when {read} < {at} or charge > {4 * band}",
            ]
        case _:
            # a latch: what passes at the closing decides where it goes on
            m.machine(
                f"S{j}",
                states={"open": [], "closed": [f"b{j}"], "held": [f"b{j}"]},
                start="open",
                rules=[
                    f"open -> closed when {read} > {at + band} and gate > 0.5",
                    f"closed -> held when b{j}.f > 0.01",
                    f"closed -> open when {read} < {at}",
                    f"held -> open when {read} < {at - band} or gate < 0.5 and time > 0.5",
                ],
            )
            return
    start = "open" if rng.random() < 0.7 else "closed"
    m.machine(f"S{j}", states={"open": [], "closed": [f"b{j}"]}, start=start, rules=rules)


def striking(seed: int) -> hb.Model:
    """Return masses on springs that hit a wall or each other, by Newton's law in a machine."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 4))
    m = hb.Model("striking", domain="translational")

    def number(low: float, high: float) -> float:
        return float(np.round(rng.uniform(low, high), 3))

    for k in range(count):
        m.add(**{f"m{k}": hb.I(number(0.5, 2.0), f=number(-1.0, 1.0)), f"v{k}": hb.One()})
        m.add(**{f"s{k}": hb.C(1.0 / number(2.0, 20.0)), f"d{k}": hb.R(number(0.0, 0.3))})
        m.bond(f"v{k} -> m{k}", f"v{k} -> s{k}", f"v{k} -> d{k}")
        m.add(**{f"F{k}": hb.Se(f"{number(0.5, 3.0)}*sin({number(2.0, 9.0)}*time)")})
        m.bond(f"F{k} -> v{k}")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", start=float(k))})
    m.add(wall=hb.Zero(), floor=hb.Sf(f"-{number(0.3, 0.95)}*pre(v0.f)"))
    m.bond("wall -> v0", "floor -> wall")
    gap = number(0.01, 0.1)
    m.machine(
        "bounce",
        states={"away": [], "impact": ["wall"]},
        start="away",
        rules=[
            f"away -> impact when x0 <= -{gap} and v0.f < 0",
            "impact -> away when pre(m0.p) >= 0",
        ],
    )
    for k in range(1, count):
        slip = f"v{k}.f - v{k - 1}.f"
        m.add(**{f"z{k}": hb.Zero(), f"knock{k}": hb.Sf(f"{number(0.3, 0.95)}*pre({slip})")})
        # the flow from v(k-1) less that into v(k) is what the source prescribes
        m.bond(f"v{k - 1} -> z{k}", f"z{k} -> v{k}", f"z{k} -> knock{k}")
        m.machine(
            f"hit{k}",
            states={"apart": [], "impact": [f"z{k}"]},
            start="apart",
            rules=[
                f"apart -> impact when x{k} - x{k - 1} <= 0.9 and {slip} < 0",
                f"impact -> apart when pre({slip}) >= 0",
            ],
        )
    return m
