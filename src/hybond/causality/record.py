"""What an assignment of causality found: strokes, reasons, loops and conflicts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from hybond.model.graph import FlatGraph
from hybond.model.kinds import Variable
from hybond.records import dataclass

TAIL = 0
"""The stroke is at the tail: the tail receives effort, the head imposes it."""
HEAD = 1
"""The stroke is at the head: the head receives effort, the tail imposes it."""

Because = Literal["source", "off", "zero", "pin", "storage", "resistor", "free"]
"""What can start a chain: a source, an OFF junction, a law that is zero, a pin, or a choice."""


@dataclass(frozen=True, slots=True)
class Origin:
    """The element that a chain of strokes starts at."""

    node: int
    """The forcing element or junction; for a pin the node that receives the effort."""
    rule: Because
    """``"source"``, ``"off"`` (OFF junction or two-port), ``"zero"`` (a law that is zero, a
    junction with one bond), ``"pin"``, or a choice: ``"storage"``, ``"resistor"``, ``"free"``."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a bond has its stroke."""

    origin: Origin
    """Where its chain starts."""
    parent: int = -1
    """The bond before it on the chain, -1 at the start of one."""
    via: int = -1
    """The node that passes the stroke on from `parent`, -1 at the start."""
    ruled_out: tuple[int, ...] = ()
    """Only for a choice whose preferred stroke led to a conflict: the chosen bonds that, with the
    fixed ones, rule it out. `refused` says that it was ruled out, by those or by fixed strokes
    alone."""
    refused: bool = False
    """Whether the preferred stroke was tried and led to a conflict."""


@dataclass(frozen=True, slots=True)
class Conflict:
    """Two causes for one variable, or none.

    Parameters
    ----------
    node : int
        Where the two chains meet.
    bonds : tuple of int
        The bonds at `node` that disagree; all its bonds if none brings a cause.
    kind : {"over", "under"}
        Two causes, or a junction that gets none.
    chain_a, chain_b : tuple of int
        The bonds from each forcing element to `node`, that element's own bond first.
    origin_a, origin_b : Origin
        The forcing elements.
    gives : tuple of ("e" or "f", "e" or "f")
        The variable that each chain imposes on `node`. They differ only at a gyrator.
    switches : tuple of (str, bool)
        Paths of the controlled nodes that had a part in it, and whether they are ON.
    """

    node: int
    bonds: tuple[int, ...]
    kind: Literal["over", "under"]
    chain_a: tuple[int, ...]
    chain_b: tuple[int, ...]
    origin_a: Origin
    origin_b: Origin
    gives: tuple[Variable, Variable]
    switches: tuple[tuple[str, bool], ...]


@dataclass(frozen=True, slots=True)
class Causality:
    """The causality of one mode.

    Parameters
    ----------
    strokes : tuple of int
        `TAIL` or `HEAD` per bond.
    reasons : tuple of Reason
        Why, per bond.
    derivative : tuple of int
        The storages (indices of `FlatGraph.storages`) in derivative causality.
    resistors : mapping
        ``(node, port)`` to the variable that this resistor port imposes on its bond.
    loops : tuple of int
        Bonds whose stroke was chosen freely: each cuts an algebraic loop.
    conflicts : tuple of Conflict
        Empty if the mode has a causality. If not, the first of two causes has the stroke.
    ends : tuple of (int, int)
        Tail and head per bond.
    """

    strokes: tuple[int, ...]
    reasons: tuple[Reason, ...]
    derivative: tuple[int, ...]
    resistors: Mapping[tuple[int, int], Variable]
    loops: tuple[int, ...]
    conflicts: tuple[Conflict, ...]
    ends: tuple[tuple[int, int], ...]

    def stroke_at(self, bond: int) -> int:
        """Return the node at the stroke: the one that receives the effort of `bond`."""
        return self.ends[bond][self.strokes[bond]]

    def effort_imposed_by(self, bond: int) -> int:
        """Return the node that imposes the effort of `bond` (and receives its flow)."""
        return self.ends[bond][1 - self.strokes[bond]]

    def chain(self, bond: int) -> tuple[int, ...]:
        """Return the bonds from the forcing element to `bond`, both ends included."""
        found = [bond]
        while (bond := self.reasons[bond].parent) >= 0:
            found.append(bond)
        return tuple(reversed(found))


def changed(graph: FlatGraph, a: Causality, b: Causality) -> tuple[int, ...]:
    """Return the bonds of `graph` whose stroke differs between `a` and `b`."""
    return tuple(k.index for k in graph.bonds if a.strokes[k.index] != b.strokes[k.index])
