"""Where the law of a resistor ends in a flat piece, or bends towards a limit: in plain numbers."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

from hybond.model.expressions import (
    Expr,
    Number,
    Table,
    compile_expression,
    differentiate,
    names,
    transform,
    turning,
)
from hybond.model.expressions.slots import is_slotted, plain
from hybond.model.graph import Node
from hybond.model.kinds import RESISTORS
from hybond.records import dataclass

LEAST, MOST = -12, 12
"""Powers of ten, in SI units, between which corners are looked for."""
PER_DECADE = 6
JUMPS = 1e-9
"""Part of the height of a law by which its pieces may be apart at a corner."""
REACHED = 1e-6
"""Part of the height of a law that bends towards a limit within which it counts as that.

A hundred times the tolerance of runs, to which what is stored is known: nearer to its limit the law
turned round says nothing of its argument that is not noise.
"""


@dataclass(frozen=True, slots=True)
class End:
    """A flat end of a law, or one that it bends towards.

    Parameters
    ----------
    way : int
        1 at large values of the argument, -1 at those far below zero.
    at : float
        Where it begins, in SI; or where the law is near to its limit.
    outer : float or None
        Of one that it bends towards: the outermost corner on that side, or 0.
    """

    way: int
    at: float
    outer: float | None = None


def is_bent(node: Node) -> bool:
    """Whether a node is a resistor of one port whose law reads nothing but the variable there."""
    law = node.law
    return (
        node.kind in RESISTORS
        and law is not None
        and law.matrix is None
        and len(law.expressions) == 1
        and not (node.impulsive or node.controlled)
        and names(law.expressions[0]) == {argument_of(node)}
    )


def argument_of(node: Node) -> str:
    """Return the variable that the law of a resistor reads."""
    assert node.law is not None
    return "law:e" if node.law.output == "f" else "law:f"


def ends_of(node: Node) -> tuple[End, ...]:
    """Return the flat ends of a resistor's law, in numbers as they are now; none if it has none.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("limited")
    >>> m.add(u=hb.Se(1.0), d=hb.R({"f": "max(0, min(2, e))"}))
    >>> m.bond("u -> d")
    >>> [(end.way, end.at) for end in ends_of(m.flatten().nodes[1])]
    [(-1, 0.0), (1, 2.0)]
    """
    if not is_bent(node):
        return ()
    assert node.law is not None
    return ends_in_numbers(with_numbers(node.law.expressions[0], plain), argument_of(node))


@lru_cache(256)
def ends_in_numbers(e: Expr, own: str) -> tuple[End, ...]:
    """Return the flat ends of a law with plain numbers."""
    value = function_of(e, own)
    slope = function_of(differentiate(e, own), own)
    corners = sorted(corners_of(e, own))
    bounds = [-math.inf, *corners, math.inf]
    levels: list[float | None] = []
    for low, high in itertools.pairwise(bounds):
        inside = values_within(low, high)
        levels.append(value(inside[0]) if all(slope(x) == 0.0 for x in inside) else None)
    found = []
    for way, row, ends in ((-1, levels, bounds[1:]), (1, levels[::-1], bounds[-2::-1])):
        if row[0] is None:
            near = _near_limit(value, float(way), corners)
            if near is not None:
                found.append(near)
            continue
        at = next((x for x, level in zip(ends, row[1:]) if level != row[0]), None)
        if at is None:
            return ()  # it is flat everywhere
        beside = value(math.nextafter(at, -way * math.inf))
        if abs(beside - row[0]) <= JUMPS * max(abs(beside), abs(row[0]), _height(value, bounds)):
            found.append(End(way, at))
        else:
            return ()
    return tuple(found) if len(found) < 2 or found[0].at < found[1].at else ()


def _height(value: Callable[[float], float], bounds: list[float]) -> float:
    return max(abs(value(values_within(low, high)[0])) for low, high in itertools.pairwise(bounds))


def _near_limit(value: Callable[[float], float], way: float, corners: list[float]) -> End | None:
    """Return where a law is as near to a limit that it bends towards as counts as that."""
    outer = way * max((way * x for x in corners), default=0.0)
    far = way * 10.0**MOST
    limit, height = value(far), abs(value(far) - value(outer))
    if not (height > 0.0 and abs(limit - value(0.1 * far)) <= 1e-5 * REACHED * height):
        return None
    near, beyond = outer, far
    while (middle := 0.5 * (near + beyond)) not in (near, beyond):
        if abs(value(middle) - limit) > REACHED * height:
            near = middle
        else:
            beyond = middle
    return None if near == outer else End(int(way), near, outer)  # else it jumps there


def function_of(e: Expr, own: str) -> Callable[[float], float]:
    """Return an expression of one name as a function, nan where it has no value."""
    compiled = compile_expression(e, {own: 0}, pre_offset=0)

    def value(x: float) -> float:
        try:
            return float(compiled([x]))
        except (ArithmeticError, ValueError):
            return math.nan

    return value


def corners_of(e: Expr, own: str) -> set[float]:
    """Return where an expression has kinks: what is compared changes its sign there."""
    sizes = [10.0 ** (k / PER_DECADE) for k in range(LEAST * PER_DECADE, MOST * PER_DECADE + 1)]
    grid = [*(-x for x in reversed(sizes)), 0.0, *sizes]
    found = set()
    for atom in turning(e):
        compared = function_of(atom, own)
        at = [(x, compared(x)) for x in grid]
        for (low, a), (high, b) in itertools.pairwise(at):
            if a == 0.0:
                found.add(low)
            elif a * b < 0.0:
                found.add(_root(compared, low, high))
    return found


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function changes its sign, to the last digit."""
    before = f(low)
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return high if abs(f(high)) <= abs(f(low)) else low
        here = f(middle)
        if here == 0.0:
            return middle
        if here * before > 0.0:
            low = middle
        else:
            high = middle


def values_within(low: float, high: float) -> list[float]:
    """Return some values between two."""
    if math.isfinite(plain(low)) and math.isfinite(plain(high)):
        return [low + part * (high - low) for part in (0.5, 0.03, 0.97)]
    if math.isfinite(plain(low)):
        return [low + part * max(abs(low), 1.0) for part in (1.0, 1e-3, 1e3)]
    if math.isfinite(plain(high)):
        return [high - part * max(abs(high), 1.0) for part in (1.0, 1e-3, 1e3)]
    return [0.0, -1.0, 1.0]


def with_numbers(e: Expr, number: Callable[[float], float]) -> Expr:
    """Return an expression with numbers made of its numbers."""

    def made(node: Expr) -> Expr:
        if isinstance(node, Number) and is_slotted(node.value):
            return replace(node, value=number(node.value))
        if isinstance(node, Table) and any(map(is_slotted, (*node.x, *node.y))):
            return replace(node, x=tuple(map(number, node.x)), y=tuple(map(number, node.y)))
        return node

    return transform(e, made)
