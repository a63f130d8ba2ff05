"""Complementarity problems of the exported runtime, held against the solvers of hybond."""

import numpy as np
import pytest

from hybond.engine.complementarity.friction_disk import make_disk, on_disk
from hybond.engine.complementarity.lcp import NO_CHOICE, ON_A_RAY, SOLVED, make_lcp
from hybond.engine.complementarity.lcp_forms import make_mixed, solve_mixed
from hybond.engine.complementarity.lemke import lemke
from hybond.engine.words import ints
from hybond.solvers import lcp as reference
from hybond.solvers.friction_disk import on_disk as reference_disk
from hybond.solvers.lemke import scaled as reference_scaled

STATUS = {SOLVED: "solved", ON_A_RAY: "ray", NO_CHOICE: "singular"}


def flat(a):
    return np.asarray(a, dtype=float).ravel().tolist()


def problems(count: int):
    """Yield matrices of graphs: definite, semidefinite, skew, badly scaled, idle pairs."""
    generator = np.random.default_rng(5)
    for k in range(count):
        n = int(generator.integers(1, 9))
        rank = int(generator.integers(0, n + 1))
        b = generator.integers(-2, 3, size=(n, rank)).astype(float)
        M = b @ b.T
        if k % 3 == 1:
            skew = generator.integers(-1, 2, size=(n, n)).astype(float)
            M = M + skew - skew.T
        if k % 3 == 2:
            d = 10.0 ** generator.integers(-4, 5, size=n)
            M = M * d * d[:, None]
        q = generator.integers(-3, 4, size=n).astype(float)
        if k % 2:
            q = q + generator.normal(size=n)
        yield M, q, generator.integers(0, 2, size=n).astype(bool)


@pytest.mark.parametrize("warm", [False, True])
def test_lemke_takes_the_way_of_the_reference(warm):
    seen = set()
    for M, q, guess in problems(250):
        n = len(q)
        p = make_lcp(n)
        begin = guess if warm else np.zeros(n, dtype=bool)
        status = lemke(p, n, flat(M), flat(q), [int(a) for a in begin])
        expected = reference.lemke(M, q, start=begin)
        seen.add(expected.status)
        assert STATUS[status] == expected.status
        block = reference_scaled(M, q)[0][np.ix_(begin, begin)]
        if np.linalg.matrix_rank(block, tol=1e-12) == begin.sum():
            # whether a singular block has a pivot that is exactly zero is rounding
            assert p.pivots == expected.pivots
        if status == SOLVED:
            np.testing.assert_array_equal(np.array(p.active, dtype=bool), expected.active)
            np.testing.assert_allclose(p.z, expected.z, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(p.w, expected.w, rtol=1e-9, atol=1e-9)
            assert tuple(np.flatnonzero(p.open)) == expected.degenerate
    assert seen == {"solved", "ray"}


def mixed_problems(count: int):
    """Yield forms A, B, C, q in which some guessed choice is singular, and some every one."""
    generator = np.random.default_rng(9)
    for k in range(count):
        n, m = int(generator.integers(1, 6)), int(generator.integers(0, 4))
        rows = n + m
        A = generator.integers(-2, 3, size=(rows, n)).astype(float)
        B = generator.integers(-2, 3, size=(rows, n)).astype(float)
        C = generator.integers(-2, 3, size=(rows, m)).astype(float)
        if k % 4 == 0:
            A[:, 0] = 0.0
        if k % 11 == 0:
            A[-1] = B[-1] = C[-1] = 0.0
        if k % 3 == 0:
            A, B, C = (a * 10.0 ** generator.integers(-3, 4, size=(rows, 1)) for a in (A, B, C))
        yield A, B, C, generator.normal(size=rows), generator.integers(0, 2, size=n).astype(bool)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("warm", [False, True])
def test_mixed_problems_are_solved_as_by_the_reference(warm):
    seen = []
    for A, B, C, q, guess in mixed_problems(250):
        n, m = A.shape[1], C.shape[1]
        x = make_mixed(n, m)
        x.whole[:] = flat(np.hstack([A, B, C]))
        x.right[:] = flat(q)
        status = solve_mixed(x, n, m, [int(a) for a in guess] if warm else ints(n), warm)
        expected = reference.mixed(A, B, q, C=C, start=guess if warm else None)
        seen.append(expected.status)
        assert STATUS[status] == expected.status
        if status == SOLVED:
            size = max(np.abs(expected.z).max(), np.abs(expected.w).max(), 1.0)
            np.testing.assert_array_equal(np.array(x.active, dtype=bool), expected.active)
            np.testing.assert_allclose(x.a, expected.z, atol=1e-9 * size)
            np.testing.assert_allclose(x.b, expected.w, atol=1e-9 * size)
            np.testing.assert_allclose(x.c, expected.free, atol=1e-9 * max(size, 1.0))
    assert {s: seen.count(s) > 5 for s in ("solved", "ray", "singular")} == {
        "solved": True,
        "ray": True,
        "singular": True,
    }


def test_the_direction_of_slip_is_that_of_the_reference():
    generator = np.random.default_rng(2)
    found = 0
    for k in range(60):
        b = generator.normal(size=(2, 2))
        A = b @ b.T
        f0 = generator.normal(size=2)
        limit = float(generator.uniform(0.0, 2.0))
        slope = generator.normal(size=2) * (0.3 if k % 2 else 0.0)
        d = make_disk()
        d.f0[:], d.a[:], d.slope[:], d.limit = flat(f0), flat(A), flat(slope), limit
        expected = reference_disk(f0, A, limit, slope)
        assert on_disk(d) == (expected is not None)
        if expected is not None:
            found += 1
            np.testing.assert_allclose([d.x, d.y], expected, atol=1e-13)
    assert found > 20
