"""The signals that records name: what a person calls the variables of a graph."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.model.graph import FlatGraph

Vector = NDArray[np.float64]


def impulse_floor(
    graph: FlatGraph, impulses: Vector, reach: Vector, x: Vector, after: Vector, rtol: float
) -> Vector:
    """Return the size below which each bond variable's impulse counts as zero.

    ``rtol * S``: S is the largest stored quantity of its kind (momentum for efforts, displacement
    for flows) in the bond's domain, or the largest such impulse if nothing is stored there.

    Parameters
    ----------
    impulses : array, shape (2 * bonds,)
    reach : array, shape (storages,)
        What each storage would hold if it had all the energy that the run has seen: a mass that
        stands still but for rounding is measured by the spring that moved it.
    x, after : array, shape (storages,)
        Stored quantities before and after the jump.
    """
    bonds = len(graph.bonds)
    largest: dict[tuple[str, int], float] = {}

    def note(domain: str, kind: int, value: float) -> None:
        largest[domain, kind] = max(largest.get((domain, kind), 0.0), abs(value))

    for s in graph.storages:
        domain = graph.bonds[s.bond].domain.name
        for value in (reach, x, after):
            note(domain, 0 if s.kind == "I" else 1, float(value[s.index]))
    for b in graph.bonds:
        note(b.domain.name, 0, float(impulses[b.index]))
        note(b.domain.name, 1, float(impulses[bonds + b.index]))
    return rtol * np.array(
        [largest[b.domain.name, 0] for b in graph.bonds]
        + [largest[b.domain.name, 1] for b in graph.bonds]
    )
