"""Which solver fits a model, and why: ``solver = "auto"``.

Looked at are the start mode and those that one machine's other state makes of it, so that the
number of modes does not matter; of each, whether its motion is linear, else how fast it decays and
how fast it oscillates at the state that the run begins with.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.look import Look
from hybond.engine.compiled.points import Points
from hybond.engine.outcome.engines import Prepared, choose_engine
from hybond.engine.tables import ModelTables, tables_of
from hybond.equations.calculus import rate_name
from hybond.errors import HybondError
from hybond.model.expressions import ARRAYS, compile_expression, names
from hybond.model.graph import FlatGraph, Mode
from hybond.run_options import AUTO

Vector = NDArray[np.float64]

LOOKED = 24
"""Modes that are looked at."""
LARGEST = 400
"""Stored quantities of a mode whose matrix, which is full, is made."""
DENSE = 150
"""Stored quantities and signals of which a Jacobian is made to look at."""
STABLE = 3.3
"""The fastest decay that a step of ``rk45`` bears, in units of its inverse."""
MANY = 10_000.0
"""Steps for stability alone that are too many."""
APART = 30.0
"""A decay is only in the way if it is that much faster than what oscillates."""
LINEAR, PINNACLE = -1, -2
"""A mode that is linear, and one without motion: as in `hybond.engine.looking.look`."""


@dataclass(frozen=True, slots=True)
class Fit:
    """A solver, and why it fits."""

    solver: str
    reason: str


@dataclass(frozen=True, slots=True)
class _Speed:
    """The fastest decay and the fastest oscillation of a mode, 1/s."""

    mode: Mode
    decay: float
    oscillation: float

    def steps(self, until: float) -> float:
        """Return how many steps stability would take, 0 if accuracy takes as many."""
        return until * self.decay / STABLE if self.decay > APART * self.oscillation else 0.0


def fitted(graph: FlatGraph, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return options of a run with a solver for ``"auto"``, if that is what they or a model say."""
    found = dict(options)
    if (found.get("solver") or graph.experiment.get("solver")) == AUTO:
        tables = tables_of(graph, calling=True, **{**found, "solver": "exact"})
        found["solver"] = fitting(choose_engine().prepare(tables)).solver
    return found


def fitting(model: Prepared) -> Fit:
    """Return a solver that fits a run; its tables are made for solver ``"exact"``.

    Linear modes are propagated exactly. Where others are stiff, ``radau`` takes all; else ``rk45``
    takes those that are not linear.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> tables = tables_of(m.flatten(), until="1 s", solver="exact")
    >>> fitting(choose_engine().prepare(tables))
    Fit(solver='exact', reason='the mode looked at is linear')
    """
    tables = model.tables
    graph = tables.graph
    until = tables.numbers["until"]
    if len(graph.storages) > LARGEST:
        return Fit(
            "rk45", f"{len(graph.storages)} stored quantities are too many for full matrices"
        )
    look = model.look()
    y = np.array(tables.floats["storage_start"] + tables.floats["integral_start"])
    linear = 0
    reasons: set[str] = set()
    speeds: list[_Speed] = []
    for mode in _modes(graph):
        try:
            look.into(0.0, list(mode))
            why = look.why_not_linear()
            if why == PINNACLE:
                continue
            if why == LINEAR:
                linear += 1
                continue
            reasons.add(tables.reasons[why])
            if len(y) <= DENSE:
                speeds.append(_speed(tables, look, mode, y))
        except HybondError:
            continue  # a mode that has no motion of its own, or not at this state
    if linear and not reasons:
        one = linear == 1
        all_ = "the mode looked at is" if one else f"all {linear} modes looked at are"
        return Fit("exact", f"{all_} linear")
    stiff = max(speeds, key=lambda s: s.steps(until), default=None)
    if stiff is not None and stiff.steps(until) > MANY:
        where = graph.mode_text(stiff.mode)
        return Fit(
            "radau",
            f"{where or 'its motion'} decays within {1.0 / stiff.decay:.2g} s: "
            f"{stiff.steps(until):.1g} explicit steps for stability",
        )
    why_not = "; ".join(sorted(reasons)) or "no mode can be looked at before the run"
    if linear:
        others = "not stiff" if speeds else "too large to tell whether they are stiff"
        return Fit("exact", f"{_count(linear)} looked at linear, others {others}")
    return Fit("rk45", f"not linear ({why_not})" + (", not stiff" if speeds else ""))


def _count(n: int) -> str:
    return f"{n} mode{'' if n == 1 else 's'}"


def _modes(graph: FlatGraph) -> Iterator[Mode]:
    start = graph.start_mode
    yield start
    count = 1
    for machine in graph.machines:
        for state in range(len(machine.states)):
            if state == start[machine.index]:
                continue
            if count == LOOKED:
                return
            count += 1
            other = list(start)
            other[machine.index] = state
            yield tuple(other)


def _speed(tables: ModelTables, look: Look, mode: Mode, y: Vector) -> _Speed:
    """Return how fast the mode that is looked into decays and oscillates near a state."""
    n = len(y)
    size = np.maximum(np.abs(y), 1e-6 * max(float(np.abs(y).max(initial=0.0)), 1e-3))
    rows = np.vstack([y, y + 1e-6 * np.diag(size)])
    rates = _rates(tables, look, rows)
    # what the states really moved by
    moved = np.diag(rows[1:] - y)
    jacobian = ((rates[1:] - rates[0]) / moved[:, None]).T
    if not n or not np.isfinite(jacobian).all():
        return _Speed(mode, 0.0, 0.0)
    values = np.linalg.eigvals(jacobian)
    return _Speed(mode, float((-values.real).max()), float(np.abs(values.imag).max()))


def _rates(tables: ModelTables, look: Look, rows: Vector) -> Vector:
    """Return the rates of states at t = 0, each a row of `rows`."""
    graph, index, size = tables.graph, tables.slots.index, tables.slots.size
    wanted = [rate_name(s) for s in graph.storages] + [i.rate for i in graph.integrals]
    # while time passes what was before is what is
    both = [index[n] for n in sorted(set().union(*map(names, wanted)))]
    slots = np.array([*both, *(k + size for k in both)], dtype=np.intc)
    values = look.values(Points(np.zeros(len(rows)), rows, accepted=True), slots)
    columns = [np.zeros(0)] * (2 * size)
    for k, column in zip(slots.tolist(), values.T, strict=True):
        columns[k] = column
    found = np.zeros(rows.shape)
    for k, e in enumerate(wanted):
        found[:, k] = compile_expression(e, index, ARRAYS, pre_offset=size)(columns)
    return found
