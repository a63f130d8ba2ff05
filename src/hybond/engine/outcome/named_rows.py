"""The signals that records name: what a person calls the variables of a graph."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.model.graph import FlatGraph
from hybond.records import dataclass

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class NamedRows:
    """Signals that are signed sums of bond variables."""

    names: tuple[str, ...]
    """``x.e``, ``x.f`` of one-ports, the common variable of junctions, and the net variable of
    controlled ones."""
    name: NDArray[np.intp]
    variable: NDArray[np.intp]
    """Shape (terms,). `name` and `variable`: to which name each term belongs, and the bond variable
    that it takes."""
    sign: Vector
    """Shape (terms,)."""

    def of(self, w: Vector, floor: Vector) -> dict[str, float]:
        """Return the signals of `w` that stand out of `floor`, shape (2 * bonds,), by name."""
        n = len(self.names)
        values = np.bincount(self.name, self.sign * w[self.variable], n)
        limits = np.bincount(self.name, np.abs(self.sign) * floor[self.variable], n)
        return {
            name: float(a)
            for name, a, b in zip(self.names, values, limits, strict=True)
            if abs(a) > b
        }


def named_rows(graph: FlatGraph) -> NamedRows:
    """Return the named signals of a graph."""
    bonds = len(graph.bonds)
    names: list[str] = []
    entries: list[tuple[int, int, float]] = []

    def add(name: str, terms: list[tuple[int, float]]) -> None:
        entries.extend((len(names), k, sign) for k, sign in terms)
        names.append(name)

    implied = {n.ends[0].bond for n in graph.nodes if n.implied}
    for node in graph.nodes:
        if node.hidden or node.implied or not node.ends:
            continue
        if node.is_junction:
            common, other = ("e", "f") if node.kind == "0" else ("f", "e")
            first = 0 if common == "e" else bonds
            add(f"{node.path}.{common}", [(first + node.ends[0].bond, 1.0)])
            if node.controlled:
                net = [
                    (bonds - first + end.bond, float(end.sign))
                    for end in node.ends
                    if end.bond not in implied
                ]
                add(f"{node.path}.{other}", net)
            continue
        for end in node.ends:
            port = f".{end.port + 1}" if len(node.ends) > 1 else ""
            add(f"{node.path}{port}.e", [(end.bond, 1.0)])
            add(f"{node.path}{port}.f", [(bonds + end.bond, 1.0)])
    name, variable, sign = np.array(entries).reshape(-1, 3).T
    return NamedRows(tuple(names), name.astype(np.intp), variable.astype(np.intp), sign)
