"""Runs that more than one file of tests measures."""

from __future__ import annotations

import pytest

import hybond as hb


@pytest.fixture(scope="session")
def discharge() -> hb.Result:
    """Return a capacitor of 1 mF at 10 V that a resistor of 1 kohm empties, for 3 s."""
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    return hb.simulate(m, until="3 s", rtol=1e-12)


@pytest.fixture(scope="session")
def waves() -> hb.Result:
    """Return five periods of 20 ms: a square wave, a half-wave rectified sine, a pulse, a ramp."""
    m = hb.Model("waves", domain="electrical")
    m.signal(
        x="mod(time, 20 ms) / (20 ms)",
        square="if x < 0.5 then 1 else -1",
        half="max(sin(2*pi*50*time/(1 s)), 0)",
        pulse="if x < 0.25 then 4 else 0",
        ramp="x",
    )
    m.add(u=hb.Sf("1 A"), c=hb.C("1 mF", e="0 V"), node=hb.Zero())
    m.bond("u -> node", "node -> c")
    return hb.simulate(m, until="0.1 s")


@pytest.fixture(scope="session")
def second_order() -> hb.Result:
    """Return a step of 1 V onto 1 H, 0.4 ohm and 1 F in series: damping 0.2, 1 rad/s."""
    m = hb.Model("rlc", domain="electrical")
    m.add(u=hb.Se("1 V"), line=hb.One(), l=hb.I("1 H"), r=hb.R("0.4 ohm"), c=hb.C("1 F", e="0 V"))
    m.bond("u -> line", "line -> l", "line -> r", "line -> c")
    return hb.simulate(m, until="40 s", rtol=1e-12)


@pytest.fixture(scope="session")
def ball() -> hb.Result:
    """Return a ball of 1 kg that falls from 3 m and comes to rest."""
    return hb.simulate(hb.load("examples/bouncing_ball_newton.toml"), until="20 s")
