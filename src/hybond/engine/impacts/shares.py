"""Shares of impulses among contacts that depend on each other: a table of four legs.

Where the response to impulses is singular, some impulses move nothing. The velocities after an
impact do not depend on these, the impulses of single contacts do. Those of least
``sum w_kk z_k**2`` are unique, do not depend on the order of contacts, and are equal for equal
contacts.
"""

import math
from typing import Final

from hybond.engine.algebra.svd import null_space
from hybond.engine.complementarity.lcp import SOLVED
from hybond.engine.complementarity.lemke import lemke
from hybond.engine.impacts.impact_records import Impact
from hybond.engine.words import Floats

DEPENDENT: Final = 1e-10
"""A singular value of the scaled response below this part of the largest one is zero."""


def still_impulses(i: Impact, many: int) -> int:
    """Find impulses of so many `i.chosen` contacts that move nothing; return how many there are.

    They are the columns of `i.kernel`, in units of `i.scale`: divided by it, velocities are roots
    of energies, and so are impulses times it.
    """
    for a in range(many):
        own = i.w[i.chosen[a] * i.n + i.chosen[a]]
        i.scale[a] = math.sqrt(own) if own > 0.0 else 1.0
    for a in range(many):
        for b in range(many):
            across = i.w[i.chosen[a] * i.n + i.chosen[b]]
            i.inner[a * many + b] = across / (i.scale[a] * i.scale[b])
    return null_space(i.svd, many, many, i.inner, DEPENDENT, i.kernel)


def share_least(i: Impact, z: Floats) -> bool:
    """Let impulses `z` of contacts that stay move the same with the least sizes, none negative.

    The norm of ``s z + N t >= 0`` is least, N being the impulses that move nothing: its optimality
    conditions are a complementarity problem of matrix N N'. Returns whether there was a choice.
    """
    many = 0
    for k in range(i.n):
        if i.stays[k] != 0:
            i.chosen[many] = k
            many += 1
    free = still_impulses(i, many)
    if free == 0:
        return False
    for a in range(many):
        for b in range(many):
            total = 0.0
            for c in range(free):
                total += i.kernel[a * free + c] * i.kernel[b * free + c]
            i.inner[a * many + b] = total
    for a in range(many):
        i.q[a] = i.scale[a] * z[i.chosen[a]]
        for b in range(many):
            i.q[a] -= i.inner[a * many + b] * (i.scale[b] * z[i.chosen[b]])
    if lemke(i.lcp, many, i.inner, i.q, i.nothing) == SOLVED:
        for a in range(many):
            least = 0.0 if i.lcp.active[a] != 0 else i.lcp.w[a]
            z[i.chosen[a]] = least / i.scale[a]
    return True
