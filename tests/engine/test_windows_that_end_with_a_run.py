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
