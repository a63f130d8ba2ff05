"""An impact through the compliance of its contacts: the law of Liu, Zhao and Brogliato.

Each closed contact is a spring of force ``k d**m`` (m = 1 linear, 1.5 Hertz) that is so stiff that
positions do not move while it acts. The paper integrates over an impulse how potential energies
``k d**(m + 1)/(m + 1)`` share it, singularly where a contact begins. In `d` and a time that has no
length the same law is regular (spring_steps.py):

    p' = k d**m,    d' = -v while v <= 0 (compression),  -v/eps**2 while v > 0 (expansion)

Expansion returns ``eps**2`` of the work of compression, Stronge's restitution; the two slopes are
the "bi-stiffness" contact. A contact ends where its indentation does, and begins again when it is
approached; the impact ends when nothing is stored and nothing approaches. Only ratios of stiffness
count, and scaled by the fastest approach impulses do not depend on speed.

Where ``eps = 0`` expansion takes no time: the limit is ``d' = -max(u, 0)`` with velocities u that
begin at zero, all other indentations being held. What it does not use up is compressed again.

Positions do not move: a contact that has ended is closed again as soon as it is approached. Finite
springs behave so only where no contact closes twice.

Source: C. Liu, Z. Zhao, B. Brogliato, *Frictionless multiple impacts in multibody systems. I.
Theoretical framework*, Proc. R. Soc. A 464, 2008.
"""

import math
from typing import Final

from hybond.engine.impacts.impact_records import Compliant, Impact
from hybond.engine.impacts.spring_steps import (
    MARGIN,
    advance_phase,
    find_forces,
    find_rate,
    find_separations,
)

LOOSER: Final = 1e2
"""The error is measured against a second integration whose tolerance is larger by this."""
OVER: Final = 1e-11
"""An impact is over when what approaches is below this part of the first approach, and what is
stored below its square of the energy."""


def compress(i: Impact, tolerance: float, most: int) -> bool:
    """Put the impulses there, and the error of velocities; False beyond so many phases."""
    n = i.n
    c = i.springs
    fastest = 0.0
    heaviest = 0.0
    logs = 0.0
    for a in range(n):
        fastest = max(fastest, -i.v[a])
        heaviest = max(heaviest, i.w[a * n + a])
        logs += math.log(i.stiffness[a])
    c.n = n
    c.exponent = i.exponent
    c.most = most
    for a in range(n):
        # scaled: responses, velocities, stiffness, hence time and impulses are about one
        c.start[a] = i.v[a] / fastest
        c.eps[a] = i.eps[a]
        c.k[a] = i.stiffness[a] / math.exp(logs / float(n))
        for b in range(n):
            c.w[a * n + b] = i.w[a * n + b] / heaviest
    if not integrate(c, min(LOOSER * tolerance, 1e-3)):
        return False
    for a in range(n):
        c.coarse[a] = c.p[a]
    if not integrate(c, tolerance):
        return False
    worst = 0.0
    for a in range(n):
        change = 0.0
        for b in range(n):
            change += c.w[a * n + b] * (c.p[b] - c.coarse[b])
        worst = max(worst, math.fabs(change))
        i.impulses[a] = max(c.p[a], 0.0) * (fastest / heaviest)
    i.error = (worst + OVER) * fastest
    return True


def integrate(c: Compliant, tolerance: float) -> bool:
    """Compress and expand from the start until nothing does; False if there are too many phases."""
    c.h = 0.1
    c.steps = 0
    c.pieces = 0
    for a in range(c.n):
        c.p[a] = 0.0
        c.d[a] = 0.0
        c.base[a] = c.start[a]
    while c.pieces < c.most:
        find_phases(c)
        if expands_at_once(c):
            if not drop_plastic(c, tolerance):
                return False
            find_phases(c)
        if is_over(c):
            return True
        if not advance_phase(c, tolerance):
            return False
        c.pieces += 1
    return False


def find_phases(c: Compliant) -> None:
    """Give each contact its phase, from velocity and indentation, or the rate of the velocity."""
    find_separations(c)
    for a in range(c.n):
        c.acts[a] = 1
        if c.d[a] <= MARGIN:
            c.d[a] = 0.0
    find_forces(c)
    for a in range(c.n):
        parts = is_rising(c, a)
        if parts and c.d[a] == 0.0:
            put_phase(c, a, 0, 0.0, 1, 0)
        elif c.eps[a] == 1.0:
            put_phase(c, a, 1, 1.0, 0, 1)
        elif parts and c.eps[a] > 0.0:
            put_phase(c, a, 1, 1.0 / (c.eps[a] * c.eps[a]), 1, 1)
        else:
            put_phase(c, a, 1, 1.0, -1, 0)


def put_phase(c: Compliant, a: int, acts: int, way: float, keeps: int, lasts: int) -> None:
    """Put a contact into a phase."""
    c.acts[a] = acts
    c.way[a] = way
    c.keeps[a] = keeps
    c.lasts[a] = lasts


def is_rising(c: Compliant, a: int) -> bool:
    """Whether a velocity is above zero, or about to be."""
    if math.fabs(c.v[a]) > 10.0 * MARGIN:
        return c.v[a] > 0.0
    return find_rate(c, a) > 0.0


def is_over(c: Compliant) -> bool:
    """Whether nothing approaches and nothing is stored."""
    stored = 0.0
    over = True
    for a in range(c.n):
        over = over and -c.v[a] <= OVER
        stored += c.force[a] * c.d[a] / (c.exponent + 1.0)
    return over and stored <= OVER * OVER


def expands_at_once(c: Compliant) -> bool:
    """Whether plastic contacts have been compressed as far as they will be."""
    some = False
    for a in range(c.n):
        stops = c.eps[a] == 0.0 and c.d[a] > 0.0 and c.v[a] >= -10.0 * MARGIN
        c.dropping[a] = 1 if stops else 0
        some = some or stops
    return some


def drop_plastic(c: Compliant, tolerance: float) -> bool:
    """Let plastic contacts expand, in no time; False if this does not end."""
    n = c.n
    h = c.h
    for a in range(n):
        c.kept[a] = c.p[a]
        c.p[a] = 0.0
        c.base[a] = 0.0
    found = drop_on(c, tolerance)
    for a in range(n):
        c.p[a] = c.kept[a]
        c.base[a] = c.start[a]
        if c.dropping[a] != 0 and c.d[a] <= tolerance:
            c.d[a] = 0.0
    c.h = h
    return found


def drop_on(c: Compliant, tolerance: float) -> bool:
    """Let plastic contacts expand until none does; False if there are too many phases."""
    while c.pieces < c.most:
        find_separations(c)
        find_forces(c)
        moves = False
        for a in range(c.n):
            if c.dropping[a] == 0:
                put_phase(c, a, c.acts[a], 0.0, 0, 0)
            elif c.acts[a] == 0 or c.d[a] <= MARGIN:
                c.d[a] = 0.0
                put_phase(c, a, 0, 0.0, 0, 0)
            elif is_rising(c, a):
                put_phase(c, a, 1, 1.0, 1, 1)
                moves = True
            else:
                put_phase(c, a, 1, 0.0, -1, 0)
        if not moves:
            return True
        if not advance_phase(c, tolerance):
            return False
        c.pieces += 1
    return False
