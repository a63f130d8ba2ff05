"""Events of a run for the page: what switched and why, mode by mode."""

from __future__ import annotations

from typing import Any

from hybond.report import fired_text, joule
from hybond.result import Result
from hybond.runs.trace import Event, Visit

PAGE = 500
"""Events told at once."""


def events(run: Result, first: int, count: int) -> list[dict[str, Any]]:
    """Return some events of a run, from the one with number `first` on.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> [e["cause"] for e in events(hb.simulate(m, until="1 s"), 0, 10)]
    ['start']
    """
    count = max(0, min(count, PAGE))
    last = min(first + count, len(run.events))
    return [event(run, k) for k in range(max(first, 0), last)]


def event(run: Result, number: int) -> dict[str, Any]:
    """Return one event in full."""
    found: Event = run.events[number]
    return {
        "event": number,
        "t": found.t,
        "t0": found.t0,
        "cause": found.cause,
        "landed": list(found.landed),
        "steps": [_step(run, s) for s in found.steps],
    }


def _step(run: Result, step: Visit) -> dict[str, Any]:
    told: dict[str, Any] = {
        "kind": step.kind,
        "mode": run.graph.mode_names(step.mode),
        "fired": [
            {
                "machine": f.machine,
                "source": f.source,
                "target": f.target,
                "guard": f.guard,
                "why": fired_text(f),
            }
            for f in step.fired
        ],
        "impulses": {k: float(v) for k, v in step.impulses.items()},
        "undetermined": list(step.undetermined),
    }
    energy = step.energy
    if energy is not None and step.kind != "mythical":
        told["energy"] = {
            "before": joule(energy.before),
            "after": joule(energy.after),
            "source": joule(energy.source),
            "lost": joule(energy.lost),
        }
    if step.exchanged:
        told["exchanged"] = {k: float(v) for k, v in step.exchanged.items()}
    return told
