"""Methods of the library: exact propagation and fixed steps, against closed forms and others."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from engine.by_engine import ENGINE
from engines import assert_same_events, assert_same_states
from export.programs import ask, compile_quickly, expected, needs_c, read_events
from scipy.linalg import expm

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"


def load(name: str) -> hb.Model:
    return hb.load(EXAMPLES / f"{name}.toml")


def by_library(model: hb.Model, until: float | str | None = None, **options: Any) -> hb.Result:
    return hb.simulate(model, until, engine=ENGINE, **options)


def coil(source: str, r: float = 2.0, l: float = 0.5) -> hb.Model:
    m = hb.Model("rl", domain="electrical")
    m.add(V=hb.Se(source), n=hb.One(), R=hb.R(r), L=hb.I(l))
    m.bond("V -> n -> R", "n -> L")
    return m


def chain(n: int) -> hb.Model:
    """Capacitors behind resistors; the last one is the slowest."""
    m = hb.Model("chain", domain="electrical")
    m.add(V=hb.Se("sin(3*time)"), i=hb.One(), r=hb.R(1.0))
    m.bond("V -> i -> r")
    for k in range(n):
        m.add(**{f"z{k}": hb.Zero(), f"c{k}": hb.C(0.01 * (k + 1)), f"i{k}": hb.One()})
        m.add(**{f"r{k}": hb.R(1.0)})
        m.bond(f"{'i' if k == 0 else f'i{k - 1}'} -> z{k} -> c{k}", f"z{k} -> i{k} -> r{k}")
    return m


# -- exact


def test_a_sine_over_two_thousand_periods_does_not_drift() -> None:
    run = by_library(coil("10*sin(2*pi*50*time)", 1.0, 0.01), 40.0, solver="exact")
    w = 100.0 * math.pi
    t = np.concatenate([s.t for s in run.segments])
    p = np.concatenate([s.y[:, 0] for s in run.segments])
    f = np.imag(10.0 * np.exp(1j * w * t) / (100.0 + 1j * w))
    f += 10.0 * w / (100.0**2 + w**2) * np.exp(-100.0 * t)
    # the argument of a sine of 1.3e4 is known to no more than that
    assert np.abs(p - f).max() <= 1e-11 * np.abs(f).max()


def test_comparisons_of_time_choose_what_drives() -> None:
    """Each is 0 or 1 between two timed events, and a generator that stands still."""
    m = coil("if time < 0.2 or time > 0.7 and not time > 0.9 then 3*time else sin(5*time)")
    run = by_library(m, 1.2, solver="exact")
    assert run.method == "1 mode propagated exactly"
    y, t = 0.0, 0.0
    a = np.zeros((5, 5))
    for end, ramp in ((0.2, True), (0.7, False), (0.9, True), (1.2, False)):
        a[:] = 0.0
        a[0, 0], a[1, 2], a[3, 4], a[4, 3] = -4.0, 1.0, 5.0, -5.0
        a[0, 1 if ramp else 3] = 3.0 if ramp else 1.0
        z = [y, t, 1.0, math.sin(5.0 * t), math.cos(5.0 * t)]
        y, t = (expm(a * (end - t)) @ z)[0], end
    assert run.final["L.p"] == pytest.approx(y, rel=1e-12)


def test_more_than_sixty_four_states() -> None:
    run = by_library(chain(80), 0.3, solver="exact")
    true = by_library(chain(80), 0.3, solver="rk45", rtol=1e-12)
    assert run.method == "1 mode propagated exactly"
    size = max(abs(v) for v in true.final.values())
    assert all(abs(run.final[k] - v) <= 1e-10 * size for k, v in true.final.items())


def test_flows_come_back_when_there_is_no_room_for_all() -> None:
    """A hundred and twenty-eight modes of one circuit, each entered twice."""
    m = coil("1")
    for k in range(7):
        m.add(**{f"s{k}": hb.One(), f"z{k}": hb.Zero(), f"g{k}": hb.R(10.0 + k), f"a{k}": hb.One()})
        m.bond(f"n -> z{k} -> s{k} -> g{k}", f"z{k} -> a{k}")
        m.add(**{f"h{k}": hb.R(3.0 + k)})
        m.bond(f"a{k} -> h{k}")
        m.input(**{f"u{k}": hb.Input(pwm={"period": 2.0 ** (k - 6), "duty": 0.5})})
        m.machine(
            f"M{k}",
            states={"off": [], "on": [f"s{k}"]},
            start="off",
            rules=[f"off -> on when u{k} > 0.5", f"on -> off when u{k} < 0.5"],
        )
    run = by_library(m, 2.0, solver="exact")
    true = by_library(m, 2.0, solver="rk45", rtol=1e-12)
    assert run.stats["propagated"] >= 128
    assert run.final["L.p"] == pytest.approx(true.final["L.p"], rel=1e-9)


@pytest.mark.parametrize("name", ["boost", "half_bridge"])
def test_converters_do_what_they_do_by_steps(name: str) -> None:
    a = hb.simulate(load(name), rtol=1e-11)
    b = by_library(load(name), solver="exact")
    assert_same_events(a, b)
    assert_same_states(a, b, 1e-8)
    assert b.method.endswith("propagated exactly")


def test_steps_of_a_stiff_mode_do_not_follow_what_died_away() -> None:
    m = hb.Model("stiff", domain="electrical")
    m.add(V=hb.Se("u"), n=hb.One(), fast=hb.R(1.0), z=hb.Zero(), c=hb.C(1e-9))
    m.add(i=hb.One(), R=hb.R(1.0), L=hb.I(1.0))
    m.bond("V -> n -> fast", "n -> z -> c", "z -> i -> R", "i -> L")
    m.input(u=hb.Input(pwm={"period": 0.5, "duty": 0.4}))
    run = by_library(m, 5.0, solver="exact")
    assert run.stats["steps"] < 2000
    matrix = np.array([[-1e9, -1.0], [1e9, -1.0]])
    fast = -(1e9 + 1.0 + np.sqrt((1e9 + 1.0) ** 2 - 8e9)) / 2.0
    slow = 2e9 / fast
    onto_slow = (matrix - fast * np.eye(2)) / (slow - fast)
    x = np.zeros(2)
    for _ in range(10):
        for h, u in ((0.2, 1.0), (0.3, 0.0)):
            rest = np.array([0.5e-9 * u, 0.5 * u])
            x = rest + np.exp(slow * h) * (onto_slow @ (x - rest))
    assert run.final["L.p"] == pytest.approx(x[1], rel=1e-12)


# -- fixed steps


@pytest.mark.parametrize(("solver", "order"), [("euler", 1), ("rk4", 4)])
def test_order(solver: str, order: int) -> None:
    off = []
    for step in (0.1, 0.05):
        run = by_library(coil("10*sin(7*time)"), 1.0, solver=solver, step=step)
        true = np.imag(10.0 * np.exp(7j) / (4 + 7j)) + 10.0 * 7.0 / 65.0 * math.exp(-4.0)
        off.append(abs(run.final["L.p"] - true))
    assert math.log2(off[0] / off[1]) == pytest.approx(order, abs=0.5)


def on_the_grid(ends: list[float], step: float) -> bool:
    """Whether ends of steps are points of a grid, but the last, which is where it ends."""
    k = np.round(np.array(ends[:-1]) / step)
    return bool(np.abs(ends[:-1] - k * step).max() <= 1e-12)


@pytest.mark.parametrize("solver", ["euler", "rk4"])
def test_fixed_steps_are_the_recursions_of_textbooks(solver: str) -> None:
    """For p' = u - 4 p: by Taylor's polynomial of the method, on a grid that does not drift."""
    h, u = 0.03, 3.0
    run = by_library(coil(str(u)), 1.0, solver=solver, step=h)
    z = -4.0 * h
    grows = 1 + z if solver == "euler" else 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24
    (segment,) = run.segments
    k = np.arange(len(segment.t) - 1)
    assert on_the_grid(segment.t.tolist(), h)
    assert segment.y[:-1, 0] == pytest.approx(u / 4 * (1 - grows**k), rel=1e-13, abs=1e-16)
    assert segment.t[-1] == 1.0 and run.stats["steps"] == 34


def test_a_grid_begins_anew_where_a_motion_does() -> None:
    """A switch at 0.1 s, and steps of 0.03 s: 0.09, 0.1, 0.13, ..."""
    m = coil("3")
    m.machine("M", states={"a": [], "b": []}, start="a", rules=["a -> b when L.p > 0.2"])
    first, second = by_library(m, 0.3, solver="rk4", step=0.03).segments
    assert first.t[:-1] == pytest.approx(0.03 * np.arange(len(first.t) - 1))
    assert second.t[0] == first.t[-1] == pytest.approx(-math.log(1 - 0.2 / 0.75) / 4, rel=1e-5)
    behind = np.diff(second.t)
    assert behind[:-1] == pytest.approx(0.03) and behind[-1] <= 0.03 * (1 + 1e-9)


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"solver": "rk4"}, "HB-S102"),
        ({"solver": "euler", "step": -1.0}, "HB-S102"),
        ({"solver": "rk45", "step": 0.1}, "HB-S104"),
        ({"solver": "exact", "step": 0.1}, "HB-S104"),
        ({"solver": "euler", "step": math.nan}, "HB-S102"),
        ({"solver": "rk4", "step": math.inf}, "HB-S102"),
        ({"solver": "rk45", "max_step": 0.0}, "HB-S103"),
    ],
)
def test_steps_that_make_no_sense_are_refused(options: dict[str, Any], code: str) -> None:
    with pytest.raises(hb.UsageError) as run:
        by_library(coil("1"), 1.0, **options)
    with pytest.raises(hb.UsageError) as export:
        hb.export(coil("1"), to="c", until=1.0, **options)
    assert run.value.code == export.value.code == code


def test_a_method_that_there_is_not_is_refused() -> None:
    with pytest.raises(hb.UsageError) as caught:
        hb.simulate(coil("1"), 1.0, solver="rk54")
    assert caught.value.code == "HB-S101" and "rk45" in caught.value.hint


# -- in exports


@pytest.mark.sampled(1)
@needs_c
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("boost", {"solver": "exact"}),
        ("half_bridge", {"solver": "exact"}),
        ("half_wave_rectifier", {"solver": "exact"}),
        ("half_bridge", {"solver": "rk4", "step": 1e-7}),
        ("diode_inductor", {"solver": "euler", "step": 1e-3}),
    ],
)
def test_a_program_runs_as_the_library_does(
    name: str, options: dict[str, Any], tmp_path: Path
) -> None:
    program = compile_quickly(str(hb.export(load(name), to="c", **options)), tmp_path, name)
    said = read_events(ask(program, "--events"))
    run = expected(by_library(load(name), **options))
    assert said.transitions == run.transitions
    assert said.times == pytest.approx(run.times, abs=1e-12 * run.end)
    for path, value in said.states.items():
        assert value == pytest.approx(run.states[path], rel=1e-12, abs=1e-15), path
