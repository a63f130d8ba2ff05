"""Complementarity problems against enumeration of all choices, textbooks, and optimisers."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from engine_lcp import (
    answers_by_engine,
    hybrid_matrix,
    is_among,
    lemke,
    p_matrix,
    positive_semidefinite,
    violation,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from listed import listed
from scipy.optimize import linprog, nnls

KOSTREVA = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 2.0], [2.0, 0.0, 1.0]])


NETWORK = np.array(  # positive semidefinite with a skew part
    [[5.0, 2, 0, 0, -2], [2, 4, 0, -6, 4], [6, -4, 5, 7, -2], [4, -2, 5, 8, -7], [0, 0, -4, -1, 2]]
)


def every_solution(M, q):
    """All solutions (z, w) at regular choices, by brute force."""
    n = len(q)
    for bits in itertools.product([False, True], repeat=n):
        on, z = np.array(bits), np.zeros(n)
        if on.any():
            block = M[np.ix_(on, on)]
            if np.linalg.cond(block) > 1e10:
                continue
            z[on] = np.linalg.solve(block, -q[on])
        w = M @ z + q
        if min(z.min(), w.min()) >= -1e-9:
            yield z, w


@listed("seed", range(60))
def test_a_p_matrix_has_the_one_solution_of_the_enumeration(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 9))
    M, q = p_matrix(rng, n), rng.normal(size=n)
    solutions = list(every_solution(M, q))
    found = lemke(M, q)
    assert found.status == "solved" and len(solutions) == 1
    assert found.z == pytest.approx(solutions[0][0], abs=1e-12)
    assert found.w == pytest.approx(solutions[0][1], abs=1e-12)
    assert answers_by_engine(M, q) == (1, False)


@listed("seed", range(150))
def test_network_matrices_are_solved_exactly_when_the_enumeration_finds_a_solution(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 8))
    M = hybrid_matrix(rng, n)
    q = rng.integers(-3, 4, n).astype(float)  # small integers: ties and degenerate pairs galore
    start = rng.random(n) < 0.5 if seed % 2 else None
    solutions = list(every_solution(M, q))
    found = lemke(M, q, start=start)
    assert found.status == ("solved" if solutions else "ray")
    if solutions:
        assert is_among(found.z, [z for z, _ in solutions])
        assert found.w == pytest.approx(M @ found.z + q, abs=1e-10)
        assert not (found.z * found.w).any() and min(found.z.min(), found.w.min()) >= 0.0
        both = np.flatnonzero((found.z < 1e-9) & (found.w < 1e-9))
        assert found.degenerate == tuple(both)
    else:  # Farkas: the ray itself proves that there is none
        assert found.infeasible
        assert (found.ray @ M).max() <= 1e-9 and found.ray.min() >= -1e-9 and found.ray @ q < 0.0


@listed("seed", range(100))
def test_for_any_matrix_what_is_found_is_a_solution_and_a_proof_is_a_proof(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 7))
    M, q = rng.integers(-2, 3, (n, n)).astype(float), rng.integers(-3, 4, n).astype(float)
    found = lemke(M, q)
    assert found.status in ("solved", "ray")
    if found.status == "solved":
        assert violation(M, q, found.z) <= 1e-12
    if found.infeasible:
        assert linprog(np.zeros(n), A_ub=-M, b_ub=q).status == 2  # HiGHS: infeasible


def test_an_example_of_murty():
    # Linear Complementarity, Linear and Nonlinear Programming, example 2.8.
    M = [[1, -1, -1, -1], [-1, 1, -1, -1], [1, 1, 2, 0], [1, 1, 0, 2]]
    found = lemke(M, [3, 5, -9, -5])
    assert found.z == pytest.approx([2, 1, 3, 1], abs=1e-12)
    assert found.active.all() and found.degenerate == ()


@pytest.mark.parametrize("n", [3, 6, 10])
def test_murtys_example_takes_exponentially_many_pivots_and_is_solved(n):
    # Murty 1978: M lower triangular, ones and twos, q = -1: 2^n - 1 changes of basis.
    M = np.tril(np.full((n, n), 2.0), -1) + np.eye(n)
    found = lemke(M, -np.ones(n))
    assert found.pivots == 2**n
    assert found.z.tolist() == [1.0] + [0.0] * (n - 1)
    assert lemke(M, -np.ones(n), start=[0]).pivots == 0


def bases_of_plain_lemke(M, q, pick, steps=40):
    """Lemke's algorithm without a lexicographic rule: the bases it passes, last "solved" if so."""
    n = len(q)
    columns = np.hstack([np.eye(n), -M, -np.ones((n, 1))])
    basis, passed = list(range(n)), []
    entering, r = 2 * n, pick(np.flatnonzero(q == q.min()), 0)
    for step in range(1, steps):
        leaving, basis[r] = basis[r], entering
        passed.append(tuple(basis))
        if leaving == 2 * n:
            return [*passed, "solved"]
        entering = leaving + n if leaving < n else leaving - n
        B = columns[:, basis]
        x, d = np.linalg.solve(B, q), np.linalg.solve(B, columns[:, entering])
        ratio = np.where(d > 1e-9, x / np.where(d > 1e-9, d, 1.0), np.inf)
        r = pick(np.flatnonzero(ratio <= ratio.min() + 1e-9), step)
    return passed


# Kostreva, Cycling in linear complementarity problems, Math. Programming 16:127-130, 1979.
@pytest.mark.parametrize("M", [KOSTREVA, NETWORK], ids=["Kostreva", "network"])
def test_problems_on_which_plain_lemke_cycles_are_solved(M):
    q = -np.ones(len(M))
    passed = bases_of_plain_lemke(M, q, lambda ties, step: int(ties[0]))
    assert passed[-1] != "solved" and len(set(passed)) < len(passed) / 2  # bases come back
    found = lemke(M, q)
    assert found.status == "solved" and found.pivots <= 2 * len(q)
    assert is_among(found.z, [z for z, _ in every_solution(M, q)])
    if M is KOSTREVA:
        assert found.z == pytest.approx([1 / 3] * 3, abs=1e-15)


def test_an_infeasible_problem_ends_on_a_ray_that_proves_it():
    # Two valves in a loop that only lets through what another source draws the other way.
    M = np.array([[0.0, 1.0], [-1.0, 0.0]])
    found = lemke(M, [1.0, -1.0])
    assert found.status == "ray" and found.infeasible
    # Painleve's inconsistent case: a negative matrix; here the ray is no proof in general.
    assert lemke([[-1.0]], [-1.0]).status == "ray"


def test_a_tie_with_the_artificial_unknown_ends_the_path():
    # Going on in lexicographic order instead would pass the solution and end on a ray.
    found = lemke([[2.0, 2.0, 2.0], [2.0, -1.0, 0.0], [1.0, 1.0, 0.0]], [-2.0, 0.0, -1.0])
    assert found.status == "solved" and found.z == pytest.approx([1.0, 0.0, 0.0])


def test_a_ray_from_a_wrong_start_is_not_the_last_word():
    M, q = [[2.0, 2.0, -1.0], [0.0, 0.0, 2.0], [-2.0, 1.0, 2.0]], [2.0, -1.0, -2.0]
    found = lemke(M, q, start=[0, 1])
    assert found.status == "solved" and found.z == pytest.approx([0.0, 0.0, 1.0])


@listed("seed", range(20))
def test_least_squares_with_signs_agree_with_nnls(seed):
    rng = np.random.default_rng(seed)
    A, b = rng.normal(size=(30, 12)), rng.normal(size=30)
    x, _ = nnls(A, b)
    found = lemke(A.T @ A, -A.T @ b)
    assert found.z == pytest.approx(x, abs=1e-12)
    assert (found.active == (x > 0.0)).all()


@listed("seed", range(20))
def test_a_linear_programme_as_complementarity_agrees_with_highs(seed):
    # min c'x, A x >= b, x >= 0: a skew matrix, every active block is a saddle point.
    rng = np.random.default_rng(seed)
    A, x0, y0 = rng.normal(size=(6, 9)), rng.random(9), rng.random(6)
    b, c = A @ x0 - rng.random(6), A.T @ y0 + rng.random(9)
    M = np.block([[np.zeros((9, 9)), -A.T], [A, np.zeros((6, 6))]])
    found = lemke(M, np.concatenate([c, -b]))
    assert found.z[:9] @ c == pytest.approx(linprog(c, A_ub=-A, b_ub=-b).fun, abs=1e-9)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_a_start_that_is_nearly_right_takes_few_pivots(wrong):
    rng = np.random.default_rng(5)
    G, K = rng.normal(size=(40, 40)), rng.normal(size=(40, 40))
    M, q = G @ G.T / 40 + K - K.T, rng.normal(size=40)
    cold, pivots = lemke(M, q), []
    for _ in range(12):
        start = cold.active.copy()
        start[rng.choice(40, wrong, replace=False)] ^= True
        warm = lemke(M, q, start=start)
        assert (warm.active == cold.active).all() and warm.z == pytest.approx(cold.z, rel=1e-11)
        assert (lemke(M, q, start=np.flatnonzero(start)).z == warm.z).all()
        pivots.append(warm.pivots)
    assert np.mean(pivots) <= 4 * wrong < cold.pivots / 4


def test_a_start_with_dependent_contacts_keeps_the_independent_ones():
    # A table on four legs: three are independent, and all four were guessed.
    legs = np.array([[1.0, 1, 1], [1, -1, 1], [1, 1, -1], [1, -1, -1]])
    found = lemke(legs @ legs.T, -np.ones(4), start=np.ones(4, dtype=bool))
    assert found.status == "solved" and found.pivots == 0 and found.active.sum() < 4
    assert legs @ (legs.T @ found.z) == pytest.approx(np.ones(4), abs=1e-14)
    skew = [[0.0, -1.0, -1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]  # no diagonal to pivot on
    found = lemke(skew, [1.0, -1.0, -1.0], start=[0, 1, 2])
    assert found.pivots == 0 and found.active.sum() == 2 and len(found.degenerate) == 1
    assert found.z[0] == 1.0 and sorted(found.z[1:]) == [0.0, 1.0]


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 20))
def test_a_feasible_semidefinite_problem_is_solved(seed, n):
    rng = np.random.default_rng(seed)
    M = hybrid_matrix(rng, n) * 10.0 ** rng.integers(-3, 4)
    z, w = (rng.integers(0, 4, n) * (rng.random(n) < 0.6) for _ in range(2))
    q = w - M @ z  # z is feasible, not complementary
    found = lemke(M, q, start=rng.random(n) < 0.5 if seed % 2 else None)
    assert found.status == "solved"
    assert violation(M, q, found.z) <= 1e-10
    assert positive_semidefinite(M)


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
def test_units_do_not_change_the_choice(seed, n):
    rng = np.random.default_rng(seed)
    M, q = p_matrix(rng, n), rng.normal(size=n)
    d = 10.0 ** rng.uniform(-6, 6, n)
    plain, scaled = lemke(M, q), lemke(M * d[:, None] * d, q * d * 1e5)
    assert (scaled.active == plain.active).all()
    assert scaled.z * d / 1e5 == pytest.approx(plain.z, rel=1e-11, abs=1e-12)
    assert violation(M * d[:, None] * d, q * d, scaled.z / 1e5) <= 1e-13


def test_a_pair_with_only_rounding_in_its_row_does_not_hide_the_others():
    # Nothing couples pair 1; scaled to a unit of its own it dwarfs the pair that fails.
    M = np.diag([2.0, 0.0, 1.0])
    M[1, 2] = -2.96e-16
    found = lemke(M, [1.25, 1.0, -1.5])
    assert found.status == "solved" and found.z.tolist() == [0.0, 0.0, 1.5]
    assert lemke(np.where(M < 1e-9, M, 0.0), [1.25, 1.0, -1.5]).status != "solved"


# Uniqueness


@listed("seed", range(20))
def test_semidefiniteness_agrees_with_the_eigenvalues(seed):
    rng = np.random.default_rng(seed)
    M, d = hybrid_matrix(rng, 6), 10.0 ** rng.uniform(-4, 4, 6)
    assert positive_semidefinite(M * d[:, None] * d)
    M -= (np.linalg.eigvalsh(M + M.T)[0] / 2.0 + 1e-3) * np.eye(6)
    assert not positive_semidefinite(M * d[:, None] * d)


def test_painleves_rod_has_two_answers_or_none():
    # A rod of length 2 l sliding on its tip: a = g-term + A N, with A = 1/m (1 + 3 cos(th)
    # (cos(th) - mu sin(th))) negative for mu > 4/3 at tan(th) = 2.
    angle, mu = np.arctan(2.0), 2.0
    A = 1.0 + 3.0 * np.cos(angle) * (np.cos(angle) - mu * np.sin(angle))
    assert abs(A + 0.8) < 1e-15
    assert answers_by_engine([[A]], [0.4]) == (2, False)
    assert answers_by_engine([[A]], [-0.4]) == (0, True)
    assert lemke([[A]], [-0.4]).status == "ray"


@listed("seed", range(60))
def test_answers_are_counted_as_the_enumeration_counts_them(seed):
    rng = np.random.default_rng(seed)
    M, q = rng.normal(size=(4, 4)) - 0.5 * np.eye(4), rng.normal(size=4) + 0.5
    answers = list(every_solution(M, q))
    different = {tuple(np.round(w, 7)) for _, w in answers}
    # at most six are told apart; parts that do not feel each other there are none
    assert answers_by_engine(M, q) == (min(len(different), 6), not different)


@listed("seed", range(20))
def test_redundant_contacts_share_forces_as_they_like_but_part_in_one_way(seed):
    rng = np.random.default_rng(seed)
    G = rng.integers(-1, 2, (8, 3)).astype(float)
    M, q = G @ G.T, G @ rng.normal(size=3)
    first = lemke(M, q)
    assert first.status == "solved" and answers_by_engine(M, q) == (1, False)
    for z, w in every_solution(M, q):
        assert first.w == pytest.approx(w, abs=1e-9)
        assert G.T @ first.z == pytest.approx(G.T @ z, abs=1e-9)


def test_a_guess_from_which_rounding_leads_round_in_a_ring_is_left():
    """A ladder of twenty diodes by Kirchhoff, blocking voltages from 150 V to 1e-8 V."""
    n = 20
    stack = np.array([[float(j <= k and (k - j) % 2 == 0) for j in range(n)] for k in range(n)])
    ends = np.eye(n) - np.eye(n, k=1)  # the charge of a diode enters one node and leaves another
    M = ends.T @ stack @ stack.T @ ends
    q = np.zeros(n)
    q[:15:2] = [149.8, 87.84, 38.97, 13.42, 3.421, 0.6012, 0.06409, 0.003052]
    q[1] = -7.379e-9
    start = np.array([int(c) for c in "00010101010101011011"], dtype=bool)
    found = lemke(M, q, start=start)
    assert found.status == "solved"
    assert found.z @ M @ found.z == pytest.approx(-found.z @ q, rel=1e-9)  # z w = 0
    assert (M @ found.z + q).min() >= -1e-11
