"""Junction laws beside resistors that jump or storage that bends: tried branch by branch.

What such a graph answers to its laws is no linear function of what they give, or none at all: a
resistor ``sign(f)`` that is held at rest has no value for any force but zero.
"""

import math
from typing import Any, Literal

import pytest

import hybond as hb


def runs(m: hb.Model, *engines: Literal["library", "python"]) -> list[hb.Result]:
    """Run it for a while by each engine, by that there is if none is named."""
    return [hb.simulate(m, 1e-3, engine=e) for e in engines] or [hb.simulate(m, 1e-3)]


def lost(run: hb.Result) -> float:
    """Return the energy that jumps have lost, in J."""
    visits = [visit for event in run.trace.events for visit in event.steps]
    return sum(visit.energy.lost for visit in visits if visit.energy is not None)


@pytest.mark.parametrize("gap", [None, "g"])
def test_a_sign_at_an_open_contact_does_not_stop_an_impact_elsewhere(gap: str | None) -> None:
    m = hb.Model("beside")
    m.add(o=hb.Zero(law="unilateral", gap=gap) if gap else hb.Zero(law="unilateral"))
    m.add(r=hb.R({"e": "1.19*sign(f)"}), q=hb.R(1.0), v=hb.One(), a=hb.I(1.0), b=hb.I(3.0, p=6.0))
    m.bond("q -> o", "o -> r", "v -> a", "v -> b")
    if gap:
        m.signal(g=hb.Integral("-o.f", start=0.3))
    for run in runs(m):
        # one velocity of both masses: p = 6 in parts of 1 to 3
        assert run["a.p"].at(5e-4) == pytest.approx(1.5, rel=1e-12)
        assert run["b.p"].at(5e-4) == pytest.approx(4.5, rel=1e-12)
        assert run["o.e"].at(5e-4) == 0.0
        assert run["r.f"].at(5e-4) == 0.0


@pytest.mark.parametrize("masses", [(1.0, 1.0), (0.5, 4.0)])
def test_a_contact_closes_without_rebound_while_a_sign_is_held(masses: tuple[float, float]) -> None:
    one, two = masses
    m = hb.Model("closes")
    m.add(o=hb.Zero(law="unilateral"), r=hb.R({"e": "1.19*sign(f)"}), q=hb.R(1.0))
    m.add(j=hb.Zero(law="unilateral"), v=hb.One(), w=hb.One())
    m.add(a=hb.I(one, p=-1.0), b=hb.I(two, p=0.5))
    m.bond("q -> o", "o -> r", "j -> v", "v -> a", "w -> j", "w -> b")
    # bond w -> j brings b's force with the other sign: both lose what the contact gives to a
    for run in runs(m):
        speeds = [run[f"{name}.f"].at(5e-4) for name in "ab"]
        assert speeds[0] == pytest.approx(speeds[1], abs=1e-12)
        # what the contact gives to one it takes from the other
        momentum = [run[f"{name}.p"].at(5e-4) for name in "ab"]
        assert momentum[0] + 1.0 == pytest.approx(0.5 - momentum[1], abs=1e-12)
        assert momentum[0] >= -1.0


def test_a_charge_on_an_open_contact_is_lost_beside_a_sign() -> None:
    m = hb.Model("lost")
    m.add(j=hb.Zero(law="unilateral"), c=hb.C(2.0, q=-0.3), r=hb.R({"e": "sign(f)"}))
    m.bond("r -> j", "j -> c")
    for run in runs(m, "python"):
        assert run["c.q"].at(5e-4) == 0.0
        assert lost(run) == pytest.approx(0.3**2 / 4.0, rel=1e-12)


@pytest.mark.parametrize("ratio", [-0.291, 1.7])
def test_bent_storage_that_two_laws_hold_at_zero_through_a_gyrator(ratio: float) -> None:
    m = hb.Model("bent")
    m.add(j=hb.Zero(law="diode"), k=hb.One(law="unilateral"), t=hb.GY(ratio))
    m.add(i=hb.I({"f": "0.391*((p/7.74) + (p/7.74)^3)"}, p=-6.46))
    m.add(c=hb.C({"e": "0.512*(q/6.81e-06)"}, q=6.07e-06))
    m.bond("k -> i", "j -> c", "j -> t.1", "t.2 -> k")
    y = 6.46 / 7.74
    energy = 7.74 * 0.391 * (y**2 / 2.0 + y**4 / 4.0) + 0.512 / 6.81e-06 * 6.07e-06**2 / 2.0
    for run in runs(m):
        # the flow of i may only be positive; what it takes to that brings both to rest
        assert abs(run["i.p"].at(5e-4)) < 1e-9
        assert abs(run["c.q"].at(5e-4)) < 1e-15
        assert lost(run) == pytest.approx(energy, rel=1e-6)


@pytest.mark.parametrize("push", [-1.78, -0.2])
def test_a_diode_in_series_with_a_sign_blocks(push: float) -> None:
    m = hb.Model("series")
    m.add(s=hb.Se(push), d=hb.One(law="diode"), v=hb.One(), r=hb.R(1.0))
    m.add(g=hb.R({"f": "0.591*sign(e)"}), c=hb.C({"e": "1.11*sinh(q/1.58e-9)"}, q=1.24e-9))
    m.bond("s -> v", "v -> d", "v -> g", "v -> c", "v -> r")
    for run in runs(m):
        assert run["v.f"].at(5e-4) == 0.0
        assert run["c.q"].at(5e-4) == 1.24e-9
        # all of what drives it is blocked
        blocked = push - 1.11 * math.sinh(1.24 / 1.58)
        assert run["d.e"].at(5e-4) == pytest.approx(blocked, rel=1e-12)


def test_a_rebound_is_not_made_plastic_by_a_trial() -> None:
    m = hb.Model("rebounds")
    m.add(o=hb.Zero(law="unilateral"), r=hb.R({"e": "1.19*sign(f)"}), q=hb.R(1.0))
    m.add(j=hb.Zero(law="unilateral", restitution=0.5), v=hb.One(), i=hb.I(1.0, p=-1.0))
    m.bond("q -> o", "o -> r", "j -> v", "v -> i")
    with pytest.raises(hb.NumericsError, match="HB-N301"):
        hb.simulate(m, 1.0)


ORDERS = [
    ["push", "hold", "drain", "c", "line", "g", "i"],
    ["drain", "hold", "push", "c", "line", "g", "i"],
    ["i", "g", "line", "c", "drain", "hold", "push"],
]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("order", ORDERS, ids=["hold", "drain", "last"])
def test_friction_beside_a_sign_does_not_break_loose_where_another_comes_to_rest(
    order: list[str], way: float, solver: Literal["auto", "radau", "rk45"]
) -> None:
    parts: dict[str, Any] = {
        "push": hb.Se(-0.3),
        "hold": hb.One(law="coulomb", limit=1.75),
        "drain": hb.Zero(law="coulomb", limit=1.76),
        "c": hb.C(0.71, q=0.78 * way),
        "line": hb.One(),
        "g": hb.R({"f": "0.763*sign(e)"}),
        "i": hb.I(1.0),
    }
    m = hb.Model("holds")
    m.add(**{name: parts[name] for name in order})
    m.bond("push -> hold -> line", "line -> g", "line -> i", "line -> drain", "c -> drain")
    run = hb.simulate(m, 1.0, solver=solver)
    # the line is held by more than pushes it, and the charge goes at 1.76/s until there is none
    assert run.status == "ok"
    for t in (0.1, 0.4, 0.44, 0.46, 0.9):
        left = way * max(0.0, 0.78 - 1.76 * t)
        assert run["c.q"].at(t) == pytest.approx(left, abs=1e-12)
    assert run["i.p"].at(0.9) == 0.0
    assert run["hold.e"].at(0.9) == pytest.approx(-0.3, rel=1e-12)
