"""Cells in words: conditions on what is stored."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hybond.analysis.modes.cell import Cell, Row

DIGITS = 6


def conditions(cell: Cell, names: Sequence[str]) -> tuple[str, ...]:
    """Return the rows of a cell that tell something, as conditions on named variables.

    Examples
    --------
    >>> import numpy as np
    >>> from hybond.analysis.modes.cell import Programs
    >>> line = Programs(np.ones(1), 100)
    >>> whole = Cell((), np.zeros(1), line)
    >>> part = whole.cut(Row(np.array([2.0]), 6.0, "<")).cut(Row(np.array([-1.0]), 1.0, "<="))
    >>> conditions(part, ["ball.p"])
    ('-1 <= ball.p < 3',)
    """
    bounds: dict[int, dict[str, Row]] = {}
    others: list[str] = []
    for row in cell.needed():
        places = np.flatnonzero(row.a)
        if len(places) != 1:
            others.append(_sum(row, names))
            continue
        k = int(places[0])
        side = "=" if row.kind == "=" else ("above" if row.a[k] > 0 else "below")
        bounds.setdefault(k, {})[side] = row
    told = [_bound(names[k], bounds[k], k) for k in sorted(bounds)]
    return tuple([*told, *others])


def _number(value: float) -> str:
    return f"{value + 0.0:.{DIGITS}g}"


def _bound(name: str, rows: dict[str, Row], k: int) -> str:
    value = {side: _number(row.b / float(row.a[k])) for side, row in rows.items()}
    if "=" in rows:
        return f"{name} = {value['=']}"
    if len(rows) == 2 and value["below"] == value["above"]:
        return f"{name} = {value['above']}"
    if len(rows) == 2:
        low, high = rows["below"].kind, rows["above"].kind
        return f"{value['below']} {low} {name} {high} {value['above']}"
    if "above" in rows:
        return f"{name} {rows['above'].kind} {value['above']}"
    return f"{name} {'>' if rows['below'].kind == '<' else '>='} {value['below']}"


def _sum(row: Row, names: Sequence[str]) -> str:
    """Return a row with a leading coefficient of one."""
    places = np.flatnonzero(row.a)
    lead = float(row.a[places[0]])
    terms: list[str] = []
    for k in places.tolist():
        c = float(row.a[k]) / lead
        size = "" if abs(abs(c) - 1.0) < 1e-12 else f"{_number(abs(c))}*"
        sign = (" - " if c < 0 else " + ") if terms else ("-" if c < 0 else "")
        terms.append(f"{sign}{size}{names[k]}")
    kind = row.kind
    if lead < 0 and kind != "=":
        kind_text = ">" if kind == "<" else ">="
    else:
        kind_text = kind
    return f"{''.join(terms)} {kind_text} {_number(row.b / lead)}"
