"""Integral, mean and root of the mean square of a signal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from hybond.errors import UsageError
from hybond.measures.impulses import Impulse, impulses_in, told
from hybond.measures.pieces import Reader, integrable
from hybond.measures.value import About, Measurement, integral_unit
from hybond.measures.window import TOLERANCE, Window

if TYPE_CHECKING:
    from hybond.result import Result

Impulses = Literal["refuse", "leave out"]
"""What to do with impulses where a signal with one has no measurement."""


def integral_of(
    run: Result, name: str, window: Window, *, tolerance: float = TOLERANCE
) -> Measurement:
    """Return the integral of a signal over time, the areas of its impulses included.

    Parameters
    ----------
    name : str
        A signal, or an expression of signals.
    tolerance : float
        As a part of the integral of its magnitude.

    Raises
    ------
    UsageError
        HB-R105 for an expression whose impulse has no meaning.
    NumericsError
        HB-R103, HB-R104.
    """
    smooth = _smooth(run, name, window, tolerance)
    found = impulses_in(run, name, window)
    area = math.fsum(i.area for i in found)
    unit = integral_unit(run.unit(name))
    how = told(found, "included")
    return Measurement(smooth + area, About(unit, window.start, window.end, impulses=area, how=how))


def mean_of(run: Result, name: str, window: Window, *, tolerance: float = TOLERANCE) -> Measurement:
    """Return the mean over time, the areas of impulses included.

    Raises
    ------
    UsageError, NumericsError
        As `integral_of`.
    """
    whole = integral_of(run, name, window, tolerance=tolerance)
    about = About(run.unit(name), window.start, window.end, impulses=whole.impulses, how=whole.how)
    return Measurement(float(whole) / window.length, about)


def rms_of(
    run: Result,
    name: str,
    window: Window,
    *,
    impulses: Impulses = "refuse",
    tolerance: float = TOLERANCE,
) -> Measurement:
    """Return the root of the mean square.

    Parameters
    ----------
    impulses : {"refuse", "leave out"}
        The square of an impulse has no integral.

    Raises
    ------
    UsageError
        HB-R106 for a signal with impulses in the window.
    """
    how = without_impulses(run, name, window, impulses, "rms")
    known = integrable(Reader(run, name), window, lambda y, t: (y**2)[None], tolerance=tolerance)
    mean = max(known.integrals()[0], 0.0) / window.length
    return Measurement(math.sqrt(mean), About(run.unit(name), window.start, window.end, how=how))


def without_impulses(run: Result, name: str, window: Window, choice: Impulses, what: str) -> str:
    """Return that impulses were left out, empty if there are none; refuse them if so asked.

    Raises
    ------
    UsageError
        HB-R106; HB-R101 for a choice that is none.
    """
    if choice not in ("refuse", "leave out"):
        raise UsageError(
            f"impulses = {choice!r}",
            code="HB-R101",
            where="impulses",
            hint='"refuse" or "leave out"',
        )
    found = impulses_in(run, name, window)
    if found and choice == "refuse":
        raise impulsive(name, found, what)
    return told(found, "left out")


def impulsive(name: str, found: tuple[Impulse, ...], what: str) -> UsageError:
    """Return the refusal of a measurement that impulses have none of."""
    first = found[0]
    return UsageError(
        f"{name} has {told(found, 'in the window')}, the first at t = {first.t:.9g} s with the "
        f"area {first.area:.6g}, and an impulse has no {what}",
        code="HB-R106",
        where=name,
        hint='impulses="leave out" measures what is beside them; the integral has their areas',
    )


def _smooth(run: Result, name: str, window: Window, tolerance: float) -> float:
    known = integrable(Reader(run, name), window, lambda y, t: y[None], tolerance=tolerance)
    return known.integrals()[0]
