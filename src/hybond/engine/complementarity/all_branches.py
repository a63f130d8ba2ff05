"""What a few laws that feel each other can do, by trying all their branches: none, one, several.

Pivoting finds an answer where laws are monotone. Elsewhere (friction whose limit follows a contact
force, active elements) it may end without one although there is one, and says nothing of a second.
So the laws are taken apart into parts that do not feel each other, and all branches of a small part
are tried, those of the mode before first.

Of several answers of a part the one is taken in which every law stays in the branch that it was in;
else that in which the fewest one-sided laws carry anything; else that in which the fewest branches
change; else the first by the names of the laws.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.scaling import balance
from hybond.engine.complementarity.branch_records import (
    ANSWERS_KEPT,
    NOT_OF_PART,
    PART_PORTS,
    Branching,
)
from hybond.engine.complementarity.law_problem import solve_laws
from hybond.engine.complementarity.law_roles import (
    BACKWARD,
    CUT,
    FORWARD,
    ONE_SIDED,
    TWO_SIDED,
    LawProblem,
)
from hybond.engine.complementarity.one_choice import KEPT_UP_TO, keeps_choice
from hybond.engine.complementarity.semidefinite import is_indefinite
from hybond.engine.words import Ints

FEW_LAWS: Final = 8
"""Laws of a part up to which it is asked whether an answer is the only one."""
MOST_CHOICES: Final = 8000
"""Choices up to which it is asked whether there is any."""
ANOTHER: Final = 1e-6
"""Part of its terms from which the `w` of two answers differ."""

TAKEN_BEFORE: Final = 0
TAKEN_IDLE: Final = 1
TAKEN_NEAR: Final = 2
TAKEN_NAME: Final = 3


def answer_laws(p: LawProblem, start: Ints) -> bool:
    """Find what the laws of all ports do together; False if there is nothing, or none was found.

    Then ``p.proved`` says that there is nothing. `start` are the branches before. ``p.answers`` is
    1, or how many answers a part has that may have several, and ``p.answer_way`` their branches.
    """
    b = p.branching
    p.lcp.proved = False
    p.mixed.lcp.proved = False
    p.answers = 1
    found = solve_laws(p, start)
    # what no law moves is known, though nothing was found for the others
    for k in range(p.n if not found else 0):
        if is_known(p, k):
            p.l[k] = 0.0
            p.branch[k] = 1 if p.common[k] == 0 else 0
            p.open[k] = 0
    # of many laws only a path that ends on a ray may prove it
    p.proved = p.lcp.proved or p.mixed.lcp.proved
    parts = split_parts(p)
    open_end = False
    part = 0
    while part < parts:
        laws = count_laws(p, part)
        small = laws >= 0 and count_choices(p, part) <= MOST_CHOICES
        if small and (not found or laws <= FEW_LAWS):
            take_part(p, part, start)
            if not found or in_doubt(b):
                try_all(b)
                if b.answers > 0:
                    give_answer(p, found)
                elif not found:
                    p.proved = p.proved or not b.doubt
                    return False
        elif laws != 0:
            open_end = True
        part += 1
    p.proved = p.proved and not found and open_end
    return found or not open_end


def split_parts(p: LawProblem) -> int:
    """Put the part of each port that takes part into ``of``, -1 for others; return how many."""
    n = p.n
    b = p.branching
    parts = 0
    for k in range(n):
        b.of[k] = -1
    for first in range(n):
        if b.of[first] >= 0 or not is_asked(p, first):
            continue
        b.of[first] = parts
        b.waiting[0] = first
        count = 1
        while count > 0:
            count -= 1
            k = b.waiting[count]
            for j in range(n):
                if b.of[j] < 0 and is_asked(p, j) and feel(p, k, j):
                    b.of[j] = parts
                    b.waiting[count] = j
                    count += 1
        parts += 1
    return parts


def is_asked(p: LawProblem, k: int) -> bool:
    """Whether a port has anything to say in what its part does."""
    return p.role[k] != CUT and not is_known(p, k)


def is_known(p: LawProblem, k: int) -> bool:
    """Whether a law has a `w` that no law moves and that is above zero: its `l` is zero.

    In a part it would only be in the way: what moves others by next to nothing, as rounding of
    slopes does, has an `l` of units beside which theirs are nothing.
    """
    n = p.n
    if p.role[k] != ONE_SIDED or not p.moved[k] > p.noise[k]:
        return False
    for j in range(n):
        if p.m[k * n + j] != 0.0:
            return False
    return True


def feel(p: LawProblem, k: int, j: int) -> bool:
    """Whether one of two ports feels the other."""
    n = p.n
    if p.m[k * n + j] != 0.0 or p.m[j * n + k] != 0.0:
        return True
    return (rubs(p, k) and p.slope[k * n + j] != 0.0) or (rubs(p, j) and p.slope[j * n + k] != 0.0)


def rubs(p: LawProblem, k: int) -> bool:
    """Whether a port has a limit of friction."""
    return p.role[k] == TWO_SIDED or p.role[k] >= FORWARD


def count_laws(p: LawProblem, part: int) -> int:
    """Return how many laws of a part have a choice; -1 if it has too many ports."""
    ports = 0
    laws = 0
    for k in range(p.n):
        if p.branching.of[k] == part:
            ports += 1
            laws += 1 if p.role[k] == ONE_SIDED or p.role[k] == TWO_SIDED else 0
    return -1 if ports > PART_PORTS else laws


def count_choices(p: LawProblem, part: int) -> int:
    """Return how many choices of branches a part has, or one more than are tried."""
    choices = 1
    for k in range(p.n):
        if p.branching.of[k] == part and choices <= MOST_CHOICES:
            choices *= 2 if p.role[k] == ONE_SIDED else 3 if p.role[k] == TWO_SIDED else 1
    return choices


def take_part(p: LawProblem, part: int, start: Ints) -> None:
    """Take a part of a problem into ``p.branching``, in units in which its terms are near one."""
    b = p.branching
    n = 0
    friction = False
    for k in range(p.n):
        friction = friction or rubs(p, k)
        if b.of[k] == part:
            b.port[n] = k
            n += 1
    b.n = n
    for i in range(n):
        for j in range(n):
            b.m[i * n + j] = p.m[b.port[i] * p.n + b.port[j]]
    balance(n, b.m, b.unit, b.room)
    b.size = 0.0
    for i in range(n):
        k = b.port[i]
        b.role[i] = p.role[k]
        b.common[i] = p.common[k]
        b.start[i] = start[k]
        b.rank[i] = p.rank[k]
        moved = p.moved[k] if p.role[k] == ONE_SIDED or not friction else p.q[k]
        b.q[i] = b.unit[i] * moved
        b.noise[i] = b.unit[i] * p.noise[k]
        if b.role[i] < FORWARD:
            # what is given its force moves as it does
            b.size = max(b.size, math.fabs(b.q[i]))
        b.limit[i] = 0.0
        of_l = b.common[i] == 0 or p.role[k] >= FORWARD
        per = 1.0 / b.unit[i] if of_l else b.unit[i]
        if rubs(p, k):
            b.limit[i] = p.limit[k] * per
        for j in range(n):
            b.m[i * n + j] *= b.unit[i] * b.unit[j]
            slope = p.slope[k * p.n + b.port[j]] if rubs(p, k) else 0.0
            b.slope[i * n + j] = slope * per * b.unit[j]
    if b.size == 0.0:
        for i in range(n):
            b.size = max(b.size, math.fabs(b.limit[i]))
    if b.size == 0.0:
        b.size = 1.0
    for i in range(n):
        b.q[i] /= b.size
        b.noise[i] /= b.size
        b.limit[i] /= b.size


def in_doubt(b: Branching) -> bool:
    """Whether more than one answer is possible: laws that are not monotone together."""
    n = b.n
    choice = False
    for i in range(n):
        choice = choice or b.role[i] == ONE_SIDED or b.role[i] == TWO_SIDED
    if not choice:
        return False
    for i in range(n * n):
        if b.slope[i] != 0.0:
            return True
    return is_indefinite(n, b.m, b.right, b.terms, b.square)


def try_all(b: Branching) -> None:
    """Try all choices of a part, that of the mode before first, and keep the answers."""
    n = b.n
    b.answers = 0
    b.more = False
    b.doubt = False
    for i in range(n):
        b.turn[i] = 0
    more = True
    while more:
        turned = 0
        for i in range(n):
            b.way[i] = way_of(b, i)
            turned += 1 if b.turn[i] != 0 else 0
        if keeps_choice(b):
            keep_choice(b, turned)
        i = 0
        while i < n and b.turn[i] + 1 == ways_of(b, i):
            b.turn[i] = 0
            i += 1
        more = i < n
        if more:
            b.turn[i] += 1


def ways_of(b: Branching, i: int) -> int:
    """Return how many ways a law has."""
    return 2 if b.role[i] == ONE_SIDED else 3 if b.role[i] == TWO_SIDED else 1


def way_of(b: Branching, i: int) -> int:
    """Return the way whose turn it is, that of the mode before being the first."""
    if b.role[i] == ONE_SIDED:
        return b.start[i] ^ b.turn[i]
    if b.role[i] == TWO_SIDED:
        # 0, 1, -1 in a ring
        return (b.start[i] + b.turn[i] + 1) % 3 - 1
    return 1 if b.role[i] == FORWARD else -1 if b.role[i] == BACKWARD else 0


def keep_choice(b: Branching, turned: int) -> None:
    """Keep the answer just found, or let it stand for one with the same `w` that turns more.

    Where there are more than are kept, the best of all is among them.
    """
    n = b.n
    at = b.answers
    for k in range(b.answers - 1, -1, -1):
        if same_w(b, k):
            at = k
    if at < b.answers and turned >= b.kept_turned[at]:
        return
    b.kept_turned[at] = turned
    for i in range(n):
        b.kept_l[at * n + i] = b.l[i]
        b.kept_w[at * n + i] = b.w[i]
        b.kept_way[at * n + i] = b.way[i]
    if at < b.answers:
        return
    if b.answers < ANSWERS_KEPT:
        b.answers += 1
        return
    b.more = True
    last = ANSWERS_KEPT - 1
    if best_kept(b, ANSWERS_KEPT + 1) == ANSWERS_KEPT:
        b.kept_turned[last] = turned
        for i in range(n):
            b.kept_l[last * n + i] = b.l[i]
            b.kept_w[last * n + i] = b.w[i]
            b.kept_way[last * n + i] = b.way[i]


def best_kept(b: Branching, many: int) -> int:
    """Return the answer to take of the first `many` that are kept."""
    best = 0
    for k in range(1, many):
        if reason_before(b, k, best) >= 0:
            best = k
    return best


def same_w(b: Branching, at: int) -> bool:
    """Whether the answer just found has the `w` of one that was kept."""
    n = b.n
    for i in range(n):
        size = max(math.fabs(b.q[i]), 1.0)
        for j in range(n):
            size = max(size, math.fabs(b.m[i * n + j] * b.l[j]))
        if math.fabs(b.w[i] - b.kept_w[at * n + i]) > ANOTHER * size:
            return False
    return True


def carried(b: Branching, at: int) -> int:
    """Return how many one-sided laws carry anything in an answer."""
    many = 0
    for i in range(b.n):
        many += 1 if b.role[i] == ONE_SIDED and b.kept_way[at * b.n + i] != 0 else 0
    return many


def reason_before(b: Branching, one: int, other: int) -> int:
    """Return why the first of two answers is to be taken rather than the second, or -1."""
    n = b.n
    if (b.kept_turned[one] == 0) != (b.kept_turned[other] == 0):
        return TAKEN_BEFORE if b.kept_turned[one] == 0 else -1
    if carried(b, one) != carried(b, other):
        return TAKEN_IDLE if carried(b, one) < carried(b, other) else -1
    if b.kept_turned[one] != b.kept_turned[other]:
        return TAKEN_NEAR if b.kept_turned[one] < b.kept_turned[other] else -1
    first = -1
    for i in range(n):
        differs = b.kept_way[one * n + i] != b.kept_way[other * n + i]
        if differs and (first < 0 or b.rank[i] < b.rank[first]):
            first = i
    if first < 0:
        return TAKEN_NAME if one < other else -1
    # at rest, OFF, or forward first
    mine = (b.kept_way[one * n + first] + 3) % 3
    theirs = (b.kept_way[other * n + first] + 3) % 3
    return TAKEN_NAME if mine < theirs else -1


def give_answer(p: LawProblem, found: bool) -> None:
    """Put the answer to take of a part into `p`; where it is the one found, leave that."""
    b = p.branching
    n = b.n
    best = best_kept(b, b.answers)
    if b.answers > 1 and p.answers == 1:
        tell_answers(p, best)
    if found:
        for i in range(n):
            b.l[i] = p.l[b.port[i]] / (b.unit[i] * b.size)
        for i in range(n):
            b.w[i] = b.q[i]
            for j in range(n):
                b.w[i] += b.m[i * n + j] * b.l[j]
        # shares apart it may be the same one, and as near to the branches before
        turned = 0
        for i in range(n):
            choice = b.role[i] == ONE_SIDED or b.role[i] == TWO_SIDED
            turned += 1 if choice and p.branch[b.port[i]] != b.start[i] else 0
        if turned <= b.kept_turned[best] and same_w(b, best):
            return
    for i in range(n):
        k = b.port[i]
        p.l[k] = b.kept_l[best * n + i] * b.unit[i] * b.size
        p.branch[k] = b.kept_way[best * n + i]
        p.open[k] = 1 if is_idle(b, best, i) else 0


def is_idle(b: Branching, at: int, i: int) -> bool:
    """Whether a law is where two of its ways meet: both variables zero, or at rest at its limit."""
    n = b.n
    l = b.kept_l[at * n + i]
    w = b.kept_w[at * n + i]
    if b.role[i] == ONE_SIDED:
        return math.fabs(l) <= KEPT_UP_TO and math.fabs(w) <= KEPT_UP_TO
    if b.role[i] != TWO_SIDED:
        return False
    speed = l if b.common[i] != 0 else w
    force = -w if b.common[i] != 0 else -l
    limit = b.limit[i]
    for j in range(n):
        limit += b.slope[i * n + j] * b.kept_l[at * n + j]
    return math.fabs(speed) <= KEPT_UP_TO and math.fabs(force) >= limit - KEPT_UP_TO


def tell_answers(p: LawProblem, best: int) -> None:
    """Note the branches of the answers of a part, the one that is taken first, and why it is."""
    b = p.branching
    n = b.n
    p.answers = b.answers
    p.more_answers = b.more
    p.answer_why = TAKEN_BEFORE
    at = 1
    for k in range(b.answers):
        for j in range(p.n):
            p.answer_way[(0 if k == best else at) * p.n + j] = NOT_OF_PART
        for i in range(n):
            row = 0 if k == best else at
            p.answer_way[row * p.n + b.port[i]] = b.kept_way[k * n + i]
        if k != best:
            p.answer_why = max(p.answer_why, reason_before(b, best, k))
            at += 1
