"""Roots that come to nothing: the motion reaches where a law ends, and rests there."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ["rk45", "radau"]


def tank(law: str, **options: object) -> hb.Model:
    m = hb.Model("tank")
    m.add(t=hb.C(2.0, e=1.0), o=hb.R({"f": law}), n=hb.Zero())
    m.bond("n -> t", "n -> o")
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "law", ["0.5*sqrt(e)", "0.5*e^0.5", "sqrt(0.25*e)", "0.5*sqrt(e*(1 + 0*e))"]
)
def test_a_tank_runs_empty_in_finite_time(law: str, solver: str) -> None:
    """2 e' = -sqrt(e)/2 from 1: e = (1 - t/8)^2 until 8 s, nothing after."""
    run = hb.simulate(tank(law), 20.0, solver=solver)
    t = np.array([1.0, 4.0, 7.0, 7.9])
    assert run["t.e"].at(t) == pytest.approx((1.0 - t / 8.0) ** 2, abs=1e-6)
    assert run["t.e"].at(np.array([8.1, 20.0])) == pytest.approx(0.0, abs=1e-300)
    assert run["o.f"].at(20.0) == 0.0
    assert run.audit().holds()


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_engine_as_python_rests_there_too(solver: str) -> None:
    runs = [
        hb.simulate(tank("0.5*sqrt(e)"), 9.0, solver=solver, engine=e) for e in ("python", None)
    ]
    assert runs[0].final == runs[1].final
    assert runs[0].final["t.e"] == 0.0


@pytest.mark.parametrize("solver", SOLVERS)
def test_tanks_in_a_row_run_empty_together(solver: str) -> None:
    """The lower one follows the upper one; what ran out of it is what was in both."""
    m = hb.Model("row")
    m.add(a=hb.C(1.0, e=2.0), b=hb.C(2.0), na=hb.Zero(), nb=hb.Zero(), s=hb.One())
    m.add(p=hb.R({"f": "0.2*sign(e)*sqrt(abs(e))"}), o=hb.R({"f": "0.06*sqrt(e)"}))
    m.bond("na -> a", "na -> s -> nb", "s -> p", "nb -> b", "nb -> o")
    m.signal(out=hb.Integral("o.f"))
    run = hb.simulate(m, 200.0, solver=solver)
    assert run["out"].at(200.0) == pytest.approx(2.0, rel=1e-5)
    assert [run.final[k] for k in ("a.q", "b.q")] == pytest.approx([0.0, 0.0], abs=1e-18)


@pytest.mark.parametrize("solver", SOLVERS)
def test_an_edge_that_is_not_at_zero(solver: str) -> None:
    """An outlet 0.25 above the ground: the level stays there."""
    run = hb.simulate(tank("0.5*sqrt(e - 0.25)"), 20.0, solver=solver)
    assert run["t.e"].at(20.0) == pytest.approx(0.25, rel=1e-12)
    t = 3.0
    assert run["t.e"].at(t) == pytest.approx(0.25 + (math.sqrt(0.75) - t / 8.0) ** 2, abs=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_is_drawn_beyond_the_edge_is_refused_there(solver: str) -> None:
    """A pump draws on from an empty tank: 2 e' = -1/2 (1 + sqrt(e)) is at 0 after 8 (1 - log 2)."""
    m = tank("0.5*sqrt(e)")
    m.add(pump=hb.Sf(-0.5))
    m.bond("pump -> n")
    run = hb.simulate(m, 20.0, solver=solver, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N302"
    assert run.t_end == pytest.approx(8.0 * (1.0 - math.log(2.0)), rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_it_fills_again_from_the_edge(solver: str) -> None:
    m = tank("0.5*sqrt(e)")
    m.add(tap=hb.Sf("if time > 12 then 0.25 else 0"))
    m.bond("tap -> n")
    run = hb.simulate(m, 100.0, solver=solver)
    assert run["t.e"].at(11.0) == 0.0
    assert run["t.e"].at(100.0) == pytest.approx(0.25, rel=1e-5)


def row(levels: list[float], between: str, outlet: str = "") -> hb.Model:
    """Tanks in a row, from the first to the last by roots of what is between their levels."""
    m = hb.Model("tanks in a row")
    for k, level in enumerate(levels):
        m.add(**{f"t{k}": hb.C(1.0, q=level), f"n{k}": hb.Zero()})
        m.bond(f"n{k} -> t{k}")
    for k in range(len(levels) - 1):
        m.add(**{f"p{k}": hb.One(), f"r{k}": hb.R({"f": between})})
        m.bond(f"n{k} -> p{k} -> n{k + 1}", f"p{k} -> r{k}")
    if outlet:
        m.add(out=hb.R({"f": outlet}))
        m.bond(f"n{len(levels) - 1} -> out")
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("law", ["0.1*sqrt(e)", "0.1*e^0.5", "sqrt(0.01*e)"])
def test_two_tanks_level_out(law: str, solver: str) -> None:
    """Their difference d falls by -0.2 sqrt(d): from 0.8 to nothing after 8.94 s, and stays."""
    run = hb.simulate(row([1.0, 0.2], law), 40.0, solver=solver, max_steps=2000)
    end = math.sqrt(0.8) / 0.1
    t = np.array([1.0, 5.0, 8.9, 9.0, 39.0])
    apart = np.where(t < end, (math.sqrt(0.8) - 0.1 * t) ** 2, 0.0)
    assert run["t0.q"].at(t) == pytest.approx(0.6 + 0.5 * apart, abs=1e-6)
    assert run["t1.q"].at(t) == pytest.approx(0.6 - 0.5 * apart, abs=1e-6)
    assert run["r0.f"].at(20.0) == pytest.approx(0.0, abs=1e-9)
    assert run.audit().holds()


@pytest.mark.parametrize("solver", [*SOLVERS, "auto"])
@pytest.mark.parametrize("levels", [[1.0, 0.5], [1.0, 0.6, 0.3], [1.0, 0.8, 0.6, 0.4, 0.2]])
def test_tanks_in_a_row_run_empty_by_plain_roots(levels: list[float], solver: str) -> None:
    m = row(levels, "0.1*sqrt(e)", "0.1*sqrt(e)")
    m.signal(gone=hb.Integral("out.f"))
    run = hb.simulate(m, 200.0, solver=solver, max_steps=5000)
    assert run["gone"].at(200.0) == pytest.approx(sum(levels), rel=1e-6)
    left = [run[f"t{k}.q"].at(200.0) for k in range(len(levels))]
    assert left == pytest.approx([0.0] * len(levels), abs=1e-8)
    many = len(levels)

    def rates(_: float, q: np.ndarray) -> list[float]:
        fall = np.append(q[:-1] - q[1:], q[-1])
        flow = 0.1 * np.sqrt(np.maximum(fall, 0.0))
        return [(flow[k - 1] if k else 0.0) - flow[k] for k in range(many)]

    t = np.array([1.0, 5.0, 10.0, 20.0])
    other = solve_ivp(rates, (0.0, 20.0), levels, t_eval=t, rtol=1e-10, atol=1e-12, method="DOP853")
    for k in range(many):
        assert run[f"t{k}.q"].at(t) == pytest.approx(other.y[k], abs=2e-6)


@pytest.mark.parametrize("solver", [*SOLVERS, "auto"])
def test_they_fill_from_nothing_and_run_empty_again(solver: str) -> None:
    m = row([0.0, 0.0, 0.0], "0.1*sqrt(e)", "0.1*sqrt(e)")
    m.add(pump=hb.Sf("if time < 10 then 0.1 else 0"))
    m.bond("pump -> n0")
    m.signal(gone=hb.Integral("out.f"))
    run = hb.simulate(m, 300.0, solver=solver, max_steps=5000)
    assert run["gone"].at(300.0) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_second_tank_that_is_fuller_is_refused_from_the_start(solver: str) -> None:
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(row([0.2, 1.0], "0.1*sqrt(e)"), 1.0, solver=solver)
    assert caught.value.code == "HB-N302"
    assert "r0" in str(caught.value)


@pytest.mark.parametrize("solver", [*SOLVERS, "auto", "qss2"])
def test_an_outlet_behind_a_linear_loss_never_ends_but_is_followed(solver: str) -> None:
    """e = R f + (f/k)^2: near the end only R is left, and the level falls by half ever again."""
    m = hb.Model("loss")
    m.add(t=hb.C(2.0, e=1.0), n=hb.Zero(), s=hb.One(), r=hb.R(0.5), o=hb.R({"f": "0.5*sqrt(e)"}))
    m.bond("n -> t", "n -> s", "s -> r", "s -> o")
    run = hb.simulate(m, 30.0, solver=solver, max_steps=20_000)

    def rate(_: float, e: np.ndarray) -> np.ndarray:
        # f^2/0.25 + 0.5 f = e
        return -0.5 * (-0.5 + np.sqrt(0.25 + 16.0 * np.maximum(e, 0.0))) / 8.0

    t = np.array([1.0, 3.0, 6.0, 9.0])
    other = solve_ivp(rate, (0.0, 9.0), [1.0], t_eval=t, rtol=1e-11, atol=1e-14)
    near = 2e-6 if solver != "qss2" else 1e-3
    assert run["t.e"].at(t) == pytest.approx(other.y[0], abs=near)
    assert abs(run["t.e"].at(30.0)) < 1e-7


@pytest.mark.parametrize("solver", [*SOLVERS, "auto"])
@pytest.mark.parametrize("what", ["source", "storage", "rate"])
def test_roots_of_what_is_stored_end_elsewhere_too(what: str, solver: str) -> None:
    """In a source, in the law of a storage, in the rate of a signal."""
    m = hb.Model("roots")
    m.add(t=hb.C({"e": "sqrt(q)"}, q=1.0) if what == "storage" else hb.C(1.0, q=1.0), n=hb.Zero())
    if what == "source":
        m.add(p=hb.Sf("-0.5*sqrt(t.q)"))
        m.bond("p -> n", "n -> t")
    else:
        m.add(o=hb.R({"f": "0.5*e" if what == "storage" else "0.5*sqrt(e)"}))
        m.bond("n -> t", "n -> o")
    if what == "rate":
        m.signal(w=hb.Integral("sqrt(t.q)"))
    run = hb.simulate(m, 20.0, solver=solver, max_steps=2000)
    assert run["t.q"].at(2.0) == pytest.approx(0.25, abs=1e-6)
    assert run["t.q"].at(20.0) == pytest.approx(0.0, abs=1e-14)
    if what == "rate":
        assert run["w"].at(20.0) == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("solver", [*SOLVERS, "auto"])
def test_a_shut_valve_between_tanks_opens_and_shuts(solver: str) -> None:
    m = row([1.0, 0.0], "0.2*sqrt(e)")
    m.machine(
        "valve",
        states={"off": [], "on": ["p0"]},
        start="off",
        rules=[
            "off -> on when time >= 1 and time < 3 or time >= 5",
            "on -> off when time >= 3 and time < 5",
        ],
    )
    run = hb.simulate(m, 30.0, solver=solver, max_steps=2000)
    # d' = -0.4 sqrt(d) while it is open: sqrt(d) = 1 - 0.2 t
    for t, root in ((1.0, 1.0), (2.0, 0.8), (4.0, 0.6), (7.0, 0.2), (20.0, 0.0)):
        d = run["t0.q"].at(t) - run["t1.q"].at(t)
        assert d == pytest.approx(root**2, abs=1e-6)


def test_a_machine_stops_the_pump_at_the_edge() -> None:
    m = tank("0.5*sqrt(e)")
    m.add(pump=hb.Sf('if m.state == "on" then -0.5 else 0'))
    m.bond("pump -> n")
    m.machine("m", states={"on": [], "off": []}, start="on", rules=["on -> off when t.e <= 0"])
    run = hb.simulate(m, 20.0)
    assert [e.t for e in run.events[1:]] == pytest.approx([8.0 * (1.0 - math.log(2.0))], rel=1e-6)
    assert run["t.e"].at(20.0) == pytest.approx(0.0, abs=1e-14)
