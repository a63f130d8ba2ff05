"""Where the modes around a surface meet: their constraints together, kept by their impulses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.equations.storage import StorageLaws
from hybond.modes.jump import impulse_directions
from hybond.programs.common_space import CommonSpace

Matrix = NDArray[np.float64]

REPEATS = 1e-10
"""Impulses of several modes may repeat each other: one that moves what is stored by less than this
part of the strongest is rounding of such a repetition."""


def meet(parts: Sequence[ModeEquations]) -> CommonSpace | None:
    """Return what all of `parts` hold together; None if each of them holds to the same.

    None as well where a constraint passes a modulated two-port or a controlled source: `meets`
    tells such modes apart.
    """
    if len({held_to(e) for e in parts}) < 2 or not meets(parts):
        return None
    holders: list[ModeEquations] = []
    rows: list[Matrix] = []
    ways: list[Matrix] = []
    seen: set[object] = set()
    for e in parts:
        if not e.tableau.constraints or held_to(e) in seen:
            continue
        seen.add(held_to(e))
        first = e.tableau.unknowns
        own = np.zeros((len(e.tableau.constraints), e.tableau.knowns))
        for row, given in zip(own, e.tableau.constraints, strict=True):
            for k, c in given.items():
                row[k - first] = c
        holders.append(e)
        rows.append(own)
        ways.append(impulse_directions(e, [0.0] * (2 * e.slots.size)))
    directions = _moving(np.hstack(ways), holders[0].storage)
    return CommonSpace(holders, rows, directions, holders[0].storage.rates_of(directions))


def meets(parts: Sequence[ModeEquations]) -> bool:
    """Whether the constraints of some modes are linear with constant coefficients."""
    return not any(
        e.structure or any(not r.impulse_free and r.kind != "hidden" for r in e.rows) for e in parts
    )


def held_to(e: ModeEquations) -> object:
    """Return what tells the state space of a mode from that of another."""
    last = e.tableau.unknowns + len(e.graph.storages)
    rows = [{k: c for k, c in r.items() if k < last} for r in e.tableau.constraints]
    return e.rank - len(e.structure), *sorted(tuple(sorted(r.items())) for r in rows)


def _moving(directions: Matrix, storage: StorageLaws) -> Matrix:
    """Return the impulses that move what is stored, without those that repeat others."""
    moves = storage.rates_of(directions)
    _, values, vt = np.linalg.svd(moves, full_matrices=False)
    rank = int((values > REPEATS * max(float(values.max(initial=0.0)), 1e-300)).sum())
    return np.asarray(directions @ vt[:rank].T)
