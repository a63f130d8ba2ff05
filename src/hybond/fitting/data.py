"""Measured signals over time: from a CSV file, or from arrays."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import FileError, UsageError
from hybond.files.parse import read_regular
from hybond.units import is_of, try_quantity

Vector = NDArray[np.float64]

LARGEST = 64 * 2**20
"""Bytes that a file of data may have."""
ROWS = 1_000_000
COLUMNS = 1_000
TIMES = ("time", "t")
"""What the column of times is called."""
_WITH_UNIT = re.compile(r"(.*\S)\s*\[([^\[\]]*)\]\s*\Z")


@dataclass(frozen=True, slots=True, eq=False)
class Data:
    """Signals that were measured.

    Parameters
    ----------
    name : str
        Of the file, or what the data are called.
    t : array, shape (rows,)
        s, in order.
    columns : mapping of signal to array, shape (rows,)
        SI; nan where nothing was measured.
    units : mapping of signal to str
        Those that columns were given in.
    """

    name: str
    t: Vector
    columns: Mapping[str, Vector]
    units: Mapping[str, str] = field(default_factory=dict)


def read_data(source: Any, number: int = 1) -> Data:
    """Return data from a file, or from a mapping of names to sequences.

    A file has a line of names, comma-separated: ``time`` (or ``t``) and signals, each with a unit
    in brackets if it is not the SI unit (``height [mm]``). Cells may be empty.

    Raises
    ------
    FileError
        HB-A530 for what cannot be read.
    UsageError
        HB-A530 for what is neither a file nor a mapping.

    Examples
    --------
    >>> found = read_data({"t": [0.0, 0.1], "height [mm]": [5, 7]})
    >>> found.t.tolist(), found.columns["height"].tolist()
    ([0.0, 0.1], [0.005, 0.007])
    """
    if isinstance(source, Data):
        return source
    if isinstance(source, str | Path):
        return _of_file(Path(source))
    if isinstance(source, Mapping):
        name = f"data {number}"
        rows = {str(k): np.asarray(v, dtype=float).reshape(-1) for k, v in source.items()}
        if len({len(v) for v in rows.values()}) > 1:
            raise _bad(name, "the columns have different lengths", "one value for each time")
        return _made(name, list(rows), list(rows.values()))
    raise UsageError(
        f"{source!r} is no data",
        code="HB-A530",
        where="data",
        hint='a CSV file, or a mapping: {"t": [...], "height": [...]}',
    )


def _of_file(path: Path) -> Data:
    try:
        content = read_regular(path, LARGEST + 1)
        if len(content) > LARGEST:
            raise _bad(str(path), "it is too large", f"at most {LARGEST // 2**20} MB")
        text = content.decode("utf-8-sig")
    except (OSError, ValueError) as error:
        if isinstance(error, UnicodeDecodeError):
            raise _bad(str(path), "it is no text in UTF-8", "save it as CSV, UTF-8") from None
        why = getattr(error, "strerror", "") or str(error)
        raise _bad(str(path), why, "name a CSV file") from None
    rows = csv.reader(io.StringIO(text), skipinitialspace=True)
    try:
        head = [cell.strip() for cell in next(rows, [])]
        if len(head) > COLUMNS:
            raise _bad(str(path), f"{len(head)} columns are too many", f"at most {COLUMNS}")
        side = head.index("side") if "side" in head else None
        cells: list[list[float]] = [[] for _ in head]
        for row in rows:
            if not any(cell.strip() for cell in row):
                continue
            if len(row) != len(head):
                why = f"line {rows.line_num} has {len(row)} cells, the first line {len(head)}"
                raise _bad(str(path), why, "one cell for each name; it may be empty")
            if len(cells[0]) >= ROWS:
                raise _bad(str(path), f"more than {ROWS} rows", "leave some out")
            if side is not None and row[side].strip() == "left":
                continue  # of a run's own table: what was just before an event
            for k, (column, cell) in enumerate(zip(cells, row, strict=True)):
                if k == side:
                    continue
                column.append(_number(cell.strip(), path, rows.line_num))
    except csv.Error as error:
        raise _bad(str(path), str(error), "comma-separated values") from None
    kept = [k for k in range(len(head)) if k != side]
    return _made(path.name, [head[k] for k in kept], [np.array(cells[k]) for k in kept])


def _number(cell: str, path: Path, line: int) -> float:
    if not cell:
        return math.nan
    try:
        value = float(cell)
    except ValueError:
        value = math.inf
    if not math.isfinite(value):
        raise _bad(
            str(path), f"{cell!r} in line {line} is no number", "numbers with a point; or nothing"
        )
    return value


def _made(name: str, head: Sequence[str], columns: Sequence[Vector]) -> Data:
    t: Vector | None = None
    found: dict[str, Vector] = {}
    units: dict[str, str] = {}
    for text, column in zip(head, columns, strict=True):
        match = _WITH_UNIT.match(text)
        own, unit = (match[1].strip(), match[2].strip()) if match else (text, "")
        factor = 1.0
        if unit:
            quantity = try_quantity(f"1 {unit}")
            if quantity is None:
                raise _bad(name, f"{unit!r} is no unit", "height [mm]; or SI without brackets")
            if own in TIMES and not is_of(quantity, "s"):
                raise _bad(name, f"{unit!r} is no unit of time", "time [ms]; or s without brackets")
            factor = quantity.value
            units[own] = unit
        if own in found or (own in TIMES and t is not None):
            raise _bad(name, f"two columns are called {own!r}", "one for each signal")
        if own in TIMES:
            t = column * factor
        else:
            found[own] = column * factor
    if t is None:
        raise _bad(name, "no column is called time or t", "the times, in s, are a column too")
    if not found or not len(t):
        raise _bad(name, "it has no measurements", "a column for each signal, a row for each time")
    if not np.isfinite(t).all() or (np.diff(t) < 0.0).any() or t[0] < 0.0:
        raise _bad(name, "the times do not increase from 0 on", "sort the rows by time")
    return Data(name, t, found, units)


def _bad(name: str, why: str, hint: str) -> FileError:
    return FileError(why, code="HB-A530", where=name, hint=hint)
