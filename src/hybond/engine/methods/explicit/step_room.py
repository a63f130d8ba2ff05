"""What a step works with: where it leads from and to, its stages, and what is measured of it."""

from __future__ import annotations

import math

from hybond.engine.mode.mode_records import PACES
from hybond.engine.words import Floats, floats, record


@record
class Step:
    """The last step, and where the method stands.

    Row j of `k` is stage j; row j of `dense` the coefficients of ``x`` to the power of j + 1, with
    ``x = (t - t0)/(t1 - t0)``.
    """

    started: bool
    t0: float
    t1: float
    y0: Floats
    y1: Floats
    f0: Floats
    t: float
    y: Floats
    f: Floats
    h: float
    off: float
    """The error of a step that was repeated, as a part of what it may be; 0: the method tells none.
    """
    error_before: float
    precise: bool
    """Whether it has next to no error: a motion that is such a polynomial."""
    controlled: int
    rejected: int
    tried: float
    """How long the step is that is tried; 0: none is."""
    solved: bool
    """Whether its stages are solved for: what damps its errors damps rounding."""
    tiny: int
    """Steps in a row that were next to no time."""
    grid: float
    """Where the grid of fixed steps begins, and how many of them lead to its next point."""
    grid_next: float
    h_asked: float
    """What the last step began with: the size that was to be tried, the error before, the point of
    the grid."""
    error_asked: float
    grid_asked: float
    rated: bool
    """Whether `f` is known there; fixed steps find it out when they need it."""
    implicit: bool
    """Of what chooses by itself: whether modes that are not linear are left to ``radau``."""
    turns: bool
    """Whether that changes with the next step."""
    roomy: bool
    """Whether there is room for it."""
    on_edge: bool
    """Whether the motion began on an edge of a law, and how far it was from each."""
    edge: Floats
    edge_there: Floats
    left_edge: bool
    """Whether it has left one."""
    calm: int
    """Steps in a row after that which need nothing of it."""
    bound: int
    """Steps in a row that stability has bound, or that did not need ``radau``; ..."""
    free: int
    """... and since the last such one."""
    long_bound: int
    """Likewise of steps beyond a bound that a motion which is followed may keep to as well."""
    long_free: int
    past_rim: bool
    """Whether the step is beyond the rim of stability, and no guard has been found in it yet."""
    looked: int
    """Steps since it was seen how far they have led from `looked_at`."""
    looked_at: Floats
    k: Floats
    weight: Floats
    """Of each stage in a sum of them."""
    pace: Floats
    """The sizes of steps that motions in straight modes have ended with; 0: none has yet."""
    began: float
    """When the motion began, s."""
    peak_y: Floats
    peak_f1: Floats
    peak_way: Floats
    peak_rate: Floats
    peak_read: Floats
    """Of a step that may hide a peak: a state within it, rates at its end, the cubic between its
    ends, rates within it, and three samples of all bond variables and arguments."""
    motion: Floats
    """The coefficients of a step that is tried, as `dense` has those of the last one."""
    hid_until: float  # up to when a step has hidden one, s; nan: none has
    dense: Floats
    scale: Floats
    tied: Floats
    """The end of a step, on the constraints of its mode, and how far it may be off them."""
    allowed: Floats
    narrow: Floats
    """What each may be off by beside the flat end of a law, at the most."""
    ends: Floats
    """Of each rule that leads to such an end: how far it is, and the size of what that is of."""
    error: Floats
    trial: Floats
    rate: Floats
    onset: Floats
    """What each state that has not moved will be a moment later, and until when that is known."""
    onset_end: float
    bent_at: float  # when a motion has last begun on a kink
    passed: Floats
    """A moment that is passed to see that."""
    passed_next: Floats
    began_at: Floats
    passed_before: Floats
    kink: Floats
    kink_side: Floats
    """What says on which side of each kink a step of ``radau`` is."""
    kink_rate: Floats
    level0: Floats
    """Co-energy variables where the step begins and ends, with what is stored there."""
    level1: Floats
    level_at: Floats
    defect: float
    """What the step has stored beyond what its rates bring, J; see `defects`."""
    apart: float
    """What it has by how it moves at its end, beyond what is shown there, J."""
    moves: Floats
    rates_known: bool
    """The rates by which the stages of an implicit step lead on at its end, if it was one."""


def make_step(n: int, kinks: int, edges: int, rules: int) -> Step:
    """Return room for steps of n states, for what turns at kinks, ways to edges, and rules."""
    s = Step()
    s.kink = floats(kinks)
    s.kink_side = floats(kinks)
    s.edge = floats(edges)
    s.edge_there = floats(edges)
    s.y0 = floats(n)
    s.y1 = floats(n)
    s.f0 = floats(n)
    s.y = floats(n)
    s.f = floats(n)
    s.k = floats(7 * n)
    s.looked_at = floats(n)
    s.weight = floats(7)
    s.pace = floats(PACES)
    s.dense = floats(4 * n)
    s.motion = floats(4 * n)
    s.scale = floats(n)
    s.error = floats(n)
    s.tied = floats(n)
    s.kink_rate = floats(n)
    s.peak_y = floats(n)
    s.peak_f1 = floats(n)
    s.peak_way = floats(3 * n)
    s.peak_rate = floats(n)
    s.hid_until = math.nan
    s.allowed = floats(n)
    s.narrow = floats(n)
    for k in range(n):
        s.narrow[k] = math.inf
    s.ends = floats(2 * rules)
    s.trial = floats(n)
    s.rate = floats(n)
    s.onset = floats(n)
    s.onset_end = -math.inf
    s.bent_at = -math.inf
    s.passed = floats(n)
    s.passed_next = floats(n)
    s.began_at = floats(n)
    s.passed_before = floats(n)
    s.level0 = floats(n)
    s.level1 = floats(n)
    s.level_at = floats(n)
    s.moves = floats(n)
    for k in range(n):
        s.level_at[k] = math.nan
    return s
