"""What an event of stick-slip asks for: guards beside their roots, and slopes of constraints."""

from __future__ import annotations

import cProfile
import functools
import math
from collections import Counter

import pytest

import hybond as hb

DRIVE = 1e-3
LIMIT = 1.0
BREAKAWAY = 1.5
SLIPS = 8


def held(effort: float) -> float:
    """Return what both springs hold at an effort."""
    return 0.1 * (math.asinh(effort / 2.0) + math.asinh(effort / 3.0))


def stick_slip() -> hb.Model:
    """Return two bent springs that are tied, driven until dry friction lets go of them."""
    m = hb.Model("stick slip")
    m.add(
        drive=hb.Sf(DRIVE),
        soft=hb.C({"e": "2.0*sinh(q/0.1)"}, q=0.0),
        hard=hb.C({"e": "3.0*sinh(q/0.1)"}, q=0.0),
        node=hb.Zero(),
        rub=hb.One(law="coulomb", limit=LIMIT, breakaway=BREAKAWAY),
    )
    m.bond("drive -> node", "node -> soft", "node -> hard", "node -> rub")
    return m


@functools.cache
def run_and_calls() -> tuple[hb.Result, Counter[str]]:
    """Return a run, and how often functions of the engine were called."""
    with cProfile.Profile() as profile:
        run = hb.simulate(stick_slip(), 400.0, engine="python")
    calls: Counter[str] = Counter()
    for entry in profile.getstats():
        if not isinstance(entry.code, str) and "engine" in entry.code.co_filename:
            calls[entry.code.co_name] += entry.callcount
    return run, calls


@pytest.mark.slow
def test_slips_come_as_often_as_springs_take_to_be_loaded() -> None:
    run, _ = run_and_calls()
    slips = [event.t for event in run.events[1:]]
    first = held(BREAKAWAY) / DRIVE
    every = (held(BREAKAWAY) - held(LIMIT)) / DRIVE
    assert slips == pytest.approx([first + k * every for k in range(SLIPS)], rel=1e-9)


def test_a_guard_is_not_asked_fifty_times_where_its_comparison_is_rounding() -> None:
    _, calls = run_and_calls()
    assert calls["holds_at"] < 24 * SLIPS


def test_constraints_that_are_met_are_asked_for_no_slopes() -> None:
    _, calls = run_and_calls()
    assert calls["slope_of"] < 1.5 * calls["newton_steps"]
