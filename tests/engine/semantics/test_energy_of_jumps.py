"""Energy that a jump creates and no source supplies is warned of, in joules."""

from __future__ import annotations

import pytest

import hybond as hb


def impact(eps: float, *, brake: bool) -> hb.Model:
    """Return two bodies that collide by Newton's law, the second perhaps caught at that instant."""
    m = hb.Model("impact", domain="translational")
    m.add(a=hb.I(1.0, f=1.0), b=hb.I(2.0, f=-0.5), s1=hb.One(), s2=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf(f"-{eps}*pre(s1.f - s2.f)"), brake=hb.Zero(), wall=hb.Sf(0.0))
    m.bond("s1 -> a", "s2 -> b", "s1 -> contact -> s2", "contact -> rebound")
    m.bond("s2 -> brake", "wall -> brake")
    m.signal(gap=hb.Integral("s2.f - s1.f", start="1 m"))
    m.machine(
        "pair",
        states={"apart": [], "collide": ["contact"]},
        start="apart",
        rules=[
            "apart -> collide when gap <= 0 and s1.f > s2.f",
            "collide -> apart when pre(a.f) <= pre(b.f)",
        ],
    )
    rules = ["free -> locked when gap <= 0"] if brake else []
    m.machine("lock", states={"free": [], "locked": ["brake"]}, start="free", rules=rules)
    return m


def created(run: hb.Result) -> list[str]:
    return [w for w in run.warnings if "creates" in w]


def test_energy_created_in_an_impact_is_warned_of() -> None:
    (text,) = created(hb.simulate(impact(0.9, brake=True), until=1.0))
    # the free body leaves at 1.35 m/s: 1.35^2/2 J of 1/2 J + 1/4 J
    assert text == (
        "at t = 0.666666667 s the jump into mode (collide, locked) creates 0.16125 J "
        "that no source supplies, a law that reads pre() being none (the first that does)"
    )


def test_a_restitution_above_one_is_warned_of() -> None:
    (text,) = created(hb.simulate(impact(1.2, brake=False), until=1.0))
    # at rest about the centre of mass: energy goes with the square of the restitution
    assert "creates 0.33 J" in text


@pytest.mark.parametrize("eps", [0.0, 0.9, 1.0])
def test_an_impact_that_creates_nothing_is_not_warned_of(eps: float) -> None:
    assert not created(hb.simulate(impact(eps, brake=False), until=1.0))


def test_what_a_source_supplies_in_a_jump_is_not_created() -> None:
    m = hb.Model("charge", domain="electrical")
    m.add(V=hb.Se(5.0), s=hb.One(), c=hb.C(1.0), n=hb.Zero(), r=hb.R(1.0))
    m.bond("V -> s -> n -> c", "n -> r")
    m.machine("m", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time >= 1"])
    run = hb.simulate(m, until=2.0)
    assert run["c.q"].at(1.5) == pytest.approx(5.0)
    assert not created(run)
