"""A run as one JSON object; ``result.schema.json`` beside this file describes it."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hybond.errors import HybondError
from hybond.model.graph import FlatGraph

if TYPE_CHECKING:
    from hybond.result import Result
    from hybond.runs.trace import Event, Fired, Visit

VERSION = 1
"""Version of the object's schema."""


def run_record(
    run: Result,
    file: str,
    times: Sequence[float] = (),
    names: Sequence[str] = (),
    warnings: Sequence[str] = (),
    *,
    events: bool = True,
) -> dict[str, Any]:
    """Return everything about a run as plain data in SI.

    Parameters
    ----------
    file : str
        Where the model came from.
    times, names : sequences
        When and what to sample: the limits from the right. Beyond the end of a run that stopped
        early there is nothing: None.
    warnings : sequence of str
        To be added to those of the run.
    events : bool
        Whether its events are asked for: to make many records takes longer than the run.
    """
    notes = list(run.warnings)
    samples = _samples(run, times, names, notes)
    final = _final(run, notes)
    notes += [w for w in warnings if w not in notes]
    record: dict[str, Any] = {
        "hybond": VERSION,
        "model": run.graph.name,
        "title": run.title,
        "file": file,
        "status": run.status,
        "until": run.until,
        "t_end": run.t_end,
        "ended_by": run.ended_by,
        **_steps(run),
        "solver": run.solver,
        "mode": run.mode,
        "events": [_event(run.graph, e) for e in run.events] if events else [],
        "samples": samples,
        "final": final,
        "units": units_of(run, [*final, *names]),
        "accumulations": [
            {
                "t": a.t,
                "ratio": a.ratio,
                "events": a.events,
                "machine": a.machine,
                "landed": a.landed,
                **({"state": a.state} if a.state else {}),
            }
            for a in run.accumulations
        ],
        "sliding": [
            {
                "t0": s.t0,
                "t1": s.t1,
                "machines": list(s.machines),
                "surfaces": list(s.surfaces),
                "kind": s.kind,
            }
            for s in run.sliding
        ],
        "turns": [{"t": turn.t, "solver": turn.solver} for turn in run.turns],
        "warnings": notes,
        "stats": {k: int(v) if float(v).is_integer() else v for k, v in run.stats.items()},
        "engine": run.engine,
        **({"method": run.method} if run.method else {}),
    }
    if run.error is not None:
        record["error"] = run.error.to_dict()
    return record


def _steps(run: Result) -> dict[str, Any]:
    """Return the steps of a script, if it was one."""
    from hybond.scripts.result import ScriptResult

    if not isinstance(run, ScriptResult):
        return {}
    steps = [
        {"label": s.label, "t0": s.t0, "t1": s.t1, "ended_by": s.ended_by, "set": dict(s.set)}
        for s in run.steps
    ]
    return {"script": steps}


def failure_record(file: str, error: HybondError | None) -> dict[str, Any]:
    """Return the object of a run that never began; `error` is None if it was interrupted."""
    from hybond.result import Result

    if error is not None and isinstance(error.partial, Result):
        return run_record(error.partial, file) | {"error": error.to_dict()}
    record: dict[str, Any] = {
        "hybond": VERSION,
        "model": file,
        "file": file,
        "status": "interrupted" if error is None else "error",
        "t_end": 0.0,
        "solver": None,
        "mode": {},
        "events": [],
        "samples": {"t": []},
        "final": {},
        "turns": [],
        "warnings": [],
        "stats": {},
        "engine": "",
    }
    if error is not None:
        record["error"] = error.to_dict()
    return record


def to_json(record: dict[str, Any]) -> str:
    r"""Return a record as text; what is not finite is null, for JSON has no word for it.

    Examples
    --------
    >>> to_json({"t": [0.5, float("inf")]})
    '{"t": [0.5, null]}\n'
    """
    return json.dumps(_finite(record), allow_nan=False) + "\n"


def units_of(run: Result, names: Sequence[str]) -> dict[str, str]:
    """Return the SI unit of each name, empty where there is none."""
    found = {}
    for name in dict.fromkeys(names):
        try:
            found[name] = run.unit(name)
        except HybondError:
            found[name] = ""
    return found


def sampled(
    run: Result, times: Sequence[float], names: Sequence[str]
) -> dict[str, list[float | None]]:
    """Return right limits of signals at times; None where the run did not get to."""
    reached = [k for k, t in enumerate(times) if run.segments and t <= run.t_end]
    values = run.sample([times[k] for k in reached], list(names)) if reached else {}
    found: dict[str, list[float | None]] = {}
    for name in names:
        column: list[float | None] = [None] * len(times)
        for k, value in zip(reached, values.get(name, ()), strict=False):
            column[k] = float(value)
        found[name] = column
    return found


def _samples(
    run: Result, times: Sequence[float], names: Sequence[str], notes: list[str]
) -> dict[str, Any]:
    try:
        columns = sampled(run, times, names)
    except HybondError as error:
        notes.append(f"no samples: {error.why}")
        columns = {name: [None] * len(times) for name in names}
    beyond = sum(t > run.t_end or not run.segments for t in times)
    if beyond:
        notes.append(
            f"the run ended at t = {run.t_end:.9g} s: {beyond} of {len(times)} sample times "
            "are later and have no value"
        )
    return {"t": list(times), **columns}


def _final(run: Result, notes: list[str]) -> dict[str, float]:
    try:
        return run.final
    except HybondError as error:
        notes.append(f"no final values: {error.why}")
        return {}


def _event(graph: FlatGraph, event: Event) -> dict[str, Any]:
    steps = [_step(graph, s) for s in event.steps]
    record: dict[str, Any] = {"t": event.t, "cause": event.cause, "steps": steps}
    if event.label:
        record["label"] = event.label
    if event.t0 is not None:
        record["since"] = event.t0
    if event.landed:
        record["landed"] = list(event.landed)
    return record


def _step(graph: FlatGraph, step: Visit) -> dict[str, Any]:
    record: dict[str, Any] = {
        "mode": graph.mode_names(step.mode),
        "kind": step.kind,
        "fired": [_fired(f) for f in step.fired],
        "impulses": dict(step.impulses),
    }
    if step.energy is not None:
        e = step.energy
        record["energy"] = {
            "before": e.before,
            "after": e.after,
            "source": e.source,
            "lost": e.lost,
        }
    if step.exchanged:
        record["exchanged"] = dict(step.exchanged)
    if step.undetermined:
        record["undetermined"] = list(step.undetermined)
    return record


def _fired(fired: Fired) -> dict[str, Any]:
    record: dict[str, Any] = {
        "machine": fired.machine,
        "from": fired.source,
        "to": fired.target,
        "guard": fired.guard,
        "values": dict(fired.values),
    }
    if fired.impulses:
        record["impulses"] = dict(fired.impulses)
    if fired.passed_over:
        record["also"] = list(fired.passed_over)
    return record


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(k): _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return value
