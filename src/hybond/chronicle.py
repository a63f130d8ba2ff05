"""A list whose items may be made when they are asked for, in the order of time."""

from __future__ import annotations

import bisect
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Generic, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")


class Chronicle(Sequence[T], Generic[T]):
    """Items with their times; blocks of them are given as a function that makes each.

    Parameters
    ----------
    time_of : callable
        The time of an item, s.

    Examples
    --------
    >>> squares = Chronicle(float)
    >>> squares.append(0)
    >>> squares.extend([1.0, 4.0, 9.0], lambda k: (k + 1) ** 2)
    >>> len(squares), squares[-1], squares[1:3], squares.times
    (4, 9, [1, 4], [0.0, 1.0, 4.0, 9.0])
    """

    def __init__(self, time_of: Callable[[T], float], items: Iterable[T] = ()) -> None:
        self._time_of = time_of
        self._items: list[T | None] = []
        self._blocks: list[tuple[int, Callable[[int], T]]] = []
        self._plain: list[bool] = []
        self.times: list[float] = []
        self.forgotten = 0
        """Items that were there before the first."""
        for item in items:
            self.append(item)

    def append(self, item: T) -> None:
        """Add an item that is there."""
        self._items.append(item)
        self._plain.append(False)
        self.times.append(float(self._time_of(item)))

    def extend(
        self,
        times: Sequence[float],
        make: Callable[[int], T],
        *,
        plain: Sequence[bool] | None = None,
    ) -> None:
        """Add as many items as there are times; item k of them is ``make(k)``, made once.

        `plain` tells of which items it is known, before they are made, that `telling` need not
        give them.
        """
        self._blocks.append((len(self._items), make))
        self._items.extend([None] * len(times))
        self._plain.extend([False] * len(times) if plain is None else plain)
        self.times.extend(times)

    def telling(self) -> Iterator[T]:
        """Return the items but for the plain ones, which are not made for it.

        Examples
        --------
        >>> squares = Chronicle(float)
        >>> squares.extend([1.0, 4.0], lambda k: (k + 1) ** 2, plain=[True, False])
        >>> list(squares.telling())
        [4]
        """
        return (self._item(k) for k, plain in enumerate(self._plain) if not plain)

    def forget(self, count: int) -> None:
        """Let go of the first items.

        Examples
        --------
        >>> letters = Chronicle(lambda _: 0.0, "abcd")
        >>> letters.forget(3)
        >>> list(letters), letters.forgotten
        (['d'], 3)
        """
        count = min(count, len(self))
        del self._items[:count], self._plain[:count], self.times[:count]
        moved = [(first - count, make) for first, make in self._blocks]
        # a block is needed if the next one begins behind the first item that is left
        ends = [*(first for first, _ in moved[1:]), len(self)]
        self._blocks = [b for b, end in zip(moved, ends, strict=False) if end > 0]
        self.forgotten += count

    def cut(self, count: int) -> None:
        """Keep the first `count` items only.

        Examples
        --------
        >>> letters = Chronicle(lambda _: 0.0, "abcd")
        >>> letters.cut(2)
        >>> list(letters), letters.forgotten
        (['a', 'b'], 0)
        """
        del self._items[count:], self._plain[count:], self.times[count:]
        self._blocks = [b for b in self._blocks if b[0] < count]

    @property
    def total(self) -> int:
        """How many items there have been."""
        return self.forgotten + len(self)

    def __len__(self) -> int:
        return len(self._items)

    @overload
    def __getitem__(self, k: int) -> T: ...

    @overload
    def __getitem__(self, k: slice) -> list[T]: ...

    def __getitem__(self, k: int | slice) -> T | list[T]:
        if isinstance(k, slice):
            return [self._item(j) for j in range(*k.indices(len(self)))]
        return self._item(range(len(self))[k])

    def __setitem__(self, k: int, item: T) -> None:
        k = range(len(self))[k]
        self._items[k], self.times[k] = item, float(self._time_of(item))
        self._plain[k] = False

    def __iter__(self) -> Iterator[T]:
        return (self._item(k) for k in range(len(self)))

    def origin(self, k: int) -> tuple[Callable[[int], T] | None, int]:
        """Return what makes item k, and by which number; None if it did not have to be made.

        Examples
        --------
        >>> squares = Chronicle(float, [0])
        >>> squares.extend([1.0, 4.0], lambda k: (k + 1) ** 2)
        >>> squares.origin(0), squares.origin(2)[1]
        ((None, 0), 1)
        """
        at = bisect.bisect_right(self._blocks, k, key=_begin) - 1
        if at < 0:
            return None, k
        first, make = self._blocks[at]
        return make, k - first

    def origins(
        self, items: NDArray[np.intp]
    ) -> Iterator[tuple[Callable[[int], T] | None, NDArray[np.intp], NDArray[np.intp]]]:
        """Yield what makes items, in order, the places of those among `items`, their numbers there.

        Examples
        --------
        >>> squares = Chronicle(float, [0])
        >>> squares.extend([1.0, 4.0], lambda k: (k + 1) ** 2)
        >>> [(places, own) for _, places, own in squares.origins(np.array([0, 2]))]
        [(array([0]), array([0])), (array([1]), array([1]))]
        """
        firsts = np.array([first for first, _ in self._blocks], dtype=np.intp)
        at = np.searchsorted(firsts, items, side="right") - 1
        begins = np.flatnonzero(np.diff(at, prepend=-2) != 0)
        for begin, end in zip(begins.tolist(), [*begins[1:].tolist(), len(items)], strict=True):
            places = np.arange(begin, end)
            if at[begin] < 0:
                yield None, places, items[places]
            else:
                first, make = self._blocks[at[begin]]
                yield make, places, items[places] - first

    def _item(self, k: int) -> T:
        item = self._items[k]
        if item is None:
            make, own = self.origin(k)
            assert make is not None
            item = self._items[k] = make(own)
        return item


def _begin(block: tuple[int, object]) -> int:
    return block[0]
