"""What laws read by ``pre()`` where impacts have come to an end, and time passes all the same.

A machine that has landed stays in its pinnacle: its law is read as at the limit of its impacts.
"""

from __future__ import annotations

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.words import Floats


def put_limits(e: Engine, mode: Mode, v: Floats) -> None:
    """Let laws that read ``pre()`` in a mode read what that comes to where impacts end."""
    m = e.model
    for k in range(m.priors):
        if mode.prior_acts[k] != 0:
            put_limit(e, k, v)


def put_limit(e: Engine, k: int, v: Floats) -> None:
    """Let one of them do so: zero, or the speed of what is hit."""
    m = e.model
    for i in range(m.prior_read[k], m.prior_read[k + 1]):
        law = m.prior_limit[i]
        limit = m.prior_limit_constant[i] if law < 0 else value(m, law, v)
        v[m.slots + m.prior_slot[i]] = limit
