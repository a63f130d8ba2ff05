"""``hybond sweep``: simulate a model with many values of its parameters."""

from __future__ import annotations

import math
import sys
from argparse import Namespace
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.cli.lists import check_experiment, check_signals, run_until, split
from hybond.cli.netlists import aside_of, in_words_of, read_model, steps_of
from hybond.cli.record import VERSION, to_json
from hybond.cli.refusal import refusal_of
from hybond.cli.running import tell_no_script
from hybond.cli.settings import changed_with
from hybond.cli.shared_words import options_given
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.cli.vary import columns
from hybond.errors import HybondError, NumericsError
from hybond.files.whole import write_whole
from hybond.names import in_columns
from hybond.progress import MembersDone
from hybond.sweep.collection import Ensemble
from hybond.sweep.ensemble import ensemble

if TYPE_CHECKING:
    from hybond.circuits.circuit import Conversion

TABLES = (".csv", ".npz", ".json")
FIRST, LAST = 40, 10
"""Members printed of a sweep that has many more."""
TOLD = 3
"""Refusals of members that are told in full."""


def sweep(given: Namespace) -> int:
    """Simulate all members; print a table, or one JSON object; write the file asked for."""
    target = check_target(given.out, TABLES, "--out")
    read, conversion = read_model(given.file)
    tell_no_script(read, "members are run")
    vary = given.vary or steps_of(conversion)
    varied = columns(vary, together=given.together)
    model, fixed = changed_with(read, given.settings)
    graph = model.flatten(parameters=fixed)
    check_experiment(graph)
    until = run_until(graph, given.until)[0]
    named = in_words_of(conversion, split(given.signals or []))
    signals = check_signals(graph, named, "--signals")
    count = len(next(iter(varied.values())))
    same: dict[str, list[Any]] = {k: [v] * count for k, v in fixed.items() if k not in varied}
    with MembersDone(count) as bar:
        many = ensemble(
            model,
            until,
            sets={**varied, **same},
            outputs=signals or None,
            workers=given.workers,
            progress=bar,
            **options_given(given, "fmus"),
        )
    measured: dict[str, NDArray[np.float64]] = {}
    if conversion is not None and conversion.measures:
        many, measured = _with_measurements(many, conversion)
    shown = replace(many, final={**many.final, **measured}) if measured else many
    record = partial(sweep_record, many, given.file, measured)
    problems = _written(shown, target, record)
    if given.json:
        text = to_json(record())
        given.json = False  # what fails from here on must not put a second object there
        sys.stdout.write(text)
    else:
        _print(shown)
    return _told(many, problems)


def _with_measurements(
    many: Ensemble, conversion: Conversion
) -> tuple[Ensemble, dict[str, NDArray[np.float64]]]:
    """Return a sweep without the signals that ``.meas`` reads, and its measurements by column.

    Members are run again for these, as ordinary runs. What is measured is no output: where a run
    ends it has a value that is not the measurement.
    """
    from hybond.circuits.measured import measure

    found = {one.name: np.full(len(many), math.nan) for one in conversion.measures}
    with MembersDone(len(many)) as bar:
        for k in np.flatnonzero(np.isin(many.status, ("ok", "accumulation"))).tolist():
            values = measure(many.run(k), conversion.measures)
            for name, value in values.items():
                found[name][k] = math.nan if value is None else value
            bar(k + 1, len(many))
    aside = aside_of(conversion)
    final = {k: column for k, column in many.final.items() if k not in aside}
    taken = {*final, *many.parameters, "member", "status", "t_end", "events"}
    named = {f"meas_{k}" if k in taken else k: column for k, column in found.items()}
    return replace(many, final=final), named


def sweep_record(
    many: Ensemble, file: str, measured: Mapping[str, NDArray[np.float64]] | None = None
) -> dict[str, Any]:
    """Return everything about a sweep as plain data in SI, lists over members."""
    measurements = {name: column.tolist() for name, column in (measured or {}).items()}
    return {
        "hybond": VERSION,
        "model": many.model.name,
        "title": many.title,
        "file": file,
        "until": many.until,
        "members": len(many),
        "parameters": {path: column.tolist() for path, column in many.parameters.items()},
        "status": many.status.tolist(),
        "t_end": many.t_end.tolist(),
        "events": many.counts.tolist(),
        "final": {name: column.tolist() for name, column in many.final.items()},
        **({"measurements": measurements} if measurements else {}),
        "units": {name: unit for name, unit in many.units.items() if name in many.final},
        "errors": [{"member": k, **e.to_dict()} for k, e in many.errors.items()],
        "warnings": [{"member": k, "warnings": list(w)} for k, w in many.warnings.items()],
        "seconds": many.seconds,
        "how": many.how,
    }


def _written(
    many: Ensemble, target: Path | None, record: Callable[[], dict[str, Any]]
) -> list[HybondError]:
    """Write the table; return what went wrong, so that what is printed is not lost."""
    if target is None:
        return []
    try:
        match target.suffix.lower():
            case ".csv":
                many.to_csv(target)
            case ".npz":
                many.to_npz(target)
            case _:
                write_whole(target, to_json(record()))
    except Exception as error:
        refusal = refusal_of(error)
        refusal.where = refusal.where or str(target)
        return [refusal]
    return []


def _print(many: Ensemble) -> None:
    say(many.title)
    say()
    table = {name: column.tolist() for name, column in many.table().items()}
    units = {name: many.units.get(name) for name in table} | {"t_end": "s"}
    rows = [[f"{name} [{units[name]}]" if units[name] else name for name in table]]
    rows += [[_cell(value) for value in row] for row in zip(*table.values(), strict=True)]
    left = len(many) - FIRST - LAST
    if left >= LAST:
        say(_aligned([*rows[: 1 + FIRST], *rows[-LAST:]], 1 + FIRST, f"... {left} more members"))
    else:
        say(_aligned(rows, len(rows), ""))
    say()
    say(f"{many.how}, {many.seconds:.3g} s")


def _cell(value: Any) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _aligned(rows: list[list[str]], gap: int, words: str) -> str:
    lines = in_columns(rows, str.rjust)
    return "\n".join([*lines[:gap], *([words] if words else []), *lines[gap:]])


def _told(many: Ensemble, problems: list[HybondError]) -> int:
    """Say what went wrong, of many members the first; return the exit code."""
    for k, warnings in list(many.warnings.items())[:TOLD]:
        complain(f"warning: member {k}: {'; '.join(warnings)}")
    failures = list(many.errors.items())
    for k, error in failures[:TOLD]:
        complain(f"member {k}: {error}")
    if len(failures) > TOLD:
        complain(f"... and {len(failures) - TOLD} more members with errors")
    for refusal in problems:
        complain(str(refusal))
    if many.interrupted:
        complain("interrupted")
        return 130
    codes = [e.exit_code for _, e in failures] + [p.exit_code for p in problems]
    codes += [NumericsError.exit_code for status in many.status if status == "accumulation"]
    return max(codes, default=0)
