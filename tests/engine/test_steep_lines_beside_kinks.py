"""A steep line that another law follows is no jump at a kink which it is near to."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb


def pad(depth: str, leaves: str) -> str:
    """Return the force of a contact that damps no more than it pushes."""
    return f"1e6*{depth} + max(-1e6*{depth}, min(1e6*{depth}, -250*unit*({leaves})))"


def preloaded(unit: float, push: float, *, turned: bool) -> hb.Model:
    """Return a spool between two plates that a spring presses against stops, and oil holds.

    In the numbers of Modelica's Translational.Examples.PreLoad, in a unit of time.
    """
    m = hb.Model("preload", parameters={"unit": unit, "extra": push})
    m.signal(
        s=hb.Integral("v.f", start=14.75e-3),
        a=hb.Integral("va.f", start=-93e-3),
        b=hb.Integral("vb.f", start=-69.25e-3),
        stop_a="max(0, -0.093 - a)",
        stop_b="max(0, b + 0.0675)",
        on_a="max(0, s - a - 0.1135)",
        on_b="max(0, b - s + 0.088)",
    )
    m.add(v=hb.One(), va=hb.One(), vb=hb.One(), oil=hb.R("2500*unit"))
    m.add(spool=hb.I("0.15*unit^2"), plate_a=hb.I("0.01*unit^2"), plate_b=hb.I("0.01*unit^2"))
    m.add(
        push=hb.Se("extra + 150*sin(0.02*pi*time/unit)"),
        pad_a=hb.Se(pad("stop_a", "va.f")),
        pad_b=hb.Se(("" if turned else "-") + f"({pad('stop_b', '-vb.f')})"),
        spring_a=hb.Se("2e4*(b - a - 0.027)"),
        spring_b=hb.Se("-2e4*(b - a - 0.027)"),
        inner_a=hb.Se(f"-({pad('on_a', 'va.f - v.f')})"),
        taken_a=hb.Se("-inner_a.e"),
        inner_b=hb.Se(pad("on_b", "v.f - vb.f")),
        taken_b=hb.Se("-inner_b.e"),
    )
    chains = ["push -> v -> spool", "v -> oil", "inner_a -> v", "inner_b -> v"]
    chains += ["pad_a -> va -> plate_a", "spring_a -> va", "taken_a -> va"]
    chains += ["spring_b -> vb -> plate_b", "taken_b -> vb"]
    m.bond(*chains, "vb -> pad_b" if turned else "pad_b -> vb")
    return m


@functools.cache
def by_scipy(extra: float) -> list[float]:
    """Return places of the spool and the plates after 2 ms."""

    def pushes(depth: float, leaves: float) -> float:
        stiff = 1e6 * max(depth, 0.0)
        return stiff + max(-stiff, min(stiff, -250.0 * leaves))

    def rates(t: float, y: np.ndarray) -> list[float]:
        s, a, b, v, va, vb = y
        spring = 2e4 * (b - a - 0.027)
        on_a, on_b = pushes(s - a - 0.1135, va - v), pushes(b - s + 0.088, v - vb)
        push = extra + 150.0 * math.sin(0.02 * math.pi * t)
        return [
            v,
            va,
            vb,
            (push - 2500.0 * v - on_a + on_b) / 0.15,
            (pushes(-0.093 - a, va) + spring + on_a) / 0.01,
            (-pushes(b + 0.0675, -vb) - spring - on_b) / 0.01,
        ]

    begin = [14.75e-3, -93e-3, -69.25e-3, 0.0, 0.0, 0.0]
    found = solve_ivp(rates, (0.0, 0.002), begin, "LSODA", rtol=1e-9, atol=1e-13)
    return [float(y) for y in found.y[:3, -1]]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("extra", [26.0, 40.0])
@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_light_plates_between_pads_that_cut_off_go_on(
    unit: float, extra: float, turned: bool
) -> None:
    """A plate passes rest while another pad goes over from pushing to letting go.

    Its steps are short beside a run of 100 s.
    """
    until = [f"time >= {0.002 * unit} [s]", f"{100.0 * unit} s"]
    run = hb.simulate(preloaded(unit, extra, turned=turned), until=until)
    told = [float(run[name].at(0.002 * unit)) for name in ("s", "a", "b")]
    assert told == pytest.approx(by_scipy(extra), rel=1e-8)
