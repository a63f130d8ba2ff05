"""The force on the edge of a disk: the secular equation of a trust region, and its limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine_lcp import on_disk
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

number = st.floats(-3.0, 3.0)


@given(a=number, b=number, c=number, d=number, x=number, y=number, limit=st.floats(0.01, 0.95))
def test_it_is_the_solution_of_the_secular_equation(
    a: float, b: float, c: float, d: float, x: float, y: float, limit: float
) -> None:
    root = np.array([[a, b], [c, d]])
    A = root @ root.T + 0.1 * np.eye(2)
    f0 = np.array([x, y])
    held = np.linalg.norm(np.linalg.solve(A, f0))
    if held < 1e-3:
        return
    size = limit * held  # less than what holds it
    way = on_disk(f0, A, size)
    assert way is not None

    def force(sigma: float) -> np.ndarray:
        return np.linalg.solve(A + sigma * np.eye(2), f0)

    top = 2.0 * np.linalg.norm(f0) / size
    sigma = brentq(lambda s: np.linalg.norm(force(s)) - size, 0.0, top, xtol=1e-15)
    assert np.allclose(size * way, force(sigma), rtol=0.0, atol=1e-10 * (1.0 + held))


@given(phi=st.floats(-math.pi, math.pi), k=st.floats(0.1, 10.0), limit=st.floats(0.0, 5.0))
def test_an_isotropic_slip_goes_where_it_is_pushed(phi: float, k: float, limit: float) -> None:
    f0 = (k * limit + 1.0) * np.array([math.cos(phi), math.sin(phi)])
    way = on_disk(f0, k * np.eye(2), limit)
    assert way is not None
    assert np.allclose(way, f0 / np.linalg.norm(f0), rtol=0.0, atol=1e-13)


def test_the_limit_may_follow_the_force() -> None:
    A, f0, slope = np.array([[1.0, 0.3], [0.3, 2.0]]), np.array([3.0, 1.0]), np.array([0.2, -0.4])
    way = on_disk(f0, A, 0.7, slope)
    assert way is not None
    force = 0.7 / (1.0 - slope @ way) * way
    assert math.isclose(np.linalg.norm(force), 0.7 + slope @ force, rel_tol=1e-13)
    f = f0 - A @ force
    assert abs(way[0] * f[1] - way[1] * f[0]) < 1e-13
    assert way @ f > 0.0


def test_what_the_disk_holds_has_no_direction() -> None:
    assert on_disk(np.array([0.5, 0.5]), np.eye(2), 1.0) is None
    assert on_disk(np.zeros(2), np.eye(2), 0.0) is None


@pytest.mark.parametrize(
    ("f0", "a", "limit"),
    [
        (
            (-0.832876160491719, 1.0199791240323567e-16),
            (0.00588235294110929, 0.005882352941176471),
            0.41692500000000005,
        ),
        (
            (-5.880832195690418, 7.201942324774972e-16),
            (0.006370741241596657, 0.006370741241594717),
            40.53677618898858,
        ),
        (
            (-2.54328365713478, 3.114624190033883e-16),
            (0.003998678589729572, 0.003998678589729041),
            153.29277608467407,
        ),
        ((-1.0, 0.0), (0.006, 0.006), 0.4),
    ],
)
def test_a_slip_along_an_axis_but_for_rounding_has_its_direction(
    f0: tuple[float, float], a: tuple[float, float], limit: float
) -> None:
    """Beside pi angles are 4e-16 apart, and next to no slip across is left there."""
    way = on_disk(np.array(f0), np.diag(a), limit)
    assert way is not None
    assert np.allclose(way, [-1.0, 0.0], rtol=0.0, atol=1e-15)
