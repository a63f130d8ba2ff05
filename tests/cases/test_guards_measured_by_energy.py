"""Guards of converters whose currents are small beside the energy that rounding is measured by.

What a guard compares counts as zero by what the energy of its part would make of it. Next to that
the numbers of a step have a sign already.
"""

import math

import pytest

import hybond as hb


def cell(turned: bool = False, size: float = 1.0) -> hb.Model:
    """Return a buck cell that switches where the voltage of its switch is zero, and goes out."""
    m = hb.Model("cell", domain="electrical", parameters={"T": "4 us", "s": size})
    m.add(V=hb.Se("s*48 V"), S=hb.One(), Rs=hb.R("20 mohm"), Ds=hb.One(law="diode"))
    m.add(Cr=hb.C("4.7 nF"), Lr=hb.I("2 uH"), D=hb.One(law="diode"), R=hb.R("5 ohm"))
    m.add(L=hb.I("50 uH", f=-4 * size if turned else 4 * size), C=hb.C("22 uF", e=20 * size))
    m.add(u=hb.Zero(), j=hb.One(), k=hb.Zero(), i=hb.One(), o=hb.Zero())
    m.bond("V -> j -> u -> S -> Rs", "u -> Cr", "j -> k", "D -> k", "k -> i -> o", "Ds -> u")
    ends = ["Lr -> j", "L -> i", "C -> o", "R -> o"]
    m.bond(*(ends if turned else [" -> ".join(reversed(b.split(" -> "))) for b in ends]))
    rules = [
        "on -> off when mod(time, T) >= 2.6 [us]",
        "off -> on when mod(time, T) < 2.6 [us] and Cr.e <= 0",
    ]
    m.machine("g", states={"on": ["S"], "off": []}, start="on", rules=rules)
    return m


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("turned", "size"), [(False, 1.0), (True, 1.0), (False, 1e-3), (False, 1e3)]
)
def test_a_diode_blocks_where_its_current_is_small_beside_what_was_stored(
    turned: bool, size: float
) -> None:
    model = cell(turned, size)
    first = hb.simulate(model, until=4e-4)
    second = hb.simulate(model, until=4e-4, start=first.state(first.events.t[3]))
    assert second.audit().holds()
    assert second["D.f"].min() > -1e-9 * size
    assert second["D.e"].max() < 1e-6 * size


@pytest.mark.sampled(1)
@pytest.mark.parametrize("resistance", [0.5, 1.0, 2.0])
def test_what_a_coil_leaves_of_a_charge_ends_as_rounding(resistance: float) -> None:
    m = hb.Model("tail", domain="electrical")
    m.add(V=hb.Se("48 V"), i=hb.One(), Lr=hb.I("2 uH"), Cr=hb.C("4.7 nF"), k=hb.Zero())
    m.add(D=hb.One(law="diode"), j=hb.One(), L=hb.I("50 uH"), o=hb.Zero())
    m.add(C=hb.C("22 uF", e="20 V"), R=hb.R(resistance))
    m.bond("V -> i -> Lr", "i -> Cr", "i -> k", "D -> k", "k -> j -> L", "j -> o -> C", "o -> R")
    run = hb.simulate(m, until=4e-4)
    assert run.status == "ok"
    assert run.audit().holds()
    assert run["D.f"].min() > -1e-9
    assert run["D.e"].max() < 1e-7


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("band", [1.5, 2.0, 2.5])
def test_a_current_in_a_band_beside_diodes_that_share_nothing(turned: bool, band: float) -> None:
    """A filter holds the current of a line within a band of its sine, beside a shorted bridge."""
    w = 2 * math.pi * 50
    m = hb.Model("active filter", domain="electrical", parameters={"w": w, "b": band})
    m.add(V=hb.Se("325 V*sin(w*time)"), s=hb.One(), Ls=hb.I("0.1 mH"), n=hb.Zero())
    m.add(Rn=hb.R("200 ohm"), li=hb.One(), Ll=hb.I("1 mH"), lj=hb.One(), Ld=hb.I("20 mH"))
    m.add(Rd=hb.R("15 ohm"), f=hb.One(), Lf=hb.I("3 mH"), G=hb.Se("0 V"))
    m.add(E=hb.Se('if h.state == "up" then 600 [V] else -600 [V]'))
    m.add(a=hb.Zero(), b_=hb.Zero(), p=hb.Zero(), q=hb.Zero())
    m.add(D1=hb.One(law="diode"), D2=hb.One(law="diode"), D3=hb.One(law="diode"))
    m.add(D4=hb.One(law="diode"))
    m.bond("a -> D1 -> p", "b_ -> D2 -> p", "q -> D3 -> a", "q -> D4 -> b_", "G -> q")
    m.bond("V -> s -> n -> li", "b_ -> li -> a", "p -> lj -> q", "n -> f", "E -> f")
    ends = ["Ls -> s", "Rn -> n", "Ll -> li", "Ld -> lj", "Rd -> lj", "Lf -> f"]
    m.bond(*(ends if turned else [" -> ".join(reversed(b.split(" -> "))) for b in ends]))
    off = "li.f + f.f - 14 [A]*sin(w*time)"
    rules = [f"up -> down when {off} > b*(1 A)", f"down -> up when {off} < -b*(1 A)"]
    m.machine("h", states={"up": [], "down": []}, start="up", rules=rules)
    run = hb.simulate(m, until=1e-3)
    assert run.status == "ok"
    assert run.audit().holds()
    t = run["li.f"].t
    held = run["li.f"].y + run["f.f"].y
    for at, current in zip(t, held, strict=True):
        assert abs(current - 14 * math.sin(w * at)) < band + 1e-9
