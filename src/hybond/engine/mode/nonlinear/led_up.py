"""From nothing to what is known: where several steep laws have to be solved together.

Exponentials throw Newton's steps beyond all numbers, or are left by a small part with each of them.
What is known, sources and what is stored, is led up from nothing by so much each time that the
solution moves a little, and each solution is where the next one begins, on the way of the last two.

Source: L. W. Nagel, *SPICE2*, 1975, source stepping.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.damped import damped
from hybond.engine.words import Floats

FIRST: Final = 2.0**-6
"""The part of all that is known that it is led up by first, ..."""
LEAST: Final = 2.0**-20
"""... and at the least; ..."""
LONGER: Final = 2.0
"""... how much more each time, ..."""
SHORTER: Final = 0.25
"""... and how much less where no solution was found."""
TRIES: Final = 400


def led_up(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Find the free unknowns, into `r`; False if there is no such way."""
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    if frees < 2:
        return False
    fit(work.led, n)
    fit(work.led_from, frees)
    fit(work.led_by, frees)
    copy_floats(n, work.base, work.led.at)
    for j in range(frees):
        work.led_from.at[j] = 0.0
        work.led_by.at[j] = 0.0
    part = 0.0
    step = FIRST
    for _ in range(TRIES):
        there = min(part + step, 1.0)
        for k in range(n):
            work.base[k] = there * work.led.at[k]
        for j in range(frees):
            r[j] = work.led_from.at[j] + (there - part) * work.led_by.at[j]
        if damped(e, mode, v, r):
            if there == 1.0:
                copy_floats(n, work.led.at, work.base)
                return True
            for j in range(frees):
                work.led_by.at[j] = (r[j] - work.led_from.at[j]) / (there - part)
                work.led_from.at[j] = r[j]
            part = there
            step *= LONGER
        else:
            step *= SHORTER
            if step < LEAST:
                break
    copy_floats(n, work.led.at, work.base)
    return False
