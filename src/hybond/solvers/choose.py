"""Solvers by name."""

from __future__ import annotations

import math

from hybond.errors import UsageError
from hybond.names import did_you_mean
from hybond.run_options import ALIASES, AUTO, FIXED, QUANTISED, SOLVERS, STEPPING, check_step
from hybond.solvers.base import Scale, Solver

__all__ = ["ALIASES", "AUTO", "FIXED", "SOLVERS", "STEPPING", "check_step", "make_solver"]


def make_solver(
    name: str,
    *,
    scale: Scale,
    rtol: float,
    step: float | None = None,
    max_step: float = math.inf,
) -> Solver:
    """Make a solver.

    Parameters
    ----------
    name : str
        One of `SOLVERS`, but for `QUANTISED`.
    scale : callable
        ``scale(y0, y1)``: the error a step may make, per component, shape (n,); ``inf`` for a
        component that must not influence the step size. Unused by fixed steps.
    rtol : float
        Relative tolerance behind `scale`.
    step : float or None
        Size of a fixed step, in seconds; None for an adaptive solver.
    max_step : float
        Largest step of an adaptive solver, in seconds.

    Raises
    ------
    UsageError
        HB-S101 for an unknown name; HB-S102 for a fixed step that is missing or not positive;
        HB-S103 for a `max_step` that is not positive; HB-S104 for a `step` given to an adaptive
        solver.

    Examples
    --------
    >>> import numpy as np
    >>> make_solver("rk45", scale=lambda y0, y1: 1e-6 * np.abs(y1), rtol=1e-6).order
    5
    >>> try:
    ...     make_solver("radua", scale=lambda y0, y1: 1e-6 * np.abs(y1), rtol=1e-6)
    ... except UsageError as error:
    ...     print(error)
    HB-S101: no solver 'radua'
      try: did you mean 'radau'?
    """
    if name not in SOLVERS or name in QUANTISED:
        known = (AUTO, *SOLVERS, *STEPPING)
        raise UsageError(f"no solver {name!r}", code="HB-S101", hint=did_you_mean(name, known))
    check_step(name, step)
    if name in FIXED:
        assert step is not None
        if name == "euler":
            from hybond.solvers.euler import ForwardEuler

            return ForwardEuler(step)
        from hybond.solvers.rk4 import ClassicRK4

        return ClassicRK4(step)
    if not max_step > 0.0:
        raise UsageError(
            f"max_step of {max_step:g} s: it must be positive",
            code="HB-S103",
            hint="leave it out to let the tolerances decide",
        )
    if name == "radau":
        from hybond.solvers.implicit import RadauIIA

        return RadauIIA(scale, rtol=rtol, max_step=max_step)
    if name == "exact":
        from hybond.solvers.exact import Exact

        return Exact(scale, rtol=rtol, max_step=max_step)
    from hybond.solvers.dopri import DormandPrince

    return DormandPrince(scale, max_step=max_step)
