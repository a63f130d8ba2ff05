"""Rows of tanks joined by orifices, level at the start or not.

What flows follows the roots of levels, and the front of what drains the last tank runs through
orifices across which there is next to nothing yet: which side of level that is on is the error of
steps. Each time it turned over a step ended there, and the next one had its size to find.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

AREA, WEIGHT, K = 0.5, 9810.0, 2.7e-5
UNTIL = 600.0
TIMES = np.linspace(UNTIL / 6, UNTIL, 6)


def row(n, levels, *, turned=False):
    """Tanks from left to right, the last of which drains; bonds of orifices turned round or not."""
    m = hb.Model("row", domain="hydraulic", parameters={"n": n, "k": K})
    pressures = [WEIGHT * level for level in levels]
    orifice = hb.R({"f": "k*sign(e)*sqrt(abs(e))"})
    m.add({"t[1..n]": hb.C(AREA / WEIGHT, e=pressures), "p[1..n]": hb.Zero()})
    m.add({"i[1..n-1]": hb.One(), "o[1..n-1]": orifice})
    m.add(drain=hb.R({"f": "k*sqrt(e)"}))
    m.bond("p[1..n] -> t[1..n]", "i[1..n-1] -> o[1..n-1]", "p[n] -> drain")
    if turned:
        m.bond("p[2..n] -> i[1..n-1] -> p[1..n-1]")
    else:
        m.bond("p[1..n-1] -> i[1..n-1] -> p[2..n]")
    return m


def levels_of(run, n):
    return np.array([run[f"t[{j}].e"].at(TIMES) for j in range(1, n + 1)]) / WEIGHT


def by_scipy(levels):
    def rates(_, h):
        drop = WEIGHT * (h[:-1] - h[1:])
        flow = K * np.sign(drop) * np.sqrt(np.abs(drop))
        net = np.append(-flow, 0.0) + np.append(0.0, flow)
        net[-1] -= K * np.sqrt(WEIGHT * max(h[-1], 0.0))
        return net / AREA

    tight = {"method": "LSODA", "rtol": 1e-11, "atol": 1e-13}
    return solve_ivp(rates, (0.0, UNTIL), levels, t_eval=TIMES, **tight).y


LEVELS = {
    "level": np.ones(12),
    "a step": np.where(np.arange(12) < 6, 2.0, 1.0),
    "mixed": np.array([0.3, 1.7, 0.9, 0.4, 1.1, 1.6, 0.2, 0.8, 1.9, 0.7, 1.2, 0.5]),
}


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("start", LEVELS)
def test_rows_of_tanks(start, solver, turned):
    levels = LEVELS[start]
    n = len(levels)
    run = hb.simulate(row(n, levels, turned=turned), until=UNTIL, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    assert levels_of(run, n) == pytest.approx(by_scipy(levels), abs=2e-6)


@pytest.mark.parametrize("n", [60, 120])
def test_long_rows_that_are_level_take_few_evaluations(n):
    run = hb.simulate(row(n, np.ones(n)), until=UNTIL)
    tight = hb.simulate(row(n, np.ones(n)), until=UNTIL, rtol=1e-10)
    assert run.status == "ok" and run.audit().holds()
    # 131,507 and 267,000 they were
    assert run.stats["evaluations"] < 600 * n and run.stats["rejected"] < 25
    assert levels_of(run, n) == pytest.approx(levels_of(tight, n), abs=1e-7)


def test_what_all_tanks_lose_has_drained():
    n = 40
    run = hb.simulate(row(n, np.full(n, 0.3)), until=3e3)
    drained = run["drain.f"]
    t = np.linspace(0.0, 3e3, 20001)
    lost = (
        np.trapezoid(drained.at(t), t) if hasattr(np, "trapezoid") else np.trapz(drained.at(t), t)
    )
    held = sum(run[f"t[{j}].q"].at(3e3) for j in range(1, n + 1))
    assert held + lost == pytest.approx(0.3 * n * AREA, rel=1e-6)
