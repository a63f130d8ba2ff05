"""Rounding is measured by what moves, whether or not a spring beside it is bent."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import hybond as hb

PUSH, RUB, RATE, MASS = 8.0, 5.0, 3.0, 2.0
SPRINGS = {
    "cubic": {"e": "1e4*q^3"},
    "slack": {"e": "1e4*(max(q - 0.01, 0) - max(-0.01 - q, 0))"},
    "hardening": {"e": "1e4*q + 1 [N/m^3]*q^3"},
}


def blocks(spring: object, law: str) -> hb.Model:
    """Return two equal blocks, pushed alike over equal tables, with a spring between them."""
    m = hb.Model("blocks", domain="translational")
    for n in "ab":
        m.add({f"m{n}": hb.I(MASS), f"v{n}": hb.One(law=law, limit=f"{RUB}")})
        m.add({f"push{n}": hb.Se(f"{PUSH}*sin({RATE}*time)")})
        m.bond(f"push{n} -> v{n} -> m{n}")
    m.add(between=hb.Zero(), spring=hb.C(spring))
    m.bond("va -> between -> vb", "between -> spring")
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("spring", SPRINGS)
@pytest.mark.parametrize("law", ["coulomb", "relay"])
def test_equal_blocks_come_to_rest_and_break_loose_together(
    spring: str, solver: str, law: str
) -> None:
    loose = math.asin(RUB / PUSH) / RATE

    def speed(t: float) -> float:
        pushed = PUSH / RATE * (math.cos(RATE * loose) - math.cos(RATE * t))
        return (pushed - RUB * (t - loose)) / MASS

    stops = brentq(speed, 0.7, math.pi / RATE + loose, xtol=1e-15)
    right = np.sort([t + k * math.pi / RATE for t in (loose, stops) for k in range(40)])
    until = 40 * math.pi / RATE - 0.5
    run = hb.simulate(blocks(SPRINGS[spring], law), until=until, solver=solver)
    assert not run.warnings
    np.testing.assert_allclose(run.events.t[1:], right[right < until], atol=1e-6)
