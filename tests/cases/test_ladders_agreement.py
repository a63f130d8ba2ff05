"""Ladders of ideal diodes and the arm of a converter: located events and time-stepping agree."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

import hybond as hb

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

from agreement import agreement, arm, loaded  # noqa: E402
from ladders import PERIOD, ladder  # noqa: E402


@pytest.mark.sampled(1)
@pytest.mark.parametrize("diodes", [4, 20])
def test_ladders_agree_to_rounding_where_steps_meet_the_peaks(diodes: int) -> None:
    """Capacitors and ideal diodes have no time of their own: a step is exact, however long."""
    found = agreement(ladder(diodes), 2.0 * PERIOD, 2 * 100, instants=40, halvings=0, theta=1.0)
    assert found.rows[0].largest < 1e-9


@pytest.mark.slow
def test_a_missed_peak_costs_the_square_of_what_it_is_missed_by() -> None:
    graph = ladder(4)
    first = [s.path for s in graph.storages].index("C2.q")
    found = agreement(graph, 0.5 * PERIOD, 25.0 * (1.0 + math.sqrt(5.0)), halvings=2, theta=1.0)
    for row in found.rows:
        # at its best (a point of the grid beside its peak) C1 and C2 share what the source has;
        # at zero again, C2 shares with C3
        k = math.floor(0.25 * PERIOD / row.step)
        best = max(math.sin(2.0 * math.pi / PERIOD * j * row.step) for j in (k, k + 1))
        assert row.states[first, -1] == pytest.approx(0.25e-4 * best, rel=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("diodes", [4, 20])
def test_loaded_ladders_converge_in_the_first_order(diodes: int) -> None:
    found = agreement(loaded(diodes), PERIOD, 100, halvings=2, theta=1.0)
    assert found.orders == pytest.approx([1.0, 1.0], abs=0.1)
    assert found.rows[-1].largest < 5e-3
    # what is left is of the second order
    assert found.extrapolated[-1] < 5e-4
    assert found.extrapolated[1] < 0.5 * found.extrapolated[0]


@pytest.mark.slow
@pytest.mark.parametrize("theta", [0.5, 1.0])
def test_the_arm_of_the_example_converges(theta: float) -> None:
    """No diode changes its branch within a step, so that theta = 1/2 is of order two."""
    example = hb.load(ROOT / "examples" / "mmc_arm.toml").flatten()
    found = agreement(example, 9.9e-3, 330, instants=33, halvings=1, theta=theta)
    order = 2.0 if theta == 0.5 else 1.0
    assert found.orders[0] == pytest.approx(order, abs=0.1)
    assert found.rows[-1].largest < (2e-4 if theta == 0.5 else 5e-2)
    assert found.extrapolated[0] < 0.2 * found.rows[-1].largest


def test_the_generated_arm_is_that_of_the_example() -> None:
    example = hb.simulate(hb.load(ROOT / "examples" / "mmc_arm.toml"), 9.9e-3)
    made = hb.simulate(arm(4), 9.9e-3)
    assert len(example.events) == len(made.events)
    t = np.linspace(0.0, 9.9e-3, 34)
    assert made["L.p"].at(t) == pytest.approx(example["L.p"].at(t), abs=1e-9)
    for k in range(1, 5):
        assert made[f"C{k}.q"].at(t) == pytest.approx(example[f"m{k}.C.q"].at(t), abs=1e-9)


@pytest.mark.slow
def test_a_larger_arm_converges() -> None:
    found = agreement(arm(8), 2.0e-3, 200, instants=20, halvings=1)
    assert found.orders[0] > 1.9
    assert found.rows[-1].largest < 1e-4
