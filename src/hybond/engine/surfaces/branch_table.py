"""The branches of junction laws that are known of modes around surfaces."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import grow_places
from hybond.engine.model import Model
from hybond.engine.surfaces.slide_records import Slide
from hybond.engine.words import Ints

UNKNOWN: Final = -1


def find_branches(m: Model, s: Slide, state: Ints) -> int:
    """Return the row of the mode whose other machines are as in `state`, or UNKNOWN."""
    for row in range(s.branches):
        same = True
        for k in range(m.machines):
            here = s.branch.at[row * m.machines + k]
            same = same and (m.is_law[k] != 0 or here == state[k])
        if same:
            return row
    return UNKNOWN


def take_branches(m: Model, s: Slide, state: Ints) -> None:
    """Give a mode the branches that are known of it."""
    if m.laws == 0:
        return
    row = find_branches(m, s, state)
    for k in range(m.machines if row >= 0 else 0):
        state[k] = s.branch.at[row * m.machines + k]


def add_branches(m: Model, s: Slide, state: Ints) -> None:
    """Note the branches of a mode."""
    grow_places(s.branch, (s.branches + 1) * m.machines)
    for k in range(m.machines):
        s.branch.at[s.branches * m.machines + k] = state[k]
    s.branches += 1
