"""Sources that a jump takes for less than they say: what they read has an impulse.

A source is a pair of a finite part and an impulse as anything else. Where it is a fixed multiple of
what it reads, the jump has its impulse; elsewhere it acts with what is finite, and is held against
its pair here. Only where somebody will read it: `tells` of the model.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.expressions.paired import evaluate_pair
from hybond.engine.expressions.pairs import NOT_A_NUMBER, clear
from hybond.engine.jumps.trial import measure_trial, show_trial
from hybond.engine.mode.mode_records import Mode
from hybond.engine.reasons.warned import IMPULSE_LEFT_OUT, add_about, begin_warning

NONE: Final = 0
"""It gives no impulse, and would."""
OTHER: Final = 1
"""It was declared impulsive, and gives another one than it says."""
MEANINGLESS: Final = 2
"""What it says has no meaning for impulses."""
SAME: Final = 1e-9
"""Impulses that differ by less than this part of their terms are the same."""


def warn_of_left_out(e: Engine, mode: Mode) -> None:
    """Warn of sources that a jump which is written does not take at their word."""
    m = e.model
    if m.tells == 0 or not e.trial.jumps:
        return
    stack = e.work.stack
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0 or m.dynamic_pair[d] < 0 or not reads_impulse(e, d):
            continue
        show_trial(e, stack)
        clear(stack)
        measure_trial(e, m.dynamic_pair[d])
        evaluate_pair(m, m.dynamic_pair[d], stack)
        how = -1
        if stack.refused != 0:
            how = MEANINGLESS if stack.refused != NOT_A_NUMBER else -1
        else:
            left = math.fabs(stack.impulse[stack.top])
            other = m.dynamic_partner[d]
            own = other - m.bonds if other >= m.bonds else other + m.bonds
            least = max(e.floor[own], SAME * stack.impulse_size[stack.top])
            if left > least:
                how = OTHER if m.dynamic_impulsive[d] != 0 else NONE
        if how >= 0:
            begin_warning(e.warned, IMPULSE_LEFT_OUT, e.t)
            add_about(e.warned, float(m.dynamic_node[d]))
            add_about(e.warned, float(how))


def reads_impulse(e: Engine, d: int) -> bool:
    """Whether a variable that a row has a slope by carries an impulse."""
    m = e.model
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        if e.trial.jump[m.bond_slot + m.slope_column[p]] != 0.0:
            return True
    return False
