"""Rows of steps as arrays of our own, those of slices that follow each other in one piece.

A step of a large model has a hundred thousand bytes: what goes on over several slices of a run is
not to be copied together afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

LARGE = 1 << 21
"""Bytes up to which a piece of memory has twice the rows that there were, ..."""
FEWEST = 256
"""... but at least so many rows are in one that is not among the first."""


class KeptRows:
    """Columns of numbers that grow slice by slice."""

    def __init__(self) -> None:
        self._room: dict[str, NDArray[Any]] = {}
        self._used: dict[str, int] = {}
        self._all: dict[str, int] = {}

    def added(self, name: str, rows: NDArray[Any]) -> NDArray[Any]:
        """Return a copy of the rows, behind the last ones of that name if there is room.

        Examples
        --------
        >>> kept = KeptRows()
        >>> first, second, third = (kept.added("t", np.array([float(k)])) for k in range(3))
        >>> joined_rows([second, third]).base is second.base
        True
        >>> joined_rows([first, second, third]).tolist()
        [0.0, 1.0, 2.0]
        """
        many = len(rows)
        room, used = self._room.get(name), self._used.get(name, 0)
        so_far = self._all.get(name, 0) + many
        if room is None or used + many > len(room):
            most = max(LARGE * many // max(rows.nbytes, 1), FEWEST)
            size = max(many, min(2 * (so_far - many), most))
            room, used = np.empty((size, *rows.shape[1:]), rows.dtype), 0
        self._room[name], self._used[name], self._all[name] = room, used + many, so_far
        found = room[used : used + many]
        found[...] = rows
        return found


def joined_rows(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return arrays as one; no copy where they follow each other in one piece of memory."""
    room = parts[0].base
    begins = [_begin(a) for a in parts]
    ends = [begin + a.nbytes for begin, a in zip(begins, parts, strict=True)]
    if not isinstance(room, np.ndarray) or begins[1:] != ends[:-1] or not parts[0].nbytes:
        return np.concatenate(parts)
    if room.shape[1:] != parts[0].shape[1:] or any(a.base is not room for a in parts):
        return np.concatenate(parts)
    first = (begins[0] - _begin(room)) // room[0].nbytes
    return room[first : first + sum(map(len, parts))]


def _begin(a: NDArray[Any]) -> int:
    return int(a.__array_interface__["data"][0])
