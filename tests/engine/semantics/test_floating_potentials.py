"""Diode bridges whose potentials are tied to earth by next to nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


def bridge(earth: float, on: float, load: float, phases: int) -> hb.Model:
    """Phases in star, the star point earthed through a large resistance, a bridge, a resistor."""
    m = hb.Model("bridge", domain="electrical", parameters={"w": 314.159265358979})
    m.add(star=hb.Zero(), plus=hb.Zero(), minus=hb.Zero(), out=hb.One(), load=hb.R(load))
    m.add(earth=hb.R(earth))
    m.bond("star -> earth", "plus -> out -> minus", "out -> load")
    for k in range(phases):
        m.add(**{f"V{k}": hb.Se(f"155*sin(w*time - {2.0 * math.pi * k / phases})")})
        m.add(**{f"line{k}": hb.One(), f"p{k}": hb.Zero()})
        m.bond(f"V{k} -> line{k}", f"star -> line{k} -> p{k}")
        for side, ends in (("u", (f"p{k}", "plus")), ("l", ("minus", f"p{k}"))):
            name = f"{side}{k}"
            m.add(**{name: hb.One(law="diode"), f"r{name}": hb.R(on)})
            m.bond(f"{ends[0]} -> {name} -> {ends[1]}", f"{name} -> r{name}")
    return m


@pytest.mark.parametrize("on", [1e-3, 1e-2])
@pytest.mark.parametrize("earth", [1e5, 1e6, 1e8])
@pytest.mark.parametrize("phases", [3, 5])
def test_a_star_point_that_all_but_floats_is_no_contradiction(
    phases: int, earth: float, on: float
) -> None:
    """The load sees the largest difference of two phases, through two diodes."""
    load = 20.0
    run = hb.simulate(bridge(earth, on, load, phases), until=0.04)
    assert run.status == "ok"
    t = np.linspace(0.001, 0.0399, 331)
    volts = np.array(
        [155.0 * np.sin(314.159265358979 * t - 2.0 * math.pi * k / phases) for k in range(phases)]
    )
    right = (volts.max(axis=0) - volts.min(axis=0)) * load / (load + 2.0 * on)
    # while two phases commutate both carry: less than their difference over the loop
    assert run["load.e"].at(t) == pytest.approx(right, abs=310.0 * on)
