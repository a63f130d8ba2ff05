"""Two runs of one model side by side: what is stored, what laws do over time, events by machine.

A stored quantity is compared at common times. Of a junction law the integrals over time of its two
variables are compared, impulses included: a force that acts for a step and an impulse within it are
the same to a method of fixed steps, and the integral of both is what another engine must find too.
"""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import gradient
from hybond.model.expressions import Name, Number
from hybond.model.graph import FlatGraph, Integral, Machine
from hybond.model.planar_friction import kept_paths
from hybond.result import Result
from hybond.runs.trace import Event, Segment

Vector = NDArray[np.float64]
Kind = Literal["stored", "integrated", "common", "net", "kept"]

SAMPLES = 400
"""Times at which runs are compared."""
FLOOR = 1e-3
"""A stored quantity is measured against at least this part of what the energy would make of it."""
SHARE = 1e-2
"""What a law adds up to is measured against at least this part of what bonds like it do."""
IDLE = 1e-9
"""Part of the largest of its kind below which an integral counts as zero."""
PAD = 1e-6
"""Part of the run around an event that runs without a step are not compared at, for the maximum."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """What is compared."""

    name: str
    unit: str
    kind: Kind
    """The last two: the integral over time of a junction law's variable."""
    machine: str = ""
    """Of the law, empty if it is none."""


@dataclass(frozen=True, slots=True)
class Difference:
    """How far two runs are apart in one quantity, as parts of `scale`."""

    quantity: Quantity
    scale: float
    """The largest value of the quantity, SI."""
    mean: float
    """Over the run."""
    largest: float
    time: float
    """`largest` and `time`: away from events, and when (s): around an event two runs differ by its
    whole jump."""
    since: float | None
    """First time away from events at which they are further apart than the tolerance."""

    def to_data(self) -> dict[str, Any]:
        """Return plain data in SI."""
        return {
            "name": self.quantity.name,
            "kind": self.quantity.kind,
            "unit": self.quantity.unit,
            "scale": self.scale,
            "mean": self.mean,
            "largest": self.largest,
            "t": self.time,
            "since": self.since,
        }


@dataclass(frozen=True, slots=True)
class Events:
    """Transitions of the machines of two runs, compared machine by machine and in order.

    Parameters
    ----------
    first, second : int
        How many there were.
    paired : int
        Those with the same machine, source and target in both.
    apart : float
        Largest distance of a pair, s: between the time of one and the step of the other.
    at : float or None
        When that was, s.
    parted : float or None
        When the first transition happened that the other run does not have, s.
    machine : str
        Whose transition that was.
    states : tuple of str
        The states it passed.
    """

    first: int
    second: int
    paired: int
    apart: float
    at: float | None
    parted: float | None
    machine: str = ""
    states: tuple[str, ...] = ()


def watched(graph: FlatGraph) -> FlatGraph:
    """Return the graph with the variables of its laws integrated over time as well."""
    integrals = list(graph.integrals)
    for m in graph.machines:
        if m.law is None:
            continue
        for name, rate in (("common", m.law.common), ("net", m.law.net)):
            if not isinstance(rate, Number):
                integrals.append(Integral(len(integrals), f"{m.path}:{name}", rate, 0.0))
    return replace(graph, integrals=tuple(integrals))


def quantities(graph: FlatGraph, run: Result) -> list[Quantity]:
    """Return what is compared, in the order of the states of `run`, a run of `watched(graph)`."""
    found = [Quantity(s.path, run.unit(s.path), "stored") for s in graph.storages]
    kept = kept_paths(graph)
    for i in graph.integrals:
        kind: Kind = "kept" if i.path in kept else "integrated"
        found.append(Quantity(i.path, run.unit(i.path), kind))
    own = len(graph.integrals)
    for i in run.graph.integrals[own:]:
        path, _, which = i.path.rpartition(":")
        kind = "common" if which == "common" else "net"
        name = f"{path}.{_pair(graph, path, kind)[1]}"
        unit = run.unit(name)
        found.append(Quantity(name, f"{unit}*s" if unit else "s", kind, path))
    return found


def compared(
    names: Sequence[Quantity], a: Result, b: Result, *, tolerance: float, step: float | None
) -> list[Difference]:
    """Return how far two runs are apart, quantity by quantity, up to where both have got to.

    Parameters
    ----------
    step : float or None
        Of the run that has one.
    """
    end = min(a.t_end, b.t_end)
    if not a.segments or not b.segments or end <= 0.0:
        return []
    times = np.linspace(0.0, end, SAMPLES + 1)[:-1] + 0.5 * end / SAMPLES
    left, right = (states_at(run, times)[:, : len(names)] for run in (a, b))
    scale = _scales(a, b, names, left, right)
    apart = np.abs(left - right) / scale
    quiet = np.ones(len(times), dtype=bool)
    pad = 2.0 * step if step is not None else PAD * end
    for run in (a, b):
        for event in run.trace.events:
            if event.t > 0.0:
                begin = event.t if event.t0 is None else event.t0
                quiet &= (times < begin - pad) | (times > event.t + pad)
    found = []
    for k, quantity in enumerate(names):
        if quantity.kind == "kept":
            continue
        away = np.where(quiet, apart[:, k], 0.0)
        worst = int(np.argmax(away))
        beyond = np.flatnonzero(away > tolerance)
        found.append(
            Difference(
                quantity,
                float(scale[k]),
                float(apart[:, k].mean()),
                float(away[worst]),
                float(times[worst]),
                float(times[beyond[0]]) if len(beyond) else None,
            )
        )
    return found


def states_at(run: Result, times: Vector) -> Vector:
    """Return what is stored and integrated at some times, one row each."""
    segments = _ends_of_steps(run)
    starts = [float(s.t[0]) for s in segments]
    rows = []
    for t in times.tolist():
        segment = segments[max(bisect.bisect_right(starts, t) - 1, 0)]
        rows.append(segment.at(min(t, float(segment.t[-1]))))
    return np.array(rows)


def _ends_of_steps(run: Result) -> list[Segment]:
    """Return segments in which laws add up the ends of steps, where time-stepping decides them.

    It averages the smooth part of other integrals; of a law that would add a part of what the
    graph would do without it.
    """
    laws = {m.path: m.law for m in run.graph.machines if m.law is not None}
    bonds = len(run.graph.bonds)
    columns: list[tuple[int, Vector]] = []
    for i in run.graph.integrals:
        path, _, which = i.path.rpartition(":")
        if path in laws and which in ("common", "net"):
            row = np.zeros(2 * bonds)
            for name, slope in gradient(i.rate).items():
                assert isinstance(slope, Number)
                letter, _, index = name.partition(":")
                row[int(index) + (bonds if letter == "f" else 0)] = slope.value
            columns.append((len(run.graph.storages) + i.index, row))
    found: list[Segment] = []
    last: tuple[Vector, Vector] | None = None
    for segment in run.segments:
        if segment.bonds is None or not columns:
            found.append(segment)
            continue
        y = np.array(segment.y)
        for k, row in columns:
            # what an instant between two segments added stays
            begin = y[0, k] if last is None else last[1][k] + segment.y[0, k] - last[0][k]
            grown = np.cumsum(np.diff(segment.t) * (segment.bonds[1:] @ row))
            y[:, k] = begin + np.concatenate([[0.0], grown])
        last = segment.y[-1], y[-1]
        found.append(replace(segment, y=y))
    return found


def _scales(a: Result, b: Result, names: Sequence[Quantity], left: Vector, right: Vector) -> Vector:
    """Return what each quantity is measured by, never zero."""
    both = np.maximum(np.abs(left).max(axis=0), np.abs(right).max(axis=0))
    nx = len(a.graph.storages)
    energy = max(a.trace.energy, *(np.abs(a.signals.stored(s.y)).max() for s in a.segments))
    own = a.signals.own_stiffness()
    stiffness = np.abs(a.signals.after(0.0, left[0], a.segments[0].mode, own))
    with np.errstate(divide="ignore", invalid="ignore"):
        whole = np.sqrt(2.0 * energy / stiffness)
    floor = np.zeros(len(names))
    floor[:nx] = np.where(np.isfinite(whole), FLOOR * whole, 0.0)
    added = _added_up(a if a.segments[0].bonds is not None else b)
    for k, q in enumerate(names):
        if q.machine:
            domain, variable = _pair(a.graph, q.machine, q.kind)
            floor[k] = SHARE * added[domain, variable]
    scale = np.maximum(both, floor)
    # what is idle in both runs has no scale of its own: rounding must not make one
    scale = np.maximum(scale, IDLE * float(both.max(initial=0.0)))
    return np.asarray(np.where(scale > 0.0, scale, 1.0))


def _pair(graph: FlatGraph, machine: str, kind: Kind) -> tuple[str, str]:
    """Return domain and letter of a law's variable: a 1-junction has its flow in common."""
    node = graph.nodes[graph.by_path[machine]]
    return node.domain.name, "f" if (node.kind == "0") == (kind == "net") else "e"


def _added_up(run: Result) -> dict[tuple[str, str], float]:
    """Return the largest integral of an absolute effort or flow, by domain and letter."""
    bonds = run.graph.bonds
    total = np.zeros(2 * len(bonds))
    for segment in run.segments:
        h = np.diff(segment.t)
        if segment.bonds is not None:
            total += h @ np.abs(segment.bonds[1:])
            continue
        wanted = [Name(f"{letter}:{k}") for letter in "ef" for k in range(len(bonds))]
        w = np.abs(np.array(run.signals.of(segment, wanted, segment.t)))
        total += 0.5 * (w[:, 1:] + w[:, :-1]) @ h
    found: dict[tuple[str, str], float] = {}
    for k, bond in enumerate(bonds):
        for letter, value in (("e", total[k]), ("f", total[len(bonds) + k])):
            key = bond.domain.name, letter
            found[key] = max(found.get(key, 0.0), float(value))
    return found


def compared_events(graph: FlatGraph, a: Result, b: Result) -> Events:
    """Compare the transitions of two runs.

    A law that changes its branch twice within a step has not moved for a method of fixed steps, and
    conversely: what counts is what each machine does at one event as a whole, impacts included.
    """
    end = min(a.t_end, b.t_end)
    paired = 0
    apart, at = 0.0, None
    parted: tuple[float, str, tuple[str, ...]] | None = None
    totals = [0, 0]
    for m in graph.machines:
        rows = [_transitions(run, m, end) for run in (a, b)]
        for k in (0, 1):
            totals[k] += len(rows[k])
        for k in range(max(map(len, rows))):
            here = [r[k] if k < len(r) else None for r in rows]
            one, other = here
            if one is not None and other is not None and one[2] == other[2]:
                paired += 1
                away = max(one[0] - other[1], other[0] - one[1], 0.0)
                if away > apart:
                    apart, at = away, max(one[1], other[1])
                continue
            t, what = min((h[1], h[2]) for h in here if h is not None)
            if parted is None or t < parted[0]:
                parted = t, m.path, what
            break
    found = Events(totals[0], totals[1], paired, apart, at, None)
    if parted is None:
        return found
    t, machine, states = parted
    return replace(found, parted=t, machine=machine, states=states)


def _transitions(
    run: Result, machine: Machine, end: float
) -> list[tuple[float, float, tuple[str, ...]]]:
    """Return (begin, end, states passed) of each event that moved a machine."""
    found = []
    for event in run.trace.events:
        if event.t > end or event.cause == "start":
            continue
        passed = states_passed(event, machine)
        if len(passed) > 1:
            found.append((event.t if event.t0 is None else event.t0, event.t, passed))
    return found


def states_passed(event: Event, machine: Machine) -> tuple[str, ...]:
    """Return the states that a machine has been in at an event, mythical ones left out."""
    found: list[str] = []
    for step in event.steps:
        for fired in step.fired:
            if fired.machine == machine.path and not found:
                found.append(fired.source)
        if step.kind != "mythical":
            state = machine.states[step.mode[machine.index]]
            if not found or found[-1] != state:
                found.append(state)
    return tuple(found)
