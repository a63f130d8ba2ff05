"""What an audit reads of a run: stretches of it, each with all its points in a few arrays.

To look into a segment takes as long as a hundred steps of it, and runs that switch have many which
are short: those that follow each other are looked into in one call.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.points import Steps as StepsToLook
from hybond.engine.compiled.points import Within
from hybond.engine.outcome.logged_steps import Block
from hybond.engine.outcome.signals import Signals
from hybond.records import dataclass
from hybond.runs.trace import Segment, Trace

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Places = NDArray[np.intp]

NUMBERS = 1 << 21
"""Bond variables that are read at once."""
POINTS = 4096
"""Points in segments that are read at once; a longer segment is read alone."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Segments that follow each other."""

    first: int
    """The number of the first segment."""
    begins: Places
    """Shape (segments,). The first point of each."""
    t: Vector
    """Shape (points,). s; where a segment begins and its steps end."""
    bonds: Matrix
    """Shape (2 bonds, points times parts). Efforts and flows; those of a point follow each other:
    while machines slide, of each mode that is combined."""
    stored: Vector
    """Shape (points,). J."""
    balance: Vector
    """Shape (points,). Stored and dissipated, less supplied, since the segment began, J."""
    passed: Vector
    """Shape (segments,). Sizes of what is supplied and dissipated in all steps, J."""

    @property
    def parts(self) -> int:
        """How many modes are combined."""
        return int(self.bonds.shape[1]) // len(self.t)

    def most(self, values: Matrix) -> Matrix:
        """Return the largest of each segment of values at points, the last axis."""
        return np.asarray(np.maximum.reduceat(values, self.begins, axis=-1))

    def sums(self, values: Matrix) -> Matrix:
        """Return the sum in each segment of values at points, the last axis."""
        return np.asarray(np.add.reduceat(values, self.begins, axis=-1))

    def along(self, values: Matrix) -> Matrix:
        """Return the sum in each segment up to each point of values there."""
        found = np.empty_like(values)
        for a, b in pairwise([*self.begins.tolist(), len(self.t)]):
            np.cumsum(values[..., a:b], axis=-1, out=found[..., a:b])
        return found

    def steps(self, values: Matrix) -> Matrix:
        """Return values of the steps that end at points, put to 0 where a segment begins."""
        values[..., self.begins] = 0.0
        return values

    def changes(self, values: Matrix) -> Matrix:
        """Return what values change by in the step that ends at a point."""
        return self.steps(np.diff(values, axis=-1, prepend=values[..., :1]))

    def integrals(self, values: Matrix) -> Matrix:
        """Return the integral of values over the step that ends at a point, as if straight."""
        before = np.concatenate([values[..., :1], values[..., :-1]], axis=-1)
        return self.steps(0.5 * (values + before) * np.diff(self.t, prepend=self.t[:1]))


def stretches(signals: Signals, trace: Trace) -> Iterator[Stretch]:
    """Yield the stretches of a run, but for those of time-stepping."""
    segments = trace.segments
    # where a source has jumped, values at the end of a segment are of both sides of the jump
    jumps = np.array([event.t for event in trace.events if event.cause == "law"])
    for made, places, numbers in segments.origins(np.arange(len(segments))):
        block = made if isinstance(made, Block) else None
        for a, b in _together(block, numbers, 2 * len(signals.graph.bonds), bool(trace.roots)):
            first = int(places[a])
            if block is not None and b - a > 1:
                low, high = int(numbers[a]), int(numbers[b - 1]) + 1
                yield _of_many(signals, block, low, high, first, jumps)
            elif segments[first].bonds is None:
                yield _of_one(signals, segments[first], first, jumps)


def sizes_of(trace: Trace) -> Vector:
    """Return the largest size that each state has in a run, but for time-stepping."""
    found: list[Vector] = []
    segments = trace.segments
    for made, places, numbers in segments.origins(np.arange(len(segments))):
        if isinstance(made, Block):
            begins, end = made.begins[numbers], int(made.begins[numbers[-1] + 1])
            if made.steps.points is None:
                state = made.steps.state
                ends = state[np.arange(int(begins[0]), end), 2]
                found += [np.abs(state[begins, 0]).max(axis=0), np.abs(ends).max(axis=0)]
            continue
        alone = [segments[k] for k in places.tolist()]
        found += [np.abs(s.y).max(axis=0) for s in alone if s.bonds is None and len(s.t)]
    return np.asarray(np.max(found, axis=0)) if found else np.zeros(0)


def _together(
    block: Block | None, numbers: Places, wide: int, rooted: bool
) -> Iterator[tuple[int, int]]:
    """Yield from where to where segments of a block are read at once.

    Where laws have several solutions each segment is followed by that which the run took.
    """
    if block is None or rooted:
        yield from ((k, k + 1) for k in range(len(numbers)))
        return
    most = min(POINTS, NUMBERS // max(wide, 1))
    alone = block.alone[numbers].tolist()
    points = (np.diff(block.begins)[numbers] + 1).tolist()
    a = held = 0
    for k, here in enumerate(points):
        if k > a and not (alone[k] and alone[k - 1] and held + here <= most):
            yield a, k
            a, held = k, 0
        held += here
    yield a, len(points)


def _of_one(signals: Signals, segment: Segment, first: int, jumps: Vector) -> Stretch:
    """Return one segment."""
    end = signals.left_ends([first])[0] if segment.t[-1] in jumps else None
    energies = signals.energies(segment)
    return _stretch(
        *(first, np.zeros(1, dtype=np.intp), segment.t, signals.bonds(segment, end)),
        *(signals.stored(segment.y), energies),
    )


def _of_many(
    signals: Signals, block: Block, low: int, high: int, first: int, jumps: Vector
) -> Stretch:
    """Return segments of a block in which nothing is slid on."""
    steps = block.steps.part(int(block.begins[low]), int(block.begins[high]))
    state = np.ascontiguousarray(steps.state[:])
    begins = block.begins[low:high] - block.begins[low]
    many = np.diff(block.begins[low : high + 1])
    # a point where each segment begins, and one where each step ends
    at = begins + np.arange(len(begins))
    ends = np.delete(np.arange(len(steps.time) + len(at)), at)
    t, y = np.empty(len(at) + len(ends)), np.empty((len(at) + len(ends), state.shape[2]))
    step = np.empty(len(t), dtype=np.intc)
    t[at], y[at], step[at] = steps.time[begins, 0], state[begins, 0], begins
    t[ends], y[ends], step[ends] = steps.time[:, 2], state[:, 2], np.arange(len(steps.time))
    looked = t.copy()
    last = at + many
    jumped = np.flatnonzero(np.isin(t[last], jumps))
    if len(jumped):
        looked[last[jumped]] = signals.left_ends((first + jumped).tolist())
        # a moment earlier may be in the step before
        earlier = np.searchsorted(steps.time[:, 2], looked[last[jumped]])
        step[last[jumped]] = np.maximum(earlier, begins[jumped])
    log = StepsToLook.logged(steps.time, state, steps.dense)
    motions = signals.motions(steps.time[begins, 0], steps.place[begins], many + 1)
    values = signals.values_along(motions, Within(log, looked, step), signals.bond_slots)
    motions = signals.motions(steps.time[begins, 0], steps.place[begins], many)
    whole = Within(log, steps.time[:, 0], np.arange(len(steps.time)))
    energies = np.zeros((len(t), 2))
    energies[ends] = signals.energies_along(motions, whole, steps.time[:, 2])[:, :2]
    for a, b in pairwise([*at.tolist(), len(t)]):
        np.cumsum(energies[a:b], axis=0, out=energies[a:b])
    return _stretch(first, at, t, np.ascontiguousarray(values.T), signals.stored(y), energies)


def _stretch(
    first: int, begins: Places, t: Vector, bonds: Matrix, stored: Vector, energies: Matrix
) -> Stretch:
    """Return a stretch; `energies` are those supplied and dissipated since a segment began."""
    supplied, dissipated = energies.T
    sizes = np.abs(np.diff(energies, axis=0, prepend=energies[:1]))
    sizes[begins] = 0.0
    passed = np.add.reduceat(sizes, begins, axis=0).sum(axis=1)
    return Stretch(first, begins, t, bonds, stored, stored + dissipated - supplied, passed)
