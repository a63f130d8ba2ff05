"""Roots that come to nothing: the motion reaches where a law ends, and rests there."""

from __future__ import annotations

import math

import numpy as np
import pytest

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


@pytest.mark.sampled(1)
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


@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize(
    ("upper", "lower", "filled", "between", "outlet"),
    [
        (2.0, 0.5, 0.0, 0.31, 0.06),
        (0.7, 3.1, 0.4, 0.09, 0.13),
        (3.6, 1.0, 2.9, 0.45, 0.04),
        (1.3, 1.9, 2.2, 0.07, 0.27),
        (0.9, 0.4, 0.0, 0.22, 0.21),
        (2.4, 3.3, 1.1, 0.38, 0.09),
    ],
)
@pytest.mark.parametrize(("turned", "beside"), [(False, False), (True, False), (False, True)])
def test_two_tanks_run_empty_whatever_their_sizes_are(
    upper: float,
    lower: float,
    filled: float,
    between: float,
    outlet: float,
    turned: bool,
    beside: bool,
    solver: str,
) -> None:
    """A third of them was refused (HB-N302): the upper one was below nothing, and drew on.

    Whatever else there is: a capacitor that nearly has no charge left, and moves.
    """
    m = hb.Model("row")
    m.add(a=hb.C(1.0, e=upper), b=hb.C(lower, e=filled), na=hb.Zero(), nb=hb.Zero(), s=hb.One())
    m.add(p=hb.R({"f": f"{between}*sign(e)*sqrt(abs(e))"}), o=hb.R({"f": f"{outlet}*sqrt(e)"}))
    way = "nb -> s -> na" if turned else "na -> s -> nb"
    m.bond(way, "na -> a", "s -> p", "nb -> b", "nb -> o")
    m.signal(out=hb.Integral("o.f"))
    if beside:
        m.add(S=hb.Se("3*exp(-time/(1 [s]))"), j=hb.One(), R=hb.R(1.0), C=hb.C(0.5))
        m.bond("S -> j -> R", "j -> C")
    run = hb.simulate(m, 400.0, solver=solver)
    there = upper + lower * filled
    for t in (1.0, 10.0, 30.0, 100.0, 400.0):
        left = run["a.q"].at(t) + run["b.q"].at(t)
        assert left + run["out"].at(t) == pytest.approx(there, rel=1e-6)
    assert run.final["a.q"] == 0.0
    assert run.final["b.q"] == 0.0


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
