"""What a run passes through can be read alone; where laws have no answer, no run goes on."""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.testing import random_recipe


@pytest.mark.parametrize("solver", ["rk45", "radau", "auto"])
@pytest.mark.parametrize(
    ("law", "half"),
    [
        ("tanh(2*f)", 0.5 * math.atanh(0.5)),
        ("2*f/(1 + abs(2*f))", 0.5),
        ("max(-1, min(1, f))", 0.5),
        ("2/3.141592653589793*atan(f)", 1.0),
    ],
)
def test_a_law_that_has_ended_in_its_limit_gives_no_more(
    law: str, half: float, solver: str
) -> None:
    """Behind a gyrator of 1 the effort is the time, in s; laws end at 1."""
    m = hb.Model("ended")
    m.add(s=hb.Sf("1*time"), a=hb.One(), g=hb.GY(1.0), b=hb.One(), r=hb.R({"e": law}))
    m.add(k=hb.C(1.0, q=1.0), kr=hb.R(1.0), n=hb.Zero())
    m.bond("s -> a -> g.1", "g.2 -> b -> r", "n -> k", "n -> kr")
    run = hb.simulate(m, 2.0, solver=solver, on_error="return")
    # a flow that grows without bound towards the end is told as that, if a step comes so near
    codes = ("HB-N301", "HB-N203") if "atan" in law else ("HB-N301",)
    assert run.error is not None and run.error.code in codes
    assert run.t_end == pytest.approx(1.0, abs=1e-9)
    assert run["r.f"].at(0.5) == pytest.approx(half, rel=1e-9)


def test_laws_of_sums_are_solved_from_far_away() -> None:
    # where an effort of 1700 has come to nothing between two accepted points, and is read there
    recipe = random_recipe(905383)
    run = hb.simulate(recipe.model(), recipe.until)
    assert run.status == "ok"
    assert run.audit().holds(1e-6)
