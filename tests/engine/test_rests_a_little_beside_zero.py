"""A state that rests beside zero by less than the error of a step, and a guard at zero."""

from __future__ import annotations

import math

import pytest

import hybond as hb

PIPE, UNIT, LIMIT = 456.0, 0.00127, 0.03


def drained(feed: float, start: float, *, turned: bool = False) -> hb.Model:
    """Return a tank that is fed, with a wide orifice behind a friction of flows."""
    m = hb.Model("drained")
    m.add(n=hb.Zero(), c=hb.C(26.0, q=start), feed=hb.Sf(feed))
    m.add(slot=hb.Zero(law="coulomb", limit=LIMIT))
    m.add(pipe=hb.R({"f": f"{PIPE}*sign(e)*sqrt(abs(e)/{UNIT})"}))
    m.bond("feed -> n -> c", "slot -> n" if turned else "n -> slot")
    m.bond("pipe -> slot" if turned else "slot -> pipe")
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("start", [2.0, 56.0, -0.3])
@pytest.mark.parametrize(("feed", "turned"), [(-0.114, False), (0.114, False), (-0.114, True)])
def test_friction_does_not_swing_about_zero(
    feed: float, turned: bool, start: float, solver: str
) -> None:
    """The orifice carries what friction leaves: ((feed - limit)/k)^2 beside zero, 4e-11 V.

    Steps ended on the other side, within the tolerance, event after event.
    """
    run = hb.simulate(drained(feed, start, turned=turned), 1.0, on_error="return", solver=solver)
    rest = math.copysign(((abs(feed) - LIMIT) / PIPE) ** 2 * UNIT, feed)
    assert run.error is None
    assert run.final["c.e"] == pytest.approx(rest, rel=1e-6)
    assert len(run.events) < 200
