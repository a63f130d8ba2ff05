"""Friction in two directions at one instant: whether it holds, and where slip begins.

What slips already has a direction: its force is known up to the limit. What is at rest is held if
the force that this takes lies in the disk of the breakaway limit. Otherwise slip begins, along the
direction that the force on the edge of the disk and the acceleration agree on (friction_disk.py).
For each disk, the slip is what the complementarity problem of all other laws makes of a given
force; several disks take turns until none moves.
"""

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.algebra.svd import rank_above, svd
from hybond.engine.answers import node_name
from hybond.engine.complementarity.friction_disk import on_disk
from hybond.engine.complementarity.law_problem import solve_laws
from hybond.engine.complementarity.law_roles import FORWARD, SHUT, LawProblem
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.laws.law_records import Laws
from hybond.engine.mode.rows.tableau import NET
from hybond.engine.model import Model
from hybond.engine.planar.planar_records import Planar
from hybond.engine.words import Floats, Ints

SLIP_REST: Final = 1e-10
"""Part of its terms below which a slip velocity is zero."""
SLIP_BEGINS: Final = 1e-12
"""Part of these terms up to which slip that begins has the direction of its heading."""
SAME_HEADING: Final = 1e-9
"""Headings that differ by less are one, rad."""
DISK_EDGE: Final = 1e-12
"""A force beyond the limit by this part is beyond doubt."""
DISK_TURNS: Final = 100
"""Rounds of all disks."""
DISK_ROUNDS: Final = 1000
"""The same where each disk is solved for itself."""
DISK_STILL: Final = 1e-12
"""The disks agree if no force moves by more than this part of its limit."""
DISK_ENOUGH: Final = 1e-9
"""The same for disks that approach each other slowly."""
GIVES_WAY: Final = 1e-8
"""Part of the largest response that disks give way by, if one body rests on more than it takes."""
NO_SLIP: Final = 1e-100


def find_disks(e: Engine, r: Laws) -> int:
    """Find each disk as it is at this instant."""
    m = e.model
    p = e.planar
    p.ready = True
    for d in range(m.disks):
        for way in range(2):
            k = m.disk_port[2 * d + way]
            stored = r.now.given[k] == NET
            for j in range(m.ports):
                stored = stored and r.response.d[k * m.ports + j] == 0.0
            if not stored:
                place = node_name(m, m.port_node[k])
                why = "the slip is not determined by what is stored"
                return say_fault(e, "HB-C105", why, place)
        x = r.response.y[m.disk_port[2 * d]]
        y = r.response.y[m.disk_port[2 * d + 1]]
        p.speed[d] = math.hypot(x, y)
        size = math.hypot(r.rounding[m.disk_port[2 * d]], r.rounding[m.disk_port[2 * d + 1]])
        p.size[d] = size
        slow = r.s[m.disk_slow[d]]
        p.resting[d] = 1 if p.speed[d] <= max(SLIP_REST * size, -slow) else 0
        p.way[2 * d] = x / p.speed[d] if p.speed[d] > 0.0 else 1.0
        p.way[2 * d + 1] = y / p.speed[d] if p.speed[d] > 0.0 else 0.0
    return OK


def put_on_the_way(m: Model, p: Planar, q: LawProblem, d: int) -> None:
    """Let the two net variables of a disk that slips be the limit times its direction."""
    n = m.ports
    first = m.disk_port[2 * d]
    limit = q.limit[first]
    copy_part(n, q.slope, first * n, p.limit_slope, d * n)
    for way in range(2):
        k = m.disk_port[2 * d + way]
        q.limit[k] = limit * p.way[2 * d + way]
        q.sloped[k] = 1
        for j in range(n):
            q.slope[k * n + j] = p.limit_slope[d * n + j] * p.way[2 * d + way]


def answer_with(m: Model, p: Planar, q: LawProblem, start: Ints) -> bool:
    """Solve with the disks at rest held, or given the forces in `p`."""
    n = m.ports
    for h in range(p.held):
        d = p.which[h]
        for way in range(2):
            k = m.disk_port[2 * d + way]
            q.role[k] = SHUT if p.free[d] == 0 else FORWARD
            q.limit[k] = p.force[2 * d + way]
            for j in range(n):
                q.slope[k * n + j] = 0.0
    return solve_laws(q, start)


def affine(n: int, constant: float, slope: Floats, row: int, l: Floats) -> float:
    """Return a limit at what the laws give."""
    total = 0.0
    for j in range(n):
        total += slope[row * n + j] * l[j]
    return constant + total


def answer_rests(e: Engine, q: LawProblem, start: Ints) -> bool:
    """Find what all laws do with the disks whose slip is zero.

    First all that rest are held, and those let go that cannot be. Where that comes to no answer the
    disks take turns, each solved for itself between the forces of the others.
    """
    m = e.model
    p = e.planar
    p.held = 0
    for d in range(m.disks):
        if p.resting[d] != 0:
            p.which[p.held] = d
            p.held += 1
    return answer_shared(e, q, start) or answer_in_turn(e, q, start)


def answer_shared(e: Engine, q: LawProblem, start: Ints) -> bool:
    """Find an answer in which disks share what they hold alike, if more than one fits.

    All give way by the same little then.
    """
    m = e.model
    p = e.planar
    n = m.ports
    many = 2 * p.held
    size = 0.0
    for i in range(many):
        a = m.disk_port[2 * p.which[i // 2] + i % 2]
        for j in range(many):
            b = m.disk_port[2 * p.which[j // 2] + j % 2]
            e.laws.block[i * many + j] = q.m[a * n + b]
            size = max(size, math.fabs(q.m[a * n + b]))
    svd(e.laws.svd, many, many, e.laws.block)
    if rank_above(e.laws.svd, many, 1e-2 * GIVES_WAY * size) == many:
        return answer_held(e, q, start)
    copy_floats(n * n, q.m, p.soft)
    for i in range(many):
        a = m.disk_port[2 * p.which[i // 2] + i % 2]
        q.m[a * n + a] += GIVES_WAY * size
    found = answer_held(e, q, start)
    if found:
        keep_disk_answer(p, q)
    copy_floats(n * n, p.soft, q.m)
    if not found:
        return False
    # what does not slip then holds to the last digit, if that is unique
    if not answer_with(m, p, q, start):
        restore_disk_answer(p, q)
    return True


def keep_disk_answer(p: Planar, q: LawProblem) -> None:
    """Keep what was found."""
    for k in range(q.n):
        p.l[k] = q.l[k]
        p.branch[k] = q.branch[k]
        p.open[k] = q.open[k]


def restore_disk_answer(p: Planar, q: LawProblem) -> None:
    """Let what was kept be the answer."""
    for k in range(q.n):
        q.l[k] = p.l[k]
        q.branch[k] = p.branch[k]
        q.open[k] = p.open[k]


def answer_held(e: Engine, q: LawProblem, start: Ints) -> bool:
    """Hold all disks, and let those go that cannot be held."""
    m = e.model
    p = e.planar
    n = m.ports
    for h in range(p.held):
        p.free[p.which[h]] = 0
        p.loose[p.which[h]] = 0
    before = math.inf
    for _ in range(DISK_TURNS):
        if not answer_with(m, p, q, start):
            return False
        keep_disk_answer(p, q)
        moved = 0.0
        for h in range(p.held):
            d = p.which[h]
            if p.free[d] == 0:
                x = -p.l[m.disk_port[2 * d]]
                y = -p.l[m.disk_port[2 * d + 1]]
                loose = p.loose[d] != 0
                constant = p.limit[d] if loose else p.rest[d]
                reach = affine(n, constant, p.limit_slope if loose else p.rest_slope, d, p.l)
                size = math.hypot(x, y)
                if size > 0.0:
                    p.way[2 * d] = x / size
                    p.way[2 * d + 1] = y / size
                if size <= reach * (1.0 + DISK_EDGE):
                    continue
                p.loose[d] = 1
                p.free[d] = 1
                most = max(affine(n, p.limit[d], p.limit_slope, d, p.l), 0.0)
                p.force[2 * d] = most * p.way[2 * d]
                p.force[2 * d + 1] = most * p.way[2 * d + 1]
                moved = math.inf
            else:
                change = turn_disk(e, q, start, d)
                if change < 0.0:
                    return False
                moved = max(moved, change)
        if moved <= DISK_STILL or (moved <= DISK_ENOUGH and moved >= 0.5 * before):
            return answer_with(m, p, q, start)
        before = moved
    return False


def probe_disk(e: Engine, q: LawProblem, start: Ints, d: int) -> bool:
    """Find how the slip and the limit of one disk follow its force, the others held.

    ``f = f0 - a p``, and the limit ``reach + follow . p``.
    """
    m = e.model
    p = e.planar
    n = m.ports
    x = p.force[2 * d]
    y = p.force[2 * d + 1]
    free = p.free[d]
    p.free[d] = 1
    scale = max(max(math.fabs(x), math.fabs(y)), math.fabs(p.limit[d]))
    probe = 1e-3 * scale if scale > 0.0 else 1.0
    base = 0.0
    good = True
    for turn in range(3):
        p.force[2 * d] = x + (probe if turn == 1 else 0.0)
        p.force[2 * d + 1] = y + (probe if turn == 2 else 0.0)
        if not answer_with(m, p, q, start):
            good = False
            break
        for way in range(2):
            k = m.disk_port[2 * d + way]
            total = 0.0
            for j in range(n):
                total += q.m[k * n + j] * q.l[j]
            p.slip[2 * turn + way] = total + q.q[k]
        most = affine(n, p.limit[d], p.limit_slope, d, q.l)
        if turn == 0:
            base = most
        else:
            p.follow[turn - 1] = (most - base) / probe
    p.force[2 * d] = x
    p.force[2 * d + 1] = y
    p.free[d] = free
    if not good:
        return False
    for way in range(2):
        if math.fabs(p.follow[way]) <= DISK_EDGE * math.fabs(base) / probe:
            p.follow[way] = 0.0
        p.a[2 * way] = -(p.slip[2 + way] - p.slip[way]) / probe
        p.a[2 * way + 1] = -(p.slip[4 + way] - p.slip[way]) / probe
    p.f0[0] = p.slip[0] + p.a[0] * x + p.a[1] * y
    p.f0[1] = p.slip[1] + p.a[2] * x + p.a[3] * y
    p.reach = base - (p.follow[0] * x + p.follow[1] * y)
    return True


def find_edge(p: Planar) -> bool:
    """Find the direction of slip on the edge of the disk that was probed."""
    for k in range(2):
        p.disk.f0[k] = p.f0[k]
        p.disk.slope[k] = p.follow[k]
    copy_floats(4, p.a, p.disk.a)
    p.disk.limit = p.reach
    return on_disk(p.disk)


def turn_disk(e: Engine, q: LawProblem, start: Ints, d: int) -> float:
    """Put one disk on its edge, the others held; return how far its force moved, or -1."""
    p = e.planar
    if not probe_disk(e, q, start, d) or not find_edge(p):
        return -1.0
    most = p.reach / (1.0 - (p.follow[0] * p.disk.x + p.follow[1] * p.disk.y))
    x = most * p.disk.x
    y = most * p.disk.y
    size = max(math.hypot(x, y), math.hypot(p.force[2 * d], p.force[2 * d + 1]))
    change = math.hypot(x - p.force[2 * d], y - p.force[2 * d + 1])
    p.force[2 * d] = x
    p.force[2 * d + 1] = y
    p.way[2 * d] = p.disk.x
    p.way[2 * d + 1] = p.disk.y
    return change / size if size > 0.0 else 0.0


def answer_in_turn(e: Engine, q: LawProblem, start: Ints) -> bool:
    """Let the disks take turns, each solved for itself."""
    m = e.model
    p = e.planar
    for h in range(p.held):
        d = p.which[h]
        p.free[d] = 1
        p.force[2 * d] = 0.0
        p.force[2 * d + 1] = 0.0
        p.loose[d] = 0
        p.holds[d] = 0
    before = math.inf
    done = False
    turn = 0
    while turn < DISK_ROUNDS and not done:
        turn += 1
        moved = 0.0
        for h in range(p.held):
            d = p.which[h]
            x = p.force[2 * d]
            y = p.force[2 * d + 1]
            if not solve_alone(e, q, start, d):
                return False
            if p.holds[d] == 0:
                p.loose[d] = 1
            own = math.hypot(p.force[2 * d], p.force[2 * d + 1])
            size = max(own, math.hypot(x, y))
            change = math.hypot(p.force[2 * d] - x, p.force[2 * d + 1] - y)
            moved = max(moved, change / size if size > 0.0 else 0.0)
            if own > 0.0:
                p.way[2 * d] = p.force[2 * d] / own
                p.way[2 * d + 1] = p.force[2 * d + 1] / own
        done = moved <= DISK_STILL or (moved <= DISK_ENOUGH and moved >= 0.5 * before)
        before = moved
    if not done or not answer_with(m, p, q, start):
        return False
    keep_disk_answer(p, q)
    for h in range(p.held):
        p.free[p.which[h]] = 1 - p.holds[p.which[h]]
    if answer_with(m, p, q, start) and disks_fit(m, p, q):
        return True
    restore_disk_answer(p, q)
    for h in range(p.held):
        d = p.which[h]
        if p.holds[d] != 0:
            q.branch[m.disk_port[2 * d]] = 0
            q.branch[m.disk_port[2 * d + 1]] = 0
    return True


def solve_alone(e: Engine, q: LawProblem, start: Ints, d: int) -> bool:
    """Find the force of one disk between those of the others, and whether it holds."""
    m = e.model
    p = e.planar
    if not probe_disk(e, q, start, d):
        return False
    x = p.force[2 * d]
    y = p.force[2 * d + 1]
    p.holds[d] = 1
    p.force[2 * d] = 0.0
    p.force[2 * d + 1] = 0.0
    if p.f0[0] == 0.0 and p.f0[1] == 0.0:
        return True
    r = e.laws
    copy_floats(4, p.a, r.block)
    svd(r.svd, 2, 2, r.block)
    regular = rank_above(r.svd, 2, 2.0 * EPSILON * r.svd.s[0]) == 2
    if regular and lu_factor(2, r.block, r.tried) != SINGULAR:
        p.force[2 * d] = p.f0[0]
        p.force[2 * d + 1] = p.f0[1]
        r.zero[0] = p.f0[0]
        r.zero[1] = p.f0[1]
        lu_solve(2, r.block, r.tried, 1, r.zero)
        x = r.zero[0]
        y = r.zero[1]
        p.force[2 * d] = x
        p.force[2 * d + 1] = y
        most = p.reach + p.follow[0] * x + p.follow[1] * y
        if p.loose[d] == 0:
            # the limit of breaking loose, as it is with this very force
            if not answer_with(m, p, q, start):
                return False
            most = affine(m.ports, p.rest[d], p.rest_slope, d, q.l)
        if math.hypot(x, y) <= most * (1.0 + DISK_EDGE):
            return True
    p.holds[d] = 0
    if not find_edge(p):
        return False
    along = 1.0 - (p.follow[0] * p.disk.x + p.follow[1] * p.disk.y)
    p.force[2 * d] = p.reach / along * p.disk.x
    p.force[2 * d + 1] = p.reach / along * p.disk.y
    return True


def disks_fit(m: Model, p: Planar, q: LawProblem) -> bool:
    """Whether what is held stays within its limit."""
    for h in range(p.held):
        d = p.which[h]
        loose = p.loose[d] != 0
        constant = p.limit[d] if loose else p.rest[d]
        reach = affine(m.ports, constant, p.limit_slope if loose else p.rest_slope, d, q.l)
        size = math.hypot(q.l[m.disk_port[2 * d]], q.l[m.disk_port[2 * d + 1]])
        if p.holds[d] != 0 and size > reach * (1.0 + DISK_ENOUGH):
            return False
    return True


def put_headings(m: Model, p: Planar, s: Floats, state: Ints) -> None:
    """Put the signals there with the heading of what begins to slip in a mode."""
    copy_floats(m.integrals, s, p.signals)
    if not p.ready:
        return
    for d in range(m.disks):
        if state[m.disk_machine[d]] == 0:
            continue
        slow = s[m.disk_slow[d]]
        angle = math.atan2(p.way[2 * d + 1], p.way[2 * d])
        apart = angle - s[m.disk_heading[d]]
        apart -= 2.0 * math.pi * math.floor(apart / (2.0 * math.pi) + 0.5)
        if slow < 0.0 and (math.fabs(apart) <= SAME_HEADING or p.resting[d] == 0):
            continue  # decided at this instant already
        if p.resting[d] == 0 and slow > 0.0 and slow < p.speed[d]:
            continue  # slips on
        p.signals[m.disk_heading[d]] = angle
        begins = 10.0 * p.speed[d] if p.resting[d] != 0 else 0.0
        p.signals[m.disk_slow[d]] = -max(max(SLIP_BEGINS * p.size[d], begins), NO_SLIP)
