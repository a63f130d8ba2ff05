"""Solutions that Newton's method missed, left again, or took nonsense for.

Oracles: closed forms, and that what a run passed through can be read.
"""

from __future__ import annotations

import random

import numpy as np
import pytest

import hybond as hb
from hybond.errors import HybondError
from hybond.testing import random_recipe
from hybond.testing.variants import reordered, turned


@pytest.mark.parametrize("way", ["j -> r.2", "r.2 -> j"])
@pytest.mark.parametrize("order", [0, 1])
def test_a_flow_that_a_flat_law_lets_through_is_not_free(order: int, way: str) -> None:
    """A valve that is open takes all; beside efforts that cancel, the square seems to take any."""
    m = hb.Model("flat")
    m.add(j=hb.Zero(), valve=hb.R({"e": "if f > 0 then 16*f else 0"}), s=hb.Sf(11.2))
    m.add(q=hb.R({"e": "2e-5*f*abs(f)"}), r=hb.R([[66.6, -6.91], [-6.91, 2.54]]))
    m.add(i=hb.I(0.23, p=-0.0034))
    bonds = ["j -> i", "j -> q", "j -> r.1", way, "j -> valve", "j -> s"]
    random.Random(order).shuffle(bonds)
    m.bond(*bonds)
    run = hb.simulate(m, 1.0)
    # no effort is left, so the body keeps its speed and the square has no flow
    assert run["valve.f"].at(0.5) == pytest.approx(0.0034 / 0.23 - 11.2, rel=1e-9)
    assert abs(float(run["q.f"].at(0.5))) < 1e-9


@pytest.mark.sampled(1)
@pytest.mark.parametrize("bonds", ["as drawn", "turned"])
def test_a_step_by_a_pivot_that_is_rounding_leads_nowhere(bonds: str) -> None:
    """Behind a law that has ended and a valve that is shut, all numbers were lost beside 1e16."""
    recipe = random_recipe(20010337)
    if bonds == "turned":
        recipe = turned(recipe, 1).recipe
    with pytest.raises(HybondError, match="HB-N301") as caught:
        hb.simulate(recipe.model(), recipe.until)
    run = caught.value.partial
    assert run is not None
    # the flow of `0.548*sign(e)` through the gyrator of -0.706
    assert abs(float(run["j3.e"].at(0.1))) == pytest.approx(0.548 * 0.706, rel=1e-12)


@pytest.mark.parametrize("seed", [0, 18070176])
def test_what_has_no_solution_is_refused_in_any_order(seed: int) -> None:
    recipe = random_recipe(18070176)
    if seed:
        recipe = reordered(recipe, seed).recipe
    with pytest.raises(HybondError, match="HB-N301"):
        hb.simulate(recipe.model(), recipe.until)


def test_values_beside_a_jump_can_be_read_after_others() -> None:
    """What a `tanh` reads beside it was far away in the point that was read before."""
    recipe = random_recipe(18022248)
    t = recipe.until / 22.0
    run = hb.simulate(recipe.model(), 1.01 * t)
    friction, rest = np.asarray(run.sample([0.0, t], ["r0.e", "r0.f"])["r0.e"])
    assert abs(friction) == pytest.approx(0.75, rel=1e-12)
    assert abs(rest) == pytest.approx(0.75, rel=1e-12)


def test_a_stop_that_is_met_where_a_sign_comes_to_zero() -> None:
    """Nothing flows then, in any order: what the sign reads is the rounding of a sum."""
    recipe = random_recipe(18071395)
    for given in (recipe, reordered(recipe, 18071395).recipe):
        run = hb.simulate(given.model(), recipe.until)
        later = run.sample([0.95, 1.2], ["i2.p", "i3.p", "g1.e", "g1.f"])
        assert later["g1.f"][0] == later["g1.f"][1] == 0.0
        assert later["g1.e"][0] == later["g1.e"][1] == 0.0
        assert later["i2.p"][0] == pytest.approx(later["i2.p"][1], rel=1e-14)
        assert later["i3.p"][0] == pytest.approx(later["i3.p"][1], rel=1e-14)


def test_slopes_reach_over_no_bend_of_a_law_that_takes_next_to_nothing() -> None:
    """Stiff storages behind a square: steps were as short as its settling."""
    recipe = random_recipe(18074098)
    run = hb.simulate(recipe.model(), recipe.until, max_steps=4000)
    near = hb.simulate(recipe.model(), recipe.until, max_steps=4000, rtol=1e-7)
    for name in recipe.stored:
        times = np.linspace(0.1, 0.9, 5) * recipe.until
        one, two = (np.asarray(r.sample(times, [name])[name]) for r in (run, near))
        assert np.abs(one - two).max() <= 1e-5 * np.abs(one).max() + 1e-12


@pytest.mark.parametrize("way", ["as drawn", "turned", "reordered"])
@pytest.mark.parametrize(
    ("seed", "valve", "scale", "factor"),
    [(18064769, "g5", 0.646, 0.612), (19053787, "g3", 5.22, 0.00154)],
)
def test_a_square_behind_a_given_flow_is_solved_beside_efforts_that_are_zero(
    seed: int, valve: str, scale: float, factor: float, way: str
) -> None:
    """No shorter step seemed to help: rounding of the zeros was as large in the next one."""
    recipe = random_recipe(seed)
    if way != "as drawn":
        recipe = (turned if way == "turned" else reordered)(recipe, seed).recipe
    for t in (0.0, 0.05 * recipe.until):
        # the first values that are read of a run are found from nothing
        run = hb.simulate(recipe.model(), 0.1 * recipe.until)
        read = run.sample([t], [f"{valve}.e", f"{valve}.f"])
        flow = abs(float(read[f"{valve}.f"][0]))
        assert flow > 0.01
        assert abs(float(read[f"{valve}.e"][0])) == pytest.approx(scale * (flow / factor) ** 0.5)
