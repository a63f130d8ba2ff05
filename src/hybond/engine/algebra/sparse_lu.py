"""Square systems in which each equation has few unknowns: sparse factors.

Equations are taken in the order of how many unknowns they have. Each is freed of the unknowns that
those before it are solved for, and solved for the one of its own that fewest equations have, among
those that are no small part of its largest term (Markowitz's rule with a threshold; Duff, Erisman,
Reid, *Direct Methods for Sparse Matrices*, chapters 5 and 7). What hangs together like a star, a
chain or a tree fills nothing in then, and costs as much as it has terms.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    fit,
    fit_places,
    grow_block,
    grow_places,
    make_block,
    make_places,
)
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.words import Floats, record

SHARE: Final = 0.1
"""Part of an equation's largest term, rounding apart, that what it is solved for has at the least.
"""
NO_TERM: Final = 1e-10
"""An equation is not independent of the others if less than this part of its terms is left."""
NOT_SOLVED: Final = -1


@record
class SparseLu:
    """A system of `unknowns`, equation after equation, and its factors.

    The terms of equation i are those from ``begins[i]`` on. At step k equation ``taken[k]`` is
    solved for unknown ``pivot[k]``, whose factor is ``diagonal[k]``: the parts of steps before that
    are taken off it begin at ``lower_begins[k]``, its other terms at ``upper_begins[k]``.
    """

    unknowns: int
    equations: int
    least: float
    """The part of its terms that has to be left of an independent equation."""
    begins: Places
    term_of: Places
    term: Block
    taken: Places
    pivot: Places
    solved_at: Places
    """The step at which each unknown is solved for."""
    diagonal: Block
    made_of: Block
    """... and the size of the terms that this is the sum of."""
    lower_begins: Places
    lower_step: Places
    lower: Block
    upper_begins: Places
    upper_of: Places
    upper: Block


@record
class Factoring:
    """Room to make such factors, and to solve by them."""

    total: Block
    """Of the equation under way: its terms, and the sizes of what they are summed of, ..."""
    size: Block
    met: Places
    """... the unknowns that it has, `width` of them, ..."""
    width: int
    marked: Places
    heap: Places
    """... and the steps that are still to be taken off it, the first one on top."""
    heaped: int
    uses: Places
    """In how many equations each unknown is."""
    side: Block


def make_sparse_lu() -> SparseLu:
    """Return room for no system."""
    f = SparseLu()
    f.least = NO_TERM
    f.begins = make_places(1)
    f.term_of = make_places(1)
    f.term = make_block(1)
    f.taken = make_places(1)
    f.pivot = make_places(1)
    f.solved_at = make_places(1)
    f.diagonal = make_block(1)
    f.made_of = make_block(1)
    f.lower_begins = make_places(1)
    f.lower_step = make_places(1)
    f.lower = make_block(1)
    f.upper_begins = make_places(1)
    f.upper_of = make_places(1)
    f.upper = make_block(1)
    return f


def make_factoring() -> Factoring:
    """Return room for the factors of no system."""
    r = Factoring()
    r.total = make_block(1)
    r.size = make_block(1)
    r.met = make_places(1)
    r.marked = make_places(1)
    r.heap = make_places(1)
    r.uses = make_places(1)
    r.side = make_block(1)
    return r


def begin_system(f: SparseLu, unknowns: int, terms: int) -> None:
    """Begin a system of so many unknowns, and as many equations, of so many terms together."""
    f.unknowns = unknowns
    f.equations = 0
    fit_places(f.begins, unknowns + 1)
    fit_places(f.term_of, terms)
    fit(f.term, terms)
    f.begins.at[0] = 0
    f.begins.at[1] = 0


def add_term(f: SparseLu, unknown: int, factor: float) -> None:
    """Add a term to the equation that is being made; those of one unknown are summed."""
    at = f.begins.at[f.equations + 1]
    f.term_of.at[at] = unknown
    f.term.at[at] = factor
    f.begins.at[f.equations + 1] = at + 1


def end_equation(f: SparseLu) -> None:
    """End the equation that is being made."""
    f.equations += 1
    if f.equations < f.unknowns:
        f.begins.at[f.equations + 1] = f.begins.at[f.equations]


def factor_sparse(f: SparseLu, r: Factoring) -> bool:
    """Find the factors; False if equations are not independent, or too few."""
    n = f.unknowns
    if f.equations < n:
        return False
    begin_factors(f, r)
    for k in range(n):
        gather(f, r, f.taken.at[k])
        f.lower_begins.at[k + 1] = f.lower_begins.at[k]
        while r.heaped > 0:
            take_off(f, r, k, take_first(r))
        if not settle_pivot(f, r, k):
            return False
    return True


def factor_again(f: SparseLu, r: Factoring) -> bool:
    """Find the factors with other values of the same terms, in the order found before.

    False if it does not fit any more: where a pivot has become a small part of its equation, or
    where there is a term now that was zero then. The factors are lost then.
    """
    n = f.unknowns
    for k in range(n):
        r.marked.at[k] = 0
    for k in range(n):
        put_again(f, r, k)
        if not take_off_again(f, r, k) or not settle_again(f, r, k):
            return False
    return True


def put_again(f: SparseLu, r: Factoring, k: int) -> None:
    """Begin with nothing of what the equation of step k has had terms of, marked by that step."""
    r.width = 0
    for p in range(f.lower_begins.at[k], f.lower_begins.at[k + 1]):
        meet_again(r, f.pivot.at[f.lower_step.at[p]], k)
    meet_again(r, f.pivot.at[k], k)
    for p in range(f.upper_begins.at[k], f.upper_begins.at[k + 1]):
        meet_again(r, f.upper_of.at[p], k)


def meet_again(r: Factoring, unknown: int, k: int) -> None:
    """Begin with nothing of one unknown."""
    r.marked.at[unknown] = k + 1
    r.total.at[unknown] = 0.0
    r.size.at[unknown] = 0.0
    r.met.at[r.width] = unknown
    r.width += 1


def take_off_again(f: SparseLu, r: Factoring, k: int) -> bool:
    """Sum the terms of the equation of step k and take off it the same steps as before."""
    i = f.taken.at[k]
    known = r.width
    for p in range(f.begins.at[i], f.begins.at[i + 1]):
        add_again(r, f.term_of.at[p], f.term.at[p], k)
    for p in range(f.lower_begins.at[k], f.lower_begins.at[k + 1]):
        step = f.lower_step.at[p]
        share = r.total.at[f.pivot.at[step]] / f.diagonal.at[step]
        f.lower.at[p] = share
        for q in range(f.upper_begins.at[step], f.upper_begins.at[step + 1]):
            add_again(r, f.upper_of.at[q], -share * f.upper.at[q], k)
    # what had cancelled cancels
    for c in range(known, r.width):
        unknown = r.met.at[c]
        if math.fabs(r.total.at[unknown]) > CANCELS * r.size.at[unknown]:
            return False
    return True


def add_again(r: Factoring, unknown: int, part: float, k: int) -> None:
    """Add to what the equation of step k has of an unknown."""
    if r.marked.at[unknown] != k + 1:
        meet_again(r, unknown, k)
    r.total.at[unknown] += part
    r.size.at[unknown] += math.fabs(part)


def settle_again(f: SparseLu, r: Factoring, k: int) -> bool:
    """Solve the equation for the same unknown; False if that is a small part of it now."""
    pivot = f.pivot.at[k]
    biggest = math.fabs(r.total.at[pivot])
    whole = 0.0
    for i in range(r.width):
        whole = max(whole, r.size.at[r.met.at[i]])
    for p in range(f.upper_begins.at[k], f.upper_begins.at[k + 1]):
        f.upper.at[p] = r.total.at[f.upper_of.at[p]]
        biggest = max(biggest, math.fabs(f.upper.at[p]))
    f.diagonal.at[k] = r.total.at[pivot]
    f.made_of.at[k] = r.size.at[pivot]
    return math.fabs(f.diagonal.at[k]) >= SHARE * biggest and biggest > f.least * whole


def begin_factors(f: SparseLu, r: Factoring) -> None:
    """Put the equations in order, those with few terms first, and make room."""
    n = f.unknowns
    fit_places(f.taken, n)
    fit_places(f.pivot, n)
    fit_places(f.solved_at, n)
    fit(f.diagonal, n)
    fit(f.made_of, n)
    fit_places(f.lower_begins, n + 1)
    fit_places(f.upper_begins, n + 1)
    fit(r.total, n)
    fit(r.size, n)
    fit_places(r.met, n)
    fit_places(r.marked, n)
    fit_places(r.heap, n + 1)
    fit_places(r.uses, n + 2)
    fit(r.side, n)
    for k in range(n + 2):
        r.uses.at[k] = 0
    # counted by how many terms they have, which is no more than there are unknowns
    for i in range(n):
        r.uses.at[terms_of(f, i) + 1] += 1
    for k in range(n + 1):
        r.uses.at[k + 1] += r.uses.at[k]
    for i in range(n):
        own = terms_of(f, i)
        f.taken.at[r.uses.at[own]] = i
        r.uses.at[own] += 1
    for k in range(n):
        r.uses.at[k] = 0
        r.marked.at[k] = 0
        f.solved_at.at[k] = NOT_SOLVED
    for i in range(f.begins.at[n]):
        r.uses.at[f.term_of.at[i]] += 1
    f.lower_begins.at[0] = 0
    f.upper_begins.at[0] = 0


def terms_of(f: SparseLu, i: int) -> int:
    """Return how many terms an equation has, which counts as no more than there are unknowns."""
    return min(f.begins.at[i + 1] - f.begins.at[i], f.unknowns)


def gather(f: SparseLu, r: Factoring, i: int) -> None:
    """Begin with the terms of equation i."""
    r.width = 0
    r.heaped = 0
    for p in range(f.begins.at[i], f.begins.at[i + 1]):
        put_term(f, r, f.term_of.at[p], f.term.at[p])


def put_term(f: SparseLu, r: Factoring, unknown: int, factor: float) -> None:
    """Add a term to the equation under way."""
    if r.marked.at[unknown] == 0:
        r.marked.at[unknown] = 1
        r.met.at[r.width] = unknown
        r.width += 1
        r.total.at[unknown] = 0.0
        r.size.at[unknown] = 0.0
        if f.solved_at.at[unknown] != NOT_SOLVED:
            heap_up(r, f.solved_at.at[unknown])
    r.total.at[unknown] += factor
    r.size.at[unknown] += math.fabs(factor)


def heap_up(r: Factoring, step: int) -> None:
    """Put a step among those to be taken off."""
    at = r.heaped
    r.heaped += 1
    while at > 0 and r.heap.at[(at - 1) // 2] > step:
        r.heap.at[at] = r.heap.at[(at - 1) // 2]
        at = (at - 1) // 2
    r.heap.at[at] = step


def take_first(r: Factoring) -> int:
    """Return the first step to be taken off, which is one less then."""
    first = r.heap.at[0]
    r.heaped -= 1
    step = r.heap.at[r.heaped]
    at = 0
    below = 1
    while below < r.heaped:
        if below + 1 < r.heaped and r.heap.at[below + 1] < r.heap.at[below]:
            below += 1
        if r.heap.at[below] >= step:
            break
        r.heap.at[at] = r.heap.at[below]
        at = below
        below = 2 * at + 1
    r.heap.at[at] = step
    return first


def take_off(f: SparseLu, r: Factoring, k: int, step: int) -> None:
    """Take a step off the equation of step k."""
    unknown = f.pivot.at[step]
    share = r.total.at[unknown] / f.diagonal.at[step]
    if share == 0.0:
        return
    at = f.lower_begins.at[k + 1]
    grow_places(f.lower_step, at + 1)
    grow_block(f.lower, at + 1)
    f.lower_step.at[at] = step
    f.lower.at[at] = share
    f.lower_begins.at[k + 1] = at + 1
    for p in range(f.upper_begins.at[step], f.upper_begins.at[step + 1]):
        put_term(f, r, f.upper_of.at[p], -share * f.upper.at[p])


def settle_pivot(f: SparseLu, r: Factoring, k: int) -> bool:
    """Solve the equation under way for an unknown and keep it; False if nothing is left of it."""
    biggest = 0.0
    whole = 0.0
    for i in range(r.width):
        unknown = r.met.at[i]
        whole = max(whole, r.size.at[unknown])
        if f.solved_at.at[unknown] == NOT_SOLVED:
            biggest = max(biggest, math.fabs(r.total.at[unknown]))
    pivot = NOT_SOLVED
    at = f.upper_begins.at[k]
    grow_places(f.upper_of, at + r.width)
    grow_block(f.upper, at + r.width)
    for i in range(r.width):
        unknown = r.met.at[i]
        r.marked.at[unknown] = 0
        if f.solved_at.at[unknown] != NOT_SOLVED or r.total.at[unknown] == 0.0:
            continue
        f.upper_of.at[at] = unknown
        f.upper.at[at] = r.total.at[unknown]
        at += 1
        if math.fabs(r.total.at[unknown]) >= SHARE * biggest:
            if pivot == NOT_SOLVED or r.uses.at[unknown] < r.uses.at[pivot]:
                pivot = unknown
    if pivot == NOT_SOLVED or not biggest > f.least * whole:
        return False
    f.pivot.at[k] = pivot
    f.solved_at.at[pivot] = k
    f.diagonal.at[k] = r.total.at[pivot]
    f.made_of.at[k] = r.size.at[pivot]
    kept = f.upper_begins.at[k]
    for i in range(kept, at):
        if f.upper_of.at[i] != pivot:
            f.upper_of.at[kept] = f.upper_of.at[i]
            f.upper.at[kept] = f.upper.at[i]
            kept += 1
    f.upper_begins.at[k + 1] = kept
    return True


def solve_sparse(f: SparseLu, r: Factoring, b: Floats, x: Floats) -> None:
    """Solve for `x`, the right-hand sides of the equations being `b`."""
    n = f.unknowns
    for k in range(n):
        total = b[f.taken.at[k]]
        for p in range(f.lower_begins.at[k], f.lower_begins.at[k + 1]):
            total -= f.lower.at[p] * r.side.at[f.lower_step.at[p]]
        r.side.at[k] = total
    for back in range(n):
        k = n - 1 - back
        total = r.side.at[k]
        for p in range(f.upper_begins.at[k], f.upper_begins.at[k + 1]):
            total -= f.upper.at[p] * x[f.upper_of.at[p]]
        x[f.pivot.at[k]] = total / f.diagonal.at[k]


def solve_transposed(f: SparseLu, r: Factoring, b: Floats, x: Floats) -> None:
    """Solve the transposed system: `b` has a number for each unknown, `x` for each equation.

    `b` is lost.
    """
    n = f.unknowns
    for k in range(n):
        share = b[f.pivot.at[k]] / f.diagonal.at[k]
        r.side.at[k] = share
        if share == 0.0:
            continue
        for p in range(f.upper_begins.at[k], f.upper_begins.at[k + 1]):
            b[f.upper_of.at[p]] -= f.upper.at[p] * share
    for back in range(n):
        k = n - 1 - back
        x[f.taken.at[k]] = r.side.at[k]
        if r.side.at[k] == 0.0:
            continue
        for p in range(f.lower_begins.at[k], f.lower_begins.at[k + 1]):
            r.side.at[f.lower_step.at[p]] -= f.lower.at[p] * r.side.at[k]
