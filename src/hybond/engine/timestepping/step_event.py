"""Writing down a step of time-stepping: branches that changed, impacts, percussions, energy."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.instant.instant import (
    CONTINUOUS,
    PINNACLE,
    Instant,
    add_energy,
    begin_instant,
    note_fired,
    note_hit,
    note_step,
)
from hybond.engine.instant.told import OVER_A_STEP, add_read, say_why
from hybond.engine.laws.ports import times_partner
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.timestepping.step_records import Stepping
from hybond.engine.words import Ints

STEP: Final = 5
"""Why an instant is one: it stands for what happened somewhere in a step."""
NO_PERCUSSION: Final = 1e-12
"""Part of the largest percussion of its kind below which another one is none."""


def note_event(e: Engine, s: Stepping, i: Instant, h: float) -> bool:
    """Note the event of a step; False if no law changed its branch or was struck.

    Percussions are given where what was stored violated a law: they are those of the whole step,
    impulses and the little that forces do in it. The energy lost includes what was dissipated.
    """
    m = e.model
    bounced = False
    struck = False
    changed = False
    for k in range(m.machines):
        changed = changed or e.state[k] != s.before_state[k]
        s.through[k] = e.state[k]
    for k in range(m.ports):
        struck = struck or s.struck[k] != 0
        if s.struck[k] != 0 and s.restitution[k] > 0.0:
            bounced = True
            s.through[m.port_machine[k]] = m.port_bounce[k]
    if not changed and not bounced:
        return False
    begin_instant(i, e.t, STEP)
    i.since = s.t0
    before = energy_of(e, s.begin_y)
    after = energy_of(e, e.y)
    times_partner(m, e.laws.now, s.w, s.wl)
    if struck:
        note_percussions(e, s, i, h)
    if bounced:
        tell_laws_of_step(e, s, i, s.before_state, s.through)
        note_step(i, PINNACLE)
        add_energy(i, before, after, s.supplied)
        tell_laws_of_step(e, s, i, s.through, e.state)
        note_step(i, CONTINUOUS)
        add_energy(i, after, after, 0.0)
    else:
        tell_laws_of_step(e, s, i, s.before_state, e.state)
        note_step(i, CONTINUOUS)
        add_energy(i, before, after, s.supplied)
    return True


def note_percussions(e: Engine, s: Stepping, i: Instant, h: float) -> None:
    """Note the percussion of each bond variable that laws act on directly, of the whole step."""
    m = e.model
    effort = 0.0
    flow = 0.0
    for turn in range(2):
        for b in range(2 * m.bonds):
            area = 0.0
            for k in range(m.ports):
                area += h * s.now.direct.at[b * m.ports + k] * s.l[k]
            if turn == 0 and b < m.bonds:
                effort = max(effort, math.fabs(area))
            elif turn == 0:
                flow = max(flow, math.fabs(area))
            else:
                floor = NO_PERCUSSION * (effort if b < m.bonds else flow)
                if math.fabs(area) > floor:
                    note_hit(i, b, area, floor)


def tell_laws_of_step(e: Engine, s: Stepping, i: Instant, source: Ints, target: Ints) -> None:
    """Tell which laws changed their branches, with both variables of each at the end."""
    m = e.model
    for machine in range(m.machines):
        if source[machine] == target[machine]:
            continue
        note_fired(i, machine, source[machine], target[machine])
        say_why(i.told, OVER_A_STEP)
        for k in range(m.ports):
            if m.port_machine[k] != machine:
                continue
            is_common = e.laws.now.given[k] == COMMON
            common = s.l[k] if is_common else s.wl[k]
            net = -s.wl[k] if is_common else -s.l[k]
            add_read(i.told, common, 0.0, False)
            add_read(i.told, net, 0.0, False)
