"""The state at rest: a pinnacle's structure with every ``pre()`` term of its laws at zero."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations, undetermined_names
from hybond.equations.storage import StorageLaws
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.dirac import steady
from hybond.modes.jump import enter, impulse_directions, reach_of
from hybond.modes.trial import Trial
from hybond.programs.program import Program

Vector = NDArray[np.float64]

DUSTING = 2
"""Times that rounding is swept off a state at rest: what is left would do work for ever."""
STILL = 1e-15
"""What a contact at rest holds still is at rest below this part of what all the energy of the run
would make of it: else the sign of a rounding error could close a contact that is to open."""


def moved(equations: ModeEquations, v: list[float]) -> tuple[int, ...]:
    """Return the storages that impulses of a mode can move."""
    rates = equations.storage.rates_of(impulse_directions(equations, v))
    return tuple(np.flatnonzero(np.abs(rates).max(axis=1, initial=0.0) > 0.0).tolist())


def still(x: Vector, which: Collection[int], storage: StorageLaws, energy: float) -> Vector:
    """Return the state with rounding in the storages `which` put to zero; `x` if there is none."""
    if not which:
        return x
    reach = reach_of(storage, x, energy)
    dust = [k for k in which if x[k] != 0.0 and abs(x[k]) <= STILL * reach[k]]
    if dust:
        x = x.copy()
        x[dust] = 0.0
    return x


def rest(
    program: Program,
    t: float,
    x: Vector,
    s: Vector,
    mode: Mode,
    interval: Interval,
    pre: Sequence[float],
    *,
    energy: float,
) -> Trial:
    """Return what `mode` makes of the state `x` at rest, and what it then has to carry.

    Junctions with laws are taken in the branches that `mode` says. Integrated signals stay.

    Parameters
    ----------
    pre : sequence of float
        Values a priori; those that the mode's laws read by ``pre()`` are taken as zero.
    energy : float
        The largest energy that the run has seen, J.

    Raises
    ------
    HybondError
        If the mode has no solution there.
    """
    slots, n = program.slots, program.slots.size
    equations = program.equations(mode, interval, t)
    v = program.values(t, interval, mode, x, s)
    v[n:] = list(pre)
    for k in program.vanishing(mode):
        v[n + k] = 0.0
    v[slots.w] = v[n + slots.w.start : n + slots.w.stop]
    where = program.graph.mode_text(mode)
    jump = enter(equations, v, x, where=where, energy=energy)
    for _ in range(DUSTING):
        jump = replace(jump, x=enter(equations, v, jump.x, where=where, energy=energy).x)
    moving = moved(equations, v)
    jump = replace(jump, x=still(jump.x, moving, equations.storage, energy))
    v[slots.x] = jump.x.tolist()
    solution = equations.solution(v, jump.x)
    size = [abs(a) for a in v[:n]]
    size[slots.w] = solution.size.tolist()
    pairs = steady(v, size)
    names = tuple(undetermined_names(program.graph, solution.freedom))
    floor = np.zeros(len(solution.w))
    return Trial(mode, equations, jump, s, v, pairs, floor, solution.freedom, names)
