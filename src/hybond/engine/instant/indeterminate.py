"""Whether the truth of a guard depends on what the equations leave open.

A guard reads values at the instant, impulses and values before it; each of these is moved along the
directions in which it is free, and the guard asked again.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.engine import Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.jumps.trial import measure_trial, show_trial
from hybond.engine.mode.left_free.leakage import is_undetermined
from hybond.engine.mode.left_free.undetermined import far_held
from hybond.engine.reasons.facts import add_fact
from hybond.engine.reasons.warned import LEFT_OPEN, add_about, begin_warning
from hybond.engine.surfaces.averages import freedom_here
from hybond.engine.words import Floats

DECIDED: Final = 0
OPEN_NOW: Final = 1
OPEN_BEFORE: Final = 2
"""What leaves a guard without truth: nothing, values or impulses at the instant, values before."""
FAR: Final = 1e3
"""How far values are moved, as a multiple of the largest."""


def keep_open_before(e: Engine) -> None:
    """Keep in which directions the values a priori are free, which stand in `e.v`."""
    m = e.model
    for k in range(2 * m.bonds):
        if math.isnan(e.v[m.bond_slot + k]):
            # a start where they have no values: what reads them is refused
            keep_as_before(e, 0, e.work.freedom.at)
            return
    many = freedom_here(e, e.mode, e.v)
    keep_as_before(e, many, e.work.freedom.at)


def keep_as_before(e: Engine, many: int, freedom: Floats) -> None:
    """Keep these directions as those in which the values a priori are free."""
    n = 2 * e.model.bonds * many
    e.trial.was_loose = many
    fit(e.trial.was_freedom, n)
    for i in range(n):
        e.trial.was_freedom.at[i] = freedom[i]


def is_indeterminate(e: Engine, rule: int) -> int:
    """Return whether the truth of a guard is open in the trial: DECIDED, OPEN_NOW, OPEN_BEFORE."""
    m = e.model
    trial = e.trial
    if m.decided != 0 and m.tells == 0:
        return DECIDED
    if trial.loose == 0 and trial.was_loose == 0:
        return DECIDED
    show_trial(e, e.work.stack)
    if turns(e, rule, e.v, 1.0, trial.loose, trial.freedom.at, ends_here(e)):
        return OPEN_NOW
    if trial.jumps and turns(e, rule, trial.jump, 0.0, trial.loose, trial.freedom.at, False):
        # what is free at an instant is what impulses may share without moving anything
        return OPEN_NOW
    if turns(e, rule, e.pre, 1.0, trial.was_loose, trial.was_freedom.at, False):
        return OPEN_BEFORE
    return DECIDED


def ends_here(e: Engine) -> bool:
    """Whether laws that bend may end the one direction in which values are free."""
    mode = e.mode
    return e.trial.loose == 1 and e.slide.k == 0 and mode.finite_frees > 0 and not mode.affine


def turns(
    e: Engine,
    rule: int,
    values: Floats,
    least: float,
    many: int,
    freedom: Floats,
    ends: bool,
) -> bool:
    """Whether a guard, shown the trial, has another truth if `values` move as they are free to.

    They move far beyond the largest of them, and beyond `least`; if that `ends` on neither side at
    once, as far as laws hold: a relief valve through which nothing flows leaves the pressure open
    up to where it opens.
    """
    m = e.model
    n = 2 * m.bonds
    first = m.bond_slot
    terms = e.trial.terms
    kept = e.work.generic
    measure_trial(e, rule)
    most = least
    for k in range(n):
        kept[k] = values[first + k]
        kept[n + k] = terms[first + k]
        most = max(most, math.fabs(values[first + k]))
    turned = False
    for j in range(many):
        if turned or not reads_along(e, rule, many, freedom, j):
            continue
        up = FAR * most
        down = -up
        if ends:
            held_up = far_held(e, e.mode, kept, values, freedom, up)
            held_down = far_held(e, e.mode, kept, values, freedom, down)
            if held_up != 0.0 and held_down != 0.0:
                up = held_up
                down = held_down
        for k in range(n):
            # what is moved is known no better than how far it is moved
            size = 0.0
            if freedom[k * many + j] != 0.0:
                for i in range(many):
                    size += math.fabs(freedom[k * many + i])
            terms[first + k] = kept[n + k] + max(up, -down) * size
        truths = 0
        for side in range(3):
            far = up * float(side // 2) + down * float((2 - side) // 2)
            for k in range(n):
                values[first + k] = kept[k] + far * freedom[k * many + j]
            truths = truths | truths_of(e, rule)
        turned = truths == 3
    for k in range(n):
        values[first + k] = kept[k]
        terms[first + k] = kept[n + k]
    return turned


def truths_of(e: Engine, rule: int) -> int:
    """Return which truth a guard has, false being 1 and true 2; 0 if it has none."""
    true = holds(e.model, rule, e.work.stack)
    if e.work.stack.refused != 0:
        return 0
    return 2 if true else 1


def reads_along(e: Engine, rule: int, many: int, freedom: Floats, j: int) -> bool:
    """Whether a guard reads a bond variable that direction j moves."""
    m = e.model
    for i in range(m.read_first[rule], m.read_first[rule + 1]):
        k = m.read_slot[i] - m.bond_slot
        if k >= 0 and k < 2 * m.bonds and freedom[k * many + j] != 0.0:
            return True
    return False


# -- telling, where somebody will read it


def is_open_at(e: Engine, k: int, open_at: int) -> bool:
    """Whether bond variable k is open in the trial, or was before it."""
    n = 2 * e.model.bonds
    trial = e.trial
    if open_at == OPEN_BEFORE:
        return is_undetermined(n, trial.was_loose, trial.was_freedom.at, k)
    return is_undetermined(n, trial.loose, trial.freedom.at, k)


def tell_open_rule(e: Engine, rule: int, open_at: int) -> None:
    """Tell the rule that is refused, when what it reads is open, and which bond variables are."""
    add_fact(e.fault, float(rule))
    add_fact(e.fault, float(open_at))
    for k in range(2 * e.model.bonds):
        if is_open_at(e, k, open_at):
            add_fact(e.fault, float(k))


def warn_of_open(e: Engine, rule: int, open_at: int) -> None:
    """Warn of a guard whose truth depends on what the equations leave open."""
    m = e.model
    begin_warning(e.warned, LEFT_OPEN, e.t)
    add_about(e.warned, float(rule))
    add_about(e.warned, float(open_at))
    for k in range(m.machines):
        add_about(e.warned, float(e.trial.state[k]))
    for k in range(2 * m.bonds):
        if is_open_at(e, k, open_at):
            add_about(e.warned, float(k))
