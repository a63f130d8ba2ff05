"""Values of residuals: along a run, or for data from a plant."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.motion import Motion, numbered
from hybond.analysis.residuals.jets import Jet
from hybond.errors import UsageError
from hybond.model.expressions import Expr, Number, differentiate, simplify, substitute
from hybond.model.expressions import names as names_of
from hybond.model.graph import FlatGraph, Mode

if TYPE_CHECKING:
    from hybond.analysis.residuals.residuals import Residuals
    from hybond.result import Result

Array = NDArray[np.float64]
Piece = tuple[Array, Mode, dict[str, Array], dict[str, Array]]
"""Instants, the mode believed in, values and sizes by residual."""


@dataclass(frozen=True)
class ResidualValues:
    """Values of all residuals at some instants."""

    t: Array
    """Shape (m,)."""
    modes: tuple[Mode, ...]
    """The mode that the residuals were evaluated for, per instant."""
    values: Mapping[str, Array]
    """Dict of str to array, shape (m,). Per residual. NaN where a derivative that it reads is not
    available (the second one in a nonlinear mode)."""
    sizes: Mapping[str, Array]
    """Dict of str to array, shape (m,). The sum of the magnitudes of the terms: what a value is to
    be compared with."""

    def __getitem__(self, name: str) -> Array:
        return self.values[name]

    def worst(self) -> dict[str, float]:
        """Return the largest magnitude of each residual, as a part of the size of its terms.

        The size is the largest along all instants, so that a residual whose terms all pass
        through zero there is not blown up.
        """
        found = {}
        for name, value in self.values.items():
            size = float(np.nanmax(self.sizes[name], initial=0.0))
            largest = float(np.nanmax(np.abs(value), initial=0.0))
            found[name] = largest / size if size else largest
        return found

    def alarms(self, limits: Mapping[str, float] | float) -> dict[str, NDArray[np.bool_]]:
        """Return, per residual, whether it is beyond its limit: the coherence vector in time.

        Parameters
        ----------
        limits : float or mapping of str to float
            In the unit of the residual.
        """
        return {
            name: np.abs(value) > (limits[name] if isinstance(limits, Mapping) else limits)
            for name, value in self.values.items()
        }


def along_run(
    about: Residuals,
    run: Result,
    *,
    mode: Mode | None,
    t: Sequence[float] | None,
    values: Mapping[str, float] | None,
) -> ResidualValues:
    """Evaluate along a run, segment by segment."""
    _same_graph(about.graph, run.graph)
    known = about.ring.known(values or {})
    pieces: list[Piece] = []
    for k, segment in enumerate(run.segments):
        times = segment.t
        if t is not None:
            last = k + 1 == len(run.segments)
            inside = [a for a in t if segment.t[0] <= a and (a < segment.t[-1] or last)]
            times = np.array([a for a in inside if a <= segment.t[-1]], dtype=float)
        if not len(times):
            continue
        motion = Motion(run, segment, times)
        believed = segment.mode if mode is None else tuple(mode)

        def read(jet: Jet, motion: Motion = motion) -> Array:
            own = about.given.known[jet.column]
            formula = own.formula if own.kind == "sensor" else numbered(own.formula, known)
            return motion.derivative(_as_run(run, formula), jet.order)

        found, sizes = _evaluated(about, believed, read, known)
        pieces.append((times, believed, found, sizes))
    return _joined(about, pieces)


def _as_run(run: Result, formula: Expr) -> Expr:
    """Put in the values of parameters that a sensor's formula names."""
    values = {f"p:{path}": float(v) for path, v in run.graph.parameters.items()}
    return numbered(formula, values)


def of_data(
    about: Residuals,
    data: Mapping[str, Any],
    *,
    mode: Mode | None,
    values: Mapping[str, float] | None,
) -> ResidualValues:
    """Evaluate for arrays by name, all in one mode."""
    known = about.ring.known(values or {})
    believed = about.graph.start_mode if mode is None else tuple(mode)
    arrays = {k: np.atleast_1d(np.asarray(v, dtype=float)) for k, v in data.items()}
    size = max((len(a) for a in arrays.values()), default=1)
    time = arrays.get("t", arrays.get("time", np.zeros(size)))

    def read(jet: Jet) -> Array:
        own = about.given.known[jet.column]
        name = own.name + "'" * jet.order
        if name in arrays:
            return np.broadcast_to(arrays[name], (size,))
        e = numbered(own.formula, known)
        for _ in range(jet.order):
            e = simplify(differentiate(e, "time"))
        timed = names_of(e) <= {"time"} and ("t" in arrays or "time" in arrays)
        if own.kind == "source" and (isinstance(e, Number) or timed):
            each = [simplify(substitute(e, {"time": Number(float(a))})) for a in time]
            return np.broadcast_to([c.value for c in each if isinstance(c, Number)], (size,))
        raise UsageError(
            f"the data have no {name!r}",
            code="HB-A303",
            where="data",
            hint="give an array for each sensor, derivatives with primes, and for each source "
            "that is not constant",
        )

    found, sizes = _evaluated(about, believed, read, known)
    return _joined(about, [(np.broadcast_to(time, (size,)), believed, found, sizes)])


def _evaluated(
    about: Residuals, mode: Mode, read: Callable[[Jet], Array], known: Mapping[str, float]
) -> tuple[dict[str, Array], dict[str, Array]]:
    kept: dict[Jet, Array] = {}
    values: dict[str, Array] = {}
    sizes: dict[str, Array] = {}
    for residual in about:
        row = residual.row.at(mode, about.ring)
        total: Any = 0.0
        size: Any = 0.0
        for k, c in row.items():
            jet = about.jets.jets[k]
            if jet not in kept:
                kept[jet] = read(jet)
            term = c.evaluate(known) * kept[jet]
            total = total + term
            size = size + np.abs(term)
        values[residual.name], sizes[residual.name] = np.asarray(total), np.asarray(size)
    return values, sizes


def _joined(about: Residuals, pieces: list[Piece]) -> ResidualValues:
    def whole(name: str, at: Callable[[Piece], dict[str, Array]]) -> Array:
        parts = [np.broadcast_to(at(p)[name], p[0].shape) for p in pieces]
        return np.concatenate(parts) if parts else np.zeros(0)

    t = np.concatenate([p[0] for p in pieces]) if pieces else np.zeros(0)
    modes = tuple(mode for times, mode, _, _ in pieces for _ in times)
    names = [r.name for r in about]
    values = {n: whole(n, lambda p: p[2]) for n in names}
    return ResidualValues(t, modes, values, {n: whole(n, lambda p: p[3]) for n in names})


def _same_graph(one: FlatGraph, other: FlatGraph) -> None:
    """Check that elements, bonds and machines are the same ones; values may differ."""

    def shape(graph: FlatGraph) -> tuple[object, ...]:
        return (
            [(n.path, n.kind) for n in graph.nodes],
            [(b.tail, b.head) for b in graph.bonds],
            [(m.path, m.states) for m in graph.machines],
        )

    if shape(one) != shape(other):
        raise UsageError(
            f"the run is of {other.name!r}, which has other elements or bonds than {one.name!r}",
            code="HB-A303",
            where="data",
            hint="simulate this model, or this model with other parameters",
        )
