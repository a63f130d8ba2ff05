"""Laws of junctions that stand as they are: the one answer, which need not be asked for.

Up to a timed event, or to a guard of a machine, the laws have stood in their branches. They are
decided anew there, impulses first and then what lasts; mostly as they were. That needs no question
where it has one answer, and this is seen in the mode itself:

- it ties nothing that is stored, so that nothing jumps on entering it;
- every ideal diode, or what is like one, conducts clearly, or blocks clearly;
- what laws give and what they feel are monotone together, and the graph is linear. Then any other
  answer has zeros wherever this one has them: it solves the same equations;
- these have one solution: they leave nothing free.

Source of the third: Cottle, Pang and Stone, The linear complementarity problem (1992), section 3.1.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.jumps.jump import enter_mode
from hybond.engine.jumps.trial import begin_trial, finish_trial
from hybond.engine.laws.law_instant import NO_LAW_VALUE, is_on
from hybond.engine.laws.ports import open_mode, ports_of
from hybond.engine.mode.digits.part_energies import find_energies, reach_of_bond
from hybond.engine.mode.digits.sizes import size_of
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints

CLEARLY: Final = 1e-6
"""Part of its terms from which on the sign of what a law carries, or blocks, is no rounding."""


def is_simple(m: Model, k: int) -> bool:
    """Whether the law of port k has two sides, and nothing beside them: an ideal diode."""
    if m.port_two_sided[k] != 0 or m.port_planar[k] != 0 or m.port_impulsive[k] != 0:
        return False
    if m.port_gap[k] != NO_LAW_VALUE or m.port_gate[k] != NO_LAW_VALUE:
        return False
    return (
        m.port_restitution[k] == NO_LAW_VALUE
        and m.port_limit[k] == NO_LAW_VALUE
        and m.port_breakaway[k] == NO_LAW_VALUE
    )


def stands_as_it_was(e: Engine, t: float, x: Floats, s: Floats, state: Ints) -> bool:
    """Try a mode, from the state `x`, in which the laws stood a priori; whether they still do.

    If so, `e.trial` is what deciding them anew would make it.
    """
    m = e.model
    r = e.laws
    if e.slide.many > 0 or r.sweep or not stood_before(e, state):
        return False
    if begin_trial(e, t, x, s, state) != OK or ports_of(e, r, state) != OK:
        return False
    mode = e.mode
    one = mode.dynamics == 0 and mode.finite_frees == 0 and r.now.linear and r.now.monotone
    if not one or is_constrained(mode) or is_constrained(open_mode(e, r.now)):
        return False
    e.trial.struck = False
    e.trial.dusted = False
    e.trial.factors = 0
    if enter_mode(e, mode, e.v, x, e.trial.x) != OK or finish_trial(e, t, x, s) != OK:
        return False
    for k in range(m.ports):
        if not stands_clearly(e, k):
            return False
    return True


def stood_before(e: Engine, state: Ints) -> bool:
    """Whether all laws are simple, and none was about to leave its branch a priori."""
    m = e.model
    for k in range(m.ports):
        if not is_simple(m, k):
            return False
        on = is_on(m, k, state[m.port_machine[k]])
        if not shown(m, k, on, e.pre) > 0.0:
            return False
    return True


def shown(m: Model, k: int, on: bool, v: Floats) -> float:
    """Return what says that a law stands: what it carries if it is `on`, or what it blocks."""
    row = 2 * k if on else 2 * k + 1
    total = 0.0
    for i in range(m.pair_first[row], m.pair_first[row + 1]):
        total += m.pair_value[i] * v[m.bond_slot + m.pair_column[i]]
    return total if on else -total


def stands_clearly(e: Engine, k: int) -> bool:
    """Whether that is positive in the trial by more than any part of its terms that counts."""
    m = e.model
    on = is_on(m, k, e.trial.state[m.port_machine[k]])
    row = 2 * k if on else 2 * k + 1
    find_energies(e, e.mode)
    size = 0.0
    for i in range(m.pair_first[row], m.pair_first[row + 1]):
        b = m.pair_column[i]
        own = size_of(e, e.mode, b, e.trial.xi, e.v)
        size += math.fabs(m.pair_value[i]) * max(own, reach_of_bond(e, e.mode, b, e.trial.xi))
    return shown(m, k, on, e.v) > CLEARLY * size
