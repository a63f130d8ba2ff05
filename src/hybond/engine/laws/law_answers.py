"""One question to the laws of an instant, and the branches that answer it.

Limits of friction depend on what the laws give, and hold more at rest than in motion: what breaks
loose is asked again.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.complementarity.all_branches import answer_laws
from hybond.engine.complementarity.decided_closely import (
    MOST,
    decide_closely,
    put_entry,
    put_known,
)
from hybond.engine.complementarity.law_roles import (
    BACKWARD,
    CUT,
    FORWARD,
    ONE_SIDED,
    TWO_SIDED,
)
from hybond.engine.engine import Engine, count_work
from hybond.engine.laws.law_friction import may_rest, rests_now, slides_through, turns_round
from hybond.engine.laws.law_instant import (
    NO_LAW_VALUE,
    find_start,
    is_on,
    is_stored,
    quantity,
)
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.law_seconds import warn_of_several
from hybond.engine.laws.law_shares import bears_less
from hybond.engine.laws.ports import base_mode
from hybond.engine.mode.rows.tableau import COMMON, NET
from hybond.engine.model import Model
from hybond.engine.planar.planar import answer_rests, put_on_the_way
from hybond.engine.words import Floats, Ints

NOISE: Final = 1e-15
"""Part of what its rounding is measured by that a finite value may be off by: large currents that
cancel leave it in each, and not the same of two that are opposite."""
LAW_DUST: Final = 1e-9
"""Part of its terms up to which a violation without a solution is rounding."""


def linearise_limit(e: Engine, r: Laws, k: int, at_rest: bool) -> None:
    """Find the limit of friction as an affine function of what the laws give.

    `r.later` are the values at which it is linearised, and bond variables without `l` are those of
    the response.
    """
    m = e.model
    n = m.ports
    p = r.problem
    rest = at_rest and m.port_breakaway[k] != NO_LAW_VALUE
    row = 2 * k + 1 if rest else 2 * k
    if rest:
        p.limit[k] = quantity(m, m.port_breakaway, m.port_breakaway_constant, k, r.later)
    else:
        p.limit[k] = quantity(m, m.port_limit, m.port_limit_constant, k, r.later)
    if p.sloped[k] != 0:
        for j in range(n):
            p.slope[k * n + j] = 0.0
    p.sloped[k] = 1 if m.limit_first[row + 1] > m.limit_first[row] else 0
    if r.limits_held and m.port_affine[k] == 0:
        return
    for i in range(m.limit_first[row], m.limit_first[row + 1]):
        law = m.limit_slope[i]
        slope = m.limit_slope_constant[i] if law < 0 else value(m, law, r.later)
        b = m.limit_column[i]
        p.limit[k] += slope * (r.response.bonds[b] - r.later[m.bond_slot + b])
        for j in range(n):
            p.slope[k * n + j] += slope * r.response.gain[b * n + j]


def solve_branches(e: Engine, r: Laws, q: Floats, h: float, shifted: bool) -> bool:
    """Solve one complementarity problem; False if nothing was found.

    `r.resting` are friction junctions that hold up to their breakaway limits, `r.rebound` what is
    added in the conditions of one-sided laws if `shifted`. The answer is in `r.problem`.
    """
    m = e.model
    if asks_friction(e, r):
        copy_floats(2 * m.slots, r.v, r.later)
        copy_part(2 * m.bonds, r.response.bonds, 0, r.later, m.bond_slot)
    count_work(e, (m.ports + 8) * (m.ports + 8) * (m.ports + 8))
    rests = put_problem(e, r, q, h, shifted)
    found = solve_problem(e, r, rests and not shifted)
    return (r.closely and answer_closely(e, r, h, found)) or found


def answer_closely(e: Engine, r: Laws, h: float, found: bool) -> bool:
    """Decide `r.problem` with twice the digits, if all its laws are one-sided or cut.

    `q` is what is known, ``r.y``, and its rate over the step `h`. What was found is where the
    search begins.
    """
    n = e.model.ports
    p = r.problem
    c = r.closer
    many = 0
    for k in range(n):
        if p.role[k] == ONE_SIDED:
            p.who[many] = k
            many += 1
        elif p.role[k] != CUT:
            return False
    if many > MOST:
        return False
    c.n = many
    for i in range(many):
        one = p.who[i]
        for j in range(many):
            at = one * n + p.who[j]
            put_entry(c, i * many + j, r.response.d[at], h, r.response.ce[at])
        put_known(c, i, r.y[one], h, r.response.rate[one])
        branch = p.branch[one] if found else r.start[one]
        c.active[i] = 1 if (branch == 1) == (p.common[one] != 0) else 0
    count_work(e, 20 * many * many * many)
    if not decide_closely(c):
        return False
    p.doubtful = False
    for i in range(many):
        one = p.who[i]
        p.doubtful = p.doubtful or c.zero[i] != 0
        p.l[one] = c.l[i]
        p.branch[one] = 1 if (c.active[i] != 0) == (p.common[one] != 0) else 0
        p.open[one] = c.zero[i]
    return True


def asks_friction(e: Engine, r: Laws) -> bool:
    """Whether any law that takes part has a limit of friction."""
    for k in range(e.model.ports):
        if r.role[k] == TWO_SIDED or r.role[k] >= FORWARD:
            return True
    return e.planar.ready


def put_problem(e: Engine, r: Laws, q: Floats, h: float, shifted: bool) -> bool:
    """Put what the laws are asked into `r.problem`; return whether any disk is at rest.

    Limits are linearised at the values `r.later`.
    """
    m = e.model
    n = m.ports
    a = r.response
    p = r.problem
    p.n = n
    p.shifted = shifted
    for k in range(n):
        p.role[k] = r.role[k]
        p.common[k] = 1 if r.now.given[k] == COMMON else 0
        if r.role[k] == TWO_SIDED or r.role[k] >= FORWARD:
            linearise_limit(e, r, k, r.resting[k] != 0)
    rests = e.planar.ready and put_disks(e, r)
    for i in range(n * n):
        p.m[i] = a.d[i] + h * a.ce[i]
    for k in range(n):
        j = 0
        while j < n and p.m[k * n + j] == 0.0 and p.m[j * n + k] == 0.0:
            j += 1
        idle = j == n
        p.q[k] = q[k]
        p.noise[k] = NOISE * r.rounding[k] if h > 0.0 else 0.0
        # a law that neither acts on anything nor feels any other: its value is rounding, or right
        if idle and q[k] < 0.0 and q[k] >= -LAW_DUST * a.size[k]:
            p.q[k] = 0.0
        p.shift[k] = r.rebound[k] if shifted else 0.0
    return rests


def solve_problem(e: Engine, r: Laws, rests: bool) -> bool:
    """Solve `r.problem`; with `rests` disks at rest are held, or let go."""
    m = e.model
    n = m.ports
    p = r.problem
    if rests:
        p.proved = False
        p.answers = 1
        return answer_rests(e, p, r.start)
    if asks_friction(e, r):
        return answer_laws(p, r.start)
    # in units in which efforts and flows are of one size: both must show their signs
    find_units(m, r, p.q)
    for k in range(n):
        for j in range(n):
            p.m[k * n + j] = p.m[k * n + j] * r.units[j] * r.units[k]
        p.q[k] *= r.units[k]
        p.shift[k] *= r.units[k]
    if not answer_laws(p, r.start):
        return False
    for k in range(n):
        p.l[k] *= r.units[k]
    return True


def put_disks(e: Engine, r: Laws) -> bool:
    """Put the limits of disks there; return whether any is at rest."""
    m = e.model
    p = e.planar
    n = m.ports
    some_rest = False
    for d in range(m.disks):
        first = m.disk_port[2 * d]
        if p.resting[d] == 0:
            put_on_the_way(m, p, r.problem, d)
            continue
        some_rest = True
        linearise_limit(e, r, first, p.slid[d] == 0)
        p.rest[d] = r.problem.limit[first]
        copy_part(n, r.problem.slope, first * n, p.rest_slope, d * n)
        linearise_limit(e, r, first, False)
        p.limit[d] = r.problem.limit[first]
        copy_part(n, r.problem.slope, first * n, p.limit_slope, d * n)
    return some_rest


def find_units(m: Model, r: Laws, q: Floats) -> None:
    """Find factors of `w` that make its efforts and its flows alike, domain by domain.

    The same factors divide `l`, so that powers stay what they are.
    """
    effort = 0.0
    flow = 0.0
    for k in range(m.ports):
        known = k > 0 and m.port_domain[k] == m.port_domain[k - 1]
        if not known:
            effort = 0.0
            flow = 0.0
        for j in range(0 if known else m.ports):
            if m.port_domain[j] != m.port_domain[k]:
                continue
            if is_effort(m, r, j):
                effort = max(effort, math.fabs(q[j]))
            else:
                flow = max(flow, math.fabs(q[j]))
        r.units[k] = 1.0
        if effort > 0.0 and flow > 0.0:
            own = is_effort(m, r, k)
            r.units[k] = math.sqrt(flow / effort if own else effort / flow)


def is_effort(m: Model, r: Laws, k: int) -> bool:
    """Whether `w` of a port is an effort."""
    return (m.junction_kind[m.port_junction[k]] == 1) == (r.now.given[k] == COMMON)


def keep_answer(m: Model, r: Laws) -> None:
    """Keep what was found while something else is asked."""
    for k in range(m.ports):
        r.answer[k] = r.problem.branch[k]
        r.answer_open[k] = r.problem.open[k]
        r.answer_l[k] = r.problem.l[k]


def slide(e: Engine, r: Laws, q: Floats, h: float, jump: bool) -> bool:
    """Solve, with breakaway where a friction junction is at rest, sliding limits elsewhere.

    `r.loose` are junctions at rest that break loose now. What has to move although its breakaway
    limit holds slides with the limit of sliding, and the others are asked again: to let go is
    never taken back. What slid, and would turn round at once, may hold as well, once. In a jump
    friction that is an impulse holds with all it has.
    """
    m = e.model
    for k in range(m.ports):
        own = not jump or m.port_impulsive[k] == 0
        r.resting[k] = 1 if may_rest(m, k) and (not own or rests_now(m, r, k)) else 0
        r.halted[k] = 0
    while solve_branches(e, r, q, h, jump):
        again = False
        for k in range(m.ports):
            if jump and m.port_impulsive[k] != 0:
                continue
            if r.resting[k] != 0 and r.problem.branch[k] != 0:
                if (not jump and bears_less(e, r, k)) or is_held_by_others(m, r, k):
                    continue
                r.resting[k] = 0
                again = True
            elif turns_round(m, r, k):
                r.halted[k] = 1
                r.resting[k] = 1
                again = True
        if not again:
            warn_of_several(e, r)
            keep_answer(m, r)
            return True
    r.proved = r.proved and r.problem.proved
    return False


def is_held_by_others(m: Model, r: Laws, k: int) -> bool:
    """Whether friction that rests has given all it can, and does not move: others rest with it.

    Of two brakes on one shaft either may be the first to have.
    """
    p = r.problem
    if p.open[k] == 0:
        return False
    for j in range(m.ports):
        rests = m.port_two_sided[j] != 0 and (p.branch[j] == 0 or p.open[j] != 0)
        if j != k and rests and p.m[k * m.ports + j] != 0.0:
            return True
    return False


def loosen(e: Engine, r: Laws, q: Floats, h: float) -> bool:
    """Let friction slide that holds with all it has; False if there is none."""
    m = e.model
    n = m.ports
    a = r.response
    some_edge = False
    for k in range(n):
        r.loose[k] = 0
        r.start[k] = r.answer[k]
    for k in range(n):
        if m.port_two_sided[k] == 0 or r.answer_open[k] == 0 or r.answer[k] != 0:
            continue
        force = -r.answer_l[k]
        if r.now.given[k] != NET:
            total = q[k]
            for j in range(n):
                total += (a.d[k * n + j] + h * a.ce[k * n + j]) * r.answer_l[j]
            force = -total
        if force == 0.0:
            continue
        some_edge = True
        r.loose[k] = 1 if force > 0.0 else -1
        r.start[k] = r.loose[k]
        if r.now.given[k] == NET:
            r.role[k] = FORWARD if force > 0.0 else BACKWARD
    found = some_edge and slide(e, r, q, h, False)
    for k in range(n):
        if found and r.loose[k] != 0:
            r.answer[k] = r.loose[k]
        r.loose[k] = 0
    find_start(m, r)
    return found


def put_mode(m: Model, r: Laws, branch: Ints, keep: bool, impact: bool) -> None:
    """Put the mode with these branches into `r.candidate`; with `keep` what is open stays so."""
    base_mode(m, r.state, r.candidate)
    for k in range(m.ports):
        machine = m.port_machine[k]
        now = r.state[machine]
        if m.port_planar[k] != 0:
            r.candidate[machine] = 1 if impact or branch[k] != 0 else 0
        elif m.port_two_sided[k] != 0:
            # sticking could carry impulses of the net variable, friction does not
            way = branch[k]
            if impact and slides_through(m, r, k):
                way = -1 if now == 2 else 1
            r.candidate[machine] = 2 if way < 0 else way
        else:
            on = branch[k] != 0
            if keep and r.answer_open[k] != 0 and r.shares[k] == 0 and now < 2:
                on = is_on(m, k, now)
            r.candidate[machine] = 1 if on else 0
            strikes = impact and r.now.given[k] == COMMON and is_stored(m, r, k)
            if on and strikes and m.port_restitution[k] != NO_LAW_VALUE:
                r.candidate[machine] = 2
