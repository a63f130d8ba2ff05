"""A vessel runs dry through a law that jumps at rest, and through one that is flat from there on.

The jump and the end of the flat piece are one instant: what the law that jumps says behind it is
nothing that the step up to there has moved by.
"""

from __future__ import annotations

from math import log

import pytest

import hybond as hb


def runs_dry(level: float) -> hb.Model:
    m = hb.Model("runs dry")
    m.add(node=hb.Zero(), c=hb.C(1.0, q=level))
    m.add(rub=hb.R({"f": "0.7*sign(e)"}), lid=hb.R({"e": "if f > 0 then 3.3*f else 0"}))
    m.bond("node -> c", "node -> rub", "node -> lid")
    return m


@pytest.mark.parametrize("level", [0.02 + 0.01 * k for k in (17, 36, 37, 41)])
@pytest.mark.parametrize("solver", ["auto", "rk45"])
def test_it_is_dry_when_it_is(level: float, solver: str) -> None:
    """Of sixty levels three were refused (HB-N411), as rates of both sides were compared."""
    run = hb.simulate(runs_dry(level), 1.28, solver=solver)
    dry = 3.3 * log(1.0 + level / (3.3 * 0.7))
    (event,) = (event for event in run.trace.events if event.t > 0.0)
    assert event.t == pytest.approx(dry, rel=1e-6)
    assert run["c.q"].at(1.28) == 0.0
    assert run.audit().holds()
