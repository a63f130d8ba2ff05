"""Values of a motion where it begins, kept while those of a moment later are looked at."""

from __future__ import annotations

from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.values import set_state


def look_later(e: Engine, mode: Mode) -> None:
    """Keep the values of the present state, which are in `e.v`, until `come_back`."""
    hold_guess(e, mode)
    copy_part(2 * e.model.bonds, e.v, e.model.bond_slot, e.work.kept_bonds, 0)


def come_back(e: Engine, mode: Mode) -> None:
    """Write them anew; Newton's method begins for what comes from where it began before."""
    give_back_guess(e, mode)
    set_state(e, mode, e.v, e.t, e.y)
    if mode.dynamics == 0:
        copy_part(2 * e.model.bonds, e.work.kept_bonds, 0, e.v, e.model.bond_slot)
    else:
        solve(e, mode, e.v)
