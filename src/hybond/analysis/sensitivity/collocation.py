"""Linear motion ``d' = A(t) d + B(t)`` over a step, by Radau's collocation with five stages.

    K_i = A_i (d + h sum_j a_ij K_j) + B_i       at t + c_i h: one linear system, nothing iterated
    d(t + h) = d + h sum_i b_i K_i

Order nine, L-stable, so that stiff modes need no small steps. The same matrices read from the right
are the adjoint of the step, exactly:

    M^T mu = h (b x l),   l(t) = l + sum_i A_i^T mu_i,   g = g + sum_i B_i^T mu_i

Source: Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
STAGES = 5


@cache
def radau() -> tuple[Vector, Vector, Vector]:
    """Return nodes c, matrix a and weights b.

    Examples
    --------
    >>> c, a, b = radau()
    >>> float(c[-1]), round(float(b.sum()), 12), bool(np.allclose(a @ c**3, c**4 / 4))
    (1.0, 1.0, True)
    """
    legendre = np.polynomial.legendre
    last = np.zeros(STAGES + 1)
    last[-1], last[-2] = 1.0, -1.0
    c = (np.sort(legendre.legroots(last).real) + 1.0) / 2.0
    c[-1] = 1.0
    powers = np.arange(1, STAGES + 1)
    a = (c[:, None] ** powers / powers) @ np.linalg.inv(c[:, None] ** (powers - 1))
    return c, a, a[-1]


@dataclass(frozen=True, slots=True)
class VariationStep:
    """A step of the variations.

    Parameters
    ----------
    t0, t1 : float
        s.
    A : array, shape (stages, n, n)
    B : array, shape (stages, n, parameters)
    """

    t0: float
    t1: float
    A: Vector
    B: Vector

    def _matrix(self) -> Vector:
        _, a, _ = radau()
        h, n = self.t1 - self.t0, self.A.shape[1]
        left = -h * np.einsum("ij,ikl->ikjl", a, self.A)
        return np.asarray(left.reshape(STAGES * n, STAGES * n) + np.eye(STAGES * n))

    def forward(self, d: Vector) -> Vector:
        """Return the variations at the end, shape (n, parameters)."""
        _, _, b = radau()
        right = self.A @ d + self.B
        k = np.linalg.solve(self._matrix(), right.reshape(STAGES * d.shape[0], d.shape[1]))
        moved = np.tensordot(b, k.reshape(STAGES, *d.shape), axes=1)
        return np.asarray(d + (self.t1 - self.t0) * moved)

    def backward(self, adjoint: Vector) -> tuple[Vector, Vector]:
        """Return the adjoint at the beginning, and what parameters add."""
        _, _, b = radau()
        h = self.t1 - self.t0
        mu = np.linalg.solve(self._matrix().T, h * np.kron(b, adjoint))
        mu = mu.reshape(STAGES, len(adjoint))
        before = adjoint + np.einsum("ikl,ik->l", self.A, mu)
        return before, np.einsum("ikp,ik->p", self.B, mu)


@dataclass(frozen=True, slots=True)
class Jump:
    """What a switch makes of the variations: the saltation matrix, and what parameters add.

    Parameters
    ----------
    t : float
        s.
    S : array, shape (n, n)
    P : array, shape (n, parameters)
    time : array, shape (n,)
    time_by : array, shape (parameters,)
        ``d tau = time @ d + time_by @ dp`` with the variations before the switch.
    """

    t: float
    S: Vector
    P: Vector
    time: Vector
    time_by: Vector

    def forward(self, d: Vector) -> Vector:
        """Return the variations after the switch."""
        return np.asarray(self.S @ d + self.P)

    def moved(self, d: Vector) -> Vector:
        """Return the derivatives of the instant."""
        return np.asarray(self.time @ d + self.time_by)

    def backward(self, adjoint: Vector) -> tuple[Vector, Vector]:
        """Return the adjoint before, and what parameters add."""
        return self.S.T @ adjoint, self.P.T @ adjoint
