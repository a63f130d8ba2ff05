"""Edges of where laws have values, looked at where time has come to.

A root has no value below zero. Steps may try what is beyond, where it rests at zero; what they end
with is not beyond by more than a step may err. A tank runs empty and stays so; one that is drawn
from after that is refused.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import REFUSED, Engine, say_fault
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.sizes import size_of
from hybond.engine.model import node_name, value
from hybond.engine.reasons.facts import NO_ELEMENT, tell_law
from hybond.engine.words import Floats

NONE_BEYOND: Final = -1
STEPS_ERR: Final = 10.0
"""Multiple of the tolerance of one step by which some of them may have come beyond."""


def beyond_edge(e: Engine, mode: Mode, v: Floats) -> int:
    """Return the first edge that the values `v`, just solved for, are beyond, or NONE_BEYOND."""
    m = e.model
    for k in range(m.edges if m.rests != 0 else 0):
        inside = value(m, m.edge_value[k], v)
        if math.isfinite(inside):
            e.edge_largest[k] = max(e.edge_largest[k], math.fabs(inside))
        may = STEPS_ERR * m.rtol
        if inside < 0.0 and inside < -may * e.edge_largest[k]:
            if inside < -may * size_of_edge(e, mode, k, v):
                return k
    return NONE_BEYOND


def size_of_edge(e: Engine, mode: Mode, k: int, v: Floats) -> float:
    """Return the size of the terms of what has an edge: levels may all but cancel."""
    m = e.model
    terms = e.work.terms
    first = m.read_first[m.edge_pair[k]]
    stop = m.read_first[m.edge_pair[k] + 1]
    for turn in range(2):
        for i in range(first, stop):
            slot = m.read_slot[i]
            b = slot - m.bond_slot
            if b < 0 or b >= 2 * m.bonds or e.slide.k > 0:
                continue
            if turn == 0:
                terms[slot] = size_of(e, mode, b, e.work.xi, v)
            else:
                here = v[slot]
                v[slot] = terms[slot]
                terms[slot] = here
    size = value(m, m.edge_size[k], v)
    for i in range(first, stop):
        b = m.read_slot[i] - m.bond_slot
        if b >= 0 and b < 2 * m.bonds and e.slide.k == 0:
            v[m.read_slot[i]] = terms[m.read_slot[i]]
    return size


def refuse_beyond(e: Engine, mode: Mode, k: int) -> int:
    """Refuse values beyond an edge."""
    m = e.model
    node = m.edge_node[k]
    say_fault(e, "HB-N302", "a law has no finite value or slope", node_name(m, max(node, 0)))
    if m.tells != 0:
        tell_law(e, mode, node if node >= 0 else NO_ELEMENT, math.nan)
    return REFUSED
