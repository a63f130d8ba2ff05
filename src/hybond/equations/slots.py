"""Where each canonical name stands in the vector of values that laws and guards read.

One layout serves all modes: time, inputs, input rates, integrated signals, stored quantities,
efforts, flows, then Booleans. A second copy of the same length follows, the a priori values.
"""

from __future__ import annotations

from hybond.model.graph import FlatGraph
from hybond.records import dataclass


@dataclass(frozen=True, slots=True)
class Slots:
    """The layout for one graph."""

    index: dict[str, int]
    """Canonical name to slot."""
    size: int
    """Number of slots of one copy; ``pre(name)`` stands at ``index[name] + size``."""
    u: slice
    du: slice
    s: slice
    x: slice
    w: slice
    """`u`, `du`, `s`, `x` and `w`: inputs, input rates, integrated signals, stored quantities, and
    bond variables (all efforts, then all flows)."""
    on: slice
    states: slice
    at: slice
    """`on`, `states` and `at`: Booleans."""


def slots_of(graph: FlatGraph) -> Slots:
    """Return the layout of `graph`.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add(a=hb.C(1.0), b=hb.R(1.0))
    >>> m.bond("a -> b")
    >>> slots_of(m.flatten()).index
    {'time': 0, 'x:0': 1, 'e:0': 2, 'f:0': 3}
    """
    index = {"time": 0}

    def group(names: list[str]) -> slice:
        start = len(index)
        for name in names:
            index[name] = len(index)
        return slice(start, len(index))

    bonds = range(len(graph.bonds))
    u = group([f"u:{i.index}" for i in graph.inputs])
    du = group([f"du:{i.index}" for i in graph.inputs])
    s = group([f"s:{i.index}" for i in graph.integrals])
    x = group([f"x:{i.index}" for i in graph.storages])
    w = group([f"e:{b}" for b in bonds] + [f"f:{b}" for b in bonds])
    on = group([f"on:{n.index}" for n in graph.nodes if n.controlled])
    states = group([f"in:{m.index}:{k}" for m in graph.machines for k in range(len(m.states))])
    at = group([f"at:{a.index}" for a in graph.watches])
    return Slots(index, len(index), u, du, s, x, w, on, states, at)
