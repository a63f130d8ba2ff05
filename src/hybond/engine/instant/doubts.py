"""What is warned of at an instant. Only where somebody will read it: `tells` of the model."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.laws.law_friction import may_rest
from hybond.engine.laws.law_instant import quantity
from hybond.engine.mode.mode_records import Mode
from hybond.engine.reasons.warned import (
    HELD_AT_REST,
    MODULUS_JUMPS,
    add_about,
    begin_warning,
)

SAME: Final = 1e-12
"""Moduli that differ by less than this part of them have not jumped."""


def warn_of_moduli(e: Engine, mode: Mode) -> None:
    """Warn of moduli that a jump which is written makes others, its values being in `e.v`."""
    m = e.model
    if m.tells == 0 or not e.trial.jumps:
        return
    v = e.work.values
    for k in range(m.slots):
        v[k] = e.pre[k]
        v[m.slots + k] = e.pre[k]
    said = False
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0 or m.dynamic_follows[d] == 0 or not modulus_jumps(e, d):
            continue
        if not said:
            begin_warning(e.warned, MODULUS_JUMPS, e.t)
        said = True
        add_about(e.warned, float(m.dynamic_node[d]))


def modulus_jumps(e: Engine, d: int) -> bool:
    """Whether a two-port's row has other slopes than with the values a priori."""
    m = e.model
    for p in range(m.frozen_first[d], m.frozen_first[d + 1]):
        law = m.frozen_value[p]
        if law >= 0:
            before = value(m, law, e.work.values)
            behind = value(m, law, e.v)
            if math.fabs(behind - before) > SAME * (math.fabs(before) + math.fabs(behind)):
                return True
    return False


def warn_of_held(e: Engine) -> None:
    """Warn once of friction that slides by its branch and that others hold at rest.

    What holds more at rest than in motion counts with what it has in motion there: what each of
    them carries is not unique, and so is not when they break loose.
    """
    m = e.model
    mode = e.mode
    for k in range(m.ports):
        if not may_rest(m, k) or e.laws.held_said[k] != 0 or e.state[m.port_machine[k]] == 0:
            continue
        j = m.port_junction[k]
        if m.end_first[j] == m.end_first[j + 1]:
            continue
        b = m.end_bond[m.end_first[j]] + (0 if m.junction_kind[j] == 0 else m.bonds)
        breakaway = quantity(m, m.port_breakaway, m.port_breakaway_constant, k, e.v)
        limit = quantity(m, m.port_limit, m.port_limit_constant, k, e.v)
        if breakaway > limit and is_held(mode, b):
            e.laws.held_said[k] = 1
            begin_warning(e.warned, HELD_AT_REST, e.t)
            add_about(e.warned, float(k))


def is_held(mode: Mode, b: int) -> bool:
    """Whether the equations of a mode give a bond variable no other value than zero."""
    row = mode.same[b]
    held = mode.finite.first.at[row] == mode.finite.first.at[row + 1]
    held = held and mode.direct.first.at[row] == mode.direct.first.at[row + 1]
    for i in range(mode.finite_frees):
        held = held and mode.finite_free.at[b * mode.finite_frees + i] == 0.0
    return held
