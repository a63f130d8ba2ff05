"""``hybond sweep``: simulate a model with many values of its parameters."""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path
from typing import Any

from hybond.cli.lists import check_experiment, check_signals, run_until, split
from hybond.cli.netlists import in_words_of, read_model
from hybond.cli.record import VERSION, to_json
from hybond.cli.refusal import refusal_of
from hybond.cli.run_words import options_given
from hybond.cli.settings import changed_with
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.cli.vary import columns
from hybond.errors import HybondError, NumericsError
from hybond.files.whole import write_whole
from hybond.names import in_columns
from hybond.progress import MembersDone
from hybond.sweep.collection import Ensemble
from hybond.sweep.ensemble import ensemble

TABLES = (".csv", ".npz", ".json")
FIRST, LAST = 40, 10
"""Members printed of a sweep that has many more."""
TOLD = 3
"""Refusals of members that are told in full."""


def sweep(given: Namespace) -> int:
    """Simulate all members; print a table, or one JSON object; write the file asked for."""
    target = check_target(given.out, TABLES, "--out")
    read, conversion = read_model(given.file)
    vary = given.vary
    if not vary and conversion is not None:  # the netlist says itself what varies
        vary = [f"{k}={','.join(map(repr, values))}" for k, values in conversion.steps]
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
    problems = _written(many, target, given.file)
    if given.json:
        text = to_json(sweep_record(many, given.file))
        given.json = False  # what fails from here on must not put a second object there
        sys.stdout.write(text)
    else:
        _print(many)
    return _told(many, problems)


def sweep_record(many: Ensemble, file: str) -> dict[str, Any]:
    """Return everything about a sweep as plain data in SI, lists over members."""
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
        "units": dict(many.units),
        "errors": [{"member": k, **e.to_dict()} for k, e in many.errors.items()],
        "warnings": [{"member": k, "warnings": list(w)} for k, w in many.warnings.items()],
        "seconds": many.seconds,
        "how": many.how,
    }


def _written(many: Ensemble, target: Path | None, file: str) -> list[HybondError]:
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
                write_whole(target, to_json(sweep_record(many, file)))
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
