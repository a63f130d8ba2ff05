"""Sources that move by a law of time alone: their values are found once for an instant.

Where guards are looked at, and where an instant is settled, equation after equation asks for them.
"""

from __future__ import annotations

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.words import Floats


def value_of_source(e: Engine, s: int, v: Floats) -> float:
    """Return the value of source s of the model, which has a law."""
    return kept_value(e, s, s, e.model.source_value[s], v)


def rate_of_source(e: Engine, s: int, v: Floats) -> float:
    """Return the rate of source s of the model, which has one."""
    return kept_value(e, s, e.model.sources + s, e.model.source_rate[s], v)


def kept_value(e: Engine, s: int, at: int, law: int, v: Floats) -> float:
    """Return the value of a law of source s, which is kept at such a place if it is of time alone.

    An input may be another one at the same time, and what compares the time may say something else.
    """
    m = e.model
    w = e.work
    if m.source_timed[s] == 0 or m.inputs > 0 or m.watches > 0:
        return value(m, law, v)
    if w.timed_at[at] != v[0]:
        w.timed[at] = value(m, law, v)
        w.timed_at[at] = v[0]
    return w.timed[at]
