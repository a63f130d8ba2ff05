"""Goals of runs: the adjoint against the forward way, and against closed forms."""

import numpy as np
import pytest

import hybond as hb

WRT = ["m", "g", "pad.C", "damper.G", "height.start"]
GOALS = [
    hb.Final("v.f*ball.p"),
    hb.Total("m*height^2"),
    hb.EventTime(3),
    hb.EventTime(2, "floor"),
]


@pytest.mark.parametrize("goal", GOALS, ids=str)
def test_the_adjoint_gives_what_the_forward_way_gives(goal: hb.Final) -> None:
    m = hb.load("examples/bouncing_ball.toml")
    both = [hb.gradient(m, goal, "2.6 s", wrt=WRT, mode=mode) for mode in ("adjoint", "forward")]
    assert both[0].by == pytest.approx(both[1].by, rel=1e-9)
    assert np.abs(both[0].by).min() > 1e-6


def test_the_energy_that_a_resistor_takes() -> None:
    """C e^2/2 (1 - exp(-2 T/(R C))), with a switch on the way that does not matter."""
    m = hb.Model("rc", parameters={"R": "2 ohm", "C": "0.5 F"}, domain="electrical")
    m.add(c=hb.C("C", e="3 V"), r=hb.R("R"), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    m.machine("s", states={"a": [], "b": []}, start="a", rules=["a -> b when c.e < 1 [V]"])
    T, R, C, e = 1.7, 2.0, 0.5, 3.0
    g = hb.gradient(m, hb.Total("r.e*r.f"), T, wrt=["R", "C", "c.e"])
    x = np.exp(-2 * T / (R * C))
    by_r = -C * e**2 / 2 * x * 2 * T / (R**2 * C)
    by_c = e**2 / 2 * (1 - x) - C * e**2 / 2 * x * 2 * T / (R * C**2)
    assert g.value == pytest.approx(C * e**2 / 2 * (1 - x), rel=1e-9)
    assert g.by == pytest.approx([by_r, by_c, C * e * (1 - x)], rel=1e-8)
    assert g.units[2] == "C" or "V" in g.units[2]
    assert "by R" in str(g)


def test_the_way_of_a_ball_is_the_integral_of_its_velocity() -> None:
    """Through impacts at which the integrand jumps."""
    m = hb.Model("ball", domain="translational", parameters={"eps": 0.7, "h": "5 m"})
    m.add(weight=hb.Se("-10 N"), ball=hb.I("1 kg"), v=hb.One())
    m.add(floor=hb.Zero(law="unilateral", gap="x", restitution="eps"))
    m.bond("weight -> v -> ball", "floor -> v")
    m.signal(x=hb.Integral("v.f", start="h"))
    way = hb.gradient(m, hb.Total("v.f"), "2.9 s", wrt=["eps", "h"])
    place = hb.gradient(m, hb.Final("x"), "2.9 s", wrt=["eps", "h"], mode="forward")
    assert way.by == pytest.approx(place.by - [0.0, 1.0], rel=1e-9)
    # the second impact is at T (1 + 2 eps) = 2.4: x = eps^2 v s - 5 s^2 after it
    eps, s, v = 0.7, 0.5, 10.0
    assert place["eps"] == pytest.approx(2 * eps * v * s + (eps**2 * v - 10 * s) * -2.0, rel=1e-8)


def test_goals_that_a_run_does_not_have() -> None:
    m = hb.load("examples/bouncing_ball.toml")
    for goal in (hb.EventTime(9), hb.EventTime(0), hb.EventTime(1, "roof"), "v.f"):
        with pytest.raises(hb.UsageError, match="HB-A525"):
            hb.gradient(m, goal, "1 s", wrt=["m"])  # type: ignore[arg-type]
    hit = hb.load("examples/bullet_and_wood.toml")
    with pytest.raises(hb.NumericsError, match=r"HB-A524.*impulse"):
        hb.gradient(hit, hb.Total("contact.e"), wrt=["m1"])
