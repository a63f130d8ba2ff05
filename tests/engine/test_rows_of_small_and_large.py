"""Flows through next to nothing in a row with orifices, and leaks of next to nothing beside them.

A flow of 1e-9 between two pressures of 1e6 that differ by 1e-9 has no digits as their difference.
"""

from __future__ import annotations

import math
import random
from fractions import Fraction
from itertools import pairwise

import pytest

import hybond as hb
from hybond.engine.mode import solving

K = 0.7 * 1e-5 * 0.04795


def valve(opening: str, *, crossed: bool) -> hb.Model:
    """Two orifices with a line of 1 Pa s/m3 between them; those across are shut."""

    def orifice(s: str) -> hb.Element:
        return hb.R({"f": f"{s}*{K}*e/(e^2 + 1)^(1/4)"})

    m = hb.Model("valve")
    m.add(P=hb.Se(7e6), T=hb.Se(0), p=hb.Zero(), t=hb.Zero(), a=hb.Zero(), b=hb.Zero())
    m.add(pa=hb.One(), bt=hb.One(), l=hb.One(), rl=hb.R(1.0))
    m.add(rpa=orifice(opening), rbt=orifice(opening))
    m.bond("P -> p", "T -> t", "p -> pa -> a", "a -> l -> b", "b -> bt -> t")
    m.bond("pa -> rpa", "bt -> rbt", "l -> rl")
    if crossed:
        m.add(pb=hb.One(), at=hb.One(), rpb=orifice("0"), rat=orifice("0"))
        m.bond("p -> pb -> b", "a -> at -> t", "pb -> rpb", "at -> rat")
    return m


@pytest.mark.parametrize("opening", ["1e-6", "1.6e-6", "1e-3", "0.5", "(time/(1 s))"])
@pytest.mark.parametrize("crossed", [False, True])
def test_two_orifices_share_the_pressure(opening: str, *, crossed: bool) -> None:
    run = hb.simulate(valve(opening, crossed=crossed), 1e-3)
    s = 5e-4 if "time" in opening else float(opening)
    flow = s * K * math.sqrt(3.5e6)
    assert run["rpa.e"].at(5e-4) == pytest.approx((7e6 - flow) / 2, rel=1e-12)
    assert run["rbt.e"].at(5e-4) == pytest.approx((7e6 - flow) / 2, rel=1e-12)
    for name in ("rpa", "rl", "rbt"):
        assert run[f"{name}.f"].at(5e-4) == pytest.approx(flow, rel=1e-9)


@pytest.mark.parametrize(("opening", "at"), [("1e-3", "rpa"), ("0.5", "rbt")])
def test_without_rows_made_anew_the_audit_finds_it(
    monkeypatch: pytest.MonkeyPatch, opening: str, at: str
) -> None:
    monkeypatch.setattr(solving, "HIDDEN", math.inf)
    m = valve(opening, crossed=True)
    run = hb.simulate(m, 1e-3, engine="python", on_error="return")
    assert run.status == "unsound"
    assert run.error is not None and run.error.where == at


def network(
    edges: list[tuple[int, int]], laws: list[hb.Element], source: float, draw: random.Random
) -> hb.Model:
    """Branches between nodes, 0 at the source and 1 at the ground, pointing either way."""
    m = hb.Model("network")
    m.add(P=hb.Se(source), T=hb.Se(0))
    m.add(**{f"n{k}": hb.Zero() for k in {k for edge in edges for k in edge}})
    m.bond("P -> n0", "T -> n1")
    for i, ((a, b), law) in enumerate(zip(edges, laws, strict=True)):
        m.add(**{f"j{i}": hb.One(), f"r{i}": law})
        m.bond(f"n{a} -> j{i} -> n{b}", f"j{i} -> r{i}" if draw.random() < 0.7 else f"r{i} -> j{i}")
    return m


def exact_flows(edges: list[tuple[int, int]], r: list[float], source: float) -> list[float]:
    """Return the flow of each branch of a linear network: nodal equations in fractions."""
    free = sorted({k for edge in edges for k in edge} - {0, 1})
    at = {k: i for i, k in enumerate(free)}
    rows = [[Fraction(0)] * (len(free) + 1) for _ in free]
    for (a, b), value in zip(edges, r, strict=True):
        g = 1 / Fraction(value)
        for k, other in ((a, b), (b, a)):
            if k in at:
                rows[at[k]][at[k]] += g
                if other in at:
                    rows[at[k]][at[other]] -= g
                elif other == 0:
                    rows[at[k]][-1] += g * Fraction(source)
    for i in range(len(free)):
        p = next(j for j in range(i, len(free)) if rows[j][i] != 0)
        rows[i], rows[p] = rows[p], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for j in range(len(free)):
            if j != i:
                rows[j] = [x - rows[j][i] * y for x, y in zip(rows[j], rows[i], strict=True)]
    level = {0: Fraction(source), 1: Fraction(0)} | {k: rows[at[k]][-1] for k in free}
    pairs = zip(edges, r, strict=True)
    return [float((level[a] - level[b]) / Fraction(value)) for (a, b), value in pairs]


BRIDGE = [(0, 2), (2, 3), (3, 1), (0, 3), (2, 1)]
WHEATSTONE = [(0, 2), (2, 1), (0, 3), (3, 1), (2, 4), (4, 3)]
LADDER = [(0, 2), (2, 1), (2, 3), (3, 1), (3, 4), (4, 1)]


def test_resistances_of_eighteen_powers_of_ten() -> None:
    draw = random.Random(4)
    for turn in range(18):
        edges = (BRIDGE, WHEATSTONE, LADDER)[turn % 3]
        r = [10 ** draw.choice([-6.0, 0.0, 12.0, draw.uniform(-6, 12)]) for _ in edges]
        run = hb.simulate(network(edges, [hb.R(v) for v in r], 12.0, draw), 1e-3)
        assert run.status == "ok"
        for i, flow in enumerate(exact_flows(edges, r, 12.0)):
            around = max(abs(run[f"r{k}.f"].at(0)) for k in range(len(edges)) if meets(edges, i, k))
            assert run[f"r{i}.f"].at(0) == pytest.approx(flow, rel=1e-6, abs=1e-9 * around)


def meets(edges: list[tuple[int, int]], i: int, k: int) -> bool:
    """Whether two branches meet in a node that is free."""
    return i == k or bool(set(edges[i]) & set(edges[k]) - {0, 1})


def orifice(draw: random.Random) -> tuple[hb.Element, float, float]:
    """Return an orifice in one of several forms, its coefficient, and where it becomes laminar."""
    k = 3.36e-7 * 10 ** draw.choice([0.0, 0.0, -1.0, draw.uniform(-4, 0)])
    p = draw.choice([1.0, 1e3])
    form = draw.randrange(3)
    if form == 0:
        return hb.R({"f": f"{k!r}*sign(e)*sqrt(abs(e))"}), k, 0.0
    if form == 1:
        return hb.R({"e": f"f*abs(f)/{k!r}^2"}), k, 0.0
    return hb.R({"f": f"{k!r}*e/(e^2 + {p}^2)^(1/4)"}), k, p


@pytest.mark.slow
def test_orifices_among_tiny_and_huge_resistances() -> None:
    # laws, sums at nodes and around loops have one solution: each law rises
    draw = random.Random(7)
    for turn in range(18):
        edges = (BRIDGE, WHEATSTONE, LADDER)[turn % 3]
        laws, known = [], []
        for _ in edges:
            if draw.random() < 0.4:
                r = 10 ** draw.choice([0.0, -6.0, draw.uniform(8, 12)])
                laws.append(hb.R(r))
                known.append((r, -1.0))
            else:
                law, k, p = orifice(draw)
                laws.append(law)
                known.append((k, p))
        run = hb.simulate(network(edges, laws, 7e6, draw), 1e-3)
        assert run.status == "ok"
        level = {k: run[f"n{k}.e"].at(0) for edge in edges for k in edge}
        flows = [run[f"j{i}.f"].at(0) for i in range(len(edges))]
        drops = [abs(run[f"r{i}.e"].at(0)) for i in range(len(edges))]
        for (a, b), f, drop, (k, p) in zip(edges, flows, drops, known, strict=True):
            assert drop == pytest.approx(abs(level[a] - level[b]), rel=1e-6, abs=7e-8)
            if p < 0:
                assert drop == pytest.approx(k * abs(f), rel=1e-6)
            else:
                want = k * drop / (drop**2 + p**2) ** 0.25 if drop > 0 else 0.0
                assert abs(f) == pytest.approx(want, rel=1e-6)
        for node in set(level) - {0, 1}:
            into = [
                f if b == node else -f
                for (a, b), f in zip(edges, flows, strict=True)
                if node in (a, b)
            ]
            assert abs(math.fsum(into)) <= 1e-9 * max(map(abs, into))


def test_orifices_in_a_row_share_a_pressure_by_squares() -> None:
    k = [3.36e-7, 3.36e-8, 1.7e-9]
    m = hb.Model("row")
    m.add(P=hb.Se(7e6), T=hb.Se(0), end=hb.Zero(), **{f"n{i}": hb.Zero() for i in range(4)})
    nodes = ["P", "n0", "n1", "n2", "n3"]
    elements = [hb.R(1e-6), *(hb.R({"e": f"f*abs(f)/{v!r}^2"}) for v in k)]
    m.bond("T -> end")
    for i, (a, b) in enumerate(pairwise([*nodes[1:], "end"])):
        m.add(**{f"j{i}": hb.One(), f"r{i}": elements[i]})
        m.bond(f"{a} -> j{i} -> {b}", f"j{i} -> r{i}")
    m.bond("P -> n0")
    run = hb.simulate(m, 1e-3)
    whole = math.fsum(v**-2 for v in k)
    flow = math.sqrt(7e6 / whole)
    for i, v in enumerate(k, 1):
        assert run[f"r{i}.e"].at(0) == pytest.approx(flow**2 / v**2, rel=1e-9)
    assert run["r0.e"].at(0) == pytest.approx(1e-6 * flow, rel=1e-9)
