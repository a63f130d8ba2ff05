"""What a node demands of the strokes at its ends in one mode."""

from __future__ import annotations

from enum import IntEnum

from hybond.causality.record import HEAD, TAIL, Because
from hybond.model.graph import Node
from hybond.model.kinds import RESISTORS, SOURCES, TWO_PORTS, Variable


class Demand(IntEnum):
    """How a node joins the strokes at its ends."""

    NONE = 0
    """Each end for itself: an element, or a junction that is OFF."""
    ONE_EFFORT = 1
    """Exactly one bond brings effort in: a 0-junction; a transformer passes it on."""
    ONE_FLOW = 2
    """Exactly one bond brings flow in: a 1-junction."""
    ALIKE = 3
    """Both bonds bring effort in or neither does: a gyrator."""


def demand_of(node: Node, off: frozenset[int]) -> Demand:
    """Return how `node` joins the strokes at its ends when the nodes in `off` are OFF."""
    if node.index in off or (node.kind in TWO_PORTS and _zero_row(node, 0)):
        return Demand.NONE
    if node.kind in ("0", "TF"):
        return Demand.ONE_EFFORT
    if node.kind == "1":
        return Demand.ONE_FLOW
    return Demand.ALIKE if node.kind == "GY" else Demand.NONE


def fixed_ends(node: Node, off: frozenset[int]) -> list[tuple[int, Variable, Because]]:
    """List what `node` must impose: positions in `node.ends`, the variable, the rule.

    A transformer of modulus zero shorts side 1 and opens side 2; a gyrator shorts both sides. A
    resistor whose law is exactly zero imposes that zero; a junction with one bond lets no
    conjugate through: a 0-junction no flow, a 1-junction no effort.
    """
    every = range(len(node.ends))
    if node.kind in SOURCES:
        imposes = node.about.imposes
        assert imposes is not None
        return [(k, imposes, "source") for k in every]
    if node.is_junction:
        zero: Variable = "e" if node.kind == "0" else "f"
        if node.index in off:
            return [(k, zero, "off") for k in every]
        if len(node.ends) == 1:
            return [(0, "f" if zero == "e" else "e", "zero")]
        return []
    if node.kind in TWO_PORTS and (node.index in off or _zero_row(node, 0)):
        rule: Because = "off" if node.index in off else "zero"
        second: Variable = "f" if node.kind == "TF" else "e"
        return [(k, "e" if node.ends[k].port == 0 else second, rule) for k in every]
    if node.kind in RESISTORS and node.law is not None:
        output = node.law.output
        return [(k, output, "zero") for k in every if _zero_row(node, node.ends[k].port)]
    return []


def preferred(node: Node) -> Variable:
    """Return what a storage gives in integral causality, or a resistor by its law as written."""
    if node.kind in RESISTORS and node.law is not None:
        return node.law.output
    wanted = node.about.imposes or node.about.law
    assert wanted is not None
    return wanted


def imposing(inward: bool, variable: Variable) -> int:
    """Return the stroke with which a node imposes `variable` on a bond.

    Parameters
    ----------
    inward : bool
        Whether the half arrow of the bond points at the node.
    variable : {"e", "f"}
        What the node imposes.

    Examples
    --------
    >>> imposing(True, "e"), imposing(False, "e"), imposing(True, "f")
    (0, 1, 1)
    """
    here = HEAD if inward else TAIL
    return 1 - here if variable == "e" else here


def _zero_row(node: Node, row: int) -> bool:
    law = node.law
    return law is not None and law.matrix is not None and not any(law.matrix[row])
