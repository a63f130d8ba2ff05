"""The equations of junctions and two-ports as rows on efforts, then flows, of all bonds."""

from __future__ import annotations

from hybond.model.graph import Node

Row = dict[int, float]


def junction_rows(node: Node, bonds: int, *, off: bool) -> list[Row]:
    """Return the rows ``sum of coefficient * variable = 0`` of a junction, ON or OFF."""
    common, other = (0, bonds) if node.kind == "0" else (bonds, 0)
    if off:
        return [{common + end.bond: 1.0} for end in node.ends]
    if not node.ends:
        return []
    first = node.ends[0].bond
    equal = [{common + end.bond: 1.0, common + first: -1.0} for end in node.ends[1:]]
    return [*equal, {other + end.bond: float(end.sign) for end in node.ends}]


def two_port_rows(node: Node, modulus: float, bonds: int) -> list[Row]:
    """Return the rows of a transformer or gyrator; port 1 takes power in, port 2 gives it out."""
    one, two = node.ends
    e1, e2, f1, f2 = one.bond, two.bond, bonds + one.bond, bonds + two.bond
    s1, s2 = (1.0 if one.inward else -1.0), (-1.0 if two.inward else 1.0)
    if node.kind == "TF":
        return [{e1: 1.0, e2: -modulus}, {f2: s2, f1: -modulus * s1}]
    return [{e1: 1.0, f2: -modulus * s2}, {e2: 1.0, f1: -modulus * s1}]
