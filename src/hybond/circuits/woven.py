"""A bond graph under way, and where the voltages and currents of a circuit are found in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from hybond.circuits.behaviour import Law
from hybond.circuits.graph_names import GraphNames
from hybond.circuits.leaves import Leaf
from hybond.circuits.notices import Line
from hybond.model.parts import Part

Terms = tuple[tuple[int, str], ...]
"""A sum: sign and name of each term."""


@dataclass
class Woven:
    """A bond graph under way, and where voltages and currents are found in it."""

    leaves: Sequence[Leaf]
    """The branches of the circuit, which the numbers below count."""
    names: GraphNames
    elements: dict[str, Part] = field(default_factory=dict)
    """Name to part; of a source that is still to be said, the value is None."""
    bonds: list[tuple[str, str]] = field(default_factory=list)
    lines: dict[str, Line] = field(default_factory=dict)
    """Element to the line that it comes from."""
    drops: dict[int, Terms] = field(default_factory=dict)
    """Branch to its voltage from node a to node b; missing if nothing tells it."""
    currents: dict[int, Terms] = field(default_factory=dict)
    """Branch to its current from node a to node b."""
    potentials: list[tuple[int, int, str]] = field(default_factory=list)
    """A node, the node against which its voltage is counted, and the 0-junction that has it."""
    pending: list[tuple[str, int, int]] = field(default_factory=list)
    """Sources whose value follows from a controlling one: name, branch and sign."""
    idle: list[int] = field(default_factory=list)
    """Branches that no current can pass."""
    junctions: dict[int, str] = field(default_factory=dict)
    """Of each switch, its controlled junction."""
    inputs: dict[int, str] = field(default_factory=dict)
    """Of each source that is an input, its name."""
    signals: dict[str, str] = field(default_factory=dict)
    """Voltages of open windings."""
    measured: dict[str, str] = field(default_factory=dict)
    """Expressions that are measured, and their signals."""
    laws: dict[Law, str] = field(default_factory=dict)
    """What is measured, as written, and its signal."""
    own: list[str] = field(default_factory=list)
    """The name that each branch has, or would have."""

    def junction(self, kind: str, name: str, **options: Any) -> str:
        """Add a junction; return its name."""
        self.elements[name] = Part(kind, None, options)
        return name

    def bond(self, tail: str, head: str, sign: int = 1) -> None:
        """Add a bond; against its direction if `sign` is negative."""
        self.bonds.append((tail, head) if sign > 0 else (head, tail))

    def element(self, k: int, kind: str, value: Any, **options: Any) -> str:
        """Add the element of a branch; return its name."""
        name = self.own[k]
        self.elements[name] = Part(kind, value, options)
        self.lines[name] = self.leaves[k].branch.line
        return name


def written(terms: Sequence[tuple[int, str]]) -> str:
    """Return a sum of terms as text; equal terms of opposite sign are gone.

    Examples
    --------
    >>> written([(1, "a.e"), (-1, "b.e"), (1, "b.e"), (1, "c.e")]), written([(-1, "a.e")])
    ('a.e + c.e', '-a.e')
    """
    count: dict[str, int] = {}
    for sign, name in terms:
        count[name] = count.get(name, 0) + sign
    text = ""
    for name, times in count.items():
        if not times:
            continue
        factor = "" if abs(times) == 1 else f"{abs(times)}*"
        if not text:
            text = f"{'-' if times < 0 else ''}{factor}{name}"
        else:
            text += f" {'-' if times < 0 else '+'} {factor}{name}"
    return text or "0"
