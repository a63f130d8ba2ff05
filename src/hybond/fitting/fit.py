"""`fit`: values of a model that bring its runs to data, by least squares with exact slopes.

    residuals r = (signal - data) / size          of all files, signals and times
    slopes    dr/dp                                from the variations of the run (`sensitivities`)
    z <- trust-region step of 1/2 sum rho(r^2)     SciPy: Branch, Coleman and Li 1999
    covariance s^2 (J^T J)^-1,  s^2 = r^T r / (n - p),  intervals by Student's t

A trial with other events is a trial like any other: its value and its slopes are those of its own
run. One that cannot be run is too far away: the step is shortened.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, Unpack

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.opened import opened_model
from hybond.analysis.sensitivity.sensitivities import check_followed, signal_of
from hybond.analysis.sensitivity.wanted import Wanted, slotted
from hybond.calls import called
from hybond.errors import NumericsError, UsageError
from hybond.fitting.data import Data, read_data
from hybond.fitting.record import Fit
from hybond.fitting.starts import minima_of, starts_of
from hybond.fitting.trials import FittedData, Trials
from hybond.fitting.varied import Scale, scale_of
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.model.unit_words import unit_of
from hybond.names import plural
from hybond.runs.asked import MethodOptions, opened
from hybond.units import is_of, try_quantity

Vector = NDArray[np.float64]
Loss = Literal["linear", "soft_l1", "huber", "cauchy", "arctan"]
LOSSES = ("linear", "soft_l1", "huber", "cauchy", "arctan")
Source = str | Path | Mapping[str, Any] | Data

CONFIDENCE = 0.95
NOTHING = 1e-10
"""Part of the spread of the data below which what a value changes is rounding of runs."""
UNSEEN = 1e-10
"""Singular values of the scaled slopes below this part of the largest: data do not tell."""


@called('hb.fit(model, "data.csv", free=["pad.C", "damper.G"])', options=MethodOptions)
def fit(
    model: Model,
    data: Source | Sequence[Source | tuple[Source, Mapping[str, Value]]],
    free: Sequence[str] | str,
    *,
    bounds: Mapping[str, tuple[Value, Value]] | None = None,
    log: Sequence[str] | str = (),
    sigma: Mapping[str, float] | None = None,
    loss: Loss = "linear",
    parameters: Mapping[str, Value] | None = None,
    max_runs: int = 200,
    starts: int = 1,
    seed: int = 0,
    **options: Unpack[MethodOptions],
) -> Fit:
    """Return values of a model with which its runs are nearest to data.

    Parameters
    ----------
    model : Model
        Its own values are where the search starts.
    data : path, mapping, or sequence of them
        CSV files, or mappings of names to sequences: ``time`` (or ``t``, s) and signals by name.
        With a run of its own for each: ``(data, {"height.start": "2 m"})`` sets values of that
        run.
    free : sequence of str
        What is looked for: parameters, values of elements, starts, as in `sensitivities`.
    bounds : mapping of name to (low, high)
        None is no bound.
    log : sequence of str
        What is looked for by its logarithm: it stays positive, and its interval is one of factors.
    sigma : mapping of signal to float
        Known standard deviations, SI. Otherwise signals are weighed by how much they vary, and the
        intervals follow from what is left.
    loss : {"linear", "soft_l1", "huber", "cauchy", "arctan"}
        What a residual counts: its square, or less of it where it is far out.
    parameters : mapping
        Values by dotted path that replace the model's own, in all runs.
    max_runs : int
        Trials at most, from each start.
    starts : int
        How often the search begins: first from the model's own values, then from a Latin hypercube
        within the bounds, which all that is free must have then. The best is returned;
        `Fit.minima` says where the others ended.
    seed : int
        Of these starts.
    **options
        `method`, or what is short for it, as for `simulate`.

    Returns
    -------
    Fit

    Raises
    ------
    UsageError
        HB-A520 for a path that cannot be set, HB-A532 for bounds, a loss, sizes or starts that are
        wrong, HB-S109 for a column that is no signal.
    FileError
        HB-A530 for data that cannot be read.
    NumericsError
        HB-A533 if the model cannot be run with the values at the start.

    Examples
    --------
    >>> import hybond as hb, numpy as np
    >>> m = hb.Model("rc", parameters={"R": "1 ohm"}, domain="electrical")
    >>> m.add(c=hb.C("1 F", e="1 V"), r=hb.R("R"), n=hb.Zero())
    >>> m.bond("n -> c", "n -> r")
    >>> t = np.linspace(0, 3, 7)
    >>> found = hb.fit(m, {"t": t, "c.e": np.exp(-t/2)}, free=["R"])
    >>> round(found["R"], 6)
    2.0
    """
    names = [free] if isinstance(free, str) else list(free)
    logs = [log] if isinstance(log, str) else list(log)
    if loss not in LOSSES:
        raise UsageError(f"loss = {loss!r}", code="HB-A532", where="loss", hint=", ".join(LOSSES))
    cases, first = _cases(model, data, names, parameters or {}, sigma or {})
    scale = scale_of(names, first.values, bounds or {}, logs, first.units)
    trials = Trials(cases, opened(options))
    begins = starts_of(scale, starts, seed)
    begin = trials.residuals(scale.values(scale.start))
    if starts == 1 and not np.isfinite(begin).all():
        raise _does_not_run(trials, "with the values at the start the model does not run")
    if len(begin) < len(names):
        raise UsageError(
            f"{len(begin)} measurements do not tell {len(names)} values",
            code="HB-A532",
            where="data",
            hint="give more data, or leave fewer values free",
        )
    ends = [_end(z, scale, trials, loss, max_runs) for z in begins]
    ran = [found for found in ends if found is not None]
    if not ran:
        raise _does_not_run(trials, f"from none of {starts} starts the model runs")
    best = min(ran, key=lambda found: float(found.cost))
    fitted = _record(best, scale, trials, first, sigma is not None, begin)
    if starts == 1:
        return fitted
    found = minima_of(scale, [(e.x, float(e.cost)) for e in ran])
    return replace(fitted, starts=starts, minima=found)


def _does_not_run(trials: Trials, why: str) -> NumericsError:
    return NumericsError(
        f"{why}: {trials.error}",
        code="HB-A533",
        where="free",
        hint="start from other values: parameters={...}",
    )


def _end(z: Vector, scale: Scale, trials: Trials, loss: Loss, max_runs: int) -> Any:
    """Return where the search from some variables ends; None if the model does not run there."""
    from scipy.optimize import least_squares

    if not np.isfinite(trials.residuals(scale.values(z))).all():
        return None
    return least_squares(
        lambda z: trials.residuals(scale.values(z)),
        z,
        lambda z: trials.slopes(scale.values(z)) * scale.slopes(z),
        bounds=scale.bounds,
        loss=loss,
        max_nfev=max_runs,
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
    )


def _cases(
    model: Model,
    data: Any,
    names: Sequence[str],
    parameters: Mapping[str, Value],
    sigma: Mapping[str, float],
) -> tuple[list[FittedData], Wanted]:
    """Return what is to be fitted, and the values at the start."""
    several = list(data) if isinstance(data, list | tuple) and not _is_pair(data) else [data]
    read: list[tuple[Data, Mapping[str, Value]]] = []
    for k, one in enumerate(several, start=1):
        source, own = one if _is_pair(one) else (one, {})
        read.append((read_data(source, k), own))
    if not read:
        raise UsageError("there are no data", code="HB-A530", where="data", hint="name a CSV file")
    sizes = _sizes([d for d, _ in read], sigma)
    cases: list[FittedData] = []
    first: Wanted | None = None
    for d, own in read:
        opened = opened_model(model, names, {**parameters, **own}, where="free")
        found = slotted(opened, {})
        first = first or found
        check_followed(found.graph)
        for name in d.columns:
            _check_unit(d, name, unit_of(signal_of(found.plain, name), found.plain))
        cases.append(FittedData(d, opened, sizes, float(d.t[-1]) or 1e-12))
    assert first is not None
    return cases, first


def _check_unit(data: Data, name: str, wanted: str) -> None:
    """Refuse a column that is given in a unit of something else than its signal is."""
    given = data.units.get(name)
    quantity = try_quantity(f"1 {given}") if given else None
    if quantity is not None and not is_of(quantity, wanted):
        raise UsageError(
            f"{name} is measured in {given}, and is in {wanted}",
            code="HB-A530",
            where=data.name,
            hint=f"{name} [{wanted}], or SI without brackets",
        )


def _is_pair(one: Any) -> bool:
    return (
        isinstance(one, tuple)
        and len(one) == 2
        and isinstance(one[1], Mapping)
        and (not isinstance(one[0], Mapping) or not set(one[1]) & {"t", "time"})
    )


def _sizes(data: Sequence[Data], sigma: Mapping[str, float]) -> dict[str, float]:
    """Return what residuals of each signal are divided by."""
    every: dict[str, list[Vector]] = {}
    for d in data:
        for name, column in d.columns.items():
            every.setdefault(name, []).append(column[~np.isnan(column)])
    for name, value in sigma.items():
        if name not in every or not value > 0.0:
            raise UsageError(
                f"sigma of {name} = {value!r}",
                code="HB-A532",
                where="sigma",
                hint="a positive number for each column of the data",
            )
    sizes = {}
    for name, columns in every.items():
        whole = np.concatenate(columns)
        spread = float(np.std(whole)) if len(whole) else 0.0
        largest = float(np.abs(whole).max(initial=0.0))
        sizes[name] = sigma.get(name, spread if spread > 1e-12 * largest else largest or 1.0)
    return sizes


def _record(
    found: Any, scale: Scale, trials: Trials, first: Wanted, known: bool, begin: Vector
) -> Fit:
    """Return the record, with intervals from the slopes at the end."""
    from scipy.special import stdtrit

    values = scale.values(found.x)
    residuals = trials.residuals(values)
    J = trials.slopes(values) * scale.slopes(found.x)
    free = len(values)
    left = max(len(residuals) - free, 1)
    variance = 1.0 if known else float(residuals @ residuals) / left
    size = np.linalg.norm(J, axis=0)
    unseen = size <= NOTHING * math.sqrt(len(residuals))
    size[unseen] = 1.0
    _, s, vt = np.linalg.svd(J / size, full_matrices=False)
    open_ = s <= UNSEEN * s.max(initial=0.0)
    weights = np.where(open_, 0.0, 1.0 / np.where(open_, 1.0, s) ** 2)
    covariance = (vt.T * weights) @ vt / np.outer(size, size) * variance
    lost = unseen | (np.abs(vt[open_]) > 1e-6).any(axis=0)
    errors = np.sqrt(np.diag(covariance))
    errors[lost] = np.inf
    reach = stdtrit(left, 0.5 + CONFIDENCE / 2) * errors
    with np.errstate(over="ignore", invalid="ignore"):
        ends = np.stack([scale.values(found.x - reach), scale.values(found.x + reach)])
    deviation = np.where(errors > 0.0, errors, 1.0)
    with np.errstate(invalid="ignore"):
        correlation = covariance / np.outer(deviation, deviation)
    notes = []
    if lost.any():
        which = ", ".join(n for n, out in zip(scale.names, lost) if out)
        notes.append(f"the data do not tell {which}: there is no interval")
    at = (found.active_mask != 0) & ~lost
    if at.any():
        which = ", ".join(n for n, out in zip(scale.names, at) if out)
        notes.append(f"{which} at a bound: the interval is as if there were none")
    blind = trials.missing == len(residuals) or bool(unseen.all())
    if trials.missing == len(residuals):
        notes.append(f"not converged: no measurement has a slope: {trials.why}")
    elif blind:
        notes.append(f"not converged: no measurement changes with {', '.join(scale.names)}")
    elif trials.missing:
        many = f"{trials.missing} {plural('measurement', trials.missing)} without a slope"
        notes.append(f"{many}: derivatives end before: {trials.why}")
    if not found.success and not blind:
        notes.append(f"not converged: {found.message}")
    if found.status in (1, 2, 3, 4) and begin @ begin < residuals @ residuals:
        notes.append("no better than the start: the loss counts less than squares")
    return Fit(
        names=scale.names,
        paths=trials.cases[0].opened.settable,
        values=values,
        low=ends.min(axis=0),
        high=ends.max(axis=0),
        units=first.units,
        start=first.values,
        correlation=correlation,
        residual={name: _rms(trials, residuals, name) for c in trials.cases for name in c.signals},
        measurements=len(residuals),
        runs=tuple(trials.last_runs()),
        data=tuple(c.data for c in trials.cases),
        trials=trials.runs,
        converged=bool(found.success) and not blind,
        notes=tuple(notes),
    )


def _rms(trials: Trials, residuals: Vector, name: str) -> float:
    """Return the root of the mean square of what is left of a signal, SI."""
    at, found = 0, []
    for case in trials.cases:
        for own, column in case.data.columns.items():
            many = int((~np.isnan(column)).sum())
            if own == name:
                found.append(residuals[at : at + many] * case.sizes[name])
            at += many
    return float(np.sqrt(np.mean(np.concatenate(found) ** 2)))
