"""Laws of junctions that have more than one solution, as rigid friction may (Painleve).

Only where somebody will read it: `tells` of the model. A few other starts are tried, always the
same ones: to find nothing proves nothing.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.complementarity.law_problem import solve_laws
from hybond.engine.complementarity.law_roles import CUT, FORWARD, ONE_SIDED, TWO_SIDED
from hybond.engine.complementarity.lcp import SOLVED
from hybond.engine.complementarity.lemke import lemke
from hybond.engine.complementarity.semidefinite import is_indefinite
from hybond.engine.engine import Engine
from hybond.engine.laws.law_records import Doubts, Laws
from hybond.engine.reasons.warned import SECOND_ANSWER, add_about, begin_warning
from hybond.engine.words import Floats

IDLE_DUST: Final = 1e-9
"""Part of its terms up to which a violation that nothing feels is rounding."""
OTHER_W: Final = 1e-8
"""Smallest scaled difference of ``w`` that counts between two solutions."""
OTHER_ANSWER: Final = 1e-6
"""The same, as a part of the largest terms of all."""
SINGLE: Final = 8
"""Most pairs whose choice alone is turned for another start."""


def warn_of_second(e: Engine, r: Laws, q: Floats, h: float, shifted: bool) -> None:
    """Warn where another answer fits as well as that in ``r.problem``, of the same question."""
    m = e.model
    n = m.ports
    d = r.doubts
    p = d.problem
    if e.planar.ready:
        for disk in range(m.disks):
            if e.planar.resting[disk] != 0:
                return
    same = True
    coupled = False
    p.n = n
    p.shifted = shifted
    for k in range(n):
        same = same and r.problem.branch[k] == r.start[k]
        rubs = r.role[k] == TWO_SIDED or r.role[k] >= FORWARD
        p.role[k] = r.problem.role[k]
        p.common[k] = r.problem.common[k]
        p.shift[k] = r.rebound[k] if shifted else 0.0
        p.limit[k] = r.problem.limit[k]
        for j in range(n):
            at = k * n + j
            coupled = coupled or (rubs and r.problem.slope[at] != 0.0)
            p.slope[at] = r.problem.slope[at]
            p.m[at] = r.response.d[at] + h * r.response.ce[at]
    if same or not (coupled or is_indefinite(n, p.m, d.scale, d.down, d.square)):
        return
    put_question(e, r, q)
    d.largest = 0.0
    for k in range(n):
        d.apart[k] = 0
        d.w[k] = p.q[k]
        size = math.fabs(p.q[k])
        for j in range(n):
            d.w[k] += p.m[k * n + j] * r.problem.l[j]
            size += math.fabs(p.m[k * n + j]) * math.fabs(r.problem.l[j])
        d.largest = max(d.largest, size)
    look_elsewhere(e, r, q)
    some_apart = False
    for k in range(n):
        some_apart = some_apart or d.apart[k] != 0
    if not some_apart:
        return
    begin_warning(e.warned, SECOND_ANSWER, r.t)
    for k in range(n):
        if d.apart[k] != 0:
            add_about(e.warned, float(k))


def put_question(e: Engine, r: Laws, q: Floats) -> None:
    """Put the constants of the problem there, as when it was first solved."""
    n = e.model.ports
    p = r.doubts.problem
    for k in range(n):
        idle = True
        for j in range(n):
            idle = idle and p.m[k * n + j] == 0.0 and p.m[j * n + k] == 0.0
        dust = idle and q[k] < 0.0 and q[k] >= -IDLE_DUST * r.response.size[k]
        p.q[k] = 0.0 if dust else q[k]


def look_elsewhere(e: Engine, r: Laws, q: Floats) -> None:
    """Look for other answers, and note in ``apart`` the ports whose ``w`` differs there."""
    n = e.model.ports
    d = r.doubts
    p = d.problem
    one_sided = True
    for k in range(n):
        one_sided = one_sided and (p.role[k] == ONE_SIDED or p.role[k] == CUT)
    if one_sided:
        if find_second(d, n):
            compare(d, n, p.l)
        return
    for way in range(1, -2, -1):
        # all on, all backward, all off
        for k in range(n):
            d.start[k] = 1 if way == 1 else -1 if way == 0 else 0
        put_question(e, r, q)
        if solve_laws(p, d.start):
            put_question(e, r, q)
            compare(d, n, p.l)


def compare(d: Doubts, n: int, l: Floats) -> None:
    """Note the ports whose ``w`` is another with `l` than in the answer taken."""
    p = d.problem
    for k in range(n):
        w = p.q[k]
        for j in range(n):
            w += p.m[k * n + j] * l[j]
        if math.fabs(w - d.w[k]) > OTHER_ANSWER * d.largest:
            d.apart[k] = 1


def find_second(d: Doubts, n: int) -> bool:
    """Find a solution of one-sided laws with another ``w`` than the first, into ``l``."""
    p = d.problem
    many = 0
    for k in range(n):
        p.l[k] = 0.0
        if p.role[k] == ONE_SIDED:
            p.who[many] = k
            many += 1
    for i in range(many):
        one = p.who[i]
        p.own_q[i] = p.q[one] + p.shift[one] if p.shifted else p.q[one]
        for j in range(many):
            p.own[i * many + j] = p.m[one * n + p.who[j]]
    if (
        many == 0
        or not is_indefinite(many, p.own, d.scale, d.down, d.square)
        or not keep_first(d, many)
    ):
        return False
    for cover in range(3):
        cover_rows(d, many, cover)
        for turn in range(3 + min(many, SINGLE)):
            put_start(d, many, turn)
            if lemke(p.lcp, many, p.sub, p.sub_q, d.start) == SOLVED and is_other(d, many):
                for i in range(many):
                    p.l[p.who[i]] = p.lcp.z[i]
                return True
    return False


def keep_first(d: Doubts, n: int) -> bool:
    """Keep the solution that is found from nothing, and what its ``w`` is compared with."""
    p = d.problem
    for i in range(n):
        d.start[i] = 0
    if lemke(p.lcp, n, p.own, p.own_q, d.start) != SOLVED:
        return False
    pushed = False
    for i in range(n):
        pushed = pushed or p.own_q[i] != 0.0
    for i in range(n):
        d.known[i] = p.lcp.active[i]
        d.first_w[i] = p.lcp.w[i]
        size = 0.0
        for j in range(n):
            size += math.fabs(p.own[i * n + j]) * p.lcp.z[j]
        least = p.lcp.size / p.lcp.d[i] if pushed else 0.0
        d.of_w[i] = max(least, size)
    return True


def cover_rows(d: Doubts, n: int, cover: int) -> None:
    """Weigh the rows, so that Lemke's path covers them in other proportions: even, up, down.

    Scaling takes the root of such weights back.
    """
    p = d.problem
    for i in range(n):
        at = float(i if cover == 1 else n - 1 - i)
        part = 0.1 + 0.9 * at / float(n - 1) if n > 1 else 0.1
        d.weight[i] = 1.0 if cover == 0 else 1.0 / (part * part)
        p.sub_q[i] = d.weight[i] * p.own_q[i]
        for j in range(n):
            p.sub[i * n + j] = d.weight[i] * p.own[i * n + j]


def put_start(d: Doubts, n: int, turn: int) -> None:
    """Put another start there: the opposite of what is known, all, none, one pair turned."""
    for i in range(n):
        other = 1 - d.known[i]
        alone = other if turn - 3 == i else d.known[i]
        d.start[i] = other if turn == 0 else 1 if turn == 1 else 0 if turn == 2 else alone


def is_other(d: Doubts, n: int) -> bool:
    """Whether the solution just found has another ``w``."""
    for i in range(n):
        w = d.problem.lcp.w[i] / d.weight[i]
        if math.fabs(w - d.first_w[i]) > OTHER_W * d.of_w[i]:
            return True
    return False
