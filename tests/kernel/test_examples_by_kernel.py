"""Every other example run by the kernel is that of the reference, by each method that both have."""

from __future__ import annotations

import pytest
from engines import assert_same_events, assert_same_states
from example_runs import NAMES, RTOL, example

import hybond as hb

IDLE = ("cockcroft_walton", "mmc_arm", "parallel_resonant_converter")
"""Where rounding says which diode is called conducting while it carries nothing: the states are the
same, events that change nothing else are not."""
LINEAR = ["boost", "buck", "capacitors_joined", "diode_bridge", "half_bridge"]
"""Examples with events, and modes that are propagated exactly."""
STIFF = ["bouncing_ball", "capacitors_joined", "diode_inductor", "half_bridge", "newtons_cradle"]


def assert_the_same(kernel: hb.Result, name: str, **options: str) -> None:
    reference = hb.simulate(example(name), rtol=RTOL, kernel=False, on_error="return", **options)
    assert reference.kernel == "not used: the reference was asked for" and kernel.kernel
    assert kernel.status == reference.status
    assert kernel.t_end == pytest.approx(reference.t_end, rel=1e-9)
    if name not in IDLE:
        assert_same_events(reference, kernel)
    assert_same_states(reference, kernel, 1e-9)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", NAMES[::2])
def test_with_and_without_the_kernel(kernel, name):
    own = hb.simulate(example(name), rtol=RTOL, kernel=True, on_error="return")
    assert_the_same(own, name)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "solver"), [(n, "exact") for n in LINEAR] + [(n, "radau") for n in STIFF]
)
def test_by_other_methods(kernel, name, solver):
    run = hb.simulate(example(name), rtol=RTOL, solver=solver, on_error="return")
    assert run.stats["marched"] > 0
    assert_the_same(run, name, solver=solver)
