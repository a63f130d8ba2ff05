"""Linear algebra of the engine, held against numpy."""

import numpy as np
import pytest
from scipy.linalg import null_space as scipy_null_space

from hybond.engine.algebra.lu import REGULAR, SINGULAR, lu_factor, lu_invert, lu_solve
from hybond.engine.algebra.lu_pair import Complex, lu_factor_pair, lu_solve_pair
from hybond.engine.algebra.products import times_matrix
from hybond.engine.algebra.qr import complement, qr_reflect, qr_rotate
from hybond.engine.algebra.svd import (
    least_squares,
    make_svd,
    null_space,
    pseudo_inverse,
    rank_above,
    svd,
    svd_of_transpose,
)
from hybond.engine.words import floats, ints

SIZES = [(1, 1), (2, 2), (3, 2), (2, 5), (6, 6), (9, 4), (4, 9), (12, 12)]


def matrices(m: int, n: int, seed: int):
    """Yield a random matrix, one of every lower rank, one with zeros, one with wild scales."""
    generator = np.random.default_rng(seed)
    yield generator.normal(size=(m, n))
    for rank in range(min(m, n)):
        yield generator.normal(size=(m, rank)) @ generator.normal(size=(rank, n))
    yield generator.integers(-1, 2, size=(m, n)).astype(float)
    yield generator.normal(size=(m, n)) * 10.0 ** generator.uniform(-2, 2, size=(m, 1))


def flat(a):
    return np.asarray(a, dtype=float).ravel().tolist()


@pytest.mark.parametrize("n", [1, 2, 5, 12])
def test_linear_systems_are_solved_like_numpy(n):
    for a in matrices(n, n, n):
        b = np.random.default_rng(n).normal(size=(n, 3))
        factors, row, x = flat(a), ints(n), flat(b)
        if np.linalg.matrix_rank(a) < n:
            continue
        assert lu_factor(n, factors, row) == REGULAR
        lu_solve(n, factors, row, 3, x)
        size = np.linalg.cond(a) * 1e-14
        np.testing.assert_allclose(np.reshape(x, (n, 3)), np.linalg.solve(a, b), rtol=size)
        inverse = floats(n * n)
        assert lu_invert(n, flat(a), row, inverse) == REGULAR
        product = np.reshape(inverse, (n, n)) @ a
        np.testing.assert_allclose(product, np.eye(n), atol=size)


@pytest.mark.parametrize("n", [1, 2, 7, 20])
def test_complex_systems_are_solved(n):
    rng = np.random.default_rng(n)
    a = rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))
    b = rng.normal(size=n) + 1j * rng.normal(size=n)
    # no pivot stands where it is needed, and half of the rest is zero
    a[np.arange(n), np.arange(n)] = 0.0 if n > 1 else 3.0 - 1.0j
    a *= (rng.random((n, n)) < 0.5) | (np.roll(np.eye(n), 1, axis=0) > 0.0)
    re, im, row, number = flat(a.real), flat(a.imag), ints(n), Complex()
    x, y = flat(b.real), flat(b.imag)
    assert lu_factor_pair(n, re, im, row, number) == REGULAR
    lu_solve_pair(n, re, im, row, number, x, y)
    assert a @ (np.array(x) + 1j * np.array(y)) == pytest.approx(b, rel=1e-9, abs=1e-9)
    ones = [1.0] * 4
    assert lu_factor_pair(2, list(ones), list(ones), ints(2), number) == SINGULAR


def test_a_zero_pivot_is_singular():
    assert lu_factor(2, [1.0, 2.0, 0.0, 0.0], ints(2)) == SINGULAR
    assert lu_factor(0, [], []) == REGULAR


@pytest.mark.parametrize(("m", "n"), SIZES)
def test_orthogonal_factors(m, n):
    for a in matrices(m, n, 7 * m + n):
        factors, scale, column = flat(a), floats(n), ints(n)
        qr_reflect(m, n, factors, scale, column, True)
        r = np.triu(np.reshape(factors, (m, n)))
        q = flat(np.eye(m))
        qr_rotate(m, n, factors, scale, False, m, q)
        q = np.reshape(q, (m, m))
        size = np.abs(a).max()
        np.testing.assert_allclose(q.T @ q, np.eye(m), atol=1e-14)
        np.testing.assert_allclose(q @ r, a[:, column], atol=1e-13 * size)


def test_a_complement_is_orthogonal_to_its_basis():
    whole, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(7, 7)))
    basis = floats(7 * 4)
    assert complement(7, 3, flat(whole[:, :3]), floats(7), ints(7), basis) == 4
    found = np.reshape(basis, (7, 4))
    np.testing.assert_allclose(found.T @ found, np.eye(4), atol=1e-14)
    np.testing.assert_allclose(whole[:, :3].T @ found, 0.0, atol=1e-14)


@pytest.mark.parametrize(("m", "n"), SIZES)
def test_singular_values_and_least_squares_are_those_of_numpy(m, n):
    d = make_svd(max(m, n), max(m, n))
    for a in matrices(m, n, 11 * m + n):
        size = np.abs(a).max()
        if size == 0.0:
            continue
        svd(d, m, n, flat(a))
        values = np.linalg.svd(a, compute_uv=False)
        np.testing.assert_allclose(d.s[: len(values)], values, rtol=1e-12, atol=1e-14 * size)
        v = np.reshape(d.v[: n * n], (n, n)).T
        np.testing.assert_allclose(v.T @ v, np.eye(n), atol=1e-14)
        us = np.reshape(d.u[: m * n], (n, m)).T
        np.testing.assert_allclose(us @ v.T, a, atol=1e-13 * size)
        rank = np.linalg.matrix_rank(a, tol=1e-9 * size)
        assert rank_above(d, n, 1e-9 * size) == rank
        svd_of_transpose(d, m, n, flat(a))
        np.testing.assert_allclose(d.s[: len(values)][:n], values, rtol=1e-12, atol=1e-14 * size)
        x = floats(n * m)
        assert pseudo_inverse(d, m, n, flat(a), 1e-10, x) == np.linalg.matrix_rank(
            a, tol=1e-10 * values[0]
        )
        inverse = np.linalg.pinv(a, rcond=1e-10)
        np.testing.assert_allclose(
            np.reshape(x, (n, m)), inverse, atol=1e-9 * np.abs(inverse).max()
        )
        b = np.random.default_rng(m).normal(size=(m, 2))
        y = floats(n * 2)
        found = np.linalg.lstsq(a, b, rcond=1e-10)
        assert least_squares(d, m, n, flat(a), 1e-10, 2, flat(b), y) == found[2]
        np.testing.assert_allclose(
            np.reshape(y, (n, 2)), found[0], atol=1e-9 * np.abs(found[0]).max(initial=1e-300)
        )


@pytest.mark.parametrize(("m", "n"), [*SIZES, (0, 3)])
def test_null_spaces_are_those_of_scipy(m, n):
    d = make_svd(max(m, n), max(m, n))
    for a in matrices(m, n, 13 * m + n) if m else [np.zeros((0, 3))]:
        basis = floats(n * n)
        free = null_space(d, m, n, flat(a), 1e-10, basis)
        expected = scipy_null_space(a, rcond=1e-10)
        assert free == expected.shape[1]
        found = np.reshape(basis[: n * free], (n, free))
        # the same space, whatever its basis
        np.testing.assert_allclose(found @ found.T, expected @ expected.T, atol=1e-10)


def test_products():
    a, b = np.arange(6.0).reshape(2, 3), np.arange(12.0).reshape(3, 4)
    c = floats(8)
    times_matrix(2, 3, 4, flat(a), flat(b), c)
    np.testing.assert_array_equal(np.reshape(c, (2, 4)), a @ b)
