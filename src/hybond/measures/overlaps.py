"""Which contacts of a run begin closed with a gap below zero: a start that is seldom meant.

A contact is closed where its gap is not positive, and then holds: bodies that overlap at the start
stay so, as if the floor were where they are. A height with a lost sign looks like that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hybond.model.expressions import Name, Number
from hybond.model.expressions.tree import walk

if TYPE_CHECKING:
    from hybond.result import Result

ROUNDING = 1e-9
"""Part of what a gap is made of below which it counts as zero."""


def told_of_overlaps(run: Result) -> tuple[str, ...]:
    """Return a warning for each contact whose gap is below zero where a run begins.

    Parameters
    ----------
    run : Result
        Any run; nothing is read where no contact has a gap.

    Returns
    -------
    tuple of str

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
    found = []
    for machine in contacts:
        assert machine.law is not None and machine.law.gap is not None
        parts = [machine.law.gap]
        parts += [e for e, _ in walk(machine.law.gap) if isinstance(e, Name | Number)]
        values = [float(y[0]) for y in run._of(parts, [0], begin)]
        if values[0] < -ROUNDING * sum(map(abs, values[1:])):
            found.append(
                f"the gap of {machine.path!r} is {values[0]:.4g} where the run begins: what "
                "overlaps then stays so, and the contact holds it; look at the sign of its start"
            )
    return tuple(found)
