"""What each junction law asks for in one step, and what all of them do.

The laws are read at the beginning of a step and hold at its end. Of what they do nothing is
believed: it is put back into them.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import node_name
from hybond.engine.complementarity.law_roles import CUT, ONE_SIDED, SHUT, TWO_SIDED, LawProblem
from hybond.engine.complementarity.semidefinite import is_indefinite
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.laws.gaps import has_gaps
from hybond.engine.laws.law_answers import is_held_by_others, put_problem, solve_problem
from hybond.engine.laws.law_instant import (
    CLOSED,
    NO_LAW_VALUE,
    evaluate_gap,
    find_able,
    find_start,
    hold_restitution,
    is_on,
    passive_role,
    quantity,
)
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.law_seconds import warn_of_several
from hybond.engine.laws.ports import times_partner
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.reasons.facts import add_fact
from hybond.engine.timestepping.guessed import answer_guessed
from hybond.engine.timestepping.open_shares import find_still, share
from hybond.engine.timestepping.step_records import NOT_LOOKED, Coupled, Stepping
from hybond.engine.words import Floats

ROUNDED_VALUE: Final = 1e-12
"""Part of the largest bond variable below which `w` of a law that feels nothing is rounding."""
CANCELLED_VALUE: Final = 1e-14
"""A sum below this part of its terms is rounding: a law does not change its branch for it."""
TOUCHING: Final = 1e-9
"""Part of the motion in a step within which a contact that was closed is still closed."""
ROUNDED_GAP: Final = 64.0 * EPSILON
"""Part of the terms of a gap that is rounding of it."""
AT_REST: Final = 1e-9
"""Part of the largest approach so far below which a contact counts as at rest."""
KEEPS: Final = 1e-7
"""Part of its terms up to which an answer, put back into its law, may be off."""


def read_step_laws(e: Engine, s: Stepping, p: Ports) -> int:
    """Read the laws at the beginning of a step; HB-C105 where slip has no inertia."""
    m = e.model
    r = e.laws
    v = s.v0
    s.size = 0.0
    for b in range(2 * m.bonds):
        s.size = max(s.size, math.fabs(s.w[b]))
    times_partner(m, p, s.w, s.before)
    find_start(m, r)
    if has_gaps(m):
        # what touches but for rounding of its gap takes part in impacts of others
        copy_floats(2 * m.slots, v, r.v)
        if find_able(e, r) != OK:
            return REFUSED
    for k in range(m.ports):
        is_common = p.given[k] == COMMON
        if m.port_planar[k] != 0 and is_common:
            why = "the slip is not determined by what is stored"
            return say_fault(e, "HB-C105", why, node_name(m, m.port_node[k]))
        r.role[k] = TWO_SIDED if m.port_two_sided[k] != 0 else ONE_SIDED
        s.gap[k] = -math.inf
        s.gap_rate[k] = 0.0
        if m.port_gap[k] != NO_LAW_VALUE:
            s.gap[k] = quantity(m, m.port_gap, m.port_gap_constant, k, v)
            for i in range(m.pair_first[2 * k + 1], m.pair_first[2 * k + 2]):
                s.gap_rate[k] -= m.pair_value[i] * s.w[m.pair_column[i]]
        if m.port_gate[k] != NO_LAW_VALUE and not is_on(m, k, e.state[m.port_machine[k]]):
            if quantity(m, m.port_gate, m.port_gate_constant, k, v) == 0.0:
                r.role[k] = passive_role(p, k)
        s.restitution[k] = 0.0
        if m.port_restitution[k] != NO_LAW_VALUE and is_common:
            s.restitution[k] = quantity(m, m.port_restitution, m.port_restitution_constant, k, v)
    return OK


def close_half_way(e: Engine, s: Stepping, p: Ports, h: float, bonds: Floats) -> None:
    """Leave out the contacts that stay open for the first half of a step of length `h`.

    What is closed but for rounding does not. The others take part with their coefficient of
    restitution. `bonds` are what they are at the end if no law acts: what rests on a contact and
    would fall again within the step is not let go of because its distance is positive by rounding;
    nor is the leg of a table that the load on the other legs would lift if it were not for them.
    What was closed and neither comes nearer nor goes apart is closed, whatever distance the step
    left in which it closed: two bodies that fall as one meet the floor as one. So is what a spring
    in the contact presses, until the spring says that it is open.
    """
    m = e.model
    r = e.laws
    times_partner(m, p, bonds, s.free)
    motion = 0.0
    for k in range(m.ports):
        if s.gap[k] > -math.inf and p.given[k] == COMMON:
            motion = max(motion, h * math.fabs(s.free[k]))
    for k in range(m.ports):
        near = s.gap[k] + 0.5 * h * s.gap_rate[k]
        # what overlaps by the step in which it struck, and goes apart, does not touch
        touching = r.able[k] != 0 and s.gap[k] >= -CLOSED * r.largest[k]
        if not near > 0.0 or (touching and not is_on(m, k, e.state[m.port_machine[k]])):
            continue
        if is_on(m, k, e.state[m.port_machine[k]]) and p.given[k] == COMMON:
            touches = s.gap[k] + 0.5 * h * min(s.free[k], 0.0) <= 0.0
            moves = h * max(math.fabs(s.free[k]), math.fabs(s.gap_rate[k]))
            if touches or near <= TOUCHING * motion or moves <= TOUCHING * motion:
                continue
            if is_rounding(e, s, k):
                # what friction does is not in the motion without laws that leads apart
                continue
        elif is_on(m, k, e.state[m.port_machine[k]]) and keeps_its_gap(e, s, k, h):
            continue
        r.role[k] = passive_role(p, k)
        s.restitution[k] = 0.0


def keeps_its_gap(e: Engine, s: Stepping, k: int, h: float) -> bool:
    """Whether the gap of port k, which was closed, is what a step left in which it closed.

    A spring in the contact says what it carries, and no speed; its gap stays as it is while it is
    closed, but for rounding. A gap that jumps, as at the edge of a table, lets go.
    """
    m = e.model
    was = s.closed_gap[k]
    if was == math.inf or m.port_gap_pair[k] < 0:
        return True
    motion = 0.0
    for i in range(m.pair_first[2 * k + 1], m.pair_first[2 * k + 2]):
        motion += h * math.fabs(m.pair_value[i] * s.w[m.pair_column[i]])
    if was == -math.inf:
        return s.gap[k] <= motion
    evaluate_gap(e, e.laws, k, s.v0)
    terms = e.work.stack.size[e.work.stack.top]
    return math.fabs(s.gap[k] - was) <= TOUCHING * motion + ROUNDED_GAP * terms


def note_closed_gaps(e: Engine, s: Stepping) -> None:
    """Note the gaps with which the step just made began, of contacts that were closed then."""
    m = e.model
    for k in range(m.ports):
        closed = s.gap[k] > -math.inf and is_on(m, k, e.state[m.port_machine[k]])
        s.closed_gap[k] = s.gap[k] if closed else -math.inf


def is_rounding(e: Engine, s: Stepping, k: int) -> bool:
    """Whether the gap of port k, where a step begins, is rounding of its terms."""
    if e.model.port_gap_pair[k] < 0:
        return False
    evaluate_gap(e, e.laws, k, s.v0)
    return math.fabs(s.gap[k]) <= ROUNDED_GAP * e.work.stack.size[e.work.stack.top]


def solve_step_laws(
    e: Engine, s: Stepping, p: Ports, c: Coupled, bonds: Floats, doubtful: bool
) -> int:
    """Find what the laws do, where bond variables are ``bonds + gain l``, into `s.l`.

    `s.v1` holds the values at which limits of friction are linearised. If `doubtful`, what `w` has
    without `l` below `s.doubt` is rounding. HB-J120 if there is no answer, HB-J121 if none was
    found.
    """
    m = e.model
    r = e.laws
    n = m.ports
    a = r.response
    a.gain = c.gain.at
    a.d = c.m.at
    a.ce = c.m.at
    copy_floats(2 * m.bonds, bonds, a.bonds)
    times_partner(m, p, bonds, r.q)
    bounces = False
    rubs = False
    for k in range(n):
        s.turned[k] = 0
        a.size[k] = s.doubt[k]
        if doubtful and math.fabs(r.q[k]) <= CANCELLED_VALUE * s.doubt[k]:
            r.q[k] = 0.0
        if c.deaf[k] != 0 and r.q[k] < 0.0 and r.q[k] >= -ROUNDED_VALUE * s.size:
            r.q[k] = 0.0
        if s.before[k] < 0.0 and hold_restitution(e, k, s.restitution[k], e.t) != OK:
            return REFUSED
        r.rebound[k] = s.restitution[k] * s.before[k]
        bounces = bounces or s.restitution[k] != 0.0
        rests = m.port_breakaway[k] != NO_LAW_VALUE and m.port_planar[k] == 0
        r.resting[k] = 1 if rests and e.state[m.port_machine[k]] == 0 else 0
        rubs = rubs or r.role[k] == TWO_SIDED
    for d in range(m.disks):
        e.planar.resting[d] = 1
        # what holds up to its breakaway limit is what was at rest
        e.planar.slid[d] = 0 if e.state[m.disk_machine[d]] == 0 else 1
    e.planar.ready = m.disks > 0
    if rubs:
        copy_floats(2 * m.slots, s.v1, r.later)
    found = ask_laws(e, s, c, bounces)
    e.planar.ready = False
    for d in range(m.disks):
        e.planar.slid[d] = 0
    if not found:
        return no_end(e, r.problem.proved)
    for k in range(n):
        s.branch[k] = r.problem.branch[k]
        s.l[k] = r.problem.l[k] if r.problem.role[k] != CUT else 0.0
    keep_idle_branches(e, s, c)
    if c.still == NOT_LOOKED and find_still(e, s, p, c) != OK:
        return REFUSED
    for k in range(n):
        s.shared[k] = 0
    if c.still > 0:
        share(e, s, p, c)
    return OK if keeps_laws(e, s, c) else no_end(e, False)


def ask_laws(e: Engine, s: Stepping, c: Coupled, bounces: bool) -> bool:
    """Ask the laws, those of the last step's branches first.

    What was at rest stays so up to its breakaway limit, and slides with the other one: to let go is
    never taken back. So does what would end the step sliding the other way: it comes to rest in
    between.
    """
    m = e.model
    r = e.laws
    n = m.ports
    p = r.problem
    if c.semidefinite == NOT_LOOKED:
        fit(s.square, n * n)
        c.semidefinite = 0 if is_indefinite(n, c.m.at, s.scale, s.down, s.square.at) else 1
    while True:
        rests = put_problem(e, r, r.q, 0.0, bounces)
        for k in range(n):
            p.moved[k] = p.q[k] + p.shift[k]
        monotone = c.semidefinite != 0
        guessed = not rests and answer_guessed(s.guess, p, r.start, c.number, monotone)
        if not guessed and not solve_problem(e, r, rests):
            return False
        broken = False
        for k in range(n):
            slides = r.resting[k] != 0 and p.branch[k] != 0
            if slides and not is_held_by_others(m, r, k) and not rests_on_others(c, p, k):
                r.resting[k] = 0
                broken = True
            elif s.turned[k] == 0 and reverses(e, p, k):
                s.turned[k] = 1
                r.resting[k] = 1
                broken = True
        if broken:
            continue
        if not guessed and p.answers > 1 and not c.lost and not s.second_said:
            r.t = s.v1[0]
            warn_of_several(e, r)
            s.second_said = True
        if not guessed:
            # in the units of the problem, as it was asked
            put_problem(e, r, r.q, 0.0, bounces)
            for k in range(n):
                p.moved[k] = p.q[k] + p.shift[k]
        return True


def reverses(e: Engine, p: LawProblem, k: int) -> bool:
    """Whether friction with a breakaway limit would end a step sliding the other way."""
    m = e.model
    if m.port_breakaway[k] == NO_LAW_VALUE or m.port_planar[k] != 0:
        return False
    began = e.state[m.port_machine[k]]
    return (began == 1 and p.branch[k] < 0) or (began == 2 and p.branch[k] > 0)


def rests_on_others(c: Coupled, p: LawProblem, k: int) -> bool:
    """Whether friction at its breakaway does not move, and diodes or contacts may hold, too.

    What leans on a stop is held by both; how much by either is open, and nothing breaks loose.
    """
    if p.open[k] == 0:
        return False
    for j in range(p.n):
        if j != k and p.role[j] == ONE_SIDED and c.m.at[k * p.n + j] != 0.0:
            return True
    return False


def keep_idle_branches(e: Engine, s: Stepping, c: Coupled) -> None:
    """Leave the branches as they were of laws where either fits: nothing has happened there.

    Friction that has come to rest at its limit rests, and holds up to its breakaway from then on.
    """
    r = e.laws
    p = r.problem
    n = p.n
    for k in range(n):
        if p.role[k] == CUT or p.role[k] == SHUT:
            continue
        either = p.open[k] != 0
        own = c.m.at[k * n + k]
        if p.role[k] == ONE_SIDED and own > 0.0 and not either:
            w = p.moved[k]
            size = math.fabs(w)
            for j in range(n):
                w += c.m.at[k * n + j] * s.l[j]
                size += math.fabs(c.m.at[k * n + j]) * math.fabs(s.l[j])
            dust = CANCELLED_VALUE * size
            if s.gap[k] > -math.inf and r.start[k] == 1:
                # bodies that fall as one lose touch by rounding of many steps, and meet no floor so
                dust = max(dust, AT_REST * s.most[k])
            either = math.fabs(w) <= dust and own * s.l[k] <= dust
        p.open[k] = 1 if either else 0
        if either:
            if p.role[k] == ONE_SIDED:
                # nothing, and by rounding not less: where all ways are tried it may be that
                s.l[k] = max(s.l[k], 0.0)
            rests = e.model.port_breakaway[k] != NO_LAW_VALUE and p.role[k] == TWO_SIDED
            s.branch[k] = 0 if rests and e.model.port_planar[k] == 0 else r.start[k]
    for k in range(n):
        if p.open[k] != 0 and p.role[k] == TWO_SIDED and p.common[k] == 0:
            # at rest at its limit, and by rounding not beyond it
            most = limit_of(s, p, k)
            if e.model.port_planar[k] == 0:
                s.l[k] = max(-most, min(most, s.l[k]))


def keeps_laws(e: Engine, s: Stepping, c: Coupled) -> bool:
    """Whether what was found keeps all laws, each put back into itself."""
    m = e.model
    p = e.laws.problem
    n = p.n
    for k in range(n):
        s.holding[k] = limit_of(s, p, k)
    for k in range(n):
        w = p.moved[k] if p.role[k] == ONE_SIDED else p.q[k]
        size = math.fabs(w)
        able = 0.0
        for j in range(n):
            w += c.m.at[k * n + j] * s.l[j]
            size += math.fabs(c.m.at[k * n + j]) * math.fabs(s.l[j])
            able += math.fabs(c.m.at[k * n + j]) * s.holding[j]
        s.wl[k] = w
        # beside friction that carries nothing there is rounding of what it could carry
        off = max(KEEPS * size, ROUNDED_VALUE * able)
        own = math.fabs(c.m.at[k * n + k])
        if not math.isfinite(w):
            return False
        if p.role[k] == SHUT and math.fabs(w) > off + ROUNDED_VALUE * s.size:
            return False
        if p.role[k] == ONE_SIDED:
            low = w < -off - ROUNDED_VALUE * s.size or own * s.l[k] < -off
            if low or min(w, own * s.l[k]) > off + ROUNDED_VALUE * s.size:
                return False
        if p.role[k] == TWO_SIDED and m.port_planar[k] == 0 and not keeps_friction(s, p, k, off):
            return False
    return True


def limit_of(s: Stepping, p: LawProblem, k: int) -> float:
    """Return what friction may hold, with what is found; zero of other laws."""
    if p.role[k] != TWO_SIDED:
        return 0.0
    limit = p.limit[k]
    if p.sloped[k] != 0:
        for j in range(p.n):
            limit += p.slope[k * p.n + j] * s.l[j]
    return math.fabs(limit)


def keeps_friction(s: Stepping, p: LawProblem, k: int, off: float) -> bool:
    """Whether a friction law holds: within its limit, and at it where it slides."""
    n = p.n
    limit = p.limit[k]
    terms = math.fabs(limit)
    for j in range(n if p.sloped[k] != 0 else 0):
        limit += p.slope[k * n + j] * s.l[j]
        terms += math.fabs(p.slope[k * n + j]) * math.fabs(s.l[j])
    is_common = p.common[k] != 0
    force = -s.wl[k] if is_common else -s.l[k]
    speed = s.l[k] if is_common else s.wl[k]
    loose = KEEPS * terms
    own = math.fabs(p.m[k * n + k])
    if is_common:
        loose += off
    elif own > 0.0:
        # a force that moves nothing by more than what its speed may be off
        loose += off / own
    if math.fabs(force) > limit + loose:
        return False
    slips = math.fabs(speed) > (0.0 if is_common else off + ROUNDED_VALUE * s.size)
    way = 1.0 if speed > 0.0 else -1.0
    return not slips or p.branch[k] == 0 or way * force >= limit - loose


def no_end(e: Engine, proved: bool) -> int:
    """Refuse laws that have no solution in a step: HB-J120; or HB-J121 if none was found."""
    m = e.model
    r = e.laws
    code = "HB-J121"
    why = "no solution of the laws was found in a step: give a contact a stiffness"
    if proved:
        code = "HB-J120"
        why = (
            "the laws have no solution in a step: give a contact a stiffness, a source a resistance"
        )
    found = say_fault(e, code, why, node_name(m, m.port_node[0]))
    if m.tells != 0:
        for k in range(m.ports):
            if r.role[k] != CUT:
                add_fact(e.fault, float(k))
    return found
