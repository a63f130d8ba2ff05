"""The method behind Radau IIA: conditions its coefficients satisfy."""

import numpy as np
import pytest

from hybond.solvers.collocation import collocation, continued


def test_the_abscissae_are_those_of_radau():
    # The right Radau points on (0, 1): zeros of the derivative of x^2 (x-1)^3, twice over.
    polynomial = np.polynomial.Polynomial([0, 0, 1]) * np.polynomial.Polynomial([-1, 1]) ** 3
    assert collocation().c == pytest.approx(np.sort(polynomial.deriv(2).roots().real), abs=1e-9)


def test_the_butcher_matrix_integrates_the_collocation_polynomial():
    m = collocation()
    for power in (1, 2, 3):
        assert m.a @ m.c ** (power - 1) == pytest.approx(m.c**power / power, abs=1e-15)


def test_the_weights_have_order_five():
    m = collocation()
    for power in range(1, 6):
        assert m.a[2] @ m.c ** (power - 1) == pytest.approx(1 / power, abs=1e-15)
    assert abs(m.a[2] @ m.c**5 - 1 / 6) > 1e-4


def test_the_eigenvectors_restore_the_inverse():
    m = collocation()
    whole = m.real * np.outer(m.real_out, m.real_in)
    whole += 2.0 * (m.pair * np.outer(m.pair_out, m.pair_in)).real
    assert whole == pytest.approx(np.linalg.inv(m.a), abs=1e-13)
    assert m.pair.imag > 0.0
    # Characteristic polynomial of the inverse: 60 - 36 x + 9 x^2 - x^3 (Pade's denominator).
    for root in (m.real, m.pair):
        assert 60.0 - 36.0 * root + 9.0 * root**2 - root**3 == pytest.approx(0.0, abs=1e-11)


def test_the_error_estimate_is_of_order_three():
    # For y' = k t^(k-1) it vanishes up to k = 3, and not for k = 4; without Jacobian, h = 1.
    m = collocation()
    for k in (1, 2, 3, 4):
        slope = 1.0 if k == 1 else 0.0
        estimate = (slope + m.error @ m.c**k) / m.real
        assert bool(abs(estimate) < 1e-13) is (k < 4)


def test_the_error_weights_are_those_of_scipy():
    from scipy.integrate._ivp.radau import E

    assert collocation().error == pytest.approx(E, rel=1e-12)


def test_the_polynomial_passes_through_the_stages():
    m = collocation()
    rng = np.random.default_rng(3)
    stages = rng.normal(size=(3, 2))
    coefficients = m.polynomial @ stages
    assert continued(coefficients, 1.0, 0.0) == pytest.approx(stages, abs=1e-13)
    p = [np.polynomial.Polynomial([0.0, *row]) for row in coefficients.T]
    foreseen = continued(coefficients, 0.7, 1.0)
    expected = np.array([[q(1.0 + 0.7 * c) - q(1.0) for q in p] for c in m.c])
    assert foreseen == pytest.approx(expected, abs=1e-12)
