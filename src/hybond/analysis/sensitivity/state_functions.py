"""Switching functions as functions of states, time and parameters only."""

from __future__ import annotations

from hybond.analysis.sensitivity.tangent import Undetermined
from hybond.analysis.sensitivity.wanted import followed, stored_law
from hybond.model.expressions import Expr, Neg, names, substitute
from hybond.model.graph import FlatGraph


def state_function(graph: FlatGraph, g: Expr) -> Expr:
    """Return an expression in which bond variables that storage sets are laws of what is stored.

    Raises
    ------
    Undetermined
        If it reads other bond variables.
    """
    laws = _set_by_storage(graph)
    found = followed(substitute(g, {n: laws[n] for n in names(g) if n in laws}))
    left = [n for n in names(found) if n.startswith(("e:", "f:"))]
    if left:
        raise Undetermined("the surface that is slid on reads more than what is stored")
    return found


def _set_by_storage(graph: FlatGraph) -> dict[str, Expr]:
    """Return the bond variables that are the co-energy variable of a storage, as its law."""
    found: dict[str, Expr] = {}
    for s in graph.storages:
        law = stored_law(graph, s)
        kind = "e" if s.kind == "C" else "f"
        own: Expr = Neg(law) if s.kind == "I" and s.sign < 0 else law
        found[f"{kind}:{s.bond}"] = own
        bond = graph.bonds[s.bond]
        for at in (bond.tail, bond.head):
            node = graph.nodes[at]
            if node.kind == ("0" if s.kind == "C" else "1") and not node.controlled:
                found.update({f"{kind}:{end.bond}": own for end in node.ends})
    return found
