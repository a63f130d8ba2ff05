"""What a problem of the speed table is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

C = "C"
"""The name of the tool that others are compared with."""


@dataclass(frozen=True)
class Outcome:
    """What one run of a tool gave.

    Parameters
    ----------
    seconds : float
    found : tuple of float
        Numbers from which the problem knows how accurate the run was.
    events : int
        How many events it had, 0 if nobody asks.
    """

    seconds: float
    found: tuple[float, ...]
    events: int = 0


Tool = Callable[[float], Outcome | None]
"""Does the job for a length, such as a number of cycles; None if it is not installed."""


def apart(found: tuple[float, ...], true: tuple[float, ...]) -> float:
    """Return the largest difference, as a part of the largest true value."""
    size = max(abs(a) for a in true)
    return max(abs(a - b) for a, b in zip(found, true, strict=True)) / size


@dataclass(frozen=True)
class Problem:
    """A job that grows with a length, and the tools that can do it.

    Parameters
    ----------
    key, title : str
    unit : str
        What the length counts.
    lengths, full : pair of float
        Two lengths for a quick table, and for a complete one.
    tools : mapping of str to Tool
        The one named `C` is the limit.
    true : callable
        What a perfect run of that length finds.
    note : str
        What the table says below the problem.
    size : float
        By which the costs of several problems of one key grow, 0 if there is one only.
    base : str
        The tool that the others are compared with.
    """

    key: str
    title: str
    unit: str
    lengths: tuple[float, float]
    full: tuple[float, float]
    tools: Mapping[str, Tool]
    true: Callable[[float], tuple[float, ...]] | None = None
    note: str = ""
    size: float = 0.0
    base: str = C


def points(length: float, longest: float) -> int:
    """Return how many output points a run has: 1,000 in the longest one, as dense in others."""
    return max(round(1000 * length / longest), 2)
