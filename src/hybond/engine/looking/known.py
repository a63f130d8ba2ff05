"""What holds apart from any motion: energy of what is stored, bond variables by what is known.

In a linear mode bond variables are a matrix times co-energy variables, values of sources and their
rates; so are their derivatives along a motion, times the derivatives of these.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import OK, Engine
from hybond.engine.looking.look import Look
from hybond.engine.mode.digits.closely import closely
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.words import Floats, Ints

NOT_LINEAR: Final = -1


def look_stored(e: Engine, l: Look, many: int, y: Floats, out: Floats) -> int:
    """Put the stored energy of states there, J: rows of `y`, as many as are said."""
    for i in range(many):
        copy_part(e.states, y, i * e.states, l.y, 0)
        out[i] = energy_of(e, l.y)
    return OK


def look_sources(e: Engine, source: Ints, rated: Ints) -> int:
    """Put the sources of the mode looked at there, in the order of its knowns; return their number.

    `rated` says of each whether its rate is asked for. NOT_LINEAR where bond variables are no
    matrix times what is known.
    """
    mode = e.mode
    if e.slide.k > 0 or mode.dynamics > 0:
        return NOT_LINEAR
    for k in range(mode.sources):
        source[k] = mode.source[k]
        rated[k] = mode.rated[k]
    return mode.sources


def look_by_knowns(e: Engine, many: int, known: Floats, out: Floats) -> None:
    """Put the bond variables there that knowns make in a linear mode, a row for each row of these.

    A row of `known` has co-energy variables, sources and rates of sources.
    """
    m = e.model
    mode = e.mode
    size = m.storages + 2 * mode.sources
    n = 2 * m.bonds
    for i in range(many):
        copy_part(size, known, i * size, e.work.xi, 0)
        closely(e, mode, mode.direct, e.work.w)
        copy_part(n, e.work.w, 0, out, i * n)
