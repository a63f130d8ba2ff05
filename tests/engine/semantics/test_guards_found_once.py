"""A guard whose instant the repeated step does not show is looked for again at that instant.

Seed 772995: the second try asked for a kink at a time of infinity, and the run ended in HB-N411.
"""

from __future__ import annotations

import pytest

import hybond as hb
from hybond.testing import random_recipe


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_a_second_look_is_at_the_instant_that_was_found(solver: str) -> None:
    recipe = random_recipe(772995)
    run = hb.simulate(recipe.model(), recipe.until, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    assert [e.t for e in run.events] == pytest.approx([0.0, 0.00962501952, 0.256793336], abs=1e-6)
    # radau never looked twice: it is the other opinion, at a far smaller tolerance
    other = hb.simulate(recipe.model(), recipe.until, solver="radau", rtol=1e-11)
    for name, x in other.final.items():
        most = max(abs(float(other[name].at(t))) for t in (0.0, 0.1, 0.2, recipe.until))
        assert run.final[name] == pytest.approx(x, abs=1e-6 * most), name
