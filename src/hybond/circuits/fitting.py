"""Diodes after a run: whether they carry the current at which they became straight lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from hybond.measures.averages import power_integral
from hybond.measures.window import Window
from hybond.result import Result

OFF = 1.5
"""A current that is off by less is not told."""
TOLD = 1e-3
"""Nor is a drop that is off by less, V."""


@dataclass(frozen=True, slots=True)
class Tangent:
    """A diode that a conversion took as the tangent of its curve.

    Parameters
    ----------
    name : str
        Its junction in the model.
    current : float
        Where the tangent touches, A.
    emission : float
        N Vt, V.
    key : str
        Its name in the netlist, in lower case.
    """

    name: str
    current: float
    emission: float
    key: str = ""


@dataclass(frozen=True, slots=True)
class Fit:
    """What a diode carried, and how far its line is from its curve there.

    Parameters
    ----------
    carried : float
        The mean of its current weighted with the charge, in the last half of the run, A.
    apart : float
        The drop of the line less that of the curve at this current, V; never negative.
    """

    tangent: Tangent
    carried: float
    apart: float

    def __str__(self) -> str:
        """Return a sentence with the card that would fit."""
        return (
            f"{self.tangent.name} carries {self.carried:.2g} A while it conducts; its drop was "
            f"taken at {self.tangent.current:g} A, which is {self.apart * 1e3:.2g} mV too much "
            f"there: --diode-current '{self.carried:.2g} A' fits it, or auto all of them"
        )


def fits(run: Result, tangents: Sequence[Tangent]) -> list[Fit]:
    r"""Return the diodes whose line does not fit what they carried; nothing is changed.

    Parameters
    ----------
    run : Result
        Of the model of a conversion.
    tangents : sequence of Tangent
        Its ``diodes``.

    Examples
    --------
    A diode at 10 mA, its drop taken at 1 A:

    >>> import pathlib, tempfile
    >>> import hybond as hb
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "d.cir")
    ...     _ = path.write_text(
    ...         "D\nI1 0 a 10m\nD1 a 0 DX\n.model DX D(IS=1e-14)\n.tran 1u 1m\n.end\n")
    ...     found = hb.read_circuit(path)
    >>> fit, = fits(hb.simulate(found.model), found.diodes)
    >>> round(fit.carried, 6), round(fit.apart, 4)
    (0.01, 0.0935)
    """
    found = []
    half = Window(0.5 * (run.t_begin + run.t_end), run.t_end)
    for tangent in tangents:
        charge, square = (power_integral(run, f"{tangent.name}.f", half, k) for k in (1, 2))
        if charge <= 0.0:
            continue
        carried = square / charge
        ratio = carried / tangent.current
        apart = tangent.emission * (ratio - 1.0 - math.log(ratio))
        if apart > TOLD and max(ratio, 1.0 / ratio) > OFF:
            found.append(Fit(tangent, carried, apart))
    return found
