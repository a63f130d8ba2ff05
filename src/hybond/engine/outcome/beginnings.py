"""Where a run begins, if not where its model says: in numbers that the engine takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.engine.run.run_records import GIVEN, GOES_ON


@dataclass(frozen=True, slots=True)
class Beginning:
    """The numbers that a run is handed: see `engine.run.carried`."""

    number: NDArray[np.float64]
    place: NDArray[np.intc]
    way: int
    """GIVEN, CHANGED or GOES_ON of `engine.run.run_records`."""
    deep: bool
    """Whether they hold what another run remembers."""
    states: int

    @property
    def t(self) -> float:
        """When it begins, s."""
        return float(self.number[0])

    @property
    def state(self) -> NDArray[np.float64]:
        """What is stored and integrated there, before it is settled."""
        return self.number[1 : 1 + self.states]


__all__ = ["GIVEN", "GOES_ON", "Beginning"]
