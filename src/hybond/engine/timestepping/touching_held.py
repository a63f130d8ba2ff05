"""Contacts that touch, held against the speeds at which a step ends.

What touches at the beginning of a step and does not go apart is in the way of whatever moves in it:
no closed contact ends it slower than by its restitution. Whoever takes part is decided before, by
distances; where one that touches was left out, by a distance that is rounding of positions, the
impact goes past it, and balls that lie side by side are struck one after the other.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.complementarity.law_roles import CUT
from hybond.engine.engine import Engine
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import times_partner
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.reasons.noting import IMPACT, note_in_state
from hybond.engine.timestepping.step_laws import is_rounding
from hybond.engine.timestepping.step_records import Stepping

MISSED: Final = 1e-6
"""Part of the fastest speed of any contact below which one does not approach."""


def hold_touching(e: Engine, s: Stepping, p: Ports, h: float) -> None:
    """Note contacts that touched, were left out of the step just made, and approach at its end.

    `s.v0` are the values at its beginning, `s.before` and `s.w` the speeds there and at its end.
    """
    m = e.model
    some = False
    for k in range(m.ports):
        some = some or (m.port_gap_pair[k] >= 0 and e.laws.role[k] == CUT)
    if not some:
        return
    times_partner(m, p, s.w, s.wl)
    fastest = 0.0
    for k in range(m.ports):
        if m.port_gap_pair[k] >= 0:
            fastest = max(fastest, max(math.fabs(s.before[k]), math.fabs(s.wl[k])))
    may = MISSED * fastest
    for k in range(m.ports):
        if s.wl[k] < -may and s.before[k] <= may and is_left_out(e, s, p, k, h):
            note_in_state(e, e.state, e.t, IMPACT, k, math.fabs(s.wl[k]), fastest)


def is_left_out(e: Engine, s: Stepping, p: Ports, k: int, h: float) -> bool:
    """Whether port k is a contact that touched and had no part in the step.

    A gap that is nothing beside the motion in the step is held against its terms.
    """
    m = e.model
    gap = math.fabs(s.gap[k])
    if m.port_gap_pair[k] < 0 or e.laws.role[k] != CUT or p.given[k] != COMMON:
        return False
    if gap > MISSED * h * math.fabs(s.wl[k]):
        return False
    return is_rounding(e, s, k)
