"""`optimise`: values of a model for which a goal of its run is least, with its gradient.

    z <- L-BFGS-B step in scaled variables     Byrd, Lu, Nocedal and Zhu 1995, by SciPy
    gradient by the adjoint of each run        one row, whatever the number of values

Where events come and go the goal has a kink or a jump; the minimum that is found is one of the
stretch of values that the steps stay in.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.goals import EventTime, Final, Goal, Total
from hybond.analysis.sensitivity.gradient import gradient_of, no_goal
from hybond.analysis.sensitivity.opened import opened_model
from hybond.analysis.sensitivity.wanted import slotted
from hybond.calls import called
from hybond.errors import HybondError, NumericsError, UsageError
from hybond.fitting.varied import scale_of, value_of
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.names import plural
from hybond.result import Result
from hybond.runs.asked import MethodOptions

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Optimum:
    """Values for which a goal is least; made by `optimise`.

    Parameters
    ----------
    goal : str
        In words.
    value : float
        What it is there, SI.
    began : float
        What it was at the start.
    names : tuple of str
    values : array, shape (free,)
        SI.
    start : array, shape (free,)
    slopes : array, shape (free,)
        The derivatives of the goal there, SI.
    units : tuple of str
    at_bound : tuple of str
        What stands at a bound.
    trials : int
        Runs that it took.
    converged : bool
    message : str
        Why the search ended, in the words of SciPy.
    run : Result
    """

    goal: str
    value: float
    began: float
    names: tuple[str, ...]
    values: Vector
    start: Vector
    slopes: Vector
    units: tuple[str, ...]
    at_bound: tuple[str, ...]
    trials: int
    converged: bool
    message: str
    run: Result = field(repr=False)

    def __getitem__(self, name: str) -> float:
        """Return a value by name, SI.

        Raises
        ------
        UsageError
            HB-A523 for a name that was not free.
        """
        return value_of(name, self.names, self.values)

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        runs = f"{self.trials} {plural('run', self.trials)}"
        yield f"{self.goal} = {self.value:.9g}, from {self.began:.9g} in {runs}"
        wide = max(map(len, self.names))
        for k, name in enumerate(self.names):
            unit = f" {self.units[k]}" if self.units[k] else ""
            at = ", at a bound" if name in self.at_bound else ""
            was = f"(from {self.start[k]:.6g}{at})"
            yield f"  {name.ljust(wide)}  {self.values[k]:.9g}{unit}  {was}"
        if not self.converged:
            yield f"not converged: {self.message}"


@called('hb.optimise(model, hb.Final("c.e"), free=["R"], until="1 s")', options=MethodOptions)
def optimise(
    model: Model,
    goal: Goal,
    free: Sequence[str] | str,
    *,
    until: float | str | None = None,
    bounds: Mapping[str, tuple[Value, Value]] | None = None,
    log: Sequence[str] | str = (),
    parameters: Mapping[str, Value] | None = None,
    max_runs: int = 200,
    **options: Unpack[MethodOptions],
) -> Optimum:
    """Return values of a model for which a goal of its run is least.

    Parameters
    ----------
    model : Model
        Its own values are where the search starts.
    goal : Final, Total or EventTime
        What is made small; for the largest, put a minus before the signal.
    free : sequence of str
        As for `fit`.
    until : float or str
        End time; by default that of the experiment.
    bounds, log, parameters
        As for `fit`.
    max_runs : int
        Trials at most.
    **options
        `method`, or what is short for it, as for `simulate`.

    Raises
    ------
    UsageError
        HB-A520 for a path that cannot be set, HB-A525 for what is no goal, HB-A532 for bounds.
    NumericsError
        HB-A533 if there is no run, or no derivative, with the values at the start.

    Examples
    --------
    The resistor that takes most energy in 1 s from a source of 1 V behind 2 ohm: one of 2 ohm.

    >>> import hybond as hb
    >>> m = hb.Model("load", parameters={"R": "0.5 ohm"}, domain="electrical")
    >>> m.add(V=hb.Se("1 V"), own=hb.R("2 ohm"), load=hb.R("R"), j=hb.One())
    >>> m.bond("V -> j -> own", "j -> load")
    >>> found = hb.optimise(m, hb.Total("-load.e*load.f"), free=["R"], until="1 s", log=["R"])
    >>> round(found["R"], 5), round(found.value, 9)
    (2.0, -0.125)
    """
    from scipy.optimize import minimize

    names = [free] if isinstance(free, str) else list(free)
    logs = [log] if isinstance(log, str) else list(log)
    if not isinstance(goal, Final | Total | EventTime):
        raise no_goal(goal)
    opened = opened_model(model, names, parameters or {}, where="free")
    first = slotted(opened, {})
    scale = scale_of(names, first.values, bounds or {}, logs, first.units)
    trials = 0

    def trial(z: Vector) -> tuple[float, Vector, Result]:
        nonlocal trials
        trials += 1
        given = dict(zip(opened.paths, scale.values(z).tolist(), strict=True))
        found = gradient_of(opened, given, goal, until, "adjoint", options)
        return found.value, found.by * scale.slopes(z), found.run

    try:
        began, steep, _ = trial(scale.start)
    except NumericsError as error:
        raise NumericsError(
            f"with the values at the start there is no gradient: {error.why}",
            code="HB-A533",
            where="free",
            hint="start from other values: parameters={...}",
        ) from None
    # what cannot be run is worse than all that could: the line search comes back
    worst = abs(began)

    def goal_of(z: Vector) -> tuple[float, Vector]:
        nonlocal worst
        try:
            value, slopes, _ = trial(z)
        except HybondError as error:
            if isinstance(error, UsageError):
                raise
            return 10.0 * worst + 1.0, np.zeros(len(z))
        worst = max(worst, abs(value))
        return value / size, slopes / size

    size = max(abs(began), float(np.abs(steep).max(initial=0.0))) or 1.0
    low, high = scale.bounds
    found = minimize(
        goal_of,
        scale.start,
        jac=True,
        method="L-BFGS-B",
        bounds=list(zip(low, high, strict=True)),
        options={"maxfun": max_runs, "ftol": 1e-14, "gtol": 1e-9},
    )
    value, slopes, run = trial(found.x)
    values = scale.values(found.x)
    near = 1e-9 * np.maximum(np.abs(values), 1e-300)
    at = (np.abs(values - scale.low) <= near) | (np.abs(values - scale.high) <= near)
    return Optimum(
        goal=str(goal),
        value=value,
        began=began,
        names=tuple(names),
        values=values,
        start=first.values,
        slopes=slopes / scale.slopes(found.x),
        units=first.units,
        at_bound=tuple(n for n, there in zip(names, at) if there),
        trials=trials,
        converged=bool(found.success),
        message=str(found.message),
        run=run,
    )
