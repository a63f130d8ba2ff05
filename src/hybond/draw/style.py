"""How each role looks, for every writer: one table.

The rows are in cascade order: of two words of one role, the later one wins.
"""

from __future__ import annotations

from dataclasses import dataclass

FONT = 'Helvetica, Arial, "DejaVu Sans", sans-serif'
PAPER = ("#ffffff", "#1c1c20")


@dataclass(frozen=True, slots=True)
class Style:
    """Looks of a role; None leaves what earlier words said."""

    ink: tuple[str, str] | None = None
    """Colour on white and on dark paper."""
    width: float | None = None
    """Of lines, in pixels."""
    dash: tuple[float, float] | None = None
    """Lengths of dash and gap, in pixels."""
    size: float | None = None
    """Of letters, in pixels."""
    bold: bool | None = None
    italic: bool | None = None
    fill: tuple[str, str] | None = None
    """What a frame is filled with, on white and on dark paper; without it it is empty."""


_INK = ("#161616", "#ececec")
_SOFT = ("#555555", "#b4b4b4")
_OFF = ("#a6a6a6", "#6c6c72")
# The hues of M. Okabe and K. Ito (2008), which stay apart for colour-blind readers; what they
# mean is said by a dash, a breadth, a cross or a word as well, for print in black and white.
_BLUE = ("#1f5fa8", "#82b6f2")
_ORANGE = ("#d96b00", "#ffa040")
_RED = ("#b3003c", "#ff6f91")
_PURPLE = ("#7b3294", "#d3a4e6")
_GREEN = ("#00734f", "#5fd0a8")

STYLES: dict[str, Style] = {
    # lines
    "bond": Style(_INK, 1.5),
    "barb": Style(_INK, 1.5),
    "stroke": Style(_INK, 1.9),
    "cross": Style(_INK, 1.9),
    "switch": Style(_SOFT, 1.2, (1.5, 2.5)),
    "part": Style(_INK, 1.3),
    "opened": Style(("#8a8a8a", "#8a8a92"), 1.0),
    "panel": Style(("#d4d4d4", "#44444c"), 0.8),
    "wire": Style(_INK, 1.4),
    "symbol": Style(_INK, 1.4),
    "filled": Style(_INK, 1.4, fill=_INK),
    # pale grounds
    "region": Style(("#dfebf7", "#243447")),
    "ground": Style(("#dfebf7", "#243447"), 0.5, fill=("#dfebf7", "#243447")),
    "emphasis": Style(("#ffedab", "#453b14")),
    # texts
    "node": Style(_INK, size=19.0, bold=True),
    "sample": Style(_INK, size=13.0, bold=True),
    "junction": Style(bold=False),
    "boxed": Style(size=13.0),
    "partname": Style(_SOFT, size=11.0, bold=True),
    "subscript": Style(_INK, size=11.0, italic=True),
    "name": Style(_INK, size=10.5),
    "junctionname": Style(_INK, size=10.5, italic=True),
    "parameter": Style(_SOFT, size=10.5),
    "machine": Style(_BLUE, size=10.0),
    "number": Style(_SOFT, size=9.0),
    "word": Style(_INK, size=11.0),
    "title": Style(_INK, size=13.0, bold=True),
    "caption": Style(_SOFT, size=11.5),
    "legend": Style(_SOFT, size=10.5),
    "badge": Style(_SOFT, 0.9, size=9.0, fill=("#f3f3f3", "#2b2b30")),
    "blue": Style(_BLUE, fill=("#e6f0fa", "#1d2c3e")),
    "orange": Style(("#9a4a00", "#ffa040"), fill=("#fdeeda", "#3f2a10")),
    "red": Style(_RED, fill=("#fbe3ea", "#46141f")),
    "purple": Style(_PURPLE, fill=("#f1e4f5", "#37223f")),
    "green": Style(_GREEN, fill=("#dcf3ea", "#12382b")),
    # states
    "dynamic": Style(_BLUE, 1.9, (3.8, 1.8)),
    "derivative": Style(_ORANGE, 3.2),
    "off": Style(_OFF),
    "conflict": Style(_RED, 2.4),
}


def look(role: str) -> Style:
    """Return the style of a role of one or more words.

    Examples
    --------
    >>> look("stroke derivative").width, look("stroke dynamic").dash
    (3.2, (3.8, 1.8))
    """
    words = set(role.split())
    ink, width, dash, size, bold, italic, fill = _INK, 1.5, None, 11.0, False, False, None
    for word, style in STYLES.items():
        if word in words:
            ink = style.ink or ink
            width = style.width if style.width is not None else width
            dash = style.dash or dash
            size = style.size or size
            bold = style.bold if style.bold is not None else bold
            italic = style.italic if style.italic is not None else italic
            fill = style.fill or fill
    return Style(ink, width, dash, size, bold, italic, fill)
