"""Motion of modes that are linear with constant coefficients: no steps, the exponential itself.

Where the rates are affine in states and time, so are their slopes by parameters, along the motion:

    x' = A x + b0 + b1 t        d' = A d + C x + c0 + c1 t        C, c for each parameter

d and x together are one linear motion with a constant matrix, and a step of any length is

    d(t + h) = S d(t) + V y(t),   y = (x - x*, 1, t - t*)         [S V; 0 Y] = exp of h times it

with x(t) the state of the run. C and c are differences of slopes at points apart: exact, as they
are affine there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.exponential import MIXED, grown, split
from hybond.analysis.sensitivity.fields import Field, Fields, ModeField
from hybond.analysis.sensitivity.tangent import At
from hybond.model.expressions.slots import PREFIX
from hybond.runs.trace import Segment

Vector = NDArray[np.float64]

AT_ONCE = 200_000
"""Entries of matrices that are raised together."""


@dataclass(frozen=True, slots=True)
class MatrixStep:
    """A step of the variations that is a matrix.

    Parameters
    ----------
    t0, t1 : float
        s.
    S : array, shape (n, n)
    P : array, shape (n, parameters)
    """

    t0: float
    t1: float
    S: Vector
    P: Vector

    def forward(self, d: Vector) -> Vector:
        """Return the variations at the end, shape (n, parameters)."""
        moved = self.S @ d
        # columns before those of parameters are variations of the start alone
        moved[:, d.shape[1] - self.P.shape[1] :] += self.P
        return np.asarray(moved)

    def backward(self, adjoint: Vector) -> tuple[Vector, Vector]:
        """Return the adjoint at the beginning, and what parameters add."""
        return self.S.T @ adjoint, self.P.T @ adjoint


def flows(fields: Fields, segment: Segment, mesh: Vector, field: Field) -> list[MatrixStep] | None:
    """Return the steps between points of a segment; None where its mode is not linear.

    Parameters
    ----------
    mesh : array, shape (points,)
    field : Field
        At these points.
    """
    if segment.sliding is not None or len(mesh) < 2 or not fields.columns.states:
        return None
    mode = fields.mode(segment.mode, field.at)
    if not mode.affine:
        return None
    n, size = fields.columns.time, fields.size
    states = np.array(
        [np.broadcast_to(field.at.values[s], mesh.shape) for s in fields.columns.states]
    )
    if mode.timeless and mode.by_states is not None:
        made = _Linear.again(field, n, *mode.by_states)
    else:
        apart = mode.field(_apart(fields, segment, mesh, field, states))
        made = _Linear.of(fields, apart, mesh, states)
        mode.by_states = made.A, made.C[:, :, :n]
    h = np.diff(mesh)
    basis = _basis(fields, mode, made.A[:n, :n], h)
    if basis is None:
        return None
    T, back, blocks = basis
    whole, unit, share = made.in_blocks(T, back, blocks, float(h.max()))
    y = np.ones((len(mesh) - 1, n + 2))
    y[:, :n], y[:, n + 1] = (states[:, :-1] - states[:, :1]).T @ back.T, mesh[:-1] - mesh[0]
    y /= unit
    T, back = _with_rest(T, size), _with_rest(back, size)
    found: list[MatrixStep] = []
    for first in range(0, len(h), max(1, AT_ONCE // whole.size)):
        part = h[first : first + max(1, AT_ONCE // whole.size)]
        E = grown((whole * part[:, None, None, None]).reshape(-1, *whole.shape[1:]))
        E = E.reshape(len(part), *whole.shape)
        S = T @ (E[:, 0, :size, :size] + np.eye(size)) @ back
        P = T @ np.einsum(
            "kpij,kj,p->kip", E[:, :, :size, size:], y[first : first + len(part)], share
        )
        ends = zip(mesh[first:].tolist(), mesh[first + 1 :].tolist(), S, P)
        found += [MatrixStep(*of) for of in ends]
    return found


def _apart(fields: Fields, segment: Segment, mesh: Vector, field: Field, states: Vector) -> At:
    """Return values at the first point, and apart from it by each state and by time."""
    n = fields.columns.time
    by = np.zeros((n + 2, n + 1))
    by[1:, :] = np.diag(_steps(mesh, states))
    values: dict[str, Vector | float] = {}
    for name, value in field.at.values.items():
        own = name.startswith(PREFIX)
        values[name] = value if own else np.full(n + 2, np.ravel(value)[0])
    for k, name in enumerate(fields.columns.states):
        values[name] = values[name] + by[:, k]
    for name, row in zip(field.tangent.rows.bonds, field.bonds[0]):
        values[name] = values[name] + by @ row[: n + 1]
    values["time"] = values["time"] + by[:, n]
    for k in range(fields.columns.inputs):
        values[f"u:{k}"] = values[f"u:{k}"] + by[:, n] * values[f"du:{k}"]
    begin = float(segment.t[0])
    return At(values, fields.values.inputs_of(mesh[0] + by[:, n], begin), n + 2)


def _steps(mesh: Vector, states: Vector) -> Vector:
    """Return how far apart points are: by each state, and by time."""
    sizes = np.abs(states).max(axis=1, initial=0.0)
    return np.append(np.where(sizes > 0.0, sizes, 1.0), mesh[-1] - mesh[0])


@dataclass(frozen=True, slots=True)
class _Linear:
    """The constant matrices of a linear motion and of its variations.

    Parameters
    ----------
    A : array, shape (size, size)
    C : array, shape (parameters, size, n + 2)
        By ``y = (x - x*, 1, t - t*)``.
    b : array, shape (n, 2)
        The rates of x by the last two of y.
    """

    A: Vector
    C: Vector
    b: Vector

    @staticmethod
    def of(fields: Fields, apart: Field, mesh: Vector, states: Vector) -> _Linear:
        """Return them from slopes at points apart."""
        n, size = fields.columns.time, fields.size
        slopes = np.broadcast_to(apart.slopes, (n + 2, *apart.slopes.shape[1:]))
        A = np.zeros((size, size))
        A[:, :n] = slopes[0, :, :n]
        by = slopes[:, :, n + 1 :].transpose(2, 1, 0)
        changes = (by[:, :, 1:] - by[:, :, :1]) / _steps(mesh, states)
        C = np.concatenate([changes[:, :, :n], by[:, :, :1], changes[:, :, n:]], axis=2)
        return _Linear(A, C, np.stack([apart.f[0, :n], slopes[0, :n, n]], axis=1))

    @staticmethod
    def again(field: Field, n: int, A: Vector, by_states: Vector) -> _Linear:
        """Return them where nothing moves with time, and what changes with states is known."""
        here = field.slopes[0, :, n + 1 :].T[:, :, None]
        C = np.concatenate([by_states, here, np.zeros_like(here)], axis=2)
        return _Linear(A, C, np.stack([field.f[0, :n], np.zeros(n)], axis=1))

    def in_blocks(
        self, T: Vector, back: Vector, blocks: Vector, longest: float
    ) -> tuple[Vector, Vector, Vector]:
        """Return the matrices of variations and y together, in a basis of the states.

        Returns
        -------
        whole : array, shape (parameters or 1, size + n + 2, size + n + 2)
        unit : array, shape (n + 2,)
            Of each y in its basis.
        share : array, shape (parameters or 1,)
            What the variations by each parameter are to be multiplied by.
        """
        n, size, many = len(T), len(self.A), len(self.C)
        norm = max(float(np.abs(blocks).sum(axis=0).max(initial=0.0)), 1.0 / longest)
        b = back @ self.b
        one, ramp = np.abs(b).sum(axis=0)
        unit = np.ones(n + 2)
        unit[n] = 1.0 / max(1.0, one / norm, ramp / norm**2)
        unit[n + 1] = unit[n] / norm
        whole = np.zeros((max(many, 1), size + n + 2, size + n + 2))
        whole[:, :n, :n] = whole[:, size:-2, size:-2] = blocks
        whole[:, n:size, :n] = self.A[n:, :n] @ T
        whole[:, size:-2, -2:] = b * unit[n:]
        whole[:, -1, -2] = norm
        share = np.ones(len(whole))
        for j in range(many):
            C = np.concatenate([self.C[j, :, :n] @ T, self.C[j, :, n:]], axis=1) * unit
            C[:n] = back @ C[:n]
            largest = float(np.abs(C).sum(axis=0).max(initial=0.0))
            share[j] = largest / norm if largest > 0.0 else 1.0
            whole[j, :size, size:] = C / share[j]
        return whole, unit, share


def _basis(
    fields: Fields, mode: ModeField, A: Vector, h: Vector
) -> tuple[Vector, Vector, Vector] | None:
    """Return a basis of the states in which steps are exact to rounding, None if there is none."""
    if mode.basis is None:
        mode.basis = split(A, fields.values.run.t_end)
    T, back, blocks, apart = mode.basis
    norm = float(np.abs(blocks).sum(axis=0).max(initial=0.0))
    return (T, back, blocks) if apart or norm * float(h.max()) <= MIXED else None


def _with_rest(T: Vector, size: int) -> Vector:
    found = np.eye(size)
    found[: len(T), : len(T)] = T
    return found
