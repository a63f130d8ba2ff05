"""Bifurcation diagrams against maps iterated here, closed forms and published numbers."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples" / "bifurcation"
BUCK = hb.load(EXAMPLES / "current_mode_buck.toml")
STOP = hb.load(EXAMPLES / "impact_oscillator.toml")
A = math.exp(-100e-6 * 4.0 / 0.5e-3)
"""Part of the current's distance to rest that is left after a period."""
ON, OFF = (10.0 - 2.0) / 4.0, 2.0 / 4.0
"""Where the current would come to rest, A, and below zero."""


def slope(top: float) -> float:
    """How much steeper than one the map falls where the switch opens before the next clock."""
    return A * (top + OFF) / (ON - top)


def top_of(steepness: float) -> float:
    """The reference at which the map is so steep."""
    return (steepness * ON - A * OFF) / (A + steepness)


def clocked(i: float, top: float, many: int) -> list[float]:
    """The current at the clock, from one to the next: both halves of a period are exponentials."""
    found = []
    for _ in range(many):
        found.append(i)
        if i >= top:
            i = -OFF + (i + OFF) * A  # it opens at once
        elif ON + (i - ON) * A <= top:
            i = ON + (i - ON) * A
        else:
            # the switch opens after t1, exp(-t1/tau) = (ON - top)/(ON - i)
            i = -OFF + (top + OFF) * A * (ON - i) / (ON - top)
    return found


def test_samples_are_those_of_the_map_of_the_current() -> None:
    tops = [0.6, 1.0, 1.2, 1.3, 1.5, 1.72, 1.78]
    diagram = hb.bifurcation(BUCK, {"Iref": tops}, of="L.f", period="T", settle=60, keep=24)
    found = diagram.branches[0].samples["L.f"]
    for k, top in enumerate(tops):
        assert found[k] == pytest.approx(clocked(0.0, top, 84)[60:], abs=1e-9)
    assert diagram.branches[0].period.tolist() == [1, 1, 1, 2, 2, 3, 3]
    assert diagram.branches[0].sequence[-1] == "on | on | on > off"


def test_each_value_goes_on_from_the_one_before() -> None:
    tops = [0.6, 1.0, 1.3, 1.72]
    for way, order in (("up", tops), ("down", tops[::-1])):
        diagram = hb.bifurcation(
            BUCK, {"Iref": tops}, of="L.f", period="T", settle=5, keep=6, direction=way
        )
        own = dict(zip(tops, diagram.branch(way).samples["L.f"], strict=True))
        i = 0.0
        for top in order:
            orbit = clocked(i, top, 12)
            assert own[top] == pytest.approx(orbit[5:11], abs=1e-9)
            i = orbit[11]


@pytest.mark.slow
def test_windows_end_where_the_map_says() -> None:
    # of a map with slopes A and -b: period 1 to b = 1; period n, n > 1, from
    # b = (1 + A + ... + A^(n-2))/A^(n-2) to b = 1/A^(n-1) (Nusse and Yorke, 1995)
    tops = np.linspace(1.1, 1.86, 20)
    diagram = hb.bifurcation(BUCK, {"Iref": tops}, of="L.f", period="T", settle=120, keep=36)
    one, two, three = diagram.windows(1e-6).periodic()
    assert [w.period for w in (one, two, three)] == [1, 2, 3]
    assert one.high == pytest.approx(top_of(1.0), abs=5e-6)
    assert two.low == pytest.approx(top_of(1.0), abs=5e-6)
    assert two.high == pytest.approx(top_of(1.0 / A), abs=3e-6)
    assert three.low == pytest.approx(top_of((1.0 + A) / A), abs=3e-6)
    assert three.high == pytest.approx(top_of(1.0 / A**2), abs=3e-6)
    assert (one.ends_in, two.ends_in) == ("border collision", "irregular")
    assert two.events == pytest.approx(0.5)


@pytest.mark.slow
def test_the_published_doublings_of_the_voltage_mode_buck() -> None:
    # at 24.516 V and 31.121 V, chaos from 32.34 V on (Fossas and Olivar 1996)
    model = hb.load(EXAMPLES / "voltage_mode_buck.toml")
    supply = [24.46, 24.56, 31.05, 31.17, 32.6, 33.0]
    diagram = hb.bifurcation(
        model, {"Vin": supply}, of="out.e", period="T", direction="up", settle=600, keep=64
    )
    assert diagram.branches[0].period.tolist() == [1, 2, 2, 4, 0, 0]
    first, second, *_ = diagram.windows()
    assert (first.ends_in, second.ends_in) == ("period doubling", "period doubling")


def one_impact(w: float, n: int, r: float, sigma: float = 0.0) -> tuple[float, float]:
    """Speed of the orbit with one impact in n periods, undamped, and 1 + trace + determinant of its
    map: zero where its period doubles."""
    tau, g = 2.0 * math.pi * n / w, 1.0 / (1.0 - w * w)
    k = 0.5 * (1.0 + r) / math.tan(0.5 * tau)
    a = k * k + ((1.0 - r) / (2.0 * w)) ** 2
    b, c = 2.0 * sigma * k, sigma**2 - g * g
    speed = (-b + math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
    force = (sigma + speed * k) / g
    trace = -2.0 * r * math.cos(tau) + math.sin(tau) * (1.0 + r) * (force - sigma) / speed
    return speed, 1.0 + trace + r * r


def test_one_impact_in_n_periods_has_the_speed_of_the_closed_form() -> None:
    for n, w in ((1, 2.5), (2, 3.9)):
        diagram = hb.bifurcation(
            STOP, {"w": [w, w + 0.01]}, of="v.f", at="stop.impact", before=True,
            settle=250, keep=8, limit=6000.0,
        )  # fmt: skip
        speed, _ = one_impact(w, n, 0.8)
        assert diagram.branches[0].samples["v.f"][0] == pytest.approx([speed] * 8, rel=1e-8)
        apart = np.diff(diagram.branches[0].when[0])
        assert apart == pytest.approx([2.0 * math.pi * n / w] * 7, rel=1e-8)


@pytest.mark.slow
def test_a_period_doubles_where_the_map_of_the_impacts_says() -> None:
    w, low, high = 2.64, 0.0, 0.02
    for _ in range(50):
        middle = 0.5 * (low + high)
        stable = one_impact(w, 1, 0.8, middle)[1] > 0.0
        low, high = (middle, high) if stable else (low, middle)
    diagram = hb.bifurcation(
        STOP, {"sigma": [low - 0.004, low + 0.004]}, of="v.f", period="2*pi/w", settle=150, keep=36,
        parameters={"w": w}, direction="up",
    )  # fmt: skip
    first = diagram.windows(5e-5)[0]
    # it settles ever more slowly there
    assert first.high == pytest.approx(low, abs=1.5e-4)
    assert first.ends_in == "period doubling"


@pytest.mark.slow
def test_the_stop_is_grazed_at_the_amplitude_of_the_free_motion() -> None:
    w, zeta = 0.35, 0.05
    graze = 1.0 / math.hypot(1.0 - w * w, 2.0 * zeta * w)
    given = {"w": w, "zeta": zeta, "rest": 0.7}
    diagram = hb.bifurcation(
        STOP, {"sigma": [0.99 * graze, 0.999 * graze, 1.02 * graze]}, of="spring.q",
        period="2*pi/w", direction="down", settle=60, keep=24, parameters=given,
    )  # fmt: skip
    below, free = diagram.windows(1e-8)
    assert free.low == pytest.approx(graze, abs=3e-8)
    assert (below.events, free.events, below.ends_in) == (2.0, 0.0, "grazing")


def test_the_phase_is_carried_on_where_the_period_varies() -> None:
    # no impact: x'' + 2 zeta x' + x = cos(w t), the phase w t going on from one w to the next
    given = {"sigma": 1e3, "zeta": 0.02}
    diagram = hb.bifurcation(
        STOP, {"w": [1.5, 1.75, 2.0]}, of=["spring.q", "v.f"], period="2*pi/w", direction="up",
        settle=0, keep=5, parameters=given, rtol=1e-12,
    )  # fmt: skip
    state = np.zeros(2)
    for k, w in enumerate((1.5, 1.75, 2.0)):
        # states x, v, cos, sin of the phase, which is whole at each sample
        rates = np.array([[0, 1, 0, 0], [-1, -0.04, 1, 0], [0, 0, 0, -w], [0, 0, w, 0]])
        over = expm(rates * 2.0 * math.pi / w)
        for j in range(5):
            assert diagram.branches[0].samples["spring.q"][k, j] == pytest.approx(
                state[0], abs=1e-9
            )
            assert diagram.branches[0].samples["v.f"][k, j] == pytest.approx(state[1], abs=1e-9)
            state = (over @ np.array([*state, 1.0, 0.0]))[:2]


@pytest.mark.slow
def test_the_engine_as_python_and_any_number_of_threads_give_the_same() -> None:
    asked = {"of": ["L.f", "node.e"], "at": "latch.off", "before": True, "settle": 3, "keep": 4}
    values = {"Iref": [1.0, 1.3]}
    for way in ("fresh", "up"):
        one = hb.bifurcation(BUCK, values, **asked, direction=way)
        other = hb.bifurcation(BUCK, values, **asked, direction=way, engine="python")
        assert "ordinary" in other.how and "ordinary" not in one.how
        for name in one.of:
            a, b = one.branches[0].samples[name], other.branches[0].samples[name]
            assert a == pytest.approx(b, rel=1e-13)
        assert one.branches[0].sequence == other.branches[0].sequence
    many = {"Iref": np.linspace(0.5, 1.9, 40)}
    both = [
        hb.bifurcation(BUCK, many, of="L.f", period="T", settle=20, keep=8, workers=n)
        for n in (1, 2)
    ]
    assert (
        both[0].branches[0].samples["L.f"].tobytes() == both[1].branches[0].samples["L.f"].tobytes()
    )


def test_an_interrupt_keeps_what_there_is() -> None:
    def press(done: float, total: int) -> None:
        raise KeyboardInterrupt

    found = hb.bifurcation(
        BUCK, {"Iref": "0.5..1.9:400"}, of="L.f", period="T", settle=20, keep=8, progress=press,
        workers=1,
    )  # fmt: skip
    assert found.interrupted and 0 < (found.branches[0].period > 0).sum() < 400
    assert np.isfinite(found.points()[1]).all()


def test_what_stops_a_run_is_kept_with_its_value() -> None:
    found = hb.bifurcation(
        BUCK, {"Iref": [1.0, 1.3]}, of="L.f", period="T", settle=40, keep=8, max_events=70
    )
    assert {k: e.code for k, e in found.errors.items()} == {("fresh", 0): "HB-N404"}
    assert found.branches[0].period.tolist() == [-1, 2]
    assert [w.name for w in found.windows()] == ["stopped", "period 2"]


def test_it_is_written_and_drawn(tmp_path: Path) -> None:
    found = hb.bifurcation(BUCK, {"Iref": "1..1.4 A:3"}, of="L.f", period="T", settle=60, keep=8)
    found.to_csv(tmp_path / "d.csv")
    rows = (tmp_path / "d.csv").read_text().splitlines()
    assert rows[0] == "Iref,direction,period,t,L.f" and len(rows) == 25
    data = found.to_dict()
    assert data["branches"][0]["periods"] == [1, 1, 2] and data["unit"] == "A"
    found.plot(path=tmp_path / "d.svg")
    drawn = (tmp_path / "d.svg").read_text()
    assert "Iref" in drawn and "once in T" in drawn
    assert repr(found).startswith("<Bifurcation 'Buck") and "period 2" in found._repr_html_()


CALLS = {"of": "L.f", "period": "T"}


@pytest.mark.parametrize(
    ("changed", "code"),
    [
        ({"parameter": {"Iref": 1.0}}, "HB-P131"),
        ({"parameter": {"Iref": "normal(1, 0.1)"}}, "HB-P131"),
        ({"parameter": {"Iref": [1.0, 2.0, 1.5]}}, "HB-P131"),
        ({"parameter": {"Iref": [1.0, 2.0], "Vo": [1.0, 2.0]}}, "HB-P131"),
        ({"direction": "left"}, "HB-P131"),
        ({"keep": 2}, "HB-P131"),
        ({"settle": -1}, "HB-P131"),
        ({"tolerance": 2.0}, "HB-P131"),
        ({"of": []}, "HB-P131"),
        ({"period": None}, "HB-P132"),
        ({"period": "L.f"}, "HB-P132"),
        ({"period": "-T"}, "HB-P132"),
        ({"period": "nothing"}, "HB-P132"),
        ({"at": "latch.off"}, "HB-P132"),
        ({"period": None, "at": "latch.of"}, "HB-P132"),
        ({"limit": "1 s"}, "HB-P132"),
        ({"of": "L.g"}, "HB-S109"),
        ({"parameter": {"Irf": [1.0, 2.0]}}, "HB-M107"),
        ({"solvr": "exact"}, "HB-S115"),
    ],
)
def test_what_makes_no_sense_is_refused(changed: dict, code: str) -> None:
    asked = {"parameter": {"Iref": [1.0, 1.2]}, **CALLS, **changed}
    with pytest.raises(hb.HybondError) as refused:
        hb.bifurcation(BUCK, asked.pop("parameter"), **asked)
    assert refused.value.code == code


def test_a_signal_or_branch_that_there_is_not_is_refused() -> None:
    found = hb.bifurcation(BUCK, {"Iref": [1.0, 1.2]}, **CALLS, settle=4, keep=4)
    asked = (lambda: found.points("L.g"), lambda: found.branch("up"), lambda: found.plot("x"))
    for call in asked:
        with pytest.raises(hb.UsageError) as refused:
            call()
        assert refused.value.code == "HB-P133"
    with pytest.raises(hb.UsageError) as refused:
        found.windows("1 V")
    assert refused.value.code == "HB-P131"


def test_chaos_is_not_taken_for_a_slow_orbit() -> None:
    tops = np.linspace(1.6, 1.68, 30)
    found = hb.bifurcation(BUCK, {"Iref": tops}, **CALLS, settle=100, keep=64)
    assert not found.branches[0].period.any()
