"""What is constant between two timed events: pieces of inputs, comparisons of time.

Where what depends on time alone has a kink or a jump at an end of such an interval, time is read
just within it: on either side of the instant as it is there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.inputs.calls import (
    CALLED,
    CONSTANT,
    FREE,
    LINES,
    PULSES,
    call_input,
    call_input_rate,
)
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints

ROUNDING: Final = 8.0 * EPSILON
"""Eight units in the last place: what instants that are one on paper differ by."""
HALF: Final = 0.5
"""Of one, which whole numbers, signs and truths jump by at least."""


def edge(m: Model, i: int, piece: int) -> float:
    """Return when piece number `piece` of pulses begins."""
    at = m.input_first[i]
    cycle = math.floor(0.5 * float(piece))
    falling = piece - 2 * int(cycle)
    share = m.input_number[at + 1] if falling == 1 else 0.0
    return m.input_number[at + 4] + (float(cycle) + share) * m.input_number[at]


def rows_of_round(m: Model, i: int) -> int:
    """Return how many rows of a table that repeats make a round."""
    at = m.input_first[i]
    many = (m.input_first[i + 1] - at) // 2
    closed = many > 1 and m.input_number[at + many - 1] >= m.input_number[at] + m.input_period[i]
    return many - 1 if closed else many


def row_of_piece(m: Model, i: int, piece: int) -> int:
    """Return the row of a table that a piece but the first begins with."""
    if m.input_period[i] == 0.0:
        return piece - 1
    rows = rows_of_round(m, i)
    return piece - 1 - (piece - 1) // rows * rows


def begin_of_piece(m: Model, i: int, piece: int) -> float:
    """Return when a piece of a table begins, but the first one."""
    row = row_of_piece(m, i, piece)
    begin = m.input_number[m.input_first[i] + row]
    if m.input_period[i] == 0.0:
        return begin
    return begin + float((piece - 1) // rows_of_round(m, i)) * m.input_period[i]


def whole_below(x: float) -> int:
    """Return the largest whole number that is not above x."""
    below = float(math.floor(x))
    return int(below)


def piece_of(m: Model, i: int, t: float) -> int:
    """Return the number of the piece of an input that begins at or contains t."""
    at = m.input_first[i]
    kind = m.input_kind[i]
    if kind == CONSTANT or kind == FREE:
        return 0
    if m.called > 0 and kind == CALLED:
        return breaks_until(m, i, t)
    if kind == PULSES:
        guess = 2 * whole_below((t - m.input_number[at + 4]) / m.input_number[at]) - 2
        while edge(m, i, guess + 1) <= t:
            guess += 1
        return guess
    if m.input_period[i] > 0.0 and t >= m.input_number[at]:
        rounds = whole_below((t - m.input_number[at]) / m.input_period[i]) - 1
        guess = max(0, rounds) * rows_of_round(m, i)
        while begin_of_piece(m, i, guess + 1) <= t:
            guess += 1
        return guess
    many = (m.input_first[i + 1] - at) // 2
    piece = 0
    while piece < many and m.input_number[at + piece] <= t:
        piece += 1
    return piece


def breaks_until(m: Model, i: int, t: float) -> int:
    """Return how many breaks of an input that is called are at or before t."""
    low = m.input_first[i]
    high = m.input_first[i + 1]
    while low < high:
        middle = (low + high) // 2
        if m.input_number[middle] <= t:
            low = middle + 1
        else:
            high = middle
    return low - m.input_first[i]


def next_break(m: Model, i: int, t: float, piece: int) -> float:
    """Return the first instant after t, in that piece of an input, at which it begins another."""
    at = m.input_first[i]
    kind = m.input_kind[i]
    if kind == CONSTANT or kind == FREE:
        return math.inf
    if m.called > 0 and kind == CALLED:
        following = at + breaks_until(m, i, t)
        return m.input_number[following] if following < m.input_first[i + 1] else math.inf
    if kind == PULSES:
        duty = m.input_number[at + 1]
        if duty == 0.0 or duty == 1.0:
            return math.inf
        return edge(m, i, piece + 1)
    many = (m.input_first[i + 1] - at) // 2
    if m.input_period[i] > 0.0 or piece < many:
        return begin_of_piece(m, i, piece + 1)
    return math.inf


def input_rate(m: Model, i: int, piece: int) -> float:
    """Return the time derivative of an input within a piece."""
    at = m.input_first[i]
    many = (m.input_first[i + 1] - at) // 2
    period = m.input_period[i]
    if m.input_kind[i] != LINES or piece == 0 or (period == 0.0 and piece == many):
        return 0.0
    row = row_of_piece(m, i, piece)
    last = row + 1 == many
    rise = m.input_number[at + many + (0 if last else row + 1)] - m.input_number[at + many + row]
    end = m.input_number[at] + period if last else m.input_number[at + row + 1]
    return rise / (end - m.input_number[at + row])


def take_line(e: Engine, i: int) -> None:
    """Find the line that an input follows within its piece, extended beyond it if need be."""
    m = e.model
    piece = e.piece[i]
    if e.line_piece[i] == piece:
        return
    at = m.input_first[i]
    kind = m.input_kind[i]
    many = (m.input_first[i + 1] - at) // 2
    e.line_piece[i] = piece
    e.line_rate[i] = input_rate(m, i, piece)
    e.line_begin[i] = 0.0
    if kind == CONSTANT or kind == FREE:
        e.line_value[i] = m.input_number[at]
    elif kind == PULSES:
        high = piece - 2 * whole_below(0.5 * float(piece)) == 0
        e.line_value[i] = m.input_number[at + 2] if high else m.input_number[at + 3]
    elif piece == 0:
        e.line_value[i] = m.input_number[at + many]
    else:
        e.line_value[i] = m.input_number[at + many + row_of_piece(m, i, piece)]
        e.line_begin[i] = begin_of_piece(m, i, piece) if e.line_rate[i] != 0.0 else 0.0


def ask_input(e: Engine, i: int, t: float) -> None:
    """Call for an input within its piece, and for its rate if that is read; once for an instant.

    It stands in `line_value` and `line_rate`, and the instant in `line_begin`.
    """
    piece = e.piece[i]
    if e.line_piece[i] == piece and e.line_begin[i] == t:
        return
    e.line_value[i] = call_input(e.calls, i, t, piece)
    if e.model.input_rated[i] != 0:
        e.line_rate[i] = call_input_rate(e.calls, i, t, piece)
    e.line_piece[i] = piece
    e.line_begin[i] = t


def level_of_piece(m: Model, i: int, piece: int) -> int:
    """Return which of its levels an input has, where these select equations."""
    kind = m.input_kind[i]
    if kind == CONSTANT:
        return 0
    if kind == PULSES:
        return piece - 2 * whole_below(0.5 * float(piece))
    if piece == 0:
        return m.level_of[m.level_first[i]]
    return m.level_of[m.level_first[i] + 1 + row_of_piece(m, i, piece)]


def next_sample(m: Model, k: int, t: float) -> float:
    """Return the first instant after t of a sampled signal."""
    every = m.sample_every[k]
    phase = m.sample_phase[k]
    if t < phase:
        return phase
    n = float(math.floor((t - phase) / every))
    if phase + n * every > t:
        n -= 1.0
    while phase + n * every <= t:
        n += 1.0
    return phase + n * every


def is_due(m: Model, k: int, t: float) -> bool:
    """Whether t is one of the instants of a sampled signal."""
    n = math.floor((t - m.sample_phase[k]) / m.sample_every[k] + 0.5)
    return n >= 0.0 and one_instant(m.sample_phase[k] + n * m.sample_every[k], t)


def one_instant(a: float, b: float) -> bool:
    """Whether two timed events are one, but for rounding."""
    return math.fabs(a - b) <= ROUNDING * math.fabs(b)


def interval_after(e: Engine, t: float) -> None:
    """Enter the interval that begins at t or contains it."""
    m = e.model
    e.straight = False
    e.within_from = math.nan
    e.within_to = math.nan
    for i in range(m.inputs):
        e.piece[i] = piece_of(m, i, t)
        e.level[i] = e.asked[i]
    end = break_after(e, t)
    inside = t + 0.5 * (end - t) if end < math.inf else t + 1.0
    for k in range(m.watches):
        e.at[k] = 1 if watch_holds(m, k, inside) else 0
    e.next_break = end
    read_within(e, t, end)


def read_within(e: Engine, t: float, end: float) -> None:
    """Read time between two instants just within them, where what depends on time jumps there."""
    m = e.model
    if t == e.within_from and end == e.within_to and m.called == 0:
        e.late = e.within_late
        e.early = e.within_early
        return
    e.within_to = math.nan
    e.late = -math.inf
    e.early = math.inf
    if m.timed_jumps > 0 and jumps_beside(e, t, moment(m, t), m.timed_jumps):
        e.late = t + moment(m, t)
    # at the end of a run nothing ticks: a guard that holds there but for rounding is to be found
    many = m.timed_jumps if end == e.next_break else m.timed_laws
    hold_before(e, end, many)
    e.within_from = t
    e.within_to = end
    e.within_many = many
    e.within_late = e.late
    e.within_early = e.early


def hold_before(e: Engine, t: float, many: int) -> None:
    """Read time just before an instant at the latest, where what depends on time jumps there.

    Of that the first `many` are asked, unless they were where the interval began that ends there.
    """
    m = e.model
    if many == 0 or not (t > e.late and t < math.inf):
        return
    if t == e.within_to and many == e.within_many and m.called == 0:
        e.early = min(e.early, e.within_early)
    elif jumps_beside(e, t, -moment(m, t), many):
        e.early = min(e.early, t - moment(m, t))


def jumps_beside(e: Engine, t: float, way: float, many: int) -> bool:
    """Whether what depends on time alone has another value next to an instant than there.

    By the present interval. The values in `e.v` are changed that it reads.
    """
    m = e.model
    late = e.late
    early = e.early
    e.late = -math.inf
    e.early = math.inf
    jumps = False
    for k in range(many):
        set_time(e, e.v, t)
        there = value(m, m.timed_jump[k], e.v)
        set_time(e, e.v, t + way)
        jumps = jumps or math.fabs(value(m, m.timed_jump[k], e.v) - there) > HALF
    e.late = late
    e.early = early
    return jumps


def moment(m: Model, t: float) -> float:
    """Return a time that is none, and long enough to be on one side of a kink."""
    return ROUNDING * max(math.fabs(t), m.span)


def break_after(e: Engine, t: float) -> float:
    """Return the first timed event after t; of several that are one but for rounding, the last.

    Inputs are in the pieces that they have at t.
    """
    m = e.model
    first = math.inf
    for i in range(m.inputs):
        first = min(first, next_break(m, i, t, e.piece[i]))
    for k in range(m.samples):
        first = min(first, next_sample(m, k, t))
    for k in range(m.watches):
        if m.watch_time[k] > t:
            first = min(first, m.watch_time[k])
    if m.inputs == 1 and m.samples == 0 and m.watches == 0:
        return first
    last = first
    for i in range(m.inputs):
        last = later(last, next_break(m, i, t, e.piece[i]), first)
    for k in range(m.samples):
        last = later(last, next_sample(m, k, t), first)
    for k in range(m.watches):
        last = later(last, m.watch_time[k], first)
    return last


def later(last: float, t: float, first: float) -> float:
    """Return the later of `last` and `t`, if `t` is one instant with `first`."""
    return max(last, t) if one_instant(t, first) else last


def watch_holds(m: Model, k: int, t: float) -> bool:
    """Whether a comparison of time holds at t."""
    difference = m.watch_slope[k] * t + m.watch_offset[k]
    if m.watch_operator[k] == 0:
        return difference < 0.0
    if m.watch_operator[k] == 1:
        return difference <= 0.0
    if m.watch_operator[k] == 2:
        return difference > 0.0
    return difference >= 0.0


def set_time(e: Engine, v: Floats, t: float) -> None:
    """Write time, inputs and comparisons of time."""
    m = e.model
    t = min(max(t, e.late), e.early)
    v[0] = t
    for i in range(m.inputs):
        if m.called > 0 and m.input_kind[i] == CALLED:
            ask_input(e, i, t)
            v[m.input_slot + i] = e.line_value[i]
            v[m.input_rate_slot + i] = e.line_rate[i]
            continue
        if e.line_piece[i] != e.piece[i]:
            take_line(e, i)
        rate = e.line_rate[i]
        v[m.input_slot + i] = (
            e.level[i]
            if m.input_kind[i] == FREE
            else e.line_value[i] + rate * (t - e.line_begin[i])
        )
        v[m.input_rate_slot + i] = rate
    for k in range(m.watches):
        v[m.at_slot + k] = float(e.at[k])


def is_timed(e: Engine, t: float) -> bool:
    """Whether an instant is one at which a comparison of time may change."""
    found = False
    for k in range(e.model.watches):
        found = found or one_instant(e.model.watch_time[k], t)
    return found


def configuration(e: Engine, state: Ints, key: Ints) -> None:
    """Put what selects equations there: states of machines, then what the interval selects."""
    m = e.model
    for k in range(m.machines):
        key[k] = state[k]
    for d in range(m.discrete):
        i = m.discrete_index[d]
        key[m.machines + d] = (
            e.at[i] if m.discrete_kind[d] == 1 else level_of_piece(m, i, e.piece[i])
        )
