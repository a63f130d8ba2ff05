"""Jumps onto constraints that bend: held against roots found by bisection."""

from __future__ import annotations

import math

import pytest
from scipy.optimize import brentq

import hybond as hb


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize(
    ("height", "width", "level"), [(1.74, 1.55, -1.99), (0.2, 0.1, 40.0), (3.0, 0.5, 900.0)]
)
def test_two_coils_follow_a_source_that_one_of_them_feeds_back(
    turn: bool, height: float, width: float, level: float
) -> None:
    m = hb.Model("coils")
    m.add(v=hb.One(), i0=hb.I(0.965), i1=hb.I({"f": f"{height}*sinh(p/{width})"}))
    m.add(s=hb.Sf(f"({level})*(1 - 0.5*tanh(i0.p))"))
    m.bond("v -> i0", "v -> i1", "v -> s" if turn else "s -> v")
    run = hb.simulate(m, until=0.1)
    p0 = brentq(lambda p: p / 0.965 - level * (1 - 0.5 * math.tanh(p)), -2e3, 2e3, xtol=1e-15)
    p1 = width * math.asinh(p0 / 0.965 / height)
    assert run["i0.p"].at(0.0) == pytest.approx(p0, rel=1e-9)
    assert run["i1.p"].at(0.0) == pytest.approx(p1, rel=1e-9)


@pytest.mark.parametrize("charge", [1.0, 12.0, 30.0])
def test_charge_is_shared_by_a_steep_and_a_flat_condenser(charge: float) -> None:
    # all charge starts in the linear one; the steep one's first Newton step is far too long
    m = hb.Model("share")
    m.add(n=hb.Zero(), flat=hb.C(1.0, q=charge), steep=hb.C({"e": "0.01*sinh(q/0.1)"}))
    m.bond("n -> flat", "n -> steep")
    run = hb.simulate(m, until=0.1)
    q = brentq(
        lambda x: 0.01 * math.sinh(x / 0.1) - (charge - x), 0.0, min(charge, 5.0), xtol=1e-15
    )
    assert run["steep.q"].at(0.0) == pytest.approx(q, rel=1e-9)
    assert run["steep.q"].at(0.0) + run["flat.q"].at(0.0) == pytest.approx(charge, rel=1e-12)


@pytest.mark.parametrize("start", [0.014, -46.9])
def test_a_source_that_is_zero_discharges_a_bent_condenser(start: float) -> None:
    # what is left is rounding of what was there, and no law that does not hold
    m = hb.Model("empty")
    m.add(n=hb.Zero(), bent=hb.C({"e": "5.4*sinh(q/10)"}, q=start), c=hb.C(112.5, q=15.7))
    m.add(load=hb.Sf("0.137*(1 - 0.5*tanh(c.q))"), short=hb.Se("-0.04*sin(46.5*time)"))
    m.bond("bent -> n", "c -> n", "n -> load", "short -> n")
    run = hb.simulate(m, until=0.1)
    assert run.status == "ok"
    scale = abs(5.4 * math.sinh(start / 10)) + 15.7 / 112.5
    assert run["bent.e"].at(0.0) == pytest.approx(0.0, abs=1e-12 * scale)


def test_coils_in_series_that_an_open_diode_stops_all_hold_nothing() -> None:
    m = hb.Model("stopped")
    m.add(loop=hb.One(law="diode"), v=hb.One(), g=hb.G(0.7))
    m.bond("loop -> v", "v -> g")
    for k, (size, p) in enumerate([(1.2222, -0.115), (2.4471, -0.931), (0.769, -0.0024)]):
        m.add(**{f"i{k}": hb.I(size, p=p)})
        m.bond(f"v -> i{k}")
    run = hb.simulate(m, until=0.5)
    assert run.status == "ok"
    assert [run[f"i{k}.p"].at(0.2) for k in range(3)] == pytest.approx([0.0] * 3, abs=1e-15)


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(
    ("law", "left", "right"),
    [
        ("1.26*max(-1, min(1, f))", 5.0, -3.0),
        ("2*tanh(f)", -9.0, 7.5),
        ("if f > 0 then 3*tanh(f) else f", 40.0, -39.0),
    ],
)
def test_laws_need_no_values_where_a_start_is_not_consistent(
    law: str, left: float, right: float, swapped: bool
) -> None:
    # neither charge alone is one that the resistor can bear, what they share is
    m = hb.Model("start")
    m.add(n=hb.Zero(), v=hb.One(), r=hb.R({"e": law}))
    m.add(a=hb.C(1.0, q=right if swapped else left), b=hb.C(1.0, q=left if swapped else right))
    m.bond("n -> a", "n -> b", "n -> v -> r")
    run = hb.simulate(m, until=0.1)
    assert run["a.q"].at(0.0) == pytest.approx((left + right) / 2, rel=1e-12)
    assert run.audit().holds()


def test_power_at_rest_is_held_against_the_rounding_of_what_rests() -> None:
    # no port has a power: each has no flow or no effort but for rounding
    m = hb.loads(
        """
hybond = 1
[elements]
j0 = { junction = 0 }
j1 = { junction = 1 }
j3 = { junction = 0 }
j4 = { junction = 0 }
j5 = { junction = 0 }
t1 = { GY = -0.971 }
t3 = { TF = 1.04 }
t4 = { TF = -0.627 }
i2 = { I = 2.9983792544570504, p = -0.784 }
c3 = { C = 0.8182989690721649, q = -0.331 }
s0 = { Sf = "-0.594*(1 - 0.5*tanh(i2.p/0.784))" }
[graph]
bonds = [
  "j3 -> j5", "s0 -> j1", "t3.1 -> j0", "j3 -> t3.2", "j4 -> j3", "t4.1 -> j1", "j5 -> c3",
  "j4 -> t4.2", "t1.2 -> j1", "i2 -> j1", "t1.1 -> j0",
]
"""
    )
    assert hb.simulate(m, until=1.84).audit().power <= 1e-12


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize("kind", ["I", "C"])
@pytest.mark.parametrize(
    ("height", "width", "steep"),
    [(0.00133, 0.00224, 1361.0), (0.1, 0.01, 600.0), (2.0, 0.3, 2500.0)],
)
def test_a_jump_leads_over_the_hump_of_a_source_that_reads_what_it_prescribes(
    turn: bool, kind: str, height: float, width: float, steep: float
) -> None:
    # Newton's first step goes away from the only root, and the next beyond all numbers
    begin, level = -0.5 * width, steep * height

    def left(x: float) -> float:
        return height * math.sinh(x / width) + level * (1 - 0.5 * math.tanh(x / (0.5 * width)))

    sign = -1.0 if turn else 1.0
    what, law, start = ("I", "f", "p") if kind == "I" else ("C", "e", "q")
    m = hb.Model("hump")
    m.add(j=hb.One() if kind == "I" else hb.Zero())
    text = f"{height}*sinh({start}/{width})"
    m.add(store=getattr(hb, what)({law: text}, **{start: sign * begin}))
    source = f"({-sign * level})*(1 - 0.5*tanh({sign}*store.{start}/{0.5 * width}))"
    m.add(s=(hb.Sf if kind == "I" else hb.Se)(source))
    m.bond("j -> store", "j -> s" if turn else "s -> j")
    x = brentq(left, -20 * width, 0.0, xtol=1e-18)
    run = hb.simulate(m, until=0.1)
    assert run[f"store.{start}"].at(0.0) == pytest.approx(sign * x, rel=1e-9)


def test_a_jump_beyond_all_numbers_is_no_solution() -> None:
    # the law of the coil never comes to what the source asks for
    m = hb.Model("never")
    m.add(j=hb.One(), i=hb.I({"f": "tanh(p)"}, p=0.1), s=hb.Sf("1.5 + 0.1*sin(i.p)"))
    m.bond("s -> j", "j -> i")
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, until=0.1)
    assert caught.value.code in ("HB-N303", "HB-N304")


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize("rubs", [True, False])
@pytest.mark.parametrize("start", [0.181, 0.12])
def test_a_jump_goes_the_way_that_it_is_pushed_though_its_source_gives_way_faster(
    turn: bool, rubs: bool, start: float
) -> None:
    # with a little resistance in the loop p grows while the source outweighs the rest: to the root
    # above; there is another one below, where friction would be pushed by what it is to brake
    modulus, inertia = 0.637, 0.62174

    def net(p: float) -> float:
        return 1.03 * (1 + 0.5 * math.tanh(p / 0.181)) - 0.91 - modulus * p / inertia

    assert net(start) > 0.0
    above = brentq(net, start, 3.0, xtol=1e-15)
    m = hb.Model("pushed")
    m.add(j=hb.One(law="coulomb", limit=0.91) if rubs else hb.One(), t=hb.GY(modulus))
    m.add(i=hb.I(inertia, p=start), k=hb.One())
    text = f"1.03*(1 + 0.5*tanh(i.p/0.181)) - {0.0 if rubs else 0.91}"
    m.add(s=hb.Se(f"-({text})" if turn else text))
    m.bond("j -> s" if turn else "s -> j", "j -> t.1", "t.2 -> k", "k -> i")
    run = hb.simulate(m, until=0.1)
    assert run["i.p"].at(0.0) == pytest.approx(above, rel=1e-9)
    assert run.audit().holds()


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize(("level", "width", "start"), [(765.0, 29.8, -29.8), (80.0, 0.7, -0.3)])
def test_a_jump_of_two_areas_leads_over_a_hump(
    turn: bool, level: float, width: float, start: float
) -> None:
    # what the source prescribes falls faster than the flow of the coil that it reads: away from
    # the only solution
    def left(p: float) -> float:
        return p / 37.9 + level * (1 - 0.5 * math.tanh(p / width))

    assert left(start) > 0.0
    p = brentq(left, -100 * level, 0.0, xtol=1e-12)
    m = hb.Model("hump")
    m.add(j=hb.One(), i=hb.I(37.9, p=start), bent=hb.I({"f": "1.06*sinh(p/0.207)"}, p=0.2))
    m.add(s=hb.Sf(f"-{level}*(1 - 0.5*tanh(i.p/{width}))"))
    m.bond("j -> i", "j -> bent", "j -> s" if turn else "s -> j")
    run = hb.simulate(m, until=0.1)
    assert run["i.p"].at(0.0) == pytest.approx(p, rel=1e-9)
    bent = 0.207 * math.asinh(p / 37.9 / 1.06)
    assert run["bent.p"].at(0.0) == pytest.approx(bent, rel=1e-9)


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize(
    ("law", "start", "fold"),
    [
        ("{q}^3 + 0.1*time", 0.0, (1.0 / math.sqrt(3.0) - 3.0**-1.5) / 0.1),
        ("exp({q} - 1) + 0.1*time - 0.5", None, 5.0),
        ("sqrt(1 + {q}) - 1 - 0.3*time", 0.0, 0.25 / 0.3),
    ],
)
@pytest.mark.parametrize("kind", ["C", "I"])
def test_where_a_source_rises_as_fast_as_the_storage_it_binds_the_run_ends(
    kind: str, law: str, start: float | None, fold: float, solver: str
) -> None:
    """Two solutions of ``q = law(q, t)`` meet there, and behind it there is none."""
    if start is None:
        start = brentq(lambda q: math.exp(q - 1.0) - 0.5 - q, -1.0, 0.5, xtol=1e-15)
    m = hb.Model("fold")
    if kind == "C":
        m.add(c=hb.C(1.0, q=start), s=hb.Se(law.format(q="c.q")))
        m.bond("s -> c")
    else:
        m.add(c=hb.I(1.0, p=start), s=hb.Sf(law.format(q="c.p")), j=hb.One())
        m.bond("s -> j -> c")
    run = hb.simulate(m, 10.0, solver=solver, on_error="return")
    assert run.error is not None
    assert run.error.code == ("HB-N201" if solver == "radau" else "HB-N304")
    assert run.t_end == pytest.approx(fold, rel=1e-6)
    assert "no solution goes on" in run.error.hint
