"""Which branches junction laws take in each of the modes that sliding combines.

A diode beside a relay may conduct while the relay is on one side and block while it is on the
other. Each mode of a combination has the branches that complementarity gives it in one state; they
are kept, by the states of all other machines, until they are chosen anew.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import grow_block, grow_places
from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.engine import OK, Engine
from hybond.engine.jumps.trial import a_priori, try_mode
from hybond.engine.laws.entering import enter
from hybond.engine.surfaces.branch_table import add_branches, find_branches, take_branches
from hybond.engine.surfaces.corners import count_corners, put_corner
from hybond.engine.surfaces.followers import let_follow
from hybond.engine.surfaces.law_means import BACKWARD, FORWARD, HELD, RESTS
from hybond.engine.words import Floats, Ints

MOST: Final = 64
"""Modes passed through one after another, at the most, whose branches are chosen."""


def choose_at(e: Engine, x: Floats, signals: Floats) -> None:
    """Let branches be chosen in this state from now on; those that are known are kept."""
    s = e.slide
    s.entries = 0
    copy_floats(e.model.storages, x, s.choose_x)
    copy_floats(e.model.integrals, signals, s.choose_s)


def choose_anew(e: Engine) -> None:
    """Forget all branches; they are chosen in the present state."""
    s = e.slide
    copy_floats(e.model.storages, e.y, s.choose_x)
    copy_part(e.model.integrals, e.y, e.model.storages, s.choose_s, 0)
    s.branches = 0
    s.entries = 0
    for k in range(e.model.ports):
        s.meant[k] = 1 if s.barred[k] == HELD else 0


def choose_ahead(e: Engine, time: float, rate: Floats, at: int) -> None:
    """Forget all branches; they are chosen where rates, from `at` on, lead in a time."""
    m = e.model
    s = e.slide
    choose_anew(e)
    for k in range(m.storages):
        s.choose_x[k] += time * rate[at + k]
    for k in range(m.integrals):
        s.choose_s[k] += time * rate[at + m.storages + k]


def know_branches(e: Engine, state: Ints, k: int, product: bool, side: Ints) -> None:
    """Choose the branches of the modes around k surfaces that are not known yet.

    What is combined has to be taken anew, and so has the mode.
    """
    s = e.slide
    if e.model.laws == 0 and e.model.followers == 0:
        return
    for part in range(count_corners(k, product)):
        put_corner(e.model, state, part, k, product, side, s.state)
        follow(e, state, s.state)
        if e.model.laws > 0:
            choose(e, s.state)


def follow(e: Engine, before: Ints, state: Ints) -> None:
    """Do what `let_follow` does, with the branches chosen of each mode passed through."""
    m = e.model
    s = e.slide
    if m.followers == 0:
        return
    copy_places(m.machines, state, 0, s.begun, 0)
    for _ in range(MOST):
        s.wants = False
        s.wants_entry = False
        let_follow(e, before, state)
        if not (s.wants or s.wants_entry):
            return
        if s.wants:
            choose(e, s.wanted)
        if s.wants_entry:
            note_entry(e, s.wanted_entry)
        copy_places(m.machines, s.begun, 0, state, 0)
    # laws and followers send each other on, mode after mode
    s.restless = m.follower[0]


def know_around(e: Engine, state: Ints) -> None:
    """Choose the branches of the modes that are combined in `state`, before it is entered."""
    m = e.model
    s = e.slide
    if (m.laws == 0 and m.followers == 0) or s.many == 0:
        return
    sides = 0
    for i in range(s.many):
        surface = s.surface[i]
        now = state[m.surface_machine[surface]]
        if now == m.surface_below[surface] or now == m.surface_above[surface]:
            s.side[sides] = surface
            sides += 1
    copy_floats(m.slots, e.pre, s.kept_pre)
    know_branches(e, state, sides, s.slid_product, s.side)
    copy_floats(m.slots, s.kept_pre, e.pre)


def choose_own(e: Engine, state: Ints) -> None:
    """Give a mode that goes on alone the branches of its own laws."""
    if e.model.laws > 0:
        choose(e, state)
        take_branches(e.model, e.slide, state)


def choose(e: Engine, state: Ints) -> None:
    """Choose the branches of a mode, unless they are known."""
    m = e.model
    s = e.slide
    if find_branches(m, s, state) >= 0:
        return
    many = s.many
    k = s.k
    parts = s.parts
    sweep = e.laws.sweep
    # each mode has the branches that it has alone
    s.many = 0
    e.laws.sweep = False
    found = a_priori(e, e.t, s.choose_x, s.choose_s, state) == OK
    found = found and enter(e, e.t, s.choose_x, s.choose_s, state, True, False) == OK
    # where no branches stand, those that it has go on
    add_branches(m, s, e.trial.state if found else state)
    for port in range(m.ports):
        if s.barred[port] != 0:
            let_go(e, s.branches - 1, port)
    s.many = many
    s.k = k
    s.parts = parts
    e.laws.sweep = sweep


def let_go(e: Engine, row: int, k: int) -> None:
    """Let the law of port k carry nothing in the branches of a row, or friction slip, or rest."""
    m = e.model
    machine = m.port_machine[k]
    go = -1
    for state in range(m.state_first[machine + 1] - m.state_first[machine]):
        at = m.state_first[machine] + state
        if go < 0 and m.on_first[at + 1] == m.on_first[at]:
            go = state
    if m.port_two_sided[k] != 0:
        go = FORWARD if e.slide.barred[k] > 0 else BACKWARD
        go = RESTS if e.slide.barred[k] == HELD else go
    if go < 0:
        return  # one that carries something in each of its branches never lets go
    e.slide.branch.at[row * m.machines + machine] = go


def note_entry(e: Engine, state: Ints) -> None:
    """Note what entering a mode from the present state jumps by."""
    m = e.model
    s = e.slide
    many = s.many
    k = s.k
    parts = s.parts
    s.many = 0
    x = s.choose_x
    found = a_priori(e, e.t, x, s.choose_s, state) == OK
    found = found and try_mode(e, e.t, x, s.choose_s, state, True) == OK
    s.many = many
    s.k = k
    s.parts = parts
    row = s.entries
    s.entries += 1
    n = 2 * m.bonds
    grow_places(s.entry, s.entries * m.machines)
    grow_places(s.entry_known, s.entries)
    grow_block(s.entry_jump, s.entries * n)
    grow_block(s.entry_x, s.entries * m.storages)
    copy_places(m.machines, state, 0, s.entry.at, row * m.machines)
    s.entry_known.at[row] = 1 if found else 0
    for b in range(n):
        jumps = found and e.trial.jumps
        s.entry_jump.at[row * n + b] = e.trial.jump[m.bond_slot + b] if jumps else 0.0
    copy_part(m.storages, e.trial.x if found else x, 0, s.entry_x.at, row * m.storages)
