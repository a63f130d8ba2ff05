"""Loops and branches: bounds that move, variables of many blocks, ways out.

This docstring has `marks`, ``marks`` and an end of comment: */ which must not end it.
"""

from __future__ import annotations

from hybond.engine.words import Ints, Text, ints, put_int, put_line, put_text


def put(name: Text, i: int) -> None:
    """Write a name and a number.

    Parameters
    ----------
    name : str
        In front.
    i : int
        Behind.

    Examples
    --------
    >>> put("a", 1)
    a 1
    """
    put_text(name)
    put_text(" ")
    put_int(i)
    put_line()


def grow(v: Ints) -> int:
    """The bound is asked once, at the beginning."""
    n = 3
    rounds = 0
    for i in range(n):
        n = n + 1  # does not lengthen the loop
        rounds += i
    for i in range(v[0]):
        v[0] = v[0] + 2
        rounds += 10 * i
    put("n", n)
    return rounds


def bump(v: Ints) -> None:
    """Change what a bound reads."""
    v[1] += 1


def calls(v: Ints) -> int:
    """The body's call changes the bound."""
    rounds = 0
    for _ in range(v[1]):
        bump(v)
        rounds += 1
    return rounds


def late(n: int) -> int:
    """A variable that both branches make, and loops that go down."""
    if n % 2 == 0:
        x = n // 2
    elif n > 5:
        # a comment for this branch
        x = 3 * n
    else:
        x = -n
        # a comment at the end
    total = 0
    for i in range(n, 0, -2):
        total += i * x
    for i in range(n - 1, -1, -1):
        total -= i
    return total


def twice(n: int) -> int:
    """One name in two blocks, each with its own value."""
    total = 0
    for i in range(n):
        part = i * i
        total += part
    while total > 20:
        part = total // 3
        if part > 100:
            continue
        total -= part
        if part == 9:
            break
    return total


def search(v: Ints, n: int, wanted: int) -> int:
    """Leave a loop in a loop."""
    while True:
        found = -1
        for i in range(n):
            if v[i] == wanted:
                found = i
                break
        if found >= 0:
            break
        wanted -= 1
    return found


def nothing(n: int, unread: float) -> None:
    """Do nothing, in several ways."""
    if n > 0:
        pass
    else:
        return
    for _ in range(n):
        pass


def report() -> None:
    """Write all."""
    v = ints(4)
    v[0] = 2
    v[1] = 3
    v[3] = 8
    put("grow", grow(v))
    put("calls", calls(v))
    put("left", v[1])
    for n in range(9):
        put("late", late(n))
    put("twice", twice(6))
    put("search", search(v, 4, 12))
    nothing(3, 1.0)
