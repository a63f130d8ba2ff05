"""A window of a clock that ends where the run does, or where a block of a step does, is found."""

from __future__ import annotations

from typing import Literal

import pytest

import hybond as hb

FORMS = ["mod(time, {p!r}) > {edge!r}", "time/{p!r} - floor(time/{p!r}) > {edge!r}/{p!r}"]


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("form", FORMS, ids=["mod", "floor"])
@pytest.mark.parametrize("part", [1e-3, 1e-5, 1e-6, 1e-7, 1e-8])
@pytest.mark.parametrize("period", [1.0, 0.05, 0.007, 0.3])
def test_it_is_found(
    period: float, part: float, form: str, solver: Literal["auto", "rk45", "radau"]
) -> None:
    edge = period * (1.0 - part)
    m = hb.Model("window", domain="electrical")
    m.add(V=hb.Se(1.0), j=hb.One(), R=hb.R(1.0), C=hb.C(0.1))
    m.bond("V -> j", "j -> R", "j -> C")
    rules = [f"a -> b when {form.format(p=period, edge=edge)}"]
    m.machine("k", states={"a": [], "b": []}, start="a", rules=rules)
    run = hb.simulate(m, period, solver=solver)
    (event,) = [e for e in run.events if e.cause != "start"]
    assert event.steps[-1].mode == (1,)
    assert event.t == pytest.approx(edge, rel=1e-12)


@pytest.mark.parametrize("duty", [0.5, 0.25, 0.9])
@pytest.mark.parametrize("period", [0.1, 0.3, 1e-3])
@pytest.mark.parametrize("periods", [1, 2, 4, 7, 10, 15])
def test_its_edge_is_found_at_the_end(periods: int, period: float, duty: float) -> None:
    """Rounding alone keeps what is compared below zero there, in half of the runs."""
    m = hb.Model("edge", domain="electrical")
    m.add(V=hb.Se(1.0), j=hb.One(), R=hb.R(1.0), C=hb.C(0.1))
    m.bond("V -> j", "j -> R", "j -> C")
    saw, edge = f"mod(time, {period!r})", duty * period
    rules = [f"off -> on when {saw} >= {edge!r}", f"on -> off when {saw} < {edge!r}"]
    m.machine("k", states={"off": [], "on": ["j"]}, start="off", rules=rules)
    end = period * periods + edge
    run = hb.simulate(m, end)
    times = [e.t for e in run.events if e.cause != "start"]
    expected = [period * k + part for k in range(periods + 1) for part in (edge, period)]
    assert times == pytest.approx(expected[:-1], rel=1e-12)
    assert run.events[-1].steps[-1].mode == (1,)
