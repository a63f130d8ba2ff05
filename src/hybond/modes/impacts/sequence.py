"""Newton's law step by step: repeat it until no contact approaches, or see that this never ends.

Whether it ends depends on restitution: three equal balls in a row, the first of which arrives,
need ever more collisions as the restitution falls to 7 - 4*sqrt(3) = 0.0718, and infinitely many
below it (inelastic collapse). The approach velocities then shrink geometrically towards zero: the
contacts that still meet end at rest relative to each other, and the impulses have a limit.

References
----------
B. Bernu, R. Mazighi, "One-dimensional bounce of inelastically colliding marbles on a wall",
J. Phys. A 23:5745-5754, 1990. S. McNamara, W. R. Young, "Inelastic collapse and clumping in a
one-dimensional granular medium", Phys. Fluids A 4:496-504, 1992.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.modes.impacts.laws import Impact, impact

Array = NDArray[np.float64]

COLLAPSED = 1e-11
"""Approach that has shrunk to this part of the first one, in `FEW` steps per contact or more, is on
its way to zero."""

FEW = 4
"""Steps per contact before an approach that shrinks may count as a collapse."""


@dataclass(frozen=True, slots=True)
class ImpactSequence:
    """Impacts one after another at one instant.

    Parameters
    ----------
    steps : tuple of Impact
        The impacts in order; each begins with what the one before left.
    impulses : ndarray, shape (n,)
        Sum of their impulses.
    after : ndarray, shape (n,)
        Separating velocities after the last one.
    energy : float
        Change of energy by all of them.
    ended : str
        ``"separated"``: nothing approaches; ``"collapse"``: approach shrinks without end;
        ``"limit"``: neither, after the allowed number of steps.
    rest : Impact or None
        Where it did not separate: the plastic impact that would end it. After a collapse it is
        its limit (within `COLLAPSED` of the first approach).
    """

    steps: tuple[Impact, ...]
    impulses: Array
    after: Array
    energy: float
    ended: str
    rest: Impact | None = None


def sequence(
    W: ArrayLike,
    v: ArrayLike,
    *,
    eps: ArrayLike,
    max_steps: int = 1000,
    names: Sequence[str] = (),
) -> ImpactSequence:
    """Repeat Newton's law for approaching contacts until none approaches.

    Parameters
    ----------
    W, v, eps, names
        See `laws.impact`.
    max_steps : int
        Limit on the number of impacts.

    Returns
    -------
    ImpactSequence

    Raises
    ------
    HybondError
        As `laws.impact`; HB-J201 counts each step by itself.

    Examples
    --------
    Three equal balls that touch, the first one arrives at 1 m/s:

    >>> W = np.array([[2.0, -1.0], [-1.0, 2.0]])
    >>> done = sequence(W, [-1.0, 0.0], eps=1.0)
    >>> done.ended, len(done.steps), done.after.tolist()  # (0, 0, 1)
    ('separated', 2, [0.0, 1.0])
    >>> done = sequence(W, [-1.0, 0.0], eps=0.05)
    >>> done.ended, done.rest.after.tolist()  # (1/3, 1/3, 1/3)
    ('collapse', [0.0, 0.0])
    """
    now = np.array(v, dtype=float)
    first = float(np.max(-now, initial=0.0))
    # What is zero but for rounding of the first velocities stays so when they have shrunk.
    floor = 1e-14 * float(np.max(np.abs(now), initial=0.0))
    steps: list[Impact] = []
    impulses, energy, ended = np.zeros(len(now)), 0.0, "limit"
    while len(steps) < max_steps:
        step = impact(W, now, eps=eps, names=names, floor=floor)
        if not step.active:
            ended = "separated"
            break
        steps.append(step)
        impulses = impulses + step.impulses
        energy += step.energy
        now = step.after
        approach = float(np.max(-now, initial=0.0))
        if 0.0 < approach <= COLLAPSED * first and len(steps) >= FEW * len(now):
            ended = "collapse"
            break
    rest = None
    if ended != "separated":
        rest = impact(W, now, eps=0.0, law="newton_simultaneous", names=names, floor=floor)
    return ImpactSequence(tuple(steps), impulses, now, energy, ended, rest)
