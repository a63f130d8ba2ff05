"""Kinks of roots that are passed where the tolerance of states does not tell them from zero.

A pressure runs through a row of vessels: what flows from one to the next is the root of their
difference, and far ahead of it that is next to nothing, of either sign by the error of the steps.
Each change of sign would end a step, and the next one would begin as near a kink as this. A root
has the same value from both sides, so nothing is passed over: what a step makes of it is as right
beyond as it is before. So in a row of many roots, where such kinks have ended one step after the
other and a step begins no farther from one than its tolerance may be off, that ends it only if it
leads there from farther away. What comes to rest at one of a few is located.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.guards.guard_values import atom_here, holds_at, look
from hybond.engine.guards.locator import NO_KINK, Locator
from hybond.engine.methods.explicit.one_instant import show_motion
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.model import Model
from hybond.engine.words import Floats

MANY: Final = 5
"""Roots that make a row, ..."""
IN_A_ROW: Final = 32
"""... and steps that their kinks have ended, one after the other."""
LOOKS: Final = 4
"""Parts of the way to a kink at whose ends it is seen whether what is compared leaves zero."""


def forget_blurred(e: Engine, g: Locator) -> None:
    """Know of no kink that it is blurred, where another step begins."""
    if not g.at < math.inf:
        g.in_a_row = 0
    if g.blurs and g.blurred_from != e.step.t0:
        g.blurs = False
        for k in range(g.guards):
            g.blurred[k] = 0


def let_blurred_pass(e: Engine, g: Locator) -> bool:
    """Whether kinks that have ended the step are blurred: they end it no more."""
    if e.model.kinks < MANY or e.slide.k > 0 or not is_root_there(e, g):
        return False
    if not is_row(e.model):
        return False
    g.in_a_row += 1
    if g.in_a_row < IN_A_ROW:
        return False
    refusal = e.refusal
    hold_guess(e, e.mode)
    g.looked = math.nan
    found = find_blurred(e, g, g.at)
    give_back_guess(e, e.mode)
    g.looked = math.nan
    e.refusal = refusal
    return found and not g.failed


def is_row(m: Model) -> bool:
    """Whether there are many roots."""
    roots = 0
    for k in range(m.kinks):
        roots += 1 if m.kink_meets[k] != 0 else 0
    return roots >= MANY


def is_root_there(e: Engine, g: Locator) -> bool:
    """Whether the kink of a root ends the step at the instant found."""
    found = False
    for k in range(g.guards):
        if is_root_kink(e, g, k) and not found:
            found = holds_at(e, g, k, g.at)
    return found


def is_root_kink(e: Engine, g: Locator, k: int) -> bool:
    """Whether guard k is the kink of a root, which has one value from both sides."""
    if g.side[k] == NO_KINK:
        return False
    kink = g.atom[g.atom_first[k]] - e.model.kink_atom
    return kink < e.model.kinks and e.model.kink_meets[kink] != 0


def find_blurred(e: Engine, g: Locator, at: float) -> bool:
    """Note which kinks are blurred from where the step begins up to `at`; whether one ends there.

    What is compared may be off by what it changes by where states are off by their tolerances. None
    is blurred where an edge beyond which laws have no values is: two tanks run empty together.
    """
    m = e.model
    s = e.step
    blur = g.blur
    here = g.unblurred
    if not show_motion(e, s.t0, s.y0):
        return False
    read_all(e, here)
    for k in range(m.kinks + m.edges):
        blur[k] = 0.0
    tolerance(e, s.y0, s.y0, s.allowed)
    for i in range(e.states):
        g.shifted_y[i] = s.y0[i]
    for i in range(e.states):
        if not (s.allowed[i] > 0.0 and s.allowed[i] < math.inf):
            continue
        g.shifted_y[i] = s.y0[i] + s.allowed[i]
        if show_motion(e, s.t0, g.shifted_y):
            read_all(e, g.beside_here)
            for k in range(m.kinks + m.edges):
                off = math.fabs(g.beside_here[k] - here[k])
                blur[k] += off if off < math.inf else 0.0
        g.shifted_y[i] = s.y0[i]
    for k in range(m.edges):
        if m.edge_met[k] != 1 and not math.fabs(here[m.kinks + k]) > blur[m.kinks + k]:
            return False
    return note_blurred(e, g, at)


def read_all(e: Engine, out: Floats) -> None:
    """Put what kinks and edges compare there, at the values of the motion that is shown."""
    m = e.model
    for k in range(m.kinks):
        out[k] = value(m, m.atom_value[m.kink_atom + k], e.v)
    for k in range(m.edges):
        out[m.kinks + k] = value(m, m.edge_value[k], e.v)


def note_blurred(e: Engine, g: Locator, at: float) -> bool:
    """Note those kinks of roots that are within what they may be off by up to `at`."""
    s = e.step
    some = False
    for i in range(LOOKS):
        look(e, g, s.t0 + float(i) / float(LOOKS) * (at - s.t0))
        for k in range(g.guards):
            if not is_root_kink(e, g, k):
                continue
            kink = g.atom[g.atom_first[k]] - e.model.kink_atom
            there = math.fabs(atom_here(e, g, g.atom_first[k]))
            g.blur[kink] = g.blur[kink] if there <= g.blur[kink] else -1.0
    for k in range(g.guards):
        if not is_root_kink(e, g, k) or g.blurred[k] != 0:
            continue
        if g.blur[g.atom[g.atom_first[k]] - e.model.kink_atom] < 0.0:
            continue
        ends = holds_at(e, g, k, at)
        some = some or ends
        g.blurred[k] = 1
        g.blurs = True
    g.blurred_from = s.t0
    return some
