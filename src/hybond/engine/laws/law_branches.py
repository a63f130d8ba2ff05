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

Sources: Heemels, Schumacher and Weiland, *Linear complementarity systems*, SIAM J. Appl.
Math. 60 (2000); Camlibel et al. on passive ones (2002).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.algebra.svd import null_space
from hybond.engine.answers import node_name
from hybond.engine.complementarity.law_roles import (
    BACKWARD,
    CUT,
    FORWARD,
    ONE_SIDED,
    SHUT,
    TWO_SIDED,
)
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.laws.law_answers import (
    is_effort,
    loosen,
    put_mode,
    slide,
)
from hybond.engine.laws.law_instant import (
    NO_LAW_VALUE,
    clean,
    find_able,
    find_rounding,
    find_start,
    is_stored,
    make_consistent,
    passive_role,
)
from hybond.engine.laws.law_parallel import find_shares, keep_left
from hybond.engine.laws.law_rates import take_later_rates
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.response import respond
from hybond.engine.mode.rows.tableau import COMMON, NET
from hybond.engine.model import Model
from hybond.engine.planar.planar import find_disks
from hybond.engine.words import Floats, float_table, int_table

SHORT_STEP: Final = 1e-6
"""The vanishing step, as a part of the shortest time that feedthrough and storage make."""
RESOLVED: Final = 1e-10
"""The shortest step that is seen at all, as a part of that time: where leaks are all that tells
feedthroughs apart, storage has to, and is lost in their rounding if the step is shorter."""
TRIES: Final = 8
"""Ways of asking for branches that last, the likeliest first; of each:"""
NO_DUST: Final = 3
"""The first ways, which rounding of what is stored has no say in."""
AS_IT_IS: Final = 4
"""The first ways, with the vanishing step as it is: if none of these can have an answer, no other
step is asked, which would only lose what is small."""
TRY_FACTOR: Final = float_table(1.0, 1.0, 1.0, 1.0, 1e-3, 1e-3, 1e3, 1e-6)
"""What the vanishing step is multiplied by."""
TRY_KEEP: Final = int_table(1, 0, -1, 0, 1, 0, 0, 0)
"""Whether what is open is left as it was; -1: friction exactly at its limit breaks loose."""
TRY_CLEAN: Final = int_table(1, 1, 1, 0, 1, 1, 1, 1)
"""Whether rounding of what is stored counts as zero."""
ADRIFT: Final = 1e-6
"""Share of a unit of freedom from which a junction has part in it."""


def short_step(m: Model, r: Laws, y: Floats) -> float:
    """Return a step so short that finite values outweigh rates, and feedthrough storage."""
    a = r.response
    first = math.inf
    for k in range(m.ports):
        if y[k] != 0.0 and math.fabs(a.rate[k]) > 0.0:
            first = min(first, math.fabs(y[k]) / math.fabs(a.rate[k]))
    return min(SHORT_STEP * least_time(m, r, y), 1e-3 * first)


def least_time(m: Model, r: Laws, y: Floats) -> float:
    """Return the shortest time that feedthrough and storage make.

    Where none do any will do that is long beside rounding: a second, or that in which slow sources
    change.
    """
    a = r.response
    n = m.ports
    least = math.inf
    for k in range(n):
        through = math.fabs(a.d[k * n + k])
        stored = math.fabs(a.ce[k * n + k])
        if through > 0.0 and stored > 0.0:
            least = min(least, through / stored)
    if least < math.inf:
        return least
    known = time_of_known(m, r, y)
    return max(known, 1.0) if known < math.inf else 1.0


def time_of_known(m: Model, r: Laws, y: Floats) -> float:
    """Return the shortest time in which efforts or flows that are known change by what they are.

    Domain by domain: sources that change over days are followed over days.
    """
    a = r.response
    n = m.ports
    least = math.inf
    for k in range(n):
        size = 0.0
        other = 0.0
        fastest = 0.0
        for j in range(n):
            if m.port_domain[j] != m.port_domain[k]:
                continue
            if is_effort(m, r, j) == is_effort(m, r, k):
                size = max(size, math.fabs(y[j]))
                fastest = max(fastest, math.fabs(a.rate[j]))
            else:
                other = max(other, math.fabs(y[j]))
        stored = math.fabs(a.ce[k * n + k])
        if size > 0.0 and fastest > 0.0:
            least = min(least, size / fastest)
        if size > 0.0 and other > 0.0 and stored > 0.0:
            least = min(least, size / other / stored)
    return least


def begin_lasting(e: Engine, r: Laws, x: Floats) -> int:
    """Make ready to find branches that may last from the state `x`: next_lasting gives them."""
    m = e.model
    if not has_answered(e, r, x):
        if make_consistent(e, r, x) != OK:
            return REFUSED
        if respond(e, r, r.v, r.x, True) != OK:
            return REFUSED
        if find_able(e, r) != OK:
            return REFUSED
        find_rounding(e, r)
    # its rates are about to be changed
    r.answered = False
    if take_later_rates(e, r) != OK:
        return REFUSED
    find_start(m, r)
    e.planar.ready = False
    if m.disks > 0 and find_disks(e, r) != OK:
        return REFUSED
    r.proved = True
    r.attempt = 0
    r.second = False
    r.solved = False
    for k in range(m.ports):
        r.loose[k] = 0
    return OK


def has_answered(e: Engine, r: Laws, x: Floats) -> bool:
    """Whether `find_jumping` has asked the graph at this state, and a linear one, last."""
    same = r.answered
    for k in range(e.model.storages if same else 0):
        same = same and r.answered_x[k] == x[k]
    return same


def keep_answered(e: Engine, r: Laws, x: Floats) -> None:
    """Keep at which state the graph has answered; one that is not linear says less in a jump."""
    r.answered = r.now.linear and not r.at_once
    copy_floats(e.model.storages, x, r.answered_x)


def lasting_role(m: Model, r: Laws, k: int) -> int:
    """Return how a port takes part in what lasts, `y` being decided by what is stored."""
    if m.port_two_sided[k] != 0:
        if r.now.given[k] == NET and r.y[k] != 0.0 and is_stored(m, r, k):
            return FORWARD if r.y[k] > 0.0 else BACKWARD
        return TWO_SIDED
    # a contact that still approaches is for the next jump, so is a plastic one where none is made:
    # what is a priori is looked at. Where its motion follows from what other laws give, whether it
    # approaches is what is asked, and where its effort is stored none strikes
    strikes = m.port_restitution[k] != NO_LAW_VALUE or r.goes_apart[k] != 0 or not r.jumping
    rebounds = (r.now.given[k] == COMMON or r.goes_apart[k] != 0) and strikes
    comes = rebounds and r.y[k] < 0.0 and is_stored(m, r, k)
    carries_nothing = 1 if r.now.given[k] == COMMON else 2
    r.comes[m.port_machine[k]] = carries_nothing if comes else 0
    if comes:
        return CUT
    return ONE_SIDED if r.able[k] != 0 else passive_role(r.now, k)


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


def next_lasting(e: Engine, r: Laws, ways: int) -> bool:
    """Find the next mode whose branches may last, into `r.candidate`, the likeliest first.

    Of the ways to ask for them the first so many are taken.
    """
    m = e.model
    n = m.ports
    a = r.response
    if r.second:
        r.second = False
        r.shared = False
        for k in range(n):
            r.shares[k] = 0
        put_mode(m, r, r.answer, r.second_keep, False)
        r.candidate_kept = r.second_keep
        return True
    while r.attempt < ways:
        keep = TRY_KEEP[r.attempt]
        if TRY_CLEAN[r.attempt] != 0:
            clean(m, r, r.y)
        else:
            copy_floats(n, a.y, r.y)
        for k in range(n):
            r.role[k] = lasting_role(m, r, k)
        hold_disks(e, r)
        for k in range(n):
            # what is stored keeps these apart, however fast that may change
            r.apart[k] = 1 if r.role[k] == CUT and r.now.given[k] == NET else 0
            if r.role[k] == ONE_SIDED and r.y[k] > 0.0 and is_stored(m, r, k):
                r.apart[k] = 1
                r.role[k] = CUT
        seen = RESOLVED * least_time(m, r, r.y)
        short = short_step(m, r, r.y)
        h = TRY_FACTOR[r.attempt] * short
        if r.attempt >= AS_IT_IS and short < seen:
            h = seen
        for k in range(n):
            r.q[k] = r.y[k] + h * a.rate[k]
        # storage is lost in the rounding of what acts at once, unless the digits of both are kept
        r.closely = TRY_CLEAN[r.attempt] != 0 and r.now.linear and r.now.monotone and h < seen
        r.attempt += 1
        found = slide(e, r, r.q, h, False)
        r.closely = False
        if found and keep < 0:
            found = loosen(e, r, r.q, h)
        if not found:
            if r.attempt == AS_IT_IS and r.proved and not r.solved and short >= seen:
                return False
            continue
        for k in range(n):
            if r.apart[k] != 0 and r.now.given[k] == NET:
                r.answer[k] = 1
        r.solved = True
        shared = find_shares(e, r, r.q, h, False)
        parted = find_adrift(m, r)
        for k in range(n if parted else 0):
            if r.shares[k] == 0 and r.adrift[k] != 0:
                r.branch[k] = 0
        put_mode(m, r, r.branch, keep > 0 and not parted, False)
        keep_left(e, r)
        r.candidate_kept = keep > 0 and not parted and not shared
        r.second = parted or shared
        r.shared = shared
        r.second_keep = keep > 0
        return True
    return False


def find_adrift(m: Model, r: Laws) -> bool:
    """Find the junctions that conduct nothing and whose blocked value nothing determines.

    Around a loop that others have opened, each may block as well as conduct, and the voltage of the
    loop lies on the open ones in shares that no equation fixes.
    """
    n = m.ports
    any_idle = False
    many = 0
    for k in range(n):
        idle = r.answer_open[k] != 0 and r.now.given[k] == NET and r.answer[k] == 1
        # friction that slides is given its force
        idle = idle and m.port_two_sided[k] == 0
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


def no_branches(e: Engine, r: Laws, k: int) -> int:
    """Refuse laws that have no solution: HB-J110; or HB-J112 if none was found, but may be."""
    r.undecided = True
    e.fault.t = r.t
    code = "HB-J112"
    why = "no solution of the laws of junctions was found: give a contact a stiffness"
    if r.proved:
        code = "HB-J110"
        why = (
            "laws of junctions have no solution: give a contact a stiffness, a source a resistance"
        )
    found = say_fault(e, code, why, node_name(e.model, e.model.port_node[k]))
    e.fault.t = r.t
    return found
