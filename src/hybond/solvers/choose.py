"""Solvers by name."""

from __future__ import annotations

import math

from hybond.errors import UsageError
from hybond.names import did_you_mean
from hybond.solvers.base import Scale, Solver

SOLVERS: dict[str, str] = {
    "rk45": "explicit Runge-Kutta 5(4) of Dormand and Prince, adaptive; the default choice",
    "radau": "implicit Runge-Kutta of order 5 (Radau IIA), adaptive; for stiff models",
    "exact": "exact propagation of linear modes by the exponential of a matrix; rk45 elsewhere",
    "rk4": "classical Runge-Kutta of order 4, fixed step",
    "euler": "forward Euler, fixed step; to reproduce published results",
    "qss1": "quantised states of order 1: constant between their events; for coarse tolerances",
    "qss2": "quantised states of order 2: lines between their events",
    "qss3": "quantised states of order 3: parabolas between their events; also named qss",
    "liqss1": "linearly implicit quantised states of order 1; stiff, for coarse tolerances",
    "liqss2": "linearly implicit quantised states of order 2, for stiff models; also named liqss",
    "liqss3": "linearly implicit quantised states of order 3, for stiff models",
}
"""Names of the solvers, each with a line that says what it is."""

FIXED = ("rk4", "euler")
"""Those with a fixed step."""

AUTO = "auto"
"""Not a solver: one is chosen for the model."""

STEPPING: dict[str, str] = {
    "moreau-jean": "time-stepping of Moreau and Jean: fixed steps, contacts and diodes within them",
}
"""Methods that replace the executive as well, each with a line that says what it is."""

QUANTISED = ("qss1", "qss2", "qss3", "liqss1", "liqss2", "liqss3")
"""Those that quantise states: the library alone has them."""

ALIASES: dict[str, str] = {"qss": "qss3", "liqss": "liqss2"}
"""Families of solvers by the member to begin with."""


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


def check_step(name: str, step: float | None) -> None:
    """Refuse a fixed step that is missing or makes no sense, or is given to who chooses his own.

    Raises
    ------
    UsageError
        HB-S102 or HB-S104, as `make_solver`.
    """
    if name not in FIXED:
        if step is not None:
            raise UsageError(
                f"solver {name!r} chooses its step; a step of {step:g} s was given",
                code="HB-S104",
                hint='give max_step to bound it, or choose a fixed step: "rk4", "euler"',
            )
    elif step is None:
        raise UsageError(
            f"solver {name!r} has a fixed step and none is given",
            code="HB-S102",
            hint='give one, such as step="1 ms", or choose the adaptive solver "rk45"',
        )
    elif not 0.0 < step < math.inf:
        raise UsageError(
            f"a step of {step:g} s for solver {name!r}: it must be positive and finite",
            code="HB-S102",
            hint='give a duration, such as step="1 ms"',
        )
