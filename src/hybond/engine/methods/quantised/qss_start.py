"""Where a run by quantised states begins to move in a mode: what that is like, and the quanta."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import row_times
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.dopri import goes_elsewhere
from hybond.engine.methods.linear.flow import take_flow
from hybond.engine.methods.quantised.qss_events import quantise_all
from hybond.engine.methods.quantised.qss_fit import ask_ahead, ask_aside, rate_not_finite
from hybond.engine.methods.quantised.qss_linear import read_generators, take_columns
from hybond.engine.methods.quantised.qss_room import Quantised, take_size, time_ahead
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats

NUDGE: Final = 0.1
"""A state put back on its constraints by less than this part of its quantum keeps its quanta."""
START: Final = 1e-3
"""A state with no size yet gets this part of the tolerance of what it is on its way to."""
IDLE_PART: Final = 1e-9
"""What goes nowhere is as large as this part of what goes farthest."""
TERMS_AHEAD: Final = 9


def qss_start(e: Engine, t: float, y: Floats, t_bound: float, jumped: bool) -> int:
    """Begin, or go on after an event."""
    s = e.step
    a = e.quantised
    forget = jumped or not s.started
    if not goes_elsewhere(e, t, y, forget):
        return OK
    if not forget:
        near = t == s.t1
        for i in range(a.states):
            if s.y[i] != s.y1[i]:
                near = near and math.fabs(s.y[i] - s.y1[i]) <= NUDGE * a.quantum[i]
                a.marked[i] = 1
        if near:
            return OK
    a.bound = t_bound
    if field(e, e.mode, t, s.y, s.f) != OK or not all_finite(a.states, s.f):
        copy_floats(a.states, s.f, a.rate)
        return rate_not_finite(e, 0.0, True)
    tolerance(e, s.y, s.y, s.scale)
    if forget:
        learn_field(e, a)
    for i in range(a.states):
        a.quantum[i] = max(s.scale[i], a.floor[i])
    if forget and a.implicit and not a.linear:
        ask_aside(e, a)
    quantise_all(e, a)
    return OK


def learn_field(e: Engine, a: Quantised) -> None:
    """Find out whether the mode is linear, and the least quanta in it."""
    s = e.step
    take_flow(e)
    # what is integrated along, and is not linear, asks for all rates anyway
    a.linear = e.exact.on and e.exact.alongs == 0
    a.reach = math.inf
    a.last_t = math.nan
    if a.linear:
        take_columns(a, e.exact.flow)
    else:
        take_size(a, a.states)
        a.reach = time_ahead(a, s.t)
    stored = e.model.storages
    sized = True
    known = True
    for i in range(a.states):
        a.floor[i] = 0.0
        sized = sized and (i >= stored or s.scale[i] > 0.0)
        known = known and sized and (i < stored or s.y[i] != 0.0)
    if known:
        return
    if a.linear:
        reach_by_matrix(e, a)
    else:
        reach_by_rates(e, a)
    farthest = 0.0
    for i in range(a.states):
        farthest = max(farthest, a.floor[i])
    if not (farthest > 0.0 and farthest < math.inf):
        farthest = 1.0
    for i in range(a.states):
        if not (a.floor[i] > 0.0 and a.floor[i] < math.inf):
            a.floor[i] = IDLE_PART * farthest
        a.floor[i] *= START * e.model.rtol
        if sized and (i < stored or s.y[i] != 0.0):
            a.floor[i] = 0.0  # what has a size needs no other


def reach_by_matrix(e: Engine, a: Quantised) -> None:
    """Put there how far each state gets within the shortest time constant of a linear mode."""
    f = e.exact.flow
    n = a.states
    span = min(f.unit, time_ahead(a, e.step.t))
    read_generators(e, f, e.step.t, a.term.at, n, 1)
    for i in range(n):
        a.term.at[i] = e.step.y[i]
        a.floor[i] = math.fabs(e.step.y[i])
    for k in range(min(a.size + 1, TERMS_AHEAD)):
        for j in range(a.size):
            a.power.at[j] = span / (float(k) + 1.0) * row_times(a.rows, j, a.term.at)
        for j in range(a.size):
            a.term.at[j] = a.power.at[j]
            if j < n:
                a.floor[j] = max(a.floor[j], math.fabs(a.term.at[j]))


def reach_by_rates(e: Engine, a: Quantised) -> None:
    """Put there how far each state gets while no rate changes by more than itself."""
    s = e.step
    span = time_ahead(a, s.t)
    changes = ask_ahead(e, a) == OK
    if changes:
        for i in range(a.states):
            if math.fabs(a.rate[i]) * span > math.fabs(s.f[i]) and s.f[i] != 0.0:
                span = math.fabs(s.f[i] / a.rate[i])
    for i in range(a.states):
        far = max(math.fabs(s.y[i]), span * math.fabs(s.f[i]))
        a.floor[i] = max(far, 0.5 * span * span * math.fabs(a.rate[i])) if changes else far
