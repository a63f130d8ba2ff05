"""Values at a point of the last step: what it found, and straight lines between its ends."""

from __future__ import annotations

from hybond.engine.engine import OK, Engine
from hybond.engine.method_numbers import MOREAU
from hybond.engine.surfaces.values import evaluate
from hybond.engine.timestepping.theta_step import write_point
from hybond.engine.words import Floats


def show_point(e: Engine, t: float, y: Floats) -> int:
    """Write all values at a point of the motion into `e.shown`: at its end, or in its last step."""
    if e.model.method != MOREAU:
        return evaluate(e, e.mode, e.shown, t, y)
    s = e.stepping
    part = (t - s.t0) / (e.t - s.t0) if t < e.t else 1.0
    for b in range(2 * e.model.bonds):
        s.base[b] = s.begin_w[b] + part * (s.w[b] - s.begin_w[b]) if part < 1.0 else s.w[b]
    write_point(e, e.shown, t, y, s.base)
    return OK
