"""Machines that follow others: a switch behind a comparator, a gate behind gates, a latch.

Their rules read the states of machines, or what these switch. Where a machine that they read
slides, each of the modes that are combined has them where fast switching takes them: what fires
when a mode is entered from that before, mode after mode. Their rules rest; what these ask for in
each mode is watched.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.model import Model
from hybond.engine.surfaces.corners import cross_as_one
from hybond.engine.surfaces.follower_guards import (
    NONE,
    first_holding,
    is_solved_for,
    put_state,
    put_states,
    solve_led,
)
from hybond.engine.surfaces.reads import BY_BONDS
from hybond.engine.surfaces.slide_records import Slide
from hybond.engine.words import Ints

ROUNDS: Final = 64
"""Rounds beyond two for each state of what follows, after which it has no end."""


def let_follow(e: Engine, before: Ints, state: Ints) -> None:
    """Put machines that follow others where these lead them when `state` is entered.

    `before` is what was settled then, which ``pre()`` reads. All fire together, as in an instant,
    until none does; what has no end is noted as restless.
    """
    m = e.model
    s = e.slide
    if m.followers == 0:
        return
    find_apart(m, s)
    if s.given:
        take_given(m, s, state)
        return
    set_time(e, s.led, e.t)
    copy_part(m.storages, s.choose_x, 0, s.led, m.stored_slot)
    copy_part(m.integrals, s.choose_s, 0, s.led, m.signal_slot)
    put_states(m, s, before, m.slots)
    put_states(m, s, state, 0)
    left = 2 * m.state_first[m.machines] + ROUNDS
    again = m.prior_followers > 0
    while True:
        rounds = settle_followers(e, state, left)
        if rounds == 0 and not again:
            return
        left -= rounds
        again = False
        # what is settled now is what the next reads as it was before
        put_states(m, s, state, m.slots)


def settle_followers(e: Engine, state: Ints, most: int) -> int:
    """Let followers fire until none does; return in how many rounds."""
    m = e.model
    s = e.slide
    many = 0
    for j in range(m.followers):
        many = ask(s, many, j)
    for rounds in range(most):
        s.led_known = False
        if is_solved_for(m, s, many):
            solve_led(e, state)
        fires = 0
        for i in range(many):
            j = s.asked[i]
            s.is_asked_now[j] = 0
            machine = m.follower[j]
            rule = NONE if s.apart[machine] != 0 else first_holding(e, j, state[machine])
            if rule != NONE:
                s.fires[fires] = j
                s.firing[fires] = rule
                fires += 1
        if fires == 0:
            return rounds
        many = 0
        for i in range(fires):
            machine = m.follower[s.fires[i]]
            put_state(m, s, machine, state[machine], False)
            state[machine] = m.rule_target[s.firing[i]]
            put_state(m, s, machine, state[machine], True)
            many = ask(s, many, s.fires[i])
            for p in range(m.reader_first[machine], m.reader_first[machine + 1]):
                many = ask(s, many, m.reader[p])
        for j in range(m.followers):
            # bond variables are others in another mode
            many = ask(s, many, j) if m.follower_asks[j] == BY_BONDS else many
    for i in range(many):
        s.is_asked_now[s.asked[i]] = 0
    s.restless = m.follower[s.fires[0]]
    return 0


def ask(s: Slide, many: int, j: int) -> int:
    """Ask a follower in the next round; return how many are asked."""
    if s.is_asked_now[j] != 0:
        return many
    s.is_asked_now[j] = 1
    s.asked[many] = j
    return many + 1


def take_given(m: Model, s: Slide, state: Ints) -> None:
    """Give a mode the states of followers that are known of it, if they are."""
    for row in range(s.branches):
        same = True
        for k in range(m.machines):
            led = m.is_law[k] != 0 or (m.machine_follows[k] != 0 and s.apart[k] == 0)
            same = same and (led or s.branch.at[row * m.machines + k] == state[k])
        if same:
            for k in range(m.machines):
                if m.machine_follows[k] != 0 and s.apart[k] == 0:
                    state[k] = s.branch.at[row * m.machines + k]
            return


def find_apart(m: Model, s: Slide) -> None:
    """Find the machines that switch on surfaces slid on, or met, and follow none."""
    for k in range(m.machines):
        s.apart[k] = 0
    for i in range(s.many + s.met):
        here = s.surface[i] if i < s.many else s.met_surface[i - s.many]
        for other in range(m.surfaces):
            if other == here or m.surface_twin[here * m.surfaces + other] != 0:
                s.apart[m.surface_machine[other]] = 1


def is_led(m: Model, s: Slide, machine: int) -> bool:
    """Whether a machine follows one that slides."""
    if m.followers == 0 or s.many == 0 or m.machine_follows[machine] == 0:
        return False
    know_led(m, s)
    return s.is_led_now[machine] != 0


def know_led(m: Model, s: Slide) -> None:
    """Find the machines that follow those that slide, unless that is known."""
    known = s.led_many == s.many
    for i in range(s.many if known else 0):
        known = known and s.led_surface[i] == s.surface[i]
    if known:
        return
    s.led_many = s.many
    for k in range(m.machines):
        s.is_led_now[k] = 0
    many = 0
    for i in range(s.many):
        s.led_surface[i] = s.surface[i]
        for other in range(m.surfaces):
            if other == s.surface[i] or cross_as_one(m, s.surface[i], other):
                many = ask_led(m, s, many, m.surface_machine[other])
    lead(m, s, many)
    for i in range(s.many):
        for other in range(m.surfaces):
            if other == s.surface[i] or m.surface_twin[s.surface[i] * m.surfaces + other] != 0:
                s.is_led_now[m.surface_machine[other]] = 0


def forget_led(s: Slide) -> None:
    """Let it be found anew who follows."""
    s.led_many = -1


def lead_also(m: Model, s: Slide, j: int) -> None:
    """Note that a follower follows, and what reads it."""
    lead(m, s, ask(s, 0, j))


def lead(m: Model, s: Slide, many: int) -> None:
    """Note that those follow that are asked, so many, and what reads them."""
    at = 0
    while at < many:
        machine = m.follower[s.asked[at]]
        s.is_asked_now[s.asked[at]] = 0
        at += 1
        s.is_led_now[machine] = 1
        many = ask_led(m, s, many, machine)


def ask_led(m: Model, s: Slide, many: int, machine: int) -> int:
    """Let those be led that read a machine; return how many are to be looked at then."""
    for p in range(m.reader_first[machine], m.reader_first[machine + 1]):
        j = m.reader[p]
        if s.is_led_now[m.follower[j]] == 0:
            many = ask(s, many, j)
    return many
