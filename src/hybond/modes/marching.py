"""What may take over the smooth part of a motion: a march of steps in which nothing happens.

The executive asks for one wherever a mode begins, and after every step of its own. What marches
gives the steps up to the end, or to the first instant at which a guard holds, or up to one that it
is not sure of; that one the executive makes itself. So a march may give up at any time and changes
nothing but the speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.modes.locate import Watched
from hybond.modes.settle import Settler
from hybond.programs.interval import Interval

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Marched:
    """Steps taken.

    Parameters
    ----------
    t : array, shape (steps,)
        Their ends, s.
        The last one may lie before the end of its step, at an event.
    y : array, shape (steps, states)
        The states there, on the constraints of the mode.
    stop, end : arrays, shape (steps,) and (steps, states)
        The ends of the steps, and the states as the steps gave them.
    dense : array, shape (steps, 4, states)
        Coefficients of ``x, ..., x^4``, as in `hybond.solvers.dense.Polynomial`.
    rejected : int
    gaps : dict
        Machine to the largest distance of its contact.
    arrived : bool
        Whether the last step ends where it should.
    interrupted : bool
        Whether it could go on at once.
    event : bool
        Whether a guard holds at the end.
    """

    t: Vector
    y: Vector
    stop: Vector
    end: Vector
    dense: Vector
    rejected: int
    gaps: dict[int, float]
    arrived: bool
    interrupted: bool
    event: bool


class Scale(Protocol):
    """What the error of a step is measured by: `ErrorScale`."""

    rtol: float
    energy: float
    largest: Vector
    rounding: Vector

    @property
    def atol_or_nan(self) -> float:
        """The absolute tolerance, nan if none is given."""

    @property
    def negligible(self) -> float:
        """Part of what a storage would hold with all energy below which it need not be right."""

    @property
    def idle(self) -> float:
        """What an integrated signal may be wrong by at zero."""


class March(Protocol):
    """What marches."""

    def march(
        self,
        equations: ModeEquations,
        watched: Watched,
        *,
        interval: Interval,
        settler: Settler,
        end: float,
        instant: float,
        start: tuple[float, Vector] | None,
    ) -> Marched | None:
        """Return the steps, None if this mode is not for marching.

        A guard that holds within `instant` of `end`, s, is left to the executive. `start` are time
        and state where a motion begins; without it the last one goes on.
        """

    def reasons(self) -> list[str]:
        """Return why modes were not for marching, a text each."""
