"""The motion of a linear mode as the kernel propagates it (`c/exact.c`)."""

from __future__ import annotations

import numpy as np

from hybond.kernel.bytecode import Book, Declined
from hybond.kernel.structs import Filled
from hybond.programs.linear import LinearForm
from hybond.solvers.propagation import LEVELS, Propagator

LARGEST = 64
"""Size of a matrix that the kernel propagates by: its powers are full."""


def put_flow(mode: Filled, book: Book, form: LinearForm | None, states: int) -> None:
    """Put in the matrix of a mode, none if there is no `form`; `states` are all components.

    Raises
    ------
    Declined
        For what is too large, or not the same in all intervals.
    """
    m = mode.structure
    matrix = np.zeros((0, 0)) if form is None else form.matrix
    if len(matrix) > LARGEST:
        raise Declined(f"more than {LARGEST} states and generators to propagate exactly")
    if form is not None and form.timely:
        raise Declined("comparisons of time in what is propagated exactly")
    flow = Propagator(matrix)
    m.flow, m.flow_norm, m.flow_unit = len(matrix), flow.norm, flow.unit
    mode.put_rows("flow_matrix", flow.matrix)
    mode.put("flow_scale", flow.scale)
    moved = np.empty(0, dtype=np.intp) if form is None else form.states
    watched = moved if form is None else form.watched
    m.moved, m.watched = len(moved), len(watched)
    mode.put("moved_at", moved)
    mode.put("along", np.setdiff1d(np.arange(states), moved))
    mode.put("watched_at", watched)
    mode.put("generator_code", [] if form is None else [book.add(e) for e in form.generators])
    mode.put("levels", np.zeros(LEVELS * len(matrix) ** 2))
    mode.put("levels_known", np.zeros(1))
