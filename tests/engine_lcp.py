"""Complementarity problems of the engine on numbers, as Python runs it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.engine.complementarity.all_branches import answer_laws
from hybond.engine.complementarity.friction_disk import make_disk
from hybond.engine.complementarity.friction_disk import on_disk as find_on_disk
from hybond.engine.complementarity.law_roles import ONE_SIDED, make_law_problem
from hybond.engine.complementarity.lcp import NO_CHOICE, ON_A_RAY, SOLVED, make_lcp
from hybond.engine.complementarity.lcp_forms import make_mixed, solve_mixed
from hybond.engine.complementarity.lemke import lemke as solve_lcp
from hybond.engine.complementarity.lemke import ray_proves
from hybond.engine.complementarity.semidefinite import is_indefinite

Array = NDArray[np.float64]
STATUS = {SOLVED: "solved", ON_A_RAY: "ray", NO_CHOICE: "singular"}


@dataclass(frozen=True)
class Found:
    """How a problem ended: `z`, `w` and `free` of a mixed one are a, b and c."""

    status: str
    z: Array
    w: Array
    active: NDArray[np.bool_]
    degenerate: tuple[int, ...]
    pivots: int
    infeasible: bool
    ray: Array
    free: Array


def flat(a: ArrayLike) -> list[float]:
    """Return numbers row by row."""
    return [float(x) for x in np.asarray(a, dtype=float).ravel()]


def guess(start: ArrayLike | None, n: int) -> list[int]:
    """Return which pairs are guessed active, of a mask or of places."""
    if start is None:
        return [0] * n
    given = np.asarray(start)
    if given.dtype == bool:
        return [int(a) for a in given]
    return [int(k in given.tolist()) for k in range(n)]


def found_in(status: int, p, z, w, free=(), active=None, infeasible: bool = False) -> Found:
    n = len(z)
    on = np.array(p.active[:n] if active is None else active[:n], dtype=bool)
    ray = np.full(n, np.nan)
    if infeasible:
        ray = np.array(p.d[:n]) * np.array(p.right[:n])
    return Found(
        STATUS[status],
        np.array(z),
        np.array(w),
        on,
        tuple(np.flatnonzero(p.open[:n]).tolist()),
        p.pivots,
        infeasible,
        ray,
        np.array(free),
    )


def lemke(M: ArrayLike, q: ArrayLike, *, start: ArrayLike | None = None) -> Found:
    """Solve ``z >= 0, w = M z + q >= 0, z w = 0``."""
    n = len(np.asarray(q))
    p = make_lcp(n)
    status = solve_lcp(p, n, flat(M), flat(q), guess(start, n))
    proved = status == ON_A_RAY and ray_proves(p, n)
    return found_in(status, p, p.z, p.w, infeasible=proved)


def mixed(
    A: ArrayLike,
    B: ArrayLike,
    q: ArrayLike,
    *,
    C: ArrayLike | None = None,
    start: ArrayLike | None = None,
) -> Found:
    """Solve ``A a + B b + C c = q`` with ``a, b >= 0, a b = 0``."""
    n = np.shape(A)[1]
    free = np.zeros((len(np.asarray(q)), 0)) if C is None else np.asarray(C)
    m = free.shape[1]
    x = make_mixed(n, m)
    x.whole[:] = flat(np.hstack([A, B, free]))
    x.right[:] = flat(q)
    status = solve_mixed(x, n, m, guess(start, n), start is not None)
    proved = status == ON_A_RAY and ray_proves(x.lcp, n)
    return found_in(status, x.lcp, x.a, x.b, x.c, x.active, proved)


def answers_by_engine(M: ArrayLike, q: ArrayLike) -> tuple[int, bool]:
    """Return how many answers with different `w` one-sided laws have, and whether 0 is proved."""
    n = len(np.asarray(q))
    p = make_law_problem(n)
    p.n = n
    p.m[:], p.q[:] = flat(M), flat(q)
    p.role[:] = [ONE_SIDED] * n
    found = answer_laws(p, [0] * n)
    return (p.answers, False) if found else (0, p.proved)


def positive_semidefinite(M: ArrayLike) -> bool:
    """Whether a matrix is, to rounding."""
    n = len(np.asarray(M))
    return not is_indefinite(n, flat(M), [0.0] * n, [0.0] * n, [0.0] * (n * n))


def violation(M: ArrayLike, q: ArrayLike, z: ArrayLike) -> float:
    """Return by how much z fails, each w in units of its terms."""
    M, q, z = (np.asarray(a, dtype=float) for a in (M, q, z))
    w, terms = M @ z + q, np.abs(M) @ np.abs(z) + np.abs(q)
    w = np.divide(w, terms, out=np.zeros_like(w), where=terms > 0.0)
    return float(max((-w).max(), np.abs(w[z > 0.0]).max(initial=0.0), (-z).max()))


def on_disk(f0: ArrayLike, A: ArrayLike, limit: float, slope: ArrayLike = (0, 0)) -> Array | None:
    """Return the direction of slip, None if there is none."""
    d = make_disk()
    d.f0[:], d.a[:], d.slope[:], d.limit = flat(f0), flat(A), flat(slope), limit
    return np.array([d.x, d.y]) if find_on_disk(d) else None


def is_among(point: Array, points: Iterable[Array], tol: float = 1e-8) -> bool:
    """Whether a point is one of some, but for rounding."""
    return any(np.abs(point - other).max() <= tol * (1.0 + np.abs(other).max()) for other in points)


def p_matrix(rng: np.random.Generator, n: int) -> Array:
    """Strict row dominance with a positive diagonal: every principal minor is positive."""
    M = rng.normal(size=(n, n))
    np.fill_diagonal(M, np.abs(M).sum(axis=1) + 0.1)
    return M


def hybrid_matrix(rng: np.random.Generator, n: int) -> Array:
    """A resistive network with some ports driven by efforts, others by flows; may be singular."""
    G = rng.integers(-2, 3, (n, rng.integers(0, n + 1)))
    K = rng.integers(-2, 3, (n, n))
    return (G @ G.T + K - K.T).astype(float)
