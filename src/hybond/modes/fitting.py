"""Which solver fits a program, and why: ``solver = "auto"``.

Looked at are the start mode and those that one machine's other state makes of it, so that the
number of modes does not matter; of each, whether its motion is linear, else how fast it decays and
how fast it oscillates at the state that the run begins with.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError
from hybond.model.graph import FlatGraph, Mode
from hybond.model.interval import Interval, interval_after
from hybond.programs.linear import LARGEST, linear_form
from hybond.programs.program import Program

Vector = NDArray[np.float64]

LOOKED = 24
"""Modes that are looked at."""
DENSE = 150
"""Stored quantities and signals of which a Jacobian is made to look at."""
STABLE = 3.3
"""The fastest decay that a step of ``rk45`` bears, in units of its inverse."""
MANY = 10_000.0
"""Steps for stability alone that are too many."""
APART = 30.0
"""A decay is only in the way if it is that much faster than what oscillates."""


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


def fitting(program: Program, until: float, y: Vector) -> Fit:
    """Return a solver that fits a run from the state `y`, shape (nx + ns + 2,), to `until`.

    Linear modes are propagated exactly. Where others are stiff, ``radau`` takes all; else ``rk45``
    takes those that are not linear. `program` is used up: its counts are those of looking.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> fitting(Program(m.flatten()), 1.0, np.array([0.01, 0.0, 0.0]))
    Fit(solver='exact', reason='the mode looked at is linear')
    """
    if program.nx > LARGEST:
        return Fit("rk45", f"{program.nx} stored quantities are too many for full matrices")
    linear = 0
    reasons: set[str] = set()
    speeds: list[_Speed] = []
    for mode, interval in _modes(program):
        try:
            equations = program.equations(mode, interval, 0.0)
            if program.fieldless(mode):
                continue
            form = linear_form(program, equations, interval)
            if not isinstance(form, str):
                linear += 1
                continue
            reasons.add(form)
            if len(y) <= DENSE:
                speeds.append(_speed(program, mode, interval, y))
        except HybondError:
            continue  # a mode that has no motion of its own, or not at this state
    if linear and not reasons:
        one = linear == 1
        all_ = "the mode looked at is" if one else f"all {linear} modes looked at are"
        return Fit("exact", f"{all_} linear")
    stiff = max(speeds, key=lambda s: s.steps(until), default=None)
    if stiff is not None and stiff.steps(until) > MANY:
        where = program.graph.mode_text(stiff.mode)
        return Fit(
            "radau",
            f"{where or 'its motion'} decays within {1.0 / stiff.decay:.2g} s: "
            f"{stiff.steps(until):.1g} explicit steps for stability",
        )
    why = "; ".join(sorted(reasons)) or "no mode can be looked at before the run"
    if linear:
        others = "not stiff" if speeds else "too large to tell whether they are stiff"
        return Fit("exact", f"{_count(linear)} looked at linear, others {others}")
    return Fit("rk45", f"not linear ({why})" + (", not stiff" if speeds else ""))


def _count(n: int) -> str:
    return f"{n} mode{'' if n == 1 else 's'}"


def _modes(program: Program) -> Iterator[tuple[Mode, Interval]]:
    graph: FlatGraph = program.graph
    interval = interval_after(graph, 0.0)
    start = graph.start_mode
    yield start, interval
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
            yield tuple(other), interval


def _speed(program: Program, mode: Mode, interval: Interval, y: Vector) -> _Speed:
    """Return how fast a mode decays and oscillates near a state."""
    equations = program.equations(mode, interval, 0.0)
    field = program.field(equations, interval)
    n = program.nx + program.ns
    base = np.array(field(0.0, y))[:n]
    size = np.maximum(np.abs(y[:n]), 1e-6 * max(float(np.abs(y[:n]).max(initial=0.0)), 1e-3))
    columns = []
    for k in range(n):
        moved = y.copy()
        moved[k] += 1e-6 * size[k]
        columns.append((np.array(field(0.0, moved))[:n] - base) / (moved[k] - y[k]))
    jacobian = np.array(columns).reshape(n, n).T
    if not n or not np.isfinite(jacobian).all():
        return _Speed(mode, 0.0, 0.0)
    values = np.linalg.eigvals(jacobian)
    return _Speed(mode, float((-values.real).max()), float(np.abs(values.imag).max()))
