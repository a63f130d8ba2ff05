"""The laws of junctions decided together, held against `modes.laws.problem`."""

import numpy as np
import pytest

from hybond.engine.complementarity.law_problem import solve_laws
from hybond.engine.complementarity.law_roles import make_law_problem
from hybond.modes.laws import problem as reference

ROLES = [
    reference.ONE_SIDED,
    reference.TWO_SIDED,
    reference.CUT,
    reference.HELD,
    reference.FORWARD,
    reference.BACKWARD,
]


def problems(count: int, roles: int):
    """Yield problems of ports in the first of these roles."""
    generator = np.random.default_rng(roles)
    for k in range(count):
        n = int(generator.integers(1, 7))
        rank = int(generator.integers(1, n + 1))
        b = generator.integers(-2, 3, size=(n, rank)).astype(float)
        M = b @ b.T
        if k % 2:
            skew = generator.integers(-1, 2, size=(n, n))
            M = M + skew - skew.T
        q = generator.integers(-2, 3, size=n) * 10.0 ** generator.integers(-4, 2, size=n)
        chosen = [ROLES[i] for i in generator.integers(0, roles, size=n)]
        common = [bool(a) for a in generator.integers(0, 2, size=n)]
        shift = generator.normal(size=n) if k % 3 == 0 else None
        friction = {}
        for i in range(n):
            if chosen[i] in (reference.TWO_SIDED, reference.FORWARD, reference.BACKWARD):
                slope = generator.normal(size=n) * (0.1 if k % 5 == 0 else 0.0)
                friction[i] = reference.Friction(float(generator.uniform(0.0, 2.0)), slope)
        start = generator.integers(-1 if roles > 1 else 0, 2, size=n).astype(np.int8)
        yield reference.Problem(M, q, chosen, common, shift, friction), start


def posed(problem):
    n = len(problem.q)
    p = make_law_problem(n)
    p.n = n
    p.m[:] = problem.M.ravel().tolist()
    p.q[:] = problem.q.tolist()
    p.role[:] = [ROLES.index(r) for r in problem.roles]
    p.common[:] = [int(c) for c in problem.common]
    p.shifted = problem.shift is not None
    if problem.shift is not None:
        p.shift[:] = problem.shift.tolist()
    for k, limit in problem.friction.items():
        p.limit[k] = limit.value
        p.slope[k * n : (k + 1) * n] = limit.slope.tolist()
    return p


@pytest.mark.sampled(3)
@pytest.mark.parametrize("roles", [1, 2, 3, 4, 6])
def test_laws_do_what_they_do_in_the_reference(roles):
    solved = unsolved = 0
    for problem, start in problems(120, roles):
        p = posed(problem)
        expected = reference.solve_laws(problem, start=start)
        found = solve_laws(p, [int(a) for a in start])
        assert found == (expected is not None)
        if expected is None:
            unsolved += 1
            continue
        solved += 1
        size = max(1.0, np.abs(expected.l).max())
        # a pair that is zero on both sides takes either branch, which one is rounding
        w = problem.M @ expected.l + problem.moved
        clear = np.maximum(np.abs(expected.l), np.abs(w)) > 1e-9 * size
        np.testing.assert_array_equal(np.array(p.branch)[clear], expected.branch[clear])
        np.testing.assert_allclose(p.l, expected.l, atol=1e-9 * size)
    assert solved > 40
    assert unsolved > 0


def test_switches_that_leave_a_part_afloat_share_by_least_voltage():
    """A bridge without a gate: its four currents are zero, one voltage is not decided."""
    M = np.array([[0.0, 1, 0, 0], [-1, 0.1, 0.1, 0], [0, 0.1, 0.1, -1], [0, 0, 1, 0]])
    q = np.array([-3.0, 0.0, 0.0, -3.0])
    roles = [reference.CUT, reference.HELD, reference.HELD, reference.CUT]
    bridge = reference.Problem(M, q, roles, [True, False, False, True])
    found = reference.solve_laws(bridge, start=np.zeros(4, dtype=np.int8))
    assert found is not None
    assert found.l == pytest.approx(np.zeros(4), abs=1e-15)
    p = posed(bridge)
    assert solve_laws(p, [0, 0, 0, 0])
    assert p.l == pytest.approx(np.zeros(4), abs=1e-15)
    # driven against each other they have no answer, and none is made up
    driven = reference.Problem(M, np.array([0.0, 1.0, -1.0, 0.0]), roles, bridge.common)
    assert reference.solve_laws(driven, start=np.zeros(4, dtype=np.int8)) is None
    assert not solve_laws(posed(driven), [0, 0, 0, 0])
