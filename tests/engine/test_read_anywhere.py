"""Reading a run by the library: at rest, at its start, by many at once, of a copy."""

from __future__ import annotations

import pytest

import hybond as hb


def ball() -> hb.Model:
    """Return a ball that loses half its speed at each impact, and comes to rest."""
    m = hb.Model("ball", domain="translational")
    m.add(
        weight=hb.Se("-9.81 N"),
        ball=hb.I("1 kg"),
        v=hb.One(),
        floor=hb.Zero(),
        rebound=hb.Sf("-0.5*pre(v.f)"),
    )
    m.bond("weight -> v -> ball", "rebound -> floor -> v")
    m.signal(height=hb.Integral("v.f", start="1 m"))
    m.machine(
        "M",
        states={"away": [], "impact": ["floor"]},
        start="away",
        rules=[
            "away -> impact when height <= 0 and v.f < 0",
            "impact -> away when pre(ball.p) >= 0",
        ],
    )
    return m


def test_the_start_knows_what_the_model_gave() -> None:
    m = hb.Model("joined", domain="electrical")
    m.add(a=hb.C("1 F", e="10 V"), b=hb.C("2 F", e="4 V"), r=hb.R("1 ohm"), node=hb.Zero())
    m.bond("node -> a", "node -> b", "node -> r")
    for engine in ("library", "reference"):
        start = hb.simulate(m, until=1, engine=engine).events[0]
        assert start.before.tolist() == [10.0, 8.0]
        assert start.after == pytest.approx([6.0, 12.0])


@pytest.mark.parametrize("name", ["max_events", "max_steps"])
@pytest.mark.parametrize("many", [2**31, 2**32 + 1, 10**12])
def test_a_limit_may_be_as_large_as_one_likes(name: str, many: int) -> None:
    limits = {name: many}
    assert hb.simulate(ball(), until=1, engine="library", **limits).status == "ok"  # type: ignore[arg-type]
