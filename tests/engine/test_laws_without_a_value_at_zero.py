"""Laws that have no value where an unknown is zero: a division by it, its logarithm, its root."""

import math

import pytest
from scipy.optimize import brentq

import hybond as hb


def conductors(*conductances: float) -> hb.Model:
    """Conductors with entropy in a row from 400 K to 300 K, no capacity between them."""
    m = hb.Model("row", domain="thermal")
    m.add(hot=hb.Se(400), cold=hb.Se(300), n0=hb.Zero())
    m.bond("hot -> n0")
    for k, g in enumerate(conductances):
        m.add(**{f"k{k}": hb.Submodel("thermal.entropy_conductor", G=g), f"n{k + 1}": hb.Zero()})
        m.bond(f"n{k} -> k{k}.hot", f"k{k}.cold -> n{k + 1}")
    m.bond(f"cold -> n{len(conductances)}")
    return m


@pytest.mark.parametrize("conductances", [(1.0, 1.0), (3.0, 1.0), (1.0, 2.0, 5.0)])
def test_conductors_of_entropy_in_a_row_divide_the_fall_of_temperature(conductances) -> None:
    run = hb.simulate(conductors(*conductances), until=1)
    heat = 100.0 / sum(1.0 / g for g in conductances)
    assert run["k0.heat"].at(1.0) == pytest.approx(heat, rel=1e-12)
    at = 400.0
    for k, g in enumerate(conductances):
        at -= heat / g
        assert run[f"n{k + 1}.e"].at(1.0) == pytest.approx(at, rel=1e-12)


@pytest.mark.parametrize("away", [True, False])
def test_a_heater_of_entropy_heats_a_conductor_without_a_capacity(away: bool) -> None:
    m = hb.Model("heater", domain="thermal")
    m.add(x=hb.Zero(), b=hb.Zero(), cold=hb.Se(300))
    m.add(heater=hb.Submodel("thermal.entropy_heater", inputs={"power": "50 [W] + 50 [W/s]*time"}))
    m.add(wall=hb.Submodel("thermal.entropy_conductor", G=2))
    m.bond("heater.port -> x", "cold -> b", "x -> wall.hot" if away else "wall.hot -> x")
    m.bond("wall.cold -> b")
    run = hb.simulate(m, until=1)
    for t in (0.0, 0.3, 1.0):
        assert run["x.e"].at(t) == pytest.approx(300 + (50 + 50 * t) / 2, rel=1e-12)


def test_a_load_of_constant_power_takes_the_higher_voltage_that_its_line_gives() -> None:
    # e^2 - 10*e + P = 0 behind 10 V and 1 ohm; none beyond 25 W
    for watts, volts in ((9.0, 9.0), (24.0, 6.0)):
        run = hb.simulate(load(f"{watts}/d.e"), until=1)
        assert run["d.e"].at(1.0) == pytest.approx(volts, rel=1e-9)
    none = hb.simulate(load("26/d.e"), until=1, on_error="return")
    assert none.error is not None and none.error.code == "HB-N301"


@pytest.mark.parametrize(
    ("law", "flow"),
    [
        ("log(d.e/2)", lambda e: math.log(e / 2)),
        ("sqrt(d.e - 3)", lambda e: math.sqrt(e - 3)),
        ("d.e^1.5/(1 + 1/d.e)", lambda e: e**1.5 / (1 + 1 / e)),
    ],
)
def test_a_logarithm_and_a_root_begin_where_they_have_a_value(law: str, flow) -> None:
    run = hb.simulate(load(law), until=1)
    assert run["d.e"].at(1.0) == pytest.approx(
        brentq(lambda e: e + flow(e) - 10, 3.0 if "sqrt" in law else 0.1, 10.0), rel=1e-9
    )


def test_a_body_that_only_radiates_what_heats_it_has_a_temperature() -> None:
    # nothing known beside it: sigma*T^4 = P
    m = hb.Model("sun", domain="thermal")
    m.add(x=hb.Zero(), heater=hb.Submodel("thermal.entropy_heater", P=100))
    m.add(away=hb.R({"f": "1e-8*away.e^4/away.e"}))
    m.bond("heater.port -> x", "x -> away")
    run = hb.simulate(m, until=1)
    assert run["x.e"].at(1.0) == pytest.approx(1e10**0.25, rel=1e-9)


def load(law: str) -> hb.Model:
    """A resistor with a law behind 10 V and 1 ohm."""
    m = hb.Model("load")
    m.add(u=hb.Se(10), i=hb.One(), r=hb.R(1), d=hb.R({"f": law}))
    m.bond("u -> i -> r", "i -> d")
    return m


def empty(kind: str, start: float) -> hb.Model:
    """A storage that a logarithm gives no value where it is empty, filled or leaking."""
    m = hb.Model("empty")
    if kind == "leak":
        m.add(A=hb.C({"e": "log(q)"}, q=start), r=hb.R({"f": "exp(e) - 2"}), n=hb.Zero())
        m.bond("A -> n -> r")
    elif kind == "source":
        m.add(A=hb.C({"e": "1 - 1/q"}, q=start), s=hb.Sf(1), n=hb.Zero())
        m.bond("s -> n -> A")
    else:
        m.add(A=hb.I({"f": "log(p)"}, p=start), s=hb.Se(1), n=hb.One())
        m.bond("s -> n -> A")
    return m


@pytest.mark.parametrize("kind", ["leak", "source", "mass"])
def test_a_storage_without_a_value_where_it_is_empty_is_named_or_fills(kind: str) -> None:
    stored = "A.p" if kind == "mass" else "A.q"
    start = 1e-3
    exact = 2.0 + (start - 2.0) * math.exp(-1.0) if kind == "leak" else start + 1.0
    run = hb.simulate(empty(kind, start), 1.0)
    assert float(run[stored].at(1.0)) == pytest.approx(exact, rel=1e-7) and run.audit().holds()
    with pytest.raises(hb.NumericsError, match="HB-N302") as refused:
        hb.simulate(empty(kind, 0.0), 1.0)
    said = str(refused.value)
    assert " A," in said and "-inf at its start" in said and f"{stored[2]} = 0" in said
