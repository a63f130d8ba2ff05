"""Pairs on equal terms, against enumeration of all choices."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from engine_lcp import is_among, lemke, mixed, p_matrix
from listed import listed


def every_choice(A, B, C, q):
    """(regular choices, solutions) of A a + B b + C c = q by brute force."""
    n, regular, solutions = A.shape[1], 0, []
    for bits in itertools.product([False, True], repeat=n):
        chosen = np.hstack([np.where(bits, A, B), C])
        if np.linalg.matrix_rank(chosen, tol=1e-9) < len(q):
            continue
        regular += 1
        x = np.linalg.solve(chosen, q)
        if x[:n].min(initial=0.0) >= -1e-9:
            a, b = np.where(bits, x[:n], 0.0), np.where(bits, 0.0, x[:n])
            solutions.append(np.concatenate([a, b, x[n:]]))
    return regular, solutions


@listed("seed", [*range(200), 2280, 4044])  # the last: rounding took for a unit
def test_pairs_are_refused_exactly_when_every_choice_is_singular(seed):
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 6)), int(rng.integers(0, 3))
    sparse = rng.random((n + m, 2 * n + m)) < 0.4  # sparse: many choices are singular
    W = rng.integers(-2, 3, sparse.shape) * sparse
    A, B, C = W[:, :n].astype(float), W[:, n : 2 * n].astype(float), W[:, 2 * n :].astype(float)
    q = rng.integers(-3, 4, n + m).astype(float)
    regular, solutions = every_choice(A, B, C, q)
    found = mixed(A, B, q, C=C)
    assert (found.status == "singular") == (regular == 0)
    if found.infeasible:
        assert not solutions
    if found.status == "solved":
        assert is_among(np.concatenate([found.z, found.w, found.free]), solutions)
        again = mixed(A, B, q, C=C, start=found.active)
        assert again.pivots == 0 and again.z == pytest.approx(found.z)


@listed("seed", range(30))
def test_pairs_of_a_standard_problem_mixed_up_give_its_solution(seed):
    # Rows combined, some pairs named the other way round, units changed: still w = M z + q.
    rng = np.random.default_rng(seed)
    n = 8
    M, q = p_matrix(rng, n), rng.normal(size=n)
    expected = lemke(M, q)
    swap, mix = rng.random(n) < 0.5, rng.normal(size=(n, n))
    d, e = 10.0 ** rng.uniform(-5, 5, n), 10.0 ** rng.uniform(-5, 5, n)
    A, B = mix @ np.where(swap, np.eye(n), -M) * d, mix @ np.where(swap, -M, np.eye(n)) * e
    found = mixed(A, B, mix @ q)
    a, b = (
        np.where(swap, expected.w, expected.z) / d,
        np.where(swap, expected.z, expected.w) / e,
    )
    assert found.z * d == pytest.approx(a * d, abs=1e-9)
    assert found.w * e == pytest.approx(b * e, abs=1e-9)
    assert (found.active == (found.z > 0.0)).all()


def test_a_guess_that_is_nearly_singular_costs_no_accuracy():
    # Both a chosen: determinant 1e-13. The solution has a_0 and b_1.
    A = np.array([[1.0, 1.0], [1.0, 1.0 + 1e-13]])
    B = np.array([[1.0, -1.0], [-1.0, 1.0 / 3.0]])
    expected = np.linalg.solve(np.column_stack([A[:, 0], B[:, 1]]), [0.4, 0.9])
    found = mixed(A, B, [0.4, 0.9], start=[0, 1])
    assert found.active.tolist() == [True, False] and expected.min() > 0.0
    assert [found.z[0], found.w[1]] == pytest.approx(expected, rel=1e-14)


def test_a_dependent_free_unknown_leaves_no_choice():
    found = mixed(np.ones((3, 1)), np.eye(3)[:, :1], np.ones(3), C=np.ones((3, 2)))
    assert found.status == "singular"


def test_two_diodes_across_a_source_that_only_a_short_would_satisfy_are_refused():
    # Two voltages fixed by one source: the currents of both pairs stay open, whatever is chosen.
    A = np.array([[1.0, 1.0], [2.0, 2.0]])
    found = mixed(A, 3.0 * A, [1.0, 2.0])
    assert found.status == "singular"


@listed("seed", range(120))
def test_units_and_a_wrong_guess_change_nothing(seed):
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 6)), int(rng.integers(0, 4))
    W = rng.integers(-2, 3, size=(n + m, 2 * n + m)).astype(float)
    if seed % 4 == 0:
        W[:, 0] = 0.0  # some guessed choice is singular
    if seed % 11 == 0:
        W[-1] = 0.0  # every one is
    W *= 10.0 ** rng.integers(-3, 4, size=(n + m, 1))
    A, B, C = W[:, :n], W[:, n : 2 * n], W[:, 2 * n :]
    q = rng.normal(size=n + m)
    regular, solutions = every_choice(A, B, C, q)
    for start in (None, rng.random(n) < 0.5):
        found = mixed(A, B, q, C=C, start=start)
        assert (found.status == "singular") == (regular == 0)
        if found.status == "solved":
            assert is_among(np.concatenate([found.z, found.w, found.free]), solutions)
        if found.infeasible:
            assert not solutions
