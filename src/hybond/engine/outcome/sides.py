"""The machine that slides where a jump inside a law cannot, written out for the model at hand."""

from __future__ import annotations

from hybond.equations.calculus import localised
from hybond.errors import HybondError
from hybond.model.expressions import (
    Call,
    Compare,
    Expr,
    Name,
    Number,
    children,
    names,
    simplify,
    to_text,
)
from hybond.model.expressions.kinks import leaping
from hybond.model.expressions.tree import walk, with_children
from hybond.model.graph import FlatGraph

UP, DOWN = "above", "below"


def machine_instead(graph: FlatGraph, path: str) -> str:
    """Return the machine to add, and what the law is to read; "" where it has several jumps.

    Parameters
    ----------
    path : str
        Of the element whose law jumps, or of the signal whose rate does.
    """
    laws = _laws(graph, path)
    turns = list(dict.fromkeys(h for e in laws for h in leaping(e)))
    asked = list(dict.fromkeys(a for e in laws for a, _ in walk(e) if _is_asked(a)))
    if len(turns) != 1 or len(asked) != 1 or not path.isidentifier() or graph.condition is None:
        return ""
    try:
        turn = to_text(simplify(_named(graph, _seen(graph, path, turns[0]))))
        old = to_text(_named(graph, asked[0]))
        graph.condition(f"{turn} > 0")
    except (HybondError, LookupError):
        return ""  # what has no name that could be written
    machine = f"{path}_side"
    above = not isinstance(asked[0], Compare) or asked[0].op in (">", ">=")
    held = f"{machine}.state == '{UP if above else DOWN}'"
    new = held if isinstance(asked[0], Compare) else f"(if {held} then 1 else -1)"
    return (
        f"[machines.{machine}] with states = {{ {DOWN} = [], {UP} = [] }}, start = '{DOWN}' and "
        f"rules = ['{DOWN} -> {UP} when {turn} > 0', '{UP} -> {DOWN} when {turn} < 0'] slides, if "
        f"{path} has {new} in place of {old}"
    )


def _laws(graph: FlatGraph, path: str) -> tuple[Expr, ...]:
    for node in graph.nodes:
        if node.path == path and node.law is not None:
            return node.law.expressions
    return tuple(i.rate for i in graph.integrals if i.path == path)


def _seen(graph: FlatGraph, path: str, e: Expr) -> Expr:
    """Return what is in an element's own variables as it is read from outside."""
    for node in graph.nodes:
        if node.path == path:
            return localised(node, (e,))[0]
    return e


def _is_asked(e: Expr) -> bool:
    jumps = isinstance(e, Compare) or (isinstance(e, Call) and e.function == "sign")
    return jumps and bool(names(e))


def _named(graph: FlatGraph, e: Expr) -> Expr:
    """Return an expression in the names that a model file has for what it reads."""
    for name, value in graph.signals.items():
        if e == value and name.isidentifier() and not isinstance(e, Number):
            return Name(name)
    if isinstance(e, Name) and ":" in e.path:
        return Name(_name(graph, e.path))
    return with_children(e, tuple(_named(graph, a) for a in children(e)))


def _name(graph: FlatGraph, slot: str) -> str:
    """Return how a model file calls what stands in a slot; LookupError if it does not."""
    kind, _, index = slot.partition(":")
    if kind == "law":
        return index
    if kind == "s":
        return graph.integrals[int(index)].path
    if kind == "u":
        return graph.inputs[int(index)].path
    if kind == "x":
        return graph.storages[int(index)].path
    if kind not in ("e", "f"):
        raise LookupError(slot)
    bond = graph.bonds[int(index)]
    ends = [graph.nodes[k] for k in (bond.tail, bond.head)]
    shared = "0" if kind == "e" else "1"
    for node in ends:
        if node.kind == shared and not node.hidden:
            return f"{node.path}.{kind}"
    for node in ends:
        if len(node.ends) == 1 and not node.hidden and not node.implied:
            return f"{node.path}.{kind}"
    raise LookupError(slot)
