"""Which stored quantities some mode may set."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

from hybond.export.modelica.solve import Form
from hybond.export.modelica.trees import check_count
from hybond.model.graph import FlatGraph, Mode


def jumping_of(graph: FlatGraph, form: Form) -> frozenset[int]:
    """Return the stored quantities that some mode may set on entry.

    Parameters
    ----------
    form : Form
        Its equations, as a jump sees them.

    Raises
    ------
    ModelError
        HB-E684 for too many modes.
    """
    if not any(form.constraint(row.at(mode, form.ring)) for row, mode in _rows(graph, form)):
        return frozenset()
    check_count(graph, form.machines, "the state on entry of a mode")
    found: set[int] = set()
    for mode in _modes(graph, form.machines):
        solution = form.jumps(mode)
        if solution is not None:
            found |= {k for k in range(form.n) if solution.value(k)}
    return frozenset(found)


def _rows(graph: FlatGraph, form: Form) -> Iterator[tuple[Any, Mode]]:
    """Yield each row with each mode in which it says something of its own."""
    for row in form.eq.rows:
        machines = sorted({m for p in row.parts for m in p.space.machines})
        check_count(graph, machines, "the rate of a stored quantity")
        for mode in _modes(graph, machines):
            if not form.void(mode):
                yield row, mode


def _modes(graph: FlatGraph, machines: Sequence[int]) -> Iterator[Mode]:
    """Yield the modes in which these machines differ."""
    mode = list(graph.start_mode)
    for states in product(*(range(len(graph.machines[m].states)) for m in machines)):
        for m, k in zip(machines, states, strict=True):
            mode[m] = k
        yield tuple(mode)
