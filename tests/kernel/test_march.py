"""Runs with the kernel are those of the reference."""

from pathlib import Path

import numpy as np
import pytest

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
FILES = sorted(f.stem for f in EXAMPLES.glob("*.toml"))
IDLE = ("cockcroft_walton", "mmc_arm", "parallel_resonant_converter")
"""Where rounding says which diode is called conducting while it carries nothing: the states are the
same, events that change nothing else are not."""


def both(model, **options):
    return [hb.simulate(model, kernel=k, on_error="return", **options) for k in (False, True)]


def events(run):
    return [(e.cause, [(s.mode, s.kind) for s in e.steps]) for e in run.events]


def assert_same_events(a, b):
    assert events(a) == events(b)
    span = a.t_end
    for one, other in zip(a.events, b.events, strict=True):
        # before an accumulation each impact inherits the errors of all before, and time runs short
        near = any(0.0 <= s.t - one.t <= 2e-3 * span for s in a.accumulations)
        assert other.t == pytest.approx(one.t, abs=(1e-6 if near else 1e-9) * span)


def assert_same_states(a, b, rel):
    span = min(a.t_end, b.t_end)
    t = np.linspace(0.0, span, 101)
    near = np.array([min((abs(e.t - u) for e in a.events), default=span) for u in t])
    clear = near > 1e-5 * span
    for s in a.graph.storages:
        x, y = (np.asarray(run[s.path].at(t.tolist())) for run in (a, b))
        size = max(float(np.abs(x).max()), 1e-300)
        assert np.abs(x - y)[clear].max(initial=0.0) <= rel * size, s.path


@pytest.mark.parametrize("name", FILES)
def test_examples_are_the_same_with_and_without_the_kernel(kernel, name):
    a, b = both(hb.load(EXAMPLES / f"{name}.toml"), rtol=1e-11)
    assert (a.status, a.t_end) == (b.status, pytest.approx(b.t_end, rel=1e-9))
    assert b.kernel and a.kernel == "not used: the reference was asked for"
    if name not in IDLE:
        assert_same_events(a, b)
    assert_same_states(a, b, 1e-9)
