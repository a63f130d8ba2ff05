"""Orbits along a parameter: pseudo-arclength steps from one to the next.

The unknowns are z = (x / sizes, T / T0 where it is the orbit's own, p / span). An orbit satisfies
F(z) = 0, one equation less than unknowns: a curve, which may turn back in p. From a point the next
one is predicted along the tangent of the curve, and corrected on the plane that stands on it:

    F_z t = 0, |t| = 1;    z = z0 + s t + ...,    t . (z - z0) = s

Source: Keller, Numerical solution of bifurcation and nonlinear eigenvalue problems, in Rabinowitz
(ed.), Applications of Bifurcation Theory, 1977.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.periodic.multipliers import Multiplier, is_neutral, is_stable
from hybond.analysis.periodic.newton import FREE, conserved
from hybond.analysis.periodic.periods import Period, followed_by, length_now
from hybond.analysis.periodic.shots import Shot, Shots, calm
from hybond.errors import HybondError
from hybond.model.graph import Mode
from hybond.result import Result

Vector = NDArray[np.float64]

ITERATIONS = 10
"""Of a correction."""
NEARER = 0.7
"""Part to which the third correction and later ones must bring what is off, or they are given
up."""


@dataclass(frozen=True, slots=True, eq=False)
class OrbitPoint:
    """An orbit on a branch.

    Parameters
    ----------
    value : float
        Of the parameter, SI.
    period : float
        s.
    state : mapping
        Of each state at the beginning, SI: when what drives the motion begins anew.
    mode : mapping
        Of each machine there.
    multipliers : tuple of Multiplier
    run : Result
        One period.
    """

    value: float
    period: float
    state: dict[str, float]
    mode: dict[str, str]
    multipliers: tuple[Multiplier, ...]
    run: Result = field(repr=False)

    @property
    def stable(self) -> bool:
        """Whether motions near it come to it."""
        return is_stable(self.multipliers)

    @property
    def neutral(self) -> bool:
        """Whether motions near it neither come to it nor leave it."""
        return is_neutral(self.multipliers)


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """A point of the curve, with what the next step needs.

    Parameters
    ----------
    z : array
    tangent : array
    mode : Mode
    shot : Shot
    found : tuple of Multiplier
    """

    z: Vector
    tangent: Vector
    mode: Mode
    shot: Shot
    found: tuple[Multiplier, ...]
    iterations: int

    @property
    def path(self) -> tuple[object, ...]:
        """The switches of the period, wherever it begins."""
        return _turned(self.shot.path)


def _turned(path: tuple[tuple[str, tuple[Mode, ...]], ...]) -> tuple[object, ...]:
    """Return the one of all turns of a cycle that is first in order."""
    turns = [path[k:] + path[:k] for k in range(len(path))] or [path]
    return min(turns)


class Arc:
    """The curve of orbits of a model along one parameter.

    Parameters
    ----------
    shots : Shots
        With the parameter as the only thing that is varied.
    period : Period
    x : array, shape (n,)
        A state; what nothing reads stays as it is there.
    sizes : array, shape (n,)
    kept : list of int
    tol : float
    span : float
        What the parameter is measured by.
    """

    def __init__(
        self,
        shots: Shots,
        period: Period,
        x: Vector,
        sizes: Vector,
        kept: list[int],
        conserved: int,
        tol: float,
        span: float,
    ) -> None:
        self.shots, self.period = shots, period
        self.base, self.sizes, self.kept = x, sizes[kept], kept
        self.conserved, self.tol, self.span = conserved, tol, span
        self.T0 = period.T
        self.phase = shots.t0 if period.own else shots.t0 - shots.first(period.T)
        """When a period begins, s: within the first one from which on all repeats."""
        self.why = ""
        """Why the last correction failed."""

    # -- unknowns

    def z_of(self, x: Vector, T: float, p: float) -> Vector:
        """Return the unknowns of an orbit."""
        own = [T / self.T0] if self.period.own else []
        return np.array([*(x[self.kept] / self.sizes), *own, p / self.span])

    def parameter(self, z: Vector) -> float:
        """Return the parameter of unknowns."""
        return float(z[-1] * self.span)

    def _state(self, z: Vector) -> Vector:
        x = self.base.copy()
        x[self.kept] = z[: len(self.kept)] * self.sizes
        return x

    # -- equations

    def shot(self, z: Vector, mode: Mode) -> Shot:
        """Return the period that unknowns say."""
        self.shots.at([self.parameter(z)])
        if self.period.own:
            T, T_by = float(z[-2]) * self.T0, None
        else:
            T, T_by = length_now(self.shots, self.period), followed_by(self.shots, self.period)
        self.shots.t0 = self.phase + (0.0 if self.period.own else self.shots.first(T))
        return self.shots.shot(self._state(z), mode, T, T_by)

    def tried(self, z: Vector, mode: Mode) -> Shot | None:
        """Return the period that unknowns say, None where it cannot be run."""
        try:
            return self.shot(z, mode)
        except HybondError as error:
            self.why = error.why
            return None

    def equations(self, shot: Shot, reference: Node | None) -> tuple[Vector, Vector]:
        """Return F and its slopes by the unknowns, shape (rows, unknowns)."""
        assert shot.M is not None and shot.by is not None and shot.last is not None
        kept, unit, m = self.kept, self.sizes, len(self.kept)
        J = (shot.M[np.ix_(kept, kept)] - np.eye(m)) * unit / unit[:, None]
        by = shot.by[kept, :1] / unit[:, None] * self.span
        F = (shot.end - shot.x)[kept] / unit
        if not self.period.own:
            return F, np.hstack([J, by])
        length = (shot.last[kept] / unit * self.T0)[:, None]
        before = shot if reference is None else reference.shot
        assert before.first is not None
        row = before.first[kept] / unit
        row = row / max(float(np.linalg.norm(row)), 1e-300)
        off = float(row @ ((shot.x - before.x)[kept] / unit))
        whole = np.vstack([np.hstack([J, length, by]), [*row, 0.0, 0.0]])
        return np.append(F, off), whole

    # -- points

    def corrected(
        self, z: Vector, mode: Mode, row: Vector, reference: Node | None, along: Vector
    ) -> Node | None:
        """Return the point of the curve on the plane through z that a row stands on.

        Parameters
        ----------
        reference : Node, optional
            Where the phase of an autonomous orbit is counted from.
        along : array
            Which way the tangent points.

        Returns
        -------
        Node or None
            None where the correction does not settle; `why` says why.
        """
        plane = float(row @ z)
        last = np.inf
        for k in range(ITERATIONS):
            shot = self.tried(z, mode)
            if shot is None:
                return None
            if shot.M is None:
                self.why = shot.why
                return None
            F, J = self.equations(shot, reference)
            off = float(np.abs(F).max(initial=0.0))
            if shot.end_mode != shot.mode:
                mode = shot.end_mode
            elif off <= self.tol:
                return self._node(z, mode, shot, J, along, k)
            if k >= 2 and off > NEARER * last:
                self.why = f"Newton's steps come no nearer than {last:.2g} of a state"
                return None
            last = off
            step = self.solved(J, row, -F, plane - float(row @ z))
            z = z + step
        self.why = f"Newton's steps do not settle in {ITERATIONS}"
        return None

    def _node(
        self, z: Vector, mode: Mode, shot: Shot, J: Vector, along: Vector, iterations: int
    ) -> Node:
        tangent = self.solved(J, along, np.zeros(len(J)), 1.0)
        tangent = tangent / np.linalg.norm(tangent)
        found = self.shots.multipliers(
            shot, self._whole_sizes(), self.kept, own=self.period.own, conserved=self.conserved
        )
        return Node(z, tangent, mode, shot, found, iterations)

    def solved(self, J: Vector, row: Vector, F: Vector, last: float) -> Vector:
        """Return the solution of ``J d = F, row d = last`` that keeps what is conserved."""
        m = len(self.kept)
        kept = np.zeros((0, len(row)))
        if self.conserved:
            own = conserved(J[:m, :m])
            kept = np.zeros((len(own), len(row)))
            kept[:, :m] = own
        whole = np.vstack([J, row, kept])
        right = np.concatenate([F, [last], np.zeros(len(kept))])
        return np.asarray(np.linalg.lstsq(whole, right, rcond=FREE)[0])

    def at_parameter(self, node: Node, p: float) -> Node | None:
        """Return the orbit at a value of the parameter, near another one."""
        row = np.zeros(len(node.z))
        row[-1] = 1.0
        z = node.z.copy()
        if abs(node.tangent[-1]) > 1e-3:
            z = z + node.tangent * ((p / self.span - z[-1]) / node.tangent[-1])
        z[-1] = p / self.span
        return self.corrected(z, node.mode, row, node, node.tangent)

    def between(self, a: Node, b: Node, part: float) -> Node | None:
        """Return the point of the curve between two others, at a part of the way."""
        chord = b.z - a.z
        z = a.z + part * chord
        row = chord / max(float(np.linalg.norm(chord)), 1e-300)
        mode = a.mode if part < 0.5 else b.mode
        found = self.corrected(z, mode, row, a, row)
        if found is None and a.mode != b.mode:
            found = self.corrected(z, b.mode if part < 0.5 else a.mode, row, a, row)
        return found

    def elsewhere(self, node: Node) -> tuple[Arc, Node] | None:
        """Return the same orbit with its beginning within its longest motion, and the curve there.

        None where that cannot be, or which way the curve goes cannot be told.
        """
        shot = node.shot
        point = calm(shot.run, shot.T)
        if point is None or abs(node.tangent[-1]) < 1e-3:
            return None
        t, x, mode = point
        arc = Arc(
            self.shots, self.period, x, self._whole_sizes(), self.kept, self.conserved, self.tol,
            self.span,
        )  # fmt: skip
        arc.T0, arc.phase = self.T0, (0.0 if self.period.own else t % shot.T)
        row = np.zeros(len(node.z))
        row[-1] = 1.0
        z = arc.z_of(x, shot.T, self.parameter(node.z))
        found = arc.corrected(z, mode, row, None, row * np.sign(node.tangent[-1]))
        return None if found is None else (arc, found)

    def doubled(self, node: Node, amplitude: float) -> tuple[Arc, Node] | None:
        """Return the curve of orbits of twice the period that begins at a point, and one of them.

        Parameters
        ----------
        node : Node
            Where a multiplier is -1.
        amplitude : float
            How far the orbit is away, as a part of states.
        """
        kept, m = self.kept, len(self.kept)
        assert node.shot.M is not None
        own = node.shot.M[np.ix_(kept, kept)] * self.sizes / self.sizes[:, None]
        values, vectors = np.linalg.eig(own)
        k = int(np.argmin(np.abs(values + 1.0)))
        v = np.real(vectors[:, k])
        v = v / np.linalg.norm(v)
        v = v * np.sign(v[int(np.argmax(np.abs(v)))])
        p = self.period
        period = replace(p, T=2.0 * node.shot.T, multiple=p.multiple * (1 if p.own else 2))
        arc = Arc(
            self.shots, period, self._state(node.z), self._whole_sizes(), kept, self.conserved,
            self.tol, self.span,
        )  # fmt: skip
        arc.phase = self.phase
        z = arc.z_of(self._state(node.z), period.T, self.parameter(node.z))
        row = np.zeros(len(z))
        row[:m] = v
        found = arc.corrected(z + amplitude * row, node.mode, row, node, row)
        return None if found is None else (arc, found)

    def _whole_sizes(self) -> Vector:
        found = np.ones(len(self.base))
        found[self.kept] = self.sizes
        return found

    def point(self, node: Node) -> OrbitPoint:
        """Return a point of the curve as a record."""
        shot = node.shot
        # what drives it says when it begins
        begin = shot.run.t_begin
        state = shot.run.state(begin - self.phase + shot.T if self.phase else begin)
        return OrbitPoint(
            self.parameter(node.z),
            shot.T,
            {**state.stored, **state.signals},
            dict(state.machines),
            node.found,
            shot.run,
        )
