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
INTEGRATED = {"rtol": RTOL}
"""Options of runs that are held against printed programs."""
SHARE_RUNS = (
    "cases/test_audit_of_examples.py",
    "engine/test_native_runs.py",
    "export/test_examples_as_programs.py",
    "export/test_units_of_examples.py",
)
"""Files of tests that one worker runs."""


PRINTED = {"c": NAMES[::3], "java": NAMES[1::3], "fmu": NAMES[2::3]}
"""Each example is printed, compiled and run in one of these; all are run by the library, which is
the same engine."""


def example(name: str) -> hb.Model:
    """Return an example as its file has it."""
    return hb.load(EXAMPLES / f"{name}.toml")


@functools.cache
def run_of(name: str) -> hb.Result:
    """Run an example at a tight tolerance, as users do."""
    return hb.simulate(example(name), rtol=RTOL, on_error="return")
