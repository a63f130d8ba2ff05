"""A scene: lines and texts with their roles and places, ready for any writer.

Roles are words of `style.STYLES`; a mark may have several: ``"stroke dynamic"``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from hybond.draw.geometry import Box, Point

# Characters that XML 1.0 cannot hold, even escaped; no font has them either.
_ILLEGAL = re.compile("[^\t\n\r\u0020-\u007e\u00a0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def printable(text: str) -> str:
    r"""Return `text` with control characters replaced.

    Examples
    --------
    >>> printable("a\x00b")
    'a�b'
    """
    return _ILLEGAL.sub("�", text)


@dataclass(frozen=True, slots=True)
class Line:
    """A polyline."""

    role: str
    points: tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class Text:
    """A text; (x, y) is on its baseline."""

    role: str
    text: str
    x: float
    y: float
    anchor: Literal["start", "middle", "end"] = "middle"


@dataclass(frozen=True, slots=True)
class Frame:
    """A rounded rectangle."""

    role: str
    box: Box
    radius: float = 6.0


@dataclass(frozen=True, slots=True)
class Band:
    """A broad pale line with round ends that lies under everything else."""

    role: str
    points: tuple[Point, ...]
    breadth: float


Mark = Line | Text | Frame | Band


@dataclass(frozen=True, slots=True)
class Group:
    """Marks that belong together: one node, one bond, the legend."""

    name: str
    key: str
    """Path of the node or name of the bond."""
    about: str
    """Text that appears when the pointer rests on the group."""
    marks: tuple[Mark, ...]


@dataclass(frozen=True, slots=True)
class Scene:
    """A picture of `width` by `height` pixels."""

    width: float
    height: float
    groups: tuple[Group, ...]
    title: str = ""
