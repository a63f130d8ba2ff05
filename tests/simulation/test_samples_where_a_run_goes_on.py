"""A run that is cut where a signal is sampled, and goes on: the whole, whatever happens there."""

from __future__ import annotations

import pytest

import hybond as hb

SAMPLED = {
    "clock": "if time >= 2 then 1 else 0",
    "counter": "u + 1",
    "input": "step",
    "machine": 'if M.state == "b" then 1 else 0',
    "level": "10 - c.q",
}


def filled(what: str) -> hb.Model:
    m = hb.Model("filled in steps")
    m.input(step=hb.Input(table=[[0, 1], [2.0, 1], [2.0, 4]]))
    m.add(c=hb.C(1.0), z=hb.Zero(), s=hb.Sf("u + 0*step"))
    m.machine("M", states={"a": [], "b": []}, start="a", rules=["a -> b when time >= 2"])
    m.bond("s -> z -> c")
    m.signal(u=hb.Sampled(SAMPLED[what], every=0.5))
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("cut", [1.9, 2.0, 2.5])
@pytest.mark.parametrize("what", SAMPLED)
def test_what_is_sampled_where_a_run_was_cut(what: str, cut: float) -> None:
    """A priori, and once: what is set at 2 s is of before the clock, the input and the machine."""
    model = filled(what)
    whole = hb.simulate(model, 4)
    expected = {"clock": 1.5, "counter": 18.0, "input": 2.5 + 1.5 * 4.0, "machine": 1.5}
    if what in expected:
        assert whole["c.q"].at(4) == pytest.approx(expected[what], rel=1e-12)
    for start in (hb.simulate(model, cut), whole.state(cut)):
        run = hb.simulate(model, 4, start=start)
        for t in (2.7, 4.0):
            assert run["c.q"].at(t) == pytest.approx(whole["c.q"].at(t), rel=1e-12)
