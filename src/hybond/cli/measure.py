"""``hybond measure``: simulate, and say what is measured of the run."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from hybond.cli.lists import check_experiment
from hybond.cli.netlists import in_words_of, read_model
from hybond.cli.outputs import PICTURES
from hybond.cli.record import VERSION, to_json
from hybond.cli.running import ending, exit_code, run_with
from hybond.cli.settings import flatten_with
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.errors import HybondError, UsageError
from hybond.measures.asked import Asked, asked_of_experiment, read_measure
from hybond.measures.losses import Losses
from hybond.model.graph import FlatGraph
from hybond.result import Result

_OF_LOSSES = ("power", "depth", "start", "end", "period", "periods", "plot", "sankey")


def measure(given: Namespace) -> int:
    """Simulate; print measurements and losses, or one JSON object."""
    _check(given)
    plot = check_target(given.plot, PICTURES, "--plot")
    sankey = check_target(given.sankey, PICTURES, "--sankey")
    model, conversion = read_model(given.file)
    graph = flatten_with(model, given.settings)
    check_experiment(graph)
    asked = wanted(graph, in_words_of(conversion, given.measures))
    if given.measures:  # told as it was asked for
        asked = [replace(a, text=t.strip()) for a, t in zip(asked, given.measures, strict=True)]
    if not asked and not given.losses:
        raise UsageError(
            "nothing is to be measured",
            code="HB-X101",
            where="hybond measure",
            hint="'mean(L.f)', --losses, or [experiment] measure in the file; --list has them all",
        )
    run = run_with(model, graph, given)
    values, problems = measures_record(run, asked)
    table = _losses(run, given, problems) if given.losses else None
    if plot is not None:
        run.plot_losses(str(plot), depth=given.depth)
    if sankey is not None and table is not None:
        from hybond.draw.sankey import draw_sankey

        draw_sankey(table, title=run.title, path=sankey)
    if given.json:
        record: dict[str, Any] = {
            "hybond": VERSION,
            "model": graph.name,
            "title": run.title,
            "file": given.file,
            "status": run.status,
            "t_end": run.t_end,
            "measures": values,
            "warnings": list(run.warnings),
        }
        if table is not None:
            record["losses"] = table.to_dict()
        if run.error is not None:
            record["error"] = run.error.to_dict()
        text = to_json(record)
        given.json = False  # what fails from here on must not put a second object there
        sys.stdout.write(text)
    else:
        say(run.title)
        if run.status != "ok":
            say(ending(run))
        say()
        problems = [*print_measures(run, asked), *(p for p in problems if p.where == "losses")]
        if table is not None:
            say(str(table))
            share = abs(table.unbalanced) / table.through if table.through else 0.0
            say(f"balanced to {share:.1g} of what passed")
    for warning in run.warnings:
        complain(f"warning: {warning}")
    for refusal in (run.error, *problems):
        if refusal is not None:
            complain(str(refusal))
    return exit_code(run) or (problems[0].exit_code if problems else 0)


def wanted(graph: FlatGraph, texts: Sequence[str]) -> list[Asked]:
    """Return what is to be measured: what is given, or what the experiment asks for.

    Raises
    ------
    UsageError
        HB-R120, HB-R121, HB-S109.
    """
    if not texts:
        return asked_of_experiment(graph)
    found = [read_measure(text, where="hybond measure") for text in texts]
    for one in found:
        try:
            one.check(graph)
        except UsageError as error:
            if error.code == "HB-R101":  # there may be several: it is told which
                error.where = one.text
            raise
    return found


def measures_record(
    run: Result, asked: Sequence[Asked]
) -> tuple[dict[str, Any], list[HybondError]]:
    """Return measurements as plain data, and the refusals of those that there are not."""
    values: dict[str, Any] = {}
    problems: list[HybondError] = []
    for one in asked:
        try:
            values[one.text] = one.of(run).to_dict()
        except HybondError as error:
            values[one.text] = {"value": None, "error": error.to_dict()}
            problems.append(error)
    return values, problems


def print_measures(run: Result, asked: Sequence[Asked]) -> list[HybondError]:
    """Print measurements, one a line; return the refusals of those that there are not."""
    rows: list[tuple[str, ...]] = []
    problems: list[HybondError] = []
    for one in asked:
        try:
            found = one.of(run)
        except HybondError as error:
            rows.append((f"  {one.text}", f"= nothing: {error.why}"))
            problems.append(error)
            continue
        at = f"at t = {found.t:.9g} s {found.side}".rstrip() if found.t is not None else ""
        rows.append((f"  {one.text}", f"= {found}", ", ".join(filter(None, (at, found.how)))))
    wide = max((len(r[0]) for r in rows), default=0)
    middle = max((len(r[1]) for r in rows if len(r) > 2), default=0)
    for row in rows:
        line = f"{row[0]:{wide}} {row[1]:{middle}}" + (f"  {row[2]}" if len(row) > 2 else "")
        say(line.rstrip())
    if rows:
        say()
    return problems


def _losses(run: Result, given: Namespace, problems: list[HybondError]) -> Losses | None:
    try:
        found = run.losses(
            start=given.start,
            end=given.end,
            period=given.period,
            periods=given.periods,
            depth=given.depth,
        )
    except HybondError as error:
        error.where = "losses"
        problems.append(error)
        return None
    return found.mean_power() if given.power else found


def _check(given: Namespace) -> None:
    for name in _OF_LOSSES:
        if getattr(given, name) not in (None, False) and not given.losses:
            raise UsageError(
                f"--{name} is of --losses; a measurement has its window in its parentheses",
                code="HB-X101",
                where="hybond measure",
                hint="give --losses too, or write 'mean(L.f, period=20 us)'",
            )
    if given.depth is not None and given.depth < 1:
        raise UsageError(
            f"--depth {given.depth}", code="HB-X101", where="--depth", hint="1 or more"
        )
