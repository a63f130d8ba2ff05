"""Quantised states: QSS1 to QSS3, and LIQSS1 to LIQSS3 for stiff models.

Instead of asking where the state is at given times, ask when it has moved by a quantum. Each state
`x` is seen by the others only through its quantised state `q`, a polynomial one degree lower::

    x' = field(t, q)        between quantum events x is a polynomial of the method's order
    when |x_i - q_i| has grown to the quantum of i:  q_i starts anew from x_i (a quantum event)

The quantum is the tolerance of a state, read at each of its events. A step ends at the next quantum
event of any state, where rates are no longer known (`qss_linear`, `qss_fit`), or at `t_end`; its
dense output is that polynomial itself.

In a stable linear system ``x' = A x + b`` the error is never more than ``|V| |Re(L)^-1 L| |V^-1|``
times the quantum, with ``A = V L V^-1``, whatever the order. Sources: E. Kofman, Simulation 78(2),
2002, and Latin American Applied Research 36, 2006; E. Kofman, S. Junco, Proc. ICBGM 2001; F. E.
Cellier, E. Kofman, Continuous System Simulation, 2006, chapters 11 and 12.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.methods.explicit.dopri import begin_step, spacing
from hybond.engine.methods.quantised.qss_events import foresee, foresee_all, let_happen, next_event
from hybond.engine.methods.quantised.qss_fit import confirm_fit, fit_rates, rate_not_finite
from hybond.engine.methods.quantised.qss_linear import take_generators
from hybond.engine.methods.quantised.qss_room import Quantised, X, move_origin
from hybond.engine.reasons.facts import add_fact

TOGETHER: Final = 1e-6
"""Quantum events this close, as a part of the step before them, are made together."""
CROWD: Final = 100
"""Steps in a row too short to advance time after which the run is given up."""


def qss_step(e: Engine, t_end: float) -> int:
    """Go to the next quantum event of any state, to where rates are not known, or to `t_end`."""
    s = e.step
    a = e.quantised
    begin_step(e)
    s.rejected = 0
    arrive(e, a)
    while True:
        if a.stale:
            foresee_all(a)
            most = min(e.model.max_step, e.longest)
            horizon = min(min(t_end, next_event(a)) - a.t, most)
            found = fit_rates(e, a, horizon)
            if found != OK:
                return found
            foresee_all(a)
            a.stale = False
        t1 = end_of_step(e, a, t_end)
        if a.crowded > CROWD:
            return too_crowded(e, a, t1 - s.t0)
        if not a.linear:
            sure = confirm_fit(e, a, t1 - s.t0)
            if sure != OK:
                return sure
            if a.stale:
                s.rejected += 1
                continue
        return take_step(e, a, t1)


def arrive(e: Engine, a: Quantised) -> None:
    """Go to where the last step ended, and do what is due there."""
    s = e.step
    move_origin(a, s.t0 - a.t)
    a.t = s.t0
    for i in range(a.states):
        a.x[X * i] = s.y0[i]
    # those that were put back on their constraints may have been pushed out of their bands
    foresee(a)
    any_due = False
    for i in range(a.states):
        a.due[i] = 1 if a.leaves[i] <= s.t0 + TOGETHER * a.h else 0
        any_due = any_due or a.due[i] != 0
    if any_due:
        let_happen(e, a)
    if s.t0 >= a.until:
        if a.linear:
            take_generators(e, a, e.exact.flow)
        else:
            a.stale = True
    foresee(a)


def end_of_step(e: Engine, a: Quantised, t_end: float) -> float:
    """Return where the step ends."""
    t = a.t
    smallest = 4.0 * spacing(t)
    t1 = min(min(next_event(a), a.until), t + min(e.model.max_step, e.longest))
    a.crowded = a.crowded + 1 if t1 < t + smallest else 0
    t1 = max(t1, t + smallest)
    return t_end if t1 > t_end - smallest else t1


def too_crowded(e: Engine, a: Quantised, h: float) -> int:
    """Refuse a run whose quantum events leave no time between them, with the state to blame."""
    found = say_fault(e, "HB-N201", "step size underflow", "")
    if e.model.tells != 0:
        blamed = -1
        for i in range(a.states):
            if blamed < 0 or a.leaves[i] < a.leaves[blamed]:
                blamed = i
        add_fact(e.fault, h)
        add_fact(e.fault, float(blamed))
    return found


def take_step(e: Engine, a: Quantised, t1: float) -> int:
    """Make the step of the present motion to `t1`, with its dense output."""
    s = e.step
    n = a.states
    h = t1 - s.t0
    power = 1.0
    copy_floats(n, s.y0, s.y1)
    for k in range(X):
        power *= h
        for i in range(n):
            s.dense[k * n + i] = power * a.x[X * i + k + 1] if k < a.order else 0.0
            s.y1[i] += s.dense[k * n + i]
    if not all_finite(n, s.y1):
        return rate_not_finite(e, h, False)
    a.h = h
    s.t1 = t1
    s.t = t1
    copy_floats(n, s.y1, s.y)
    return OK


def qss_retry(e: Engine, t_end: float) -> int:
    """Cut the last step off at `t_end`: the same polynomials."""
    return take_step(e, e.quantised, t_end)
