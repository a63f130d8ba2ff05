"""What a signal has of a frequency and its multiples, and how far it is from a sine."""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.measures.averages import without_impulses
from hybond.measures.impulses import impulses_in, told
from hybond.measures.pieces import Reader, integrable
from hybond.measures.value import About, Measurement, shown
from hybond.measures.window import TOLERANCE, Window
from hybond.names import html_table
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]

WHOLE = 1e-9
"""How far a window may be from whole periods, in periods."""
MOST = 10_000
"""Harmonics."""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """Harmonics of a signal over whole periods.

    ``y = mean + sum of amplitude[k] * cos(2 pi frequency[k] (t - start) + phase[k])``.

    Parameters
    ----------
    frequency : array, shape (n,)
        Hz, the multiples of the first.
    amplitude : array, shape (n,)
        Peak values, in the unit of the signal.
    phase : array, shape (n,)
        rad.
    mean, rms : float
        Of the whole signal; `rms` is NaN if it has impulses.
    unit : str
    start, end : float
        s.
    how : str
        Whether impulses are included.
    """

    frequency: Vector
    amplitude: Vector
    phase: Vector
    mean: float
    rms: float
    unit: str
    start: float
    end: float
    how: str = ""

    def table(self) -> dict[str, Vector]:
        """Return columns: frequency, amplitude and phase."""
        return {"frequency": self.frequency, "amplitude": self.amplitude, "phase": self.phase}

    def to_pandas(self) -> Any:
        """Return a DataFrame over frequency."""
        import pandas as pd

        return pd.DataFrame(self.table()).set_index("frequency")

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        columns = {k: v.tolist() for k, v in self.table().items()}
        own = {"mean": self.mean, "rms": self.rms, "unit": self.unit}
        return {**own, "start": self.start, "end": self.end, "how": self.how, **columns}

    def rows(self) -> list[tuple[str, str, str]]:
        """Return frequency, amplitude and phase for people, the mean first."""
        found = [("0 Hz", shown(self.mean, self.unit), "")]
        for f, a, p in zip(self.frequency, self.amplitude, self.phase, strict=True):
            found.append((shown(float(f), "Hz"), shown(float(a), self.unit), f"{p:.4f} rad"))
        return found

    def __str__(self) -> str:
        rows = self.rows()
        wide = [max(len(r[k]) for r in rows) for k in range(3)]
        return "\n".join(
            "  ".join(word.rjust(w) for word, w in zip(row, wide, strict=True)).rstrip()
            for row in rows
        )

    def _repr_html_(self) -> str:
        return html_table(self.rows(), ("frequency", "amplitude", "phase"))


def spectrum_of(
    run: Result,
    name: str,
    window: Window,
    frequency: float,
    *,
    harmonics: int = 20,
    tolerance: float = TOLERANCE,
) -> Spectrum:
    """Return the harmonics of a signal: integrals over whole periods, impulses included.

    Parameters
    ----------
    frequency : float
        Hz, of the first.
    harmonics : int
        How many.

    Raises
    ------
    UsageError
        HB-R109 if the window is not whole periods; HB-R101 for a number that is none.
    """
    if not isinstance(harmonics, int) or not 1 <= harmonics <= MOST:
        raise UsageError(
            f"harmonics = {harmonics!r}",
            code="HB-R101",
            where="harmonics",
            hint=f"a whole number from 1 to {MOST}",
        )
    periods = window.length * frequency
    if round(periods) < 1 or abs(periods - round(periods)) > WHOLE * max(periods, 1.0):
        raise UsageError(
            f"a window of {window.length:.9g} s is {periods:.9g} periods of {frequency:.9g} Hz",
            code="HB-R109",
            where=name,
            hint="whole periods: periods=1, or start and end that fit",
        )
    omega = 2.0 * math.pi * round(periods) / window.length
    top = harmonics * omega

    def functions(y: Vector, t: Vector) -> Vector:
        # what is known of the highest is known of the others
        angle = top * (t - window.start)
        return np.stack([y, y * np.cos(angle), y * np.sin(angle), y**2])

    known = integrable(Reader(run, name), window, functions, shared=3, tolerance=tolerance)
    found = impulses_in(run, name, window)
    angle = known.pieces.times() - window.start
    lines = []
    for k in range(1, harmonics + 1):
        real = known.integral(known.functions[0] * np.cos(k * omega * angle))
        imaginary = -known.integral(known.functions[0] * np.sin(k * omega * angle))
        struck = sum(i.area * cmath.exp(-1j * k * omega * (i.t - window.start)) for i in found)
        lines.append((complex(real, imaginary) + struck) * 2.0 / window.length)
    line = np.array(lines)
    area = math.fsum(i.area for i in found)
    square = known.integral(known.functions[3])
    return Spectrum(
        np.arange(1.0, harmonics + 1.0) * (omega / (2.0 * math.pi)),
        np.abs(line),
        np.angle(line),
        (known.integral(known.functions[0]) + area) / window.length,
        math.nan if found else math.sqrt(max(square, 0.0) / window.length),
        run.unit(name),
        window.start,
        window.end,
        told(found, "included"),
    )


def thd_of(
    run: Result,
    name: str,
    window: Window,
    frequency: float,
    *,
    harmonics: int | None = None,
    tolerance: float = TOLERANCE,
) -> Measurement:
    """Return the total harmonic distortion: what is not the fundamental, as a part of it.

    Parameters
    ----------
    harmonics : int, optional
        Up to which harmonic; by default all that the signal has beside its mean and its
        fundamental, which is its rms less both.

    Raises
    ------
    UsageError
        HB-R106 for impulses; HB-R109; HB-R110 if there is no fundamental.
    """
    without_impulses(run, name, window, "refuse", "distortion")
    if harmonics is not None and (not isinstance(harmonics, int) or harmonics < 2):
        raise UsageError(
            f"harmonics = {harmonics!r}",
            code="HB-R101",
            where="harmonics",
            hint="2 or more; leave it out for all",
        )
    found = spectrum_of(run, name, window, frequency, harmonics=harmonics or 1, tolerance=tolerance)
    first = float(found.amplitude[0])
    if not first > 1e-9 * found.rms:
        raise UsageError(
            f"{name} has nothing of {frequency:.9g} Hz",
            code="HB-R110",
            where=name,
            hint="give the frequency that it has: run[...].frequency(level)",
        )
    if harmonics is None:
        rest = max(found.rms**2 - found.mean**2 - 0.5 * first**2, 0.0)
        part = math.sqrt(2.0 * rest) / first
    else:
        part = float(np.linalg.norm(found.amplitude[1:])) / first
    return Measurement(part, About("", window.start, window.end))
