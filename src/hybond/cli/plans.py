"""``hybond sweep --collect``: a plan of many runs, whose rows are collected in a folder."""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path
from typing import Any

import numpy as np

from hybond.cli.lists import check_experiment, run_until, scaled, split
from hybond.cli.netlists import in_words_of, read_model, steps_of
from hybond.cli.outputs import TABLES
from hybond.cli.record import VERSION, to_json
from hybond.cli.running import tell_no_script
from hybond.cli.settings import changed_with
from hybond.cli.shared_words import options_given
from hybond.cli.streams import complain, say
from hybond.errors import NumericsError, UsageError
from hybond.names import in_columns
from hybond.progress import MembersDone
from hybond.sweep.plan import Plan
from hybond.sweep.sweeping import sweep
from hybond.sweep.table import SweepTable

TOLD = 5
"""Kinds of failures that are told, and notes."""


def plan_sweep(given: Namespace) -> int:
    """Run a plan; print what came of it, or one JSON object."""
    _check(given)
    read, conversion = read_model(given.file)
    tell_no_script(read, "members are run")
    vary = given.vary or steps_of(conversion)
    model, fixed = changed_with(read, given.settings)
    graph = model.flatten(parameters=fixed)
    check_experiment(graph)
    plan = Plan(
        factors_of(vary), sample=given.sample, seed=given.seed or 0, together=given.together
    )
    until = run_until(graph, given.until)[0]
    asked: dict[str, Any] = {
        "collect": in_words_of(conversion, given.collect) or None,
        **{"until": until, "parameters": fixed, "out": given.out},
        **{"runs": given.runs or "", "workers": given.workers, **options_given(given, "fmus")},
    }
    if given.estimate:
        from hybond.sweep.estimating import estimate

        found = estimate(model, plan, **asked)
        if given.json:
            own = {name: getattr(found, name) for name in found.__slots__}
            sys.stdout.write(to_json({"hybond": VERSION, "file": given.file, **own}))
        else:
            say(str(found))
        return 0
    with MembersDone(len(plan)) as bar:
        table = sweep(model, plan, executor=given.cluster, part=given.part, progress=bar, **asked)
    counts = table.counts()
    if given.json:
        sys.stdout.write(to_json({**plan_record(table, counts), "file": given.file}))
    else:
        _print(table, counts)
    return _told(table, counts)


def factors_of(vary: list[str]) -> dict[str, str]:
    """Return paths and values of ``path=values``.

    Raises
    ------
    UsageError
        HB-X103.

    Examples
    --------
    >>> factors_of(["mu=0.2:0.3:0.005", "c.C = log(1e-4, 1e-2, 50)"])
    {'mu': '0.2:0.3:0.005', 'c.C': 'log(1e-4, 1e-2, 50)'}
    >>> factors_of(["R=1k, 2.2k"])
    {'R': '1e3, 2.2e3'}
    """
    found: dict[str, str] = {}
    for text in vary:
        path, equals, values = (word.strip() for word in text.partition("="))
        if not equals or not path or not values or path in found:
            raise UsageError(
                f"{path!r} is varied twice" if path in found else f"{text!r} varies nothing",
                code="HB-X103",
                where="--vary",
                hint="--vary mu=0.2:0.3:0.005, each path once",
            )
        found[path] = ", ".join(scaled(word) for word in split([values]))
    if not found:
        raise UsageError(
            "nothing is varied",
            code="HB-X103",
            where="--vary",
            hint="--vary mu=0.2:0.3:0.005 or --vary 'mu=normal(0.2, 0.01)'",
        )
    return found


def _check(given: Namespace) -> None:
    why = hint = ""
    if not given.collect:
        why, hint = "nothing is collected", "--collect 'final(ball.p), count(events)'"
    elif given.signals:
        why, hint = "--signals and --collect", "--collect 'final(NAME)'"
    elif given.out and Path(given.out).suffix.lower() in TABLES:
        why = f"--collect writes a folder, not {given.out!r}"
        hint = f"--out {Path(given.out).stem}"
    if why:
        raise UsageError(why, code="HB-X101", where="hybond sweep", hint=hint)


def plan_record(table: SweepTable, counts: dict[str, int]) -> dict[str, Any]:
    """Return what a sweep has come to, as plain data."""
    return {
        "hybond": VERSION,
        "model": table.job.model.name,
        "title": table.title,
        "until": table.job.until,
        "members": len(table.plan),
        "done": len(table),
        "plan": table.plan.to_dict(),
        "counts": counts,
        "collected": {
            name: {"least": a, "mean": b, "most": c, "none": d, "unit": table.unit(name)}
            for name, (a, b, c, d) in _spans(table).items()
        },
        "folder": None if table.folder is None else str(table.folder),
        "notes": list(table.notes),
        "interrupted": table.interrupted,
        "seconds": table.seconds,
        "how": table.how,
    }


def _spans(table: SweepTable) -> dict[str, tuple[float, float, float, int]]:
    """Return of each number least, mean, most, and how many members have none."""
    names = [c.text for c in table.collectors if c.kind in ("number", "whole")]
    least, most = dict.fromkeys(names, np.inf), dict.fromkeys(names, -np.inf)
    total, there = dict.fromkeys(names, 0.0), dict.fromkeys(names, 0)
    for part in table.parts():
        for name in names:
            values = part.columns[name]
            values = values[np.isfinite(values)]
            if len(values):
                least[name] = min(least[name], float(values.min()))
                most[name] = max(most[name], float(values.max()))
                total[name] += float(values.sum())
                there[name] += len(values)
    return {
        n: (least[n], total[n] / there[n], most[n], len(table) - there[n])
        for n in names
        if there[n]
    }


def _print(table: SweepTable, counts: dict[str, int]) -> None:
    say(table.title)
    say()
    done = "" if len(table) == len(table.plan) else f", {len(table)} done"
    say(f"{len(table.plan)} members{done}, {table.plan.way} of {', '.join(table.plan.paths)}")
    for kind, many in counts.items():
        say(f"  {many} {kind}")
    rows = [["", "least", "mean", "most"]]
    for name, (a, b, c, none) in _spans(table).items():
        unit = f" [{table.unit(name)}]" if table.unit(name) else ""
        rows.append([name + unit, *(f"{x:.6g}" for x in (a, b, c))])
        if none:
            rows[-1].append(f"{none} without")
    if len(rows) > 1:
        say()
        say("\n".join(in_columns(rows)))
    say()
    if table.folder is not None and not table.interrupted:
        say(f"{table.folder / 'table.csv'} has a row for each member")
    say(f"{table.how}, {table.seconds:.3g} s")


def _told(table: SweepTable, counts: dict[str, int]) -> int:
    """Say what went wrong, of many members the first; return the exit code."""
    for text in table.notes[:TOLD]:
        complain(text)
    if len(table.notes) > TOLD:
        complain(f"... and {len(table.notes) - TOLD} more notes")
    seen: dict[str, str] = {}
    warned = 0
    for part in table.parts():
        for k, (code, place, why, warning) in part.said.items():
            warned += bool(warning)
            if code:
                at = f" at {place}" if place else ""
                seen.setdefault(code, f"member {part.first + k}: {code}{at}: {why}")
    for text in list(seen.values())[:TOLD]:
        complain(text)
    if warned:
        complain(f"{warned} members warn: see the column warnings")
    if table.interrupted:
        done = f"{len(table)} of {len(table.plan)} members"
        if table.folder is None:
            complain(f"interrupted after {done}; with --out they would be kept")
        else:
            complain(f"interrupted: {done} are in {table.folder}; the same command goes on there")
        return 130
    codes = [2 if code[3:4] in "MUCEF" else 1 if code[3:4] in "RS" else 3 for code in seen]
    codes += [NumericsError.exit_code for kind in counts if kind.startswith("accumulation")]
    return max(codes, default=0)
