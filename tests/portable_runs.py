"""A run of the engine as Python in this process, and one by the library to hold it against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import hybond as hb
from hybond.engine.compiled.answering import Calls
from hybond.engine.engine import REFUSED, Engine, make_engine
from hybond.engine.run import motion, run_records
from hybond.engine.run.log import make_report
from hybond.engine.tables import answered, tables_of
from hybond.model.planar_friction import kept_paths

CAUSES = ["start", "guard", "time", "input", "accumulation", "step", "sample"]
KINDS = ["mythical", "pinnacle", "continuous"]


@dataclass
class PortableRun:
    """What happened: instants with cause and transitions, the end, and its state."""

    events: list
    t: float
    y: np.ndarray
    code: str
    engine: Engine


def portable(model, monkeypatch, **options) -> PortableRun:
    """Run a model in the engine, as Python."""
    tables = tables_of(model.flatten(), calling=True, **options)
    m = answered(tables)
    e = make_engine(m)
    if m.called or m.blocks:
        e.calls.answers = Calls(tables)
    events = []

    def note(engine, report, i):
        steps = []
        for step in range(i.steps):
            fired = []
            for f in range(i.first.at[step], i.first.at[step + 1]):
                k = i.machine.at[f]
                first = m.state_first[k]
                names = [tables.states[first + a.at[f]] for a in (i.source, i.target)]
                fired.append((tables.machines[k], *names))
            steps.append((KINDS[i.kind.at[step]], sorted(fired)))
        events.append((i.t, CAUSES[i.cause], steps))

    monkeypatch.setattr(motion, "report_event", note)
    status = motion.run_to_end(e, run_records.make_run(e, make_report(e)))
    return PortableRun(events, e.t, np.array(e.y), e.fault.code if status == REFUSED else "", e)


def transitions(run) -> list:
    """Return the events of a run in the same form."""
    return [
        (
            event.t,
            event.cause,
            [
                (s.kind, sorted((f.machine, f.source, f.target) for f in s.fired))
                for s in event.steps
            ],
        )
        for event in run.events
    ]


def assert_the_same(model, monkeypatch, *, events=True, rel=1e-9, **options):
    """Hold a run of the engine as Python against one by the library; return both."""
    a = hb.simulate(model, on_error="return", **options)
    b = portable(model, monkeypatch, **options)
    span = max(a.t_end, 1e-300)
    if events:
        expected = transitions(a)
        assert [e[1:] for e in b.events] == [e[1:] for e in expected]
        for one, other in zip(b.events, expected, strict=True):
            assert one[0] == pytest.approx(other[0], abs=1e-9 * span)
    assert b.t == pytest.approx(a.t_end, rel=1e-9)
    assert b.code == (a.error.code if a.error is not None else "")
    segments = a.trace.segments
    n = len(b.y)
    final = np.asarray(segments[-1].y)[-1][:n]
    if a.trace.events and a.trace.events[-1].t == a.t_end:
        final = np.asarray(a.trace.events[-1].after)
    size = np.max([np.abs(np.asarray(s.y)[:, :n]).max(axis=0) for s in segments], axis=0)
    size = np.maximum(size, 1e-4 * size.max(initial=1e-300))
    own = kept_paths(a.graph)  # what friction in the plane keeps for itself is no result
    nx = len(a.graph.storages)
    shown = np.array([k < nx or a.graph.integrals[k - nx].path not in own for k in range(n)])
    b.y, final, size = b.y[shown], final[shown], size[shown]
    assert (np.abs(b.y - final) <= rel * size).all(), (b.y, final)
    return a, b
