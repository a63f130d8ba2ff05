"""Diodes after a run: whether they carry the current at which they became straight lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hybond.measures.chebyshev import WEIGHTS, coefficients, tails
from hybond.measures.pieces import Pieces, steps_of
from hybond.measures.window import Window
from hybond.result import Result

OFF = 1.5
"""A current that is off by less is not told."""
TOLD = 1e-3
"""Nor is a drop that is off by less, V."""
CLOSE = 1e-3
"""To this part of its mean a current is read."""
NOTHING = 1e-9
"""Nor is it read closer than to this part of the largest of all: what is smaller is rounding."""
STEPS = 8
"""Steps of the run that are read as one piece, if one polynomial is close enough to them."""
PIECES = 100_000
"""Pieces at the most: a current that needs more counts as it was read last."""


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
    for tangent, (charge, square) in zip(tangents, _powers(run, tangents), strict=True):
        if charge <= 0.0:
            continue
        carried = square / charge
        ratio = carried / tangent.current
        apart = tangent.emission * (ratio - 1.0 - math.log(ratio))
        if apart > TOLD and max(ratio, 1.0 / ratio) > OFF:
            found.append(Fit(tangent, carried, apart))
    return found


def _powers(run: Result, tangents: Sequence[Tangent]) -> list[list[float]]:
    """Return the integrals of currents and of their squares, shape (tangents, 2).

    All diodes are read in one go: to solve the circuit at a point costs more than to read it.
    """
    half = Window(0.5 * (run.t_begin + run.t_end), run.t_end)
    names = [f"{tangent.name}.f" for tangent in tangents]
    sums = np.zeros((len(names), 2))
    if not names or half.length <= 0.0:
        return sums.tolist()
    todo = together(steps_of(run, half), STEPS)
    count = 0
    while len(todo):
        t = todo.times()
        flat = run._of(names, np.repeat(todo.segment, t.shape[1]), t.ravel())
        read = np.reshape(flat, (len(names), *t.shape))
        charge, square = ((read**k @ WEIGHTS) * todo.half for k in (1, 2))
        mean = np.abs(charge.sum(axis=1) + sums[:, 0]) / half.length
        allowed = np.maximum(CLOSE * mean, NOTHING * np.abs(read).max())
        count += len(todo)
        ok = (tails(coefficients(read)) <= allowed[:, None]).all(axis=0) | (count > PIECES)
        sums += np.column_stack([charge[:, ok].sum(axis=1), square[:, ok].sum(axis=1)])
        todo = todo.part(~ok).halved()
    return sums.tolist()


def together(pieces: Pieces, many: int) -> Pieces:
    """Return up to so many pieces that follow each other in a segment as one.

    Examples
    --------
    >>> steps = Pieces(np.array([0, 0, 0, 1]), np.arange(4.0), np.arange(1.0, 5.0))
    >>> joined = together(steps, 2)
    >>> joined.low.tolist(), joined.high.tolist()
    ([0.0, 2.0, 3.0], [2.0, 3.0, 4.0])
    """
    count = np.arange(len(pieces))
    within = count - np.searchsorted(pieces.segment, pieces.segment)
    first = count[within % many == 0]
    last = np.append(first[1:], len(pieces)) - 1
    return Pieces(pieces.segment[first], pieces.low[first], pieces.high[last])
