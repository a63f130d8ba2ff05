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
    """Return five periods of 50 Hz: a square wave of 1 A, a half-wave rectified sine, a pulse."""
    m = hb.Model("waves", domain="electrical")
    # a period is 20 ms; the pulse is high for its first quarter
    m.signals = {
        "x": "mod(time, 20 ms) / (20 ms)",
        "square": "if x < 0.5 then 1 else -1",
        "half": "max(sin(2*pi*50*time), 0)",
        "pulse": "if x < 0.25 then 4 else 0",
        "ramp": "x",
    }
    m.add(u=hb.Sf("1 A"), c=hb.C("1 mF", e="0 V"), node=hb.Zero())
    m.bond("u -> node", "node -> c")
    return hb.simulate(m, until="0.1 s")
