"""Laws of one side, held to what they can do on the mean while machines slide."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.reasons.noting import PULLS, note_violation
from hybond.engine.surfaces.law_means import is_meant
from hybond.engine.surfaces.values import evaluate

HOLDS: Final = 1e-9
"""Part of what a law carries by which it may pull at an instant located as that where it does."""


def hold_means(e: Engine) -> None:
    """Note laws that pull on the mean of fast switching for longer than an instant.

    At a kink of what drives them they begin to, and are let go within that.
    """
    m = e.model
    s = e.slide
    since = e.checks.pulls_since
    some = False
    for k in range(m.ports):
        meant = s.k > 0 and is_meant(e, k)
        some = some or meant
        since[k] = since[k] if meant else math.inf
    if not some:
        return
    if evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return
    for k in range(m.ports):
        margin = s.margin[2 * s.k + k]
        if not (is_meant(e, k) and margin < -HOLDS):
            since[k] = math.inf
            continue
        since[k] = min(since[k], e.t)
        if e.t > since[k] + room_of_instant(e, e.t):
            size = s.push_size[k]
            note_violation(e, e.mode, e.t, PULLS, k, -margin * size, size)
