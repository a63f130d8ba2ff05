"""Coefficients of methods: the conditions that they satisfy, and those of others."""

import numpy as np
import pytest
from scipy.integrate import RK45
from scipy.integrate._ivp.radau import MU_COMPLEX, MU_REAL

from hybond.engine.methods.explicit.dopri import STAGE_AT, TABLE
from hybond.engine.methods.implicit import radau_factors as f
from hybond.engine.methods.implicit import radau_stages as r

DOPRI = np.reshape(TABLE, (-1, 7))
C = np.array([r.STAGE_1, r.STAGE_2, 1.0])
INVERSE = np.reshape(f.BUTCHER_INVERSE, (3, 3))
A = np.linalg.inv(INVERSE)


def test_dormand_and_prince_satisfy_their_conditions():
    c = np.array([*STAGE_AT, 1.0])
    # the first row is stage 2
    assert DOPRI[:7].sum(axis=1) == pytest.approx(c)
    assert DOPRI[7].sum() == pytest.approx(0.0, abs=1e-15)
    assert DOPRI[8:].sum(axis=0) == pytest.approx(DOPRI[6], abs=1e-15)
    # smooth across steps: the slope at the end is the seventh stage
    assert np.arange(1, 5) @ DOPRI[8:] == pytest.approx(np.eye(7)[6], abs=1e-14)
    for power in range(1, 6):
        assert DOPRI[6] @ c ** (power - 1) == pytest.approx(1 / power)


def test_dormand_and_prince_are_those_of_scipy():
    assert np.array_equal(DOPRI[8:], RK45.P.T)
    assert np.array_equal(DOPRI[6, :6], RK45.B)
    assert np.array_equal(np.abs(DOPRI[7]), np.abs(RK45.E))


def test_the_abscissae_are_those_of_radau():
    # the right Radau points on (0, 1): zeros of the second derivative of x^2 (x - 1)^3
    polynomial = np.polynomial.Polynomial([0, 0, 1]) * np.polynomial.Polynomial([-1, 1]) ** 3
    assert pytest.approx(np.sort(polynomial.deriv(2).roots().real), abs=1e-9) == C


def test_radau_integrates_the_collocation_polynomial_and_is_of_order_five():
    for power in (1, 2, 3):
        assert A @ C ** (power - 1) == pytest.approx(C**power / power, abs=1e-14)
    for power in range(1, 6):
        assert A[2] @ C ** (power - 1) == pytest.approx(1 / power, abs=1e-14)
    assert abs(A[2] @ C**5 - 1 / 6) > 1e-4


def test_the_eigenvectors_restore_the_inverse():
    pair = complex(f.PAIR_RE, f.PAIR_IM)
    out = np.array(r.PAIR_OUT_RE) + 1j * np.array(r.PAIR_OUT_IM)
    into = np.array(f.PAIR_IN_RE) + 1j * np.array(f.PAIR_IN_IM)
    whole = f.REAL * np.outer(r.REAL_OUT, f.REAL_IN) + 2.0 * (pair * np.outer(out, into)).real
    assert whole == pytest.approx(INVERSE, abs=1e-13)
    # Pade's denominator
    for root in (f.REAL, pair):
        assert 60.0 - 36.0 * root + 9.0 * root**2 - root**3 == pytest.approx(0.0, abs=1e-11)
    assert pytest.approx(MU_REAL, rel=1e-14) == f.REAL
    assert abs(pair.imag) == pytest.approx(abs(MU_COMPLEX.imag), rel=1e-14)
