"""What a page asks about sweeps of a plan: what is wrong, begin, cancel, views, members, table."""

from __future__ import annotations

import contextlib
import math
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.draw.of_sweeps import NONE, Axis
from hybond.errors import UsageError
from hybond.model.parts import Value
from hybond.studio.curves import numbers
from hybond.studio.planned import Planned
from hybond.studio.plans import faults, offered, wanted_of
from hybond.sweep.maps import map_of
from hybond.sweep.views import refusal, spread_of

if TYPE_CHECKING:
    from hybond.studio.session import Session

Message = dict[str, Any]
POINTS = 20_000
"""Points of a picture: of more members some are drawn, and the page says so."""
CELLS = 250_000
"""Cells of a map."""
TIMES = 1_000
"""Times of a curve."""
ROWS = 200
"""Rows of a table that are sent at once."""


def words(session: Session, message: Mapping[str, Any]) -> Message:
    """Return what the form of a plan may say."""
    graph = session.whole("plan")
    model = session.meaning().model
    assert model is not None
    return offered(model, graph)


def look(session: Session, message: Mapping[str, Any]) -> Message:
    """Return how many members a plan has, what is wrong with it, and its command."""
    graph = session.whole("plan")
    model = session.meaning().model
    assert model is not None
    wanted = wanted_of(message)
    members, wrong = faults(model, graph, wanted)
    name = Path(session.document.name)
    return {
        "members": members,
        "wrong": wrong,
        "command": wanted.command(str(name if name.suffix else name.with_suffix(".toml"))),
    }


def begin(session: Session, message: Mapping[str, Any]) -> Message:
    """Begin the sweep of a plan; refused as a whole if anything is wrong with it."""
    graph = session.whole("plan")
    model = session.meaning().model
    assert model is not None
    wanted = wanted_of(message)
    wrong = faults(model, graph, wanted)[1]
    if wrong:
        said = next(iter(wrong.values()))
        raise UsageError(
            said["why"], code=said["code"], where=said["where"], hint=said.get("try", "")
        )
    planned = session.plans.start(model, wanted, session.document.revision)
    return {**planned.told(), **planned.about()}


def state(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the sweep that there is, if there is one: for a page that comes back."""
    planned = session.plans.current
    return {"now": None if planned is None else {**planned.told(), **planned.about()}}


def cancel(session: Session, message: Mapping[str, Any]) -> Message:
    """Stop the sweep; what is done stays."""
    session.plans.cancel()
    return {}


def seen(session: Session, message: Mapping[str, Any]) -> Message:
    """Return a view of what is done: the same numbers that plots in Python draw."""
    planned = _planned(session, message)
    view = str(message.get("view"))
    if view not in VIEWS:
        raise UsageError(
            f"there is no view {view!r}", code="HB-W103", where="view", hint=", ".join(VIEWS)
        )
    return {"view": view, "kept": len(planned.table()), **VIEWS[view](planned, message)}


def _map(planned: Planned, message: Mapping[str, Any]) -> Message:
    table = planned.table()
    at = {str(k): int(v) for k, v in (message.get("at") or {}).items()}
    x, y, value = (str(message.get(k) or "") for k in ("x", "y", "value"))
    found = map_of(table, x, y, value, at=at)
    if found.is_grid and len(found.members) > CELLS:
        raise refusal(f"{len(found.members)} cells", f"at most {CELLS} on the page")
    said: Message = {
        "x": _axis(found.x),
        "y": _axis(found.y),
        "value": found.value,
        "unit": found.unit,
        "names": list(found.names),
        "inks": list(found.inks),
        "none": NONE,
        "all": len(found.members),
    }
    if found.is_grid:
        own = slice(None)
        said["across"], said["up"] = numbers(found.across), numbers(found.up)
    else:
        own = slice(None, None, max(math.ceil(len(found.members) / POINTS), 1))
        said["across"], said["up"] = numbers(found.across[own]), numbers(found.up[own])
    return {
        **said,
        "members": found.members[own].tolist(),
        "number": numbers(found.number[own]),
    }


def _axis(axis: Axis) -> Message:
    edges = None if axis.edges is None else numbers(axis.edges)
    return {"name": axis.name, "unit": axis.unit, "log": axis.log, "edges": edges}


def _family(planned: Planned, message: Mapping[str, Any]) -> Message:
    found = spread_of(planned.table(), str(message.get("curve") or ""))
    step = max(math.ceil(len(found.t) / TIMES), 1)
    return {
        "signal": found.signal,
        "unit": found.unit,
        "t": numbers(found.t[::step]),
        "every": step,
        "bands": [numbers(row[::step]) for row in found.bands],
        "members": found.members.tolist(),
        "curves": [numbers(row[::step]) for row in found.curves],
    }


def _tornado(planned: Planned, message: Mapping[str, Any]) -> Message:
    table, value = planned.table(), str(message.get("value") or "")
    rows = table.tornado(value)
    middle = float(np.asarray(table[value], dtype=float)[0])
    paths = list(table.plan.paths)
    return {
        "value": value,
        "unit": table.unit(value),
        "middle": numbers([middle])[0],
        "rows": [
            {
                "path": path,
                "unit": table.unit(path),
                "ends": numbers([low, high]),
                "outcomes": numbers([at_low, at_high]),
                "members": [1 + 2 * paths.index(path), 2 + 2 * paths.index(path)],
            }
            for path, low, high, at_low, at_high in rows
        ],
    }


def _sobol(planned: Planned, message: Mapping[str, Any]) -> Message:
    value = str(message.get("value") or "")
    found = planned.table().sobol(value)
    order = np.argsort(-np.nan_to_num(found.total), kind="stable")
    rows = [
        {
            "path": found.names[k],
            "first": numbers([found.first[k], found.first_error[k]]),
            "total": numbers([found.total[k], found.total_error[k]]),
        }
        for k in order.tolist()
    ]
    return {"value": value, "rows": rows, "points": found.points, "leftOut": found.left_out}


def _table(planned: Planned, message: Mapping[str, Any]) -> Message:
    table = planned.table()
    first = max(int(message.get("first") or 0), 0)
    rows = [_cells(row) for row in table.rows(first, first + ROWS)]
    return {
        "columns": [{"name": n, "unit": table.unit(n)} for n in table.columns],
        "first": first,
        "rows": rows,
    }


def _cells(row: Sequence[Any]) -> list[Any]:
    return [numbers([c])[0] if isinstance(c, float) else c for c in row]


VIEWS = {
    "map": _map,
    "scatter": _map,
    "family": _family,
    "tornado": _tornado,
    "sobol": _sobol,
    "table": _table,
}
"""What may be looked at."""


def member(session: Session, message: Mapping[str, Any]) -> Message:
    """Return a member: what its factors are, and its row if it has run."""
    planned = _planned(session, message)
    number = _member(planned, message)
    table = planned.table()
    row = [dict(zip(table.columns, _cells(r))) for r in table.rows(number, number + 1)]
    return {"member": number, "sets": _sets(planned, number), "row": row[0] if row else None}


def open_member(session: Session, message: Mapping[str, Any]) -> Message:
    """Run a member as a run of its own, to be plotted."""
    planned = _planned(session, message)
    number = _member(planned, message)
    running = session.runs.start(
        planned.job.model,
        until=planned.job.whole_until,
        revision=planned.revision,
        wanted=[str(n) for n in message.get("names") or ()],
        wide=int(message.get("width") or 800),
        parameters=planned.table().parameters(number),
        title=f"run {number} of the sweep: {_said(_sets(planned, number))}",
    )
    return {"run": running.number}


def csv(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the table as the text of a CSV file."""
    planned = _planned(session, message)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "table.csv")
        planned.table().to_csv(file)
        text = file.read_text(encoding="utf-8")
    return {"name": f"{Path(session.document.name).stem}_sweep.csv", "text": text}


def _planned(session: Session, message: Mapping[str, Any]) -> Planned:
    planned = session.plans.current
    if planned is None or planned.number != message.get("plan"):
        raise UsageError(
            f"there is no sweep {message.get('plan')!r}",
            code="HB-W103",
            where="plan",
            hint="run the sweep",
        )
    return planned


def _member(planned: Planned, message: Mapping[str, Any]) -> int:
    number, many = message.get("member"), len(planned.job.plan)
    if not isinstance(number, int) or not 0 <= number < many:
        raise UsageError(
            f"there is no member {number!r}",
            code="HB-P109",
            where="member",
            hint=f"0 to {many - 1}",
        )
    return number


def _said(sets: Mapping[str, Value]) -> str:
    words = []
    for path, value in sets.items():
        number, _, unit = str(value).partition(" ")
        with contextlib.suppress(ValueError):
            number = f"{float(number):.6g}"
        words.append(f"{path} = {number} {unit}".strip())
    return ", ".join(words)


def _sets(planned: Planned, number: int) -> dict[str, Value]:
    """Return the factors of a member as `hybond.simulate` takes them."""
    rows, table = planned.job.plan.rows(number, number + 1), planned.table()
    found: dict[str, Value] = {}
    for factor in planned.job.plan.factors:
        value, unit = rows[factor.path][0], table.unit(factor.path)
        if factor.is_number:
            value = f"{float(value)!r} {unit}" if unit else float(value)
        found[factor.path] = value
    return found
