"""What ``pre()`` reads stays what it was through all modes of an instant, and so does its digit."""

from __future__ import annotations

import math

import pytest

import hybond as hb


def swinging(turned: bool, store: str, *, rules: list[str]) -> hb.Model:
    """Return a swing of 1 with a resistor that the state `a` switches on for no time at all."""
    m = hb.Model("swing")
    if store == "C":
        m.add(k=hb.C(1.0, q=1.0), w=hb.Zero(), s=hb.One(), o=hb.I(1.0), x=hb.One(), r=hb.R(1.0))
    else:
        m.add(k=hb.I(1.0, p=1.0), w=hb.One(), s=hb.Zero(), o=hb.C(1.0), x=hb.Zero(), r=hb.R(1.0))
    m.bond("w -> k", "w -> s -> o", "r -> x -> w" if turned else "w -> x -> r")
    m.machine("m", states={"a": ["x"], "b": [], "d": []}, start="b", rules=rules)
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("store", "read"), [("C", "pre(k.f)"), ("I", "pre(k.e)")])
@pytest.mark.parametrize("level", [0.8, 0.3, 0.95])
def test_a_rule_of_what_was_held_in_one_mode_of_an_instant_and_not_in_the_next(
    store: str, read: str, level: float, turned: bool
) -> None:
    """The step ends where the guard holds by more than rounding: of the flow that was there.

    In `a` more flows, and what was over the limit by rounding of that counted as being at it.
    """
    rules = [f"b -> a when {read} < -{level}", f"a -> d when {read} < -{level}"]
    run = hb.simulate(swinging(turned, store, rules=rules), until=2.0)
    (event,) = run.trace.events[1:]
    assert event.t == pytest.approx(math.asin(level), abs=1e-9)
    assert [step.kind for step in event.steps] == ["mythical", "continuous"]
    assert [f.values[read] for s in event.steps for f in s.fired] == pytest.approx([-level] * 2)
