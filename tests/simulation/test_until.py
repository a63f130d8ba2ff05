"""Runs that end where a condition holds first."""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.engine.tables import tables_of

SOLVERS = ("auto", "rk45", "radau", "exact", "rk4", "qss3", "liqss2", "moreau-jean")


def charging() -> hb.Model:
    m = hb.Model("rc", domain="electrical", parameters={"V": "10 V"})
    m.add(U=hb.Se("V"), R=hb.R("1 kohm"), C=hb.C("1 mF"), i=hb.One())
    m.bond("U -> i -> R", "i -> C")
    return m


@pytest.mark.parametrize("solver", SOLVERS)
def test_it_ends_where_the_condition_holds_first(solver: str) -> None:
    step = "10 ms" if solver in ("rk4", "moreau-jean") else None
    run = hb.simulate(charging(), ["C.e > 8 V", "10 s"], solver=solver, step=step)
    # at the end of the step that passes it, by fixed steps without events
    off = {"moreau-jean": 0.011, "qss3": 1e-6, "liqss2": 1e-4}.get(solver, 1e-7)
    assert run.t_end == pytest.approx(math.log(5.0), abs=off)
    assert (run.status, run.ended_by) == ("ok", "C.e > 8 V")
    last = run.events[-1]
    assert (last.cause, last.t) == ("until", run.t_end)
    assert run.final["C.e"] >= 8.0 - 1e-12
    assert run.mode == {}


def test_it_ends_at_its_time_if_the_condition_never_holds() -> None:
    run = hb.simulate(charging(), ["C.e > 20 V", "3 s"])
    assert (run.t_end, run.ended_by) == (3.0, "time")


def test_the_first_of_several_conditions_is_told() -> None:
    run = hb.simulate(charging(), ["C.e > 9 V", "R.f < 4 mA", "10 s"])
    # R.f = 10 mA exp(-t)
    assert run.ended_by == "R.f < 4 mA"
    assert run.t_end == pytest.approx(math.log(2.5), abs=1e-9)


def test_time_can_be_part_of_a_condition() -> None:
    run = hb.simulate(charging(), ["C.e > 2 V and time > 1 s", "10 s"])
    assert run.t_end == 1.0


def test_the_time_of_the_experiment_bounds_a_condition() -> None:
    m = charging()
    m.experiment = {"until": "2 s"}
    assert hb.simulate(m, "C.e > 20 V").t_end == 2.0
    m.experiment = {"until": ["C.e > 5 V", "2 s"]}
    assert hb.simulate(m).t_end == pytest.approx(math.log(2.0), abs=1e-9)
    # another time stands for all of it
    assert hb.simulate(m, "1.5 s").t_end == 1.5


def test_an_impulse_is_larger_than_any_force() -> None:
    # a ball that falls 1 m and strikes: the force of the impact has no bound
    model = hb.load("examples/bouncing_ball_newton.toml")
    whole = hb.simulate(model)
    impact = whole.events[1].t
    run = hb.simulate(model, ["contact.e > 1 GN", "10 s"])
    assert run.t_end == pytest.approx(impact, rel=1e-12)
    assert run.ended_by == "contact.e > 1 GN"
    # what happened there is settled, and recorded: the impact is part of the run
    after = [v for k, v in run.state().stored.items() if k.endswith(".p")]
    expected = [v for k, v in whole.state(impact).stored.items() if k.endswith(".p")]
    assert after == pytest.approx(expected, rel=1e-12)


def test_a_condition_that_holds_at_once_ends_the_run_at_its_start() -> None:
    run = hb.simulate(charging(), ["C.e < 1 V", "10 s"])
    assert (run.t_end, len(run.segments)) == (0.0, 0)
    assert run.final["C.e"] == 0.0
    assert run.state().t == 0.0


def test_it_goes_on_from_where_a_condition_ended_it() -> None:
    model = hb.load("examples/bouncing_ball.toml")
    first = hb.simulate(model, "height < 0.5")
    second = hb.simulate(model, start=first)
    whole = hb.simulate(model)
    assert second.final == pytest.approx(whole.final, rel=1e-11, abs=1e-13)
    assert [e.t for e in second.events] == pytest.approx(list(whole.events.t[1:]), rel=1e-12)


def test_modes_and_names_are_those_of_the_model() -> None:
    model = hb.load("examples/bouncing_ball.toml")
    run = hb.simulate(model, "height < 0.5")
    assert run.mode == {"floor": "away"}
    assert [len(s.mode) for s in run.segments] == [1]
    assert run.graph.machines == model.flatten().machines
    assert run.weight("floor", "away", 0.1) == 1.0


@pytest.mark.parametrize(
    ("until", "code"),
    [
        ("C.e > 8 V", "HB-S132"),
        (["1 s", "2 s"], "HB-S106"),
        ([], "HB-S106"),
        ("soon", "HB-S106"),
        (["C.x > 8 V", "1 s"], "HB-S136"),
        (["C.e > 8 A", "1 s"], "HB-S136"),
        (["C.e =", "1 s"], "HB-S136"),
        (["true", "1 s"], "HB-S136"),
    ],
)
def test_what_is_no_end_is_refused(until: object, code: str) -> None:
    with pytest.raises(hb.UsageError) as error:
        hb.simulate(charging(), until)  # type: ignore[arg-type]
    assert error.value.code == code


def test_who_ends_at_a_time_alone_says_so() -> None:
    m = charging()
    m.experiment = {"until": ["C.e > 8 V", "10 s"]}
    with pytest.raises(hb.UsageError, match="HB-S115"):
        hb.ensemble(m, sets={"V": [9.0, 10.0]})
    with pytest.raises(hb.UsageError, match="HB-E641"):
        tables_of(m.flatten())
