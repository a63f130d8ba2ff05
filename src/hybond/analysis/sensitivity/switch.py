"""The saltation of a switch, through every mode that was passed at the instant.

    x- moves with the instant:       X = d + f- dtau
    each mode that was written:      X <- its entry map, differentiated (`entry`)
    and is seen at the old time:     d+ = X - f+ dtau

with dtau of the crossing. Several modes written at one instant (pinnacles) compose. Sources:
Rozenvasser 1967; Galan, Feehery and Barton 1999.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.collocation import Jump
from hybond.analysis.sensitivity.crossing import Crossing
from hybond.analysis.sensitivity.entry import Before, entered
from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.gaps import closing, has_gap
from hybond.analysis.sensitivity.gradients import Compiled
from hybond.analysis.sensitivity.sampling import due, sampled
from hybond.analysis.sensitivity.tangent import Read
from hybond.runs.trace import Event

Vector = NDArray[np.float64]

CLOSED = 1e-11
"""Part of its terms that a gap may be open, and is closed."""


def switched(
    fields: Fields, t: float, end: Field, found: Crossing, event: Event | None, begin: Field
) -> Jump:
    """Return what a switch makes of the variations.

    Parameters
    ----------
    end, begin : Field
        At the instant, from the left and from the right.

    Raises
    ------
    Undetermined
        Where a mode that was passed has no derivative.
    """
    n, size = fields.columns.time, fields.size
    many = len(fields.columns.parameters)
    basis = size + many
    dtau = found.by
    moved = np.eye(size, basis) + np.outer(end.f[0], dtau)
    p = np.eye(many, basis, size)
    written = moved[:n].copy()
    now = [sample for sample, _ in due(fields, t)]
    moved[:n] = sampled(end, now, moved[:n], dtau, p)
    moved[:n] = passed(fields, t, end, event, Before(moved[:n], dtau, p, end, written))
    whole = moved - np.outer(begin.f[0], dtau)
    if event is not None:
        whole[:n] = landed(fields, end, event, whole[:n], p)
    return Jump(t, whole[:, :size], whole[:, size:], dtau[:size], dtau[size:])


def landed(fields: Fields, end: Field, event: Event, moved: Vector, p: Vector) -> Vector:
    """Return variations after an event, those of gaps that it closed being none.

    Where flights become so short that rounding ends the last one, it is not the gap that was found
    to be zero first: and yet all motions nearby are on the contact from there, whichever way.

    Parameters
    ----------
    end : Field
        Before the event.
    moved, p : array, shape (n, more), (parameters, more)
        Variations of what is stored and integrated after it, and of parameters.
    """
    left = {f.machine for step in event.steps for f in step.fired if f.source == "open"}
    contacts = [
        k
        for k, m in enumerate(fields.graph.machines)
        if m.path in left
        and has_gap(fields, k)
        and m.states[event.steps[-1].mode[k]] == "closed"
        and _is_closed(fields, end, k)
    ]
    if not contacts:
        return moved
    n = fields.columns.time
    many = len(fields.columns.parameters)
    still = np.zeros(n + many)
    start = Before(np.eye(n, n + many), still, np.eye(many, n + many, n), end, np.eye(n, n + many))
    less = closing(fields, contacts, end, passed(fields, event.t, end, event, start)[:, :n])
    return moved if less is None else moved - less @ np.vstack([moved, p])


def _is_closed(fields: Fields, end: Field, machine: int) -> bool:
    """Whether the gap of a contact is zero, but for rounding of its terms."""
    law = fields.graph.machines[machine].law
    assert law is not None and law.gap is not None
    made = end.tangent.rows.moving(law.gap)
    read = Read(end.tangent, [made])
    slope, n = read.at(end.at, end.bonds)[0, 0], fields.columns.time
    value = float(Compiled([made]).at(end.at.values, 1)[0, 0])
    states = (float(np.ravel(end.at.values[name])[0]) for name in fields.columns.states)
    terms = sum(abs(float(c) * x) for c, x in zip(slope[:n], states, strict=True))
    return abs(value) <= CLOSED * max(terms, float(read.terms(end.at)[0]))


def started(fields: Fields, event: Event, states: Vector, begin: Field) -> Vector:
    """Return the variations after the start was settled, shape (states, more + parameters)."""
    basis, many = states.shape[1], len(fields.columns.parameters)
    instant, p = np.zeros(basis), np.eye(many, basis, basis - many)
    now = [sample for sample, _ in due(fields, event.t)]
    prior, x = begin, states
    if now:
        mode = tuple(m.start for m in fields.graph.machines)
        prior = fields.entered(event.t, np.asarray(event.before), mode)
        x = sampled(prior, now, states, instant, p)
    return passed(fields, event.t, prior, event, Before(x, instant, p, prior, states))


def passed(fields: Fields, t: float, end: Field, event: Event | None, before: Before) -> Vector:
    """Return how the state is varied after all modes that were written at an instant."""
    if event is None:
        return before.x
    state = np.array(event.before, dtype=float)
    for sample, _ in due(fields, t):
        for k in sample.signals:
            place = len(fields.graph.storages) + k
            state[place] = event.after[place]
    x = before.x
    written = [s for s in event.steps if s.kind != "mythical"]
    from_ = end
    for k, step in enumerate(written):
        last = k == len(written) - 1
        if last and not step.areas:
            into = fields.mode_after(step.mode, t).tangent
            if into.alike and into.free(fields.values.own):
                return x
        state = state + _moved(fields, step.areas)
        if last:
            state = np.array(event.after, dtype=float)
        at = fields.values.with_prior(fields.values.after(t, state, step.mode), _one(from_))
        mode = fields.mode(step.mode, at)
        x = entered(mode.tangent, at, step.areas, replace(before, x=x))
        if not last:
            field = mode.field(at)
            before = replace(before, x=x, written=x, field=field)
            from_ = field
    return x


def _one(field: Field) -> dict[str, float]:
    return {name: float(np.ravel(v)[0]) for name, v in field.at.values.items()}


def _moved(fields: Fields, areas: Mapping[str, float]) -> Vector:
    """Return what impulse areas add to what is stored and integrated."""
    graph = fields.graph
    moved = np.zeros(len(graph.storages) + len(graph.integrals))
    for s in graph.storages:
        name, sign = (f"e:{s.bond}", 1.0) if s.kind == "I" else (f"f:{s.bond}", float(s.sign))
        moved[s.index] = sign * areas.get(name, 0.0)
    return moved


__all__ = ["passed", "started", "switched"]
