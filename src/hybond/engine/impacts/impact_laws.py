"""Laws of impacts that see all closed contacts at once.

With the response `w` of the separating velocities to impulses, ``v+ = v + w z``, no impulse being
negative. All agree for one contact, ``v+ = -eps v``; for several they differ, legitimately.

NEWTON_SIMULTANEOUS
    ``0 <= z``, ``v+ + eps v >= 0``, one of them zero. It can create energy where restitutions of
    contacts differ that act on each other: a property of the law, so that the impact is refused.
POISSON
    All compress, ``0 <= c``, ``v + w c >= 0``, one of them zero; then impulses are returned:
    ``0 <= z - (1 + eps) c``, ``v+ >= 0``, one of them zero. It creates none: what is added to c has
    the least energy among impulses of at least ``eps c``, and ``max(eps) c`` is one of these.
LZB
    Compression and expansion of stiff springs (compliant.py).

Where contacts depend on each other, the velocities after are unique, impulses are not (shares.py).
If restitution differs among these, the first two have no meaning and refuse.

Sources: C. Glocker, F. Pfeiffer, *Multiple impacts with friction in rigid multibody systems*,
Nonlinear Dynamics 7, 1995; M. Anitescu, F. A. Potra, Nonlinear Dynamics 14, 1997; J. J. Moreau,
*Unilateral contact and dry friction in finite freedom dynamics*, CISM 302, 1988.
"""

import math
from typing import Final

from hybond.engine.complementarity.lcp import SOLVED
from hybond.engine.complementarity.lemke import lemke
from hybond.engine.impacts.compliant import compress
from hybond.engine.impacts.impact_records import (
    CANNOT_STOP,
    CREATES_ENERGY,
    DEPENDS,
    EXCHANGED,
    LZB,
    NEVER_ENDS,
    POISSON,
    Impact,
)
from hybond.engine.impacts.shares import share_least, still_impulses
from hybond.engine.words import Floats

APPROACH: Final = 1e-12
"""A velocity below this part of the largest one at the impact neither approaches nor separates."""
CREATED: Final = 1e-11
"""Energy that appears is more than rounding beyond this part of the terms that it is a sum of."""
SPRING_RTOL: Final = 1e-12
MOST_PHASES: Final = 2000
MOST_PHASES_EACH: Final = 200
"""The most phases of springs: so many, and so many more for each contact."""
DIFFERS: Final = 1e-9
"""A velocity that dependent contacts contradict each other by, beyond rounding."""


def exchange_impulses(i: Impact, law: int) -> int:
    """Find what the contacts exchange by a law; EXCHANGED, or why it has no answer."""
    most = 0.0
    least = 0.0
    for k in range(i.n):
        most = max(most, math.fabs(i.v[k]))
        least = min(least, i.v[k])
        i.impulses[k] = 0.0
        i.blamed[k] = 0
        i.after[k] = i.v[k]
    i.still = APPROACH * most
    i.energy = 0.0
    i.error = 0.0
    i.shared = False
    if not least < -i.still:
        return EXCHANGED
    if law == POISSON:
        found = poisson(i)
    elif law == LZB:
        found = by_springs(i)
    else:
        found = newton_simultaneous(i)
    return found if found != EXCHANGED else check_energy(i)


def newton_simultaneous(i: Impact) -> int:
    """Let all closed contacts rebound."""
    came = 0
    mean = 0.0
    for k in range(i.n):
        i.z[k] = (1.0 + i.eps[k]) * i.v[k]
        if i.v[k] < -i.still:
            i.chosen[came] = k
            mean += i.eps[k]
            came += 1
    # impulses that move nothing see no relative velocity: neither may they see what is asked for
    free = still_impulses(i, came)
    fastest = 0.0
    for a in range(came):
        fastest = max(fastest, math.fabs(i.v[i.chosen[a]]) / i.scale[a])
    for c in range(free):
        asked = 0.0
        for a in range(came):
            k = i.chosen[a]
            speed = i.v[k] / i.scale[a] / fastest
            asked += i.kernel[a * free + c] * (i.eps[k] - mean / float(came)) * speed
        if is_contradiction(i, asked):
            return blame_dependent(i, came, free, c)
    found = find_stopping(i, i.z, i.impulses)
    if found != EXCHANGED:
        return found
    move_contacts(i)
    for k in range(i.n):
        if i.stays[k] != 0:
            i.after[k] = -i.eps[k] * i.v[k]
    return EXCHANGED


def poisson(i: Impact) -> int:
    """Compress all closed contacts, then give back a part of each impulse, at least."""
    n = i.n
    found = find_stopping(i, i.v, i.impulses)
    if found != EXCHANGED:
        return found
    shared = i.shared
    many = 0
    for k in range(n):
        if i.stays[k] != 0:
            i.chosen[many] = k
            many += 1
    # compressions that move nothing, being returned in unequal parts, may move something
    free = still_impulses(i, many)
    for c in range(free):
        asked = 0.0
        for a in range(many):
            moved = 0.0
            for b in range(many):
                returned = i.eps[i.chosen[b]] * i.kernel[b * free + c]
                moved += i.inner[a * many + b] * returned
            asked = max(asked, math.fabs(moved))
        if is_contradiction(i, asked):
            return blame_dependent(i, many, free, c)
    for k in range(n):
        # where compression ended, the velocity is zero but for rounding
        slowed = 0.0
        returned = 0.0
        for j in range(n):
            slowed += i.w[k * n + j] * i.impulses[j]
            returned += i.w[k * n + j] * (i.eps[j] * i.impulses[j])
        i.z[k] = returned if i.stays[k] != 0 else i.v[k] + slowed + returned
    for k in range(n):
        i.after[k] = (1.0 + i.eps[k]) * i.impulses[k]
    found = find_stopping(i, i.z, i.impulses)
    if found != EXCHANGED:
        return found
    for k in range(n):
        i.impulses[k] += i.after[k]
    i.shared = shared
    move_contacts(i)
    for k in range(n):
        if i.stays[k] != 0:
            i.after[k] = 0.0
    return EXCHANGED


def by_springs(i: Impact) -> int:
    """Compress and expand springs; the energy is not let grow by the error of integration."""
    n = i.n
    # springs cannot stop what no impulse can stop
    found = find_stopping(i, i.v, i.impulses)
    if found != EXCHANGED:
        return found
    i.shared = False
    if not compress(i, SPRING_RTOL, MOST_PHASES + MOST_PHASES_EACH * n):
        return NEVER_ENDS
    gained = 0.0
    curvature = 0.0
    passive = True
    for k in range(n):
        passive = passive and i.eps[k] <= 1.0
        gained += i.impulses[k] * i.v[k]
        for j in range(n):
            curvature += i.impulses[k] * i.w[k * n + j] * i.impulses[j]
    if passive and gained + 0.5 * curvature > 0.0:
        for k in range(n):
            i.impulses[k] *= -2.0 * gained / curvature  # along their ray, to where it is zero
    move_contacts(i)
    for k in range(n):
        if math.fabs(i.after[k]) <= i.error:
            i.after[k] = 0.0
    return EXCHANGED


def find_stopping(i: Impact, q: Floats, z: Floats) -> int:
    """Solve ``0 <= z``, ``w z + q >= 0``, one of them zero; `i.stays` says where the second is."""
    if lemke(i.lcp, i.n, i.w, q, i.nothing) != SOLVED:
        for k in range(i.n):
            i.blamed[k] = 1 if q[k] < -i.still else 0
        return CANNOT_STOP
    for k in range(i.n):
        z[k] = i.lcp.z[k]
        i.stays[k] = 1 if i.lcp.active[k] != 0 or math.fabs(i.lcp.w[k]) <= i.still else 0
    i.shared = share_least(i, z)
    return EXCHANGED


def move_contacts(i: Impact) -> None:
    """Put the velocities there that follow from the impulses."""
    for k in range(i.n):
        i.after[k] = i.v[k]
        for j in range(i.n):
            i.after[k] += i.w[k * i.n + j] * i.impulses[j]


def is_contradiction(i: Impact, asked: float) -> bool:
    """Whether what is asked of impulses that move nothing is more than rounding."""
    most = 1.0
    for k in range(i.n):
        most = max(most, i.eps[k])
    return math.fabs(asked) > DIFFERS * most


def blame_dependent(i: Impact, many: int, free: int, column: int) -> int:
    """Blame the contacts that have part in impulses which move nothing."""
    for a in range(many):
        part = math.fabs(i.kernel[a * free + column])
        i.blamed[i.chosen[a]] = 1 if part > DIFFERS else 0
    return DEPENDS


def check_energy(i: Impact) -> int:
    """Find the change of energy; refuse a law that creates some, unless a restitution does."""
    size = 0.0
    elastic = True
    source = False
    for k in range(i.n):
        if math.fabs(i.after[k]) <= i.still:
            i.after[k] = 0.0
        i.energy += 0.5 * i.impulses[k] * (i.v[k] + i.after[k])
        size += 0.5 * i.impulses[k] * (math.fabs(i.v[k]) + math.fabs(i.after[k]))
        if i.impulses[k] > 0.0:
            elastic = elastic and i.eps[k] >= 1.0
            source = source or i.eps[k] > 1.0
    if math.fabs(i.energy) <= CREATED * size:
        i.energy = 0.0 if elastic else min(i.energy, 0.0)
    if i.energy > 0.0 and not source:
        for k in range(i.n):
            i.blamed[k] = 1 if i.impulses[k] > 0.0 else 0
        return CREATES_ENERGY
    return EXCHANGED
