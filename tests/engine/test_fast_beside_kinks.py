"""What is fast beside the run: how often laws are solved in a step, and what comes of it.

Of a motion of millions of periods a run makes as many steps as it may; what a step costs is how
often it solves for bond variables. Counted are these, in Python; oracles are energy and closed
forms.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest

import hybond as hb
import hybond.engine.mode.solving as solving
from hybond.engine.mode.left_free import leakage, undetermined
from hybond.engine.run import roots_reached
from hybond.errors import HybondError
from hybond.testing import random_recipe


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often some functions of the engine are called."""
    calls: Counter[str] = Counter()

    def count(room: Any, name: str) -> None:
        inner: Callable[..., Any] = getattr(room, name)

        def outer(*given: Any) -> Any:
            calls[name] += 1
            return inner(*given)

        monkeypatch.setattr(room, name, outer)

    count(solving, "newton")
    count(undetermined, "directions_left")
    count(leakage, "pseudo_inverse")
    count(roots_reached, "leads_to_rest")
    return calls


def swings(law: str) -> hb.Model:
    """A mass on a spring, and laws that are solved for and take next to nothing from it."""
    m = hb.Model("swings")
    m.add(
        c=hb.C(1.0, q=1.0),
        i=hb.I(1.0, p=0.0),
        r=hb.R({"f": law}),
        rest=hb.R({"e": "1e-6*(f + f^3)"}),
        node=hb.One(),
        side=hb.Zero(),
        way=hb.One(),
    )
    m.bond("c -> node", "node -> i", "node -> side", "side -> r", "side -> way", "way -> rest")
    return m


@pytest.mark.slow
def test_what_is_far_from_rest_is_not_led_there_in_trial(counted: Counter[str]) -> None:
    run = hb.simulate(swings("1e-3*sign(e)*sqrt(abs(e))"), 6.0, engine="python")
    assert counted["leads_to_rest"] < run.stats["steps"] / 4
    assert run.sample([6.0], ["c.q"])["c.q"][0] == pytest.approx(math.cos(6.0), abs=2e-5)


def test_what_a_loop_leaves_free_is_found_once(counted: Counter[str]) -> None:
    m = hb.Model("loop")
    m.add(c=hb.C(1.0, q=1.0), r=hb.R({"e": "f + f^3"}), a=hb.Zero(), b=hb.Zero())
    m.bond("one: c -> a", "two: a -> b", "three: a -> b", "four: b -> r")
    run = hb.simulate(m, 2.0, engine="python")
    assert counted["directions_left"] < 5
    assert counted["pseudo_inverse"] < 3
    last = run.sample([2.0], ['"two".f', '"three".f', '"four".f'])
    flow = last['"four".f'][0]
    assert last['"two".f'][0] == pytest.approx(0.5 * flow, rel=1e-12)
    assert last['"three".f'][0] == pytest.approx(0.5 * flow, rel=1e-12)
    # f + f^3 is what is stored, so log(f) + 1.5 f^2 falls as time passes
    begins = 0.6823278038280193
    fallen = math.log(begins / flow) + 1.5 * (begins**2 - flow**2)
    assert fallen == pytest.approx(2.0, abs=1e-6)


def test_behind_one_of_many_kinks_steps_begin_as_long_as_they_were() -> None:
    recipe = random_recipe(45064013)
    with pytest.raises(HybondError) as told:
        hb.simulate(recipe.model(), recipe.until, max_steps=1500)
    assert told.value.code == "HB-N409"
    partial = told.value.partial
    assert partial is not None
    assert partial.stats["rejected"] < 3 * partial.stats["steps"]
    assert partial.stats["evaluations"] < 80 * partial.stats["steps"]
