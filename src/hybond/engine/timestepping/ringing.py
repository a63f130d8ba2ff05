"""What a step does by its matrices: whether it rings, and whether laws in it are still passive."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.complementarity.semidefinite import is_indefinite
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.response import feel_at_once
from hybond.engine.model import Model
from hybond.engine.timestepping.step_records import Coupled, Stepping
from hybond.engine.words import Floats

IDLE_PART: Final = 1e-14
"""Part of the largest response below which a law does nothing."""
LEFT_OF_LAWS: Final = 0.5
"""Part of what laws make of their `w` by the graph that a step has to leave of it."""


def turns_back(n: int, inverse: Floats, kept: float, square: Floats) -> bool:
    """Whether a step without laws turns anything stored by more than a quarter; `square` is room.

    The step multiplies by ``(inverse - kept) / theta``, where `kept` is ``1 - theta``. Of what is
    passive that is positive definite, measured by energy, as long as all of it ends nearer to where
    it began than to the opposite: then, and only then if nothing swings, all pivots are positive,
    in whatever units.
    """
    if kept <= 0.0:
        return False
    for i in range(n * n):
        square[i] = inverse[i]
    for k in range(n):
        square[k * n + k] -= kept
    for k in range(n):
        pivot = square[k * n + k]
        if not pivot > 0.0:
            return True
        for i in range(k + 1, n):
            part = square[i * n + k] / pivot
            if part != 0.0:
                for j in range(k + 1, n):
                    square[i * n + j] -= part * square[k * n + j]
    return False


def loses_laws(m: Model, s: Stepping, p: Ports, c: Coupled) -> bool:
    """Whether a step with ``theta < 1`` leaves too little of how laws feel what they do.

    With G what a graph answers to a law at the rate ``1 / (theta h)``, which is passive as the
    graph is, and D what it answers at once, laws feel ``m = (G - (1 - theta) D) / theta``. If D is
    most of G, because something relaxes within the step, that is no longer passive, laws have two
    answers or none, and what they find is an artefact. With ``theta = 1`` it is G. Of a graph that
    is not passive by itself nothing is said.
    """
    n = m.ports
    kept = 1.0 - c.theta
    if kept <= 0.0:
        return False
    feel_at_once(m, p, c.direct.at, s.at_once)
    at_once = s.at_once
    most = 0.0
    for i in range(n * n):
        most = max(most, max(math.fabs(c.m.at[i]), math.fabs(at_once[i])))
    acts = False
    for i in range(n * n):
        if math.fabs(at_once[i]) <= IDLE_PART * most:
            at_once[i] = 0.0
        acts = acts or at_once[i] != 0.0
    if not acts:
        return False
    for i in range(n * n):
        d = kept * at_once[i]
        left = (1.0 - LEFT_OF_LAWS * c.theta) * c.m.at[i] - LEFT_OF_LAWS * d
        at_once[i] = c.theta * c.m.at[i] + d
        s.feel[i] = left
    return is_indefinite(n, s.feel, s.scale, s.down, s.square.at) and not is_indefinite(
        n, at_once, s.scale, s.down, s.square.at
    )
