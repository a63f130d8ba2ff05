"""Whatever happens within a slice, whoever looks on may end the run."""

from __future__ import annotations

import time

import pytest
from engine.by_engine import EngineModel, EngineRun

import hybond as hb
from hybond.engine.compiled.sliced import RAISED
from hybond.engine.tables import tables_of
from hybond.errors import HybondError
from hybond.testing import random_recipe


class Enough(Exception):
    pass


def swinging(law: str) -> hb.Model:
    m = hb.Model("swing")
    m.add(c=hb.C("1", q="1"), i=hb.I({"f": law}, p=0.0), r=hb.R({"e": "0.01*f^3"}), j=hb.One())
    m.bond("j -> c", "j -> i", "j -> r")
    return m


@pytest.mark.parametrize("law", ["p", "p + p^3", "sinh(p)"])
def test_an_onlooker_ends_a_slice_that_has_no_end(law: str) -> None:
    """All of a run is one slice; what was made before stays, with all its rows."""
    tables = tables_of(swinging(law).flatten(), until=1e9, tells=True, max_steps=10**9)
    run = EngineRun(EngineModel(tables))
    looked = []

    def look() -> None:
        looked.append(run.t)
        if len(looked) == 3:
            raise Enough

    run.onlooker.asked = look
    rows = []
    with pytest.raises(Enough):
        rows += list(run.slices(steps=-1))
        pytest.fail("the run has ended")
    assert len(looked) == 3
    assert run.status == RAISED
    assert 0.0 < run.t < 1e9


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", [427293, 910287])
def test_laws_without_a_solution_are_refused_at_once(seed: int) -> None:
    """Sources that jump by rounding, and edges that lead nowhere, began anew without end.

    A law of each gives no value where the motion is led: ``sign`` between its two values.
    """
    recipe = random_recipe(seed)
    begun = time.process_time()

    def progress(_: float, __: int) -> None:
        if time.process_time() - begun > 10.0:
            raise Enough

    with pytest.raises(HybondError) as caught:
        hb.simulate(recipe.model(), recipe.until, progress=progress)
    assert caught.value.code == "HB-N301"
    assert "within a jump" in caught.value.hint
    assert caught.value.partial.stats["steps"] < 1000
