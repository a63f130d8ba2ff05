"""A valve that opens into an orifice: its flow is a root, as steep as can be where it begins."""

from __future__ import annotations

import pytest

import hybond as hb


def valve(k: float, sign: int) -> hb.Model:
    """Return a vessel below the pressure of a valve, filled at unit flow; behind it an orifice."""
    m = hb.Model("valve")
    m.add(
        pump=hb.Sf(1.0 * sign),
        vessel=hb.C(1.0, q=-1.39 * sign),
        node=hb.Zero(),
        valve=hb.One(law="unilateral"),
        orifice=hb.R({"e": f"{k}*f*abs(f)"}),
    )
    m.bond("pump -> node", "node -> vessel", "valve -> orifice")
    m.bond("node -> valve" if sign > 0 else "valve -> node")
    return m


@pytest.mark.parametrize("k", [5e-9, 1e-9, 1e-12])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_valve_before_an_orifice_opens_and_does_not_chatter(k: float, sign: int) -> None:
    # it opens at 1.39 s, and within 2 k s all that is pumped flows through it
    run = hb.simulate(valve(k, sign), 3.0, max_events=100)
    assert len(run.events) <= 12
    end = run.sample([3.0], ["vessel.q", "orifice.f"])
    assert end["orifice.f"][0] == pytest.approx(1.0, rel=1e-6)
    assert end["vessel.q"][0] == pytest.approx(k * sign, rel=1e-6)
    assert run.audit().energy < 1e-9
