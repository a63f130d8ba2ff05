"""Parameter sets: rows or columns of what replaces a model's own values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.model.kept import kind_of
from hybond.model.parts import Value

Columns = dict[str, list[Value]]
"""For each dotted path the value of every member."""


def columns_of(sets: Mapping[str, Any] | Iterable[Mapping[str, Any]]) -> Columns:
    """Return parameter sets as columns of plain Python values, all of one length.

    Parameters
    ----------
    sets : mapping of path to sequence, or sequence of mappings of path to value
        Columns or rows; NumPy's arrays and numbers are as good as lists and floats.

    Raises
    ------
    UsageError
        HB-S114 for no sets, columns of different lengths, or rows with different paths.

    Examples
    --------
    >>> columns_of([{"m": 1, "k": "2 N/m"}, {"m": 3, "k": "4 N/m"}])
    {'m': [1, 3], 'k': ['2 N/m', '4 N/m']}
    >>> columns_of({"m": np.array([1.0, 3.0])})
    {'m': [1.0, 3.0]}
    """
    if isinstance(sets, Mapping):
        return _checked({str(path): _column(path, given) for path, given in sets.items()})
    if not isinstance(sets, Iterable):
        raise _refusal(f"sets is {_short(sets)}", "")
    rows = list(sets)
    for k, row in enumerate(rows):
        if not isinstance(row, Mapping):
            raise _refusal(f"set {k} is {_short(row)}, not a mapping of paths to values", f"[{k}]")
        if row.keys() != rows[0].keys():
            path = next(iter(row.keys() ^ rows[0].keys()))
            one, other = (k, 0) if path in row else (0, k)
            raise _refusal(f"set {one} has {path!r}, set {other} has not", f"[{k}]")
    if not rows:
        raise _refusal("there is no set", "")
    return _checked({str(p): [_plain(row[p]) for row in rows] for p in rows[0]})


def numbers_of(values: Sequence[Value]) -> NDArray[Any]:
    """Return values as an array: in SI if they are numbers or quantities, else as they are.

    Examples
    --------
    >>> numbers_of([1, "5 mm"]).tolist(), numbers_of(["2*m", 1.0]).tolist()
    ([1.0, 0.005], ['2*m', 1.0])
    """
    found = [kind_of(value) for value in values]
    if not any(isinstance(kind, str) for kind, _ in found):
        return np.array([number for _, number in found])
    whole = np.empty(len(values), dtype=object)
    whole[:] = list(values)
    return whole


def _checked(columns: Columns) -> Columns:
    lengths = {path: len(column) for path, column in columns.items()}
    if not columns:
        raise _refusal("the sets name no parameter", "")
    first = next(iter(lengths))
    for path, length in lengths.items():
        if length != lengths[first]:
            raise _refusal(
                f"{path!r} has {length} values, {first!r} has {lengths[first]}", f"[{path!r}]"
            )
    if not lengths[first]:
        raise _refusal("there is no set", "")
    return columns


def _column(path: object, given: Any) -> list[Value]:
    flat = isinstance(given, Iterable) and not isinstance(given, str | Mapping)
    if not flat or getattr(given, "ndim", 1) != 1:
        raise _refusal(f"{path!r} is {_short(given)}, not a row of values", f"[{path!r}]")
    return [_plain(value) for value in given]


def _plain(value: Any) -> Value:
    return value.item() if isinstance(value, np.generic) else value


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"a {type(value).__name__}"


def _refusal(why: str, place: str) -> UsageError:
    return UsageError(
        why,
        code="HB-S114",
        where=f"sets{place}",
        hint='rows, [{"m": 1}, {"m": 2}], or columns of one length, {"m": [1, 2]}',
    )
