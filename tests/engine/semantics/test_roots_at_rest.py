"""Roots on both sides of rest: what runs out by one is at rest after a finite time, and stays.

Oracles: closed forms of ``x' = -k x^p``; what is stored together.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ["auto", "rk45", "radau"]
LAWS = {
    "square root": ("sign({0})*sqrt(abs({0}))", 0.5),
    "power": ("abs({0})^0.5*sign({0})", 0.5),
    "cube root": ("sign({0})*abs({0}/1)^(1/3)", 1.0 / 3.0),
    "either way": ("if {0} > 0 then sqrt({0}) else -sqrt(-{0})", 0.5),
}


def draining(law: str, start: float, *, dual: bool, away: bool) -> hb.Model:
    """A tank of 2 with an outlet, or a mass of 2 in a fluid."""
    m = hb.Model("draining")
    if dual:
        m.add(s=hb.I(2.0, p=2.0 * start), j=hb.One(), d=hb.R({"e": f"0.5*({law.format('f')})"}))
    else:
        m.add(s=hb.C(2.0, q=2.0 * start), j=hb.Zero(), d=hb.R({"f": f"0.5*({law.format('e')})"}))
    m.bond("j -> s", "j -> d" if away else "d -> j")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("away", [True, False])
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_what_runs_out_by_a_root_is_at_rest_in_finite_time(
    law: tuple[str, float], dual: bool, away: bool, solver: str
) -> None:
    """From either side: ``2 x' = -x^p/2`` is ``(1 - t/T)^(1/(1 - p))``, T = 4/(1 - p)."""
    text, p = law
    end = 4.0 / (1.0 - p)
    t = np.array([0.2, 0.5, 0.9]) * end
    for start in (1.0, -1.0):
        m = draining(text, start, dual=dual, away=away)
        run = hb.simulate(m, 3.0 * end, solver=solver, max_steps=500)
        x = run["s.p" if dual else "s.q"]
        exact = 2.0 * start * (1.0 - t / end) ** (1.0 / (1.0 - p))
        assert x.at(t) == pytest.approx(exact, abs=1e-6)
        assert x.at(np.array([1.001, 2.0, 3.0]) * end) == pytest.approx(0.0, abs=1e-300)
        assert len(run.events) == 1 and run.audit().holds()


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("levels", [(1.0, 0.2), (0.0, 3.0)])
def test_two_tanks_are_level_in_finite_time(levels: tuple[float, float], solver: str) -> None:
    """The difference d of tanks of 1 and 2 falls as ``d' = -1.5 k sqrt(d)``."""
    m = hb.Model("level")
    a, b = levels
    m.add(a=hb.C(1.0, q=a), b=hb.C(2.0, q=2.0 * b), na=hb.Zero(), nb=hb.Zero(), s=hb.One())
    m.add(o=hb.R({"f": "0.4*sign(e)*sqrt(abs(e))"}))
    m.bond("na -> a", "na -> s -> nb", "s -> o", "nb -> b")
    run = hb.simulate(m, 30.0, solver=solver, max_steps=500)
    d, rate = a - b, 0.3
    end = math.sqrt(abs(d)) / rate
    t = np.array([0.1, 0.5, 0.9]) * end
    exact = math.copysign(1.0, d) * (math.sqrt(abs(d)) - rate * t) ** 2
    assert run["a.e"].at(t) - run["b.e"].at(t) == pytest.approx(exact, abs=1e-6)
    level = (a + 2.0 * b) / 3.0
    assert run["a.e"].at(30.0) == pytest.approx(level, rel=1e-12)
    assert run["b.e"].at(30.0) == pytest.approx(level, rel=1e-12)


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_what_is_driven_through_rest_does_not_stay_there(solver: str) -> None:
    """A mass in such a fluid that a force swings: it turns, as SciPy has it."""
    m = hb.Model("swung")
    m.add(u=hb.Se("cos(time/1 [s])"), s=hb.I(1.0, p=0.4), j=hb.One())
    m.add(d=hb.R({"e": "0.5*sign(f)*sqrt(abs(f))"}))
    m.bond("u -> j -> s", "j -> d")
    run = hb.simulate(m, 6.0, solver=solver, max_steps=5000)
    t = np.linspace(0.5, 6.0, 12)
    found = solve_ivp(
        lambda t, v: [math.cos(t) - 0.5 * np.sign(v[0]) * math.sqrt(abs(v[0]))],
        (0.0, 6.0),
        [0.4],
        method="RK45",
        t_eval=t,
        rtol=1e-10,
        atol=1e-12,
    )
    assert run["s.p"].at(t) == pytest.approx(found.y[0], abs=2e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_rested_is_filled_again(solver: str) -> None:
    """A tap opens at 12 s: the level goes to where the outlet gives as much."""
    m = draining(LAWS["square root"][0], 1.0, dual=False, away=True)
    m.add(tap=hb.Sf("if time > 12 then 0.25 else 0"))
    m.bond("tap -> j")
    run = hb.simulate(m, 100.0, solver=solver, max_steps=5000)
    assert run["s.q"].at(11.0) == 0.0
    assert run["s.q"].at(100.0) == pytest.approx(0.5, rel=1e-5)


def test_the_engine_as_python_rests_there_too() -> None:
    m = draining(LAWS["square root"][0], 1.0, dual=False, away=True)
    runs = [hb.simulate(m, 20.0, engine=engine) for engine in ("python", None)]
    assert runs[0].final == runs[1].final
    assert runs[0].final["s.q"] == 0.0
