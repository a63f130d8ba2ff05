"""Values of the names that formulas are printed in."""

from __future__ import annotations

from hybond.model.graph import FlatGraph


def parameter_values(graph: FlatGraph) -> dict[str, float]:
    """Return the values of all names ``p:...`` that formulas of `graph` use."""
    found = {f"p:{path}": float(v) for path, v in graph.parameters.items()}
    if graph.parametric is not None:
        for node in graph.nodes:
            if not node.is_junction and not node.hidden:
                found.update(graph.parametric(node.index).own)
    return found
