"""Which branches the laws of junctions take: decided together, impulses first.

At an instant, in the mode that the machines are in, the graph seen from its junction laws is
(ports.py)::

    w = y + D l;    y moves by C E nu under impulses nu, and at the rate y' + C E l

1. *Impulses.* Where some law is violated by what is stored (``y < 0``), the branches that carry
   impulses are those of ``0 <= nu``, ``y + C E nu >= 0``, one of them zero. Newton's restitution
   adds ``eps pre(y)``: its contacts take the branch ``impact``.
2. *Finite values, then rates.* From the state after the jump, the branches that last are those of
   an implicit step of vanishing length ``h``: ``0 <= l``, ``(y + h y') + (D + h C E) l >= 0``. The
   finite values decide; where both of a pair are zero, the rates do.

As modes.laws.complementarity. Sources: Heemels, Schumacher and Weiland, *Linear complementarity
systems*, SIAM J. Appl. Math. 60 (2000); Camlibel et al. on passive ones (2002).
"""

import math
from typing import Final

from hybond.export.portable.engine import OK, REFUSED, Engine, say_fault
from hybond.export.portable.jump import enter_mode
from hybond.export.portable.law_problem import (
    BACKWARD,
    CUT,
    FORWARD,
    ONE_SIDED,
    SHUT,
    TWO_SIDED,
    solve_laws,
)
from hybond.export.portable.law_records import Laws, Ports, Response
from hybond.export.portable.model import Model, node_name, value
from hybond.export.portable.paired import evaluate_pair
from hybond.export.portable.pairs import clear, sign_at
from hybond.export.portable.planar import answer_rests, find_disks, put_on_the_way
from hybond.export.portable.ports import base_mode, open_mode, partner_sizes, ports_of, respond
from hybond.export.portable.storage import energy_of
from hybond.export.portable.svd import least_squares, null_space
from hybond.export.portable.tableau import COMMON, NET
from hybond.export.portable.trial import seen_of
from hybond.export.portable.values import set_values
from hybond.export.portable.words import Floats, Ints, float_table, int_table

LAW_ZERO: Final = 1e-12
"""Part of its terms below which a value counts as zero; guards are located a tenth before that, so
that what passes through zero at an event is decided by its rate."""
LOCATED: Final = 0.02
"""Part of that zero from which on guards may be located."""
LAW_DUST: Final = 1e-9
"""Part of its terms up to which a violation without a solution is rounding."""
SHORT_STEP: Final = 1e-6
"""The vanishing step, as a part of the shortest time that feedthrough and storage make."""
TRIES: Final = 8
TRY_FACTOR: Final = float_table(1.0, 1.0, 1.0, 1.0, 1e-3, 1e-3, 1e3, 1e-6)
TRY_KEEP: Final = int_table(1, 0, 0, -1, 1, 0, 0, 0)
"""Whether what is open is left as it was; -1: friction exactly at its limit breaks loose."""
TRY_CLEAN: Final = int_table(1, 1, 0, 1, 1, 1, 1, 1)
"""Whether rounding of what is stored counts as zero."""
ADRIFT: Final = 1e-6
"""Share of a unit of freedom from which a junction has part in it."""
CLOSED: Final = 1e-10
"""Part of the largest gap so far below which a gap is closed."""
NO_LAW_VALUE: Final = -2
"""What stands for an option that a law does not have; -1 is a constant."""


def quantity(m: Model, law: Ints, constant: Floats, k: int, v: Floats) -> float:
    """Return the value of an option of law k."""
    return constant[k] if law[k] < 0 else value(m, law[k], v)


def take_instant(e: Engine, r: Laws, t: float, s: Floats, state: Ints) -> None:
    """Take the instant that is looked at, and the mode that it begins with."""
    m = e.model
    r.t = t
    for k in range(m.integrals):
        r.s[k] = s[k]
    for k in range(m.machines):
        r.state[k] = state[k]


def make_consistent(e: Engine, r: Laws, x: Floats) -> int:
    """Take the ports into `r.now`, the values into `r.v`, the state into `r.x`.

    The state is put on what the machines' mode alone asks for. As Complementarity.consistent.
    """
    m = e.model
    if ports_of(e, r, r.state) != OK:
        return REFUSED
    mode = open_mode(e, r.now)
    set_values(e, mode, r.v, r.t, x, r.s)
    for k in range(m.slots):
        r.v[m.slots + k] = e.pre[k]
    for k in range(2 * m.bonds):
        r.v[m.bond_slot + k] = 0.0
    energy = e.energy
    e.energy = max(e.energy, math.fabs(energy_of(e, x)))
    found = enter_mode(e, mode, r.v, x, r.x)
    e.energy = energy
    for k in range(m.storages):
        r.v[m.stored_slot + k] = r.x[k]
    return found


def find_able(e: Engine, r: Laws) -> int:
    """Find which laws may take their ON branch at all: contacts closed, thyristors fired.

    As Complementarity.able.
    """
    m = e.model
    stack = e.work.stack
    # rounding of a gap is that of its terms, as for the guards that watch it
    for k in range(m.slots):
        r.terms[k] = math.fabs(r.v[k])
    stack.now = r.v
    stack.was = r.v
    stack.was_first = 0
    stack.jumps = False
    stack.terms = r.terms
    for k in range(m.ports):
        on = is_on(m, k, r.state[m.port_machine[k]])
        r.able[k] = 1
        if m.port_gap[k] != NO_LAW_VALUE:
            gap = m.port_gap_constant[k]
            sign = 1 if gap > 0.0 else -1 if gap < 0.0 else 0
            if m.port_gap_pair[k] >= 0:
                clear(stack)
                evaluate_pair(m, m.port_gap_pair[k], stack)
                gap = stack.finite[stack.top]
                sign = sign_at(stack, stack.top)
                if stack.refused != 0:
                    place = node_name(m, m.port_node[k])
                    return say_fault(e, "HB-J101", "a gap is not a number", place)
            r.largest[k] = max(r.largest[k], math.fabs(gap))
            r.able[k] = 1 if on or sign <= 0 or gap <= CLOSED * r.largest[k] else 0
        if m.port_gate[k] != NO_LAW_VALUE:
            gate = quantity(m, m.port_gate, m.port_gate_constant, k, r.v) != 0.0
            r.able[k] = 1 if on or gate else 0
    return OK


def is_on(m: Model, k: int, state: int) -> bool:
    """Whether a state of the machine of port k switches anything ON."""
    at = m.state_first[m.port_machine[k]] + state
    return m.on_first[at + 1] > m.on_first[at]


def find_rounding(e: Engine, r: Laws) -> None:
    """Find what rounding of each `y` is measured by. As Complementarity._size."""
    m = e.model
    mode = open_mode(e, r.now)
    energy = max(e.energy, math.fabs(energy_of(e, r.x)))
    seen_of(e, mode, r.x)
    for b in range(2 * m.bonds):
        r.zero[b] = math.sqrt(energy) * mode.seen[b]
    partner_sizes(m, r.now, r.zero, r.rounding)
    for k in range(m.ports):
        r.rounding[k] = r.response.size[k] + 10.0 * r.rounding[k]


def clean(m: Model, r: Laws, y: Floats) -> None:
    """Put `y` of the response there, rounding counted as zero. As Complementarity.clean."""
    for k in range(m.ports):
        own = r.response.y[k]
        y[k] = 0.0 if math.fabs(own) <= LAW_ZERO * r.rounding[k] else own


def find_start(m: Model, r: Laws) -> None:
    """Find the branches of the mode: 0 OFF or at rest, 1 ON or forward, -1 backward."""
    for k in range(m.ports):
        state = r.state[m.port_machine[k]]
        r.start[k] = 1 if is_on(m, k, state) else 0
        if m.port_two_sided[k] != 0 and m.port_planar[k] == 0 and state == 2:
            r.start[k] = -1


def short_step(m: Model, a: Response, y: Floats) -> float:
    """Return a step so short that finite values outweigh rates, and feedthrough storage.

    As Complementarity.step.
    """
    n = m.ports
    least = 1.0
    first = math.inf
    for k in range(n):
        through = math.fabs(a.d[k * n + k])
        stored = math.fabs(a.ce[k * n + k])
        if through > 0.0 and stored > 0.0:
            least = min(least, through / stored)
        if y[k] != 0.0 and math.fabs(a.rate[k]) > 0.0:
            first = min(first, math.fabs(y[k]) / math.fabs(a.rate[k]))
    return min(SHORT_STEP * least, 1e-3 * first)


def passive_role(p: Ports, k: int) -> int:
    """Return how a port takes part that is OFF."""
    return CUT if p.given[k] == COMMON else SHUT


def linearise_limit(e: Engine, r: Laws, k: int, at_rest: bool) -> None:
    """Find the limit of friction as an affine function of what the laws give.

    `r.later` are the values, bond variables being those of the response. As
    modes.laws.friction.Linearised.
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
    for j in range(n):
        p.slope[k * n + j] = 0.0
    for i in range(m.limit_first[row], m.limit_first[row + 1]):
        law = m.limit_slope[i]
        slope = m.limit_slope_constant[i] if law < 0 else value(m, law, r.later)
        b = m.limit_column[i]
        for j in range(n):
            p.slope[k * n + j] += slope * r.response.gain[b * n + j]


def solve_branches(e: Engine, r: Laws, q: Floats, h: float, shifted: bool) -> bool:
    """Solve one complementarity problem; False if nothing was found.

    `r.resting` are friction junctions that hold up to their breakaway limits, `r.rebound` what is
    added in the conditions of one-sided laws if `shifted`. The answer is in `r.problem`. As
    Complementarity._solve.
    """
    m = e.model
    n = m.ports
    a = r.response
    p = r.problem
    p.n = n
    p.shifted = shifted
    rubs = False
    for k in range(n):
        p.role[k] = r.role[k]
        p.common[k] = 1 if r.now.given[k] == COMMON else 0
        if r.role[k] == TWO_SIDED or r.role[k] >= FORWARD:
            rubs = True
    rubs = rubs or e.planar.ready
    if rubs:
        for i in range(2 * m.slots):
            r.later[i] = r.v[i]
        for b in range(2 * m.bonds):
            r.later[m.bond_slot + b] = a.bonds[b]
        for k in range(n):
            if r.role[k] == TWO_SIDED or r.role[k] >= FORWARD:
                linearise_limit(e, r, k, r.resting[k] != 0)
    rests = e.planar.ready and put_disks(e, r)
    for i in range(n * n):
        p.m[i] = a.d[i] + h * a.ce[i]
    for k in range(n):
        idle = True
        for j in range(n):
            idle = idle and p.m[k * n + j] == 0.0 and p.m[j * n + k] == 0.0
        p.q[k] = q[k]
        # a law that neither acts on anything nor feels any other: its value is rounding, or right
        if idle and q[k] < 0.0 and q[k] >= -LAW_DUST * a.size[k]:
            p.q[k] = 0.0
        p.shift[k] = r.rebound[k] if shifted else 0.0
    if rests and not shifted:
        return answer_rests(e, p, r.start)
    if rubs:
        return solve_laws(p, r.start)
    # in units in which efforts and flows are of one size: both must show their signs
    find_units(m, r, p.q)
    for k in range(n):
        for j in range(n):
            p.m[k * n + j] = p.m[k * n + j] * r.units[j] * r.units[k]
        p.q[k] *= r.units[k]
        p.shift[k] *= r.units[k]
    if not solve_laws(p, r.start):
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
        linearise_limit(e, r, first, True)
        p.rest[d] = r.problem.limit[first]
        for j in range(n):
            p.rest_slope[d * n + j] = r.problem.slope[first * n + j]
        linearise_limit(e, r, first, False)
        p.limit[d] = r.problem.limit[first]
        for j in range(n):
            p.limit_slope[d * n + j] = r.problem.slope[first * n + j]
    return some_rest


def find_units(m: Model, r: Laws, q: Floats) -> None:
    """Find factors of `w` that make its efforts and its flows alike, domain by domain.

    The same factors divide `l`, so that powers stay what they are. As Complementarity._units.
    """
    for k in range(m.ports):
        effort = 0.0
        flow = 0.0
        for j in range(m.ports):
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


def slide(e: Engine, r: Laws, q: Floats, h: float) -> bool:
    """Solve, with breakaway where a friction junction is at rest, sliding limits elsewhere.

    `r.loose` are junctions at rest that break loose now. What has to move although its breakaway
    limit holds slides with the limit of sliding, and the others are asked again: to let go is
    never taken back. As Complementarity._slide.
    """
    m = e.model
    for k in range(m.ports):
        r.resting[k] = 0
        if m.port_breakaway[k] != NO_LAW_VALUE and m.port_planar[k] == 0 and r.loose[k] == 0:
            r.resting[k] = 0 if r.now.given[k] == NET and math.fabs(r.y[k]) > 0.0 else 1
    while solve_branches(e, r, q, h, False):
        broken = False
        for k in range(m.ports):
            if r.resting[k] != 0 and r.problem.branch[k] != 0:
                r.resting[k] = 0
                broken = True
        if not broken:
            keep_answer(m, r)
            return True
    return False


def loosen(e: Engine, r: Laws, q: Floats, h: float) -> bool:
    """Let friction slide that holds with all it has; False if there is none.

    As Complementarity._loosened.
    """
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
    found = some_edge and slide(e, r, q, h)
    for k in range(n):
        if found and r.loose[k] != 0:
            r.answer[k] = r.loose[k]
        r.loose[k] = 0
    find_start(m, r)
    return found


def begin_lasting(e: Engine, r: Laws, x: Floats) -> int:
    """Make ready to find branches that may last from the state `x`: next_lasting gives them."""
    m = e.model
    if make_consistent(e, r, x) != OK:
        return REFUSED
    if respond(e, r, r.v, r.x, True) != OK:
        return REFUSED
    if find_able(e, r) != OK:
        return REFUSED
    find_rounding(e, r)
    find_start(m, r)
    e.planar.ready = False
    if m.disks > 0 and find_disks(e, r) != OK:
        return REFUSED
    r.attempt = 0
    r.second = False
    r.solved = False
    for k in range(m.ports):
        r.loose[k] = 0
    return OK


def lasting_role(m: Model, r: Laws, k: int) -> int:
    """Return how a port takes part in what lasts, `y` being decided by what is stored."""
    n = m.ports
    state_like = math.fabs(r.response.d[k * n + k]) == 0.0
    if m.port_two_sided[k] != 0:
        if state_like and r.now.given[k] == NET and r.y[k] != 0.0:
            return FORWARD if r.y[k] > 0.0 else BACKWARD
        return TWO_SIDED
    # a contact that still approaches is for the next jump
    comes = m.port_restitution[k] != NO_LAW_VALUE and state_like and r.y[k] < 0.0
    return ONE_SIDED if r.able[k] != 0 and not comes else passive_role(r.now, k)


def hold_disks(e: Engine, r: Laws) -> None:
    """Let disks take part whose slip is zero, in both directions or in none, or that slip."""
    m = e.model
    if not e.planar.ready:
        return
    for d in range(m.disks):
        for way in range(2):
            k = m.disk_port[2 * d + way]
            rests = e.planar.resting[d] != 0
            r.y[k] = 0.0 if rests else r.response.y[k]
            r.role[k] = SHUT if rests else FORWARD


def is_stored(m: Model, r: Laws, k: int) -> bool:
    """Whether `w` of a port follows from what is stored, and no `l`."""
    n = m.ports
    stored = True
    for j in range(n):
        stored = stored and r.response.d[k * n + j] == 0.0
    return stored


def next_lasting(e: Engine, r: Laws) -> bool:
    """Find the next mode whose branches may last, into `r.candidate`, the likeliest first.

    As Complementarity.lasting.
    """
    m = e.model
    n = m.ports
    a = r.response
    if r.second:
        r.second = False
        put_mode(m, r, r.answer, r.second_keep, False)
        r.candidate_kept = r.second_keep
        return True
    while r.attempt < TRIES:
        keep = TRY_KEEP[r.attempt]
        if TRY_CLEAN[r.attempt] != 0:
            clean(m, r, r.y)
        else:
            for k in range(n):
                r.y[k] = a.y[k]
        for k in range(n):
            r.role[k] = lasting_role(m, r, k)
        hold_disks(e, r)
        for k in range(n):
            # what is stored keeps these apart, however fast that may change
            r.apart[k] = 0
            if r.role[k] == ONE_SIDED and r.y[k] > 0.0 and is_stored(m, r, k):
                r.apart[k] = 1
                r.role[k] = CUT
        h = TRY_FACTOR[r.attempt] * short_step(m, a, r.y)
        for k in range(n):
            r.q[k] = r.y[k] + h * a.rate[k]
        r.attempt += 1
        found = slide(e, r, r.q, h)
        if found and keep < 0:
            found = loosen(e, r, r.q, h)
        if not found:
            continue
        for k in range(n):
            if r.apart[k] != 0 and r.now.given[k] == NET:
                r.answer[k] = 1
        r.solved = True
        if find_adrift(m, r):
            for k in range(n):
                r.branch[k] = 0 if r.adrift[k] != 0 else r.answer[k]
            put_mode(m, r, r.branch, False, False)
            r.candidate_kept = False
            r.second = True
            r.second_keep = keep > 0
        else:
            put_mode(m, r, r.answer, keep > 0, False)
            r.candidate_kept = keep > 0
        return True
    return False


def find_adrift(m: Model, r: Laws) -> bool:
    """Find the junctions that conduct nothing and whose blocked value nothing determines.

    Around a loop that others have opened, each may block as well as conduct, and the voltage of the
    loop lies on the open ones in shares that no equation fixes. As complementarity._adrift.
    """
    n = m.ports
    any_idle = False
    many = 0
    for k in range(n):
        idle = r.answer_open[k] != 0 and r.now.given[k] == NET and r.answer[k] == 1
        blocked = r.now.given[k] == NET and r.answer[k] == 0
        r.adrift[k] = 1 if idle else 0
        any_idle = any_idle or idle
        if idle or blocked:
            r.tried[many] = k
            many += 1
    if not any_idle:
        return False
    for i in range(many):
        for j in range(many):
            at = r.tried[i] * n + r.tried[j]
            r.block[i * many + j] = r.response.d[at]
            r.block[(many + i) * many + j] = r.response.ce[at]
    free = null_space(r.svd, 2 * many, many, r.block, 1e-10, r.basis)
    any_idle = False
    for i in range(many):
        shown = False
        for j in range(free):
            shown = shown or math.fabs(r.basis[i * free + j]) > ADRIFT
        if not shown:
            r.adrift[r.tried[i]] = 0
        any_idle = any_idle or r.adrift[r.tried[i]] != 0
    return any_idle


def put_mode(m: Model, r: Laws, branch: Ints, keep: bool, impact: bool) -> None:
    """Put the mode with these branches into `r.candidate`; what is open stays as it was if `keep`.

    As Complementarity._mode.
    """
    base_mode(m, r.state, r.candidate)
    for k in range(m.ports):
        machine = m.port_machine[k]
        now = r.state[machine]
        if m.port_planar[k] != 0:
            r.candidate[machine] = 1 if impact or branch[k] != 0 else 0
        elif m.port_two_sided[k] != 0:
            # sticking would carry impulses, friction does not: it slides through a jump
            way = branch[k]
            if impact and m.port_impulsive[k] == 0:
                way = -1 if now == 2 else 1
            r.candidate[machine] = 2 if way < 0 else way
        else:
            on = branch[k] != 0
            if keep and r.answer_open[k] != 0 and now < 2:
                on = is_on(m, k, now)
            r.candidate[machine] = 1 if on else 0
            if on and impact and m.port_restitution[k] != NO_LAW_VALUE:
                r.candidate[machine] = 2


def no_branches(e: Engine, r: Laws, k: int) -> int:
    """Refuse laws that have no solution."""
    e.fault.t = r.t
    why = "laws of junctions have no solution: give a contact a stiffness, a source a resistance"
    found = say_fault(e, "HB-J110", why, node_name(e.model, e.model.port_node[k]))
    e.fault.t = r.t
    return found


def find_jumping(e: Engine, r: Laws, x: Floats) -> int:
    """Find the mode whose branches carry impulses from the state `x`, into `r.candidate`.

    Returns 1 if there is one, 0 if no law is violated by what is stored, -1 for a refusal. As
    Complementarity.jumping.
    """
    m = e.model
    n = m.ports
    a = r.response
    if make_consistent(e, r, x) != OK:
        return -1
    if respond(e, r, r.v, r.x, False) != OK:
        return -1
    e.planar.ready = False
    find_rounding(e, r)
    clean(m, r, r.y)
    if find_able(e, r) != OK:
        return -1
    wrong = False
    who = 0
    dust = True
    for k in range(n):
        one_sided = m.port_two_sided[k] == 0
        r.rebound[k] = 0.0
        if m.port_restitution[k] != NO_LAW_VALUE:
            own = quantity(m, m.port_restitution, m.port_restitution_constant, k, r.v)
            r.rebound[k] = own
        # what rebounds enters one after another; what does not stays together, as in one problem
        taking = one_sided and r.able[k] != 0 and (r.rebound[k] == 0.0 or r.y[k] < 0.0)
        # OFF where the common variable follows from what is stored alone: it must be zero
        shut = one_sided and r.able[k] == 0 and is_stored(m, r, k) and r.now.given[k] == NET
        if (taking and r.y[k] < 0.0) or (shut and r.y[k] != 0.0):
            wrong = True
            who = k
            dust = dust and math.fabs(r.y[k]) <= LAW_DUST * r.rounding[k]
        taking = taking or m.port_impulsive[k] != 0
        r.role[k] = passive_role(r.now, k)
        if taking:
            r.role[k] = ONE_SIDED if one_sided else TWO_SIDED
        # friction that is no impulse lets its junction slide through a jump
        if not one_sided and m.port_impulsive[k] == 0:
            r.role[k] = SHUT if r.now.given[k] == COMMON else CUT
        r.resting[k] = 1
        r.rebound[k] *= r.y[k]
    if not wrong:
        return 0
    find_start(m, r)
    h = short_step(m, a, r.y)
    for turn in range(4):
        factor = 1.0 if turn == 0 else 1e-3 if turn == 1 else 1e3 if turn == 2 else 1e-6
        if solve_branches(e, r, r.y, factor * h, True):
            keep_answer(m, r)
            put_mode(m, r, r.answer, False, True)
            return 1
    if dust:
        return 0  # rounding has no solution; what lasts is decided without it
    no_branches(e, r, who)
    return -1


def sweep_dust(e: Engine, r: Laws, x: Floats, after: Floats) -> int:
    """Put the state without approaches that are nothing but rounding into `after`.

    For the laws they are zero, for the guards that watch them they may not be. They are taken away
    as an impact would, along the impulses of their contacts. As Complementarity.dusted.
    """
    m = e.model
    n = m.ports
    a = r.response
    if make_consistent(e, r, x) != OK or respond(e, r, r.v, r.x, False) != OK:
        return REFUSED
    find_rounding(e, r)
    if find_able(e, r) != OK:
        return REFUSED
    many = 0
    for k in range(n):
        slow = a.y[k] < -LOCATED * LAW_ZERO * r.rounding[k] and a.y[k] >= -LAW_ZERO * r.rounding[k]
        if slow and m.port_two_sided[k] == 0 and is_stored(m, r, k) and r.able[k] != 0:
            r.tried[many] = k
            many += 1
    for s in range(m.storages):
        after[s] = r.x[s]
    if many == 0:
        return OK
    for i in range(many):
        r.q[i] = -a.y[r.tried[i]]
        for j in range(many):
            r.block[i * many + j] = a.ce[r.tried[i] * n + r.tried[j]]
    least_squares(r.svd, many, many, r.block, -1.0, 1, r.q, r.l)
    for s in range(m.storages):
        for i in range(many):
            after[s] += a.e[s * n + r.tried[i]] * r.l[i]
    return OK
