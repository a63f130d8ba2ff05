"""Runs of the examples, made once for all tests that look at them."""

from __future__ import annotations

import functools
from pathlib import Path

import hybond as hb

EXAMPLES = Path(__file__).parents[1] / "examples"
NAMES = sorted(p.stem for p in EXAMPLES.glob("*.toml"))
STOPPED = {"bouncing_ball_no_mode", "diode_inductor_no_mode", "falling_rod_threshold"}
"""Examples that end in HB-N401, as they are meant to."""
RTOL = 1e-11
SHARE_RUNS = (
    "cases/test_audit_of_examples.py",
    "export/test_examples_as_programs.py",
    "export/test_units_of_examples.py",
    "kernel/test_examples_by_kernel.py",
)
"""Files of tests that one worker runs."""


def example(name: str) -> hb.Model:
    """Return an example as its file has it."""
    return hb.load(EXAMPLES / f"{name}.toml")


def integrated(name: str) -> dict[str, str]:
    """Return the method of a run of what is printed: it integrates what hybond propagates."""
    return {"solver": "rk45"} if example(name).experiment.get("solver") == "exact" else {}


@functools.cache
def run_of(name: str) -> hb.Result:
    """Run an example at a tight tolerance, as users do."""
    return hb.simulate(example(name), rtol=RTOL, on_error="return")


@functools.cache
def integrated_run_of(name: str) -> hb.Result:
    """Run an example by a method that printed programs have."""
    method = integrated(name)
    if not method:
        return run_of(name)
    return hb.simulate(example(name), rtol=RTOL, on_error="return", **method)
