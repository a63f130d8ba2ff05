"""What a page asks about runs: begin, cancel, plots, events mode by mode, values at a time."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from hybond.errors import HybondError, UsageError
from hybond.report import fired_text, joule
from hybond.result import Result, Side
from hybond.runs.trace import Event, Visit
from hybond.studio.curves import MOST_PLOTTED, at_cursor, curve, numbers, phase, strip, units_of
from hybond.studio.strokes import Meaning, first_member, mode_of, strokes

if TYPE_CHECKING:
    from hybond.studio.session import Session


Message = dict[str, Any]
PAGE = 500
"""Events told at once."""


def begin(session: Session, message: Mapping[str, Any]) -> Message:
    """Begin a run of the model as it is."""
    model = session.meaning().model
    known = session.meaning()
    if known.error is not None or model is None:
        raise known.error or UsageError(
            "there is no model",
            code="HB-W103",
            where="run",
            hint="put an element or a junction there",
        )
    until = message.get("until") or None
    options = message.get("options") or {}
    running = session.runs.start(
        model,
        until=until,
        options=options,
        revision=session.document.revision,
        wanted=[str(n) for n in message.get("names") or ()],
        wide=int(message.get("width") or 800),
    )
    return {"run": running.number}


def sweep(session: Session, message: Mapping[str, Any]) -> Message:
    """Begin runs of the model with a parameter over a range."""
    session.whole("sweep")
    model = session.meaning().model
    assert model is not None
    begun = session.sweeps.start(model, message)
    return {"sweep": begun.number, "values": begun.values}


def cancel(session: Session, message: Mapping[str, Any]) -> Message:
    """Stop what runs."""
    session.runs.cancel()
    session.sweeps.cancel()
    return {}


def summaries(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the runs that are kept."""
    return {"runs": [r.summary() for r in session.runs.kept.values()]}


def curves_of(session: Session, message: Mapping[str, Any]) -> Message:
    """Return signals and lanes of a run between two times."""
    run = session.runs.result(message.get("run"))
    t0, t1 = float(message.get("t0", 0.0)), float(message.get("t1", run.t_end))
    width = int(message.get("width", 800))
    found = []
    for name in [str(n) for n in message.get("names", ())][:MOST_PLOTTED]:
        try:
            found.append(curve(run, name, t0, t1, width))
        except HybondError as error:
            found.append({"name": name, "error": error.to_dict()})
    return {"curves": found, "strip": strip(run, t0, t1, width) if message.get("strip") else []}


def phase_of(session: Session, message: Mapping[str, Any]) -> Message:
    """Return one signal of a run over another."""
    run = session.runs.result(message.get("run"))
    x, y = (str(n) for n in message["names"])
    return phase(run, x, y, float(message["t0"]), float(message["t1"]))


def energies(session: Session, message: Mapping[str, Any]) -> Message:
    """Return who gave energy and who took it from the start of a run to a time."""
    from hybond.draw.sankey import shares_of

    run = session.runs.result(message.get("run"))
    t = float(message["t"])
    if t <= run.t_begin:  # where nothing has flowed yet
        return {"gives": [], "takes": [], "start": run.t_begin, "end": run.t_begin}
    found = run.losses(end=t, depth=1)
    gives, takes = (
        [{"name": n, "kind": kind, "energy": abs(e)} for n, kind, e in side]
        for side in shares_of(found)
    )
    return {"gives": gives, "takes": takes, "start": found.start, "end": found.end}


def events_of(session: Session, message: Mapping[str, Any]) -> Message:
    """Return some events of a run."""
    run = session.runs.result(message.get("run"))
    first = int(message.get("first", 0))
    return {
        "events": events(run, first, int(message.get("count", 100))),
        "total": len(run.events),
    }


def cursor(session: Session, message: Mapping[str, Any]) -> Message:
    """Return values on the bonds of a level at a time, and its strokes in the mode there.

    With ``mode`` the strokes are those of that mode, one of the modes of an instant.
    """
    run = session.runs.result(message.get("run"))
    known, path = session.meaning(), str(message.get("level") or "")
    bonds = numbers_of(known, path)
    if known.graph is None or not known.whole or len(known.graph.bonds) != len(run.graph.bonds):
        bonds = {}
    side: Side = "left" if message.get("side") == "left" else "right"
    found = at_cursor(run, float(message["t"]), side, list(bonds.values()))
    units = units_of(run, list(bonds.values()))
    values = {
        key: {
            "e": found["values"][str(b)][0],
            "f": found["values"][str(b)][1],
            "units": units[str(b)],
            "power": not run.graph.bonds[b].domain.pseudo,
        }
        for key, b in bonds.items()
    }
    states = message.get("mode") if isinstance(message.get("mode"), dict) else found["mode"]
    drawn = strokes(known, mode_of(known, states), path)
    signals = {}
    for name in [str(n) for n in message.get("names") or ()][:MOST_PLOTTED]:
        with contextlib.suppress(HybondError):
            (signals[name],) = numbers([float(run[name].at(found["t"], side=side))])
    return {
        "t": found["t"],
        "mode": states,
        "values": values,
        "signals": signals,
        "strokes": drawn,
    }


def numbers_of(known: Meaning, path: str) -> dict[str, int]:
    """Return the numbers of the bonds of a level in the graph, by what the page calls them.

    Of a range and of an array the first is shown for all.
    """
    path = path if known.graph is None else first_member(path, known.graph)
    prefix = f"{path}.graph.bonds[" if path else "graph.bonds["
    found: dict[str, int] = {}
    for k, written in enumerate(() if known.graph is None else known.graph.bonds):
        if written.where.startswith(prefix):
            found.setdefault(f"{written.where[len(prefix) : -1]}.{written.arrow}", k)
    return found


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
