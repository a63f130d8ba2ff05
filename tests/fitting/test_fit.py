"""Fits against the values that data were made with, and against SciPy's own covariance."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq, curve_fit

import hybond as hb

TRUE = {"pad.C": 1.3e-3, "damper.G": 6.0}


def dropped() -> dict[str, np.ndarray]:
    """Return the ball's height and velocity by closed forms of flight and contact, with noise.

    Flight: v' = -g. In contact: m v' = F - m g, q' = -v, with the force F = q/C - v/G of the pad
    and the damper, until it would pull: linear, by the matrix exponential.
    """
    C, G, g = TRUE["pad.C"], TRUE["damper.G"], 9.81
    t = np.linspace(0.0, 1.5, 151)[1:]
    hit = np.sqrt(2 * 3.0 / g)
    A = np.array([[-1 / G, 1 / C, 0, -g], [-1.0, 0, 0, 0], [1.0, 0, 0, 0], [0, 0, 0, 0]])
    enter = np.array([-g * hit, 0.0, 0.0, 1.0])

    def force(s: float) -> float:
        v, q, _, _ = expm(A * s) @ enter
        return float(q / C - v / G)

    low = brentq(force, 0.05, 0.15, xtol=1e-14)
    leave = expm(A * low) @ enter
    v, h = np.empty_like(t), np.empty_like(t)
    for i, at in enumerate(t):
        if at < hit:
            v[i], h[i] = -g * at, 3.0 - g * at**2 / 2
        elif at < hit + low:
            v[i], _, h[i], _ = expm(A * (at - hit)) @ enter
        else:
            s = at - hit - low
            v[i], h[i] = leave[0] - g * s, leave[2] + leave[0] * s - g * s**2 / 2
    random = np.random.default_rng(3)
    return {
        "time": t,
        "height": h + random.normal(0.0, 0.01, len(t)),
        "v.f": v + random.normal(0.0, 0.05, len(t)),
    }


@pytest.mark.slow
def test_the_contact_of_a_ball_is_found_within_its_interval(tmp_path: Path) -> None:
    m = hb.load("examples/bouncing_ball.toml")
    found = hb.fit(m, dropped(), free=list(TRUE), log=["pad.C"])
    assert found.converged and found.measurements == 300
    for k, name in enumerate(TRUE):
        assert found.low[k] < TRUE[name] < found.high[k]
        assert found.high[k] - found.low[k] < 0.25 * TRUE[name]
    assert found.residual == pytest.approx({"height": 0.01, "v.f": 0.05}, rel=0.1)
    assert found.trials < 20 and "pad.C" in str(found)
    run = hb.simulate(m, "1.5 s", parameters=found.parameters)
    assert run["v.f"].at(1.0) == pytest.approx(found.runs[0]["v.f"].at(1.0), rel=1e-9)
    found.plot(tmp_path / "fit.svg")
    assert (tmp_path / "fit.svg").read_text().count("<use") > 300


def discharge(R: float = 1.0) -> hb.Model:
    m = hb.Model("rc", parameters={"R": R, "e0": 1.0})
    m.add(c=hb.C(1.0, e="e0"), r=hb.R("R"), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    return m


T = np.linspace(0.1, 6.0, 40)
NOISE = np.random.default_rng(1).normal(0.0, 0.02, len(T))


def test_intervals_are_those_of_a_fit_of_the_closed_form() -> None:
    y = 3.0 * np.exp(-T / 2.0) + NOISE
    found = hb.fit(discharge(), {"t": T, "c.e": y}, free=["R", "e0"])
    best, covariance = curve_fit(
        lambda t, R, e: e * np.exp(-t / R), T, y, p0=[1, 1], xtol=1e-12, ftol=1e-12
    )
    assert found.values == pytest.approx(best, rel=1e-6)
    half = 2.0243941639 * np.sqrt(np.diag(covariance))  # Student's t, 38 degrees of freedom
    assert found.high - best == pytest.approx(half, rel=1e-4)
    assert found.correlation[0, 1] == pytest.approx(
        covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1]), rel=1e-4
    )
    known = hb.fit(discharge(), {"t": T, "c.e": y}, free=["R", "e0"], sigma={"c.e": 0.5})
    _, own = curve_fit(
        lambda t, R, e: e * np.exp(-t / R), T, y, p0=[1, 1], sigma=0.5 * np.ones(40),
        absolute_sigma=True,
    )  # fmt: skip
    assert known.high - best == pytest.approx(2.0243941639 * np.sqrt(np.diag(own)), rel=1e-4)


def test_several_files_each_with_its_own_start(tmp_path: Path) -> None:
    paths = []
    for k, start in enumerate((1.0, 3.0)):
        path = tmp_path / f"run{k}.csv"
        y = start * np.exp(-T / 2.0)
        lines = ["t [ms], c.e"]
        lines += [f"{1e3 * a!r},{b!r}" for a, b in zip(T.tolist(), y.tolist())]
        lines[5] = lines[5].partition(",")[0] + ","  # a cell without a measurement
        path.write_text("\n".join(lines), encoding="utf-8")
        paths.append((path, {"e0": start}))
    found = hb.fit(discharge(), paths, free=["R"], bounds={"R": (0.5, None)})
    assert found["R"] == pytest.approx(2.0, rel=1e-6)
    assert found.measurements == 78 and len(found.runs) == 2


def test_what_is_far_out_counts_less() -> None:
    y = np.exp(-T / 2.0) + NOISE
    y[[3, 12, 25]] += 2.0
    plain = hb.fit(discharge(), {"t": T, "c.e": y}, free=["R"])
    robust = hb.fit(
        discharge(), {"t": T, "c.e": y}, free=["R"], loss="soft_l1", sigma={"c.e": 0.02}
    )
    assert abs(robust["R"] - 2.0) < 0.1 < abs(plain["R"] - 2.0)


def test_trials_with_other_numbers_of_events() -> None:
    """A tank with a valve that the start never opens, and the data do."""
    m = hb.Model("tank", parameters={"inflow": 0.4, "level": 1.0})
    m.add(s=hb.Sf("inflow"), c=hb.C(1.0), n=hb.Zero(), j=hb.One(), r=hb.R(1.0))
    m.bond("s -> n -> c", "n -> j -> r")
    m.machine("valve", states={"shut": [], "open": ["j"]}, start="shut",
              rules=["shut -> open when c.e > level"])  # fmt: skip
    t = np.linspace(0.1, 2.0, 20)
    late = np.maximum(t - 1.0 / 0.9, 0.0)
    y = np.where(t < 1.0 / 0.9, 0.9 * t, 0.9 + 0.1 * np.exp(-late))
    found = hb.fit(m, {"t": t, "c.e": y}, free=["inflow"])
    assert len(found.runs[0].trace.events) == 2
    assert found["inflow"] == pytest.approx(0.9, rel=1e-6)


def test_what_the_data_do_not_tell_has_no_interval() -> None:
    m = discharge()
    m.parameter(other=1.0)
    m.add(d=hb.C(1.0, e=1.0), k=hb.R("other"))
    m.bond("d -> k")
    found = hb.fit(m, {"t": T, "c.e": np.exp(-T / 2.0) + NOISE}, free=["R", "other"])
    assert np.isinf(found.high[1]) and np.isfinite(found.high[0])
    assert "do not tell other" in str(found)


def test_refusals(tmp_path: Path) -> None:
    m, good = discharge(), {"t": T, "c.e": np.exp(-T)}

    def refused(code: str, data: object = good, **options: object) -> None:
        given = {"free": ["R"], **options}
        with pytest.raises(hb.HybondError, match=code):
            hb.fit(m, data, **given)  # type: ignore[arg-type]

    refused("HB-A520", free=["Q"])
    refused("HB-A532", bounds={"Q": (0, 1)})
    refused("HB-A532", bounds={"R": (2.0, 3.0)})
    refused("HB-A532", bounds={"R": (0.0, "1 furlong")})
    refused("HB-A532", loss="square")
    refused("HB-A532", sigma={"c.e": 0.0})
    refused("HB-A532", {"t": [1.0], "c.e": [1.0]}, free=["R", "e0"])
    rooted = hb.Model("rooted", parameters={"a": -1.0})
    rooted.add(c=hb.C(1.0, e=1.0), r=hb.R({"e": "f*sqrt(a + 0*f)"}))
    rooted.bond("c -> r")
    with pytest.raises(hb.NumericsError, match="HB-A533"):
        hb.fit(rooted, good, free=["a"])
    refused("HB-S109", {"t": T, "q.e": T})
    for bad in (7, {"c.e": T}, {"t": T}, {"t": T[::-1], "c.e": T}, {"t": T, "c.e": T[1:]}):
        refused("HB-A530", bad)
    for text in ("t,c.e\n1,x", "t,c.e\n1", "t,t\n1,1", "t [yd3],c.e\n1,1", "", "t,c.e\n1,inf"):
        path = tmp_path / "bad.csv"
        path.write_text(text, encoding="utf-8")
        refused("HB-A530", path)
    refused("HB-A530", tmp_path / "none.csv")
    refused("HB-A530", {"t [mm]": [1.0, 2.0], "c.e": [1.0, 1.0]})


def test_data_in_a_unit_of_something_else_are_refused() -> None:
    """It was a factor without a word."""
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    with pytest.raises(hb.UsageError, match="is measured in m, and is in V"):
        hb.fit(m, {"t": [0.5, 1.0], "c.e [m]": [6.0, 3.6]}, free=["r.R"])
    found = hb.fit(m, {"t": [0.5, 1.0], "c.e [mV]": [6e3, 3.6e3]}, free=["r.R"])
    assert 900.0 < found["r.R"] < 1100.0


def test_a_resistor_is_matched_to_its_source() -> None:
    m = hb.Model("load", parameters={"R": 0.5})
    m.add(V=hb.Se(1.0), own=hb.R(2.0), load=hb.R("R"), j=hb.One())
    m.bond("V -> j -> own", "j -> load")
    goal = hb.Total("-load.e*load.f")
    found = hb.optimise(m, goal, free=["R"], until=1.0, log=["R"])
    assert found["R"] == pytest.approx(2.0, rel=1e-5) and found.value == pytest.approx(-0.125)
    held = hb.optimise(m, goal, free=["R"], until=1.0, bounds={"R": (0.1, 1.5)})
    assert held["R"] == pytest.approx(1.5) and held.at_bound == ("R",)
    # d/dR of -R/(2 + R)^2
    assert held.slopes == pytest.approx([-(2.0 - 1.5) / 3.5**3], rel=1e-7)


def test_a_throw_that_returns_latest() -> None:
    """Up at an angle with a given speed: it flies longest straight up; the event's own adjoint."""
    m = hb.Model("throw", parameters={"turn": 0.6})
    m.add(w=hb.Se(-10.0), up=hb.I(1.0, f="20*sin(turn)"), v=hb.One())
    m.bond("w -> v -> up")
    m.signal(h=hb.Integral("v.f"))
    m.machine("s", states={"air": [], "down": []}, start="air",
              rules=["air -> down when h < 0"])  # fmt: skip
    found = hb.optimise(m, hb.Final("-h"), free=["turn"], until=1.0, bounds={"turn": (0.1, 3.0)})
    assert found["turn"] == pytest.approx(np.pi / 2, abs=1e-6)
    g = hb.gradient(m, hb.EventTime(1), "5 s", wrt=["turn"])
    assert g.by == pytest.approx([4.0 * np.cos(0.6)], rel=1e-9)


@pytest.mark.slow
def test_duty_and_coil_of_a_converter() -> None:
    m = hb.Model("buck", domain="electrical", parameters={"D": 0.3, "L": "20 uH"})
    m.input(gate=hb.Input(pwm={"period": "10 us", "duty": "D"}))
    m.add(V=hb.Se("(12 V)*gate"), coil=hb.I("L"), cap=hb.C("10 uF"), load=hb.R("2 ohm"))
    m.add(j=hb.One(), n=hb.Zero())
    m.bond("V -> j -> coil", "j -> n -> cap", "n -> load")
    periods, T = 20, 1e-5
    wanted = {"time": [periods * T], "coil.f": [2.2], "cap.e": [5.0]}
    found = hb.fit(m, wanted, free=["D", "L"], log=["L"], sigma={"coil.f": 1.0, "cap.e": 1.0})
    # the same period after period, by the exponentials of both halves
    D, L = found["D"], found["L"]
    off = np.array([[0.0, -1 / L, 0.0], [1e5, -5e4, 0.0], [0.0, 0.0, 0.0]])
    on = off + np.array([[0.0, 0.0, 12.0 / L], [0.0] * 3, [0.0] * 3])
    once = expm(off * (1 - D) * T) @ expm(on * D * T)
    end = np.linalg.matrix_power(once, periods) @ [0.0, 0.0, 1.0]
    assert end[:2] == pytest.approx([2.2, 5.0], rel=1e-6)
    assert found.trials < 15


def test_what_only_rounding_tells_has_no_interval() -> None:
    """Of a free fall the mass is not told, whatever digits its slopes have."""
    m = hb.Model("drop", domain="translational", parameters={"m": "1 kg", "g": "9 m/s^2"})
    m.add(weight=hb.Se("-m*g"), ball=hb.I("m"), v=hb.One())
    m.bond("weight -> v -> ball")
    m.signal(h=hb.Integral("v.f", start="10 m"))
    t = np.linspace(0.1, 1.0, 10)
    found = hb.fit(m, {"time": t, "h": 10.0 - 0.5 * 9.81 * t**2}, free=["m", "g"])
    assert found["g"] == pytest.approx(9.81, rel=1e-9)
    assert any("do not tell m" in note for note in found.notes) and found.high[0] == np.inf


def filled(law: str) -> hb.Model:
    m = hb.Model("filled", domain="hydraulic", parameters={"k": 2e-6, "q": 1e-4})
    m.add(pump=hb.Sf("q"), tank=hb.C(4e-6), n=hb.Zero(), hole=hb.R({"f": law}))
    m.bond("pump -> n -> tank", "n -> hole")
    return m


@pytest.mark.parametrize("free", ["k", "q"])
@pytest.mark.parametrize("law", ["k*sign(e)*sqrt(abs(e))", "k*sqrt(max(e, 0))"])
def test_a_fit_without_a_slope_has_not_converged_and_says_why(law: str, free: str) -> None:
    data = {"time": [1.0, 5.0, 9.0], "tank.e": [20.0, 80.0, 130.0]}
    found = hb.fit(filled(law), data, free=[free])
    assert not found.converged
    assert "no measurement has a slope: at t = 0 s a law has no finite slope here" in str(found)
    assert str(found).count("converged") == 1


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("law", "power"), [("k*e", 1.0), ("k*sign(e)*sqrt(abs(e))", 0.5), ("k*e^3", 3.0)]
)
def test_a_fit_of_which_nothing_measured_changes_has_not_converged(law: str, power: float) -> None:
    # a tank behind a valve that opens after what is measured, and before it
    m = hb.Model("late", parameters={"k": 0.02})
    m.add(tank=hb.C(1.0, e=1.0), n=hb.Zero(), v=hb.One(), hole=hb.R({"f": law}))
    m.bond("n -> tank", "n -> v -> hole")
    m.machine("V", states={"shut": [], "open": ["v"]}, start="shut",
              rules=["shut -> open when time >= 5"])  # fmt: skip
    found = hb.fit(m, {"time": [1.0, 2.0, 3.0], "tank.e": [0.9, 0.9, 0.8]}, free=["k"])
    assert not found.converged
    assert "not converged: no measurement changes with k" in str(found)
    k = 0.1
    level = math.exp(-k) if power == 1.0 else (1 - (1 - power) * k) ** (1 / (1 - power))
    told = hb.fit(m, {"time": [1.0, 6.0], "tank.e": [1.0, level]}, free=["k"])
    assert told.converged and told["k"] == pytest.approx(k, rel=1e-6)


def test_a_fit_of_which_some_measurements_have_a_slope_says_where_slopes_end() -> None:
    # a tank that fills from 1 s on, when its orifice opens, which has an infinite slope there
    m = hb.Model("late", parameters={"k": 2.0, "q": 1.0})
    m.add(pump=hb.Sf("if time < 1 then 0*q else q"), tank=hb.C(1.0), n=hb.Zero(), v=hb.One())
    m.add(hole=hb.R({"f": "k*sign(e)*sqrt(abs(e))"}), c=hb.C(1.0, e=1.0), r=hb.R("q"), j=hb.Zero())
    m.bond("pump -> n -> tank", "n -> v -> hole", "j -> c", "j -> r")
    m.machine("V", states={"shut": [], "open": ["v"]}, start="shut",
              rules=["shut -> open when time >= 1"])  # fmt: skip
    t = np.array([0.25, 0.5, 1.5])
    found = hb.fit(m, {"time": t, "c.e": np.exp(-t)}, free=["q"])
    assert "1 measurement without a slope: derivatives end before: at t = 1 s" in str(found)
    assert "a law has no finite slope here" in str(found) and found.converged
