"""Where laws bend or jump within a motion: comparisons in laws, corners of tables, magnitudes.

They are no events: the run ends a step there, just behind the crossing. Up to it the laws of the
left side hold, and where the field itself jumps the variations jump, too:

    d+ = d + (f- - f+) dtau
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.collocation import Jump
from hybond.analysis.sensitivity.crossing import crossed
from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.gradients import Compiled
from hybond.analysis.sensitivity.tangent import Read, Undetermined
from hybond.model.expressions import Binary, Expr, comparisons, names, turning
from hybond.model.graph import Mode
from hybond.runs.trace import Segment

Vector = NDArray[np.float64]

BESIDE = 1e-6
"""Part of a step before its end at which the laws of the left side are read."""
NO_JUMP = 1e-7
"""Part by which rates on both sides may differ and there is only a bend."""


@dataclass(frozen=True, slots=True)
class Kink:
    """A point within a motion where a law bends or jumps.

    Parameters
    ----------
    t : float
        The accepted point behind it, s.
    left : float
        A time before it that is close, s.
    h : Expr
        What changes its sign.
    """

    t: float
    left: float
    h: Expr


def kinks_of(fields: Fields, segment: Segment) -> list[Kink]:
    """Return the kinks within a segment, in order."""
    if segment.sliding is not None or len(segment.t) < 3:
        return []
    at = fields.values.within(segment, segment.t)
    rows = fields.mode(segment.mode, at).rows
    every = {h: None for e in (*rows.rows, *rows.rates) for h in turning(e)}
    turns = [h for h in every if any(not n.startswith("p:") for n in names(h))]
    found: dict[int, Kink] = {}
    values = Compiled(turns).at(at.values, at.points)
    for h, column in zip(turns, values.T, strict=True):
        sign = np.sign(column)
        for k in np.flatnonzero(sign[:-1] * sign[1:] < 0.0).tolist():
            if k + 2 == len(segment.t):
                continue  # the end of the segment is a switch of its own
            j = k + 1 if abs(column[k + 1]) <= abs(column[k]) or k == 0 else k
            step = float(segment.t[j] - segment.t[j - 1])
            off = abs(column[j]) / max(abs(column[j] - column[j - 1]), 1e-300) * step
            left = float(segment.t[j]) - max(BESIDE * step, 4.0 * off)
            if j in found and found[j].h != h:
                raise Undetermined("two laws bend at one instant: which comes first would change")
            found[j] = Kink(float(segment.t[j]), left, h)
    return [found[j] for j in sorted(found)]


def jumped(fields: Fields, segment: Segment, kink: Kink) -> Jump | None:
    """Return what the jump of a law makes of the variations; None if it only bends."""
    back = kink.t - kink.left
    sides = np.array([kink.left - back, kink.left, kink.t, kink.t + back])
    field = fields.within(segment, np.minimum(sides, segment.t[-1]))
    before = 2.0 * field.f[1] - field.f[0]
    after = field.f[2]
    size = np.abs(before) + np.abs(after)
    change = before - after
    if (np.abs(change) <= NO_JUMP * size).all():
        return None
    left = fields.within(segment, sides[1:2])
    moved = Field(left.at, before[None], left.slopes, left.bonds, left.tangent)
    found = crossed(fields, segment, moved, kink.h, "a law jumps")
    if found is None or isinstance(found, str):
        raise Undetermined("a law jumps where it is only touched (grazing)")
    n = fields.size
    whole = np.eye(n, len(found.by)) + np.outer(change, found.by)
    return Jump(kink.t, whole[:, :n], whole[:, n:], found.by[:n], found.by[n:])


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
                texts.setdefault(h, f"{rule.text} of {machine.path}")
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
