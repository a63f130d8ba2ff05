"""None, one or several answers of a few laws, against all branches in exact fractions."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest
from engine_lcp import flat
from listed import listed

from hybond.engine.algebra.least_distance import make_least_distance, nearest_point
from hybond.engine.complementarity.all_branches import answer_laws
from hybond.engine.complementarity.branch_records import NOT_OF_PART
from hybond.engine.complementarity.law_roles import (
    BACKWARD,
    CUT,
    FORWARD,
    ONE_SIDED,
    SHUT,
    TWO_SIDED,
    LawProblem,
    make_law_problem,
)

Row = list[Fraction]
"""Coefficients of the unknowns, then a constant."""


def posed(M, q, role, common, limit, slope) -> LawProblem:
    n = len(q)
    p = make_law_problem(n)
    p.n = n
    p.m[:], p.q[:], p.limit[:], p.slope[:] = flat(M), flat(q), flat(limit), flat(slope)
    p.role[:], p.common[:] = [int(r) for r in role], [int(c) for c in common]
    p.rank[:] = list(range(n))
    return p


def feasible(equal: list[Row], least: list[Row]) -> bool:
    """Whether numbers exist with rows of `equal` zero and rows of `least` not negative."""
    equal, least = [list(r) for r in equal], [list(r) for r in least]
    unknowns = len((equal + least)[0]) - 1
    for k in range(unknowns):
        row = next((r for r in equal if r[k]), None)
        if row is not None:
            equal.remove(row)
            for rows in (equal, least):
                for r in rows:
                    part = r[k] / row[k]
                    r[:] = [a - part * b for a, b in zip(r, row)]
            continue
        up = [r for r in least if r[k] > 0]
        down = [r for r in least if r[k] < 0]
        least = [r for r in least if not r[k]]
        for a, b in itertools.product(up, down):  # Fourier and Motzkin
            least.append([x / a[k] - y / b[k] for x, y in zip(a, b)])
    return not any(r[-1] for r in equal) and all(r[-1] >= 0 for r in least)


def branches(M, q, role, common, limit, slope):
    """Yield each choice of branches with its equations and its inequalities."""
    n = len(q)
    F = Fraction
    unit = [[F(int(i == j)) for j in range(n)] + [F(0)] for i in range(n)]
    w = [[F(a) for a in M[k]] + [F(q[k])] for k in range(n)]
    most = [[F(a) for a in slope[k]] + [F(limit[k])] for k in range(n)]

    def plus(a: Row, b: Row, part: int = 1) -> Row:
        return [x + part * y for x, y in zip(a, b)]

    ways = {ONE_SIDED: (0, 1), TWO_SIDED: (-1, 0, 1), FORWARD: (1,), BACKWARD: (-1,)}
    for choice in itertools.product(*(ways.get(r, (0,)) for r in role)):
        equal, least = [], []
        for k, way in enumerate(choice):
            net = [-a for a in (w[k] if common[k] else unit[k])]
            speed = unit[k] if common[k] else w[k]
            if role[k] == ONE_SIDED:
                equal.append(w[k] if way else unit[k])
                least.append(unit[k] if way else w[k])
            elif role[k] in (CUT, SHUT):
                equal.append(unit[k] if role[k] == CUT else w[k])
            elif role[k] != TWO_SIDED:
                equal.append(plus([-a for a in unit[k]], most[k], -way))
            elif way:
                equal.append(plus(net, most[k], -way))
                least += [[way * a for a in speed], most[k]]
            else:
                equal.append(speed)
                least += [plus(most[k], net, 1), plus(most[k], net, -1)]
        yield choice, equal, least


def problem(seed: int, kinds: list[int], sloped: bool):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    M = rng.integers(-2, 3, (n, n))
    if seed % 3 == 0:
        b = rng.integers(-1, 2, (n, max(1, n - 1)))
        M = b @ b.T  # passive, and mostly singular
    role = [kinds[i] for i in rng.integers(0, len(kinds), n)]
    rubs = np.isin(role, (TWO_SIDED, FORWARD, BACKWARD))
    slope = rng.integers(-2, 3, (n, n)) * rubs[:, None] * int(sloped)
    common = rng.integers(0, 2, n)
    return M, rng.integers(-2, 3, n), role, common, rng.integers(0, 3, n) * rubs, slope


def follows(given, p: LawProblem) -> bool:
    """Whether the answer in `p`, as fractions of twelve digits, is one of its own branches."""
    M, q, role, common, limit, slope = given
    l = np.array(p.l)
    w = M @ l + q
    most = limit + slope @ l
    size = 1e-9 * (1.0 + np.abs(l).max())
    good = True
    for k, r in enumerate(role):
        net, speed = (-w[k], l[k]) if common[k] else (-l[k], w[k])
        if r == ONE_SIDED:
            good &= l[k] > -size and w[k] > -size and min(l[k], w[k]) < size
        elif r == TWO_SIDED and abs(speed) > size:
            good &= abs(net - np.sign(speed) * most[k]) < size
        elif r == TWO_SIDED:
            good &= abs(net) < most[k] + size
    return bool(good)


@pytest.mark.sampled(1)
@listed("seed", range(240))
@pytest.mark.parametrize(
    ("kinds", "sloped"),
    [
        ([ONE_SIDED], False),
        ([ONE_SIDED, TWO_SIDED], True),
        ([ONE_SIDED, TWO_SIDED, CUT, SHUT, FORWARD, BACKWARD], True),
    ],
)
def test_no_solution_is_said_if_and_only_if_there_is_none(seed, kinds, sloped) -> None:
    """Singular choices included: there a whole face may answer, or none."""
    given = problem(seed, kinds, sloped)
    p = posed(*given)
    start = [int(a) for a in np.random.default_rng(seed).integers(0, 2, p.n)]
    exists = any(feasible(equal, least) for _, equal, least in branches(*given))
    assert answer_laws(p, start) == exists
    assert p.proved == (not exists)
    if exists:
        assert follows(given, p)


@listed("seed", range(240))
def test_several_are_told_apart_by_what_moves(seed) -> None:
    """Where each choice of branches is regular its answers can be counted exactly."""
    given = problem(3 * seed + 1, [ONE_SIDED, TWO_SIDED], True)
    M, q = given[0], given[1]
    answers = set()
    for _choice, equal, least in branches(*given):
        rows = np.array([[float(a) for a in r[:-1]] for r in equal])
        if abs(np.linalg.det(rows)) < 0.5:  # whole numbers: it is zero
            return
        if feasible(equal, least):
            l = np.linalg.solve(rows, [-float(r[-1]) for r in equal])
            answers.add(tuple(np.round(M @ l + q, 6) + 0.0))
    p = posed(*given)
    assert answer_laws(p, [0] * p.n) == bool(answers)
    if answers:
        # parts that do not feel each other are counted apart
        whole = all(p.answer_way[k] != NOT_OF_PART for k in range(p.n)) and p.answers > 1
        if whole:
            assert p.answers == len(answers)
        assert (p.answers > 1) == (len(answers) > 1)


def test_what_holds_already_is_kept_and_else_what_carries_least() -> None:
    """``w = 1 - l``: l = 0 and l = 1 both do (a wedge, or Painleve)."""
    for start, l in ((0, 0.0), (1, 1.0)):
        p = posed([[-1.0]], [1.0], [ONE_SIDED], [1], [0.0], [[0.0]])
        assert answer_laws(p, [start]) and p.answers == 2
        assert p.l[0] == pytest.approx(l)
    # two of them that do not feel each other, one of which was ON
    p = posed(-np.eye(2), [1.0, 1.0], [ONE_SIDED] * 2, [1, 1], [0, 0], np.zeros((2, 2)))
    assert answer_laws(p, [0, 1])
    assert p.l[:2] == pytest.approx([0.0, 1.0])


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_a_tie_is_decided_by_name_not_by_order(order) -> None:
    """One of two must carry, either may: the first by name stays idle, however it is declared."""
    M = np.array([[-1.0, -2.0], [-2.0, -1.0]])
    q = np.array([1.0, 1.0])
    on = np.array([[0.0, 1.0], [1.0, 0.0]])
    assert all((M @ l + q)[k] == 0.0 for k, l in ((1, on[0]), (0, on[1])))
    held = [[2.0, 1.0], [1.0, 2.0]]
    p = posed(held, [-1.0, -1.0], [ONE_SIDED] * 2, [1, 1], [0, 0], np.zeros((2, 2)))
    assert answer_laws(p, [0, 0]) and p.answers == 1  # monotone: one answer
    p = posed([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.0], [ONE_SIDED] * 2, [1, 1], [0, 0], 0 * M)
    p.rank[:] = list(order)
    assert answer_laws(p, [0, 0]) and p.answers == 3
    carries = p.l[:2].index(max(p.l[:2]))
    assert sorted(p.l[:2]) == pytest.approx([0.0, 1.0])
    assert carries == (1 if order == (0, 1) else 0)


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
@pytest.mark.parametrize("faint", [0.0, 1e-28, 1e-22, 1e-16, 1e-12, 1e-9, 1e-4])
def test_an_idle_law_that_moves_others_by_next_to_nothing_decides_nothing(faint, order) -> None:
    """A diode that blocks whatever others do has no say: of the other two, both carry a current.

    It would move one of them by a rounding of what it carries; it carries nothing.
    """
    M = np.array([[0.0, -1.0, 0.0], [1.0, 1e-6, faint], [0.0, 0.0, 0.0]])
    q = np.array([0.0025, -0.002, 0.003])
    M, q = M[np.ix_(order, order)], q[list(order)]
    for common in itertools.product((0, 1), repeat=3):
        for start in itertools.product((0, 1), repeat=3):
            p = posed(M, q, [ONE_SIDED] * 3, common, [0] * 3, np.zeros((3, 3)))
            assert answer_laws(p, list(start)) and p.answers == 1
            l = np.zeros(3)
            l[order.index(0)], l[order.index(1)] = 0.002 - 1e-6 * 0.0025, 0.0025
            assert p.l[:3] == pytest.approx(l)


def test_more_laws_than_are_tried_claim_nothing() -> None:
    """Fourteen laws that push each other away, all fed: none is found, and none is excluded."""
    n = 14
    rng = np.random.default_rng(4)
    M = -np.eye(n) - 0.1 * rng.random((n, n))
    p = posed(M, -np.ones(n), [ONE_SIDED] * n, [1] * n, np.zeros(n), np.zeros((n, n)))
    assert not answer_laws(p, [0] * n)
    # every entry pulls down: a ray proves it all the same
    assert p.proved
    M[0, 1] = 0.05
    p = posed(M, -np.ones(n), [ONE_SIDED] * n, [1] * n, np.zeros(n), np.zeros((n, n)))
    found = answer_laws(p, [0] * n)
    assert not (p.proved and found)


@listed("seed", range(60))
def test_the_nearest_point_is_that_of_a_quadratic_program(seed) -> None:
    from scipy.optimize import linprog, minimize

    rng = np.random.default_rng(seed)
    n, d = int(rng.integers(1, 7)), int(rng.integers(1, 4))
    g, h = rng.integers(-3, 4, (n, d)).astype(float), rng.integers(-3, 4, n).astype(float)
    z = [0.0] * d
    found = nearest_point(make_least_distance(n, d), n, d, flat(g), flat(h), z)
    possible = linprog(np.zeros(d), A_ub=-g, b_ub=-h, bounds=(None, None)).status == 0
    assert found == possible
    if found:
        assert (g @ z - h).min() > -1e-9
        best = minimize(
            lambda x: x @ x,
            z,
            jac=lambda x: 2.0 * x,
            constraints={"type": "ineq", "fun": lambda x: g @ x - h, "jac": lambda _: g},
            method="SLSQP",
            options={"ftol": 1e-14},
        )
        assert np.dot(z, z) <= best.fun + 1e-6
