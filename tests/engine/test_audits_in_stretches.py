"""An audit reads many segments at once, and says what it says of each alone, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb
from hybond.engine.outcome import stretches as reading

PUMP = """
hybond = 1
name = "pump"
domain = "electrical"

[elements]
V = {{ Se = "{source}" }}
S1 = {{ junction = 1 }}
S1_R = {{ R = "20 ohm" }}
S2 = {{ junction = 1 }}
S2_R = {{ R = "30 ohm" }}
C1 = {{ C = "100 pF" }}
C2 = {{ C = "1 nF", e = "0.1 V" }}
x = {{ junction = 0 }}

[graph]
bonds = ["S2 -> S2_R", "x -> S2", "x -> C1", "S1 -> S1_R", "S1 -> x", "V -> S1", "S2 -> C2"]

[machines.A]
states = {{ open = [], closed = ["S1"] }}
start = "open"
rules = ["open -> closed when sin(3e6*time) > 0", "closed -> open when sin(3e6*time) < 0"]

[machines.B]
states = {{ open = [], closed = ["S2"] }}
start = "closed"
rules = ["open -> closed when cos(3e6*time) > 0.1", "closed -> open when cos(3e6*time) < 0"]

[experiment]
until = "{until}"
"""

SOURCES = {
    "steady": "1",
    "a source that jumps": "1 + floor(time*3e5)/7",
    "a source with kinks": "abs(sin(2e5*time))",
}


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("engine", ["library", "python"])
def test_many_segments_at_once_are_as_one_by_one(
    source: str, engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = PUMP.format(source=SOURCES[source], until="6 us" if engine == "python" else "90 us")
    run = hb.simulate(hb.loads(text), engine=engine)
    assert len(run.segments) > (10 if engine == "python" else 150)
    at_once = run.audit()
    assert at_once.holds()
    monkeypatch.setattr(reading, "POINTS", 40)
    assert run.audit() == at_once
    monkeypatch.setattr(reading, "POINTS", 1)
    assert run.audit() == at_once


@pytest.mark.parametrize("keep", [5, 17])
def test_what_a_run_keeps_is_read_from_its_middle(
    keep: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = PUMP.format(source=SOURCES["a source with kinks"], until="90 us")
    run = hb.simulate(hb.loads(text), keep=keep)
    at_once = run.audit()
    monkeypatch.setattr(reading, "POINTS", 1)
    assert run.audit() == at_once


def test_stretches_have_the_points_of_the_run() -> None:
    text = PUMP.format(source=SOURCES["a source that jumps"], until="90 us")
    run = hb.simulate(hb.loads(text))
    found = list(reading.stretches(run.signals, run.trace))
    assert len(found) < len(run.segments) / 10
    t = np.concatenate([s.t for s in found])
    assert t.tolist() == [k for s in run.segments for k in s.t.tolist()]
    # nothing but R takes, so that a segment ends with what it began with
    for s in found:
        off = s.changes(s.balance)
        assert np.abs(s.along(off)).max() <= 1e-7 * (s.stored.max() + s.passed.max())
