"""The modes around the surfaces that a state has met."""

from __future__ import annotations

from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.engine import OK, Engine
from hybond.engine.laws.branches import know_branches
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.combine import take_parts
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats


def take_met(e: Engine, first: int, many: int, product: bool) -> int:
    """Take some of the surfaces met as those to be combined, with the modes around them."""
    s = e.slide
    copy_places(many, s.met_surface, first, s.side, 0)
    know_branches(e, s.around, many, product, s.side)
    s.k = many
    s.product = product
    s.has_last = False
    return take_parts(e, s.around)


def find_field(e: Engine, rate: Floats) -> bool:
    """Put the rates of the present state in ``e.mode`` there; False if there are none."""
    m = e.model
    # what stands does so in the mode that is left
    stood = e.standing.some
    e.standing.some = False
    for k in range(m.slots):
        e.v[m.slots + k] = 0.0
    copy_part(m.switches + m.state_first[m.machines], e.mode.flags, 0, e.v, m.on_slot)
    put_limits(e, e.mode, e.v)
    # functions of surfaces may read any bond variable
    found = field(e, e.mode, e.t, e.y, rate) == OK and solve(e, e.mode, e.v) == OK
    e.standing.some = stood
    return found
