"""Energy that goes into each element while time passes: integrals of effort times flow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.measures.pieces import Known, Pieces, Size, resolved, steps_of
from hybond.measures.window import TOLERANCE, Window
from hybond.model.expressions import Name
from hybond.model.graph import FlatGraph, Node
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]

AT_ONCE = 4_000_000
"""Numbers that are integrated at once."""


def check_located(run: Result) -> None:
    """Refuse a run of time-stepping.

    Raises
    ------
    UsageError
        HB-R113: its steps do not tell jumps from motion.
    """
    if run.segments and run.segments[0].bonds is not None:
        raise UsageError(
            "steps of time-stepping do not tell what is lost in jumps from what is dissipated",
            code="HB-R113",
            where="losses",
            hint="take a solver that locates events; run.energies and run.audit know the totals",
        )


def power_nodes(graph: FlatGraph) -> list[Node]:
    """Return the elements that give or take energy, those on pseudo bonds left out."""
    return [
        n
        for n in graph.nodes
        if not n.is_junction
        and n.kind not in ("TF", "GY")
        and n.ends
        and not any(graph.bonds[end.bond].domain.pseudo for end in n.ends)
    ]


@dataclass(frozen=True, slots=True)
class Passed:
    """Energy that went into elements over stretches of a window.

    Parameters
    ----------
    low, high : arrays, shape (n,)
        s.
    energy : array, shape (elements, n)
        J.
    """

    low: Vector
    high: Vector
    energy: Vector

    @property
    def total(self) -> Vector:
        """J, shape (elements,)."""
        return np.asarray(self.energy.sum(axis=1))


def energies_into(
    run: Result,
    nodes: Sequence[Node],
    window: Window,
    *,
    parts: int = 0,
    tolerance: float = TOLERANCE,
) -> Passed:
    """Return the energy that goes into elements while time passes.

    Parameters
    ----------
    parts : int
        Stretches that are even, besides the steps of the run.
    tolerance : float
        As a part of the energy that passes through the largest of them.

    Raises
    ------
    NumericsError
        HB-R103, HB-R104.
    """
    bonds = sorted({end.bond for n in nodes for end in n.ends})
    place = {b: k for k, b in enumerate(bonds)}
    signs = np.zeros((len(nodes), len(bonds)))
    for k, n in enumerate(nodes):
        for end in n.ends:
            signs[k, place[end.bond]] += end.sign

    def rows(pieces: Pieces) -> Vector:
        t = pieces.times()
        powers = _powers(run, bonds, np.repeat(pieces.segment, t.shape[1]), t.ravel())
        return np.asarray((signs @ powers).reshape(len(nodes), *t.shape))

    steps = steps_of(run, window, parts)
    if not nodes:
        # a model without bonds of power, all of them pseudo
        return Passed(steps.low, steps.high, np.zeros((0, len(steps))))
    known: list[Known] = []
    stretches = list(_stretches(steps, len(bonds)))
    sizes: dict[int, Size] = {}

    def others(k: int) -> Size | None:
        """Return what passes in all stretches but one: next to nothing is a part of that."""
        for j, stretch in enumerate(stretches):
            if j not in sizes:
                sizes[j] = Size.of(rows, stretch)
        return Size.joined([size for j, size in sizes.items() if j != k])

    for k, stretch in enumerate(stretches):
        found = resolved(
            *(rows, stretch),
            name="power",
            shared=len(nodes),
            tolerance=tolerance,
            beside=partial(others, k) if len(stretches) > 1 else None,
        )
        known.append(found)
    return Passed(
        np.concatenate([p.pieces.low for p in known]),
        np.concatenate([p.pieces.high for p in known]),
        np.concatenate([p.of_pieces() for p in known], axis=1),
    )


def _stretches(pieces: Pieces, bonds: int) -> Iterator[Pieces]:
    many = max(AT_ONCE // (22 * max(bonds, 1)), 1)
    for k in range(0, len(pieces), many):
        chosen = np.zeros(len(pieces), dtype=bool)
        chosen[k : k + many] = True
        yield pieces.part(chosen)


def _powers(run: Result, bonds: Sequence[int], segment: NDArray[np.intp], t: Vector) -> Vector:
    """Return effort times flow of bonds at points of segments, shape (bonds, points)."""
    asked = np.unique(segment)
    sliding = [
        k for k in asked.tolist() if run.trace.slidings and run.segments[k].sliding is not None
    ]
    names = [Name(f"{v}:{b}") for v in "ef" for b in bonds]
    if not sliding:
        values = np.array(run._of(names, segment, t))
        values = values.reshape(2, len(bonds), len(t))
        return np.asarray(values[0] * values[1])
    found = np.zeros((len(bonds), len(t)))
    for k in asked.tolist():
        own = segment == k
        found[:, own] = run.signals_of(k).powers(run.segments[k], bonds, t[own])
    return found
