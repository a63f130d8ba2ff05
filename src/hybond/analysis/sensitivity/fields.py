"""The rates of states along a run, and how they change with states, time and parameters.

Along a switching surface g = 0 the rates are those of Filippov, a mean of those of the modes around
it (0 below all surfaces, j above surface j):

    f = f_0 + sum_j l_j (f_j - f_0),      g' = L_0 + sum_j l_j (L_j - L_0) = 0,   L_i = g' in mode i
    dl = -(L_j - L_0)^-1 ((1 - sum l) dL_0 + sum_j l_j dL_j)

where L_i is g differentiated along the motion as an expression: nothing is a difference.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.gradients import Compiled, Gradients
from hybond.analysis.sensitivity.last_kink import Kink, ends_at
from hybond.analysis.sensitivity.mode_rows import ModeRows
from hybond.analysis.sensitivity.solving import NO_SLOPE
from hybond.analysis.sensitivity.tangent import At, Columns, Read, Tangent, Undetermined
from hybond.analysis.sensitivity.values import Values
from hybond.analysis.sensitivity.wanted import followed, stored_law
from hybond.engine.outcome.combinations import Combination
from hybond.equations.calculus import partial_time
from hybond.equations.surfaces import surfaces_of
from hybond.model.expressions import Expr, Neg, names, substitute, turning
from hybond.model.graph import FlatGraph, Mode
from hybond.model.inputs import Called, Timetable
from hybond.runs.trace import Segment

Vector = NDArray[np.float64]
__all__ = ["Field", "Fields", "ModeField", "Undetermined", "partial_time"]


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

    def point(self, k: int) -> Field:
        """Return the field at one of its points."""
        k %= self.at.points

        def own(rows: Vector) -> Vector:
            return rows if len(rows) == 1 else rows[k : k + 1]

        at = self.at.some(slice(k, k + 1))
        return Field(at, self.f[k : k + 1], own(self.slopes), own(self.bonds), self.tangent)


class Fields:
    """The fields of a run.

    Parameters
    ----------
    integrands : sequence of Expr
        What is integrated beside the states, in canonical names.
    """

    def __init__(self, values: Values, integrands: Sequence[Expr]) -> None:
        self._values = values
        self.graph = values.found.graph
        states = [f"x:{s.index}" for s in self.graph.storages]
        states += [f"s:{i.index}" for i in self.graph.integrals]
        self.columns = Columns(states, len(self.graph.inputs), values.found.columns)
        self.integrands = list(integrands)
        self.size = len(states) + len(self.integrands)
        self._rates: dict[tuple[ModeRows, Expr], tuple[Compiled, Read]] = {}
        self._forget()

    def _forget(self) -> None:
        """Know no number of any run."""
        self._made: dict[tuple[object, ...], ModeField] = {}
        self._whole: tuple[Segment, Vector, Field] | None = None
        self._nine: tuple[Segment, Field] | None = None
        self._last: tuple[Segment, Kink | None] | None = None

    @property
    def values(self) -> Values:
        """The values of the run; they may be replaced by those of another run of the graph."""
        return self._values

    @values.setter
    def values(self, values: Values) -> None:
        self._values = values
        self._forget()

    def mode(self, mode: Mode, at: At) -> ModeField:
        """Return the equations of a mode, where comparisons of time are as at a point."""
        names = [f"at:{w.index}" for w in self.graph.watches]
        return self._mode(mode, {n: float(np.ravel(at.values[n])[0]) for n in names})

    def mode_after(self, mode: Mode, t: float) -> ModeField:
        """Return the equations of a mode that is entered at a time."""
        return self._mode(mode, self.values.truths_after(t))

    def _mode(self, mode: Mode, truths: dict[str, float]) -> ModeField:
        key = (mode, *truths.values())
        found = self._made.get(key)
        if found is None:
            kept = self.values.found.modes
            whole = (*key, *self.integrands)
            if whole not in kept:
                kept[whole] = ModeField(self.graph, self.columns, self.integrands, mode, truths)
            found = self._made[key] = kept[whole].anew()
        return found

    def within(self, segment: Segment, t: Vector) -> Field:
        """Return the field at times of a segment."""
        at = self.values.within(segment, t)
        if segment.sliding is None:
            mode = self.mode(segment.mode, at)
            kink = self.last_kink(segment) if mode.rows.turns else None
            if kink is not None and (t > kink.left).any():
                at = self.values.within(segment, np.minimum(t, kink.left))
            return mode.field(at)
        return self._sliding(segment, np.minimum(t, np.nextafter(segment.t[-1], 0.0)), at)

    def last_kink(self, segment: Segment) -> Kink | None:
        """Return the kink at the very end of a segment; kept as `whole` is."""
        if self._last is None or self._last[0] is not segment:
            self._last = segment, ends_at(self, segment)
        return self._last[1]

    def whole(self, segment: Segment, times: Vector) -> tuple[Vector, Field]:
        """Return the accepted points of a segment with times inside it, and the field there.

        That of the last segment asked for is kept.
        """
        if self._whole is None or self._whole[0] is not segment:
            begin, end = float(segment.t[0]), float(segment.t[-1])
            inside = times[(times > begin) & (times < end)]
            mesh = np.unique(np.concatenate([segment.t, inside]))
            self._whole = segment, mesh, self.within(segment, mesh)
        return self._whole[1:]

    def spread(self, segment: Segment) -> Field:
        """Return the field at nine points over a segment, but its end; kept as `whole` is."""
        if self._nine is None or self._nine[0] is not segment:
            t = np.linspace(segment.t[0], segment.t[-1], 9)[:-1]
            self._nine = segment, self.within(segment, t)
        return self._nine[1]

    def ending(self, segment: Segment, state: Vector | None) -> Field:
        """Return the field at the end of a segment, in a state that is given."""
        t = float(segment.t[-1])
        kept = self._whole is not None and self._whole[0] is segment
        if kept and (state is None or segment.sliding is not None or self._stays(segment, state)):
            assert self._whole is not None
            return self._whole[2].point(-1)
        if state is None or segment.sliding is not None:
            return self.within(segment, np.array([t]))
        at = self.values.before(segment, t, state)
        mode = self.mode(segment.mode, at)
        if mode.rows.turns and self.last_kink(segment) is not None:
            return self.within(segment, np.array([t]))
        return mode.field(at)

    def _stays(self, segment: Segment, state: Vector) -> bool:
        """Whether the motion itself ends in a state: no constraint puts it back."""
        assert self._whole is not None
        tangent = self._whole[2].tangent
        return (
            tangent.alike and tangent.free(self.values.own) and bool((segment.y[-1] == state).all())
        )

    def entered(self, t: float, state: Vector, mode: Mode) -> Field:
        """Return the field where a mode begins."""
        at = self.values.after(t, state, mode)
        return self.mode(mode, at).field(at)

    def parts(self, segment: Segment, t: Vector) -> list[Field]:
        """Return the fields of all modes that a sliding motion combines, at times of it."""
        made = segment.combined
        assert isinstance(made, Combination) and made.modes is not None
        if made.product and len(made.surfaces) > 1:
            raise Undetermined("products of weights are combined on several surfaces")
        values = self.values.parts(segment, t)
        modes = [tuple(m) for m in made.modes.tolist()]
        parts = [self.mode(m, at).field(at) for m, at in zip(modes, values, strict=True)]
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

    def rate_of(self, field: Field, g: Expr) -> tuple[Vector, Vector]:
        """Return how fast a function of the state moves, and how that changes by all columns."""
        key = field.tangent.rows, g
        if key not in self._rates:
            L = field.tangent.rows.along_held([field.tangent.rows.made(g)])
            self._rates[key] = Compiled(L), Read(field.tangent, L)
        value, slope = self._rates[key]
        at = field.at
        return value.at(at.values, at.points)[:, 0], slope.at(at, field.bonds)[:, 0]

    def weights(self, segment: Segment, t: Vector) -> tuple[list[Field], Vector, Vector]:
        """Return the modes around points of sliding, the weights l, and how these change.

        Returns
        -------
        parts : list of Field
        weights : array, shape (points, surfaces)
        slopes : array, shape (points, surfaces, columns)
        """
        parts = self.parts(segment, t)
        surfaces = self.surfaces(segment)
        shape = len(t), len(surfaces), len(parts)
        speeds, slopes = np.zeros(shape), np.zeros((*shape, self.columns.many))
        for j, g in enumerate(surfaces):
            for i, part in enumerate(parts):
                speeds[:, j, i], slopes[:, j, i] = self.rate_of(part, g)
        turn = speeds[:, :, 1:] - speeds[:, :, :1]
        weights: Vector = np.asarray(np.linalg.solve(turn, -speeds[:, :, :1])[:, :, 0], float)
        change: Vector = (_shares(weights)[:, None, :, None] * slopes).sum(axis=2)
        return parts, weights, np.asarray(-np.linalg.solve(turn, change))

    def _sliding(self, segment: Segment, t: Vector, mean: At) -> Field:
        parts, weights, change = self.weights(segment, t)
        shares = _shares(weights)
        f = sum(s[:, None] * p.f for s, p in zip(shares.T, parts, strict=True))
        slopes, bonds = (
            sum(s[:, None, None] * getattr(p, name) for s, p in zip(shares.T, parts, strict=True))
            + sum(
                (own(p) - own(parts[0]))[:, :, None] * change[:, j, None]
                for j, p in enumerate(parts[1:])
            )
            for name, own in (("slopes", lambda p: p.f), ("bonds", _bonds_of))
        )
        return Field(mean, np.asarray(f), slopes, bonds, parts[0].tangent)


def _shares(weights: Vector) -> Vector:
    return np.concatenate([1.0 - weights.sum(axis=1, keepdims=True), weights], axis=1)


def _bonds_of(field: Field) -> Vector:
    values = (field.at.values[n] for n in field.tangent.rows.bonds)
    return np.array([np.broadcast_to(v, field.at.points) for v in values]).T


class ModeField:
    """A mode with what is read in it.

    Attributes
    ----------
    basis : tuple or None
        Of its states, slow apart from fast, once it was asked for (`flow`).
    by_states : tuple or None
        How rates change with states, and how slopes by parameters do, where they are affine.
    """

    def __init__(
        self,
        graph: FlatGraph,
        columns: Columns,
        integrands: Sequence[Expr],
        mode: Mode,
        truths: dict[str, float],
    ) -> None:
        self._graph, self._columns = graph, columns
        self.basis: tuple[Vector, Vector, Vector, bool] | None = None
        self.by_states: tuple[Vector, Vector] | None = None
        self._affine: bool | None = None
        self._timeless: bool | None = None
        self.rows = ModeRows(graph, mode, truths)
        self.tangent = Tangent(self.rows, columns)
        self._extra = [self.rows.moving(e) for e in integrands]
        self._rates = Compiled([*self.rows.rates, *self._extra])
        self._read = Read(self.tangent, self._extra)

    def anew(self) -> ModeField:
        """Return the same equations, of which no number is known yet."""
        found = copy.copy(self)
        found.basis = found.by_states = None
        found.tangent = self.tangent.anew()
        return found

    @property
    def timeless(self) -> bool:
        """Whether no rate reads time, or an input that moves between its edges."""
        if self._timeless is None:
            every = [*self.rows.rows, *self.rows.rates, *self._extra]
            read = frozenset().union(*(names(e) for e in every))
            ramps = {f"u:{i.index}" for i in self._graph.inputs
                     if isinstance(i.waveform, Timetable) and i.waveform.linear}  # fmt: skip
            self._timeless = "time" not in read and not read & ramps
        return self._timeless

    @property
    def affine(self) -> bool:
        """Whether rates are affine in states and time, with coefficients of parameters only."""
        if self._affine is None:
            graph, columns = self._graph, self._columns
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
        if not np.isfinite(slopes).all():
            raise Undetermined(NO_SLOPE)
        return Field(at, self._rates.at(at.values, at.points), slopes, bonds, self.tangent)


def state_function(graph: FlatGraph, g: Expr) -> Expr:
    """Return an expression in which bond variables that storage sets are laws of what is stored.

    Raises
    ------
    Undetermined
        If it reads other bond variables.
    """
    laws = _set_by_storage(graph)
    found = followed(substitute(g, {n: laws[n] for n in names(g) if n in laws}))
    left = [n for n in names(found) if n.startswith(("e:", "f:"))]
    if left:
        raise Undetermined("the surface that is slid on reads more than what is stored")
    return found


def _set_by_storage(graph: FlatGraph) -> dict[str, Expr]:
    """Return the bond variables that are the co-energy variable of a storage, as its law."""
    found: dict[str, Expr] = {}
    for s in graph.storages:
        law = stored_law(graph, s)
        kind = "e" if s.kind == "C" else "f"
        own: Expr = Neg(law) if s.kind == "I" and s.sign < 0 else law
        found[f"{kind}:{s.bond}"] = own
        bond = graph.bonds[s.bond]
        for at in (bond.tail, bond.head):
            node = graph.nodes[at]
            if node.kind == ("0" if s.kind == "C" else "1") and not node.controlled:
                found.update({f"{kind}:{end.bond}": own for end in node.ends})
    return found
