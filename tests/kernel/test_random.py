"""Random models run alike with and without the kernel."""

from __future__ import annotations

import os

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from passive_nets import network
from switched_models import converter, striking

import hybond as hb

MORE = bool(os.environ.get("HYBOND_FUZZ"))
SEEDS = st.integers(0, 10**6)


def some(count):
    """Draw `count` seeds, many more when fuzzing; a smaller seed is no simpler model."""
    return settings(
        max_examples=20 * count if MORE else max(1, count // 2),
        deadline=None,
        phases=(Phase.explicit, Phase.generate),
        suppress_health_check=list(HealthCheck),
    )


def told(run):
    """What happened: causes, modes, guards."""
    return [
        (e.cause, [(s.mode, s.kind, [(f.machine, f.guard) for f in s.fired]) for s in e.steps])
        for e in run.events
    ]


def jumps(run):
    """When what is stored jumped."""
    return [
        round(e.t, 7)
        for e in run.events
        if any(s.impulses for s in e.steps if s.kind != "mythical")
    ]


def apart(a, b):
    """The largest difference of stored quantities away from events, as a part of the largest."""
    end = min(a.t_end, b.t_end)
    if end == 0.0:
        return 0.0
    t = np.linspace(0.0, end, 101)
    near = np.abs(np.subtract.outer(t, [e.t for e in a.events])).min(axis=1)
    names = [s.path for s in a.graph.storages]
    if not names:
        return 0.0
    x, y = (np.array(list(run.sample(t, names).values())) for run in (a, b))
    size = max(np.abs(x).max(), 1e-9)
    return float(np.abs(x - y)[:, near > 1e-5 * end].max(initial=0.0) / size)


def assert_alike(model, until):
    """Compare the engines, unless the reference itself depends on its tolerance."""

    def run(**options):
        return hb.simulate(model, until, on_error="return", **{"rtol": 1e-11, **options})

    a, b = run(kernel=False), run()
    if told(a) != told(b):
        assume(told(run(kernel=False, rtol=4e-12)) == told(a))
        assume(told(run(kernel=False, rtol=2.5e-11)) == told(a))
    assert told(a) == told(b)
    assert (a.status, a.warnings) == (b.status, b.warnings)
    assert (a.error is None) == (b.error is None)
    if a.error is not None:
        assert a.error.code == b.error.code
    for one, other in zip(a.events, b.events, strict=True):
        near = any(0.0 <= s.t - one.t <= 2e-3 * until for s in a.accumulations)
        assert other.t == pytest.approx(one.t, abs=(1e-6 if near else 1e-8) * until)
    if not a.accumulations:
        assert apart(a, b) <= 1e-9
    return b


@pytest.mark.slow
@given(seed=SEEDS)
@some(40)
def test_converters(kernel, seed):
    assert_alike(converter(seed), 2.0)


@pytest.mark.slow
@given(seed=SEEDS)
@some(12)
def test_striking_masses(kernel, seed):
    assert_alike(striking(seed), 6.0)


@pytest.mark.slow
@given(seed=SEEDS, sources=st.booleans())
@some(30)
def test_networks_of_diodes(kernel, seed, sources):
    """Which diode is called conducting while it carries nothing may be rounding, but no more."""
    model = network(seed, sources=sources)
    a, b = (hb.simulate(model, 2.0, rtol=1e-11, kernel=k, on_error="return") for k in (False, True))
    # where only rounding is left, the complementarity problem may have no answer (HB-J110)
    assume(not any(r.error and r.error.code == "HB-J110" for r in (a, b)))
    assert a.status == b.status
    assert apart(a, b) <= 1e-9
    assert jumps(a) == jumps(b)


@pytest.mark.slow
def test_the_kernel_settles_most_of_their_events(kernel):
    runs = [hb.simulate(converter(seed), 2.0, on_error="return") for seed in range(20)]
    runs += [hb.simulate(striking(seed), 6.0) for seed in range(5)]
    assert sum(r.stats["crossed"] for r in runs) > 0.5 * sum(len(r.events) for r in runs)
