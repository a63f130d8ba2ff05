"""Which states act on which rates, and which of them can be shifted together."""

from __future__ import annotations

from hybond.engine.algebra.blocks import Places, make_places
from hybond.engine.words import record


@record
class Acting:
    """What is known of it in a mode; see `acting`.

    State j acts on the rates `rate` from ``first[j]`` up to ``first[j + 1]``. States of one of the
    `groups`, as `group` says of each, act on no rate together; none: that would not be worth it, or
    is not known.
    """

    known: bool
    groups: int
    group: Places
    first: Places
    rate: Places


def make_acting() -> Acting:
    """Return nothing known."""
    a = Acting()
    a.group = make_places(1)
    a.first = make_places(1)
    a.rate = make_places(1)
    return a
