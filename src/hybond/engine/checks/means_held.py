"""Laws of one side, held to what they can do on the mean while machines slide."""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.reasons.noting import PULLS, note_violation
from hybond.engine.surfaces.law_means import is_meant
from hybond.engine.surfaces.values import evaluate

HOLDS: Final = 1e-9
"""Part of what a law carries by which it may pull at an instant located as that where it does."""


def hold_means(e: Engine) -> None:
    """Note laws that pull on the mean of fast switching, at the present instant."""
    m = e.model
    s = e.slide
    some = False
    for k in range(m.ports if s.k > 0 else 0):
        some = some or is_meant(e, k)
    if not some:
        return
    if evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return
    for k in range(m.ports):
        margin = s.margin[2 * s.k + k]
        if is_meant(e, k) and margin < -HOLDS:
            size = s.push_size[k]
            note_violation(e, e.mode, e.t, PULLS, k, -margin * size, size)
