"""Limits of sequences of instants, against closed forms."""

from __future__ import annotations

import math

import pytest
from engine.sliding_models import allowed
from hypothesis import given, settings
from hypothesis import strategies as st

from hybond.engine.contacts.accumulation import (
    aitken,
    chatters,
    limit_of,
    note_impact,
    push_time,
    restart,
)
from hybond.engine.contacts.landing_records import LAST_TIMES, Landings, make_landings
from hybond.engine.tables import answered, tables_of


def landings() -> Landings:
    """Return what is known before a run of one machine."""
    return make_landings(answered(tables_of(allowed().flatten(), until=1.0)))


@settings(max_examples=100)
@given(st.floats(-5, 5), st.floats(0.01, 5), st.floats(0.01, 0.95))
def test_aitken_is_exact_for_geometric_sequences(limit: float, size: float, r: float) -> None:
    terms = [limit - size * r**k for k in range(3)]
    rounding = 1e-14 * (abs(limit) + size) / (1 - r) ** 2
    assert aitken(*terms) == pytest.approx(limit, abs=rounding)


def test_aitken_has_no_limit_for_what_does_not_converge() -> None:
    assert aitken(0.0, 1.0, 2.0) == math.inf
    assert aitken(1.0, 1.0, 1.0) == 1.0


@pytest.mark.parametrize("times", [[0, 1], [0, 1, 2], [0, 1, 3], [0, 0, 0], [0, 1, 1.5, 2.1]])
def test_what_does_not_shrink_has_no_limit(times: list[float]) -> None:
    assert not limit_of(landings(), [float(t) for t in times], 0, len(times))


def test_what_shrinks_has_the_limit_of_its_series() -> None:
    g = landings()
    assert limit_of(g, [3.0 - 0.5**k for k in range(8)], 0, 8)
    assert (g.limit_t, g.limit_ratio) == pytest.approx((3.0, 0.5), rel=1e-15)
    assert g.limit_left == pytest.approx(0.5**7)


def crowd(times: list[float]) -> tuple[bool, Landings]:
    """Return whether events at these instants, no impacts, have reached a limit."""
    g = landings()
    for t in times:
        g.other_kept[0] = push_time(g.others, g.other_kept[0], 0, t)
    return chatters(g, 0, 10.0, times[-1]), g


def test_twelve_intervals_in_one_moment_are_chatter() -> None:
    assert LAST_TIMES == 13
    assert not crowd([1.0 + 1e-13 * k for k in range(12)])[0]  # eleven intervals
    found, g = crowd([1.0 + 1e-13 * k for k in range(13)])
    assert found and g.limit_t == pytest.approx(1.0)
    assert not crowd([1.0 + 0.1 * k for k in range(13)])[0]
    found, g = crowd([2.0 - 0.1**k for k in range(13)])
    assert found and g.limit_t == pytest.approx(2.0, abs=1e-12)
    assert g.limit_ratio == pytest.approx(0.1, rel=1e-3)
    # the oldest go
    assert crowd([0.1 * k for k in range(20)] + [3.0 - 0.1**k for k in range(13)])[0]


def test_intervals_before_it_all_began_tell_no_limit() -> None:
    """Four tenths at each turn: 7e-8 s are left, whatever a first interval of a second says."""
    assert not crowd([2.0, *(3.0 - 0.4 ** (6 + k) for k in range(12))])[0]


def test_a_limit_that_is_past_is_none() -> None:
    """Another contact went on beyond it, and struck this one at the same instants."""
    found, g = crowd([2.0 - 0.1**k for k in range(13)])
    assert found and not chatters(g, 0, 10.0, 2.0 + 1e-8)


def test_a_machine_remembers_its_longest_flight() -> None:
    g = landings()
    note_impact(g, 0, 1.0, 5.0)
    note_impact(g, 0, 1.5, 2.0)
    restart(g, 0, 2.0)
    note_impact(g, 0, 2.1, 1.0)
    assert (g.flight[0], g.speed[0], g.count[0]) == (5.0, 5.0, 1)
