"""What states may be off by beside the flat end of a law that tells far less than that apart.

A resistor ``F*tanh(f/v)`` across a capacitance is turned round: its flow is found from what is
stored. Beside its end a millionth of the effort is all the flow there is, so that steps which are
right by their tolerance may say any flow, and cross the end, where the law holds, to and fro. So
within half of the way there a state may be off by no more than moves the law's argument by a part
of where the end is.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats

NEAR: Final = 0.25
"""Part of its terms that what is left of the way to an end is, at half of that."""
APART: Final = 5e-3
"""Part of these by which the error of a step may move it."""
PASSES: Final = 4
"""Times that less is tried: on either side an argument moves by another power of that."""
NOTHING_KNOWN: Final = 1e-4
"""Part of its tolerance that a state may be off by where laws have no values at that."""


def narrow_beside_flat(e: Engine, t: float, y: Floats) -> None:
    """Put what each stored quantity may be off by for that into ``e.step.narrow``; else infinity.

    Of a step that begins at a time and a state.
    """
    s = e.step
    m = e.model
    for k in range(m.storages):
        s.narrow[k] = math.inf
    if e.slide.k > 0 or not some_follow(e):
        return
    refusal = e.refusal
    hold_guess(e, e.mode)
    if evaluate(e, e.mode, e.shown, t, y) == OK and see_ways(e):
        tolerance(e, y, y, s.allowed)
        for k in range(e.states):
            s.trial[k] = y[k]
        for k in range(m.storages):
            if s.allowed[k] > 0.0 and s.allowed[k] < math.inf:
                s.narrow[k] = within(e, t, y, k)
    give_back_guess(e, e.mode)
    e.refusal = refusal


def some_follow(e: Engine) -> bool:
    """Whether a law is between its flat ends."""
    m = e.model
    for k in range(m.machines):
        if m.rule_first[k] < m.rule_first[k + 1] and m.rule_piece[m.rule_first[k]] != 0:
            if e.state[k] == m.start[k]:
                return True
    return False


def is_asked(e: Engine, k: int, r: int) -> bool:
    """Whether a rule leads from between the flat ends of a law, where it is, to one of them."""
    m = e.model
    return m.rule_piece[r] != 0 and m.rule_source[r] == e.state[k] and e.state[k] == m.start[k]


def see_ways(e: Engine) -> bool:
    """Put how far it is to each flat end into ``e.step.ends``; whether one is near."""
    m = e.model
    near = False
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            a = m.atom_first[r]
            if a == m.atom_first[r + 1] or not is_asked(e, k, r):
                continue
            size = value(m, m.atom_size[a], e.shown)
            here = value(m, m.atom_value[a], e.shown)
            counts = math.fabs(here) < NEAR * size
            e.step.ends[2 * r] = here
            e.step.ends[2 * r + 1] = size if counts else math.inf
            near = near or counts
    return near


def within(e: Engine, t: float, y: Floats, k: int) -> float:
    """Return what a stored quantity may be off by, found by ever less; infinity: as it may be."""
    s = e.step
    off = s.allowed[k]
    for _ in range(PASSES):
        s.trial[k] = y[k] + off
        part = part_within(e, t)
        s.trial[k] = y[k] - off
        part = min(part, part_within(e, t))
        if part >= 1.0:
            break
        off *= part
    s.trial[k] = y[k]
    return off if off < s.allowed[k] else math.inf


def part_within(e: Engine, t: float) -> float:
    """Return the part of how far ``e.step.trial`` is off that moves arguments by little enough."""
    m = e.model
    if evaluate(e, e.mode, e.shown, t, e.step.trial) != OK:
        return NOTHING_KNOWN
    part = math.inf
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            a = m.atom_first[r]
            if a == m.atom_first[r + 1] or not is_asked(e, k, r):
                continue
            size = e.step.ends[2 * r + 1]
            moved = math.fabs(value(m, m.atom_value[a], e.shown) - e.step.ends[2 * r])
            if size < math.inf and moved > APART * size:
                part = min(part, APART * size / moved)
    return part
