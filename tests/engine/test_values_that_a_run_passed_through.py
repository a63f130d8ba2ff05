"""What a run passes through can be read alone; where laws have no answer, no run goes on."""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.testing import random_recipe


def orifice_in_row(charge: float) -> hb.Model:
    """A charge that runs out through an orifice, a gyrator and what resists behind it."""
    m = hb.Model("row")
    m.add(c=hb.C(1.0, q=charge), j=hb.One(), o=hb.R({"f": "7*sign(e)*sqrt(abs(e))"}))
    m.add(g=hb.GY(-0.1), z=hb.Zero(), b=hb.R({"e": "3*f + f^3"}))
    m.bond("c -> j -> o", "j -> g.1", "g.2 -> z", "b -> z")
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau", "auto"])
@pytest.mark.parametrize("charge", [1e-3, 1e-12, 1e-20, 1e-30, 1e-60])
def test_a_root_far_below_one_is_found_from_nothing(charge: float, solver: str) -> None:
    # q = (f/7)^2 + f*0.01/3, the cube being nothing
    run = hb.simulate(orifice_in_row(charge), 1e-9, solver=solver)
    a, b = 1.0 / 49.0, 0.01 / 3.0
    flow = 2.0 * charge / (b + math.sqrt(b * b + 4.0 * a * charge))
    assert run["o.f"].at(0.0) == pytest.approx(flow, rel=1e-6 + 10.0 * charge)
    assert run["o.e"].at(0.0) == pytest.approx((flow / 7.0) ** 2, rel=1e-6 + 10.0 * charge)


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
    assert run.error is not None and run.error.code == "HB-N301"
    assert run.t_end == pytest.approx(1.0, abs=1e-9)
    assert run["r.f"].at(0.5) == pytest.approx(half, rel=1e-9)


def test_laws_of_sums_are_solved_from_far_away() -> None:
    # where an effort of 1700 has come to nothing between two accepted points, and is read there
    recipe = random_recipe(905383)
    run = hb.simulate(recipe.model(), recipe.until)
    assert run.status == "ok"
    assert run.audit().holds(1e-6)
