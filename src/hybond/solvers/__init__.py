"""How time passes: one step contract, and the methods that keep it."""

from __future__ import annotations

from hybond.run_options import SOLVERS
from hybond.solvers.base import Field, FloatArray, Scale, Solver, Step, StepFailure
from hybond.solvers.choose import make_solver

__all__ = [
    "SOLVERS",
    "Field",
    "FloatArray",
    "Scale",
    "Solver",
    "Step",
    "StepFailure",
    "make_solver",
]
