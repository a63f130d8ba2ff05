"""The files that a run leaves behind."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybond.cli.record import run_record, to_json
from hybond.cli.refusal import refusal_of
from hybond.cli.streams import complain
from hybond.errors import HybondError
from hybond.files.whole import write_whole

if TYPE_CHECKING:
    from hybond.result import Result

TABLES = (".csv", ".npz", ".json")
PICTURES = (".png", ".svg", ".pdf")
LONG = 3000
"""Pieces of a run whose picture takes more than a second or two."""


def write_table(run: Result, path: Path, file: str, names: Sequence[str]) -> None:
    """Write all points of a run, both limits at events.

    As ``.json`` it is the record of ``--json`` with one key more, ``table``.
    """
    columns = list(names) or None
    match path.suffix.lower():
        case ".csv":
            run.to_csv(path, columns)
        case ".npz":
            run.to_npz(path, columns)
        case _:
            record: dict[str, Any] = run_record(run, file)
            record["table"] = {k: v.tolist() for k, v in run.table(columns).items()}
            write_whole(path, to_json(record))


def write_plot(run: Result, path: Path, names: Sequence[str]) -> None:
    """Plot a run with a strip of its modes."""
    os.environ.setdefault("MPLBACKEND", "Agg")  # a terminal may have no screen
    if len(run.segments) > LONG and sys.stderr.isatty():
        complain(f"drawing {len(run.segments)} pieces between events ...")
    run.plot(*names, path=str(path))


def write_all(
    run: Result, table: Path | None, plot: Path | None, file: str, names: Sequence[str]
) -> list[HybondError]:
    """Write what is asked for; return what went wrong, so that one failure leaves the rest."""
    problems = []
    try:
        if table is not None:
            write_table(run, table, file, names)
    except Exception as error:
        problems.append(_placed(error, table))
    try:
        if plot is not None:
            write_plot(run, plot, names)
    except Exception as error:
        problems.append(_placed(error, plot))
    return problems


def _placed(error: Exception, path: Path | None) -> HybondError:
    refusal = refusal_of(error)
    refusal.where = refusal.where or str(path)
    return refusal
