"""Putting a state back on the surfaces that it slides on."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.surfaces.blend import blend, solve_weights
from hybond.engine.surfaces.common_space import onto_all
from hybond.engine.surfaces.corners import put_slopes
from hybond.engine.surfaces.outputs import output_value, show_state
from hybond.engine.surfaces.surface import surface_value
from hybond.engine.words import Floats

OFTEN: Final = 3
"""Times that a state is put back on its surfaces."""


def onto_surfaces(e: Engine, t: float, y: Floats) -> int:
    """Put the state back on its surfaces, along the fields that hold it there."""
    s = e.slide
    n = e.states
    v = e.shown
    for _ in range(OFTEN):
        if s.common:
            show_state(e, t, y, v)
            onto_all(e, v, y)
        show_state(e, t, y, v)
        off = False
        for j in range(s.k):
            s.right[j] = side_value(e, j, v)
            off = off or s.right[j] != 0.0
        if not off:
            return OK
        if blend(e, v) != OK:
            return NOT_FINITE
        if is_left(e):
            return OK
        copy_floats(s.k * s.k, s.change, s.matrix)
        if solve_weights(e, s.right) != OK:
            return NOT_FINITE
        put_slopes(s)
        still = True
        for k in range(n):
            back = 0.0
            for j in range(s.k):
                back += s.right[j] * direction(e, j, k)
            moved = y[k] - back
            still = still and moved == y[k]
            y[k] = moved
        if still:
            return OK
        s.known = False
    return OK


def is_left(e: Engine) -> bool:
    """Whether a surface is left here: no switch holds its function."""
    s = e.slide
    for j in range(s.k):
        if s.gone[j] != 0:
            return True
    return False


def side_value(e: Engine, j: int, v: Floats) -> float:
    """Return a switching function at the time and state in `v`."""
    s = e.slide
    if s.of_state[j] != 0:
        return surface_value(e, s.side[j], v)
    copy_floats(2 * e.model.slots, v, s.ahead)
    return output_value(e, s.side[j], 0, s.ahead)


def direction(e: Engine, j: int, k: int) -> float:
    """Return how weight j moves state k."""
    s = e.slide
    total = 0.0
    for part in range(s.parts):
        total += s.by[part * s.k + j] * s.part_rate[part * e.states + k]
    return total
