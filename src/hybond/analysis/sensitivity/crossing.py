"""What ends a motion, and how its instant moves.

    h(x, t, p) = 0 with h' = h_x f + h_t not zero:    d tau = -(h_x d + h_p dp) / h'

h is the comparison of a guard that becomes true, a branch of a junction's law that ends, the edge
of an input, a comparison of time, or a weight of sliding that reaches its end. A comparison may
become true without passing zero, because what it reads jumps: the sawtooth of a pulse width
modulation, a condition. Then h is what makes that jump. Where h' is zero the
guard is only touched (grazing) and the instant has no derivative; where two of them are zero at
once, their order would change, and it has none either unless both say the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.gradients import Compiled
from hybond.analysis.sensitivity.sampling import due
from hybond.analysis.sensitivity.tangent import Read, Undetermined
from hybond.engine.tables.factored_guards import factored_guard
from hybond.model.expressions import Binary, Expr, comparisons, names, to_text
from hybond.model.expressions.kinks import leaping
from hybond.runs.trace import Event, Segment

Vector = NDArray[np.float64]

CLOSE = 1e-6
"""Part of a segment within which a function that crosses at its speed would be zero."""
LOCATED = 1e-11
"""Part of a time within which the run has located a crossing."""
GRAZES = 1e-6
"""A speed of crossing below this part of the largest one of the segment is none."""
ROUNDED = 4e-12
"""Part of its terms within which the run may leave a function that it has located."""
STILL = 4 * float(np.finfo(float).eps)
"""A function that moves by less than this part of what it is made of does not move at all."""
NEVER = 1e-4
"""The same for its terms in states, which may be nearly equal: a part of that."""
NO_CAUSE = "time"
"""The text of a crossing that nothing but time makes."""
SAME = 1e-6
"""Part by which two derivatives of an instant may differ and be one."""


@dataclass(frozen=True, slots=True)
class Crossing:
    """How an instant moves.

    Parameters
    ----------
    by : array, shape (n + parameters,)
        ``d tau`` by states, what is integrated beside them, and parameters.
    text : str
        What became zero.
    """

    by: Vector
    text: str


def crossing(fields: Fields, segment: Segment, end: Field, event: Event | None) -> Crossing:
    """Return how the end of a segment moves.

    Parameters
    ----------
    end : Field
        At the end of the segment, from the left.
    event : Event or None
        What happened there, None if only a field changes.

    Raises
    ------
    Undetermined
        If the instant has no derivative: the reason.
    """
    t = float(segment.t[-1])
    found: list[Crossing] = []
    if event is not None and event.cause == "guard":
        found = _by_guards(fields, segment, end, event)
    if not found and segment.sliding is not None:
        found = _by_weights(fields, segment, end)
    if not found or due(fields, t):
        found += timed(fields, end, t)
    if not found:
        if event is None or event.cause in ("time", "input"):
            return Crossing(np.zeros(fields.size + len(fields.columns.parameters)), NO_CAUSE)
        raise Undetermined("what became zero at this instant was not found")
    first = found[0]
    for other in found[1:]:
        both = np.abs(first.by) + np.abs(other.by)
        if (np.abs(first.by - other.by) > SAME * both.max(initial=0.0)).any():
            raise Undetermined(
                f"{first.text} and {other.text} happen at one instant: which comes first would "
                "change"
            )
    return first


def _by_guards(fields: Fields, segment: Segment, end: Field, event: Event) -> list[Crossing]:
    """Return the comparisons of guards that fired first and that became zero.

    Where none is zero, what jumps in them is looked at, and then what jumps in the laws of the
    mode, as a source that steps: that is zero where it jumps.
    """
    touched: list[str] = []
    for jumps in (False, True):
        for loose in (False, True):
            found, grazed = _guards_that_cross(fields, segment, end, event, loose, jumps)
            if found:
                return found
            touched += grazed
    rows = end.tangent.rows
    made = [crossed(fields, segment, end, h, "a law jumps") for h in rows.turns if h in rows.leaps]
    if passed := [c for c in made if isinstance(c, Crossing)]:
        return passed
    if touched:
        raise Undetermined(f"{touched[0]} is only touched (grazing)")
    return []


def _guards_that_cross(
    fields: Fields, segment: Segment, end: Field, event: Event, loose: bool, jumps: bool
) -> tuple[list[Crossing], list[str]]:
    """Return what crosses, and the texts of what only touches."""
    graph = fields.graph
    found: list[Crossing] = []
    grazed: list[str] = []
    machines = {m.path: m for m in graph.machines}
    for fired in event.steps[0].fired:
        machine = machines.get(fired.machine)
        if machine is None or fired.source not in machine.states:
            continue
        source = machine.states.index(fired.source)
        rules = [r for r in machine.rules if r.source == source]
        own = [r for r in rules if machine.states[r.target] == fired.target]
        for rule in own or rules:
            # a product is flat where it crosses: that is asked of what it is made of
            for compare in comparisons(factored_guard(rule.guard)):
                h = Binary("-", compare.left, compare.right)
                for g in leaping(end.tangent.rows.moving(h)) if jumps else [h] if names(h) else []:
                    made = crossed(fields, segment, end, g, rule.said, loose=loose)
                    if isinstance(made, str):
                        grazed.append(made)
                    elif made is not None:
                        found.append(made)
    return found, grazed


def crossed(
    fields: Fields, segment: Segment, end: Field, h: Expr, text: str, *, loose: bool = False
) -> Crossing | str | None:
    """Return how a function crosses zero, its text if it only touches, None if it is not zero.

    `loose` takes also what is zero within rounding of its terms: crossings of very short motions.
    """
    rows = end.tangent.rows
    # until it fires, what a guard reads a priori is what there is
    made = rows.moving(h)
    value = float(Compiled([made]).at(end.at.values, 1)[0, 0])
    if not names(made) or not np.isfinite(value):
        return None
    read = Read(end.tangent, [made])
    slope = read.at(end.at, end.bonds)[0, 0]
    n = fields.columns.time
    speed = float(slope[:n] @ end.f[0, :n] + slope[n])
    length = max(float(segment.t[-1] - segment.t[0]), 1e-12 * abs(float(segment.t[-1])))
    largest, size = _sizes(fields, segment, made)
    terms = sum(
        abs(float(c) * float(np.ravel(end.at.values[name])[0]))
        for c, name in zip(slope[:n], fields.columns.states)
    )
    if largest * length <= STILL * (float(read.terms(end.at)[0]) + NEVER * terms):
        return None
    if abs(speed) <= GRAZES * max(largest, abs(speed)) or speed == 0.0:
        still = abs(value) <= 1e-7 * size and size > 0.0
        return text if still and largest > 0.0 else None
    near = max(CLOSE * length, LOCATED * float(segment.t[-1])) * abs(speed)
    if abs(value) > (max(near, ROUNDED * terms) if loose else near):
        return None
    if read.is_open(end.at):
        bonds = end.tangent.shared(end.at, end.bonds, read.asked(end.at))
        if bonds is None:
            raise Undetermined(f"{text}: the mode leaves open how what it reads is shared")
        slope = read.at(end.at, bonds)[0, 0]
        speed = float(slope[:n] @ end.f[0, :n] + slope[n])
    return _crossing(fields, slope, speed, text)


def _crossing(fields: Fields, slope: Vector, speed: float, text: str) -> Crossing:
    """Return how the instant moves at which something crosses zero with a speed."""
    n = fields.columns.time
    by = np.zeros(fields.size + len(fields.columns.parameters))
    by[:n] = -slope[:n] / speed
    by[fields.size :] = -slope[n + 1 :] / speed
    return Crossing(by, text)


def _sizes(fields: Fields, segment: Segment, made: Expr) -> tuple[float, float]:
    """Return the largest speed of a function within a segment, and its largest value."""
    field = fields.spread(segment)
    slope = Read(field.tangent, [made]).at(field.at, field.bonds)[:, 0]
    n = fields.columns.time
    speed = np.abs((slope[:, :n] * field.f[:, :n]).sum(axis=1) + slope[:, n]).max(initial=0.0)
    value = np.abs(Compiled([made]).at(field.at.values, field.at.points)).max(initial=0.0)
    return float(speed), float(value)


def _by_weights(fields: Fields, segment: Segment, end: Field) -> list[Crossing]:
    """Return the weight of sliding that reaches 0 or 1 at the end."""
    _, found_weights, found_slopes = fields.weights(segment, np.nextafter(segment.t[-1:], 0.0))
    weights, slopes = found_weights[0], found_slopes[0]
    ends = np.minimum(np.abs(weights), np.abs(1.0 - weights))
    if not (ends < 1e-3).any():
        return []
    n = fields.columns.time
    found = []
    for k in np.flatnonzero(ends < 1e-3).tolist():
        slope = slopes[k]
        speed = float(slope[:n] @ end.f[0, :n] + slope[n])
        if speed == 0.0:
            raise Undetermined("sliding ends without a weight that passes its end")
        found.append(_crossing(fields, slope, speed, "the end of sliding"))
    return found


def timed(fields: Fields, end: Field, t: float) -> list[Crossing]:
    """Return the edges of inputs and the comparisons of time that lie at an instant."""
    close = 1e-9 * t
    found = []
    for edge in fields.values.edges(t, close):
        found.append(
            Crossing(np.concatenate([np.zeros(fields.size), edge]), "an input has an edge")
        )
    for sample, by in due(fields, t):
        whole = np.concatenate([np.zeros(fields.size), by])
        found.append(Crossing(whole, f"{sample.path} is sampled"))
    return found + _by_time(fields, end, close)


def _by_time(fields: Fields, end: Field, close: float) -> list[Crossing]:
    """Return the comparisons of time that change their truth at an instant."""
    found = []
    for watch in fields.graph.watches:
        h = end.tangent.rows.made(Binary("-", watch.compare.left, watch.compare.right))
        value = float(Compiled([h]).at(end.at.values, 1)[0, 0])
        slope = Read(end.tangent, [h]).at(end.at, end.bonds)[0, 0]
        n = fields.columns.time
        if not slope[n] or abs(value) > close * abs(slope[n]):
            continue
        by = np.zeros(fields.size + len(fields.columns.parameters))
        by[fields.size :] = -slope[n + 1 :] / slope[n]
        found.append(Crossing(by, to_text(watch.compare)))
    return found
