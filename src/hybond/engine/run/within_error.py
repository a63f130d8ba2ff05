"""What a step leaves beside an edge, no farther than its error, rests there if it stays.

Two tanks run out together, through a hole at the bottom or half way up, and a step has left the
upper one below that by less than its error: it would be filled from below, where there is nothing
to give, and laws have no value there. So all that laws take the root of, and that is next to
nothing, is brought to nothing at once, by the smallest change of what is stored; what goes on all
the same is left as it was.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, fit, make_block
from hybond.engine.algebra.least_step import LeastStep, find_least_step, make_least_step
from hybond.engine.algebra.products import copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.functions import BELOW
from hybond.engine.methods.tolerances.scale import widest_tolerance
from hybond.engine.mode.digits.sizes import sizes_of
from hybond.engine.surfaces.values import evaluate, field
from hybond.engine.words import Floats, Ints, floats, ints, record

PASSES: Final = 4
"""Times that the straight way is gone: differences are known to a part of them."""
NOTHING: Final = 1e-6
"""Part of the error of a step that is nothing."""
MIDDLE: Final = 0.5 * BELOW
"""Part of its terms by which what is put on an edge is beyond it: what is rounding is nothing."""
ROUNDED: Final = BELOW
"""Part of what is stored by which it is moved to see what rounding makes of rates."""


LEFT: Final = 0
MOVED: Final = 1
GONE: Final = 2
"""What becomes of a state: nothing, a little change, or nothing is left of it."""


@record
class Resting:
    """Room to see what is brought to rest, and by what."""

    here: Floats
    size: Floats
    there: Floats
    """What laws take roots of, what its terms add up to, and the same elsewhere."""
    near: Ints
    """Which of it is next to nothing."""
    lead: Block
    """By how much the error of each state moves it: a row for each, and those of what is near."""
    step: LeastStep
    """What is asked of it, and by what part of its error each state is moved for that."""
    allowed: Floats
    """The error of a step in each state."""
    way: Ints
    """Whether each is left as it is, moved, or no more than that error, and brought to nothing."""
    after: Floats
    beside: Floats
    """The state that comes of it, and one beside it."""
    rate: Floats
    rate_beside: Floats
    noise: Floats
    """Rates there, and by how much rounding of what is stored moves these."""
    steps: int
    waits: int
    since: float
    """How many steps there were since it was last asked, after how many it is next, and when."""


def make_resting(e: Engine) -> Resting:
    """Return such room."""
    s = Resting()
    many = e.model.begins
    s.here = floats(many)
    s.size = floats(many)
    s.there = floats(many)
    s.near = ints(many)
    s.lead = make_block(1)
    s.step = make_least_step(many, e.states)
    s.allowed = floats(e.states)
    s.way = ints(e.states)
    s.rate_beside = floats(e.states)
    s.after = floats(e.states)
    s.beside = floats(e.states)
    s.rate = floats(e.states)
    s.noise = floats(e.states)
    s.waits = 1
    s.since = -math.inf
    return s


def stop_within_error(e: Engine, s: Resting, stuck: bool) -> bool:
    """Put what is within the error of a step on the edges of laws, if it stays; whether it does.

    Where no step leads on, and it is `stuck`, it may be filled from there as well. Else what is
    filled has its level above the edge, and each time it would lose that.
    """
    m = e.model
    widest_tolerance(e, e.y, s.allowed)
    for j in range(m.storages, e.states):
        s.allowed[j] = 0.0
    if not see_arguments(e, e.y, s.here, s.size) or not see_leads(e, s):
        return False
    if not rests_with_all(e, s) and not (stuck and is_filled_from_edge(e, s)):
        return False
    copy_floats(e.states, s.after, e.y)
    return True


def rests_with_all(e: Engine, s: Resting) -> bool:
    """Whether what is moved stays, be it brought to nothing or not; what would not, is left."""
    for j in range(e.states):
        gone = math.fabs(e.y[j]) <= s.allowed[j]
        s.way[j] = LEFT if s.allowed[j] == 0.0 else GONE if gone else MOVED
    moves = True
    while moves:
        if not choose_near(e, s) or not bring_near(e, s):
            return False
        moves = leave_moving(e, s)
    return is_put_on_edge(e, s)


def is_filled_from_edge(e: Engine, s: Resting) -> bool:
    """Whether what is moved by as little as can be is drawn beyond no edge; it may be filled."""
    for j in range(e.states):
        s.way[j] = MOVED if s.allowed[j] > 0.0 else LEFT
    if not choose_near(e, s) or not bring_near(e, s):
        return False
    see_noise(e, s)
    for k in range(e.model.edges):
        speed = 0.0
        for j in range(e.states):
            if s.near[k] != 0 and s.allowed[j] > 0.0:
                lead = s.lead.at[k * e.states + j] / s.allowed[j]
                speed += lead * s.rate[j] + math.fabs(lead) * s.noise[j]
        if not speed >= 0.0:
            return False
    return is_put_on_edge(e, s)


def see_arguments(e: Engine, y: Floats, here: Floats, size: Floats | None) -> bool:
    """Put what laws take roots of there, and what its terms add up to; whether it is known."""
    m = e.model
    if evaluate(e, e.mode, e.v, e.t, y) != OK:
        return False
    for k in range(m.begins):
        here[k] = value(m, m.edge_value[k], e.v)
        if not math.isfinite(here[k]):
            return False
    if size is not None:
        sizes_of(e, e.mode, e.v)
        for i in range(m.edge_bonds):
            e.v[m.bond_slot + m.edge_bond[i]] = e.work.sizes[m.edge_bond[i]]
        for k in range(m.begins):
            size[k] = value(m, m.edge_size[k], e.v)
    return True


def see_leads(e: Engine, s: Resting) -> bool:
    """Put by how much the error of each state moves what laws take roots of into columns."""
    n = e.states
    many = e.model.begins
    fit(s.lead, 2 * many * n)
    lead = s.lead.at
    copy_floats(n, e.y, s.beside)
    for j in range(n):
        way = s.allowed[j]
        s.beside[j] = e.y[j] + way
        if way > 0.0 and not see_arguments(e, s.beside, s.there, None):
            way = -way
            s.beside[j] = e.y[j] + way
            if not see_arguments(e, s.beside, s.there, None):
                return False
        for k in range(many):
            lead[k * n + j] = (s.there[k] - s.here[k]) / way * s.allowed[j] if way != 0.0 else 0.0
        s.beside[j] = e.y[j]
    return True


def choose_near(e: Engine, s: Resting) -> bool:
    """Note what is next to nothing beside the error of a step; whether there is any."""
    n = e.states
    some = False
    for k in range(e.model.begins):
        far = 0.0
        for j in range(n):
            if s.way[j] != LEFT:
                far += math.fabs(s.lead.at[k * n + j])
        s.near[k] = 1 if far > 0.0 and math.fabs(s.here[k]) <= far else 0
        some = some or s.near[k] != 0
    return some


def bring_near(e: Engine, s: Resting) -> bool:
    """Bring that to nothing by the smallest change, and find rates there; False if they fail."""
    m = e.model
    n = e.states
    for j in range(n):
        s.after[j] = e.y[j] if s.way[j] != GONE else 0.0
    for _ in range(PASSES):
        if not see_arguments(e, s.after, s.there, s.size):
            return False
        c = 0
        at = m.begins * n
        for k in range(m.begins):
            if s.near[k] == 0:
                continue
            # what has a root on one side alone is put where rounding does not make one
            beyond = MIDDLE * s.size[k] if k < m.edges and s.there[k] != 0.0 else 0.0
            s.step.rest[c] = -s.there[k] - beyond
            for j in range(n):
                s.lead.at[at] = s.lead.at[k * n + j] if s.way[j] == MOVED else 0.0
                at += 1
            c += 1
        find_least_step(s.step, c, n, s.lead.at, m.begins * n)
        for j in range(n):
            if s.way[j] != MOVED:
                continue
            s.after[j] += s.allowed[j] * s.step.z[j]
            if math.fabs(s.after[j]) <= NOTHING * s.allowed[j]:
                s.after[j] = 0.0
            if not math.fabs(s.after[j] - e.y[j]) <= s.allowed[j]:
                return False
    return field(e, e.mode, e.t, s.after, s.rate) == OK


def leave_moving(e: Engine, s: Resting) -> bool:
    """Leave as it was what moves on from there all the same; whether there is any."""
    see_noise(e, s)
    moves = False
    for j in range(e.states):
        if s.after[j] != e.y[j] and not math.fabs(s.rate[j]) <= s.noise[j]:
            s.way[j] = LEFT
            moves = True
    return moves


def see_noise(e: Engine, s: Resting) -> None:
    """See by how much rounding of what is stored moves rates."""
    n = e.states
    for i in range(n):
        s.noise[i] = 0.0
    copy_floats(n, s.after, s.beside)
    for j in range(n):
        if s.after[j] == 0.0 or s.after[j] == e.y[j]:
            continue
        s.beside[j] = s.after[j] + math.fabs(ROUNDED * s.after[j])
        if field(e, e.mode, e.t, s.beside, s.rate_beside) == OK:
            for i in range(n):
                s.noise[i] += math.fabs(s.rate_beside[i] - s.rate[i])
        s.beside[j] = s.after[j]


def is_put_on_edge(e: Engine, s: Resting) -> bool:
    """Whether laws have values where it was put, and one of them ends there."""
    m = e.model
    if not see_arguments(e, s.after, s.there, None):
        return False
    on = False
    for k in range(m.edges):
        if s.there[k] < 0.0 and s.here[k] >= 0.0:
            return False
        on = on or (s.there[k] == 0.0 and s.near[k] != 0)
    moved = False
    for j in range(e.states):
        moved = moved or math.fabs(s.after[j] - e.y[j]) > EPSILON * math.fabs(e.y[j])
    return on and moved
