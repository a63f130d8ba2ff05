"""Many switches beside diodes: what is looked at beforehand does not grow with their settings."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest

import hybond as hb
from hybond.causality import orientation
from hybond.engine.tables import laws

PERIOD, U, L, R = 20e-3, 300.0, 5e-3, 10.0
TIMES = {"1": (30, 150), "2": (330, 210), "3": (150, 30), "4": (210, 330)}
"""When the switches of a leg of three levels are closed, in degrees: +U from 30 on, 0, -U, 0."""


def inverter(legs: int) -> hb.Model:
    """Return three-level legs with clamped midpoints, each with an R and an L to the middle."""
    m = hb.Model("npc", domain="electrical")
    m.add(up=hb.Se(U), down=hb.Se(-U), p=hb.Zero(), n=hb.Zero())
    m.bond("up -> p", "n -> down")
    for k in range(legs):
        h = f"a{k}_"
        m.add(**{h + "1": hb.Zero(), h + "x": hb.Zero(), h + "2": hb.Zero()})
        nodes = ["p", h + "1", h + "x", h + "2", "n"]
        for s, (a, b) in enumerate(pairwise(nodes), 1):
            on, off = TIMES[str(s)]
            m.add(**{f"{h}S{s}": hb.One(), f"{h}r{s}": hb.R("10 mohm")})
            m.add(**{f"{h}D{s}": hb.One(law="diode")})
            m.bond(f"{a} -> {h}S{s} -> {b}", f"{h}S{s} -> {h}r{s}", f"{b} -> {h}D{s} -> {a}")
            phase = f"mod(360*time/({PERIOD} [s]) - {120 * k} - {on} + 720, 360)"
            closed = f"{phase} < {(off - on) % 360}"
            m.machine(
                f"{h}g{s}",
                states={"open": [], "closed": [f"{h}S{s}"]},
                start="open",
                rules=[f"open -> closed when {closed}", f"closed -> open when not ({closed})"],
            )
        m.add(**{f"{h}D5": hb.One(law="diode"), f"{h}D6": hb.One(law="diode")})
        m.bond(f"{h}D5 -> {h}1", f"{h}2 -> {h}D6")
        m.add(**{f"{h}L": hb.I(L), f"{h}R": hb.R(R), f"{h}i": hb.One()})
        m.bond(f"{h}x -> {h}i", f"{h}i -> {h}L", f"{h}i -> {h}R")
    return m


def settled(t: float) -> float:
    """Return the current of a leg at its angle 360*t/PERIOD once it repeats itself."""
    edges = [(0, 0.0), (30, U), (150, 0.0), (210, -U), (330, 0.0), (360, 0.0)]
    spans = [((b - a) / 360 * PERIOD, u) for (a, u), (b, _) in pairwise(edges)]
    i = 0.0
    for last in [False] * 40 + [True]:
        left = t if last else PERIOD
        for span, u in spans:
            # a level of zero goes through one switch and a diode
            r = R + (0.02 if u else 0.01)
            i = u / r + (i - u / r) * math.exp(-r * min(span, left) / L)
            left -= min(span, left)
    return i


def test_twelve_switches_beside_diodes_begin_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = 0
    plain = orientation.orientation

    def counted(*args: Any) -> Any:
        nonlocal asked
        asked += 1
        return plain(*args)

    monkeypatch.setattr(orientation, "orientation", counted)
    run = hb.simulate(inverter(3), "30 ms")
    assert (run.status, asked) == ("ok", 1)
    for k in range(3):
        angle = (21e-3 - k * PERIOD / 3) % PERIOD
        assert float(run[f"a{k}_L.f"].at(21e-3)) == pytest.approx(settled(angle), rel=1e-6)


@pytest.mark.parametrize("most", [1, 4096])
def test_what_is_looked_at_beforehand_changes_no_answer(
    monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    monkeypatch.setattr(laws, "CONFIGURATIONS", most)
    run = hb.simulate(inverter(1), "30 ms")
    assert run.status == "ok"
    assert float(run["a0_L.f"].at(21e-3)) == pytest.approx(settled(1e-3), rel=1e-6)
