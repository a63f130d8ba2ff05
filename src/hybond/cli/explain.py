"""``hybond explain``: when and why each switch happened, and what it did."""

from __future__ import annotations

import textwrap
from argparse import Namespace
from collections.abc import Iterator

from hybond.cli.lists import check_experiment
from hybond.cli.netlists import read_model
from hybond.cli.running import ending, exit_code, run_with
from hybond.cli.settings import flatten_with
from hybond.cli.streams import complain, say
from hybond.errors import HybondError
from hybond.model.dimensions import infer_dimension
from hybond.options import seconds
from hybond.report import fired_text, joule
from hybond.result import Result
from hybond.runs.trace import Event, Visit
from hybond.units import format_quantity, parse_unit


def explain(given: Namespace) -> int:
    """Simulate and print the event table, then each event in full."""
    model = read_model(given.file)[0]
    graph = flatten_with(model, given.settings)
    check_experiment(graph)
    at = None if given.at is None else seconds(given.at, "--at")
    run = run_with(model, graph, given)
    say(explanation(run, at))
    if run.error is not None:
        complain(str(run.error))
    return exit_code(run)


def explanation(run: Result, at: float | None = None) -> str:
    """Return the event table and its details; only the event nearest to `at`, if it is given."""
    events = list(run.events)
    if at is not None and events:
        events = [min(events, key=lambda e: abs(e.t - at))]
    lines = [run.title, "", run.explain(at)]
    for event in events:
        mark = "in the step" if event.cause == "step" else "δ"
        details = [line.replace(" δ", f" {mark}") for s in event.steps for line in _step(run, s)]
        if details:
            lines += ["", _heading(event), *details]
    lines += ["", ending(run), *(f"warning: {w}" for w in run.warnings)]
    if run.error is not None:
        lines += ["", *_failure(run.error)]
    return "\n".join(lines)


def _heading(event: Event) -> str:
    since = "" if event.t0 is None else f"{event.t0:.9g} .. "
    return f"t = {since}{event.t:.9g} s ({event.cause})"


def _step(run: Result, step: Visit) -> Iterator[str]:
    """Return what a step wrote; nothing for a mode that was entered without a jump."""
    over = [f for f in step.fired if f.passed_over]
    if not (step.impulses or step.exchanged or step.undetermined or over):
        return
    mode = ", ".join(run.graph.mode_names(step.mode).values()) or "the only mode"
    yield f"  ({mode}) {step.kind}"
    for fired in step.fired:
        yield f"    {fired.machine}: {fired.source} -> {fired.target} when {fired_text(fired)}"
    trial = ", on trial" if step.kind == "mythical" else ""
    for name, area in step.impulses.items():
        yield f"    impulse    {name} = {_area(run, name, area)} δ{trial}"
    e = step.energy
    if e is not None and step.kind != "mythical":
        yield (
            f"    energy     {joule(e.before)} before, {joule(e.after)} after; "
            f"supplied {joule(e.source)}, lost {joule(e.lost)}"
        )
    for name, area in step.exchanged.items():
        yield f"    exchanged  {name} = {_area(run, name, area)} δ with a source or an OFF junction"
    if step.undetermined:
        yield f"    open       {', '.join(step.undetermined)}: not determined by the equations"


def _area(run: Result, name: str, area: float) -> str:
    """Return an impulse area with its unit: that of the signal, times a second."""
    try:
        dimension = infer_dimension(run.expression(name), run.graph.dimensions.get)
    except HybondError:
        dimension = None
    if dimension is None:
        return f"{area:.6g}"
    return format_quantity(area, dimension * parse_unit("s")[1])


def _failure(error: HybondError) -> list[str]:
    place = f" at {error.where}" if error.where else ""
    lines = [f"The run stopped: {error.code}{place}"]
    for text in (error.why, f"try: {error.hint}" if error.hint else ""):
        lines += textwrap.wrap(
            text,
            96,
            initial_indent="  ",
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        )
    return lines
