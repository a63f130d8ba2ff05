"""Pieces of a continuous law at an instant: which of them it is there changes nothing.

A flow that dies away behind a leak that blocks (``if e > 0 then G*e else 0``): the error of a step
puts it a last place past its end, in whose piece it is led back by more than rounding. The pieces
followed each other without end (HB-N401) at tolerances of 1e-9 and less; a moment later the law is
on the side to which it is led.
"""

from __future__ import annotations

import pytest

import hybond as hb
from hybond.testing import random_recipe


@pytest.mark.parametrize("rtol", [1e-9, 1e-10, 1e-11, 1e-12])
def test_a_leak_that_nothing_flows_through_any_more_blocks(rtol: float) -> None:
    recipe = random_recipe(112023275)
    right = hb.simulate(recipe.model(), until=recipe.until, rtol=1e-6)
    run = hb.simulate(recipe.model(), until=recipe.until, rtol=rtol)
    assert run.status == "ok" and run.audit().holds()
    for path in recipe.stored:
        size = abs(right[path].y).max()
        assert run.final[path] == pytest.approx(right.final[path], abs=1e-5 * size)
