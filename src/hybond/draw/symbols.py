"""Symbols of parts on paper: turned so that their pins point where their wires go."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from hybond.draw.geometry import Box, Point
from hybond.draw.measure import width
from hybond.draw.scene import Line, Mark, Text
from hybond.model.symbol import Symbol, points_of

UNIT = 20.0
"""Pixels of a unit of symbols."""
WORD = 11.0
"""Size of words in symbols."""
_ARC = 28
"""Sides of a circle."""
_TURNS: tuple[tuple[float, float, float, float], ...] = (
    (1, 0, 0, 1),
    (0, -1, 1, 0),
    (-1, 0, 0, -1),
    (0, 1, -1, 0),
    (1, 0, 0, -1),
    (-1, 0, 0, 1),
    (0, 1, 1, 0),
    (0, -1, -1, 0),
)
"""As written, turned by quarters, and mirrored: rows of a matrix."""
_UPRIGHT = (_TURNS[0], _TURNS[5])


@dataclass(frozen=True, slots=True)
class Placed:
    """A symbol on paper.

    Parameters
    ----------
    marks : tuple
        Lines and texts, in pixels.
    pins : mapping of port to (place, direction)
        Where a wire ends, and the way it leaves.
    box : Box
        What it covers.
    """

    marks: tuple[Mark, ...]
    pins: Mapping[str, tuple[Point, Point]]
    box: Box


def placed(
    symbol: Symbol, at: Point, toward: Mapping[str, Point], *, facing: Point = (0.0, 0.0)
) -> Placed:
    """Put a symbol at a place, turned as its wires want it.

    Parameters
    ----------
    toward : mapping of port to (x, y)
        The way from the middle to what the port is wired to.
    facing : (x, y)
        The way in which its upper side looks, where its pins leave that open.

    Examples
    --------
    >>> two = Symbol({"a": (-2.0, 0.0), "b": (2.0, 0.0)}, ("-2,0 2,0",))
    >>> placed(two, (0.0, 0.0), {"a": (0.0, 1.0), "b": (0.0, -1.0)}).pins["a"]
    ((0.0, 40.0), (0.0, 1.0))
    """
    turns = _UPRIGHT if symbol.upright else _TURNS
    turn = max(turns, key=lambda t: _fit(symbol, t, toward, facing))

    def to(p: Point) -> Point:
        x, y = _turned(turn, p)
        return (at[0] + UNIT * x + 0.0, at[1] + UNIT * y + 0.0)

    lines = [points_of(text) for text in symbol.lines]
    fills = [points_of(text) for text in symbol.fills]
    lines += [_circle(x, y, r) for x, y, r in symbol.circles]
    marks: list[Mark] = [Line("symbol", tuple(map(to, points))) for points in lines]
    marks += [Line("symbol filled", tuple(map(to, points))) for points in fills]
    for text, x, y in symbol.words:
        u, v = to((x, y))
        marks.append(Text("word", text, u, v + 0.36 * WORD))
    pins = {port: (to(p), _way(turn, p)) for port, p in symbol.pins.items()}
    every = [p for m in marks if isinstance(m, Line) for p in m.points]
    every += [p for p, _ in pins.values()]
    every += [(m.x, m.y) for m in marks if isinstance(m, Text)] or [at]
    xs, ys = zip(*every)
    return Placed(tuple(marks), pins, Box(min(xs), min(ys), max(xs), max(ys)))


def _fit(
    symbol: Symbol,
    turn: tuple[float, float, float, float],
    toward: Mapping[str, Point],
    facing: Point,
) -> float:
    """Return how well the pins point where they are wired to; as written where it is the same."""
    x, y = _turned(turn, (0.0, -1.0))
    total = -0.01 * _TURNS.index(turn) + 0.2 * (x * facing[0] + y * facing[1])
    for port, pin in symbol.pins.items():
        if port in toward:
            (x, y), (u, v) = _turned(turn, pin), toward[port]
            total += (x * u + y * v) / (math.hypot(u, v) or 1.0)
    return total


def _turned(turn: tuple[float, float, float, float], p: Point) -> Point:
    a, b, c, d = turn
    return (a * p[0] + b * p[1], c * p[0] + d * p[1])


def _way(turn: tuple[float, float, float, float], pin: Point) -> Point:
    """Return the way in which a wire leaves a pin: that of its greater distance."""
    x, y = _turned(turn, pin)
    if abs(x) >= abs(y):
        return (math.copysign(1.0, x), 0.0)
    return (0.0, math.copysign(1.0, y))


def _circle(x: float, y: float, r: float) -> tuple[Point, ...]:
    angles = [2.0 * math.pi * k / _ARC for k in range(_ARC + 1)]
    return tuple((x + r * math.cos(a), y + r * math.sin(a)) for a in angles)


def boxed(title: str, ports: Sequence[str], side_of: Callable[[str], str]) -> Symbol:
    """Return a box with named ports, for a part without a symbol.

    Parameters
    ----------
    side_of : callable
        ``"w"``, ``"e"``, ``"n"`` or ``"s"`` for each port: where it is wired to.

    Examples
    --------
    >>> boxed("motor", ["a", "b"], lambda p: {"a": "w", "b": "e"}[p]).pins
    {'a': (-2.0, 0.0), 'b': (2.0, 0.0)}
    """
    sides: dict[str, list[str]] = {"w": [], "e": [], "n": [], "s": []}
    for port in ports:
        sides[side_of(port)].append(port)
    high = max(1.0, 0.5 * (1 + max(len(sides["w"]), len(sides["e"]))))
    half = max(1.5, (width(title, WORD) + 12.0) / 2.0 / UNIT)
    half = max(half, 0.75 * max(len(sides["n"]), len(sides["s"])))
    pins: dict[str, Point] = {}
    lines = [_outline(half, high)]
    for side, (ux, uy) in {"w": (-1, 0), "e": (1, 0), "n": (0, -1), "s": (0, 1)}.items():
        many = len(sides[side])
        for k, port in enumerate(sides[side]):
            along = (k - (many - 1) / 2.0) * (1.0 if ux else 1.5)
            edge = (ux * half, along) if ux else (along, uy * high)
            pin = (edge[0] + 0.5 * ux, edge[1] + 0.5 * uy)
            pins[port] = pin
            lines.append(f"{edge[0]:g},{edge[1]:g} {pin[0]:g},{pin[1]:g}")
    return Symbol(pins, tuple(lines), words=((title, 0.0, 0.0),))


def _outline(half: float, high: float) -> str:
    corners = [(-half, -high), (half, -high), (half, high), (-half, high), (-half, -high)]
    return " ".join(f"{x:g},{y:g}" for x, y in corners)
