"""What is tied to a source and passes a kink, fast or within no time at all, does not jump there.

Whether a source jumps onto what is stored is asked a moment before a kink and behind it. A fast
motion is elsewhere a moment later without any jump, and a step may be shorter than a moment. Both
told of jumps that were none, and could end in states beside their laws.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

X = [-80.0, -40.0, 0.0, 40.0, 120.0]
Y = [-0.2, -0.05, 0.0, 0.05, 0.075]
LAWS = {
    "table": {"table": [X, Y], "extrapolate": "linear"},
    "halves": "if p > 0 then p/3 else p/5",
    "corner": "p + max(p - 1, 0)",
}


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("law", LAWS)
def test_a_fast_source_through_the_kink_of_what_it_drives(law: str, solver: str) -> None:
    m = hb.Model("driven")
    m.add(s=hb.Sf("-600*sin(900*time)"), j=hb.One(), i=hb.I(0.9), k=hb.I({"f": LAWS[law]}, p=0.0))
    m.bond("s -> j", "j -> i", "j -> k")
    run = hb.simulate(m, 0.016, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    assert len(run.events) == 1  # the start
    t = np.linspace(0.0, 0.016, 41)
    f = -600.0 * np.sin(900.0 * t)
    assert run["i.p"].at(t) == pytest.approx(0.9 * f, rel=1e-6, abs=1e-5)
    ends = t[-1]
    assert run["k.f"].at(ends) == pytest.approx(-600.0 * math.sin(900.0 * ends), rel=1e-12)


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("jump", [1e-3, 1.0])
def test_what_does_jump_in_fast_motion_is_told(jump: float, solver: str) -> None:
    m = hb.Model("driven")
    m.add(s=hb.Sf(f"600*sin(900*time) + {jump}*floor(time/(7 ms))"), j=hb.One(), i=hb.I(0.9))
    m.add(k=hb.I(2.0))
    m.bond("s -> j", "j -> i", "j -> k")
    run = hb.simulate(m, 0.008, solver=solver)
    (event,) = run.events[1:]
    assert event.t == pytest.approx(0.007, rel=1e-12)
    assert abs(event.steps[-1].impulses["s.e"]) == pytest.approx(2.9 * jump, rel=1e-6)


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize(
    ("law", "q"),
    [("0.254*((q/7.75) + (q/7.75)^3)", 4.07), ("3*(q + q^5)", -1.0), ("sinh(2*q)", 0.5)],
)
def test_a_kink_within_less_than_a_moment_of_the_start(law: str, q: float, solver: str) -> None:
    # the source begins at zero, and so does what the bent resistor has a kink at
    m = hb.Model("begun")
    m.add(j=hb.Zero(), a=hb.R({"e": "0.165*(f/0.726)*abs(f/0.726)"}))
    m.add(b=hb.R({"e": "0.651*tanh(f/0.158)"}), c=hb.C({"e": law}, q=q))
    m.add(s=hb.Se("1.78*sin(0.507*time)"))
    m.bond("j -> b", "c -> j", "j -> a", "j -> s")
    run = hb.simulate(m, 0.375, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    t = np.linspace(0.01, 0.375, 7)
    assert run["c.e"].at(t) == pytest.approx(1.78 * np.sin(0.507 * t), rel=1e-7)
