"""The program: runs a model and prints what is asked for."""

from __future__ import annotations

from hybond.engine.engine import REFUSED, Engine
from hybond.engine.run.motion import ACCUMULATES, run_to_end
from hybond.engine.run.report import (
    Report,
    put_fault,
    put_final,
    put_header,
    put_stuck,
    put_unsound,
)
from hybond.engine.run.run_records import Run, make_run


def run_program(e: Engine, report: Report) -> int:
    """Run from the start; return the exit code: 0 fine, 3 the numerics or not the end.

    What was computed is printed first.
    """
    run: Run = make_run(e, report)
    put_header(e, report)
    status = run_to_end(e, run)
    put_final(e, report)
    if status == REFUSED:
        put_fault(e)
        return 3
    if e.checks.violated > 0:
        put_unsound(e)
        return 3
    if status == ACCUMULATES:
        put_stuck(e)
        return 3
    return 0
