"""An inverting amplifier with limits and a steep gain: one solution, in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


@pytest.mark.sampled(3)
@pytest.mark.parametrize("gain", [1e2, 1e4, 1e5, 1e7])
@pytest.mark.parametrize("turned", [False, True])
def test_an_inverting_amplifier_with_limits_is_its_closed_form(gain: float, turned: bool) -> None:
    m = hb.Model("inverting", domain="electrical")
    m.add(vin=hb.Se("1 V*sin(2*pi*1000*time/(1 s))"), i=hb.One(), m=hb.Zero(), j=hb.One())
    m.add(r1=hb.R("1 kohm"), r2=hb.R("15 kohm"))
    limited = f"1 [V]*max(min({gain}*m.e/(1 [V]), 10), -10)"
    m.add(o=hb.Se(limited if turned else f"-{limited}"))
    m.bond("vin -> i -> m", "i -> r1", "m -> j -> r2", "o -> j" if turned else "j -> o")
    run = hb.simulate(m, "1 ms")
    assert run.status == "ok"
    for t in np.linspace(0.0, 1e-3, 23):
        free = -15.0 * math.sin(2e3 * math.pi * t) / (1.0 + 16.0 / gain)
        out = run["o.e"].at(float(t)) * (-1.0 if turned else 1.0)
        assert out == pytest.approx(min(max(free, -10.0), 10.0), abs=1e-6)
