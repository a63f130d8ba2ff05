"""Whether anything takes power from motions near another one, or gives them some.

Of variations Tellegen's theorem holds as of motions: what storage takes, sum dy dx' over all of it
(x what is stored, y its effort or flow), is what resistances and sources give. Where that is
nothing all along, whatever the variation, a pair of multipliers is on the unit circle because
nothing damps it, and not because losses and gains happen to be equal over a period.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.chain import Chain
from hybond.analysis.sensitivity.collocation import Jump, VariationStep
from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.flow import MatrixStep
from hybond.result import Result

Vector = NDArray[np.float64]

INSTANTS = 24
"""At which it is looked."""
NOTHING = 1e-8
"""Part of what storage gives and takes that may be left over."""
SAME = 1e-12
"""Part by which variations differ that a switch leaves as they are."""


def takes_nothing(run: Result, chain: Chain, fields: Fields, basis: Vector) -> bool:
    """Return whether storage keeps the power of all variations that begin as columns of a basis.

    Parameters
    ----------
    basis : array, shape (n, many)
    """
    n = len(basis)
    found = [d[:n, :n] @ basis for d in chain.forward()]
    motions = [
        k for k, link in enumerate(chain.links) if isinstance(link, VariationStep | MatrixStep)
    ]
    for k, link in enumerate(chain.links):
        if isinstance(link, VariationStep | MatrixStep):
            continue
        moved = np.abs(found[k + 1] - found[k]).max(axis=1, initial=0.0)
        if (moved <= SAME * np.abs(found[k]).max(axis=1, initial=0.0)).all():
            continue
        if not isinstance(link, Jump) or not _passes(run, fields, link, found[k], found[k + 1]):
            return False
    moves = False
    for k in motions[:: max(1, len(motions) // INSTANTS)]:
        link = chain.links[k]
        assert isinstance(link, VariationStep | MatrixStep)
        segment = next((s for s in run.segments if s.t[0] <= link.t0 < s.t[-1]), None)
        if segment is None:
            return False
        field = fields.within(segment, np.array([link.t0]))
        y, sign = _efforts(fields, field, found[k]), _signs(fields)
        rates = field.slopes[0, : len(y), :n] @ found[k]
        left = (sign[:, None] * y).T @ rates
        size = float((np.abs(y).max(axis=1) * np.abs(rates).max(axis=1)).sum())
        if (np.abs(left + left.T) > NOTHING * size).any():
            return False
        moves = moves or size > 0.0
    return moves


def _passes(run: Result, fields: Fields, jump: Jump, before: Vector, after: Vector) -> bool:
    """Return whether storage has the same energy of variations on both sides of a switch."""
    sides = []
    for d, ends in ((before, True), (after, False)):
        own = [s for s in run.segments if (s.t[0] < jump.t <= s.t[-1] if ends else
                                           s.t[0] <= jump.t < s.t[-1])]  # fmt: skip
        if not own:
            return False
        y = _efforts(fields, fields.within(own[0], np.array([jump.t])), d)
        sides.append((_signs(fields)[:, None] * y).T @ d[: len(y)])
    size = NOTHING * float(np.abs(sides[0]).max(initial=0.0))
    return bool((np.abs(sides[1] - sides[0]) <= size).all())


def _efforts(fields: Fields, field: Field, d: Vector) -> Vector:
    """Return how what storage answers with is varied: the effort of C, the flow of I."""
    rows, graph = field.tangent.rows.bonds, fields.graph
    names = [("e:" if s.kind == "C" else "f:") + str(s.bond) for s in graph.storages]
    own = [rows.index(name) for name in names]
    return np.asarray(field.bonds[0, own, : len(d)] @ d)


def _signs(fields: Fields) -> Vector:
    return np.array([1.0 if s.kind == "I" else float(s.sign) for s in fields.graph.storages])
