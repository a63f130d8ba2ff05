"""Machines that follow because what they read of bonds is another in each of the modes combined.

A gate behind a divider behind a comparator reads no state of any machine. While the comparator
slides, its signal is never at the average: the gate is asked in each mode.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.surfaces.averages import show_part
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.followers import forget_led, know_led, lead_also
from hybond.engine.surfaces.reads import BY_BONDS
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Ints

DIFFERS: Final = 1e-9
"""Comparisons are others in another mode if more than this part of their terms is."""


def combine_led(e: Engine, state: Ints) -> int:
    """Take what a mode is combined of while some machines slide, and which others follow these."""
    if combine_here(e, state) != OK:
        return REFUSED
    return find_led(e) if e.slide.k > 0 and e.model.followers > 0 else OK


def find_led(e: Engine) -> int:
    """Find which machines follow those that slide, in the combination that is there."""
    m = e.model
    s = e.slide
    forget_led(s)
    know_led(m, s)
    shown = False
    for j in range(m.followers):
        machine = m.follower[j]
        if m.follower_asks[j] != BY_BONDS or s.is_led_now[machine] != 0 or s.apart[machine] != 0:
            continue
        if not shown and evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
            return REFUSED
        shown = True
        if is_other_in_parts(e, machine):
            lead_also(m, s, j)
    return OK


def is_other_in_parts(e: Engine, machine: int) -> bool:
    """Whether what a machine's rules compare is not the same in all parts."""
    m = e.model
    first = m.atom_first[m.rule_first[machine]]
    last = m.atom_first[m.rule_first[machine + 1]]
    other = False
    for part in range(e.slide.parts):
        show_part(e, part, e.shown)
        for a in range(first, last):
            here = value(m, m.atom_value[a], e.shown)
            size = value(m, m.atom_size[a], e.shown)
            if part == 0:
                e.slide.led_atom[a] = here
            off = math.fabs(here - e.slide.led_atom[a])
            other = other or off > DIFFERS * (math.fabs(size) + math.fabs(e.slide.led_atom[a]))
    return other
