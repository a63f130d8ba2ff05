"""`Branch`: what came of all values, each begun alone or carried on from its neighbour."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.sections import Carry
from hybond.errors import HybondError
from hybond.sweep.bifurcation.orbits import Orbit, orbit_of
from hybond.sweep.bifurcation.values import Point, Values

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Branch:
    """What came of all values of the parameter, in one direction.

    Parameters
    ----------
    direction : str
        ``fresh``: each value begins as the model does; ``up``, ``down``: where the one before has
        come, which is the next smaller or greater one.
    samples : mapping of str to array, shape (values, samples)
        Of each signal; nan where there are fewer.
    when : array, shape (values, samples)
        s.
    period : array of int, shape (values,)
        In samples; 0: none, -1: the run has stopped, or was not made.
    settled : array of bool, shape (values,)
        Whether it repeats within the tolerance; else differences still shrink.
    events : array, shape (values,)
        Modes entered from a sample to the next, on average.
    sequence : tuple of str
        The modes of one turn, for each value.
    errors : mapping of int to HybondError
    warnings : mapping of int to tuple of str
    """

    direction: str
    samples: Mapping[str, Vector]
    when: Vector
    period: NDArray[np.intp]
    settled: NDArray[np.bool_]
    events: Vector
    sequence: tuple[str, ...]
    errors: Mapping[int, HybondError]
    warnings: Mapping[int, tuple[str, ...]]
    orbits: tuple[Orbit | None, ...] = field(repr=False)
    carries: tuple[Carry | None, ...] = field(repr=False)
    scale: Vector = field(repr=False)

    def orbit_of(self, point: Point, values: Values) -> Orbit | None:
        """Return the orbit of a point, held against the scale of this branch."""
        return _orbit(point, values, self.scale)

    def __repr__(self) -> str:
        return f"<Branch {self.direction}: {len(self.period)} values>"


def _orbit(point: Point, values: Values, scale: Vector) -> Orbit | None:
    q = values.question
    if point.error is not None or point.samples.shape[1] < 2:
        return None
    return orbit_of(point.samples, point.words, scale, q.tolerance, q.longest)


def branch_of(values: Values, direction: str, points: Sequence[Point | None]) -> Branch:
    """Return a branch of the points of all values; None for those that were not run."""
    q, many = values.question, len(points)
    samples = np.full((len(q.of), many, q.cut.keep), np.nan)
    when = np.full((many, q.cut.keep), np.nan)
    for k, point in enumerate(points):
        if point is not None:
            n = point.samples.shape[1]
            samples[:, k, :n], when[k, :n] = point.samples, point.when
    there = np.abs(np.where(np.isfinite(samples), samples, 0.0))
    scale = there.max(axis=(1, 2))
    orbits = tuple(None if p is None else _orbit(p, values, scale) for p in points)
    return Branch(
        direction,
        dict(zip(q.of, samples, strict=True)),
        when,
        np.array([-1 if o is None else o.period for o in orbits], dtype=np.intp),
        np.array([o is not None and o.settled for o in orbits], dtype=bool),
        np.array([np.nan if o is None else o.events for o in orbits]),
        tuple("" if o is None else values.word_text(o.words) for o in orbits),
        {k: p.error for k, p in enumerate(points) if p is not None and p.error is not None},
        {k: p.warnings for k, p in enumerate(points) if p is not None and p.warnings},
        orbits,
        tuple(None if p is None else p.carry for p in points),
        scale,
    )
