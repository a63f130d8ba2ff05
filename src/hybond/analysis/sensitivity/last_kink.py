"""The kink at the very end of a motion: up to it, laws are those on its left side.

A run ends where it is told to, and a segment where an event is; what jumps with time there, or with
what follows it, reads as it is after its jump, or before it, as rounding has it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hybond.model.expressions import Expr
from hybond.runs.trace import Segment

if TYPE_CHECKING:
    from hybond.analysis.sensitivity.fields import Fields

BESIDE = 2.5e-12
"""Part of a time before the end at which the left side is read; a quarter of what locates events"""


@dataclass(frozen=True, slots=True)
class Kink:
    """A point within a motion where laws bend or jump.

    Parameters
    ----------
    t : float
        The accepted point behind it, s.
    left : float
        A time before it that is close, s.
    h : tuple of Expr
        What changes its sign: what passes zero, and what jumps over it.
    """

    t: float
    left: float
    h: tuple[Expr, ...]


def ends_at(fields: Fields, segment: Segment) -> Kink | None:
    """Return the kink that lies at the very end of a segment, if there is one.

    Its laws are then those on the left side of it up to the end, as far as time can be told.
    """
    if segment.sliding is not None or segment.bonds is not None or len(segment.t) < 2:
        return None
    end = float(segment.t[-1])
    near = min(BESIDE * abs(end), 0.5 * (end - float(segment.t[-2])))
    at = fields.values.within(segment, np.array([end - near, end]))
    rows = fields.mode(segment.mode, at).rows
    turns = rows.turns
    if not turns:
        return None
    before, there = rows.turned.at(at.values, 2)
    # what passes zero goes on as it came; nobody has seen what is beyond the end of a run
    behind = 2.0 * there - before
    changed = (before * there <= 0.0) | (before * behind < 0.0)
    passed = [turns[k] for k in np.flatnonzero(changed & (before != 0.0)).tolist()]
    return Kink(end, end - near, tuple(passed)) if passed else None
