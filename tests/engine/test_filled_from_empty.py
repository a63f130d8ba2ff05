"""Tanks that are empty and are filled gently: an outlet by a root has no value below the edge.

The inflow is made for a level: its rate, and what runs out there. Where it is not, SciPy integrates
the equations from a little later on, where they have slopes.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ("auto", "radau")
"""`auto` begins with explicit steps, `radau` takes implicit ones from the start."""
TIMES = np.array([0.02, 0.1, 0.3, 0.6, 1.0])


def tank(outlet: str, inflow: str, level: float = 0.0) -> hb.Model:
    """A tank with one inflow and an outlet."""
    m = hb.Model("tank")
    m.add(n=hb.Zero(), c=hb.C(1.0, e=level), o=hb.R({"f": outlet}), s=hb.Sf(inflow))
    m.bond("s -> n -> c", "n -> o")
    return m


def least(run: hb.Result, name: str) -> float:
    """Return the least value of a signal, also between the points of the run."""
    return float(run[name].at(np.linspace(0.0, run.t_end, 1001)).min())


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("outlet", "inflow", "power"),
    [
        ("0.3*sqrt(e)", "4*time^3 + 0.3*time^2", 4),
        ("0.3*sqrt(e)", "8*time^7 + 0.3*time^4", 8),
        ("0.3*e^0.7", "4*time^3 + 0.3*time^2.8", 4),
        ("0.3*e^0.2", "5*time^4 + 0.3*time", 5),
        ("1e4*sqrt(e)", "4*time^3 + 1e4*time^2", 4),
        # opened and shut while it runs, and opened from shut
        ("(1 + 0.5*sin(10*time))*0.3*sqrt(e)", "4*time^3 + (1 + 0.5*sin(10*time))*0.3*time^2", 4),
        ("time*0.3*sqrt(e)", "4*time^3 + time*0.3*time^2", 4),
    ],
)
def test_the_level_follows_what_flows_in(outlet: str, inflow: str, power: int, solver: str) -> None:
    run = hb.simulate(tank(outlet, inflow), 1.0, solver=solver, max_steps=2000)
    assert run["c.e"].at(TIMES) == pytest.approx(TIMES**power, rel=2e-6)
    assert run["c.e"].at(1.0) == pytest.approx(1.0, rel=1e-8)
    assert least(run, "c.e") >= 0.0
    assert run.audit().holds()


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("inflow", "begin"),
    [
        ("2*time^1.5", 1e-3),
        ("2*time^4", 0.02),
        ("2*max(0, time - 0.1)^2", 0.101),
        ("1 - cos(3*time)", 1e-3),
    ],
)
def test_an_inflow_that_is_given(inflow: str, begin: float, solver: str) -> None:
    """``h' = q - 0.3 sqrt(h)``: a little later h is (q/0.3)**2 but for next to nothing."""
    rate = {
        "2*time^1.5": lambda t: 2.0 * t**1.5,
        "2*time^4": lambda t: 2.0 * t**4,
        "2*max(0, time - 0.1)^2": lambda t: 2.0 * max(0.0, t - 0.1) ** 2,
        "1 - cos(3*time)": lambda t: 1.0 - math.cos(3.0 * t),
    }[inflow]
    meant = solve_ivp(
        lambda t, h: [rate(t) - 0.3 * math.sqrt(max(h[0], 0.0))],
        (begin, 1.0),
        [(rate(begin) / 0.3) ** 2],
        method="Radau",
        rtol=1e-9,
        atol=1e-15,
    ).y[0, -1]
    run = hb.simulate(tank("0.3*sqrt(e)", inflow), 1.0, solver=solver, max_steps=2000)
    assert run["c.e"].at(1.0) == pytest.approx(meant, rel=1e-8)
    assert least(run, "c.e") >= 0.0


@pytest.mark.parametrize("solver", SOLVERS)
def test_an_edge_that_is_not_at_zero(solver: str) -> None:
    """An outlet 0.25 above the ground; water stands up to it."""
    m = tank("0.3*sqrt(e - 0.25)", "4*time^3 + 0.3*time^2", 0.25)
    run = hb.simulate(m, 1.0, solver=solver, max_steps=500)
    assert run["c.e"].at(TIMES) == pytest.approx(0.25 + TIMES**4, rel=1e-7)
    assert least(run, "c.e") >= 0.25


@pytest.mark.parametrize("solver", SOLVERS)
def test_outlets_beside_each_other_and_behind_a_check_valve(solver: str) -> None:
    m = tank("0.3*sqrt(e)", "4*time^3 + 0.3*time^2 + 0.2*time^2.8 + 0.1*time^2")
    m.add(more=hb.R({"f": "0.2*e^0.7"}), valve=hb.One(law="diode"), last=hb.R({"f": "0.1*sqrt(e)"}))
    m.bond("n -> more", "n -> valve -> last")
    run = hb.simulate(m, 1.0, solver=solver, max_steps=2000)
    assert run["c.e"].at(TIMES) == pytest.approx(TIMES**4, rel=1e-6)
    assert run["valve.f"].at(TIMES) == pytest.approx(0.1 * TIMES**2, rel=1e-6)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("inflow", ["2", "2*time^2"])
def test_tanks_in_a_row(inflow: str, solver: str) -> None:
    """What runs out of the upper one fills the lower one; both are empty."""
    m = hb.Model("row")
    m.add(a=hb.C(1.0), b=hb.C(1.0), na=hb.Zero(), nb=hb.Zero(), between=hb.One(), s=hb.Sf(inflow))
    m.add(o=hb.R({"f": "0.3*sign(e)*sqrt(abs(e))"}), p=hb.R({"f": "0.2*sqrt(e)"}))
    m.bond("s -> na -> a", "na -> between -> nb -> b", "between -> o", "nb -> p")
    run = hb.simulate(m, 1.0, solver=solver, max_steps=2000)

    def rates(t: float, h: np.ndarray) -> list[float]:
        through = 0.3 * math.copysign(math.sqrt(abs(h[0] - h[1])), h[0] - h[1])
        q = 2.0 if inflow == "2" else 2.0 * t * t
        return [q - through, through - 0.2 * math.sqrt(max(h[1], 0.0))]

    meant = solve_ivp(rates, (0.0, 1.0), [0.0, 0.0], method="Radau", rtol=1e-9, atol=1e-14).y[:, -1]
    assert [run["a.e"].at(1.0), run["b.e"].at(1.0)] == pytest.approx(meant, rel=1e-7)
    assert least(run, "b.e") >= 0.0


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("by", ["time", "kink", "event"])
def test_a_tank_that_ran_empty_is_filled_again(by: str, solver: str) -> None:
    """From 1 it is empty after 4 s; from 6 s on it is filled for the level ``(t - 6)**4``."""
    rate = "4*(time - 6)^3 + 0.5*(time - 6)^2"
    if by == "kink":
        rate = "4*max(0, time - 6)^3 + 0.5*max(0, time - 6)^2"
    if by == "time":
        rate = f"if time > 6 then {rate} else 0"
    m = tank("0.5*sqrt(e)", rate if by != "event" else f"if tap.on then {rate} else 0", 1.0)
    if by == "event":
        m.add(tap=hb.One(), nothing=hb.Se(0.0))
        m.bond("nothing -> tap")
        m.machine(
            "hand",
            states={"shut": [], "open": ["tap"]},
            start="shut",
            rules=["shut -> open when time >= 6"],
        )
    run = hb.simulate(m, 7.0, solver=solver, max_steps=2000)
    assert run["c.e"].at(2.0) == pytest.approx(0.25, rel=1e-7)
    assert run["c.e"].at(5.0) == 0.0
    assert run["c.e"].at(6.5) == pytest.approx(0.5**4, rel=1e-6)
    assert run["c.e"].at(7.0) == pytest.approx(1.0, rel=1e-7)
    assert run.audit().holds()


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_moves_beside_a_tank_that_fills(solver: str) -> None:
    """An oscillator of 10 rad/s is no less right for it, nor is a guard on the level."""
    m = tank("0.3*sqrt(e)", "4*time^3 + 0.3*time^2")
    m.add(j=hb.One(), mass=hb.I(1.0), spring=hb.C(0.01, q=1.0))
    m.bond("j -> mass", "j -> spring")
    m.machine(
        "float", states={"low": [], "high": []}, start="low", rules=["low -> high when c.e > 0.01"]
    )
    run = hb.simulate(m, 1.0, solver=solver, max_steps=2000)
    assert run["spring.q"].at(TIMES) == pytest.approx(np.cos(10.0 * TIMES), abs=3e-7)
    assert run["c.e"].at(1.0) == pytest.approx(1.0, rel=1e-8)
    assert run.events.t[1] == pytest.approx(0.01**0.25, rel=1e-8)


@pytest.mark.slow
def test_the_engine_as_python_fills_likewise() -> None:
    model = tank("0.3*sqrt(e)", "4*time*time*time + 0.3*time*time")
    runs = [hb.simulate(model, 1.0, solver="rk45", rtol=1e-4, engine=e) for e in ("python", None)]
    assert runs[0].final == runs[1].final
    assert runs[0].final["c.q"] == pytest.approx(1.0, rel=1e-4)
