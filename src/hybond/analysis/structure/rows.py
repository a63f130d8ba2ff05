"""The records of a structural analysis: one row per mode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

from hybond.model.graph import Mode

Word = Literal["yes", "no", "no here", "-"]
"""``"no here"``: it holds for nearly all values of the elements, but not at the model's."""


@dataclass(frozen=True, slots=True)
class Property:
    """Controllability or observability of one mode.

    Parameters
    ----------
    finite, infinite, impulse : bool
        At the model's values (see `hybond.analysis.structure.controllability`).
    structural : tuple of three bool
        The same three at random values of all elements.
    by_paths : bool or None
        What causal paths and the derivative assignment say of `finite`; None if that was not
        asked, or causality has conflicts.
    rank : int
        Dimension of the controllable (observable) motion.
    modes : tuple of complex
        The poles that are not controllable (observable), 1/s.
    storages : tuple of str
        The stored quantities involved in them.
    unreached, stuck : tuple of str
        Storages that no causal path reaches; storages that stay in integral causality in the
        derivative assignment.
    margin : float
        Smallest scaled singular value of the test at the poles.
    sure : bool
        False if a rank was near its limit.
    """

    finite: bool
    infinite: bool
    impulse: bool
    structural: tuple[bool, bool, bool]
    by_paths: bool | None
    rank: int
    modes: tuple[complex, ...]
    storages: tuple[str, ...]
    unreached: tuple[str, ...]
    stuck: tuple[str, ...]
    margin: float
    sure: bool

    @property
    def actual(self) -> tuple[bool, bool, bool]:
        """At finite frequencies, at infinity, of impulses, at the model's values."""
        return self.finite, self.infinite, self.impulse

    @property
    def lost(self) -> tuple[str, ...]:
        """What holds for nearly all values but not at these."""
        names = ("finite", "at infinity", "impulse")
        return tuple(
            n for n, a, s in zip(names, self.actual, self.structural, strict=True) if s and not a
        )


@dataclass(frozen=True, slots=True)
class StiffWords:
    """Stiffness of one mode, in names."""

    ratio: float
    stiff: bool
    fastest: complex
    slowest: complex
    fast: tuple[str, ...]
    slow: tuple[str, ...]
    resistors: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ModeStructure:
    """The structure of one mode.

    Parameters
    ----------
    mode : tuple of int
    text : str
        The mode in words.
    refused : mapping or None
        Why there is no analysis: code, where, why, try. All else is then empty.
    states, order : int
        Stored quantities, and how many of them move by themselves.
    derivative : tuple of str
        Stored quantities in derivative causality.
    loops : tuple of str
        Bonds that cut an algebraic loop.
    conflicts : int
        Causal conflicts.
    solvable : bool
    index : int or None
        0 for an ordinary differential equation.
    impulse_free : bool or None
    poles : tuple of complex
        1/s.
    controllable, observable : Property or None
        None without inputs or outputs, or if the mode is not solvable.
    stiffness : StiffWords or None
    notes : tuple of str
    """

    mode: Mode
    text: str
    refused: Mapping[str, str] | None = None
    states: int = 0
    order: int | None = None
    derivative: tuple[str, ...] = ()
    loops: tuple[str, ...] = ()
    conflicts: int = 0
    solvable: bool | None = None
    index: int | None = None
    impulse_free: bool | None = None
    poles: tuple[complex, ...] = ()
    controllable: Property | None = None
    observable: Property | None = None
    stiffness: StiffWords | None = None
    notes: tuple[str, ...] = ()

    def record(self) -> dict[str, Any]:
        """Return the row as plain data; a pole is ``[real, imaginary]``."""
        found = _plain(asdict(self))
        assert isinstance(found, dict)
        return found


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    return value
