"""A chain: the linear maps of a run's variations one after the other, and where it is read."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.collocation import Jump, VariationStep
from hybond.analysis.sensitivity.flow import MatrixStep
from hybond.analysis.sensitivity.landing import Landing

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Reading:
    """Where the chain is read.

    Parameters
    ----------
    place : int
        After how many links.
    t : float
    values : array, shape (outputs,)
    by : array, shape (outputs, n)
    direct : array, shape (outputs, parameters)
    """

    place: int
    t: float
    values: Vector
    by: Vector
    direct: Vector


@dataclass(frozen=True, slots=True)
class RunSwitch:
    """A switch of the run.

    Parameters
    ----------
    place : int or None
        Which link it is, None if it has no derivative.
    t : float
    text : str
        What became zero.
    event : int or None
        Its number in the run's table.
    """

    place: int | None
    t: float
    text: str
    event: int | None


@dataclass
class Chain:
    """The linear maps of a run."""

    start: Vector
    """Shape (n, parameters); more columns, which come first, where the start varies by itself."""
    links: list[VariationStep | MatrixStep | Jump | Landing] = field(default_factory=list)
    readings: list[Reading] = field(default_factory=list)
    instants: list[RunSwitch] = field(default_factory=list)
    ends: float | None = None
    """Where the derivative ends before the run does, s."""
    why: str = ""
    rough: list[float] = field(default_factory=list)
    """Where halving steps did not make two halves and the whole agree, s."""

    edges: list[tuple[str, list[str]]] = field(default_factory=list)
    """What is zero at the start and moves, and by which parameters."""
    last: list[str] = field(default_factory=list)
    """What moves a law's jump that lies at the very end, which is not made."""

    def notes(self) -> tuple[str, ...]:
        """Return what else is to be known."""
        found = [
            f"by {', '.join(by)} perhaps to one side only: the start lies on the edge of {text}"
            for text, by in self.edges
        ]
        if self.last:
            found.append(
                f"by {', '.join(self.last)} perhaps to one side only: the run ends where a law "
                "jumps, and the derivatives are those before its jump"
            )
        return (*found, *self.digits())

    def digits(self) -> tuple[str, ...]:
        """Return what is to be known of their digits."""
        if not self.rough:
            return ()
        near = f"near t = {self.rough[0]:.6g} s the derivatives have fewer digits"
        return (f"{near}: their motion is not smooth there",)

    def forward(self) -> list[Vector]:
        """Return the variations before the first link, and after each."""
        found = [self.start]
        for link in self.links:
            flat = link.after(found) if isinstance(link, Landing) else link.forward(found[-1])
            found.append(flat)
        return found
