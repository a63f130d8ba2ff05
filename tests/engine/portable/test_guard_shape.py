"""What samples of a guard show: bounds that spare looking at the polynomial through them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb
from hybond.engine.engine import make_engine
from hybond.engine.guards.guard_shape import NEAR, floor_of, rest_below, rest_of, stays
from hybond.engine.guards.locator import FRACTION, GRID, SAMPLES, make_locator
from hybond.engine.tables import answered, tables_of

NUMBERS = st.lists(st.floats(-1.0, 1.0), min_size=SAMPLES, max_size=SAMPLES)


@pytest.fixture(scope="module")
def locator():
    graph = hb.load("examples/half_bridge.toml").flatten()
    return make_locator(make_engine(answered(tables_of(graph))))


def polynomial(samples) -> np.ndarray:
    """Return the polynomial of degree 5 through samples on the grid, by least squares of numpy."""
    x = 2.0 * np.array([FRACTION[k] for k in range(SAMPLES)]) - 1.0
    return np.polyval(np.polyfit(x, samples, 5), np.linspace(-1.0, 1.0, GRID))


@settings(max_examples=50)
@given(samples=NUMBERS, offset=st.sampled_from([0.0, 1.0, -3.0, 1e6]))
def test_a_floor_is_below_the_polynomial(locator, samples, offset):
    samples = [x + offset for x in samples]
    for sign in (1.0, -1.0):
        floor = floor_of(locator, min(samples), max(samples), sign)
        assert (sign * polynomial(samples) >= floor - 1e-9 * abs(offset) - 1e-9).all()


@settings(max_examples=50)
@given(samples=NUMBERS, offset=st.floats(-3.0, 3.0))
def test_a_guard_stays_where_its_polynomial_does(locator, samples, offset):
    samples = np.array(samples) + offset
    locator.shape[:SAMPLES] = list(samples)
    found = stays(locator, 0)
    if not samples.any():
        assert found
        return
    up = np.sign(samples[0])
    bound = NEAR * np.ptp(samples) + 3.0 * rest_of(locator, 0)
    away = min((up * samples).min(), (up * polynomial(samples)).min())
    assert found == (up != 0.0 and away > bound) or away == pytest.approx(bound, rel=1e-6)


@settings(max_examples=50)
@given(samples=NUMBERS, offset=st.sampled_from([0.0, 1.0, 1e6]))
def test_what_a_polynomial_leaves_is_below_its_length(locator, samples, offset):
    samples = np.array(samples) + offset
    locator.shape[:SAMPLES] = list(samples)
    x = 2.0 * np.array([FRACTION[k] for k in range(SAMPLES)]) - 1.0
    left = samples - np.polyval(np.polyfit(x, samples, 5), x)
    size = np.abs(samples).max()
    assert rest_of(locator, 0) == pytest.approx(np.abs(left).max(), abs=1e-12 * size)
    below = rest_below(locator, locator.shape, 0, size)
    assert rest_of(locator, 0) <= below
    assert below == pytest.approx(np.linalg.norm(left), abs=1e-11 * size)
