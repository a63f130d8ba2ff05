"""Causality of one mode: fixed, pinned, preferred, then free; each step propagated at once.

The sequential causality assignment procedure of Karnopp and Rosenberg, with OFF junctions among
the fixed ones as in HYBRSIM (P. J. Mosterman, SIMULATION 78(1), 2002).
"""

from __future__ import annotations

from collections.abc import Mapping

from hybond.causality.account import account
from hybond.causality.arrays import compile_arrays
from hybond.causality.assignment import Assignment
from hybond.causality.record import Causality
from hybond.model.graph import FlatGraph, Mode
from hybond.uncollected import uncollected


@uncollected
def assign(graph: FlatGraph, mode: Mode, *, pins: Mapping[int, int] | None = None) -> Causality:
    """Assign causality to all bonds of `graph` in `mode`.

    Parameters
    ----------
    mode : tuple of int
        The state of each machine.
    pins : mapping, optional
        Bond index to `TAIL` or `HEAD`: strokes set after the fixed ones, before storage. Without
        it those of the graph.

    Returns
    -------
    Causality
        Complete even if there are conflicts: it lists them, and keeps the first of two causes.

    Notes
    -----
    The ports of a field are taken one by one, as if each could have either causality.

    Examples
    --------
    Two capacitors in parallel: the second one follows the first.

    >>> import hybond as hb
    >>> m = hb.Model("two")
    >>> m.add(J=hb.Sf(1), c1=hb.C(1), c2=hb.C(2), node=hb.Zero())
    >>> m.bond("J -> node -> c1", "node -> c2")
    >>> graph = m.flatten()
    >>> causality = assign(graph, graph.start_mode)
    >>> [graph.storages[k].path for k in causality.derivative]
    ['c2.q']
    >>> graph.nodes[causality.stroke_at(1)].path, causality.chain(2)
    ('node', (1, 2))
    """
    return assign_off(graph, graph.off_nodes(mode), pins=pins)


@uncollected
def assign_off(
    graph: FlatGraph,
    off: frozenset[int],
    *,
    pins: Mapping[int, int] | None = None,
    unknown: frozenset[int] = frozenset(),
) -> Causality:
    """Assign causality with the nodes `off` OFF, whether or not the machines can do that.

    Parameters
    ----------
    graph, pins
        As in `assign`.
    off : frozenset of int
        The controlled nodes that are OFF.
    unknown : frozenset of int
        Nodes that demand nothing: a conflict found without them is one whatever they are.
    """
    pins = graph.pins if pins is None else pins
    arrays = compile_arrays(graph, unknown=unknown, switched=off)
    work = Assignment(arrays, off=off, pins=pins)
    return account(graph, work, off=off, pins=pins, unknown=unknown)
