"""A valve behind a gyrator, driven by a source that passes zero and fills a storage that bends.

The valve takes a root, and what is across it is the square of what drives: a few steps of time
nearer to zero it is a thousandth. The rate of the storage beside it is unknown, too, and nothing
that the valve knows of.
"""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb

R, LEAK, TURN = 1.248, 0.2256, 0.13


def driven(beside: str) -> hb.Model:
    m = hb.Model("driven")
    m.add(j0=hb.One(), n=hb.Zero(), j1=hb.Zero(), t=hb.GY(TURN), r=hb.R(R))
    m.add(valve=hb.R({"f": "1.1*sign(e)*sqrt(abs(e)/0.373)"}), g=hb.G(LEAK))
    m.add(s=hb.Se("0.162*sin(5.08*time)"))
    m.bond("n -> s", "j0 -> r", "j0 -> n", "j1 -> valve", "j0 -> t.1", "j1 -> t.2", "g -> j0")
    if beside:
        m.add(c=hb.C({"e": beside}))
        m.bond("n -> c")
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("beside", ["", "0.799*((q/0.732) + (q/0.732)^3)", "sinh(q)"])
def test_the_valve_follows_through_zero(beside: str, solver: str) -> None:
    """Beside a storage it was refused where the source passes zero, or there were no values."""
    run = hb.simulate(driven(beside), 2.0, solver=solver)
    assert run.audit().holds()
    near = [0.618423751 + way for way in (-1e-6, -1e-10, 1e-10, 1e-6, 1e-3)]
    times = np.array([1e-16, 1e-12, 1e-9, 1e-6, *near, 1.0, 1.9])
    drives = np.abs(0.162 * np.sin(5.08 * times))
    across = TURN * 1.1 * np.sqrt(TURN / 0.373)
    whole = R + 1.0 / LEAK
    root = (2.0 * drives) / (across + np.sqrt(across**2 + 4.0 * whole * drives))
    found = np.abs(run.sample(times.tolist(), ["r.f"])["r.f"])
    assert found == pytest.approx(root**2, rel=1e-6)
