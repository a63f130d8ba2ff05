"""Records: references, arrays of them, rings, what is shared."""

from __future__ import annotations

from typing import Final

from hybond.engine.words import (
    Floats,
    Records,
    Text,
    floats,
    put_int,
    put_line,
    put_number,
    put_text,
    record,
    records,
    some,
)

ROOM: Final = 3


@record
class Link:
    """One link of a chain."""

    value: float  # what it carries
    next: Link | None
    name: Text
    row: Floats
    """Of two."""
    used: bool
    count: int


@record
class Shelf:
    links: Records[Link]
    free: int


def make_shelf() -> Shelf:
    """Return a shelf of links that are not there yet."""
    s = Shelf()
    s.links = records(Link, ROOM)
    return s


def link_of(s: Shelf, k: int) -> Link:
    """Return a link, made when it is first asked for."""
    if s.links[k] is None:
        made = Link()
        made.row = floats(2)
        made.name = "new" if k != 1 else "second"
        s.links[k] = made
        s.free += 1
    return some(s.links[k])


def total(first: Link) -> float:
    """Sum along the chain."""
    at: Link | None = first
    result = 0.0
    while at is not None:
        result += at.value + at.row[0]
        at = at.next
    return result


def system(double: int) -> int:
    """Names that are words elsewhere."""
    new = double + 1
    for long in range(new):
        new += long
    return new


def even(n: int) -> bool:
    """One of two functions that call each other."""
    return True if n == 0 else odd(n - 1)


def odd(n: int) -> bool:
    """The other one."""
    return False if n == 0 else even(n - 1)


def report() -> None:
    """Write all."""
    s = make_shelf()
    first = link_of(s, 0)
    first.value = 1.5
    other = link_of(s, 2)
    other.value = 2.5
    first.next = other
    row = other.row
    row[0] = 10.0
    same = link_of(s, 2)
    same.value += 0.25
    same.count -= 3
    second = link_of(s, 1)
    second.used = s.links[0] is not None and s.links[1] is not None
    put_number(total(first))
    put_line()
    put_int(s.free * 10 + same.count + system(3))
    put_text(link_of(s, 1).name)
    put_text(link_of(s, 2).name)
    put_text(" used" if link_of(s, 1).used and not other.used else " idle")
    put_text(" named" if first.name != "" else " nameless")
    nameless = Link()
    put_text(nameless.name)
    put_text(" nameless" if nameless.name == "" else " named")
    put_text(" even\n" if even(10) else " odd\n")
