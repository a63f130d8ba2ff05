"""Impacts that accumulate: derivatives behind their limit.

Impacts come at t_0, t_1, t_2, whose derivatives are known. Their intervals shrink geometrically, so
that the limit is the one that the run extrapolates, and so is its derivative:

    T = t_2 + D^2/(C - D),   C = t_1 - t_0,   D = t_2 - t_1,   r = D/C
    dT = dt_2 + (2 r - r^2)/(1 - r)^2 (dt_2 - dt_1) - r^2/(1 - r)^2 (dt_1 - dt_0)

The state has come there with the last impact, at t_n, and is put on the constraint that holds
behind it (`entry`); from t_n on it moves, in the mean, as at rest, to first order in T - t_n:

    d_n = rest(d + f dt_n) - f_n dt_n        f: in flight behind the last impact
    d+  = d_n + (T - t_n) (A d_n + B),       f_n = f+ - (T - t_n) (A f+ + f_t),  A, B, f+: at rest

and what is left of the gap is none (`gaps`).

Source of the extrapolation: Aitken, Proceedings of the Royal Society of Edinburgh 46, 1926.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.collocation import Jump
from hybond.analysis.sensitivity.entry import Before, entered
from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.gaps import closing, has_gap
from hybond.analysis.sensitivity.tangent import Undetermined
from hybond.runs.trace import Event

Vector = NDArray[np.float64]

SETTLED = 1e-6
"""Part by which the limits of three impacts and of the three before may differ."""
NOTHING = 1e-3
"""What moves a limit by less than this part of it, by all of a parameter, is compared to that."""


@dataclass(frozen=True, slots=True)
class Landing:
    """What the limit of impacts makes of the variations.

    Parameters
    ----------
    t : float
        s.
    S : array, shape (n, n)
    P : array, shape (n, parameters)
    by_last : array, shape (n,)
        By how the last impact moved.
    last : tuple of int and Jump
        The last impact, and where in the chain it is.
    impacts : tuple
        Three impacts that tell the limit, likewise.
    weights : array, shape (3,)
        Of how these moved, in how the limit does.
    """

    t: float
    S: Vector
    P: Vector
    by_last: Vector
    last: tuple[int, Jump]
    impacts: tuple[tuple[int, Jump], ...]
    weights: Vector

    def after(self, found: Sequence[Vector]) -> Vector:
        """Return the variations behind the limit, from all before each link."""
        d = found[-1]
        place, impact = self.last
        moved = self.S @ d + np.outer(self.by_last, impact.moved(found[place]))
        moved[:, d.shape[1] - self.P.shape[1] :] += self.P
        return np.asarray(moved)

    def moved(self, found: Sequence[Vector]) -> Vector:
        """Return the derivatives of the limit."""
        return np.asarray(self.weights @ np.array([j.moved(found[p]) for p, j in self.impacts]))

    def rows(self) -> tuple[dict[int, Vector], Vector]:
        """Return the same as rows at places of the chain, and what parameters add."""
        pairs = list(zip(self.weights.tolist(), self.impacts, strict=True))
        direct = np.array([w * j.time_by for w, (_, j) in pairs]).sum(axis=0)
        return {p: w * j.time for w, (p, j) in pairs}, direct

    def backward(self, adjoint: Vector) -> tuple[Vector, Vector, tuple[int, Vector]]:
        """Return the adjoint before, what parameters add, and a row at the last impact."""
        (place, last), by = self.last, float(self.by_last @ adjoint)
        before = self.S.T @ adjoint
        return before, self.P.T @ adjoint + by * last.time_by, (place, by * last.time)


def landed(
    fields: Fields,
    event: Event,
    flight: Field,
    rest: Field,
    impacts: Sequence[tuple[int, Jump]],
    found: Sequence[Vector],
    machine: str,
) -> Landing:
    """Return what the limit of impacts makes of the variations.

    Parameters
    ----------
    flight, rest : Field
        Behind the last impact, and behind the landing.
    impacts : sequence of (int, Jump)
        Of the machine that lands, with their places in the chain.
    found : sequence of array
        The variations before each link.
    machine : str
        What lands.

    Raises
    ------
    Undetermined
        Where the impacts do not tell the limit.
    """
    n, size = fields.columns.time, fields.size
    many = len(fields.columns.parameters)
    own_size = np.abs(fields.values.found.values)
    unit = NOTHING * event.t / np.where(own_size > 0.0, own_size, 1.0)
    some, weights = _clearest(impacts, found, unit)
    # columns: variations behind the last impact, parameters, and how that impact moved
    basis = size + many + 1
    moved = np.zeros((size, basis))
    moved[:, :size] = np.eye(size)
    moved[:, -1] = flight.f[0]
    instant = np.zeros(basis)
    instant[-1] = 1.0
    p = np.eye(many, basis, size)
    # what is read a priori is at its limit, and stays there
    before = Before(moved[:n], instant, p, flight, np.zeros((n, basis)))
    own = {name: float(np.ravel(v)[0]) for name, v in flight.at.values.items()}
    at = fields.values.with_prior(rest.at, dict.fromkeys(own, 0.0))
    moved[:n] = entered(rest.tangent, at, event.steps[-1].areas, before)
    entry = moved[:n, :n].copy()
    left = event.t - impacts[-1][1].t
    A = np.zeros((size, size))
    A[:, :n], by_time = rest.slopes[0, :, :n], rest.slopes[0, :, n]
    moved[:, -1] -= rest.f[0] - left * (A @ rest.f[0] + by_time)
    moved += left * (A @ moved)
    moved[:, size:-1] += left * rest.slopes[0, :, n + 1 :]
    lands = [k for k, m in enumerate(fields.graph.machines) if m.path == machine]
    less = closing(fields, lands, flight, entry) if has_gap(fields, lands[0]) else None
    if less is not None:
        gap = less[:, :n] @ moved[:n]
        gap[:, size:-1] += less[:, n:]
        moved[:n] -= gap
        # nor does anything move on the contact, beyond the first order
        again = Before(moved[:n], np.zeros(basis), p, rest, moved[:n])
        moved[:n] = entered(rest.tangent, at, {}, again)
    return Landing(
        event.t,
        moved[:, :size],
        moved[:, size:-1],
        moved[:, -1],
        impacts[-1],
        tuple(some),
        weights,
    )


def _clearest(
    impacts: Sequence[tuple[int, Jump]], found: Sequence[Vector], unit: Vector
) -> tuple[Sequence[tuple[int, Jump]], Vector]:
    """Return three impacts whose limit differs least from that of the three before, with weights.

    The first are not yet alike, and between the last ones rounding counts.
    """
    best, place = np.inf, 0
    made: list[Vector] = []
    with np.errstate(all="ignore"):
        for k in range(len(impacts) - 2):
            three = impacts[k : k + 3]
            moves = np.array([j.moved(found[p]) for p, j in three])
            made.append(_limit([j.t for _, j in three]) @ moves)
            if k:
                more = moves.shape[1] - len(unit)
                least = np.concatenate([np.full(more, NOTHING), unit])
                off = np.abs(made[k] - made[k - 1]) / (np.abs(moves).max(axis=0) + least)
                if off.max(initial=0.0) < best:
                    best, place = float(off.max(initial=0.0)), k
    if not best <= SETTLED:
        raise Undetermined("impacts accumulated, and do not tell how their limit moves")
    three = impacts[place : place + 3]
    return three, _limit([j.t for _, j in three])


def _limit(t: Sequence[float]) -> Vector:
    """Return the weights of three instants in how their limit moves.

    Examples
    --------
    >>> _limit([0.0, 1.0, 1.5]).tolist()
    [1.0, -4.0, 4.0]
    """
    r = (t[2] - t[1]) / (t[1] - t[0])
    a, b = (2.0 * r - r * r) / (1.0 - r) ** 2, -r * r / (1.0 - r) ** 2
    return np.array([-b, b - a, 1.0 + a])
