"""Which contacts of a run close with a gap below zero: from the start on, or by a jump.

A contact is closed where its gap is not positive, and then holds: bodies that overlap stay so, as
if the floor were where they are. A height with a lost sign looks like that, and so does a block
that runs against a stair.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hybond.model.expressions import Expr, Name, Number, jumping, names
from hybond.model.expressions.tree import walk

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hybond.result import Result

    Indices = NDArray[np.intp]
    Vector = NDArray[np.float64]

ROUNDING = 1e-9
"""Part of what a gap is made of below which it counts as zero."""
APART, AT_ONCE, WIDER = 1e-6, 0.5, 10
"""The same within a run; part of a fall that a jump is at once, of that in a time so many halvings
longer."""
HALVINGS = 60
"""Of the time between two steps in which a jump is looked for."""


def told_of_overlaps(run: Result) -> tuple[str, ...]:
    """Return a warning for each contact whose gap is below zero where a run begins, or jumps there.

    Parameters
    ----------
    run : Result
        Any run; nothing is read where no contact has a gap.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("below", domain="translational")
    >>> m.add(m=hb.I(1), W=hb.Se(-9.81), v=hb.One(), floor=hb.Zero(law="unilateral", gap="h"))
    >>> m.bond("W -> v -> m", "floor -> v")
    >>> m.signal(h=hb.Integral("v.f", start="-1 m"))
    >>> hb.simulate(m, until="1 s").warnings[0][:45]
    "the gap of 'floor' is -1 where the run begins"
    """
    contacts = [m for m in run.graph.machines if m.law is not None and m.law.gap is not None]
    if not contacts or not len(run.segments):
        return ()
    begin = np.array([float(run.segments[0].t[0])])
    sampled = {f"s:{k}" for sample in run.graph.samples for k in sample.signals}
    found = []
    for machine in contacts:
        assert machine.law is not None and machine.law.gap is not None
        gap = machine.law.gap
        value, terms = (float(y[0]) for y in _seen(run, gap, np.zeros(1, dtype=int), begin))
        if value < -ROUNDING * terms:
            found.append(
                f"the gap of {machine.path!r} is {value:.4g} where the run begins: what "
                "overlaps then stays so, and the contact holds it; look at the sign of its start"
            )
        elif jumping(gap) or any(n[:2] in ("u:", "in", "at") or n in sampled for n in names(gap)):
            found += _jumped_into(run, machine.path, gap)
    return tuple(found)


def _seen(run: Result, gap: Expr, which: Indices, t: Vector) -> tuple[Vector, Vector]:
    """Return a gap, and the size of what it is made of, at points of segments."""
    parts = [gap, *(e for e, _ in walk(gap) if isinstance(e, Name | Number))]
    value, *made_of = run._of(parts, which, t)
    return value, np.sum(np.abs(made_of), axis=0)


def _jumped_into(run: Result, path: str, gap: Expr) -> list[str]:
    """Return a warning of a gap that jumps to below zero between two steps, if one does."""
    many = [len(s.t) for s in run.segments]
    t = np.concatenate([s.t for s in run.segments])
    last = np.diff(t, append=np.inf) > 0.0
    t, which = t[last], np.repeat(np.arange(len(many)), many)[last]
    value, terms = _seen(run, gap, which, t)
    least = APART * terms
    fell = np.flatnonzero((value < -least) & (-np.diff(value, prepend=value[0]) > least))
    jumped = fell[_fall_at_once(run, gap, which, t, value, fell) > least[fell]]
    return [
        f"the gap of {path!r} jumps to {value[k]:.4g} at t = {t[k]:.6g} s: what overlaps then "
        "stays so, and the contact holds it; a step in a floor is a wall, with a contact of its own"
        for k in jumped[:1]
    ]


def _fall_at_once(
    run: Result, gap: Expr, which: Indices, t: Vector, value: Vector, at: Indices
) -> Vector:
    """Return by how much a gap falls in no time before points of a run; 0: it does so in some.

    The time since the point before is halved, again and again, to where the gap falls most: what
    jumps does so in the last of these as in longer ones, however long the steps were.
    """
    low, high, above, below = t[at - 1], t[at], value[at - 1], value[at]
    falls = [above - below]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        there = _seen(run, gap, which[at - 1], middle)[0]
        early = above - there >= there - below
        low, above = np.where(early, low, middle), np.where(early, above, there)
        high, below = np.where(early, middle, high), np.where(early, there, below)
        falls.append(above - below)
    return np.where(falls[-1] > AT_ONCE * falls[-1 - WIDER], falls[-1], 0.0)
