"""Why two right engines may differ: the cases in which a model does not have one answer.

Each is decided from the model and its runs, and holds from a certain time on. A difference that
begins before any reason for it is a mistake of one of the engines.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hybond.analysis.complementarity.form import complementarity
from hybond.analysis.cross.runs import Events, states_passed
from hybond.causality.orientation import base_mode
from hybond.errors import HybondError
from hybond.model.expressions import Number, names
from hybond.model.graph import FlatGraph, Machine, Mode
from hybond.result import Result
from hybond.runs.trace import Event

SMALL = 1e-9
"""Part of the largest entry below which an eigenvalue counts as zero."""


@dataclass(frozen=True, slots=True)
class Reason:
    """A reason for a legitimate difference."""

    name: str
    """``simultaneous impacts``, ``friction during impact``, ``several solutions``, ``thresholds``,
    ``pinnacles and resets``, ``sliding``, ``events closer than the step``, ``a run that
    stopped``."""
    text: str
    """What was found."""
    since: float
    """From when on, s."""


@dataclass(frozen=True, slots=True)
class Uniqueness:
    """Whether complementarity leaves the answer open."""

    shares: frozenset[tuple[str, str]] = frozenset()
    """Machine and ``common`` or ``net`` of what is not unique, though all that is stored is."""
    several: bool = False
    """Whether what is stored need not be unique either."""


def uniqueness(graph: FlatGraph, modes: list[Mode]) -> Uniqueness:
    """Return what the laws of a graph leave open in some modes of its other machines.

    ``G(s) = D + C (s I - A)^-1 E`` at a real s is the matrix of an implicit step of length 1/s. If
    ``G + G'`` is positive semi-definite, solutions differ only within its null space, and what is
    stored is unique.
    """
    if not any(m.law is not None for m in graph.machines):
        return Uniqueness()
    shares: set[tuple[str, str]] = set()
    several = False
    for mode in dict.fromkeys(base_mode(graph, m) for m in modes):
        try:
            form = complementarity(graph, mode, symbolic=False)
            m = form.numbers()
        except HybondError:
            continue
        a, e, c, d = (np.asarray(m[k], dtype=float) for k in "AECD")
        if not d.size:
            continue
        s = 1.0 + 2.0 * float(np.abs(a).sum(axis=1).max(initial=0.0))
        g = d + c @ np.linalg.solve(s * np.eye(len(a)) - a, e) if len(a) else d
        size = np.sqrt(np.maximum(np.abs(np.diag(g)), SMALL * np.abs(g).max()))
        size[size == 0.0] = 1.0
        g = g / np.outer(size, size)
        values, vectors = np.linalg.eigh(g + g.T)
        small = SMALL * max(1.0, float(np.abs(values).max()))
        several |= bool(values[0] < -small)
        null = vectors[:, np.abs(values) <= small]
        moved = np.abs(null).max(axis=1, initial=0.0), np.abs(g @ null).max(axis=1, initial=0.0)
        for k, port in enumerate(form.laws):
            own, other = ("common", "net") if port.orientation == "common" else ("net", "common")
            for which, by in ((own, moved[0][k]), (other, moved[1][k])):
                if by > SMALL:
                    shares.add((port.path, which))
    return Uniqueness(frozenset(shares), several)


def reasons(
    graph: FlatGraph,
    a: Result,
    b: Result,
    *,
    step: float | None,
    unique: Uniqueness,
    compared: Events,
) -> tuple[Reason, ...]:
    """Return the legitimate reasons for differences between two runs, the earliest first.

    Parameters
    ----------
    step : float or None
        Of the run that has one.
    unique : Uniqueness
        Of the graph in the modes of the runs.
    """
    events = [e for run in (a, b) for e in run.trace.events]
    every = [
        _simultaneous(graph, events),
        _friction(graph, events),
        _several(graph, (a, b), unique),
        _thresholds(graph, compared),
        _pinnacles(graph, events),
        _sliding((a, b)),
        _close(a if step is not None and b.solver == "moreau-jean" else b, step),
        _stopped((a, b)),
    ]
    return tuple(sorted((r for r in every if r is not None), key=lambda r: r.since))


def _begin(event: Event) -> float:
    return event.t if event.t0 is None else event.t0


def _bouncing(machine: Machine) -> bool:
    law = machine.law
    if law is None or law.restitution is None:
        return False
    return not (isinstance(law.restitution, Number) and law.restitution.value == 0.0)


def _simultaneous(graph: FlatGraph, events: list[Event]) -> Reason | None:
    who = [m for m in graph.machines if _bouncing(m)]
    for event in sorted(events, key=_begin):
        struck = [m.path for m in who if "impact" in states_passed(event, m)]
        if len(struck) > 1:
            return Reason(
                "simultaneous impacts",
                f"{', '.join(struck)} bounce at one instant: contact after contact, or all in one "
                "problem, are different laws of impact",
                _begin(event),
            )
    return None


def _varying_friction(graph: FlatGraph) -> list[str]:
    return [
        m.path
        for m in graph.machines
        if m.law is not None
        and m.law.limit is not None
        and any(n.startswith(("e:", "f:")) for n in names(m.law.limit))
    ]


def _friction(graph: FlatGraph, events: list[Event]) -> Reason | None:
    who = _varying_friction(graph)
    if not who:
        return None
    for event in sorted(events, key=_begin):
        if any(step.impulses for step in event.steps if step.kind != "mythical"):
            return Reason(
                "friction during impact",
                f"the friction of {', '.join(who)} follows a force that has an impulse: it acts in "
                "an impact for time-stepping, and for located events where it is impulsive",
                _begin(event),
            )
    return None


def _several(graph: FlatGraph, runs: tuple[Result, Result], found: Uniqueness) -> Reason | None:
    if found.several:
        return Reason(
            "several solutions",
            "the matrix of the complementarity problem is not positive semi-definite, so that it "
            "may have several solutions or none",
            0.0,
        )
    if any(" answers: " in w for run in runs for w in run.warnings):
        who = ", ".join(_varying_friction(graph)) or "the laws"
        return Reason(
            "several solutions", f"a step had more than one solution ({who}; see its warning)", 0.0
        )
    return None


def _thresholds(graph: FlatGraph, compared: Events) -> Reason | None:
    """Guards of states, gates, breakaway: just reached in one run, just missed in the other."""
    if compared.parted is None:
        return None
    machine = next(m for m in graph.machines if m.path == compared.machine)
    law = machine.law
    if law is None:
        reads = (n for r in machine.rules for n in names(r.guard))
        keeps = any(n.startswith(("e:", "f:", "x:", "s:")) for n in reads)
    else:
        keeps = law.breakaway is not None or law.gate is not None
    if not keeps:
        return None
    return Reason(
        "thresholds",
        f"{machine.path} switches at a threshold, which one run reaches and the other does not "
        f"({' -> '.join(compared.states)})",
        compared.parted,
    )


def _pinnacles(graph: FlatGraph, events: list[Event]) -> Reason | None:
    written = {m.path: m for m in graph.machines if m.law is None}
    for event in sorted(events, key=_begin):
        for step in event.steps:
            if step.kind != "pinnacle":
                continue
            who = [f.machine for f in step.fired if f.machine in written]
            if who:
                return Reason(
                    "pinnacles and resets",
                    f"{', '.join(who)} writes what is stored at an instant by a rule of its own",
                    _begin(event),
                )
    return None


def _sliding(runs: tuple[Result, Result]) -> Reason | None:
    left = [s for run in runs for s in run.sliding if s.t1 < run.t_end]
    if not left:
        return None
    first = min(left, key=lambda s: s.t1)
    return Reason(
        "sliding",
        f"{', '.join(first.machines)} slid along {', '.join(first.surfaces)}: where that has "
        "become unstable, any moment of leaving is an answer",
        first.t1,
    )


def _close(located: Result, step: float | None) -> Reason | None:
    if step is None:
        return None
    times = [e.t for e in located.trace.events if e.cause != "start"]
    for t0, t1 in pairwise(times):
        if t1 - t0 < step:
            return Reason(
                "events closer than the step",
                f"two events {t1 - t0:.3g} s apart, with steps of {step:.3g} s",
                t0,
            )
    return None


def _stopped(runs: tuple[Result, Result]) -> Reason | None:
    for run in runs:
        if run.status == "accumulation":
            return Reason(
                "a run that stopped",
                f"{run.solver} stops where events accumulate, at t = {run.t_end:.9g} s",
                run.t_end,
            )
    return None
