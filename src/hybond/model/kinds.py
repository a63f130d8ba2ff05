"""The kinds of node of a bond graph: one record each, which everything else reads.

Adding a kind means adding a record here; causality, equations and drawing look up what they
need (ports, energy, fixed or preferred causality, symbol) and never compare names by hand.
"""

from __future__ import annotations

from typing import Literal

from hybond.records import dataclass

Variable = Literal["e", "f"]


@dataclass(frozen=True, slots=True)
class Kind:
    """What all nodes of one kind have in common."""

    name: str
    """The symbol of the field, ``"C"``; also the key in a model file."""
    meaning: str
    """A phrase for messages."""
    least: int = 1
    most: int | None = 1
    """`least` and `most`: number of bonds; None is no limit."""
    energy: Literal["q", "p"] | None = None
    """The stored quantity: displacement, momentum or nothing."""
    imposes: Variable | None = None
    """The variable that the element gives to its bond: always (a source), or preferably (a storage
    in integral causality)."""
    fixed: bool = False
    """Whether `imposes` is a must."""
    law: Variable | None = None
    """The variable on the left of the law as written with a plain value (``R``: ``e = R f``)."""

    @property
    def symbol(self) -> str:
        """The letter drawn: a conductance is an R, as in the textbooks."""
        return "R" if self.name == "G" else self.name


KINDS: dict[str, Kind] = {
    k.name: k
    for k in (
        Kind("C", "capacitance, spring", most=None, energy="q", imposes="e", law="e"),
        Kind("I", "inertia, inductance", most=None, energy="p", imposes="f", law="f"),
        Kind("R", "resistance", most=None, law="e"),
        Kind("G", "conductance", most=None, law="f"),
        Kind("Se", "effort source", imposes="e", fixed=True, law="e"),
        Kind("Sf", "flow source", imposes="f", fixed=True, law="f"),
        Kind("TF", "transformer", least=2, most=2),
        Kind("GY", "gyrator", least=2, most=2),
        Kind("0", "junction of common effort", least=0, most=None),
        Kind("1", "junction of common flow", least=0, most=None),
    )
}

JUNCTIONS = ("0", "1")
TWO_PORTS = ("TF", "GY")
SOURCES = ("Se", "Sf")
STORAGES = ("C", "I")
RESISTORS = ("R", "G")


def law_hint(kind: str, form: str) -> str:
    """Return what to write instead of ``law`` at an element; `form` as one does where one is."""
    if kind not in STORAGES + RESISTORS:
        return "only junctions have laws"
    own = form.format(kind=kind, of=KINDS[kind].law)
    return f"a formula stands in place of its value, {own}; only junctions have laws"
