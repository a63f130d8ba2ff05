"""The integral of a controller that stops at a limit: implicit steps that begin at the jump.

A step ends where the rate jumps but for rounding, and may have the rates of the side that it left.
The oracle is SciPy's integrator, one mode after the other, with the jump as its event.
"""

from __future__ import annotations

import math

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


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("gain", "lag", "level"), [(1, 1.0, 0.1), (10, 1.0, 0.3), (30, 0.3, 0.5)])
def test_an_integral_let_go_from_a_limit_of_zero(
    sign: int, gain: float, lag: float, level: float
) -> None:
    """It waited below zero by 1e-13, and steps seemed to see it pass: HB-N410 in 15 runs of 36.

    Let go where ``cos 3t`` rises past ``-level``, it is a lag driven by a cosine.
    """
    m = hb.Model("stopped")
    m.signal(
        c=hb.Integral("-3*s", start=1.0),
        s=hb.Integral("3*c"),
        u=f"({sign * gain}*(c + {level}) - z)/{lag}",
        z=hb.Integral(f"if {sign}*z <= 0 and {sign}*u < 0 then 0 else u", start=sign * 0.5),
    )
    free = (2.0 * math.pi - math.acos(-level)) / 3.0
    if level == 0.5:
        free += 2.0 * math.pi / 3.0  # held once more

    def driven(t: float) -> float:
        swing = math.cos(3.0 * t) + 3.0 * lag * math.sin(3.0 * t)
        return gain * (level + swing / (1.0 + 9.0 * lag**2))

    run = hb.simulate(m, until=free + 0.8)
    for t in (free + 0.1, free + 0.8):
        want = driven(t) - driven(free) * math.exp((free - t) / lag)
        assert run["z"].at(t) == pytest.approx(sign * want, rel=1e-6)
    assert run["z"].at(free - 0.01) == pytest.approx(0.0, abs=1e-9 * gain)


@pytest.mark.parametrize("phase", [3.907692307692308, 3.7, 4.2])
@pytest.mark.parametrize(
    "law", ["if z <= 0 then max(0, u) else u", "if z > 0 or u >= 0 then u else 0"]
)
def test_an_integral_that_begins_at_its_limit(law: str, phase: float) -> None:
    """By radau it stayed there for ever, silently: what is not refused is right."""
    m = hb.Model("begins")
    m.signal(u=f"sin(7.3*time + {phase}) + 0.1", z=hb.Integral(law))
    go = (2.0 * math.pi - math.asin(0.1) - phase) / 7.3
    meant = (math.cos(7.3 * go + phase) - math.cos(7.3 * 0.6 + phase)) / 7.3 + 0.1 * (0.6 - go)
    assert hb.simulate(m, 2.0)["z"].at(0.6) == pytest.approx(meant, abs=1e-6)
    run = hb.simulate(m, 2.0, solver="radau", on_error="return")
    assert run.status == "error" or run["z"].at(0.6) == pytest.approx(meant, abs=1e-6)
