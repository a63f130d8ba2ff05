"""Points in many segments of one slice of a run, with the steps in which they lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.kept_rows import SharedRows
from hybond.engine.compiled.points import Steps as StepsToLook
from hybond.engine.outcome.logged_steps import Block, Steps
from hybond.records import dataclass

Vector = NDArray[np.float64]


def begins_of(numbers: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which of numbers differ from the one before: in order, that is where each begins.

    Examples
    --------
    >>> begins_of(np.array([3, 3, 5])).tolist()
    [True, False, True]
    """
    return np.not_equal(np.diff(numbers, prepend=-1), 0)


@dataclass(frozen=True, slots=True)
class Along:
    """Points in segments of one block, with the steps in which they lie."""

    points: NDArray[np.intp]
    """Shape (points,). Which of all points these are."""
    steps: Steps
    """The steps of the block."""
    step: NDArray[np.intp]
    """Shape (points,). Which of them each lies in."""
    begin: Vector
    place: NDArray[np.intc]
    many: NDArray[np.intp]
    """`begin`, `place` and `many`: of each segment: when it begins, the row with the states of
    machines, how many points."""
    resting: list[int]
    """Segments left out: some of their points are behind the last step."""

    @staticmethod
    def of(
        block: Block,
        numbers: NDArray[np.intp],
        places: NDArray[np.intp],
        first: NDArray[np.intp],
        ends: NDArray[np.intp],
        t: Vector,
    ) -> Along:
        """Return the points from ``first[place]`` to before ``ends[place]`` of segments."""
        steps = block.steps
        over = steps.time[block.begins[numbers + 1] - 1, 2]
        rests = t[ends[places] - 1] > over
        resting = places[rests].tolist()
        numbers, places = numbers[~rests], places[~rests]
        many = ends[places] - first[places]
        points = np.repeat(first[places] - np.cumsum(many) + many, many) + np.arange(many.sum())
        low = np.repeat(block.begins[numbers], many)
        high = np.repeat(block.begins[numbers + 1] - 1, many)
        step = np.clip(np.searchsorted(steps.time[:, 2], t[points]), low, high)
        begins = block.begins[numbers]
        return Along(
            points,
            steps,
            step,
            steps.time[begins, 0],
            steps.place[begins],
            many,
            resting,
        )

    def to_look(self) -> StepsToLook:
        """Return the steps as the engine reads them."""
        log, state = self.steps, self.steps.state
        if isinstance(state, SharedRows):
            # only those that are asked for are written out, others are never read
            used = np.unique(self.step)
            written = np.empty(state.shape)
            for k in range(written.shape[1]):
                written[used, k] = state[used, k]
            state = written
        return StepsToLook.logged(log.time, state, log.dense)
