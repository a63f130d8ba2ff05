"""Rows of steps as arrays of our own, those of slices that follow each other in one piece.

A step of a large model has a hundred thousand bytes: what goes on over several slices of a run is
not to be copied together afterwards, and a step begins mostly where the last one was ended.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import DTypeLike, NDArray

LARGE = 1 << 21
"""Bytes up to which a piece of memory has twice the rows that there were, ..."""
FEWEST = 256
"""... but at least so many rows are in one that is not among the first."""
WIDE = 64
"""Numbers of a row from which on rows that are the same stand once: to look them up takes as long
as to copy so many."""


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
        found = self.room(name, rows.shape, rows.dtype)
        found[...] = rows
        return found

    def room(self, name: str, shape: tuple[int, ...], dtype: DTypeLike) -> NDArray[Any]:
        """Return room for rows, behind the last ones of that name if there is some."""
        many = shape[0]
        room, used = self._room.get(name), self._used.get(name, 0)
        so_far = self._all.get(name, 0) + many
        if room is None or used + many > len(room):
            size = np.dtype(dtype).itemsize * math.prod(shape[1:])
            most = max(LARGE // max(size, 1), FEWEST)
            size = max(many, min(2 * (so_far - many), most))
            room, used = np.empty((size, *shape[1:]), dtype), 0
        self._room[name], self._used[name], self._all[name] = room, used + many, so_far
        return room[used : used + many]

    def last(self, name: str, many: int) -> NDArray[Any]:
        """Return the last rows of a name."""
        used = self._used[name]
        return self._room[name][used - many : used]

    def ends_with(self, name: str, row: NDArray[np.float64], more: int) -> bool:
        """Whether the last row of a name is this one, to the last bit, with room behind it."""
        used = self._used.get(name, 0)
        if not used or used + more > len(self._room[name]):
            return False
        return np.array_equal(self._room[name][used - 1].view(np.int64), row.view(np.int64))


class SharedRows:
    """Rows at many places, several at each; those that follow and are the same stand once.

    It is read as an array of shape (places, rows of each, numbers) is.

    Examples
    --------
    >>> states = np.array([[[1.0], [2.0]], [[2.0], [2.0]], [[2.0], [3.0]]])
    >>> found = SharedRows.of(states, KeptRows(), "y")
    >>> len(found), found.rows.tolist(), found[1:].tolist()
    (3, [[1.0], [2.0], [3.0]], [[[2.0], [2.0]], [[2.0], [3.0]]])
    """

    def __init__(self, rows: NDArray[np.float64], at: NDArray[np.intp]) -> None:
        self.rows = rows
        self.at = at
        """Shape (places, rows of each). Which row stands there."""

    @staticmethod
    def of(states: NDArray[np.float64], kept: KeptRows, name: str) -> SharedRows:
        """Return a copy of states, in rows that are kept; the same means to the last bit."""
        many, each, numbers = states.shape
        flat = states.reshape(-1, numbers)
        bits = flat.view(np.int64)
        new = np.append(True, (bits[1:] != bits[:-1]).any(axis=1))
        # where the last slice ended the next one begins
        again = kept.ends_with(name, flat[0], int(new.sum()) - 1)
        new[0] = not again
        which = np.flatnonzero(new)
        rows = kept.room(name, (len(which), numbers), flat.dtype)
        np.take(flat, which, axis=0, out=rows, mode="clip")  # else it is copied twice
        if again:
            rows = kept.last(name, len(which) + 1)
        return SharedRows(rows, (np.cumsum(new) - (not again)).reshape(many, each))

    @property
    def shape(self) -> tuple[int, int, int]:
        """That of the array."""
        return len(self.at), self.at.shape[1], self.rows.shape[1]

    def __len__(self) -> int:
        return len(self.at)

    def __getitem__(self, which: Any) -> NDArray[np.float64]:
        found: NDArray[np.float64] = self.rows[self.at[which]]
        return found

    def part(self, first: int, last: int) -> SharedRows:
        """Return those at the places from `first` to `last` - 1."""
        at = self.at[first:last]
        if not len(at):
            return SharedRows(self.rows[:0], at)
        begin = int(at[0, 0])
        return SharedRows(self.rows[begin : int(at[-1, -1]) + 1], at - begin)

    def begun_at(self, row: NDArray[np.float64]) -> SharedRows:
        """Return the same with another row before all."""
        at = self.at + 1
        at[0, 0] = 0
        return SharedRows(np.vstack([row, self.rows]), at)

    @staticmethod
    def joined(parts: Sequence[SharedRows]) -> SharedRows:
        """Return those of several slices as one."""
        room = parts[0].rows.base
        if isinstance(room, np.ndarray) and all(p.rows.base is room for p in parts):
            begins = [(_begin(p.rows) - _begin(room)) // room[0].nbytes for p in parts]
            first = min(begins)
            last = max(k + len(p.rows) for k, p in zip(begins, parts, strict=True))
            rows, before = room[first:last], [k - first for k in begins]
        else:
            rows = np.concatenate([p.rows for p in parts])
            before = [0, *accumulate(len(p.rows) for p in parts[:-1])]
        at = [p.at + k for p, k in zip(parts, before, strict=True)]
        return SharedRows(rows, np.concatenate(at))


StateRows: TypeAlias = NDArray[np.float64] | SharedRows
"""States at steps or instants: of a large model with what is the same standing once."""


def joined_states(parts: Sequence[StateRows]) -> StateRows:
    """Return states of several slices as one; all are shared, or none is."""
    found = [p for p in parts if isinstance(p, SharedRows)]
    if found:
        return SharedRows.joined(found)
    return joined_rows([p for p in parts if not isinstance(p, SharedRows)])


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
