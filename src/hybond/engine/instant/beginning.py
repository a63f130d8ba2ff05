"""Where a run begins: what is a priori there, and states that machines cannot begin in.

The states that machines are declared to begin in may have no mode with a solution, as all switches
of a bridge that a current feeds are open until their gates are read. Such a mode is passed over as
at any other instant, and what is a priori is then of the first behind it that has a solution.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.engine import OK, Engine
from hybond.engine.inputs.sampling import sample
from hybond.engine.instant.indeterminate import keep_as_before, keep_open_before
from hybond.engine.instant.instant import Instant
from hybond.engine.instant.passed_over import MOST, leave
from hybond.engine.jumps.trial import a_priori, show_stored
from hybond.engine.laws.branches import know_around
from hybond.engine.laws.entering import enter
from hybond.engine.laws.law_instant import make_consistent, take_instant
from hybond.engine.surfaces.values import set_values
from hybond.engine.words import Floats, Ints


def stand_before(e: Engine, t: float, x: Floats, s: Floats, state: Ints, begin: Floats) -> bool:
    """Let what is a priori at the start be of branches of laws that stand there, if any do.

    Those that laws are declared with are nobody's choice: friction at rest beside what moves would
    make of an impact one that is faster than anything stored. Storages that one junction holds
    together say different things of it before they share what they store, and none is more right.
    `begin` is room for what is stored, put on what machines ask for without their laws. Whether any
    branches stand.
    """
    take_instant(e, e.laws, t, s, state)
    if make_consistent(e, e.laws, x) != OK:
        return False
    copy_floats(e.model.storages, e.laws.x, begin)
    if enter(e, t, begin, s, state, False, False) != OK:
        return False
    show_stored(e)
    copy_floats(e.model.slots, e.v, e.pre)
    keep_as_before(e, e.trial.loose, e.trial.freedom.at)
    return True


def stand_without_before(
    e: Engine, t: float, x: Floats, s: Floats, state: Ints, begin: Floats
) -> bool:
    """Let what is a priori at the start be of branches that stand; those declared have no values.

    A box that turns in the air has none in which all its corners are at rest, as laws are declared
    to begin. Whether any stand.
    """
    set_values(e, e.mode, e.pre, t, x, s)
    for k in range(2 * e.model.bonds):
        e.pre[e.model.bond_slot + k] = math.nan
    return stand_before(e, t, x, s, state, begin)


def begin_behind(
    e: Engine, i: Instant, x: Floats, s: Floats, state: Ints, target: Ints, begin: Floats
) -> bool:
    """Begin in the first mode with a solution behind that of the states that machines begin in.

    The latter was refused. Whether there is one; `state` is then that of the mode entered. What was
    sampled is sampled anew, but no block is called twice.
    """
    m = e.model
    if m.blocks > 0:
        return False
    copy_places(m.machines, e.state, 0, state, 0)
    for _ in range(MOST):
        # a mode without a solution gives bonds no values that rules could read a priori
        for k in range(2 * m.bonds):
            e.pre[m.bond_slot + k] = math.nan
        if not leave(e, i, e.t, x, s, state, target):
            return False
        if a_priori(e, e.t, x, s, state) != OK:
            return False
        keep_open_before(e)
        copy_part(m.integrals, e.y, m.storages, s, 0)
        e.sampled_at = -math.inf
        if sample(e, s) != OK:
            return False
        know_around(e, state)
        if m.laws > 0:
            stand_before(e, e.t, x, s, state, begin)
        if enter(e, e.t, x, s, state, True, False) == OK:
            return True
    return False
