"""Turbulent orifices between volumes of oil in SI units: 1e7 Pa that differ by 1e-6."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

W, Q = 274.69717876038743, 3.3794125206124035e-05
SMALL, LARGE = 2.6739455852334826e-14, 6.706724322760052e-14


def check_valve_whose_flow_touches_zero() -> hb.Model:
    """A pump that pauses for no time at all, behind a check valve between two volumes."""
    m = hb.Model("pauses", domain="hydraulic")
    m.add(
        S=hb.Sf(f"{Q!r}*(1+sin({W!r}*time))"),
        n=hb.Zero(),
        A=hb.C(f"{SMALL!r} m^3/Pa", e="7.3 MPa"),
        j=hb.One(),
        V=hb.R({"f": "7.208650825684926e-07*sqrt(max(0,e))"}),
        k=hb.Zero(),
        B=hb.C(f"{LARGE!r} m^3/Pa", e="7.384 MPa"),
    )
    m.bond("S -> n -> A", "n -> j -> k -> B", "j -> V")
    return m


def orifice_beside_a_pipe(law: str) -> hb.Model:
    """A chamber joined to an accumulator by an orifice and a pipe, driven by next to nothing."""
    m = hb.Model("follows", domain="hydraulic")
    m.add(
        S=hb.Sf("4.4e-4*(1+0.5*sin(154.86*time))"),
        n=hb.Zero(),
        A=hb.C({"e": "4.35e6*(7.4e-4/(7.4e-4-q))^1.4"}, q="0 m^3"),
        out=hb.One(),
        E=hb.R({"f": "7.9e-07*sqrt(max(0,e-50000.0))"}),
        c=hb.Zero(),
        C=hb.C("3.18e-14 m^3/Pa", e="5 MPa"),
        j=hb.One(),
        V=hb.R({"f": law}),
        i=hb.One(),
        I=hb.I("1.517e7 Pa*s^2/m^3"),
        R=hb.R("4.823e9 Pa*s/m^3"),
    )
    m.bond("S -> n -> A", "n -> out -> E", "c -> C", "c -> j -> n", "j -> V")
    m.bond("c -> i -> n", "i -> I", "i -> R")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_flow_that_touches_zero_is_passed(solver: str) -> None:
    run = hb.simulate(check_valve_whose_flow_touches_zero(), until=0.05, solver=solver)
    t = 0.05
    pumped = Q * (t + (1.0 - math.cos(W * t)) / W)
    held = run["A.q"].at(t) + run["B.q"].at(t)
    assert held == pytest.approx(SMALL * 7.3e6 + LARGE * 7.384e6 + pumped, rel=1e-9)
    # what passes is what fills the second volume as fast as the first
    passes = Q * (1.0 + math.sin(W * t)) * LARGE / (SMALL + LARGE)
    apart = run["A.e"].at(t) - run["B.e"].at(t)
    assert apart == pytest.approx((passes / 7.208650825684926e-07) ** 2, rel=1e-3)
    assert run.status == "ok"
    assert run.stats["steps"] < 3000


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "law",
    [
        "2.16e-07*sign(e)*sqrt(abs(e))",
        "if e > 0 then 2.16e-07*sqrt(e) else -2.16e-07*sqrt(-e)",
    ],
)
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_orifice_that_next_to_nothing_drives_takes_few_steps(solver: str, law: str) -> None:
    end = 0.2
    run = hb.simulate(orifice_beside_a_pipe(law), until=end, solver=solver)

    def rates(t: float, y: np.ndarray) -> list[float]:
        a, c, i = y
        gas = 4.35e6 * (7.4e-4 / (7.4e-4 - a)) ** 1.4
        apart = c / 3.18e-14 - gas
        # smooth within 1e-6 of what pressures are
        flow = 2.16e-07 * apart / (apart**2 + 1.0) ** 0.25 + i
        leaves = 7.9e-07 * math.sqrt(max(0.0, gas - 50000.0))
        fills = 4.4e-4 * (1.0 + 0.5 * math.sin(154.86 * t))
        return [fills - leaves + flow, -flow, (apart - 4.823e9 * i) / 1.517e7]

    there = solve_ivp(
        rates, (0.0, end), [0.0, 3.18e-14 * 5e6, 0.0], method="LSODA", rtol=1e-9, atol=1e-18
    ).y[:, -1]
    gas = 4.35e6 * (7.4e-4 / (7.4e-4 - there[0])) ** 1.4
    assert run["A.e"].at(end) == pytest.approx(gas, rel=1e-6)
    assert run["C.e"].at(end) == pytest.approx(gas, rel=1e-6)
    assert run.stats["steps"] < 3000


@pytest.mark.parametrize(
    "law",
    ["1.0477e-06*sqrt(max(0,e-50000))", "if e > 50000 then 1.0477e-06*sqrt(e-50000) else 0"],
)
def test_check_valve_that_closes_as_what_is_behind_it_turns(law: str) -> None:
    """A volume follows the pressure behind its valve; it took 10,000 steps, or HB-N410."""
    small = 1.398e-14
    m = hb.Model("closes", domain="hydraulic")
    m.add(
        A=hb.C(f"{small!r} m^3/Pa", e="7 MPa"),
        n=hb.Zero(),
        j=hb.One(),
        V=hb.R({"f": law}),
        P=hb.Se("1.7e6+5e10*(time-0.0103)^2"),
    )
    m.bond("n -> A", "n -> j", "j -> V", "j -> P")
    run = hb.simulate(m, until=0.03)
    for t in (0.004, 0.006, 0.008):
        flow = small * 1e11 * (0.0103 - t)
        # what the valve needs falls as well: 2 q q'/k^2 of the slope of the pressure
        less = small * 2.0 * flow * small * 1e11 / 1.0477e-06**2
        assert run["V.f"].at(t) == pytest.approx(flow + less, rel=1e-3)
    assert run["A.e"].at(0.03) == pytest.approx(1.75e6, rel=1e-6)
    assert run["V.f"].at(0.03) == 0.0
    assert run.status == "ok"
    assert run.stats["steps"] < 2000


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize(
    "law",
    ["1e-8*sqrt(max(0,e))", "if e > 0 then 1e-8*sqrt(e) else 0", "1e-8*sign(e)*sqrt(abs(e))"],
)
@pytest.mark.parametrize("beside", ["", "1e8 Pa*s/m^3", "1e9 Pa*s/m^3", "1e12 Pa*s/m^3"])
def test_valve_that_begins_where_pressures_are_equal(law: str, beside: str, solver: str) -> None:
    """The vessel was put 1e4 Pa below what is behind its check valve, with status ok.

    Beside a part that nothing joins it was 2.4 Pa off: rounding of the pressures was taken to make
    flows by the slope of a root at zero.
    """
    m = hb.Model("level", domain="hydraulic")
    m.add(
        A=hb.C("1e-12 m^3/Pa", e="10040000.0 Pa"),
        n=hb.Zero(),
        j=hb.One(),
        V=hb.R({"f": law}),
        P=hb.Se("1e7+1e8*(time-0.02)^2"),
    )
    m.bond("n -> A", "n -> j -> P", "j -> V")
    if beside:
        m.add(apart=hb.C("1e-10 m^3/Pa", e="1 bar"), alone=hb.Zero(), leak=hb.R(beside))
        m.bond("alone -> apart", "alone -> leak")
    run = hb.simulate(m, until=0.018, solver=solver)
    # the root u of what is apart is smooth: 2 u u' = -p' - 1e4 u
    apart = solve_ivp(
        lambda t, u: (-2e8 * (t - 0.02) - 1e4 * u) / (2.0 * np.maximum(u, 1e-12)),
        (1e-9, 0.018),
        [math.sqrt(1e-9 * 4e6)],
        method="LSODA",
        rtol=1e-11,
        atol=1e-9,
        dense_output=True,
    )
    for t in (0.001, 0.004, 0.01, 0.015):
        assert run["V.e"].at(t) == pytest.approx(apart.sol(t)[0] ** 2, abs=0.2)
    assert run.audit().holds()


def test_what_turns_within_a_step_turns_between_its_ends() -> None:
    """One of two roots begins in a step: dense output was led one way, 1,000 Pa beside it."""
    small, k, turns = 1.1364197361361094e-13, 1.1897771254867412e-07, 0.015386735860190574
    pressure = f"2e6+1.1497760040924e8*(time-{turns!r})^2"
    m = hb.Model("turns", domain="hydraulic")
    m.add(
        A=hb.C(f"{small!r} m^3/Pa", e=f"{2e6 + 1.1497760040924e8 * turns**2!r} Pa"),
        n=hb.Zero(),
        j=hb.One(),
        V=hb.R({"f": f"{k!r}*(sqrt(max(0,e))-sqrt(max(0,-e)))"}),
        P=hb.Se(pressure),
    )
    m.bond("n -> A", "n -> j -> P", "j -> V")
    run = hb.simulate(m, until=0.03)
    for t in np.linspace(0.002, 0.029, 40):
        flow = small * 2.2995520081848e8 * (turns - t)
        assert run["V.e"].at(t) == pytest.approx(math.copysign((flow / k) ** 2, flow), abs=0.1)
