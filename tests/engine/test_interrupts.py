"""Ctrl-C in a run: answered soon, nothing lost, whoever handles it."""

from __future__ import annotations

import os
import signal
import sys
import threading

import pytest
from engine.by_engine import ENGINE

import hybond as hb

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no signals to a process itself")


def long_run() -> hb.Model:
    m = hb.Model("lc", domain="electrical")
    m.add(c=hb.C("1 F", e="1 V"), l=hb.I("1 H"), n=hb.Zero())
    m.bond("n -> c", "n -> l")
    return m


class Own(Exception):
    pass


def interrupted(**options: object) -> hb.Result:
    # imports and tables take their time: an interrupt then would be raised at once
    hb.simulate(long_run(), until=1.0, engine=ENGINE)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        return hb.simulate(long_run(), until=1e7, keep=1000, engine=ENGINE, **options)  # type: ignore[arg-type]
    finally:
        timer.cancel()


def test_an_interrupt_keeps_what_there_is() -> None:
    run = interrupted(max_steps=10**9)
    assert run.status == "interrupted"
    assert 0.0 < run.t_end < 1e7
    assert run["c.e"].at(run.t_end) == pytest.approx(run["c.q"].at(run.t_end))


def test_a_handler_of_the_user_is_called_between_slices_and_stays() -> None:
    def own(number: int, frame: object) -> None:
        raise Own

    before = signal.signal(signal.SIGINT, own)
    try:
        with pytest.raises(Own):
            interrupted(max_steps=10**9)
        assert signal.getsignal(signal.SIGINT) is own
    finally:
        signal.signal(signal.SIGINT, before)
