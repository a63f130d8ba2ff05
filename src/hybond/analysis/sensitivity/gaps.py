"""Contacts at rest: variations that leave the gap closed.

A mode at rest holds speeds together, and a variation of the gap would stay as it is. But a state
with a gap comes back to the contact, and one with less than none there is not: variations are put
onto the gap's own surface, along the way on which the contact moves what it pushes.

    d <- d - E (C E)^-1 (C d + C_p dp)      C: the gap's slopes, E = A (1 - S): where impulses lead
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.tangent import Read

Vector = NDArray[np.float64]

MOVED = 1e-9
"""Part of the largest by which impulses move a gap at the least, or it is another's."""


def closing(fields: Fields, contacts: Sequence[int], free: Field, entry: Vector) -> Vector | None:
    """Return what variations are less by, as a matrix for states and parameters.

    Parameters
    ----------
    contacts : sequence of int
        Machines of contacts with a gap.
    free : Field
        Where they are open.
    entry : array, shape (n, n)
        What closing them makes of the variations of what is stored.

    Returns
    -------
    array, shape (n, n + parameters), or None
        None where impulses do not move each gap by itself.
    """
    n = fields.columns.time
    laws = [fields.graph.machines[k].law for k in contacts]
    gaps = [free.tangent.rows.moving(law.gap) for law in laws if law is not None and law.gap]
    slopes = Read(free.tangent, gaps).at(free.at, free.bonds)[0]
    E = free.slopes[0, :n, :n] @ (np.eye(n) - entry)
    moved = slopes[:, :n] @ E
    largest = float(np.abs(moved).max(initial=0.0))
    if not largest or np.linalg.matrix_rank(moved, MOVED * largest) < len(gaps):
        return None
    apart = np.delete(slopes, n, axis=1)
    return np.asarray(E @ np.linalg.pinv(moved) @ apart)


def has_gap(fields: Fields, machine: int) -> bool:
    """Whether a machine is a contact that is closed at a distance."""
    law = fields.graph.machines[machine].law
    return law is not None and law.kind == "unilateral" and law.gap is not None
