"""Diodes after a run: whether they carry the current at which they became straight lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.measures.chebyshev import WEIGHTS, coefficients, tails
from hybond.measures.pieces import Pieces, steps_of
from hybond.measures.window import Window
from hybond.result import Result

Vector = NDArray[np.float64]

OFF = 1.5
"""A current that is off by less is not told."""
TOLD = 1e-3
"""Nor is a drop that is off by less, V."""
CLOSE = 1e-3
"""To this part of its mean a current is read."""
LITTLE = 0.01
"""Where the last half of a run has less than this part of a diode's charge, all of it counts: a
surge, or what charges only once."""
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
        The mean of its current weighted with the charge, in the last half of the run, or in all of
        it if nearly all the charge came before, A.
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
    """Return the integrals of currents and of their squares, shape (tangents, 2)."""
    middle = 0.5 * (run.t_begin + run.t_end)
    last = _integrals(run, tangents, Window(middle, run.t_end))
    begin = Window(run.t_begin, middle)
    if not tangents or not _had_more(run, tangents, begin, last[:, 0]).any():
        found: list[list[float]] = last.tolist()
        return found
    first = _integrals(run, tangents, begin)
    early = last[:, 0] < LITTLE * (first[:, 0] + last[:, 0])
    sums: list[list[float]] = np.where(early[:, None], first + last, last).tolist()
    return sums


def _had_more(
    run: Result, tangents: Sequence[Tangent], begin: Window, charge: Vector
) -> NDArray[np.bool_]:
    """Whether a diode seems to have carried far more charge in the first half than later on."""
    if begin.length <= 0.0:
        return np.zeros(len(tangents), bool)
    steps = together(steps_of(run, begin), STEPS)
    names = [f"{tangent.name}.f" for tangent in tangents]
    flat = run._of(names, steps.segment, 0.5 * (steps.low + steps.high))
    about = np.reshape(flat, (len(names), -1)) @ (steps.high - steps.low)
    had: NDArray[np.bool_] = LITTLE * about > 0.1 * charge
    return had


def _integrals(run: Result, tangents: Sequence[Tangent], half: Window) -> Vector:
    """Return those of a part of the run.

    All diodes are read in one go: to solve the circuit at a point costs more than to read it.
    """
    names = [f"{tangent.name}.f" for tangent in tangents]
    sums = np.zeros((len(names), 2))
    if not names or half.length <= 0.0:
        return sums
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
    return sums


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
