"""Runs that keep the last of their segments and events only, and write events as they happen."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

import hybond as hb
from hybond.chronicle import Chronicle

EXAMPLES = Path(__file__).parents[3] / "examples"

LONG = """
import resource, hybond as hb
m = hb.Model("rhythm")
m.add(c=hb.C(1, q=1.0), n=hb.Zero(), g=hb.G(0.1), s=hb.One(), r=hb.R(1))
m.bond("n -> c", "n -> g", "n -> s -> r")
m.machine("M", states={"off": [], "on": ["s"]}, start="off",
          rules=["off -> on when sin(5*time) > 0.1", "on -> off when sin(5*time) < -0.2"])
for until in (1000.0, 40000.0):
    run = hb.simulate(m, until, keep=50)
    print(run.trace.events.total, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def rhythm():
    m = hb.Model("rhythm")
    m.add(c=hb.C(1, q=1.0), n=hb.Zero(), g=hb.G(0.1), s=hb.One(), r=hb.R(1))
    m.bond("n -> c", "n -> g", "n -> s -> r")
    rules = ["off -> on when sin(5*time) > 0.1", "on -> off when sin(5*time) < -0.2"]
    m.machine("M", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    m.signal(A=hb.Integral("c.e"))
    return m


def test_the_last_segments_are_those_of_a_run_that_keeps_all():
    whole, part = (hb.simulate(rhythm(), 60.0, keep=k) for k in (None, 20))
    assert 20 <= len(part.segments) <= 40 and 20 <= len(part.events) <= 40
    assert part.trace.events.total == len(whole.events)
    last = list(whole.events)[-len(part.events) :]
    assert [(e.t, e.cause, e.steps[-1].mode) for e in part.events] == [
        (e.t, e.cause, e.steps[-1].mode) for e in last
    ]
    assert part.t_begin == part.segments[0].t[0] > 0.0
    t = [part.t_begin, 0.5 * (part.t_begin + 60.0), 60.0]
    assert part["c.q"].at(t) == pytest.approx(whole["c.q"].at(t), rel=1e-12)
    assert part.final == whole.final
    with pytest.raises(hb.UsageError, match="HB-S110"):
        part["c.q"].at(1.0)


def test_a_journal_has_a_row_for_each_event(tmp_path):
    file = tmp_path / "events.csv"
    run = hb.simulate(rhythm(), 30.0, journal=file, keep=5)
    whole = hb.simulate(rhythm(), 30.0)
    with file.open(newline="") as lines:
        head, *rows = csv.reader(lines)
    assert head == ["t", "cause", "M", "c.q", "A"]
    assert len(rows) == run.trace.events.total == len(whole.events)
    for row, event in zip(rows, whole.events, strict=True):
        assert float(row[0]) == event.t and row[1] == event.cause
        assert row[2] == whole.graph.machines[0].states[event.steps[-1].mode[0]]
        assert [float(a) for a in row[3:]] == event.after.tolist()


def test_a_journal_is_written_up_to_an_error(tmp_path):
    m = rhythm()
    m.machine("N", states={"a": [], "b": []}, start="a",
              rules=["a -> b when time > 3", "b -> a when time > 3"])  # fmt: skip
    file = tmp_path / "events.csv"
    run = hb.simulate(m, 10.0, journal=file, on_error="return")
    assert run.error is not None
    assert len(file.read_text().splitlines()) == 1 + len(run.events) > 3


def test_an_interrupted_journal_has_each_event_once(tmp_path):
    def stop(t, events):
        if events > 30:
            raise KeyboardInterrupt

    file = tmp_path / "events.csv"
    run = hb.simulate(rhythm(), 2000.0, journal=file, progress=stop)
    times = [float(line.split(",")[0]) for line in file.read_text().splitlines()[1:]]
    assert run.status == "interrupted"
    assert times == [e.t for e in run.events] and len(times) > 30


def test_the_left_limit_where_the_kept_part_begins_is_not_known():
    run = hb.simulate(rhythm(), 60.0, keep=20)
    assert run["s.f"].at(run.t_begin, side="right") >= 0.0
    with pytest.raises(hb.UsageError, match="HB-S110"):
        run["s.f"].at(run.t_begin, side="left")
    assert run.table(["c.q"])["side"][0] == "right"


def test_a_journal_in_no_folder_is_refused(tmp_path):
    with pytest.raises(hb.UsageError, match="HB-S113"):
        hb.simulate(rhythm(), 1.0, journal=tmp_path / "none" / "events.csv")


@pytest.mark.parametrize(
    "options",
    [
        {"keep": 0},
        {"keep": 2.5},
        {"keep": True},
        {"keep": 3, "solver": "moreau-jean"},
        {"journal": "x.csv", "solver": "moreau-jean"},
    ],
)
def test_what_cannot_be_kept_is_refused(options, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(hb.UsageError, match="HB-S113"):
        hb.simulate(rhythm(), 1.0, step=0.01, **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_memory_does_not_grow_with_the_events():
    done = subprocess.run(
        [sys.executable, "-c", LONG], capture_output=True, text=True, check=True, timeout=300
    )
    (few, before), (many, after) = (map(int, line.split()) for line in done.stdout.splitlines())
    assert many > 60_000 > 20 * few
    assert after - before < 4_000  # KiB


def test_forgetting_keeps_what_is_still_to_be_made():
    made = []
    c = Chronicle(float)
    c.append(0)
    for start in (1, 4):
        c.extend(
            [float(start + k) for k in range(3)], lambda k, s=start: made.append(s + k) or s + k
        )
    c.append(7)
    c.forget(2)
    assert (c.total, c.forgotten, list(c)) == (8, 2, [2, 3, 4, 5, 6, 7])
    assert made == [2, 3, 4, 5, 6] and c.times == [2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    c.forget(100)
    assert (len(c), c.total) == (0, 8)


@pytest.mark.parametrize("solver", ["rk45", "exact"])
def test_a_run_has_as_many_events_as_it_may(solver):
    model = hb.load(EXAMPLES / "half_bridge.toml")
    with pytest.raises(hb.HybondError, match="HB-N404") as caught:
        hb.simulate(model, "20 ms", solver=solver, max_events=100)
    assert len(caught.value.partial.events) == 101
    run = hb.simulate(model, "20 ms", solver=solver, max_events=401)
    assert run.status == "ok" and len(run.events) == 401


def test_times_of_events_come_without_their_records():
    run = hb.simulate(hb.load(EXAMPLES / "half_bridge.toml"), "20 ms")
    times = run.events.t
    assert times.tolist() == [e.t for e in run.events]
    assert run.events[3:5][0].t == times[3]


def test_steps_without_an_event_do_not_fill_the_memory():
    # L/R is 1e-12 s: an explicit method goes on at that pace long after all has died out
    m = hb.Model("stiff", domain="electrical")
    m.add(V=hb.Se("1 V"), i=hb.One(), R=hb.R("1 Gohm"), L=hb.I("1 mH"))
    m.bond("V -> i -> R", "i -> L")
    with pytest.raises(hb.NumericsError) as caught:
        hb.simulate(m, "1 s", solver="rk45", max_steps=3000)
    assert caught.value.code == "HB-N409"
    assert "in the mean" in str(caught.value)
    assert caught.value.partial.stats["steps"] < 10_000
    assert hb.simulate(m, "1 s", solver="radau", max_steps=3000).status == "ok"


def test_a_run_ends_at_its_limit_of_steps_however_long_its_slices_are(monkeypatch):
    # a clock begins a motion anew, and is no event: who looks on counts then, slice by slice
    from hybond.engine.outcome import engine_run

    text = """
hybond = 1
name = "clocked"
domain = "electrical"
[elements]
s = { Se = "k" }
j = { junction = 1 }
r = { R = 1.0 }
c = { C = 1.0 }
[graph]
bonds = ["s -> j", "j -> r", "j -> c"]
[inputs]
k = { pwm = { period = 1e-3, duty = 0.351, high = 1.0, low = 0.0 } }
"""
    ends = set()
    for first in (1, 7, 100, 5000):
        monkeypatch.setattr(engine_run, "FIRST", first)
        with pytest.raises(hb.NumericsError) as caught:
            hb.simulate(hb.loads(text), 1.0, max_steps=170)
        partial = caught.value.partial
        ends.add((caught.value.code, str(caught.value), partial.t_end, partial.stats["steps"]))
    # the 171st step is one too many: two a period
    assert {end[3] for end in ends} == {171.0} and len(ends) == 1
