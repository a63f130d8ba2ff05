"""Bodies that move as one and are apart by rounding of their positions are struck as one.

What a flight leaves of a gap of zero is 1e-17 m, of either sign. By that sign two bodies with a
contact that does not rebound took part in an impact together, or one after the other.
"""

from __future__ import annotations

import pytest

import hybond as hb


def row(gap: str, *, turned: bool = False, rotational: bool = False) -> hb.Model:
    """Return a body that flies towards two that touch each other, or nearly so."""
    domain = "rotational" if rotational else "translational"
    m = hb.Model("row", domain=domain)
    way = -1.0 if turned else 1.0
    for k, (mass, speed) in enumerate([(3.0, 1.0), (1.0, 0.0), (1.0, 0.0)]):
        m.add(**{f"v{k}": hb.One(), f"b{k}": hb.I(mass, f=way * speed)})
        m.bond(f"b{k} -> v{k}" if turned else f"v{k} -> b{k}")
    m.add(hit=hb.Zero(law="unilateral", gap="far", restitution=0.5))
    m.add(touch=hb.Zero(law="unilateral", gap="near"))
    m.bond("v0 -> hit -> v1", "v1 -> touch -> v2")
    m.signal(far=hb.Integral("v1.f - v0.f", start=0.3))
    m.signal(near=hb.Integral("v2.f - v1.f", start=gap))
    return m


@pytest.mark.parametrize("gap", ["-1e-17", "0", "1e-17", "1e-14"])
@pytest.mark.parametrize("given", [{}, {"turned": True}, {"rotational": True}])
def test_bodies_that_touch_but_for_rounding_are_struck_as_one(
    gap: str, given: dict[str, bool]
) -> None:
    """3 kg at 1 m/s against 2 kg with half of the speed given back: 0.4 and 0.9 m/s."""
    run = hb.simulate(row(gap, **given), 1.0)
    speeds = [run[f"v{k}.f"].at(1.0) for k in range(3)]
    assert speeds == pytest.approx([0.4, 0.9, 0.9], rel=1e-12)
    assert len(run.events) == 2 and run.audit().holds()


def test_bodies_that_are_apart_are_struck_one_after_the_other() -> None:
    """The first is hit alone, hits the second, which stays with it, and both are hit again."""
    run = hb.simulate(row("1e-6"), 1.0)
    first = [0.625, 1.125, 0.0]  # 3 kg against 1 kg
    both = first[1] / 2.0
    end = (3.0 * first[0] + 2.0 * both - 0.5 * 2.0 * (first[0] - both)) / 5.0
    assert run["v0.f"].at(1.0) == pytest.approx(end, rel=1e-12)
    assert run["v2.f"].at(1.0) == pytest.approx(end + 0.5 * (first[0] - both), rel=1e-12)
