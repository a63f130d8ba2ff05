"""The boundary between a rod that sticks and one that slides, by its closed form.

A rod that strikes with velocity (0, -v) of its centre and without rotation sticks if the impulse
that stops its tip lies in the cone of friction. With the tip at (x, y) = l (cos, sin) of the angle
from the centre, the impulse (Px, Py) stops both velocities of the tip:

    Px (1/m + y^2/J) - Py x y/J = 0,   so   mu = |Px/Py| = |x y|/(J/m + y^2)

which is J/(m l^2) = sin cos/mu - sin^2 (Mosterman & Biswas 2002, figure of the falling rod).
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb

ROD = Path(__file__).parents[2] / "examples" / "falling_rod.toml"
THETA = 0.85


@pytest.mark.slow
def test_a_sweep_draws_the_boundary_between_stuck_and_sliding() -> None:
    plan = hb.Plan({"mu": "0.2:0.4:0.01", "J": "0.61:1.81:0.08"})
    table = hb.sweep(hb.load(ROD), plan, until="0.45 s", collect="sequence, first(tip.stuck)")
    boundary = math.sin(THETA) * math.cos(THETA) / table["mu"] - math.sin(THETA) ** 2
    sticks = table["J"] > boundary
    assert 100 < sticks.sum() < len(table) - 100
    np.testing.assert_array_equal(np.isfinite(table["first(tip.stuck)"]), sticks)
    starts = [text.startswith("free > stuck") for text in table["sequence"]]
    np.testing.assert_array_equal(starts, sticks)


def test_the_boundary_holds_within_its_last_digits() -> None:
    mu = np.array([0.2, 0.265, 0.3, 0.35])
    edge = math.sin(THETA) * math.cos(THETA) / mu - math.sin(THETA) ** 2
    for factor, sticks in ((1.0 - 1e-7, False), (1.0 + 1e-7, True)):
        plan = hb.Plan({"mu": mu, "J": edge * factor}, together=True)
        table = hb.sweep(hb.load(ROD), plan, until="0.45 s", collect="first(tip.stuck)")
        assert np.isfinite(table["first(tip.stuck)"]).tolist() == [sticks] * len(mu)
