"""What a run passes through can be read alone; where laws have no answer, no run goes on."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

import hybond as hb
from hybond.testing import random_recipe


@pytest.mark.sampled(3)
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


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("method", [hb.Auto(), hb.MoreauJean(step=0.5)], ids=["auto", "steps"])
@pytest.mark.parametrize(
    ("law", "part"),
    [
        ("2*x/(1 + x^2)", lambda x: 2 * x / (1 + x**2)),
        ("4*x/3^0.75/(1 + x^4)", lambda x: 4 * x / 3**0.75 / (1 + x**4)),
        ("3^1.5/2*x/(1 + x^2)^1.5", lambda x: 3**1.5 / 2 * x / (1 + x**2) ** 1.5),
    ],
)
def test_a_law_that_falls_off_behind_its_top_gives_no_more(
    law: str, part: Callable[[float], float], method: hb.Auto | hb.MoreauJean, turned: bool
) -> None:
    """Torque over slip: far behind the top its numbers are beyond all bounds, and no answer."""
    way = "(-f/1e-3)" if turned else "(f/1e-3)"
    own = f"{'-' if turned else ''}7*({law.replace('x', way)})"

    def driven(push: float) -> hb.Model:
        m = hb.Model("slip", domain="rotational")
        m.add(push=hb.Se(7.0 * push), w=hb.One(), slip=hb.R({"e": own}))
        m.bond("push -> w", "slip -> w" if turned else "w -> slip")
        return m

    with pytest.raises(hb.NumericsError, match="HB-N301"):
        hb.simulate(driven(1.2), 1.0, method=method)
    run = hb.simulate(driven(0.9), 1.0, method=method)
    assert part(float(run["w.f"].at(0.5)) / 1e-3) == pytest.approx(0.9, rel=1e-9)


def test_laws_of_sums_are_solved_from_far_away() -> None:
    # where an effort of 1700 has come to nothing between two accepted points, and is read there
    recipe = random_recipe(905383)
    run = hb.simulate(recipe.model(), recipe.until)
    assert run.status == "ok"
    assert run.audit().holds(1e-6)
