"""Jumps of storages that are many orders apart in SI units: charge and momentum are kept."""

import pytest
from portable_runs import assert_the_same

import hybond as hb

SIZES = [
    # capacitance, inertance of the oil, mass that is hit
    ("1 uF", "2e7 kg/m^4", "1e-9 kg"),
    ("1 nF", "1e9 kg/m^4", "1e9 kg"),
    ("1 fF", "2e7 kg/m^4", "1e6 kg"),
]


def together(C: str, L: str, mass: str, *, nonlinear: bool = False) -> hb.Model:
    """At 1 s two capacitors are joined, a valve is shut and two masses are glued, all doubly."""
    m = hb.Model("together", domain="electrical")
    m.add(a=hb.Zero(), b=hb.Zero(), s1=hb.One(), s2=hb.One(), Ca=hb.C(C, e="10 V"), Cb=hb.C(C))
    m.bond("a -> Ca", "b -> Cb", "a -> s1 -> b", "a -> s2 -> b")
    m.machine(
        "switch",
        states={"open": [], "closed": ["s1", "s2"]},
        start="open",
        rules=["open -> closed when time >= 1"],
    )
    oil = {"domain": "hydraulic"}
    law = {"e": "1e9 [Pa]*(exp(q/(1 [L])) - 1)"}
    m.add(p=hb.Se("1 bar", **oil), n=hb.Zero(**oil), valve=hb.One(**oil), feed=hb.One(**oil))
    m.add(V=hb.C(law if nonlinear else "1e-12 m^3/Pa", **oil), Rf=hb.R("1e10 Pa*s/m^3", **oil))
    m.add(L=hb.I(L, f="0.1 L/s", **oil), Rv=hb.R("1e9 Pa*s/m^3", **oil))
    m.bond("p -> feed -> n -> V", "feed -> Rf", "n -> valve -> L", "valve -> Rv")
    m.machine(
        "tap",
        states={"open": ["valve"], "shut": []},
        start="open",
        rules=["open -> shut when time >= 1"],
    )
    line = {"domain": "translational"}
    m.add(v1=hb.One(**line), v2=hb.One(**line), k1=hb.Zero(**line), k2=hb.Zero(**line))
    m.add(M1=hb.I("2 kg", f="3 m/s", **line), M2=hb.I(mass, **line))
    m.bond("v1 -> M1", "v2 -> M2", "v1 -> k1 -> v2", "v1 -> k2 -> v2")
    m.machine(
        "glue",
        states={"free": [], "on": ["k1", "k2"]},
        start="free",
        rules=["free -> on when time >= 1"],
    )
    return m


@pytest.mark.sampled(6)
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("sizes", SIZES)
def test_what_is_joined_shares_what_it_holds(sizes, nonlinear) -> None:
    model = together(*sizes, nonlinear=nonlinear)
    run = hb.simulate(model, until=1.001, solver="radau")
    speed = 2 * 3 / (2 + float(sizes[2].split()[0]))
    assert [run[v].at(1.001) for v in ("Ca.e", "Cb.e")] == pytest.approx([5, 5], rel=1e-12)
    assert [run[v].at(1.001) for v in ("M1.f", "M2.f")] == pytest.approx([speed] * 2, rel=1e-9)
    assert run["L.f"].at(1.001) == 0.0


def test_an_exported_program_finds_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    model = together(*SIZES[0], nonlinear=True)
    assert_the_same(model, monkeypatch, until=1.001, solver="radau")


def test_two_gases_that_are_joined_beside_a_large_momentum(monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousandth of a cubic metre, and 1e9 Pa*s: each is tried in its own size."""
    m = hb.Model("gases", domain="hydraulic")
    gas = {"e": "5e6 [Pa]*(1e-3 [m^3]/(1e-3 [m^3] - q))^1.4"}
    m.add(Ga=hb.C(gas, q="0.5 L"), Gb=hb.C(gas, q="0.1 L"), a=hb.Zero(), b=hb.Zero(), s=hb.One())
    m.bond("a -> Ga", "b -> Gb", "a -> s -> b")
    m.machine(
        "tap",
        states={"shut": [], "open": ["s"]},
        start="shut",
        rules=["shut -> open when time >= 1"],
    )
    m.add(L=hb.I("1e12 kg/m^4", f="1 L/s"), R=hb.R("1e9 Pa*s/m^3"), v=hb.One())
    m.bond("v -> L", "v -> R")
    run, _ = assert_the_same(m, monkeypatch, until=1.01)
    assert [run[q].at(1.01) for q in ("Ga.q", "Gb.q")] == pytest.approx([3e-4, 3e-4], rel=1e-12)
