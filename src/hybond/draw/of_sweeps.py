"""What is drawn of many runs, on paper or on a page: outcomes over two columns, bands of curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Numbers = NDArray[np.intp]
NONE = "#d9d9d9"
"""Where there is no outcome."""


@dataclass(frozen=True, slots=True)
class Axis:
    """One direction of a map.

    Parameters
    ----------
    name, unit : str
    log : bool
        Whether values are apart by ratios more than by differences.
    edges : array, shape (levels + 1,), or None
        Of the cells around the levels of a grid; None of points.
    """

    name: str
    unit: str
    log: bool
    edges: Vector | None


@dataclass(frozen=True, slots=True)
class OutcomeMap:
    """An outcome over two columns.

    Parameters
    ----------
    x, y : Axis
    value, unit : str
        What is mapped.
    members : array, shape (points,)
        Numbers of the members; of cells row by row, from below, -1 where none has run yet.
    across, up : array, shape (points,)
        Where they are; of cells the levels, shapes (columns,) and (rows,).
    number : array, shape (points,)
        The outcome, or which of `names` it is; nan where there is none.
    names, inks : tuple of str
        Texts in the order of the members, of very many the frequent ones, and their colours; empty
        if the outcome is a number.
    """

    x: Axis
    y: Axis
    value: str
    unit: str
    members: Numbers
    across: Vector
    up: Vector
    number: Vector
    names: tuple[str, ...]
    inks: tuple[str, ...]

    @property
    def is_grid(self) -> bool:
        """Whether it is made of cells."""
        return self.x.edges is not None


@dataclass(frozen=True, slots=True)
class Spread:
    """A curve of many runs.

    Parameters
    ----------
    signal, unit : str
    t : array, shape (times,)
        s.
    bands : array, shape (5, times)
        The quantiles `hybond.sweep.views.BANDS`: 5, 25, 50, 75 and 95 %.
    members : array of int, shape (shown,)
    curves : array, shape (shown, times)
        Theirs; nan beyond the end of a run.
    """

    signal: str
    unit: str
    t: Vector
    bands: Vector
    members: NDArray[np.intp]
    curves: Vector
