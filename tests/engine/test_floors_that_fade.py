"""Rounding of what was large long ago is gone where the motion has carried it away.

Beside a capacitor that stays charged behind its diode, the others discharge and are charged again
when the sine rises: their diodes were judged by what all of that energy would make of them, and
switched without an end just behind the zero. Voltages where nothing is left to settle, in closed
form; times in proportion to no amplitude.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

OMEGA = 100.0 * math.pi
BEFORE, AFTER = 0.02, {"x0": 5e3, "x1": 200.0, "x2": 2.0, "x3": 7.0}
WAYS = ["as drawn", "bonds turned", "the other polarity", "the last one on the second"]


def beside_a_charged_one(amplitude: float, way: str) -> hb.Model:
    """Four small capacitors and a large one, each behind a diode, fed by a sine."""
    m = hb.Model("ladder", domain="electrical")
    m.add(V=hb.Se(f"{amplitude!r}*sin({OMEGA!r}*time)"), s=hb.One(), Rs=hb.R(BEFORE))
    m.bond("V -> s -> n0", "s -> Rs")
    small = {"0": 5e-11, "1": 1e-9, "2": 3.5e-7, "3": 6e-9}
    for k, c in small.items():
        m.add(**{f"n{k}": hb.Zero(), f"c{k}": hb.C(c), f"x{k}": hb.R(AFTER[f"x{k}"])})
        m.bond(f"c{k} -> n{k}" if way == "bonds turned" else f"n{k} -> c{k}", f"n{k} -> x{k}")
    m.add(n4=hb.Zero(), c4=hb.C(2e-4), x4=hb.R(900.0))
    m.bond("n4 -> c4", "n4 -> x4")
    last = "n1" if way == "the last one on the second" else "n3"
    for k, (here, there, r) in {
        "1": ("n0", "n1", 3e-4),
        "2": ("n1", "n2", 1e-4),
        "3": ("n0", "n3", 1e-5),
        "4": (last, "n4", 1e-2),
    }.items():
        if way == "the other polarity":
            here, there = there, here
        m.add(**{f"d{k}": hb.One(law="diode"), f"r{k}": hb.R(r)})
        m.bond(f"{here} -> d{k} -> {there}")
        m.bond(f"r{k} -> d{k}" if way == "bonds turned" else f"d{k} -> r{k}")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("way", WAYS)
def test_diodes_beside_a_charged_capacitor_switch_once(way: str, solver: str) -> None:
    amplitude = 20.0
    run = hb.simulate(beside_a_charged_one(amplitude, way), until=0.045, solver=solver)
    assert run.status == "ok"
    assert run.audit().energy < 1e-8
    fired = [f for e in run.events for v in e.steps for f in v.fired if f.target == "blocks"]
    # once each in every period, the large one just behind its peak
    assert sorted(f.machine for f in fired) == sorted(2 * ["d1", "d2", "d3", "d4"])
    sign, later = (-1.0, 0.01) if way == "the other polarity" else (1.0, 0.0)
    # that is behind its diode there, and the others settle within microseconds
    beside = sum(1.0 / r for r in AFTER.values())
    there = amplitude * math.sin(OMEGA * 0.0015) / (1.0 + BEFORE * beside)
    found = float(run["c2.e"].at(0.0215 + later))
    assert found == pytest.approx(sign * there, rel=1e-3)
    assert abs(float(run["c2.e"].at(0.035 - later))) < 1e-9 * amplitude


def test_times_do_not_depend_on_the_amplitude() -> None:
    runs = [hb.simulate(beside_a_charged_one(a, WAYS[0]), until=0.045) for a in (1e-6, 1.0, 1e6)]
    times = [[float(e.t) for e in run.events] for run in runs]
    assert len(times[0]) > 10
    assert times[1] == pytest.approx(times[0], abs=1e-9)
    assert times[2] == pytest.approx(times[0], abs=1e-9)
