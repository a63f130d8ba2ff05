"""Time-stepping over pulses that are narrower than its steps: it says so, as fixed steps do.

What is narrower than a step is seen at none of its ends; oracle is the area of the pulse.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb


def push(source: str, *, diode: bool = False) -> hb.Model:
    """A source on 2 H, or behind a diode that no pulse upwards closes."""
    m = hb.Model("push", domain="electrical")
    m.add(F=hb.Se(source), v=hb.One(law="diode") if diode else hb.One(), M=hb.I("2 H"))
    m.bond("F -> v -> M")
    return m


def bell(width: float) -> str:
    return f"1 V*exp(-((time/(1 s) - 0.5003)/{width!r})^2)"


@pytest.mark.parametrize("diode", [False, True])
def test_a_pulse_between_two_steps_is_told(diode: bool) -> None:
    run = hb.simulate(push(bell(1e-5), diode=diode), "1 s", solver="moreau-jean", step="1 ms")
    assert run["M.p"].at(1.0) < 0.1 * math.sqrt(math.pi) * 1e-5
    assert any("in F" in w and "passed over" in w for w in run.warnings)


@pytest.mark.parametrize("source", [bell(0.05), "1 V", "1 V*sin(2*time/(1 s))"])
@pytest.mark.parametrize("diode", [False, True])
def test_what_steps_see_is_not_told(diode: bool, source: str) -> None:
    run = hb.simulate(push(source, diode=diode), "1 s", solver="moreau-jean", step="1 ms")
    assert not any("passed over" in w for w in run.warnings)
    if source == bell(0.05):
        assert run["M.p"].at(1.0) == pytest.approx(math.sqrt(math.pi) * 0.05, rel=1e-3)
