"""A capacitor straight across the output of a steep amplifier in a loop of resistors.

What the capacitor holds is the output of a source that reads what the loop leaves free. The
solution is that of two equations in one unknown each, by halving.
"""

from __future__ import annotations

import math

import pytest
from scipy.optimize import brentq

import hybond as hb

GAIN = 1e4


def two_stages(back: float, *, turned: bool, peak: float = 0.5) -> hb.Model:
    m = hb.Model("two stages", domain="electrical")
    m.add(vi=hb.Se(f"{peak} V*sin(2*pi*1000*time/(1 s))"), one=hb.Se(stage("a.e")))
    m.add(two=hb.Se(stage("c.e")), cap=hb.C("1 nF"), r1=hb.R(1e4), r2=hb.R(2e4), r3=hb.R(1e4))
    m.add(r4=hb.R(2e4), r5=hb.R(back), a=hb.Zero(), b=hb.Zero(), c=hb.Zero(), d=hb.Zero())
    m.add(i=hb.One(), j2=hb.One(), j3=hb.One(), j4=hb.One(), j5=hb.One())
    m.bond("vi -> i -> a", "i -> r1", "one -> b", "two -> d", "j2 -> r2", "j3 -> r3", "j4 -> r4")
    m.bond("j5 -> r5", "d -> cap")
    ends = [("a", "j2", "b"), ("b", "j3", "c"), ("c", "j4", "d"), ("d", "j5", "a")]
    for one, way, other in ends:
        m.bond(f"{other} -> {way} -> {one}" if turned else f"{one} -> {way} -> {other}")
    return m


def stage(read: str) -> str:
    return f"1 V*12*tanh(-{GAIN}*{read}/(1 V))"


def solution(vi: float, back: float) -> float:
    """Return the output of the second stage."""

    def second(b: float) -> float:
        return brentq(
            lambda d: d - 12.0 * math.tanh(-GAIN * (2.0 * b + d) / 3.0), -12.1, 12.1, xtol=1e-15
        )

    def first(b: float) -> float:
        a = (vi / 1e4 + b / 2e4 + second(b) / back) / (1.5e-4 + 1.0 / back)
        return b - 12.0 * math.tanh(-GAIN * a)

    return second(brentq(first, -12.1, 12.1, xtol=1e-15))


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("back", "peak"), [(4e4, 0.5), (1e5, 0.5), (1e5, 8.0), (2e5, 0.5)])
@pytest.mark.parametrize("turned", [False, True])
def test_a_capacitor_across_the_output_of_two_stages(
    back: float, peak: float, *, turned: bool
) -> None:
    """It was HB-N301 or HB-N411: the constraint was read where what is free is zero."""
    run = hb.simulate(two_stages(back, turned=turned, peak=peak), "0.4 ms", max_steps=2000)
    assert run.status == "ok"
    for t in (1e-9, 3e-8, 1e-7, 1e-5, 1.3e-4, 2.5e-4, 3.9e-4):
        d = solution(peak * math.sin(2e3 * math.pi * t), back)
        assert run["cap.e"].at(t) == pytest.approx(d, rel=1e-6, abs=1e-6)
