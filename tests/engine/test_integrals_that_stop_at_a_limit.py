"""The integral of a controller that stops at a limit: implicit steps that begin at the jump.

A step ends where the rate jumps but for rounding, and may have the rates of the side that it left.
The oracle is SciPy's integrator, one mode after the other, with the jump as its event.
"""

from __future__ import annotations

import pytest
from scipy.integrate import solve_ivp

import hybond as hb

STEP = 1.9  # when the set value falls to -0.5
R, K, D = 0.8843, 0.13, 0.5

CONTROLLED = {
    # mirrored, turned: whatever sign the states have, and which way the bonds point
    "as it is": (1, ["u -> j -> x", "j -> r", "j -> k"]),
    "mirrored": (-1, ["u -> j -> x", "j -> r", "j -> k"]),
    "turned": (1, ["j -> k", "j -> r", "u -> j", "j -> x"]),
}


def controlled(sign: int, bonds: list[str], stops: str) -> hb.Model:
    """Return a mass on a spring under PI control; the integral stops where the sum is large."""
    m = hb.Model("controlled", parameters={"s": sign})
    m.add(u=hb.Se("3*error + z - 0.5*j.f"), x=hb.I(1.0), j=hb.One(), r=hb.R(R), k=hb.C(K))
    m.bond(*bonds)
    m.signal(
        error="s*(if time < 1.9 then 1 else -0.5) - k.q",
        z=hb.Integral(f"if {stops} then 2*error else 0"),
    )
    return m


def integrated(t_end: float) -> tuple[list[float], float]:
    """Return speed, way and integral, and when the integral stopped."""

    def rates(y, growth):
        v, q, z = y
        error = 1 - q
        return [3 * error + z - D * v - R * v - q / K, v, growth * 2 * error]

    def limit(_t, y):
        return 3 * (1 - y[1]) + y[2] - 4

    limit.terminal = True
    limit.direction = 1
    fine = {"rtol": 1e-12, "atol": 1e-13, "method": "DOP853"}
    before = solve_ivp(lambda _t, y: rates(y, 1), (0, STEP), [0, 0, 0], events=[limit], **fine)
    stopped = before.t[-1]
    assert 0 < stopped < STEP
    after = solve_ivp(lambda _t, y: rates(y, 0), (stopped, t_end), before.y[:, -1], **fine)
    return list(after.y[:, -1]), stopped


@pytest.mark.parametrize("stops", ["s*(3*error + z) < 4", "abs(3*error + z) < 4"])
@pytest.mark.parametrize("case", CONTROLLED)
def test_an_integral_that_stops_by_radau(case, stops):
    # it went on to minus 0.88 a second instead of nothing, for some lengths of the run
    at = STEP - 1e-6
    (speed, way, integral), _ = integrated(at)
    sign, bonds = CONTROLLED[case]
    model = controlled(sign, bonds, stops)
    for until in (2.5, 3.1, 4.1, 4.2, 5.0):
        run = hb.simulate(model, until, method=hb.Radau())
        assert run["z"].at(at) == pytest.approx(sign * integral, rel=1e-7), until
        assert run["k.q"].at(at) == pytest.approx(sign * way, rel=1e-7), until
        assert run["x.f"].at(at) == pytest.approx(sign * speed, abs=1e-7), until
