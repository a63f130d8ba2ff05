"""The laws of junctions decided together, against their own words and enumeration of branches."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import pytest
from engine_lcp import flat
from scipy.optimize import lsq_linear

from hybond.engine.complementarity.law_problem import solve_laws
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

Array = np.ndarray
ROLES = [ONE_SIDED, TWO_SIDED, CUT, SHUT, FORWARD, BACKWARD]
CLOSE = 1e-8


@dataclass
class Laws:
    """What the laws of some ports ask for: ``w = M l + q``, friction of ``limit + slope l``."""

    M: Array
    q: Array
    role: list[int]
    common: list[bool]
    shift: Array
    limit: Array
    slope: Array

    def posed(self) -> LawProblem:
        """Return the problem as the engine has it."""
        p = make_law_problem(len(self.q))
        p.n = len(self.q)
        p.m[:], p.q[:], p.role[:] = flat(self.M), flat(self.q), list(self.role)
        p.common[:] = [int(c) for c in self.common]
        p.shifted = bool(self.shift.any())
        p.shift[:], p.limit[:], p.slope[:] = flat(self.shift), flat(self.limit), flat(self.slope)
        return p

    def off(self, l: Array) -> Array:
        """Return by how much each law fails, all in units of the largest term."""
        w = self.M @ l + self.q
        most = self.limit + self.slope @ l
        size = 1.0 + np.abs(l).max() + (np.abs(self.M) @ np.abs(l) + np.abs(self.q)).max()
        bad = np.zeros(len(l))
        for k, role in enumerate(self.role):
            # l is the common variable, or minus the net one
            net = -w[k] if self.common[k] else -l[k]
            speed = l[k] if self.common[k] else w[k]
            if role == ONE_SIDED:
                open_ = w[k] + self.shift[k]
                bad[k] = max(-l[k], -open_, min(abs(l[k]), abs(open_)))
            elif role == TWO_SIDED:
                # what slides is braked by all there is; what rests, by no more than that
                slides = net - most[k] if speed > 0.0 else -net - most[k]
                rests = max(abs(speed), abs(net) - most[k])
                bad[k] = min(max(abs(slides), 0.0), rests)
            elif role == CUT:
                bad[k] = abs(l[k])
            elif role == SHUT:
                bad[k] = abs(w[k])
            else:
                # `l` is minus the net variable here, whatever is common
                bad[k] = abs(-l[k] - (most[k] if role == FORWARD else -most[k]))
        return bad / size

    def every_answer(self) -> list[Array]:
        """Return all answers at regular choices of branches, by brute force."""
        n = len(self.q)
        found = []
        ways = {ONE_SIDED: (0, 1), TWO_SIDED: (-1, 0, 1)}
        for choice in itertools.product(*(ways.get(r, (0,)) for r in self.role)):
            rows, right = np.zeros((n, n)), np.zeros(n)
            unit = np.eye(n)
            for k, (role, way) in enumerate(zip(self.role, choice)):
                net = -self.M[k] if self.common[k] else -unit[k]
                net_0 = -self.q[k] if self.common[k] else 0.0
                if role == ONE_SIDED:
                    rows[k] = self.M[k] if way else unit[k]
                    right[k] = -self.q[k] - self.shift[k] if way else 0.0
                elif role == TWO_SIDED and way == 0:
                    rows[k] = unit[k] if self.common[k] else self.M[k]
                    right[k] = 0.0 if self.common[k] else -self.q[k]
                elif role == TWO_SIDED:
                    rows[k] = net - way * self.slope[k]
                    right[k] = way * self.limit[k] - net_0
                elif role == CUT:
                    rows[k] = unit[k]
                elif role == SHUT:
                    rows[k], right[k] = self.M[k], -self.q[k]
                else:
                    way = 1 if role == FORWARD else -1
                    rows[k] = -unit[k] - way * self.slope[k]
                    right[k] = way * self.limit[k]
            if np.linalg.matrix_rank(rows, tol=1e-9) < n:
                continue
            l = np.linalg.solve(rows, right)
            if self.off(l).max() < CLOSE:
                found.append(l)
        return found


def problems(count: int, roles: int):
    """Yield problems of ports in the first of these roles."""
    generator = np.random.default_rng(roles)
    for k in range(count):
        n = int(generator.integers(1, 6))
        b = generator.integers(-2, 3, size=(n, int(generator.integers(1, n + 1)))).astype(float)
        M = b @ b.T
        if k % 2:
            skew = generator.integers(-1, 2, size=(n, n))
            M = M + skew - skew.T
        q = generator.integers(-2, 3, size=n) * 10.0 ** generator.integers(-4, 2, size=n)
        role = [ROLES[i] for i in generator.integers(0, roles, size=n)]
        common = [bool(a) for a in generator.integers(0, 2, size=n)]
        shift = (generator.normal(size=n) if k % 3 == 0 else 0.0) * np.equal(role, ONE_SIDED)
        rubs = np.isin(role, (TWO_SIDED, FORWARD, BACKWARD))
        limit = np.where(rubs, generator.uniform(0.0, 2.0, n), 0.0)
        slope = generator.normal(size=(n, n)) * (0.1 if k % 5 == 0 else 0.0) * rubs[:, None]
        start = generator.integers(-1 if roles > 1 else 0, 2, size=n)
        yield Laws(M, q, role, common, shift, limit, slope), [int(a) for a in start]


@pytest.mark.parametrize("roles", [1, 2, 3, 4, 6])
def test_what_laws_do_is_what_they_say_and_found_where_there_is_any(roles: int) -> None:
    solved = unsolved = 0
    for laws, start in problems(100, roles):
        p = laws.posed()
        answers = laws.every_answer()
        if not solve_laws(p, start):
            # a limit that follows a force makes a matrix that no path is sure to get through
            assert not answers or laws.slope.any()
            unsolved += 1
            continue
        solved += 1
        l = np.array(p.l)
        assert laws.off(l).max() < CLOSE
        if answers and np.linalg.matrix_rank(laws.M, tol=1e-9) == len(l):
            assert any(np.abs(l - a).max() < 1e-7 * (1 + np.abs(a).max()) for a in answers)
    assert solved > 30
    assert unsolved > 0


def test_switches_that_leave_a_part_afloat_share_by_least_voltage() -> None:
    """A bridge without a gate: its four currents are zero, one voltage is not decided."""
    M = np.array([[0.0, 1, 0, 0], [-1, 0.1, 0.1, 0], [0, 0.1, 0.1, -1], [0, 0, 1, 0]])
    none, pairs = np.zeros(4), np.zeros((4, 4))
    roles, common = [CUT, SHUT, SHUT, CUT], [True, False, False, True]
    p = Laws(M, np.array([-3.0, 0.0, 0.0, -3.0]), roles, common, none, none, pairs).posed()
    assert solve_laws(p, [0, 0, 0, 0])
    assert p.l == pytest.approx(np.zeros(4), abs=1e-15)
    # driven against each other they have no answer, and none is made up
    driven = Laws(M, np.array([0.0, 1.0, -1.0, 0.0]), roles, common, none, none, pairs)
    assert not solve_laws(driven.posed(), [0, 0, 0, 0])


def rubbing(M: Array, q: Array, limit: Array) -> Array:
    """Return the forces of friction on bodies, `l`, that move by ``M l + q``."""
    n = len(q)
    laws = Laws(M, q, [TWO_SIDED] * n, [False] * n, np.zeros(n), limit, np.zeros((n, n)))
    p = laws.posed()
    assert solve_laws(p, [0] * n)
    return np.array(p.l)


@pytest.mark.parametrize("seed", range(12))
def test_friction_on_all_bodies_is_bounded_least_squares(seed: int) -> None:
    """Moreau: the forces are the nearest to what would hold, within their limits."""
    rng = np.random.default_rng(seed)
    A, b, limit = rng.normal(size=(25, 8)), 2.0 * rng.normal(size=25), 0.3 * rng.random(8)
    meant = lsq_linear(A, b, (-limit, limit), method="bvls", tol=1e-14).x
    assert rubbing(A.T @ A, -A.T @ b, limit) == pytest.approx(meant, abs=1e-10)


@pytest.mark.parametrize(
    ("push", "force", "speed"), [(0.5, -0.5, 0.0), (3.0, -1.0, 2.0), (-3.0, 1.0, -2.0)]
)
def test_a_block_on_a_rough_table_sticks_or_slides(push: float, force: float, speed: float) -> None:
    found = rubbing(np.eye(1), np.array([push]), np.ones(1))
    assert (found[0], found[0] + push) == (force, speed)
