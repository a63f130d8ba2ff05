"""Where a run has no derivative, the record says so and gives no number."""

import numpy as np
import pytest

import hybond as hb


def thrown(reach: float) -> hb.Model:
    """A ball that is thrown up 5 m high, and a place where it becomes heavier, reached or not."""
    m = hb.Model("thrown", parameters={"v0": 10.0, "top": reach})
    m.add(
        weight=hb.Se('if w.state == "high" then -15 else -10'), ball=hb.I(1.0, f="v0"), v=hb.One()
    )
    m.bond("weight -> v -> ball")
    m.signal(h=hb.Integral("v.f"))
    m.machine("w", states={"low": [], "high": []}, start="low", rules=["low -> high when h >= top"])
    return m


def test_a_ceiling_that_is_only_touched() -> None:
    s = hb.sensitivities(thrown(5.0), "2 s", wrt=["v0"], of=["v.f"], times=[0.5])
    assert s.ends == pytest.approx(1.0, abs=1e-3)
    assert "grazing" in s.why and "h >= top" in s.why
    assert s.at(0.5, "v.f", "v0") == pytest.approx(1.0, rel=1e-12)
    assert s.events[0].by is None and s.t[-1] <= s.ends
    for ask in (lambda: s.final("v.f", "v0"), lambda: s.of_event(1, "v0")):
        with pytest.raises(hb.NumericsError, match="HB-A524") as caught:
            ask()
        assert "grazing" in str(caught.value)
    assert "no derivatives from" in str(s)


def test_a_ceiling_that_is_passed_has_a_derivative() -> None:
    s = hb.sensitivities(thrown(3.2), "1 s", wrt=["v0", "top"], of=["v.f"])
    # 10 t - 5 t^2 = 3.2 at t = 0.4, with 6 m/s
    assert s.events[0].by == pytest.approx([-0.4 / 6, 1 / 6], rel=1e-8)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("law", ["k*sqrt(max(e, 0))", "k*sqrt(abs(e))"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_root_at_its_end_has_no_derivative_and_no_other_warning(law: str, turned: bool) -> None:
    m = hb.Model("tank", domain="hydraulic", parameters={"k": 2e-6})
    m.add(pump=hb.Sf(1e-4), tank=hb.C(4e-6), n=hb.Zero(), hole=hb.R({"f": law}))
    m.bond("pump -> n -> tank", "hole -> n" if turned else "n -> hole")
    s = hb.sensitivities(m, 10.0, wrt=["k"])
    assert s.ends == 0.0 and "no finite slope" in s.why


def two(first: float, second: float) -> hb.Model:
    """Two tanks that fill, each with a valve that opens at a level."""
    m = hb.Model("two", parameters={"a": 1.0, "b": 1.0})
    m.add(p=hb.Sf("a"), q=hb.Sf("b"), c=hb.C(1.0), d=hb.C(1.0), n=hb.Zero(), k=hb.Zero())
    m.add(x=hb.One(), y=hb.One(), r=hb.R(1.0), s=hb.R(1.0))
    m.bond("p -> n -> c", "q -> k -> d", "n -> x -> r", "k -> y -> s")
    m.machine("A", states={"shut": [], "open": ["x"]}, start="shut",
              rules=[f"shut -> open when c.e > {first}"])  # fmt: skip
    m.machine("B", states={"shut": [], "open": ["y"]}, start="shut",
              rules=[f"shut -> open when d.e > {second}"])  # fmt: skip
    return m


def test_two_events_at_one_instant_have_no_order() -> None:
    s = hb.sensitivities(two(1.0, 1.0), "2 s", wrt=["a", "b"], of=["c.e"])
    assert s.ends == pytest.approx(1.0) and "one instant" in s.why
    apart = hb.sensitivities(two(1.0, 1.1), "2 s", wrt=["a", "b"], of=["c.e", "d.e"])
    assert [e.by.tolist() for e in apart.events if e.by is not None] == [
        pytest.approx([-1.0, 0.0], abs=1e-10),
        pytest.approx([0.0, -1.1], abs=1e-10),
    ]
    # behind the valve: e' = a - e; e = a + (1 - a) exp(-(t - 1/a))
    assert apart.final("c.e", "a") == pytest.approx(1 - np.exp(-1.0), rel=1e-8)


def test_what_is_not_followed_is_refused() -> None:
    m = two(1.0, 2.0)
    with pytest.raises(hb.UsageError, match="HB-A520") as caught:
        hb.sensitivities(m, "1 s", wrt=["c.D"])
    assert "c.C" in str(caught.value)
    with pytest.raises(hb.UsageError, match="HB-S109"):
        hb.sensitivities(m, "1 s", wrt=["a"], of=["nothing.e"])
    late = "c.e*(if time > 0.2 [s] then 1 else 0)"
    with pytest.raises(hb.UsageError, match="HB-S109") as caught:
        hb.gradient(m, hb.Total(late), "1 s", wrt=["a"])
    assert "make it a signal" in str(caught.value)
    s = hb.sensitivities(m, "0.5 s", wrt=["a"])
    for ask in (lambda: s["c.e"], lambda: s["c.q", "b"], lambda: s.at(0.123, "c.q", "a")):
        with pytest.raises(hb.UsageError, match="HB-A523"):
            ask()
    bent = hb.Model("bent")
    bent.add(c=hb.C({"e": "q^3"}, q=1.0), r=hb.R(1.0))
    bent.bond("c -> r")
    with pytest.raises(hb.EquationError, match="HB-A521"):
        hb.sensitivities(bent, "1 s", wrt=["c.C"])
    held = hb.load("examples/planar_puck.toml")
    name = next(k for k, v in held.flatten().parameters.items() if isinstance(v, float))
    with pytest.raises(hb.EquationError, match="HB-A522"):
        hb.sensitivities(held, "1 s", wrt=[name])


def test_an_edge_at_the_very_end_has_two_sides() -> None:
    m = hb.Model("pulses", parameters={"f": 10.0})
    m.input(u=hb.Input(pwm={"period": "1/f", "duty": 0.5}))
    m.signal(x=hb.Integral("u"))
    m.add(s=hb.Se(1.0), r=hb.R(1.0))
    m.bond("s -> r")
    s = hb.sensitivities(m, 0.5, wrt=["f"], of=["x"], times=[0.42])
    assert s.ends == pytest.approx(0.5) and "very end" in s.why
    # at 0.42, in the fifth pulse since 0.4: x = 4 d/f + (t - 4/f), d = 1/2
    assert s.at(0.42, "x", "f") == pytest.approx(-4 * 0.5 / 100 + 4 / 100, rel=1e-9)


def test_a_start_on_the_edge_of_a_diode_is_said() -> None:
    m = hb.Model("stroke", domain="electrical", parameters={"R": "1 ohm"})
    m.add(V=hb.Se("1 V"), d=hb.One(law="diode"), coil=hb.I("1 H", p="0 V*s"), r=hb.R("R"))
    m.bond("V -> d -> coil", "d -> r")
    s = hb.sensitivities(m, "1 s", wrt=["coil.p", "R"], of=["coil.p"])
    # more flux stays, less than none is none: to that side the derivative is another one
    assert len(s.notes) == 1 and "by coil.p perhaps to one side" in s.notes[0]
    assert s.final("coil.p", "coil.p") == pytest.approx(np.exp(-1.0), rel=1e-9)


def test_shares_that_a_mode_leaves_open_have_no_derivative() -> None:
    m = hb.Model("two paths", domain="electrical", parameters={"V": "1 V"})
    m.add(source=hb.Se("V"), r=hb.R("1 ohm"), c=hb.C("1 F"), j=hb.One(), n=hb.Zero(), k=hb.Zero())
    m.add(a=hb.One(), b=hb.One())
    m.bond("source -> j -> n", "j -> r", "n -> a -> k", "n -> b -> k", "k -> c")
    s = hb.sensitivities(m, "1 s", wrt=["V"], of=["a.f"])
    assert s.ends == 0.0 and "shared" in s.why
    whole = hb.sensitivities(m, "1 s", wrt=["V"], of=["c.e"])
    assert whole.final("c.e", "V") == pytest.approx(1 - np.exp(-1.0), rel=1e-9)


@pytest.mark.parametrize(
    "guard",
    ["C.e < 0", "C.e*C.e*C.e < 0", "C.e^3 < 0", "C.e*abs(C.e) < 0", "0 >= abs(C.e)", "C.e*D.e < 0"],
)
def test_derivatives_go_on_where_a_product_crosses_zero_by_its_factors(guard: str) -> None:
    """A cube is flat there: it was taken for a guard that is only touched."""
    m = hb.Model("flat", parameters={"u": 1.0})
    m.add(C=hb.C(1.0, q=1.0), R=hb.R(1.0), S=hb.Sf("-u"), n=hb.Zero())
    m.add(D=hb.C(1.0, q=0.0), s=hb.Sf('if r.state == "up" then 1 else 0'), k=hb.Zero())
    m.bond("n -> C", "n -> R", "S -> n", "s -> k -> D")
    m.machine("r", states={"up": [], "down": []}, start="up", rules=[f"up -> down when {guard}"])
    found = hb.sensitivities(m, 1.0, wrt=["u"], of=["D.q"])
    # C.e = (1 + u) exp(-t) - u is zero at log((1 + u)/u)
    assert found.ends is None
    assert found.final("D.q", "u") == pytest.approx(1.0 / 2.0 - 1.0, rel=1e-9)
