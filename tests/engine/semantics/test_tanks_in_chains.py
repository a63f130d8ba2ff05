"""Tanks in chains by plain roots: they come to one level, or run empty, all together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ["auto", "rk45", "radau", "exact"]
SIZES = [1.0, 2.0, 1.0, 3.0, 1.0]
LEVELS = [2.0, 1.5, 1.0, 0.5, 0.0]
PIPE = 0.3


def chain(levels: Sequence[float], outlet: float = 0.0) -> hb.Model:
    """Return tanks from left to right, `outlet` being that of the last one."""
    m = hb.Model("chain")
    for i, level in enumerate(levels):
        m.add(**{f"t{i}": hb.C(SIZES[i], e=level), f"n{i}": hb.Zero()})
        m.bond(f"n{i} -> t{i}")
    for i in range(len(levels) - 1):
        m.add(**{f"s{i}": hb.One(), f"r{i}": hb.R({"f": f"{PIPE}*sqrt(e)"})})
        m.bond(f"n{i} -> s{i} -> n{i + 1}", f"s{i} -> r{i}")
    if outlet > 0.0:
        m.add(o=hb.R({"f": f"{outlet}*sqrt(e)"}))
        m.bond(f"n{len(levels) - 1} -> o")
    return m


def by_scipy(levels: Sequence[float], outlet: float, times: np.ndarray) -> np.ndarray:
    """Return the levels at times before the tanks come to rest, shape (times, tanks)."""
    sizes = np.array(SIZES[: len(levels)])

    def rate(_: float, h: np.ndarray) -> np.ndarray:
        flow = PIPE * np.sqrt(np.maximum(h[:-1] - h[1:], 0.0))
        out = outlet * np.sqrt(max(h[-1], 0.0))
        return (np.append(0.0, flow) - np.append(flow, out)) / sizes

    found = solve_ivp(rate, (0.0, times[-1]), levels, "LSODA", times, rtol=1e-11, atol=1e-13)
    return np.asarray(found.y.T)


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_tanks_level_out_in_finite_time(solver: str) -> None:
    """Their difference is (sqrt(d) - 0.3 (1 + 1/2) t / 2)^2 until it is nothing."""
    run = hb.simulate(chain([2.0, 0.5]), 20.0, solver=solver)
    t = np.array([1.0, 3.0, 5.0])
    difference = run["t0.e"].at(t) - run["t1.e"].at(t)
    assert difference == pytest.approx((np.sqrt(1.5) - 0.225 * t) ** 2, abs=1e-7)
    assert run["r0.f"].at(6.0) == run["r0.f"].at(20.0) == 0.0
    assert [run.final["t0.e"], run.final["t1.e"]] == pytest.approx([1.0, 1.0], rel=1e-14)
    assert run.stats["steps"] < 400
    assert run.audit().holds()


@pytest.mark.sampled(3)
@pytest.mark.parametrize("many", [3, 4, 5])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_chain_comes_to_one_level_and_rests(solver: str, many: int) -> None:
    """Rounding between levels is no difference: it is not sent to and fro without end."""
    run = hb.simulate(chain(LEVELS[:many]), 60.0, solver=solver)
    sizes = np.array(SIZES[:many])
    level = float(sizes @ LEVELS[:many] / sizes.sum())
    assert [run.final[f"t{i}.e"] for i in range(many)] == pytest.approx([level] * many, rel=1e-13)
    assert all(run[f"r{i}.f"].at(60.0) == 0.0 for i in range(many - 1))
    assert run.stats["steps"] < 1000
    times = np.array([1.0, 4.0, 8.0])
    for i, expected in enumerate(by_scipy(LEVELS[:many], 0.0, times).T):
        assert run[f"t{i}.e"].at(times) == pytest.approx(expected, rel=1e-6)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("many", [2, 3])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_chain_runs_empty_through_the_last_tank(solver: str, many: int) -> None:
    m = chain(LEVELS[:many], outlet=0.1)
    m.signal(out=hb.Integral("o.f"))
    run = hb.simulate(m, 200.0, solver=solver)
    held = float(np.array(SIZES[:many]) @ LEVELS[:many])
    assert run["out"].at(200.0) == pytest.approx(held, rel=1e-6)
    assert [run.final[f"t{i}.e"] for i in range(many)] == pytest.approx([0.0] * many, abs=1e-18)
    times = np.array([5.0, 20.0, 50.0])
    for i, expected in enumerate(by_scipy(LEVELS[:many], 0.1, times).T):
        assert run[f"t{i}.e"].at(times) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_empty_tanks_are_filled_and_run_empty(solver: str) -> None:
    m = chain([0.0, 0.0], outlet=0.1)
    m.add(pump=hb.Sf("if time < 20 then 0.1 else 0"))
    m.bond("pump -> n0")
    m.signal(out=hb.Integral("o.f"))
    run = hb.simulate(m, 150.0, solver=solver)
    assert run["out"].at(150.0) == pytest.approx(2.0, rel=1e-6)
    assert [run.final["t0.e"], run.final["t1.e"]] == pytest.approx([0.0, 0.0], abs=1e-18)


@pytest.mark.parametrize("solver", SOLVERS)
def test_level_tanks_that_are_filled_alike_stay_level(solver: str) -> None:
    """Both levels rise by 0.01 per second; the pipe between them carries nothing."""
    m = chain([1.0, 0.5])
    m.add(p=hb.Sf(0.01), q=hb.Sf(0.02))
    m.bond("p -> n0", "q -> n1")
    run = hb.simulate(m, 60.0, solver=solver)
    level = 2.0 / 3.0 + 0.01 * 60.0
    assert [run.final["t0.e"], run.final["t1.e"]] == pytest.approx([level, level], rel=1e-12)
    assert run["r0.f"].at(60.0) == 0.0
    assert run.stats["steps"] < 400


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_siphon_stops_at_its_inlet(solver: str) -> None:
    """It takes from the second tank down to 0.4; what ran out of both is on the way."""
    m = chain([2.0, 0.5])
    m.add(o=hb.R({"f": "0.2*sqrt(e - 0.4)"}))
    m.bond("n1 -> o")
    m.signal(out=hb.Integral("o.f"))
    run = hb.simulate(m, 100.0, solver=solver)
    assert [run.final["t0.e"], run.final["t1.e"]] == pytest.approx([0.4, 0.4], rel=1e-13)
    assert run["out"].at(100.0) == pytest.approx(2.0 + 1.0 - 3 * 0.4, rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_draws_from_level_tanks_is_refused_when_it_begins(solver: str) -> None:
    """The pipe has no law from right to left, and the first tank would be the lower one."""
    m = chain([2.0, 0.5])
    m.add(pump=hb.Sf("if time < 10 then 0 else -0.02"))
    m.bond("pump -> n0")
    run = hb.simulate(m, 20.0, solver=solver, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N302"
    assert run.t_end == pytest.approx(10.0, rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_pipes_in_series_are_one(solver: str) -> None:
    """Their laws add up to e = f^2 (1/0.3^2 + 1/0.4^2): one pipe of 0.24."""
    m = hb.Model("series")
    m.add(a=hb.C(1.0, e=2.0), b=hb.C(2.0, e=0.5), x=hb.Zero(), na=hb.Zero(), nb=hb.Zero())
    m.add(s1=hb.One(), s2=hb.One(), r1=hb.R({"f": "0.3*sqrt(e)"}), r2=hb.R({"f": "0.4*sqrt(e)"}))
    m.bond("na -> a", "nb -> b", "na -> s1 -> x -> s2 -> nb", "s1 -> r1", "s2 -> r2")
    run = hb.simulate(m, 40.0, solver=solver)
    t = np.array([1.0, 3.0, 5.0])
    difference = run["a.e"].at(t) - run["b.e"].at(t)
    assert difference == pytest.approx((np.sqrt(1.5) - 0.18 * t) ** 2, abs=1e-7)
    assert [run.final["a.e"], run.final["b.e"]] == pytest.approx([1.0, 1.0], rel=1e-14)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_the_engine_as_python_comes_to_the_same_level(solver: str) -> None:
    runs = [
        hb.simulate(chain(LEVELS[:3]), 12.0, solver=solver, engine=engine)
        for engine in ("python", None)
    ]
    assert runs[0].final == runs[1].final
