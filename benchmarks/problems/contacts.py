"""P9: long chains with stiffening springs and ten compliant contacts."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np
from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c
from measuring.restarts import Mode, Rule, Vector, in_scipy

import hybond as hb
from problems.chain import chain, links

CONTACTS, CUBIC, PAD, DAMPER, RTOL = 10, 1e5, 1e5, 100.0, 1e-8
LENGTHS = {100: (1.0, 2.0), 1000: (1.0, 2.0), 10_000: (0.5, 1.1)}
FULL = {100: (1.0, 2.0), 1000: (1.0, 2.0), 10_000: (0.5, 1.1)}
SCIPY = 1000
"""Masses up to which SciPy is asked."""


def gap(contact: int) -> float:
    """Return how far a mass may move before it touches, m."""
    return 0.5 + 0.05 * contact


def mass(masses: int, contact: int) -> int:
    """Return the number of the mass that has a contact, from 1."""
    return (contact + 1) * masses // CONTACTS


def model(masses: int) -> hb.Model:
    """Return the chain; each contact is a spring and a damper that a machine switches."""
    m = chain(masses, CUBIC)
    for c in range(CONTACTS):
        k = mass(masses, c)
        m.signal(**{f"way{c}": hb.Integral(f"v{k}.f", start=0.0)})
        m.add(
            **{
                f"contact{c}": hb.Zero(),
                f"squeeze{c}": hb.One(),
                f"pad{c}": hb.C(1.0 / PAD),
                f"damper{c}": hb.R(DAMPER),
            }
        )
        m.bond(f"v{k} -> contact{c} -> squeeze{c} -> pad{c}", f"squeeze{c} -> damper{c}")
        m.machine(
            f"stop{c}",
            states={"away": [], "touching": [f"contact{c}"]},
            start="away",
            rules=[
                f"away -> touching when way{c} >= {gap(c)} and v{k}.f > 0",
                f"touching -> away when contact{c}.e < 0",
            ],
        )
    return m


def modes(masses: int, mode: Hashable) -> Mode:
    """Return the chain while the contacts in `mode`, a tuple of Booleans, touch."""
    assert isinstance(mode, tuple)
    touching = np.array(mode)
    of = np.array([masses + mass(masses, c) - 1 for c in range(CONTACTS)])
    way = slice(2 * masses, 2 * masses + CONTACTS)
    pad = slice(2 * masses + CONTACTS, 2 * masses + 2 * CONTACTS)

    def pulled(t: float, y: Vector) -> Vector:
        dq, dv = links(y[:masses], y[masses : 2 * masses], CUBIC)
        v = y[of]
        dv[of - masses] -= np.where(touching, PAD * y[pad] + DAMPER * v, 0.0)
        return np.concatenate((dq, dv, v, np.where(touching, v, -PAD / DAMPER * y[pad])))

    def rule(c: int) -> Rule:
        after = tuple(not a if k == c else a for k, a in enumerate(mode))

        def guard(t: float, y: Vector) -> float:
            v = y[of[c]]
            if mode[c]:
                return float(PAD * y[pad][c] + DAMPER * v)
            return float(gap(c) - y[way][c]) if v > 0.0 else 1.0

        return guard, lambda t, y: (after, y)

    return pulled, [rule(c) for c in range(CONTACTS)]


def problem(masses: int, full: bool) -> Problem:
    """Return the problem: what it finds are the stretch at the first contact and the first one."""
    longest = (FULL if full else LENGTHS)[masses][1]

    def limit(end: float, rtol: float = RTOL) -> Outcome | None:
        run = in_c("contacts", masses, end, rtol, points(end, longest))
        return run and Outcome(run.seconds, run.found[1:])

    def true(end: float) -> tuple[float, ...]:
        run = limit(end, 1e-12)
        return run.found if run else (float("nan"),) * 2

    def ours(end: float) -> Outcome:
        return in_hybond(
            model(masses),
            end,
            points(end, longest),
            ["way0", f"way{CONTACTS - 1}"],
            lambda run: (run.final[f"k{mass(masses, 0)}.q"], run.final["k1.q"]),
            rtol=RTOL,
        )

    def scipy(end: float) -> Outcome:
        return in_scipy(
            lambda mode: modes(masses, mode),
            (False,) * CONTACTS,
            [0.0] * (2 * masses + 2 * CONTACTS),
            end,
            points(end, longest),
            lambda t, y, times: (float(y[mass(masses, 0) - 1]), float(y[0])),
            rtol=RTOL,
        )

    tools = {C: limit, "hybond": ours, "SciPy": scipy}
    if masses > SCIPY:
        del tools["SciPy"]
    return Problem(
        "P9",
        f"stiffening chain of {masses:,}, ten contacts",
        "second",
        LENGTHS[masses],
        FULL[masses],
        tools,
        true,
        size=masses,
    )
