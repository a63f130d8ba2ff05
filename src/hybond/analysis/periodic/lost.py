"""How many directions a period loses: by the switches that it passes, not by how small they become.

Motion within a mode loses none, however fast it settles: its map is an exponential, which has an
inverse. What loses some is a map of a switch (storage that follows other storage, a diode that
blocks, friction that holds, a plastic impact), whose rank is told of that map alone. So the image
of all directions is carried through the period, through motions shortened until they hardly
shrink anything, and through switches with all that they keep made equally long; what is left
after as many periods as it takes is not lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.chain import Chain
from hybond.analysis.sensitivity.collocation import Jump, VariationStep
from hybond.analysis.sensitivity.exponential import grown
from hybond.analysis.sensitivity.fields import Fields
from hybond.analysis.sensitivity.flow import MatrixStep
from hybond.result import Result

Vector = NDArray[np.float64]

NOTHING = 1e-11
"""Part of the terms of the scaled map of a switch that is left where they cancel."""
GONE = 1e-9
"""Length of a direction that is carried along, of one at first, that is none any more."""
SHORT = 0.5
"""How large the matrix of a motion is made at the most."""


def lost_directions(
    run: Result, chain: Chain, fields: Fields, sizes: Vector, kept: Sequence[int]
) -> int:
    """Return how many directions are lost within a period, for structure.

    Parameters
    ----------
    sizes : array, shape (n,)
        What states are measured by.
    kept : sequence of int
        States that come back.
    """
    place, unit = list(kept), sizes[list(kept)]

    def scaled(M: Vector) -> Vector:
        return np.asarray(M[np.ix_(place, place)] * unit / unit[:, None])

    maps: list[Vector | _Limit] = [_alike(scaled(chain.start[:, : len(sizes)]))]
    motions: list[VariationStep | MatrixStep] = []
    before: list[int] = []
    for link in chain.links:
        if isinstance(link, VariationStep | MatrixStep):
            motions.append(link)
            before.append(len(maps))
            continue
        if motions:
            maps.append(_shortened(scaled(_rates(run, fields, motions))))
            motions = []
        before.append(len(maps))
        if isinstance(link, Jump):
            maps.append(_alike(scaled(link.S)))
        else:
            at, impact = link.last
            by, row = link.by_last[place] / unit, impact.time[place] * unit
            maps.append(_Limit(scaled(link.S), by, row, before[at]))
    if motions:
        maps.append(_shortened(scaled(_rates(run, fields, motions))))
    basis = np.eye(len(place))
    while basis.shape[1]:
        image = _carried(maps, basis)
        if image.shape[1] == basis.shape[1]:
            break
        basis = image
    return len(place) - basis.shape[1]


@dataclass(frozen=True, slots=True)
class _Limit:
    """The limit of impacts: a map of what is there, and of what was there before the last one."""

    S: Vector
    by: Vector
    row: Vector
    before: int


def _rates(run: Result, fields: Fields, motions: Sequence[VariationStep | MatrixStep]) -> Vector:
    """Return the mean of the matrix of the variations over a motion."""
    n = fields.columns.time
    total, long = np.zeros((n, n)), 0.0
    for link in motions:
        h = link.t1 - link.t0
        if isinstance(link, VariationStep):
            A = link.A.mean(axis=0)
        else:
            middle = 0.5 * (link.t0 + link.t1)
            segment = next(s for s in run.segments if s.t[0] <= middle <= s.t[-1])
            A = fields.within(segment, np.array([middle])).slopes[0, :, :n]
        total, long = total + h * A[:n, :n], long + h
    return total / long if long > 0.0 else total


def _shortened(A: Vector) -> Vector:
    """Return the map of a motion that is so short that it hardly shrinks anything."""
    size = float(np.linalg.norm(A, 2)) if A.size else 0.0
    return np.eye(len(A)) + (grown(A[None] * (SHORT / size))[0] if size > 0.0 else 0.0)


def _alike(S: Vector) -> Vector:
    """Return a map that loses what another one does, and keeps the length of all else."""
    u, _, v = np.linalg.svd(S)
    rank = rank_of(S)
    return np.asarray(u[:, :rank] @ v[:rank])


def rank_of(S: Vector) -> int:
    """Return the rank of the map of a switch in scaled states, which is 1 where nothing happens.

    By elimination with the largest pivots: what is left of terms that cancel is nothing, however
    large other entries are, as those of an impact that hardly touches.

    Examples
    --------
    >>> import numpy as np
    >>> rank_of(np.array([[-0.2, 1e6], [0.0, -0.2]])), rank_of(np.array([[1e-16, 0.0], [0.0, 1.0]]))
    (2, 1)
    """
    left, terms = S.copy(), np.maximum(np.abs(S), 1.0)
    rank = 0
    while left.size:
        i, j = divmod(int(np.argmax(np.abs(left) / terms)), left.shape[1])
        if abs(left[i, j]) <= NOTHING * terms[i, j]:
            break
        taken = np.outer(left[:, j], left[i]) / left[i, j]
        left, terms = left - taken, terms + np.abs(taken)
        left = np.delete(np.delete(left, i, axis=0), j, axis=1)
        terms = np.delete(np.delete(terms, i, axis=0), j, axis=1)
        rank += 1
    return rank


def _carried(maps: Sequence[Vector | _Limit], basis: Vector) -> Vector:
    """Return an orthonormal basis of what a period makes of the span of another one."""
    found = [basis]
    for made in maps:
        now = found[-1]
        if isinstance(made, _Limit):
            now = made.S @ now + np.outer(made.by, made.row @ found[made.before])
        else:
            now = made @ now
        u, values, v = np.linalg.svd(now, full_matrices=False)
        rank = int((values > GONE).sum())
        turn = v[:rank].T / values[:rank]
        found = [own @ turn for own in found]
        found.append(u[:, :rank])
    return found[-1]
