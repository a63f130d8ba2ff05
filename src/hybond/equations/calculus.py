"""Laws in the names of bonds, and derivatives: along a bond variable, and along time."""

from __future__ import annotations

from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Neg,
    Number,
    differentiate,
    simplify,
    substitute,
    turning,
)
from hybond.model.expressions import names as names_of
from hybond.model.graph import FlatGraph, Node, Storage


def rate_name(storage: Storage) -> Expr:
    """Return the rate of a stored quantity: the flow into a C, the effort into an I."""
    if storage.kind == "I":
        return Name(f"e:{storage.bond}")
    flow = Name(f"f:{storage.bond}")
    return flow if storage.sign > 0 else Neg(flow)


def partial_time(e: Expr, graph: FlatGraph) -> Expr:
    """Return the time derivative of `e` along the motion, bond variables held still.

    Stored quantities move at their rates (which are bond variables), integrated signals at their
    integrands, inputs at ``du:k``. This is the inhomogeneous part of a hidden constraint.
    """
    total: Expr = Number(0.0)
    for name in sorted(names_of(e)):
        kind, _, index = name.partition(":")
        if kind == "time":
            rate: Expr = Number(1.0)
        elif kind == "u":
            rate = Name(f"du:{index}")
        elif kind == "s":
            rate = graph.integrals[int(index)].rate
        elif kind == "x":
            rate = rate_name(graph.storages[int(index)])
        else:
            continue
        total = Binary("+", total, Binary("*", differentiate(e, name), rate))
    return simplify(total)


def gradient(e: Expr) -> dict[str, Expr]:
    """Return the nonzero derivatives of `e` with respect to bond variables, by canonical name."""
    found = {}
    for name in sorted(names_of(e)):
        if name.startswith(("e:", "f:")):
            d = differentiate(e, name)
            if d != Number(0.0):
                found[name] = d
    return found


def bent(e: Expr) -> bool:
    """Whether `e` bends or jumps as a bond variable changes, which its slopes do not show."""
    return any(reads_bonds(a) for a in turning(e))


def reads_bonds(e: Expr) -> bool:
    """Whether `e` reads an effort or a flow a posteriori."""
    from hybond.model.expressions import posterior_names

    return any(n.startswith(("e:", "f:")) for n in posterior_names(e))


def localised(node: Node, expressions: tuple[Expr, ...]) -> list[Expr]:
    """Return laws with their local names replaced by those of the node's bonds."""
    local: dict[str, Expr] = {}
    many = len(node.ends) > 1
    for end in node.ends:
        k = str(end.port + 1) if many else ""
        local[f"law:e{k}"] = Name(f"e:{end.bond}")
        flow = Name(f"f:{end.bond}")
        local[f"law:f{k}"] = flow if end.inward else Neg(flow)
    return [substitute(e, local) for e in expressions]
