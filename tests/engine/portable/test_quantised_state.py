"""Single quantised states: when they leave their bands, and where they are put."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybond.engine.methods.quantised.qss_band import leaves_band
from hybond.engine.methods.quantised.qss_nodes import node_at, through_nodes
from hybond.engine.methods.quantised.qss_place import place_ahead

coefficient = st.floats(-10, 10, allow_nan=False).map(lambda a: 0.0 if abs(a) < 1e-3 else a)


def test_leaving_a_band() -> None:
    assert leaves_band(0.0, 0.0, 0.0, 8.0, 1.0) == 0.5
    # falls to -1 before it rises to 1
    assert leaves_band(0.5, -3.0, 1.0, 0.0, 1.0) == pytest.approx(0.633974596)
    assert leaves_band(0.5, 0.0, 0.0, 0.0, 1.0) == math.inf
    assert leaves_band(1.5, -1.0, 0.0, 0.0, 1.0) == 0.0


@settings(max_examples=300, deadline=None)
@given(st.floats(-0.9, 0.9), st.lists(coefficient, min_size=1, max_size=3))
def test_leaving_a_band_is_the_first_root_that_numpy_finds(d0: float, rest: list[float]) -> None:
    d = [d0, *rest]
    roots: list[float] = []
    for level in (1.0, -1.0):
        found = np.roots([d0 - level, *rest][::-1])
        roots += [r.real for r in found if abs(r.imag) < 1e-9 * max(abs(r), 1.0) and r.real > 0]
    s = leaves_band(*(*d, 0.0, 0.0)[:4], 1.0)
    if math.isinf(s):
        assert not roots
        return
    value = np.polynomial.polynomial.polyval(s, d)
    assert abs(value) == pytest.approx(1.0, rel=1e-6)
    inside = np.polynomial.polynomial.polyval(np.linspace(0.0, s, 400), d)
    assert np.abs(inside).max() <= 1.0 + 1e-6


def placed(x: float, u: list[float], a: float, quantum: float) -> tuple[list[float], float]:
    q = [0.0] * len(u)
    return q, place_ahead(x, len(u), u, a, quantum, [0.0] * len(u), q)


def test_a_fast_state_is_put_ahead_or_on_its_equilibrium() -> None:
    q, h = placed(1.0, [0.0], -1000.0, 0.25)
    assert (q, h) == ([0.875], pytest.approx(0.125 / 875.0))
    assert placed(0.1, [0.0], -1000.0, 0.25) == ([0.0], math.inf)


@settings(max_examples=300, deadline=None)
@given(
    st.floats(-2, 2),
    st.lists(st.floats(-5, 5), min_size=1, max_size=3),
    st.floats(-1e4, -0.1),
    st.floats(1e-4, 0.5),
)
@pytest.mark.slow
def test_a_placed_quantised_state_is_touched_in_time_and_never_far(
    x: float, u: list[float], a: float, quantum: float
) -> None:
    q, h = placed(x, u, a, quantum)
    n = len(u)
    motion = [x]
    for k in range(n):
        motion.append((a * q[k] + u[k]) / (k + 1))
    d = np.array(motion) - np.array([*q, 0.0])
    rounding = 1e-9 * (abs(x) + sum(map(abs, u)) + quantum)
    if math.isfinite(h):
        assert abs(d[0]) == pytest.approx(0.5 * quantum, abs=rounding)
        # x - q = c (s - h)^n: a root of that multiplicity, and inside half the band until then
        c = motion[n]
        wanted = [c * math.comb(n, k) * (-h) ** (n - k) for k in range(n + 1)]
        for k in range(n):
            assert d[k] * h**k == pytest.approx(wanted[k] * h**k, abs=rounding)
    elif q[0] != x:
        # an equilibrium: q keeps its distance, and the highest derivative is zero
        assert abs(d[0]) <= 0.5 * quantum + rounding
        assert motion[n] / abs(a) ** n == pytest.approx(0.0, abs=rounding)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_polynomial_through_gauss_nodes_has_the_integral_of_one_twice_as_high(n: int) -> None:
    nodes, _ = np.polynomial.legendre.leggauss(n)
    assert [node_at(n, k) for k in range(n)] == pytest.approx(0.5 + 0.5 * nodes, abs=1e-16)
    h = 0.7
    values = [(node_at(n, k) * h) ** (2 * n - 1) for k in range(n)]
    out = [0.0] * 3
    through_nodes(n, h, values, 0, 1, out)
    integral = sum(c * h ** (k + 1) / (k + 1) for k, c in enumerate(out[:n]))
    assert integral == pytest.approx(h ** (2 * n) / (2 * n), rel=1e-14)
