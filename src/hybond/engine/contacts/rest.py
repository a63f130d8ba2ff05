"""The state at rest: a pinnacle's structure with every ``pre()`` term of its laws at its limit."""

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.constraints.impulse_ways import impulse_directions
from hybond.engine.contacts.landing_records import Landings
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.jumps.jump import enter_mode
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.surfaces.averages import freedom_here, sizes_here, solve_here
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.values import set_values
from hybond.engine.words import Floats, Ints

DUSTING: Final = 2
"""Times that rounding is swept off a state at rest: what is left would do work for ever."""
STILL: Final = 1e-15
"""What a contact at rest holds still is at rest below this part of what all the energy of its
part would make of it: else the sign of a rounding error could close a contact that is to open."""


def find_moved(e: Engine, held: Ints) -> None:
    """Note the storages that impulses of `e.mode` can move, at the values ``e.v``."""
    m = e.model
    ways = e.work.ways
    impulse_directions(e, e.mode, e.v, ways)
    for k in range(m.storages):
        at = rate_bond(m, k)
        held[k] = 0
        for j in range(ways.many):
            if ways.directions.at[at * ways.many + j] != 0.0:
                held[k] = 1


def still_stored(e: Engine, held: Ints, x: Floats) -> None:
    """Put rounding in storages that are held to zero."""
    m = e.model
    reach_of(e, e.mode, x, e.work.reach)
    for k in range(m.storages):
        if held[k] != 0 and math.fabs(x[k]) <= STILL * e.work.reach[k]:
            x[k] = 0.0


def find_rest(e: Engine, g: Landings, t: float, target: Ints) -> int:
    """Find what a mode makes of the state at rest, and what it then has to carry.

    The state is `g.x` and `g.s`, a priori values are ``e.pre``. The state at rest is then `g.x`,
    impulses are `g.area`, bond variables `g.force`, and the values ``e.v`` with sizes.
    """
    m = e.model
    if mode_of(e, target) != OK or combine_here(e, target) != OK:
        return REFUSED
    mode = e.mode
    set_values(e, mode, e.v, t, g.x, g.s)
    copy_part(m.slots, e.pre, 0, e.v, m.slots)
    put_limits(e, mode, e.v)
    for b in range(2 * m.bonds):
        e.v[m.bond_slot + b] = e.v[m.slots + m.bond_slot + b]
    for turn in range(DUSTING + 1):
        copy_part(m.storages, g.x, 0, e.v, m.stored_slot)
        if enter_mode(e, mode, e.v, g.x, e.trial.x) != OK:
            return REFUSED
        if turn == 0:
            copy_floats(2 * m.bonds, e.impulses, g.area)
        copy_floats(m.storages, e.trial.x, g.x)
    find_moved(e, g.moves)
    still_stored(e, g.moves, g.x)
    copy_part(m.storages, g.x, 0, e.v, m.stored_slot)
    if solve_here(e, mode, e.v) != OK:
        return REFUSED
    sizes_here(e, mode, e.v)
    for b in range(2 * m.bonds):
        g.force[b] = e.v[m.bond_slot + b]
        g.size[b] = e.work.sizes[b]
    g.loose = freedom_here(e, mode, e.v)
    fit(e.trial.freedom, 2 * m.bonds * g.loose)
    copy_floats(2 * m.bonds * g.loose, e.work.freedom.at, e.trial.freedom.at)
    return OK
