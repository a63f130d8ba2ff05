"""Where a run of the reference begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.engine.tables import start
from hybond.programs.program import Program

Vector = NDArray[np.float64]


def start_of(program: Program) -> Vector:
    """Return the state at t = 0 as the model gives it, before it is settled."""
    return np.append(start.start_of(program.graph), [0.0, 0.0])
