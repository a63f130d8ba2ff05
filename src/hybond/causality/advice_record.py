"""What advice says: resistors to add, their price, and all of it in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

AT_MOST = 3
"""Resistors that are proposed together."""


@dataclass(frozen=True, slots=True)
class Resistor:
    """A resistor to add."""

    name: str
    """A name that is free in the model."""
    kind: str
    """Whether it is in parallel (at a 0-junction) or in series (at a 1-junction)."""
    junction: str
    """The junction that it is connected to; a new one if `splits` names a bond."""
    splits: str
    """The bond in which the new junction is put, or empty."""
    value: float | None
    """The proposed resistance, SI. None if nothing bounds it, or no number is known."""
    time_constant: float | None
    """With that value, s."""
    gain: float | None
    """The time constant is ``R/gain`` in series, ``1/(R*gain)`` in parallel. 0 if no storage is
    driven by it, None if the law of one is not linear."""

    def stiffness(self, resistance: float) -> float | None:
        """Return the time constant, s, that a resistance makes; None if it makes none."""
        if not self.gain:
            return None
        return resistance / self.gain if self.kind == "1" else 1.0 / (resistance * self.gain)

    def bonds(self) -> tuple[str, ...]:
        """Return the bonds to write; they replace the one that is split."""
        if not self.splits:
            return (f"{self.junction} -> {self.name}",)
        tail, head = (end.strip() for end in self.splits.rpartition(":")[2].split("->"))
        return (f"{tail} -> {self.junction} -> {head}", f"{self.junction} -> {self.name}")


@dataclass(frozen=True, slots=True)
class Advice:
    """What would make the causality around some switches the same in all modes.

    Parameters
    ----------
    switches : tuple of str
        The controlled junctions and switched elements that turn strokes.
    bonds : tuple of str
        The bonds that they turn.
    storages : tuple of str
        The stored quantities that change between integral and derivative causality.
    resistors : tuple of Resistor
        What to add; empty if nothing was found.
    pins : mapping
        Bond to the node at its stroke: what has to be pinned with them, for a resistor may take
        either causality in a mode that leaves it the choice.
    fastest, slowest : float or None
        Time constants of the model in these modes, s; None if it has none or is not linear.
    text : str
        All of it in words.
    """

    switches: tuple[str, ...]
    bonds: tuple[str, ...]
    storages: tuple[str, ...]
    resistors: tuple[Resistor, ...]
    pins: Mapping[str, str]
    fastest: float | None
    slowest: float | None
    text: str


def advice_text(
    switches: tuple[str, ...],
    bonds: tuple[str, ...],
    storages: tuple[str, ...],
    resistors: tuple[Resistor, ...],
    pins: Mapping[str, str],
    constants: tuple[float, ...],
) -> str:
    """Return an advice as lines: what is turned, what to add, what it costs.

    The parameters are those of `Advice`; `constants` are time constants, fastest first.
    """
    lines = [f"Switching {_listed(switches)} turns {_listed(tuple(map(repr, bonds)))}"]
    if storages:
        verb = "is" if len(storages) == 1 else "are"
        lines[0] += f"; {_listed(storages)} {verb} integral or derivative, by the mode"
    lines[0] += "."
    if pins and not resistors:
        return f"{lines[0]}\nTheir own resistors absorb that: pin {_pinned(pins)}."
    if not resistors:
        return (
            lines[0] + f"\nNo {AT_MOST} resistors next to it make causality the same in all modes."
        )
    whole = "makes" if len(resistors) == 1 else "makes, with the others,"
    for k, r in enumerate(resistors):
        how = "in series" if r.kind == "1" else "in parallel"
        goal = f" {whole} causality the same in all modes" if k == len(resistors) - 1 else ""
        where = f"connect it to {r.kind}-junction {r.junction}"
        if r.splits:
            where = f"put a {r.kind}-junction {r.junction} into {r.splits!r}"
        written = ", ".join(f'"{bond}"' for bond in r.bonds())
        lines.append(f"A resistor {r.name} {how}{goal}: {where}, as in {written}.")
        lines.append(_price(r, constants))
    if pins:
        lines.append(f"Pin {_pinned(pins)}.")
    return "\n".join(lines)


def _pinned(pins: Mapping[str, str]) -> str:
    return _listed(tuple(f"{bond!r} at {node}" for bond, node in pins.items()), len(pins))


def _price(r: Resistor, constants: tuple[float, ...]) -> str:
    if r.gain is None:
        return "Its time constant depends on laws that are modulated or not linear."
    if not r.gain:
        return "It makes no time constant with storage: it costs accuracy only."
    tau = f"R*{1 / r.gain:.4g}" if r.kind == "1" else f"{1 / r.gain:.4g}/R"
    text = f"It makes a time constant of {tau} s"
    if r.value is None or r.time_constant is None:
        return f"{text}; the model has none to compare it with."
    text += f": with R = {r.value:.4g} SI {r.time_constant:.4g} s, "
    text += f"1/{constants[0] / r.time_constant:.4g} of the fastest ({constants[0]:.4g} s)"
    if constants[-1] > constants[0]:
        text += f", 1/{constants[-1] / r.time_constant:.4g} of the slowest ({constants[-1]:.4g} s)"
    return text + "."


def _listed(words: tuple[str, ...], most: int = 6) -> str:
    shown = list(words[:most])
    if len(words) > most:
        shown.append(f"{len(words) - most} more")
    return shown[0] if len(shown) == 1 else ", ".join(shown[:-1]) + " and " + shown[-1]
