"""Storages whose law has no value where they start."""

from __future__ import annotations

import math

from hybond.engine.outcome.refusals import Said
from hybond.model.expressions import FLOATS, compile_expression, names
from hybond.model.expressions.text import to_text
from hybond.model.graph import FlatGraph, Node


def storage_at_start(graph: FlatGraph) -> Said | None:
    """Return what is to be said of the first storage whose law gives no number at its start.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("log", domain="electrical")
    >>> m.add(c=hb.C({"e": "1 V*log(q/(1 C))"}), r=hb.R("1 ohm"), n=hb.Zero())
    >>> m.bond("n -> c", "n -> r")
    >>> storage_at_start(m.flatten()).why
    'the law of C c, e = log(q), gives -inf at its start, q = 0'
    """
    starts: dict[int, dict[str, float]] = {}
    for s in graph.storages:
        node = graph.nodes[s.node]
        if s.start_is != "stored":
            continue  # the stored quantity is what the law is solved for
        suffix = str(s.port + 1) if len(node.ends) > 1 else ""
        starts.setdefault(s.node, {})[f"law:{node.about.energy}{suffix}"] = s.start
    for index, values in starts.items():
        found = _valueless(graph.nodes[index], values)
        if found is not None:
            return found
    return None


def _valueless(node: Node, values: dict[str, float]) -> Said | None:
    if node.law is None:
        return None
    for e in node.law.expressions:
        used = [name for name in values if name in names(e)]
        if names(e) - values.keys():
            continue
        slot = {name: k for k, name in enumerate(values)}
        try:
            value = float(compile_expression(e, slot, FLOATS, pre_offset=0)(list(values.values())))
        except (ArithmeticError, ValueError):
            value = math.nan
        if math.isfinite(value):
            continue
        given = ", ".join(f"{name[4:]} = {values[name]:g}" for name in used)
        formula = to_text(e).replace("law:", "")
        energy = node.about.energy
        return Said(
            f"the law of {node.kind} {node.path}, {node.law.output} = {formula}, "
            f"gives {value:g} at its start, {given}",
            f"elements.{node.path}.{node.kind}",
            f"give it a start at which the law has a value, {energy} = ...",
        )
    return None
