"""The laws of junctions, all at once, as one mixed linear complementarity problem.

Given ``w = M l + q`` (`equations.ports`), each port takes part in one of four ways:

==============  ===================================================================
``ONE_SIDED``   ``0 <= l  |  w + shift >= 0``, both zero or one of them
``TWO_SIDED``   the net variable in ``limit * Sgn(common variable)``: dry friction
``CUT``         ``l = 0``: OFF, where `l` is the common variable
``HELD``        ``w = 0``, `l` of either sign: OFF, where `w` is the common variable
``FORWARD``     friction that surely slides forward: ``net = limit``; `l` is the net variable
``BACKWARD``    the same, backward
==============  ===================================================================

The limit of friction may be affine in `l`, so that it follows a contact force of the same problem.
Source: V. Acary, B. Brogliato, *Numerical Methods for Nonsmooth Dynamical Systems*, Springer 2008,
chapters 10 and 12.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hybond.solvers.lcp import lemke, mixed, positive_semidefinite, second_solution

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Branches = NDArray[np.int8]
Mask = NDArray[np.bool_]

CLEAR = 1e-6
"""Part of the largest of its kind from which a value is positive beyond doubt."""
LEVELS = 4
"""Orders of magnitude at which pairs that are zero on both sides are looked at again."""
SETTLED = 1e-9
"""Part of its terms up to which what is held counts as zero."""
ONE_SIDED, TWO_SIDED, CUT, HELD = "one-sided", "two-sided", "cut", "held"
FORWARD, BACKWARD = "forward", "backward"


@dataclass(frozen=True, slots=True)
class Friction:
    """The limit of a friction law: ``value + slope @ l``.

    Parameters
    ----------
    value : float
    slope : array, shape (ports,)
    """

    value: float
    slope: Vector


@dataclass(frozen=True, slots=True)
class Answer:
    """What the laws do.

    Parameters
    ----------
    l : array, shape (ports,)
    branch : array of int, shape (ports,)
        0 OFF or at rest, 1 ON or forward, -1 backward.
    open : array of bool, shape (ports,)
        Both variables of a pair are zero: either branch fits.
    """

    l: Vector
    branch: Branches
    open: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Problem:
    """What all laws ask for, together.

    Parameters
    ----------
    M : array, shape (ports, ports)
    q : array, shape (ports,)
    roles : sequence of str
        How each port takes part.
    common : sequence of bool
        Whether `l` is the common variable of the port's junction (else minus the net variable).
    shift : array, shape (ports,), optional
        Added to `w` in the conditions of one-sided ports: restitution times the velocity before.
    friction : dict
        The limit of each two-sided port.
    """

    M: Matrix
    q: Vector
    roles: Sequence[str]
    common: Sequence[bool]
    shift: Vector | None = None
    friction: Mapping[int, Friction] = field(default_factory=dict)

    @property
    def moved(self) -> Vector:
        """What `w` of one-sided ports is without `l`, restitution included."""
        return self.q if self.shift is None else self.q + self.shift

    def within(self, roles: Mapping[int, str], friction: Mapping[int, Friction]) -> Problem:
        """Return the problem with some ports in other roles or under other limits."""
        return replace(
            self,
            roles=[roles.get(k, role) for k, role in enumerate(self.roles)],
            friction={**self.friction, **friction},
        )


def ambiguous(problem: Problem, answer: Answer, *, tol: float = 1e-6) -> list[int]:
    """Return the ports whose `w` differs in another solution; finding none proves nothing.

    Examples
    --------
    >>> import numpy as np
    >>> bistable = Problem(np.array([[-1.0]]), np.array([1.0]), [ONE_SIDED], [True])
    >>> ambiguous(bistable, solve_laws(bistable))
    [0]
    """
    M, q, roles = problem.M, problem.q, problem.roles
    w = M @ answer.l + q
    size = np.abs(M) @ np.abs(answer.l) + np.abs(q)
    if all(r in (ONE_SIDED, CUT) for r in roles):
        who = np.array([k for k, r in enumerate(roles) if r == ONE_SIDED], dtype=np.intp)
        own, moved = M[np.ix_(who, who)], problem.moved[who]
        if not len(who) or positive_semidefinite(own):
            return []
        second = second_solution(own, moved, lemke(own, moved))
        if second is None:
            return []
        other = np.zeros(len(q))
        other[who] = second.z
        found = [other]
    else:
        on = np.ones(len(q), dtype=np.int8)
        tries = [solve_laws(problem, start=s) for s in (on, -on, 0 * on)]
        found = [a.l for a in tries if a is not None]
    scale = tol * max(float(size.max(initial=0.0)), float(np.finfo(float).tiny))
    apart = np.zeros(len(q), dtype=bool)
    for other in found:
        apart |= np.abs(M @ other + q - w) > scale
    return [int(k) for k in np.flatnonzero(apart)]


def solve_laws(problem: Problem, *, start: Branches | None = None) -> Answer | None:
    """Return what the laws of all ports do together, None if nothing was found.

    `start`, shape (ports,), is a guess of the branches.

    Examples
    --------
    A block pushed by 10 N: dry friction of 3 N brakes it, of 12 N it stays at rest.

    >>> import numpy as np
    >>> for limit in (3.0, 12.0):
    ...     friction = {0: Friction(limit, np.zeros(1))}
    ...     push = Problem(np.eye(1), np.array([10.0]), [TWO_SIDED], [False], friction=friction)
    ...     found = solve_laws(push)
    ...     print(found.l, found.branch)
    [-3.] [1]
    [-10.] [0]
    """
    M, q, roles, common = problem.M, problem.q, problem.roles, problem.common
    moved = problem.moved
    if not len(q):
        return Answer(np.zeros(0), np.zeros(0, dtype=np.int8), np.zeros(0, dtype=bool))
    if all(r in (ONE_SIDED, CUT) for r in roles):
        return _one_sided(M, moved, roles, common, start)
    if not {TWO_SIDED, FORWARD, BACKWARD}.intersection(roles):
        return _without_held(M, moved, roles, common, start)
    return _mixed(M, q, moved, roles, common, problem.friction, start)


def _one_sided(
    M: Matrix,
    q: Vector,
    roles: Sequence[str],
    common: Sequence[bool],
    start: Branches | None,
) -> Answer | None:
    n = len(q)
    who = np.array([k for k, r in enumerate(roles) if r == ONE_SIDED], dtype=np.intp)
    l, branch = np.zeros(n), np.zeros(n, dtype=np.int8)
    either = np.zeros(n, dtype=bool)
    if len(who):
        on_active = np.array([common[k] for k in who])
        guess = None if start is None else (start[who] == 1) == on_active
        own = M if len(who) == n else M[np.ix_(who, who)]
        if guess is not None and (z := _as_before(own, q[who], guess)) is not None:
            l[who], branch[who] = z, guess == on_active
            return Answer(l, branch, either)
        found = _by_levels(own, q[who], guess)
        if found is None:
            return None
        l[who], active, either[who] = found
        branch[who] = active == on_active
    return Answer(l, branch, either)


def _as_before(M: Matrix, q: Vector, active: Mask) -> Vector | None:
    """Return the solution with a known active set if it clearly is one, None if in doubt."""
    z = np.zeros(len(q))
    if active.any():
        try:
            z[active] = np.linalg.solve(M[np.ix_(active, active)], -q[active])
        except np.linalg.LinAlgError:
            return None
    w = M @ z + q
    size = float((np.abs(M) @ z + np.abs(q)).max(initial=0.0))
    clear = np.where(active, z > CLEAR * z.max(initial=0.0), w > CLEAR * size)
    return z if clear.all() else None


def _without_held(
    M: Matrix,
    q: Vector,
    roles: Sequence[str],
    common: Sequence[bool],
    start: Branches | None,
) -> Answer | None:
    """Put in the `l` that hold ``w = 0``, and solve for the others."""
    held = np.array([r == HELD for r in roles])
    free = ~held
    own = M[np.ix_(held, held)]
    scale = np.sqrt(np.maximum(np.abs(np.diag(own)), np.finfo(float).tiny))
    tied = np.linalg.matrix_rank(own / scale / scale[:, None], tol=SETTLED) < len(own)
    if tied:
        # what is held depends on the others, not on its own `l` alone
        mixed_up = _mixed(M, q, q, roles, common, {}, start)
        if mixed_up is not None:
            return mixed_up
        # or nothing decides some `l`, like voltages of switches that leave a part afloat
    fixed = np.column_stack([M[np.ix_(held, free)], q[held]])
    into = np.linalg.lstsq(M[np.ix_(held, held)], fixed, rcond=None)[0]
    through = M[np.ix_(free, held)]
    inner = M[np.ix_(free, free)] - through @ into[:, :-1]
    rest = q[free] - through @ into[:, -1]
    kept = [k for k, f in enumerate(free) if f]
    found = _one_sided(
        inner,
        rest,
        [roles[k] for k in kept],
        [common[k] for k in kept],
        None if start is None else start[kept],
    )
    if found is None:
        return None
    l, branch = np.zeros(len(q)), np.zeros(len(q), dtype=np.int8)
    either = np.zeros(len(q), dtype=bool)
    l[free], branch[free], either[free] = found.l, found.branch, found.open
    l[held] = -(into[:, :-1] @ found.l + into[:, -1])
    left = np.abs(M @ l + q)[held]
    if tied and (left > SETTLED * (np.abs(M) @ np.abs(l) + np.abs(q))[held]).any():
        return None
    return Answer(l, branch, either)


def _by_levels(m: Matrix, q: Vector, start: Mask | None) -> tuple[Vector, Mask, Mask] | None:
    """Solve ``0 <= l | q + m l >= 0`` level by level of magnitude.

    Pairs that are zero on both sides, measured by the largest of them, are decided by what is
    left of `q` once the others are: a current that passes through zero while others flow. Returns
    `l`, the active set and what stays open at every level, or None if there is no solution.
    """
    found = lemke(m, q, start=start)
    if found.status != "solved":
        return None
    active = np.array(found.active, dtype=bool)
    left = np.zeros(len(q), dtype=bool)
    left[list(found.degenerate)] = True
    for _ in range(LEVELS):
        if not left.any():
            break
        sure = active & ~left
        inner, rest = m[np.ix_(left, left)], q[left]
        if sure.any():
            through = m[np.ix_(left, sure)]
            fixed = np.column_stack([m[np.ix_(sure, left)], q[sure]])
            solved = through @ np.linalg.lstsq(m[np.ix_(sure, sure)], fixed, rcond=None)[0]
            inner, rest = inner - solved[:, :-1], rest - solved[:, -1]
        if not rest.any():
            break
        finer = lemke(
            inner, rest / np.abs(rest).max(), start=None if start is None else start[left]
        )
        if finer.status != "solved":
            break
        where = np.flatnonzero(left)
        active[where] = finer.active
        still = np.zeros(len(q), dtype=bool)
        still[where[list(finer.degenerate)]] = True
        if still.sum() == left.sum():
            break
        left = still
    return np.asarray(found.z), active, left


def _mixed(
    M: Matrix,
    q: Vector,
    moved: Vector,
    roles: Sequence[str],
    common: Sequence[bool],
    friction: Mapping[int, Friction],
    start: Branches | None,
) -> Answer | None:
    """Write the laws as rows ``A a + B b + C l = d`` with ``a, b >= 0`` and ``a b = 0``."""
    n = len(q)
    unit = np.eye(n)
    # pairs (port, way): way 1 or -1 of friction, 0 one-sided
    owner: list[tuple[int, int]] = []
    for k, role in enumerate(roles):
        if role == ONE_SIDED:
            owner.append((k, 0))
        elif role == TWO_SIDED:
            owner += [(k, 1), (k, -1)]
    place = {o: p for p, o in enumerate(owner)}
    rows = len(owner) + n
    A, B = np.zeros((rows, len(owner))), np.zeros((rows, len(owner)))
    C, d = np.zeros((rows, n)), np.zeros(rows)
    i = 0
    for k, role in enumerate(roles):
        if role == CUT:
            C[i] = unit[k]
            i += 1
        elif role == HELD:
            C[i], d[i] = M[k], -q[k]
            i += 1
        elif role in (FORWARD, BACKWARD):
            way = 1.0 if role == FORWARD else -1.0
            C[i], d[i] = unit[k] + way * friction[k].slope, -way * friction[k].value
            i += 1
        elif role == ONE_SIDED:
            p = place[k, 0]
            own = float(M[k, k])
            per = 1.0 / own if own > 0.0 else 1.0
            A[i, p], C[i] = 1.0, -unit[k]
            B[i + 1, p], C[i + 1], d[i + 1] = 1.0, -M[k] * per, moved[k] * per
            i += 2
        else:
            forth, back = place[k, 1], place[k, -1]
            limit = friction[k]
            if common[k]:
                speed, still, force, held = unit[k], 0.0, -M[k], -q[k]
            else:
                speed, still, force, held = M[k], q[k], -unit[k], 0.0
            # speeds are written as the forces that would make them: tolerances then agree
            own = float(M[k, k])
            per = 1.0 if own <= 0.0 else own if common[k] else 1.0 / own
            A[i, forth], A[i, back], C[i], d[i] = 1.0, -1.0, -speed * per, still * per
            B[i + 1, forth], C[i + 1], d[i + 1] = 1.0, force - limit.slope, limit.value - held
            B[i + 2, back], C[i + 2], d[i + 2] = 1.0, -force - limit.slope, limit.value + held
            i += 3
    guess = None
    if start is not None:
        guess = np.array(
            [start[k] == way if way else (start[k] == 1) == common[k] for k, way in owner],
            dtype=bool,
        )
    found = mixed(A, B, d, C=C, start=guess)
    if found.status != "solved":
        return None
    branch, either = np.zeros(n, dtype=np.int8), np.zeros(n, dtype=bool)
    branch[[r == FORWARD for r in roles]], branch[[r == BACKWARD for r in roles]] = 1, -1
    for p, (k, way) in enumerate(owner):
        active = bool(found.active[p])
        if way == 0:
            branch[k] = active == common[k]
        elif active:
            branch[k] = way
        either[k] |= p in found.degenerate
    return Answer(np.asarray(found.free), branch, either)
