"""Where Newton's method begins if laws have no values at zero: with what is known beside them.

A temperature that entropy flows are divided by, a pressure that a logarithm is taken of: unknowns
begin as the mean of what is known of their kind, then as each of the known ones. Unknowns of a kind
of which nothing is known begin with zero, then with 1 and some powers of ten, either way.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.damped import damped
from hybond.engine.mode.nonlinear.newton_system import system, with_free
from hybond.engine.words import Floats

KNOWN_ONES: Final = 12
"""So many of the known ones are tried, at the most."""
SIZES: Final = 7
"""0, 1, -1, 1e-3, -1e-3, 1e3, -1e3."""


def from_neighbours(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Go to a root, into `r`, from what is known of the kinds of the unknowns.

    Whether laws had values anywhere is `e.work.had_values`.
    """
    e.work.had_values = False
    for size in range(SIZES):
        for turn in range(KNOWN_ONES + 1):
            if not begin_beside(e, mode, turn, size_of_turn(size), r):
                break
            with_free(mode, 2 * e.model.bonds, e.work.base, r, e.work.w)
            rows = system(e, mode, v, e.work.w)
            if all_finite(rows, e.work.residual.at):
                e.work.had_values = True
                if damped(e, mode, v, r):
                    return True
    return False


def size_of_turn(turn: int) -> float:
    """Return what unknowns begin with of whose kind nothing is known."""
    if turn == 0:
        return 0.0
    size = 1.0 if turn <= 2 else 1e-3 if turn <= 4 else 1e3
    return size if turn % 2 == 1 else -size


def begin_beside(e: Engine, mode: Mode, turn: int, otherwise: float, r: Floats) -> bool:
    """Put what unknowns begin with there; False where no kind has so many known ones.

    In turn 0 the mean of the known ones, then each.
    """
    some_left = turn == 0
    for j in range(mode.finite_frees):
        kind = e.model.bond_class[mode.free_column[j]]
        many = 0
        total = 0.0
        own = 0.0
        for b in range(2 * e.model.bonds):
            if e.model.bond_class[b] == kind and e.work.base[b] != 0.0 and is_known(e, mode, b):
                many += 1
                total += e.work.base[b]
                if many == turn:
                    own = e.work.base[b]
        r[j] = otherwise
        if many > 0:
            r[j] = total / float(many) if turn == 0 or turn > many else own
        some_left = some_left or (turn > 0 and turn <= many)
    return some_left


def is_known(e: Engine, mode: Mode, b: int) -> bool:
    """Whether nothing that is free takes part in a bond variable, once of those that are one."""
    known = mode.same[b] == b and math.isfinite(e.work.base[b])
    for j in range(mode.finite_frees):
        known = known and mode.finite_free.at[b * mode.finite_frees + j] == 0.0
    return known
