"""How much a signal varies about its mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.errors import UsageError
from hybond.measures.averages import mean_of, rms_of
from hybond.measures.extremes import range_of
from hybond.measures.window import TOLERANCE, Window
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

NOUGHT = 1e-9
"""Part of the root of the mean square up to which a mean counts as zero."""


@dataclass(frozen=True, slots=True)
class Ripple:
    """How much a signal varies about its mean, as parts of the mean.

    Parameters
    ----------
    peak_to_peak : float
        The maximum less the minimum.
    rms : float
        Of what is left without the mean: the ripple factor of a rectifier.
    """

    peak_to_peak: float
    rms: float


def ripple_of(run: Result, name: str, window: Window, *, tolerance: float = TOLERANCE) -> Ripple:
    """Return how much a signal varies, as parts of its mean.

    Raises
    ------
    UsageError
        HB-R106 for impulses, HB-R108 for a mean of zero.
    NumericsError
        HB-R103, HB-R104.
    """
    height = range_of(run, name, window, tolerance=tolerance)
    root = rms_of(run, name, window, tolerance=tolerance)
    mean = abs(mean_of(run, name, window, tolerance=tolerance))
    if not mean > NOUGHT * root:
        raise UsageError(
            f"the mean of {name} is {mean:.6g}, and ripple is a part of it",
            code="HB-R108",
            where=name,
            hint="peak_to_peak() and rms() need no mean",
        )
    return Ripple(height / mean, max(root**2 - mean**2, 0.0) ** 0.5 / mean)
