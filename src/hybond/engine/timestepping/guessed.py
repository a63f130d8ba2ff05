"""The laws of a step with their branches guessed: those of the last step, then what these violate.

A guess makes of each law an equation. If what follows keeps all laws, beyond doubt, it is the
answer, and most steps end here with the factors of the step before. Where the laws are monotone, so
that there is no other answer, branches that are violated are turned, all at once, a few times
(block pivoting). Everything else is left to the methods that decide (`law_problem`).

Source: J. J. Judice, F. M. Pires, *A block principal pivoting algorithm for large-scale strictly
monotone linear complementarity problems*, Computers & Operations Research 21 (1994).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.complementarity.law_roles import CUT, ONE_SIDED, SHUT, TWO_SIDED, LawProblem
from hybond.engine.timestepping.step_records import Guess
from hybond.engine.words import Ints

BEYOND_DOUBT: Final = 1e-6
"""Part of its terms from which a value has its sign beyond doubt."""
TURNS: Final = 20
"""How often branches are turned."""
LEFT: Final = 0
"""``l = 0``."""
HELD: Final = 1
"""``w = 0``, restitution included."""
SLIDES: Final = 2
"""The net variable is at its limit, and it is `l`."""
DRAGS: Final = 3
"""The same, and it is `w`."""


def answer_guessed(g: Guess, p: LawProblem, start: Ints, number: int, monotone: bool) -> bool:
    """Find what the laws do if the branches `start`, or some next to them, fit beyond doubt.

    The answer is in `p`; `number` tells the matrix of the problem from others.
    """
    n = p.n
    sloped = False
    for k in range(n):
        way = start[k]
        is_common = p.common[k] != 0
        g.way[k] = 0
        if p.role[k] == CUT:
            g.code[k] = LEFT
        elif p.role[k] == SHUT:
            g.code[k] = HELD
        elif p.role[k] == ONE_SIDED:
            g.code[k] = HELD if (way == 1) == is_common else LEFT
        elif p.role[k] == TWO_SIDED:
            g.way[k] = way
            put_friction_code(g, k, is_common)
            if p.sloped[k] != 0:
                for j in range(n):
                    sloped = sloped or p.slope[k * n + j] != 0.0
        else:
            return False
    turn = 0
    while turn < TURNS:
        turn += 1
        if not solve_guessed(g, p, number, sloped):
            return False
        wrong = look_at_guess(g, p)
        if wrong == 0:
            put_guessed(g, p)
            return True
        if wrong < 0 or not monotone or sloped:
            return False
        for k in range(n):
            if g.turned[k] == 0:
                continue
            if p.role[k] == ONE_SIDED:
                g.code[k] = LEFT if g.code[k] == HELD else HELD
            else:
                g.way[k] = 0 if g.way[k] != 0 else g.turned[k]
                put_friction_code(g, k, p.common[k] != 0)
    return False


def put_friction_code(g: Guess, k: int, is_common: bool) -> None:
    """Say what friction does that goes that way."""
    if g.way[k] == 0:
        g.code[k] = LEFT if is_common else HELD
    else:
        g.code[k] = DRAGS if is_common else SLIDES


def solve_guessed(g: Guess, p: LawProblem, number: int, sloped: bool) -> bool:
    """Solve for `l` with the branches that are guessed; False if they leave it open."""
    n = p.n
    same = g.number == number and not sloped
    for k in range(n):
        same = same and g.code[k] == g.kept_code[k]
    if not same:
        g.number = -1
        g.many = 0
        for k in range(n):
            g.kept_code[k] = g.code[k]
            if g.code[k] == HELD or g.code[k] == DRAGS or (sloped and g.code[k] == SLIDES):
                g.unknown[g.many] = k
                g.many += 1
        fit(g.factor, g.many * g.many)
        for i in range(g.many):
            put_equation(g, p, i)
        if g.many > 0 and lu_factor(g.many, g.factor.at, g.row) == SINGULAR:
            return False
        if not sloped:
            g.number = number
    for k in range(n):
        slides = g.code[k] == SLIDES and not sloped
        g.l[k] = -float(g.way[k]) * p.limit[k] if slides else 0.0
    for i in range(g.many):
        k = g.unknown[i]
        total = p.moved[k] if p.role[k] == ONE_SIDED else p.q[k]
        if g.code[k] == SLIDES:
            g.right[i] = -float(g.way[k]) * p.limit[k]
            continue
        if g.code[k] == DRAGS:
            total += float(g.way[k]) * p.limit[k]
        for j in range(n):
            if g.l[j] != 0.0:
                total += p.m[k * n + j] * g.l[j]
        g.right[i] = -total
    if g.many > 0:
        lu_solve(g.many, g.factor.at, g.row, 1, g.right)
    for i in range(g.many):
        if not math.isfinite(g.right[i]):
            return False
        g.l[g.unknown[i]] = g.right[i]
    return True


def put_equation(g: Guess, p: LawProblem, i: int) -> None:
    """Put the equation of a port whose `l` is solved for."""
    n = p.n
    k = g.unknown[i]
    way = float(g.way[k])
    for c in range(g.many):
        j = g.unknown[c]
        entry = 0.0 if g.code[k] == SLIDES else p.m[k * n + j]
        if g.code[k] == SLIDES and k == j:
            entry = 1.0
        if g.code[k] == SLIDES or g.code[k] == DRAGS:
            entry += way * p.slope[k * n + j]
        g.factor.at[i * g.many + c] = entry


def look_at_guess(g: Guess, p: LawProblem) -> int:
    """Return how many laws are violated, 0 if all hold beyond doubt, -1 if some are in doubt.

    `turned` says which ones, and of friction at rest which way it would go.
    """
    n = p.n
    wrong = 0
    doubt = False
    for k in range(n):
        g.turned[k] = 0
        if p.role[k] == CUT or p.role[k] == SHUT:
            continue
        w = p.moved[k] if p.role[k] == ONE_SIDED else p.q[k]
        size = math.fabs(w)
        for j in range(n):
            if g.l[j] != 0.0:
                term = p.m[k * n + j] * g.l[j]
                w += term
                size += math.fabs(term)
        own = p.m[k * n + k]
        if p.role[k] == ONE_SIDED:
            x = own * g.l[k] if g.code[k] == HELD else w
            doubt = doubt or math.fabs(x) <= BEYOND_DOUBT * size
            if x < 0.0:
                g.turned[k] = 1
                wrong += 1
            continue
        limit = p.limit[k]
        if p.sloped[k] != 0:
            for j in range(n):
                limit += p.slope[k * n + j] * g.l[j]
        is_common = p.common[k] != 0
        if g.way[k] != 0:
            x = float(g.way[k]) * (own * g.l[k] if is_common else w)
            doubt = doubt or math.fabs(x) <= BEYOND_DOUBT * size or limit < 0.0
            if x < 0.0:
                g.turned[k] = 1
                wrong += 1
            continue
        force = -w if is_common else -g.l[k]
        room = limit - math.fabs(force)
        doubt = doubt or math.fabs(room) <= BEYOND_DOUBT * limit or limit <= 0.0
        if room < 0.0:
            g.turned[k] = 1 if force > 0.0 else -1
            wrong += 1
    if wrong > 0:
        return wrong
    return -1 if doubt else 0


def put_guessed(g: Guess, p: LawProblem) -> None:
    """Let the guess be the answer."""
    for k in range(p.n):
        p.l[k] = g.l[k]
        p.open[k] = 0
        p.branch[k] = g.way[k]
        if p.role[k] == ONE_SIDED:
            p.branch[k] = 1 if (g.code[k] == HELD) == (p.common[k] != 0) else 0
