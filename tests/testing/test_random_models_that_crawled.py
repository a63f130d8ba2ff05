"""Random models that took ten seconds to minutes, for steps and looks that led nowhere."""

from __future__ import annotations

import pytest

import hybond as hb
from hybond.testing import random_recipe


def ends(seed: int) -> hb.Result:
    recipe = random_recipe(seed)
    return hb.simulate(recipe.model(), recipe.until, max_steps=300)


@pytest.mark.parametrize("seed", [410242, 412424, 412914])
def test_what_is_held_at_zero_beside_a_source_that_begins_at_zero_takes_no_steps(seed: int) -> None:
    """Its rate is the rounding of what the source pushes, which grows long after the start."""
    run = ends(seed)
    assert run.status == "ok"
    for path in random_recipe(seed).stored:
        assert run.final[path] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("seed", "kept"),
    [
        (410538, {"c1.q": 1.09, "c5.q": 1.33}),
        (410920, {"i0.p": -0.12, "c3.q": 0.0, "w0": -0.12 * 1.05}),
    ],
)
def test_kinks_of_laws_that_rounding_moves_are_not_looked_for(
    seed: int, kept: dict[str, float]
) -> None:
    """Nothing moves for the whole run: a flow is at the corner of its law, or at its flat place."""
    run = ends(seed)
    for path, x in kept.items():
        assert run.final[path] == pytest.approx(x, abs=1e-12)


@pytest.mark.parametrize("seed", [410886, 345980, 346235])
def test_a_jump_that_steps_only_feel_is_refused_and_not_crept_along(seed: int) -> None:
    """A store behind ``sign``: its stages reach over zero, its ends do not."""
    with pytest.raises(hb.NumericsError) as caught:
        ends(seed)
    assert caught.value.code == "HB-N410"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", [133960, 411579])
def test_steps_of_no_time_end_at_what_has_no_solution(seed: int) -> None:
    """``e = sign(f)`` at a force below its own: no flow gives it, and time stood at 1e-321 s."""
    with pytest.raises(hb.NumericsError) as caught:
        recipe = random_recipe(seed)
        hb.simulate(recipe.model(), recipe.until, max_steps=20_000)
    assert caught.value.code == "HB-N301"


def test_what_stands_still_after_a_jump_balances_its_power() -> None:
    """Inductors share constant flows: efforts are rounding, and power is none of what is stored."""
    recipe = random_recipe(813582)
    run = hb.simulate(recipe.model(), recipe.until)
    half = run.sample([0.5 * run.t_end], list(recipe.stored))
    for path in recipe.stored:
        assert run.final[path] == pytest.approx(float(half[path][0]), rel=1e-12)
    assert run.audit().holds(1e-8)
