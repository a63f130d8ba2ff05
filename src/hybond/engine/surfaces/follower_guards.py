"""Guards of machines that follow others, asked in a mode of one moment.

Most read the states of machines alone, beside time and inputs. What is stored is that of the
present; for bond variables the mode is solved. Rounding counts as zero, as in an instant.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.answers import value
from hybond.engine.contacts.landing_records import in_force
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.mode.digits.part_energies import find_energies, reach_of_bond
from hybond.engine.mode.digits.sizes import size_of
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.mode.solving import solve
from hybond.engine.model import Model
from hybond.engine.surfaces.branch_table import UNKNOWN, find_branches, take_branches
from hybond.engine.surfaces.reads import BY_BONDS, BY_STATES
from hybond.engine.surfaces.slide_records import Slide
from hybond.engine.words import Ints

NONE: Final = -1


def put_states(m: Model, s: Slide, state: Ints, at: int) -> None:
    """Write the states of machines and what they switch, from slot `at` on."""
    for k in range(m.switches + m.state_first[m.machines]):
        s.led[at + m.on_slot + k] = 0.0
    for k in range(m.machines):
        row = m.state_first[k] + state[k]
        s.led[at + m.on_slot + m.switches + row] = 1.0
        for i in range(m.on_first[row], m.on_first[row + 1]):
            s.led[at + m.on_slot + m.on_switch[i]] = 1.0


def put_state(m: Model, s: Slide, machine: int, state: int, here: bool) -> None:
    """Write whether a machine is in a state, and that what this switches is ON."""
    row = m.state_first[machine] + state
    s.led[m.on_slot + m.switches + row] = 1.0 if here else 0.0
    for i in range(m.on_first[row], m.on_first[row + 1]):
        s.led[m.on_slot + m.on_switch[i]] = 1.0 if here else 0.0


def is_solved_for(m: Model, s: Slide, many: int) -> bool:
    """Whether any of those that are asked reads bond variables."""
    for i in range(many):
        if m.follower_asks[s.asked[i]] == BY_BONDS:
            return True
    return False


def solve_led(e: Engine, state: Ints) -> None:
    """Write the bond variables of a mode, if it has a solution."""
    m = e.model
    s = e.slide
    copy_places(m.machines, state, 0, s.led_mode, 0)
    if m.laws > 0 and not s.wants and find_branches(m, s, s.led_mode) == UNKNOWN:
        s.wants = True
        copy_places(m.machines, s.led_mode, 0, s.wanted, 0)
    take_branches(m, s, s.led_mode)
    if mode_of(e, s.led_mode) != OK:
        return
    copy_part(m.switches + m.state_first[m.machines], e.mode.flags, 0, s.led, m.on_slot)
    if not put_entry(e):
        return
    put_limits(e, e.mode, s.led)
    s.led_known = solve(e, e.mode, s.led) == OK
    if s.led_known:
        find_energies(e, e.mode)


def put_entry(e: Engine) -> bool:
    """Write what is stored after the jump on entering the mode, and its impulses; if known."""
    m = e.model
    s = e.slide
    s.led_jumps = False
    copy_part(m.storages, s.choose_x, 0, s.led, m.stored_slot)
    if not is_constrained(e.mode):
        return True
    row = find_entry(m, s, s.led_mode)
    if row == UNKNOWN:
        s.wants_entry = True
        copy_places(m.machines, s.led_mode, 0, s.wanted_entry, 0)
        return False
    copy_part(m.storages, s.entry_x.at, row * m.storages, s.led, m.stored_slot)
    copy_part(2 * m.bonds, s.entry_jump.at, row * 2 * m.bonds, s.led_jump, m.bond_slot)
    for b in range(2 * m.bonds):
        s.led_jumps = s.led_jumps or s.led_jump[m.bond_slot + b] != 0.0
    return s.entry_known.at[row] != 0


def find_entry(m: Model, s: Slide, state: Ints) -> int:
    """Return the row of a mode whose jump on being entered is known, or UNKNOWN."""
    for row in range(s.entries):
        same = True
        for k in range(m.machines):
            same = same and s.entry.at[row * m.machines + k] == state[k]
        if same:
            return row
    return UNKNOWN


def first_holding(e: Engine, j: int, state: int) -> int:
    """Return the first rule that leads a follower away from a state, NONE if there is none."""
    m = e.model
    machine = m.follower[j]
    for rule in range(m.rule_first[machine], m.rule_first[machine + 1]):
        # not those by which a machine leaves where it has landed, nor others that rest there
        asked = m.rule_source[rule] == state and m.rule_landed[rule] == 0
        if asked and in_force(m, e.landings, machine, rule) and holds_led(e, j, rule):
            return rule
    return NONE


def holds_led(e: Engine, j: int, rule: int) -> bool:
    """Whether a rule of a follower holds."""
    m = e.model
    s = e.slide
    if m.follower_asks[j] == BY_STATES:
        return value(m, m.rule_value[rule], s.led) != 0.0
    for p in range(m.read_first[rule], m.read_first[rule + 1]):
        slot = m.read_slot[p]
        b = slot - m.bond_slot
        if b < 0 or b >= 2 * m.bonds:
            s.led_terms[slot] = math.fabs(s.led[slot])
            if m.samples > 0 and slot >= m.signal_slot and slot < m.stored_slot:
                terms = e.sample_terms[slot - m.signal_slot]
                s.led_terms[slot] = max(s.led_terms[slot], terms)
        elif s.led_known:
            size = size_of(e, e.mode, b, e.work.xi, s.led)
            s.led_terms[slot] = max(size, reach_of_bond(e, e.mode, b, e.work.xi))
        else:
            return False
    stack = e.work.stack
    stack.now = s.led
    stack.was = s.led
    stack.was_first = m.slots
    stack.jump = s.led_jump
    stack.jumps = s.led_jumps
    stack.terms = s.led_terms
    stack.prior_terms = s.led_terms
    return holds(m, rule, stack) and stack.refused == 0
