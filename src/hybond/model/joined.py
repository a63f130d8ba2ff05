"""Items in groups: which of them hang together when one pair after the other is joined."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import Generic, TypeVar

K = TypeVar("K", bound=Hashable)


class Joined(Generic[K]):
    """Groups of items; each is a group of its own until it is joined to another.

    Parameters
    ----------
    items : iterable, optional
        Those that are in some group whether they are joined or not.

    Examples
    --------
    >>> joined = Joined(range(5))
    >>> joined.join([3, 1])
    >>> joined.join([4, 3])
    >>> joined.groups()
    [[0], [1, 3, 4], [2]]
    """

    def __init__(self, items: Iterable[K] = ()) -> None:
        self._above: dict[K, K] = {item: item for item in items}

    def root(self, item: K) -> K:
        """Return the item that stands for the group of another."""
        above = self._above
        while (up := above.setdefault(item, item)) != item:
            above[item] = above[up]
            item = up
        return item

    def join(self, items: Iterable[K]) -> None:
        """Make one group of the groups of items; that of the first stands for it. Of none, none."""
        first = None
        for item in items:
            first = item if first is None else first
            self._above[self.root(item)] = self.root(first)

    def groups(self) -> list[list[K]]:
        """Return the groups; they, and the items in each, in the order in which these came."""
        found: dict[K, list[K]] = {}
        for item in list(self._above):
            found.setdefault(self.root(item), []).append(item)
        return list(found.values())
