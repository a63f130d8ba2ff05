"""The rates of states along a run, and how they change with states, time and parameters.

Along a switching surface g = 0 the rates are those of Filippov, a mean of those of the modes around
it (0 below all surfaces, j above surface j):

    f = f_0 + sum_j l_j (f_j - f_0),      g' = L_0 + sum_j l_j (L_j - L_0) = 0,   L_i = g' in mode i
    dl = -(L_j - L_0)^-1 ((1 - sum l) dL_0 + sum_j l_j dL_j)

where L_i is g differentiated along the motion as an expression: nothing is a difference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.gradients import Compiled, Gradients
from hybond.analysis.sensitivity.mode_rows import ModeRows
from hybond.analysis.sensitivity.state_functions import state_function
from hybond.analysis.sensitivity.tangent import At, Columns, Read, Tangent, Undetermined
from hybond.analysis.sensitivity.values import Values
from hybond.engine.outcome.combinations import Combination
from hybond.equations.calculus import partial_time
from hybond.equations.surfaces import surfaces_of
from hybond.model.expressions import Expr, names, turning
from hybond.model.graph import Mode
from hybond.model.inputs import Called
from hybond.runs.trace import Segment

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Field:
    """Rates at points, states first and then what is integrated beside them.

    Parameters
    ----------
    at : At
    f : array, shape (points, n)
    slopes : array, shape (points, n, columns)
        By states, time, parameters.
    bonds : array, shape (points or 1, 2 * bonds, columns)
        How bond variables change.
    tangent : Tangent
        Of the mode, or of one of those that are combined.
    """

    at: At
    f: Vector
    slopes: Vector
    bonds: Vector
    tangent: Tangent


class Fields:
    """The fields of a run.

    Parameters
    ----------
    integrands : sequence of Expr
        What is integrated beside the states, in canonical names.
    """

    def __init__(self, values: Values, integrands: Sequence[Expr]) -> None:
        self.values = values
        self.graph = values.found.graph
        states = [f"x:{s.index}" for s in self.graph.storages]
        states += [f"s:{i.index}" for i in self.graph.integrals]
        self.columns = Columns(states, len(self.graph.inputs), values.found.columns)
        self.integrands = list(integrands)
        self.size = len(states) + len(self.integrands)
        self._made: dict[tuple[object, ...], ModeField] = {}

    def mode(self, mode: Mode, at: At) -> ModeField:
        """Return the equations of a mode, where comparisons of time are as at a point."""
        names = [f"at:{w.index}" for w in self.graph.watches]
        truths = {n: float(np.ravel(at.values[n])[0]) for n in names}
        key = (mode, *truths.values())
        found = self._made.get(key)
        if found is None:
            found = self._made[key] = ModeField(self, mode, truths)
        return found

    def within(self, segment: Segment, t: Vector) -> Field:
        """Return the field at times of a segment."""
        at = self.values.within(segment, t)
        if segment.sliding is None:
            return self.mode(segment.mode, at).field(at)
        inside = np.minimum(t, np.nextafter(segment.t[-1], 0.0))
        states = np.array([at.values[n] for n in self.columns.states]).T
        return self._sliding(segment, inside, states, at)

    def ending(self, segment: Segment, state: Vector | None) -> Field:
        """Return the field at the end of a segment, in a state that is given."""
        t = float(segment.t[-1])
        if state is None or segment.sliding is not None:
            return self.within(segment, np.array([t]))
        at = self.values.before(segment, t, state)
        return self.mode(segment.mode, at).field(at)

    def entered(self, t: float, state: Vector, mode: Mode) -> Field:
        """Return the field where a mode begins."""
        at = self.values.after(t, state, mode)
        return self.mode(mode, at).field(at)

    def parts(self, segment: Segment, t: float, state: Vector) -> list[Field]:
        """Return the fields of all modes that a sliding motion combines, at one of its points."""
        made = segment.combined
        assert isinstance(made, Combination) and made.modes is not None
        if made.product and len(made.surfaces) > 1:
            raise Undetermined("products of weights are combined on several surfaces")
        parts = [self.entered(t, state, tuple(m)) for m in made.modes.tolist()]
        if len({p.tangent.rank(p.at) for p in parts}) > 1:
            # the limit of jumps back and forth, and no mean of two fields
            raise Undetermined("modes that hold storage together differently are combined")
        return parts

    def surfaces(self, segment: Segment) -> list[Expr]:
        """Return the switching functions that are slid on, of states, time and parameters only."""
        made = segment.combined
        assert isinstance(made, Combination)
        every = surfaces_of(self.graph)
        return [state_function(self.graph, every[k].g) for k in made.surfaces]

    def rate_of(self, field: Field, g: Expr) -> tuple[float, Vector]:
        """Return how fast a function of the state moves, and how that changes by all columns."""
        (L,) = field.tangent.rows.along_held([field.tangent.rows.made(g)])
        value = float(Compiled([L]).at(field.at.values, 1)[0, 0])
        slope = Read(field.tangent, [L]).at(field.at, field.bonds)[0, 0]
        return value, slope

    def weights(
        self, segment: Segment, t: float, state: Vector
    ) -> tuple[list[Field], Vector, Vector]:
        """Return the modes around a point of sliding, the weights l, and how these change.

        Returns
        -------
        parts : list of Field
        weights : array, shape (surfaces,)
        slopes : array, shape (surfaces, columns)
        """
        parts = self.parts(segment, t, state)
        surfaces = self.surfaces(segment)
        found = [[self.rate_of(part, g) for part in parts] for g in surfaces]
        speeds = np.array([[v for v, _ in row] for row in found])
        slopes = np.array([[s for _, s in row] for row in found])
        turn = speeds[:, 1:] - speeds[:, :1]
        weights = np.linalg.solve(turn, -speeds[:, 0])
        shares = np.concatenate([[1.0 - weights.sum()], weights])
        return parts, weights, -np.linalg.solve(turn, np.einsum("i,sic->sc", shares, slopes))

    def _sliding(self, segment: Segment, t: Vector, states: Vector, mean: At) -> Field:
        fs, slopes, bonds = [], [], []
        tangent: Tangent | None = None
        for at, state in zip(t.tolist(), states, strict=True):
            parts, weights, change = self.weights(segment, at, state)
            shares = np.concatenate([[1.0 - weights.sum()], weights])
            own_w = np.array([_bonds_of(p) for p in parts])
            fs.append(np.einsum("i,in->n", shares, np.array([p.f[0] for p in parts])))
            slope = np.einsum("i,inc->nc", shares, np.array([p.slopes[0] for p in parts]))
            w = np.einsum("i,inc->nc", shares, np.array([p.bonds[0] for p in parts]))
            for j in range(len(weights)):
                slope = slope + np.outer(parts[j + 1].f[0] - parts[0].f[0], change[j])
                w = w + np.outer(own_w[j + 1] - own_w[0], change[j])
            slopes.append(slope)
            bonds.append(w)
            tangent = parts[0].tangent
        assert tangent is not None
        return Field(mean, np.array(fs), np.array(slopes), np.array(bonds), tangent)


def _bonds_of(field: Field) -> Vector:
    names = field.tangent.rows.bonds
    return np.array([float(np.ravel(field.at.values[n])[0]) for n in names])


class ModeField:
    """A mode with what is read in it.

    Attributes
    ----------
    basis : tuple or None
        Of its states, slow apart from fast, once it was asked for (`flow`).
    """

    def __init__(self, fields: Fields, mode: Mode, truths: dict[str, float]) -> None:
        self._fields = fields
        self.basis: tuple[Vector, Vector, Vector, bool] | None = None
        self._affine: bool | None = None
        self.rows = ModeRows(fields.graph, mode, truths)
        self.tangent = Tangent(self.rows, fields.columns)
        self._extra = [self.rows.moving(e) for e in fields.integrands]
        self._rates = Compiled([*self.rows.rates, *self._extra])
        self._read = Read(self.tangent, self._extra)

    @property
    def affine(self) -> bool:
        """Whether rates are affine in states and time, with coefficients of parameters only."""
        if self._affine is None:
            graph, columns = self._fields.graph, self._fields.columns
            every = [*self.rows.rows, *self.rows.rates, *self._extra]
            moving = [*self.rows.bonds, *columns.states, "time"]
            moving += [f"u:{k}" for k in range(columns.inputs)]
            read = frozenset().union(*(names(e) for e in every))
            bent = (h for e in every for h in turning(e))
            self._affine = (
                not any(isinstance(graph.inputs[k].waveform, Called) and f"u:{k}" in read
                        for k in range(columns.inputs))
                and not any(n in moving for h in bent for n in names(h))
                and Gradients(every, moving).steady
            )  # fmt: skip
        return self._affine

    def field(self, at: At) -> Field:
        """Return the field at points."""
        bonds = self.tangent.bonds(at)
        slopes = self.tangent.rates(at, bonds)
        if self._extra:
            extra = self._read.at(at, bonds)
            points = max(len(slopes), len(extra))
            both = (np.broadcast_to(a, (points, *a.shape[1:])) for a in (slopes, extra))
            slopes = np.concatenate(list(both), axis=1)
        return Field(at, self._rates.at(at.values, at.points), slopes, bonds, self.tangent)


__all__ = ["Field", "Fields", "ModeField", "Undetermined", "partial_time"]
