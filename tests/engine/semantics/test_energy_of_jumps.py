"""Energy that a jump creates and no source supplies is warned of, in joules."""

from __future__ import annotations

import numpy as np
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
        "that no source supplies: an impact law says so, by pre() or by its coefficients (the "
        "first that does)"
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


@pytest.mark.parametrize(
    ("source", "bridged"),
    [("5*sin(w*4*time)", False), ("5*sin(w*4*time)", True), ("4*sin(w*3*time) + 2*time", False)],
)
@pytest.mark.parametrize("dual", [False, True])
def test_what_a_jump_of_rounding_sweeps_up_is_not_created(
    source: str, bridged: bool, dual: bool
) -> None:
    """Two emptied storages follow a source below zero through diodes, the second one by dust."""
    m = hb.Model("emptied", parameters={"w": 1.0})
    node, across, store, give = (
        (hb.One, hb.Zero, hb.I, hb.Sf) if dual else (hb.Zero, hb.One, hb.C, hb.Se)
    )
    full = {"p": 0.7} if dual else {"q": 0.7}
    m.add(a=node(), b=node(), m=node(), A=store(0.3), B=store(2.2, **full), S=give(source))
    m.add(c=across(law="diode"), d=across(law="diode"))
    m.bond("a -> A", "b -> B", "m -> S", "a -> c -> m", "b -> d -> m")
    if bridged:
        m.add(x=across(law="diode"))
        m.bond("a -> x -> b")
    run = hb.simulate(m, until=2.5)
    t = np.linspace(0.0, 2.5, 100_001)
    given = 5 * np.sin(4 * t) if "5" in source else 4 * np.sin(3 * t) + 2 * t
    # each has what the source has had at its lowest, and no more than at the start
    stored = "p" if dual else "q"
    for name, size, start in (("A", 0.3, 0.0), ("B", 2.2, 0.7)):
        least = min(start, size * float(given.min()))
        assert run[f"{name}.{stored}"].at(2.5) == pytest.approx(least, rel=1e-6)
    assert run.audit().holds()


@pytest.mark.parametrize("bond", ["w -> o", "o -> w"])
@pytest.mark.parametrize("slope", [10.0, 2.0, -0.5])
def test_a_source_that_follows_what_an_impact_moves_gives_on_the_way(
    slope: float, bond: str
) -> None:
    """A wall whose speed reads the momentum of what it strikes; the run was called unsound."""
    m = hb.Model("follows")
    m.add(a=hb.I(1.0, p=-0.5), n=hb.One(), c=hb.Zero(law="unilateral", restitution=0.5))
    m.add(w=hb.Sf(f"30 - {slope}*a.p"), o=hb.One())
    m.bond("n -> a", bond, "o -> c", "c -> n")
    run = hb.simulate(m, 1.0)
    # w(p) - p after it is -1/2 times that before
    after = (30.0 + 0.5 * (30.0 + 0.5 * slope + 0.5)) / (1.0 + slope)
    assert run["a.p"].at(0.5) == pytest.approx(after, rel=1e-12)
