"""Runs of the same model by two engines, held against each other."""

from __future__ import annotations

import numpy as np
import pytest


def events(run):
    """What happened, without when."""
    return [(e.cause, [(s.mode, s.kind) for s in e.steps]) for e in run.events]


def assert_same_events(a, b):
    """The same events at the same times; before an accumulation times drift apart."""
    assert events(a) == events(b)
    span = a.t_end
    for one, other in zip(a.events, b.events, strict=True):
        # before an accumulation each impact inherits the errors of all before, and time runs short
        near = any(0.0 <= s.t - one.t <= 2e-3 * span for s in a.accumulations)
        assert other.t == pytest.approx(one.t, abs=(1e-6 if near else 1e-9) * span)


def assert_same_states(a, b, rel):
    """What is stored is the same but at instants at which it may jump.

    To a part of its own size, or of 1e-4 of the largest of its kind: what is smaller is made of
    differences.
    """
    span = min(a.t_end, b.t_end)
    t = np.linspace(0.0, span, 101)
    near = np.array([min((abs(e.t - u) for e in a.events), default=span) for u in t])
    clear = near > 1e-5 * span
    runs = [
        {s.path: np.asarray(r[s.path].at(t.tolist())) for s in r.graph.storages} for r in (a, b)
    ]
    kind = {s.path: (a.graph.bonds[s.bond].domain.name, s.kind) for s in a.graph.storages}
    largest: dict[tuple[str, str], float] = {}
    for path, x in runs[0].items():
        size = float(np.abs(x).max())
        largest[kind[path]] = max(largest.get(kind[path], 1e-300), size)
    for path, x in runs[0].items():
        size = max(float(np.abs(x).max()), 1e-4 * largest[kind[path]])
        off = np.abs(x - runs[1][path])[clear].max(initial=0.0)
        assert off <= rel * size, (path, off, size)
