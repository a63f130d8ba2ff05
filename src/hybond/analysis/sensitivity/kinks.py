"""Where laws bend or jump within a motion: comparisons in laws, corners of tables, magnitudes.

They are no events: the run ends a step there, just behind the crossing. Up to it the laws of the
left side hold, and where the field itself jumps the variations jump, too:

    d+ = d + (f- - f+) dtau
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.collocation import Jump
from hybond.analysis.sensitivity.crossing import SAME, Crossing, crossed
from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.gradients import Compiled
from hybond.analysis.sensitivity.last_kink import BESIDE as INSTANT
from hybond.analysis.sensitivity.last_kink import Kink
from hybond.analysis.sensitivity.tangent import Read, Undetermined
from hybond.model.expressions import Binary, Expr, comparisons, names, turning
from hybond.model.graph import Mode
from hybond.runs.trace import Segment

Vector = NDArray[np.float64]

BESIDE = 1e-6
"""Part of a step before its end at which the laws of the left side are read."""
THERE = 1e-3
"""Part of a step, at the most, from its end to what it was ended for."""
NO_JUMP = 1e-7
"""Part by which rates on both sides may differ and there is only a bend."""


def kinks_of(fields: Fields, segment: Segment) -> list[Kink]:
    """Return the kinks within a segment, in order."""
    if segment.sliding is not None or len(segment.t) < 3:
        return []
    at = fields.values.within(segment, segment.t)
    rows = fields.mode(segment.mode, at).rows
    turns, found = rows.turns, dict[int, Kink]()
    values = rows.turned.at(at.values, at.points)
    sign = np.sign(values)
    for k in np.flatnonzero((sign[:-1] * sign[1:] < 0.0).any(axis=1)).tolist():
        changed = np.flatnonzero(sign[k] * sign[k + 1] < 0.0).tolist()
        # the step ended behind what passes zero; what jumps over it is far from it on both sides
        ends = np.abs(values[k : k + 2, changed])
        parts = ends / np.abs(values[k + 1, changed] - values[k, changed])
        before, behind = parts.min(axis=1).tolist()
        j = k + 1 if behind <= before or before > THERE or k == 0 else k
        if j + 1 == len(segment.t):
            continue  # the end of the segment is a switch of its own
        t, step = float(segment.t[j]), float(segment.t[j] - segment.t[j - 1])
        off = min(before, behind)
        back = max(BESIDE * step, 4.0 * off * step if off <= THERE else 0.0, INSTANT * t)
        left = max(t - back, 0.5 * (float(segment.t[0]) + t))
        h = [turns[c] for c in changed]
        if j in found:
            left, h = max(left, found[j].left), [*found[j].h, *h]
        found[j] = Kink(t, left, tuple(dict.fromkeys(h)))
    return [found[j] for j in sorted(found)]


def jumped(fields: Fields, segment: Segment, kink: Kink) -> Jump | None:
    """Return what the jump of a law makes of the variations; None if it only bends."""
    back = kink.t - kink.left
    sides = np.array([kink.left - back, kink.left, kink.t, kink.t + back])
    field = fields.within(segment, np.minimum(sides, segment.t[-1]))
    before = 2.0 * field.f[1] - field.f[0]
    change = before - field.f[2]
    small = _is_small(change, before)
    leaps = fields.mode(segment.mode, field.at).rows.leaps
    if small and not any(h in leaps for h in kink.h):
        return None
    left = fields.within(segment, sides[1:2])
    found = passing(fields, segment, kink, replace(left, f=before[None]))
    if found is None and not small:
        raise Undetermined("a law jumps where it is only touched (grazing)")
    if isinstance(found, str) and not small:
        raise Undetermined(found)
    if not isinstance(found, Crossing):
        return None
    n = fields.size
    whole = np.eye(n, len(found.by)) + np.outer(change, found.by)
    return Jump(kink.t, whole[:, :n], whole[:, n:], found.by[:n], found.by[n:])


def jumps_at_end(fields: Fields, segment: Segment, kink: Kink) -> Crossing | str | None:
    """Return how a jump at the very end of a segment moves, which the motion has not made yet.

    None where laws only bend there; why it cannot be told how it moves.
    """
    left = fields.within(segment, np.array([kink.left]))
    there = fields.values.within(segment, np.array([kink.t]))
    mode = fields.mode(segment.mode, there)
    passed = Compiled(kink.h)
    if (passed.at(there.values, 1) * passed.at(left.at.values, 1) < 0.0).any():
        if _is_small(left.f[0] - mode.field(there).f[0], left.f[0]):
            return None
    elif not any(h in mode.rows.leaps for h in kink.h):
        return None
    return passing(fields, segment, kink, left)


def passing(fields: Fields, segment: Segment, kink: Kink, left: Field) -> Crossing | str | None:
    """Return how the instant of a kink moves; None where all is only touched, or why there is none.

    What is not zero on the left side has jumped over it, because something else passes.
    """
    found = [crossed(fields, segment, left, h, "a law jumps") for h in kink.h]
    passed = [c for c in found if isinstance(c, Crossing)]
    for other in passed[1:]:
        both = np.abs(passed[0].by) + np.abs(other.by)
        if (np.abs(passed[0].by - other.by) > SAME * both.max(initial=0.0)).any():
            return "two laws bend at one instant: which comes first would change"
    return passed[0] if passed else None


def _is_small(change: Vector, before: Vector) -> bool:
    return bool((np.abs(change) <= NO_JUMP * (np.abs(before) + np.abs(before - change))).all())


def edges_at(fields: Fields, field: Field, mode: Mode, d: Vector) -> list[tuple[str, list[str]]]:
    """Return what is zero where a run starts and moves with a parameter: its text, and by which.

    There are other laws on the other side, and derivatives are those to one side.

    Parameters
    ----------
    field : Field
        At the start, in `mode`.
    d : array, shape (states, parameters)
        The variations there.
    """
    rows, graph, known = field.tangent.rows, fields.graph, fields.values.found
    texts: dict[Expr, str] = {}
    for machine, state in zip(graph.machines, mode, strict=True):
        for rule in machine.rules:
            for compare in comparisons(rule.guard) if rule.source == state else ():
                h = rows.moving(Binary("-", compare.left, compare.right))
                texts.setdefault(h, f"{rule.said} of {machine.path}")
    for e in (*rows.rows, *rows.rates):
        for h in turning(e):
            texts.setdefault(h, "a law that bends")
    found: dict[str, list[str]] = {}
    moves = np.vstack([d, np.zeros((1, d.shape[1])), np.eye(d.shape[1])])
    for h, text in texts.items():
        if not any(not n.startswith("p:") for n in names(h)):
            continue
        if Compiled([h]).at(field.at.values, 1)[0, 0] != 0.0:
            continue
        slope = Read(field.tangent, [h]).at(field.at, field.bonds)[0, 0]
        size = (np.abs(slope)[:, None] * np.abs(moves)).max(axis=0, initial=0.0)
        by = np.flatnonzero(np.abs(slope @ moves) > NO_JUMP * size).tolist()
        if by:
            found[text] = sorted({*found.get(text, ()), *(known.names[k] for k in by)})
    return list(found.items())
