"""Orbits that are one of many, pairs that nothing damps, and what a period loses."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import ellipk

import hybond as hb


def pendulum(angle: float) -> hb.Model:
    m = hb.Model("pendulum")
    m.add(a=hb.C({"e": "sin(q)"}, q=angle), b=hb.I(1.0), j=hb.One())
    m.bond("j -> a", "j -> b")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("angle", "settle"), [(0.5, 30), (2.0, 400), (3.0, 40)])
def test_a_pendulum_swings_as_it_was_let_go_and_nothing_brings_others_there(
    angle: float, settle: float
) -> None:
    orbit = hb.periodic(pendulum(angle), settle=settle)
    assert orbit["a.q"].max() == pytest.approx(angle, rel=1e-7)
    assert orbit.period == pytest.approx(4 * ellipk(np.sin(angle / 2) ** 2), rel=1e-6)
    assert orbit.neutral and not orbit.stable and orbit.free == ("a.q, b.p",)
    assert orbit.values.tolist() == [1.0, 1.0]
    assert "one of a family" in str(orbit) and "a centre" not in str(orbit)
    assert orbit.to_data()["neutral"] is True


def test_hunters_and_hunted_keep_their_own_conserved_quantity() -> None:
    m = hb.Model("lotka_volterra")
    m.signal(x=hb.Integral("x*(1 - y)/(1 s)", start=2.0), y=hb.Integral("y*(x - 1)/(1 s)", start=1))
    orbit = hb.periodic(m, settle=40.0)
    level = 2.0 - np.log(2.0) + 1.0  # x - ln x + y - ln y, at the start

    def least(x: float) -> float:
        return float(x - np.log(x) + 1.0 - level)

    assert orbit["x"].min() == pytest.approx(brentq(least, 0.1, 0.9, xtol=1e-13), rel=1e-7)
    assert orbit["y"].mean() == pytest.approx(1.0, rel=1e-8)  # Volterra's law of means
    assert orbit.neutral and orbit.free


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("settle", "guess"), [(6.5, None), (30, None), (1000, None), (30, "3 s")])
def test_a_linear_circuit_without_losses_is_a_centre(settle: float, guess: str | None) -> None:
    m = hb.Model("lc", domain="electrical")
    m.add(L=hb.I("1 H"), C=hb.C("0.25 F", e="1 V"), j=hb.One())
    m.bond("j -> L", "j -> C")
    orbit = hb.periodic(m, guess, settle=settle)
    assert orbit.period == pytest.approx(np.pi, rel=1e-9)
    assert orbit["C.e"].max() == pytest.approx(1.0, rel=1e-9)
    assert (
        orbit.neutral and "a centre: all others near it repeat with the same period" in orbit.notes
    )


def driven(resistor: str = "", w: float = 2.6) -> hb.Model:
    m = hb.Model("driven", domain="electrical", parameters={"w": f"{w} rad/s"})
    m.add(V=hb.Se("1 V*cos(w*time)"), L=hb.I("1 H"), C=hb.C("1 F"), j=hb.One())
    m.bond("V -> j -> L", "j -> C")
    if resistor:
        m.add(r=hb.R({"e": resistor}))
        m.bond("j -> r")
    return m


@pytest.mark.parametrize("w", [2.6, 2.0, 0.7])
def test_a_driven_circuit_without_losses_is_neutral_at_all_frequencies(w: float) -> None:
    orbit = hb.periodic(driven(w=w))
    own = np.exp(2j * np.pi / w * np.array([1, -1]))
    assert np.sort_complex(orbit.values) == pytest.approx(np.sort_complex(own), abs=1e-9)
    assert [m.kind for m in orbit.multipliers] == ["neutral", "neutral"]
    assert orbit.neutral and not orbit.stable and "nothing damps" in str(orbit)
    assert float(orbit["C.e"].max()) == pytest.approx(1 / abs(1 - w * w), rel=1e-7)


def test_losses_and_gains_that_are_equal_over_a_period_are_no_reason() -> None:
    """det M = exp(-integral of R/L) = 1, and yet something takes and gives."""
    orbit = hb.periodic(driven("(0.3 [ohm])*sin(w*time)*f"))
    assert np.abs(orbit.values) == pytest.approx([1.0, 1.0], abs=1e-8)
    assert [m.kind for m in orbit.multipliers] == ["Neimark-Sacker"] * 2
    assert orbit.neutral and "at a Neimark-Sacker" in str(orbit)


def test_what_dies_out_fast_is_not_lost() -> None:
    T, R, C = 1e-3, 1.0, 1e-3 / 94.0
    m = hb.Model("pump", domain="electrical")
    m.input(u=hb.Input(pwm={"period": "1 ms", "duty": 0.5}))
    m.add(V=hb.Se("5 V*u"), R=hb.R("1 ohm"), C=hb.C(C), j=hb.One(), n=hb.Zero())
    m.bond("V -> j -> R", "j -> n -> C")
    orbit = hb.periodic(m)
    assert orbit.lost == 0 and orbit.values == pytest.approx([np.exp(-94.0)], rel=1e-8)
    m.add(K=hb.C("100 uF"), way=hb.R("100 ohm"), k=hb.One())
    m.bond("n -> k -> way", "k -> K")
    orbit = hb.periodic(m)
    A = np.array([[-1 / (R * C) - 0.01 / C, 0.01 / 100e-6], [0.01 / C, -0.01 / 100e-6]])
    assert orbit.values[0] == pytest.approx(np.linalg.eigvals(expm(A * T)).real.max(), rel=1e-8)
    assert [x.kind for x in orbit.multipliers] == ["", "fast"] and orbit.lost == 0
    assert "too small to be told" in str(orbit)


def shaker(amplitude: str, w: str, restitution: float) -> hb.Model:
    values = {"m": "2 kg", "g": "9.81 m/s^2", "A": amplitude, "w": w, "e": restitution}
    m = hb.Model("shaker", domain="translational", parameters=values)
    m.add(weight=hb.Se("-m*g"), ball=hb.I("m"), v=hb.One(), table=hb.Sf("-A*w*sin(w*time)"))
    m.add(floor=hb.Zero(law="unilateral", gap="h - A*cos(w*time)", restitution="e"))
    m.bond("weight -> v -> ball", "table -> floor -> v")
    m.signal(h=hb.Integral("v.f", start="30 mm"))
    return m


@pytest.mark.parametrize(
    ("amplitude", "w", "restitution"),
    [("4 mm", "20 rad/s", 0.3), ("5 mm", "60 rad/s", 0.2), ("4 mm", "60 rad/s", 0.0)],
)
def test_a_ball_that_rests_on_a_shaker_loses_both_directions(
    amplitude: str, w: str, restitution: float
) -> None:
    """It rides all the time (A w^2 < g), or is thrown up and comes to rest before it is again."""
    orbit = hb.periodic(shaker(amplitude, w, restitution), settle=40 * np.pi / float(w.split()[0]),
                        wrt=["A"])  # fmt: skip
    assert orbit.lost == 2 and orbit.stable and orbit.free == ()
    assert orbit.values.tolist() == [0.0, 0.0]
    if restitution == 0.3:  # on the table: h = A when the period begins
        assert orbit.state.signals["h"] == pytest.approx(4e-3, rel=1e-9)
        assert orbit.derivative("h", "A") == pytest.approx(1.0, rel=1e-9)
        assert orbit.derivative("ball.p", "A") == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
def test_where_a_ball_has_landed_on_a_shaker_the_table_alone_says_how_it_is_varied() -> None:
    """h = A cos(w t), p = -2 m A w sin(w t): also where rounding ends the last flight, not the gap.

    Which of the eleven landings end so is a matter of last digits; of the others the way to the
    limit of impacts is the table's as well, as far as it is extrapolated.
    """
    w = 50.0
    times = (0.2995 + 2.0 * np.pi / w * np.arange(11)).tolist()
    found = hb.sensitivities(shaker("5 mm", f"{w} rad/s", 0.2), 1.6, wrt=["A", "e"], times=times)
    landings = [e for e in found.run.events if e.steps[-1].mode == (1,) and e.cause != "start"]
    for t in times:
        (last,) = [e for e in landings if e.t < t][-1:]
        close = 1e-12 if last.cause == "guard" else 1e-7
        assert found.at(t, "h", "A") == pytest.approx(np.cos(w * t), abs=close)
        assert found.at(t, "h", "e") == pytest.approx(0.0, abs=1e-20 if close < 1e-9 else 1e-9)
        assert found.at(t, "ball.p", "A") == pytest.approx(-2.0 * w * np.sin(w * t), abs=1e-9)


def test_clocks_that_nothing_ties_together_are_told_from_what_runs_away() -> None:
    """Up and down between -1 and 1 in 4 s, beside a clock of 1.1 s."""
    m = hb.Model("clocks", domain="electrical")
    m.input(u=hb.Input(pwm={"period": "1.1 s", "duty": 0.5}))
    m.add(V=hb.Se("1 V*u"), R=hb.R("1 ohm"), C=hb.C("1 F"), j=hb.One())
    m.bond("V -> j -> R", "j -> C")
    m.signal(x=hb.Integral('(if s.state == "up" then 1 else -1)/(1 s)', start=0.3))
    rules = ["up -> down when x > 1", "down -> up when x < -1"]
    m.machine("s", states={"up": [], "down": []}, start="up", rules=rules)
    with pytest.raises(hb.NumericsError, match="has a rhythm of its own") as error:
        hb.periodic(m)
    assert error.value.code == "HB-A540" and "couple the two" in error.value.hint


@pytest.mark.slow
def test_a_family_is_not_followed_and_a_pair_that_nothing_damps_crosses_nothing() -> None:
    m = hb.Model("pendulum", parameters={"k": 1.0})
    m.add(a=hb.C({"e": "k*sin(q)"}, q=1.0), b=hb.I(1.0), j=hb.One())
    m.bond("j -> a", "j -> b")
    with pytest.raises(hb.NumericsError, match=r"one of a family, by a\.q, b\.p") as error:
        hb.continuation(m, "k", (1.0, 2.0), settle=30.0)
    assert error.value.code == "HB-A542" and error.value.partial is not None
    found = hb.continuation(driven(), "L.I", ("1 H", "2 H"), points=3)
    assert found.special == () and found.branches[0].ended == "the range ends"
    assert all(p.neutral for p in found.branches[0].points)
