"""``hybond run``: simulate a model and say what happened."""

from __future__ import annotations

import math
import sys
from argparse import Namespace
from collections.abc import Container, Sequence

from hybond.cli.lists import check_experiment, check_signals, run_until, sample_times, split
from hybond.cli.measure import measures_record, print_measures
from hybond.cli.netlists import (
    aside_of,
    in_words_of,
    measurements,
    notes,
    print_measurements,
    read_model,
)
from hybond.cli.outputs import PICTURES, TABLES, write_all
from hybond.cli.record import run_record, sampled, to_json, units_of
from hybond.cli.running import ending, exit_code, has_script, run_with
from hybond.cli.settings import flatten_with
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.engine.outcome.step_error import GOOD
from hybond.errors import HybondError
from hybond.measures.asked import asked_of_experiment
from hybond.names import in_columns, plural
from hybond.report import EventTable
from hybond.result import Result
from hybond.units import format_quantity

FIRST, LAST = 12, 4
"""Events printed of a run that has many more."""


def run(given: Namespace) -> int:
    """Simulate; print the run, or one JSON object; write the files asked for."""
    table = check_target(given.out, TABLES, "--out")
    plot = check_target(given.plot, PICTURES, "--plot")
    check_target(given.journal, (".csv",), "--journal")
    saved = check_target(given.save_state, (".json",), "--save-state")
    model, conversion = read_model(given.file, given.diode_current)
    graph = flatten_with(model, given.settings)
    check_experiment(graph)
    end = math.inf if has_script(graph, given) else run_until(graph, given.until)[1]
    times = sample_times(given.at or [], end)
    named = in_words_of(conversion, split(given.signals or []))
    signals = check_signals(graph, named, "--signals")

    result = run_with(model, graph, given)
    asked = asked_of_experiment(graph)
    measured = measurements(result, conversion)
    suggested = notes(result, conversion)

    aside = aside_of(conversion)
    problems = write_all(result, table, plot, given.file, signals)
    if saved is not None and result.error is None:
        result.state().save(saved)
    names = signals or (default_names(result) if times else [])
    if given.json:
        said = [f"{p.code} at {p.where}: {p.why}" for p in problems]
        record = run_record(result, given.file, times, names, [*suggested, *said])
        record["final"] = {k: v for k, v in record["final"].items() if k not in aside}
        if conversion is not None:
            record["measurements"] = measured
        if asked:
            record["measures"], refused = measures_record(result, asked)
            problems += refused
        text = to_json(record)
        given.json = False  # what fails from here on must not put a second object there
        sys.stdout.write(text)
    else:
        _print(result, times, names, aside)
        print_measurements(measured)
        problems += print_measures(result, asked)
        for note in suggested:
            say(f"note: {note}")
    for refusal in (result.error, *problems):
        if refusal is not None:
            complain(str(refusal))
    return exit_code(result) or (problems[0].exit_code if problems else 0)


def default_names(run: Result) -> list[str]:
    """Return the signals that the experiment lists, or all that have a name."""
    listed = [str(n) for key in ("plot", "outputs") for n in run.graph.experiment.get(key, ())]
    return list(dict.fromkeys(listed)) or run.names


def _print(
    run: Result, times: Sequence[float], names: Sequence[str], aside: Container[str] = ()
) -> None:
    record = run_record(run, "", times, events=False)
    say(run.title)
    say()
    _events(run)
    if times:
        say()
        say(_table(run, times, names))
    say()
    for step in getattr(run, "steps", ()):
        say(f"  {step.t0:.9g} .. {step.t1:.9g} s  {step.label or 'step'}: {step.ended_by}")
    say(ending(run))
    final = {name: value for name, value in record["final"].items() if name not in aside}
    units = record["units"]
    width = max(map(len, final), default=0)
    for name, value in final.items():
        say(f"  {name:{width}}  {format_quantity(value, units[name] or '1')}")
    say()
    for warning in record["warnings"]:
        say(f"warning: {warning}")
    say(stats_line(run))
    for line in filter(None, (run.method, f"made by {run.engine}" if run.engine else "")):
        say(line)
    if "step_error" in run.stats:
        say(step_line(run))


def _events(run: Result) -> None:
    """Print the events; of many the first and the last."""
    events = run.events
    left = len(events) - FIRST - LAST
    if left < LAST:
        say(str(events))
        return
    say(str(EventTable(run.graph, events[:FIRST])))
    say(f"... {left} more events: hybond explain tells all of them ...")
    say(str(EventTable(run.graph, events[-LAST:])))


def stats_line(run: Result) -> str:
    """Return how much work a run was, in one line."""
    count = {k: int(v) for k, v in run.stats.items() if float(v).is_integer()}
    kinds = {"steps": "step", "rejected": "", "evaluations": "evaluation"}
    words = [
        f"{count[k]} {plural(one, count[k]) if one else k}"
        for k, one in kinds.items()
        if k in count
    ]
    if "modes" in count:
        # those that were only tried at an instant count as well
        words.append(f"equations of {count['modes']} {plural('mode', count['modes'])}")
    events, kept = count.get("events", len(run.events)), len(run.events)
    many = f"{events} {plural('event', events)}"
    words.append(many + (f", the last {kept} kept" if kept < events else ""))
    return ", ".join([run.solver, *words])


def step_line(run: Result) -> str:
    """Return how good the step of time-stepping was, in one line."""
    error, advised = run.stats["step_error"], run.stats["step_advised"]
    text = f"estimated error: {100.0 * error:.2g} %"
    if error <= GOOD:
        return text
    return f"{text}; try step = {format_quantity(advised, 's')} for {100.0 * GOOD:g} %"


def _table(run: Result, times: Sequence[float], names: Sequence[str]) -> str:
    try:
        columns = sampled(run, times, names)
    except HybondError as error:
        return f"no samples: {error.why}"
    units = units_of(run, names)
    heads = ["t [s]", *(f"{n} [{units[n]}]" if units[n] else n for n in names)]
    rows = [heads]
    for k, t in enumerate(times):
        values = (columns[n][k] for n in names)
        rows.append([f"{t:.9g}", *("-" if v is None else f"{v:.9g}" for v in values)])
    return "\n".join(in_columns(rows, str.rjust))
