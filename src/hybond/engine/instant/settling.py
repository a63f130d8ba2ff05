"""An instant under way, and how it is seen that its modes follow without end.

Time cannot advance where a trial comes back: the same mode, state, state after the jump and a
priori values.
"""

from __future__ import annotations

from hybond.engine.algebra.products import copy_part
from hybond.engine.answers import machine_name
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Settling:
    """An instant under way: the state written last, and what a cycle is told by."""

    x: Floats
    begin: Floats
    """At the start: what is stored, put on what machines ask for without their laws."""
    s: Floats
    state: Ints
    target: Ints
    entered: Ints
    first_target: Ints
    """What fired first at the instant."""
    only_dust: bool
    """Whether all jumps since then were next to nothing."""
    some_dust: bool
    """Whether there were any."""
    moved: Floats
    """What the last of them moved."""
    held: Ints
    """Of each rule: whether it was asked of the trial, and holds."""
    # one earlier trial: the search for a cycle compares with it, and takes a later one in turn
    tries: int
    turn: int
    marked: bool
    mark_state: Ints
    mark_written: Ints
    mark: Floats
    mark_jumps: bool
    # the mode that was found to stand, and how many were
    stand_state: Ints
    stands: int
    # what goes on from a trial for a moment
    moment: Floats
    moment_rate: Floats
    moment_sum: Floats
    moment_from: Floats
    moment_values: Floats
    moment_bonds: Floats


def make_settling(e: Engine) -> Settling:
    """Return room for settling."""
    m = e.model
    g = Settling()
    g.x = floats(m.storages)
    g.begin = floats(m.storages)
    g.s = floats(m.integrals)
    g.state = ints(m.machines)
    g.target = ints(m.machines)
    g.entered = ints(m.machines)
    g.first_target = ints(m.machines)
    g.moved = floats(m.storages)
    g.held = ints(m.rule_first[m.machines])
    g.mark_state = ints(m.machines)
    g.mark_written = ints(m.machines)
    g.mark = floats(2 * e.states + m.slots)
    g.stand_state = ints(m.machines)
    g.moment = floats(e.states)
    g.moment_rate = floats(e.states)
    g.moment_sum = floats(e.states)
    g.moment_from = floats(e.states)
    g.moment_values = floats(2 * m.slots)
    g.moment_bonds = floats(2 * m.bonds)
    return g


def comes_back(e: Engine, g: Settling) -> bool:
    """Whether the trial was there before at this instant."""
    return g.marked and is_marked(e, g)


def look_for_cycle(e: Engine, g: Settling) -> int:
    """Refuse a trial that was there before at this instant: time cannot advance.

    Compared is one earlier trial, taken anew after 1, 2, 4, ... others (Brent), so that a cycle is
    found without keeping all of them.
    """
    m = e.model
    if comes_back(e, g):
        names = machine_name(m, m.machines - 1) if m.machines == 1 else ""
        return say_fault(e, "HB-N401", "time cannot advance: modes follow without end", names)
    g.tries += 1
    if g.tries >= g.turn:
        g.tries = 0
        g.turn *= 2
        put_mark(e, g)
    return OK


def put_mark(e: Engine, g: Settling) -> None:
    """Remember the trial."""
    m = e.model
    g.marked = True
    g.mark_jumps = e.trial.jumps
    for k in range(m.machines):
        g.mark_state[k] = e.trial.state[k]
        g.mark_written[k] = g.state[k]
    at = 0
    for k in range(m.storages):
        g.mark[at] = g.x[k]
        g.mark[at + 1] = e.trial.x[k]
        at += 2
    for k in range(m.integrals):
        g.mark[at] = g.s[k]
        g.mark[at + 1] = e.trial.s[k]
        at += 2
    copy_part(m.slots, e.pre, 0, g.mark, at)


def is_marked(e: Engine, g: Settling) -> bool:
    """Whether the trial is the one remembered."""
    m = e.model
    same = g.mark_jumps == e.trial.jumps
    for k in range(m.machines):
        same = same and g.mark_state[k] == e.trial.state[k]
        same = same and g.mark_written[k] == g.state[k]
    if not same:
        return False
    at = 0
    for k in range(m.storages):
        same = same and g.mark[at] == g.x[k] and g.mark[at + 1] == e.trial.x[k]
        at += 2
    for k in range(m.integrals):
        same = same and g.mark[at] == g.s[k] and g.mark[at + 1] == e.trial.s[k]
        at += 2
    for k in range(m.slots):
        same = same and g.mark[at + k] == e.pre[k]
    return same
