"""Storages that exchange what they hold a billion times while something slow goes on: by hand.

Each system is a model, its end, and what is stored there by the exponential of its matrix in 120
digits, which is made of what the model was given.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from decimal import Decimal, localcontext
from fractions import Fraction

import pytest

import hybond as hb

R = 1e-9
"""What joins two capacitors, ohm: terms of rates are 1e15 times as large as those of the leak."""
LEAK = 1e6
Rates = Sequence[Sequence[float | Fraction]]


def moved(rates: Rates, start: Sequence[float | Decimal], t: float) -> list[Decimal]:
    """Return where ``x' = rates x`` leads in a time, by squares of a series."""
    with localcontext() as context:
        context.prec = 120
        n = len(start)
        a = [[number(x) for x in row] for row in rates]
        halvings = max(int(math.log2(float(max(abs(x) for r in a for x in r)) * n * t + 1)), 0) + 4
        small = [[x * Decimal(t) / 2**halvings for x in row] for row in a]
        unit = [[Decimal(i == j) for j in range(n)] for i in range(n)]
        total, term = unit, unit
        for k in range(1, 60):
            term = [[x / k for x in row] for row in times(term, small)]
            total = [
                [x + y for x, y in zip(p, q, strict=True)] for p, q in zip(total, term, strict=True)
            ]
        for _ in range(halvings):
            total = times(total, total)
        return [sum(x * number(y) for x, y in zip(row, start, strict=True)) for row in total]


def times(a: list[list[Decimal]], b: list[list[Decimal]]) -> list[list[Decimal]]:
    columns = list(zip(*b, strict=True))
    return [[sum(x * y for x, y in zip(row, c, strict=True)) for c in columns] for row in a]


def number(x: float | Fraction | Decimal) -> Decimal:
    return Decimal(x.numerator) / x.denominator if isinstance(x, Fraction) else Decimal(x)


def over(a: float, *b: float) -> Fraction:
    """Return a quotient with all its digits."""
    return Fraction(a) / math.prod(map(Fraction, b))


def pair(*, back: bool = False, r: float = R, leak: hb.Element | None = None) -> hb.Model:
    """Two capacitors; bonds point from the first, and the second leaks, or all the other way."""
    m = hb.Model("pair")
    m.add(a=hb.C(1e-6, q=5e-6), b=hb.C(2e-6), na=hb.Zero(), nb=hb.Zero(), s=hb.One(), r=hb.R(r))
    m.add(l=leak or hb.R(LEAK))
    m.bond("s -> r", *(["nb -> s -> na", "a -> na", "na -> l", "nb -> b"] if back else
                       ["na -> s -> nb", "na -> a", "b -> nb", "nb -> l"]))  # fmt: skip
    return m


def pair_rates(*, back: bool = False, r: float = R) -> Rates:
    a, b = over(1, r, 1e-6), over(1, r, 2e-6)
    out = over(1, LEAK, 1e-6 if back else 2e-6)
    return [[-a - out, b], [a, -b]] if back else [[-a, b], [a, -b - out]]


System = tuple[hb.Model, float, dict[str, float]]
"""A model, its end, and what is stored there."""


def held(run: hb.Result, until: float, ends: dict[str, float], rel: float) -> None:
    """Hold a run against what is stored at its end."""
    for name, end in ends.items():
        assert run[name].at(until) == pytest.approx(end, rel=rel, abs=0.0)


def ends(names: str, stored: Sequence[Decimal]) -> dict[str, float]:
    """Return what is stored by name; of states behind those that have one nothing."""
    return dict(zip(names.split(), map(float, stored), strict=False))


def of_pair(m: hb.Model, *, back: bool = False, until: float = 3.0, r: float = R) -> System:
    q = moved(pair_rates(back=back, r=r), [5e-6, 0.0], until)
    return m, until, ends("a.q b.q", q)


def masses(*, back: bool) -> System:
    """Two masses with a stiff damper between them, and friction of one."""
    m = hb.Model("masses")
    m.add(a=hb.I(2.0, p=3.0), b=hb.I(5.0), va=hb.One(), vb=hb.One(), z=hb.Zero(), d=hb.R(1e9))
    m.add(w=hb.R(0.7))
    m.bond("va -> a", "vb -> b", "z -> d", "va -> w" if back else "vb -> w")
    m.bond("vb -> z -> va" if back else "va -> z -> vb")
    a, b, out = over(1e9, 2), over(1e9, 5), over(0.7, 2 if back else 5)
    p = moved([[-a - out * back, b], [a, -b - out * (not back)]], [3.0, 0.0], 9.0)
    return m, 9.0, ends("a.p b.p", p)


def bodies() -> System:
    """Three warm bodies in good contact, heat that comes, and a faint leak."""
    m = hb.Model("bodies")
    m.add(a=hb.C(1.0, q=1.0), b=hb.C(2.0), c=hb.C(0.5), na=hb.Zero(), nb=hb.Zero(), nc=hb.Zero())
    m.add(s=hb.One(), t=hb.One(), r=hb.R(1e-9), u=hb.R(1e-6), g=hb.R(3.0), heat=hb.Sf(0.25))
    m.bond("na -> a", "b -> nb", "nc -> c", "na -> s -> nb", "s -> r", "nc -> t -> nb", "t -> u")
    m.bond("na -> g", "heat -> nc")
    r, u, g = over(1, 1e-9), over(1, 1e-6), over(1, 3)
    rates = [[-r - g, r / 2, 0, 0], [r, -(r + u) / 2, 2 * u, 0], [0, u / 2, -2 * u, 0.25], [0] * 4]
    q = moved(rates, [1.0, 0.0, 0.0, 1.0], 5.0)
    return m, 5.0, ends("a.q b.q c.q", q)


def geared() -> System:
    """What is conserved is a sum with the ratio of a gear, no number of few digits."""
    m = hb.Model("geared")
    m.add(a=hb.C(1.0, q=1.0), b=hb.C(2.0), na=hb.Zero(), nb=hb.Zero(), s=hb.One(), n=hb.TF(0.3))
    m.add(r=hb.R(R), g=hb.R(3.0))
    m.bond("na -> a", "nb -> b", "s -> r", "nb -> g", "na -> n -> s -> nb")
    r, n = over(1, R), over(1, 0.3)
    rates = [[-r * n * n, n * r / 2], [n * r, -r / 2 - over(1, 6)]]
    q = moved(rates, [1.0, 0.0], 7.0)
    return m, 7.0, ends("a.q b.q", q)


def coils() -> System:
    """Two coils whose currents are held together, with a capacitor: slow oscillation."""
    m = hb.Model("coils")
    m.add(a=hb.I(1.0, p=1.0), b=hb.I(2.0), c=hb.C(0.3), sa=hb.One(), sb=hb.One(), z=hb.Zero())
    m.add(g=hb.R(1e9), r=hb.R(0.01))
    m.bond("sa -> a", "b -> sb", "sa -> z -> sb", "z -> g", "sb -> c", "sa -> r")
    g = over(1e9)
    rates = [[-g - over(0.01, 1), -g / 2, 0], [-g, -g / 2, over(1, 0.3)], [0, over(-1, 2), 0]]
    x = moved(rates, [1.0, 0.0, 0.0], 4.0)
    return m, 4.0, ends("a.p b.p c.q", x)


def driven(*, back: bool) -> System:
    """The pair behind a source that moves."""
    m = pair(back=back)
    m.add(V=hb.Se("2*sin(7*time)"), sv=hb.One(), rv=hb.R(LEAK))
    m.bond("V -> sv -> na", "sv -> rv")
    rates = [[*row, 0, 0] for row in pair_rates(back=back)] + [[0, 0, 0, 7], [0, 0, -7, 0]]
    rates[0][0] -= over(1, LEAK, 1e-6)
    rates[0][2] = over(2, LEAK)
    x = moved(rates, [5e-6, 0.0, 0.0, 1.0], 3.0)
    return m, 3.0, ends("a.q b.q", x)


def read_by_source() -> System:
    """The leak is a source that reads what it empties."""
    return of_pair(pair(leak=hb.Sf("b.e/1e6")))


def loose() -> System:
    """The pair beside two open switches in series, between which a level is left open."""
    m = pair()
    m.add(x=hb.One(), k=hb.Zero(), y=hb.One())
    m.bond("na -> x -> k -> y -> nb")
    rule = "off -> on when time >= 100"
    m.machine("X", start="off", states={"off": [], "on": ["x", "y"]}, rules=[rule])
    return of_pair(m)


def counted() -> System:
    """What went through the nanoohm, as the integral of its current."""
    m = pair()
    m.signal(went=hb.Integral("r.f"))
    m, until, there = of_pair(m)
    return m, until, {**there, "went": 5e-6 - there["a.q"]}


def switched() -> System:
    """The pair by itself, joined by a switch, and by itself again."""
    m = pair(r=1e-7)
    rules = ["open -> closed when time >= 1 and time < 3", "closed -> open when time >= 3"]
    m.machine("S", start="open", states={"open": [], "closed": ["s"]}, rules=rules)
    alone: Rates = [[0, 0], [0, over(-1, LEAK, 2e-6)]]
    q = moved(alone, [5e-6, 0.0], 1.0)
    q = moved(alone, moved(pair_rates(r=1e-7), q, 2.0), 1.0)
    return m, 4.0, ends("a.q b.q", q)


LINEAR: dict[str, Callable[[], System]] = {
    "pair": lambda: of_pair(pair()),
    "back": lambda: of_pair(pair(back=True), back=True),
    "masses": functools.partial(masses, back=False),
    "masses back": functools.partial(masses, back=True),
    **{"bodies": bodies, "geared": geared, "coils": coils},
    "driven": functools.partial(driven, back=False),
    "driven back": functools.partial(driven, back=True),
    **{"read by a source": read_by_source, "loose": loose, "counted": counted},
}

Joint = tuple[int, int, float]
"""Two nodes, and the resistance between them, ohm."""
At = tuple[int, float]
"""A node, and what is there: a resistance to ground in ohm, or a current into it in ampere."""


def network(
    farads: Sequence[float],
    volts: Sequence[float],
    joints: Sequence[Joint],
    leaks: Sequence[At],
    fed: Sequence[At],
    until: float,
) -> System:
    """Capacitors at nodes that resistors join."""
    m = hb.Model("network")
    n = len(farads)
    rates = [[Fraction(0)] * (n + 1) for _ in range(n + 1)]
    for i, (c, e) in enumerate(zip(farads, volts, strict=True)):
        m.add(**{f"n{i}": hb.Zero(), f"c{i}": hb.C(c, e=e)})
        m.bond(f"n{i} -> c{i}")
    for k, (a, b, r) in enumerate(joints):
        m.add(**{f"s{k}": hb.One(), f"r{k}": hb.R(r)})
        m.bond(f"n{a} -> s{k} -> n{b}", f"s{k} -> r{k}")
        for i, j in ((a, b), (b, a)):  # of charges: what one gives is what the other gets
            rates[i][i] -= over(1, r, farads[i])
            rates[j][i] += over(1, r, farads[i])
    for k, (i, r) in enumerate(leaks):
        m.add(**{f"l{k}": hb.R(r)})
        m.bond(f"n{i} -> l{k}")
        rates[i][i] -= over(1, r, farads[i])
    for k, (i, f) in enumerate(fed):
        m.add(**{f"f{k}": hb.Sf(f)})
        m.bond(f"f{k} -> n{i}")
        rates[i][n] += Fraction(f)
    start = [*(Decimal(c) * Decimal(e) for c, e in zip(farads, volts, strict=True)), Decimal(1)]
    return m, until, ends(" ".join(f"c{i}.q" for i in range(n)), moved(rates, start, until))


NETWORKS: dict[str, Callable[[], System]] = {
    "of three scales": lambda: network(
        [1e-9, 1e-3, 1e-2], [-1.5, 1.0, -2.5], [(0, 1, 1e-10), (2, 1, 1e-2)], [(2, 1e6)], [], 80.0
    ),
    "fed": lambda: network(
        [3e-7, 1e-6, 3e-2],
        [-4.0, -1.0, 4.0],
        [(0, 1, 1e-10), (0, 2, 5e-3), (0, 1, 3e-4)],
        [(0, 1e6)],
        [(1, 1e-2)],
        0.3,
    ),
    "fed for years": lambda: network(
        [0.1, 0.3, 1e-3, 3e-5],
        [5.0, -4.0, -5.0, 5.0],
        [(1, 0, 1e-9), (2, 0, 1e2), (1, 3, 90.0)],
        [(0, 1e9), (1, 20.0), (2, 100.0)],
        [(3, -1.0)],
        1e8,
    ),
    "that begins with nothing": lambda: network(
        [1e-3, 1e-6, 1e-5, 3e-5],
        [0.0, 0.0, 1.5, 0.0],
        [(1, 0, 13.0), (1, 2, 1e-4), (1, 3, 1e-5), (2, 1, 1e-10)],
        [(0, 1e8), (2, 1e4), (3, 1.0)],
        [(0, -5e-4)],
        3e4,
    ),
    "for 1e25 times the fastest": lambda: network(
        [1e-9, 1e-8, 0.1],
        [0.0, -4.11, 4.11],
        [(0, 1, 1e-10), (0, 2, 1.5e-10)],
        [(2, 1e6)],
        [],
        1e6,
    ),
    "that is level soon": lambda: network(
        [1e-6, 1.0, 1e-4, 3e-8],
        [3.0, 3.0, -2.3, 3.0],
        [(0, 1, 1e-5), (0, 2, 1e5), (3, 1, 2.3e-7), (2, 0, 1e-8)],
        [(0, 2.7e3), (2, 1.1e5)],
        [],
        11.0,
    ),
    "that leaks beside": lambda: network(
        [1e-7, 1e-8, 1e-4],
        [3.0, 3.0, 3.0],
        [(1, 0, 73.0), (2, 0, 6e-10)],
        [(0, 1e4)],
        [],
        0.3,
    ),
    "of next to no and next to all resistance": lambda: network(
        [1e-4, 1e-6, 1e-4],
        [-2.8, 4.3, 0.0],
        [(1, 0, 1.0), (2, 0, 3.4e6), (1, 2, 1e-8)],
        [(0, 1e6)],
        [],
        1.0,
    ),
    "that is level": lambda: network(
        [1.4e-8, 1e-8], [1.0, 1.0], [(1, 0, 1e-10)], [(0, 1e6)], [], 4e-3
    ),
}
"""Networks of capacitors whose rates are more than ten powers of ten apart."""
