"""The symbol of a part in schematics: lines, circles and words around its middle, and its pins.

Places are in quarters of 80 pixels: a symbol with two pins goes from -2 to 2. x is to the right
and y downwards, as in drawings.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from hybond.records import dataclass

Point = tuple[float, float]

LARGEST = 12.0
"""Farthest place from the middle."""
CORE = "core"
"""Parameter of a part of a circuit diagram: the couplings of a coil, divided by spaces."""
MARKS = 200
"""Most marks of a symbol."""
_PAIR = r"([+-]?(?:\d+\.?\d*|\.\d+)),([+-]?(?:\d+\.?\d*|\.\d+))\Z"


@dataclass(frozen=True, slots=True)
class Symbol:
    """What a part looks like.

    Parameters
    ----------
    pins : mapping of str to (x, y)
        Where the wires of its ports end.
    lines, fills : tuple of str
        Polylines and filled outlines as places: ``"-2,0 -0.5,0"``.
    circles : tuple of (x, y, r)
    words : tuple of (text, x, y)
        Texts by their middles.
    upright : bool
        Whether it is never turned: a tank, a weight.
    """

    pins: Mapping[str, Point]
    lines: tuple[str, ...] = ()
    fills: tuple[str, ...] = ()
    circles: tuple[tuple[float, float, float], ...] = ()
    words: tuple[tuple[str, float, float], ...] = ()
    upright: bool = False

    def to_data(self) -> dict[str, Any]:
        """Return the section of a model file.

        Examples
        --------
        >>> Symbol({"pin": (0.0, -1.0)}, ("0,-1 0,0",)).to_data()
        {'pins': {'pin': [0.0, -1.0]}, 'lines': ['0,-1 0,0']}
        """
        data: dict[str, Any] = {"pins": {k: list(v) for k, v in self.pins.items()}}
        rest = {"lines": self.lines, "fills": self.fills}
        data |= {k: list(v) for k, v in rest.items() if v}
        if self.circles:
            data["circles"] = [list(c) for c in self.circles]
        if self.words:
            data["words"] = [list(w) for w in self.words]
        if self.upright:
            data["upright"] = True
        return data


def points_of(text: str) -> tuple[Point, ...]:
    """Return the places of a polyline.

    Raises
    ------
    ValueError
        For a text that is none, and places too far out.

    Examples
    --------
    >>> points_of("-2,0 .5,0")
    ((-2.0, 0.0), (0.5, 0.0))
    """
    found = []
    for pair in text.split():
        match = re.match(_PAIR, pair, re.ASCII)
        if match is None:
            raise ValueError(f"{pair[:20]!r} is no place x,y")
        found.append((float(match[1]), float(match[2])))
    if len(found) < 2:
        raise ValueError(f"{text[:40]!r} has fewer than two places")
    if max(abs(v) for p in found for v in p) > LARGEST:
        raise ValueError(f"{text[:40]!r} goes farther out than {LARGEST:g}")
    return tuple(found)
