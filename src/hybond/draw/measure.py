"""How wide a text is, without asking a font.

The widths are those of DejaVu Sans, which matplotlib brings along and which is wider than the
Helvetica or Arial that a browser will take, so that a text fits wherever it is shown.
"""

from __future__ import annotations

_NARROW = frozenset("iljI|.,:;'!()[]{}/\\ ·‹›-ftr\"²³°")
_WIDE = frozenset("mwMW@%…+=<>~ΩQOGD&→δ_")


def width(text: str, size: float, *, bold: bool = False) -> float:
    """Return the width of `text` at font size `size`, in the same unit, not too small.

    Examples
    --------
    >>> width("iii", 10.0) < width("aaa", 10.0) < width("MMM", 10.0)
    True
    """
    units = sum(
        0.42
        if c in _NARROW
        else 0.88
        if c in _WIDE
        else 0.70
        if c.isupper()
        else 0.64
        if ord(c) < 0x2E80
        else 1.05  # a script whose letters fill a square
        for c in text
    )
    return units * size * (1.1 if bold else 1.0)


def shorten(text: str, size: float, room: float, *, keep_end: bool = False) -> str:
    """Return `text`, cut with an ellipsis to fit into `room`.

    Parameters
    ----------
    keep_end : bool
        Cut at the front: the end of a dotted path says more than its beginning.

    Examples
    --------
    >>> shorten("a_very_long_name", 10.0, 60.0)
    'a_very_…'
    >>> shorten("plant.motor.coil", 10.0, 60.0, keep_end=True)
    '…otor.coil'
    """
    if width(text, size) <= room:
        return text
    for n in range(len(text) - 1, 0, -1):
        cut = "…" + text[-n:] if keep_end else text[:n] + "…"
        if width(cut, size) <= room:
            return cut
    return "…"


def abridged(text: str, size: float, room: float) -> str:
    """Return `text` with its middle left out where it takes more than `room`.

    Paths that begin and end alike differ at their ends.

    Examples
    --------
    >>> abridged("plant.motor.winding.e", 10.0, 80.0)
    'plant…nding.e'
    """
    if width(text, size) <= room:
        return text
    for n in range(len(text) - 1, 1, -1):
        cut = text[: n // 3 + 1] + "…" + text[len(text) - (n - n // 3) + 1 :]
        if width(cut, size) <= room:
            return cut
    return "…"


_BREAKS = (frozenset(" ·*+-,="), frozenset(" ·*+-,=/("))
"""After these a law may go on in the next line, the first where one of them will do."""


def wrapped(
    text: str, size: float, room: float, *, most: int, words: bool = False, bold: bool = False
) -> list[str]:
    """Return `text` in lines that fit into `room`, at most so many; the last one may be cut.

    Parameters
    ----------
    words : bool
        Break at spaces only, as in a title; else also after the signs of a law.
    bold : bool
        Whether it is printed bold.

    Examples
    --------
    >>> wrapped("a + b*(c + d)", 10.0, 40.0, most=3)
    ['a + b*', '(c + d)']
    >>> wrapped("Ball on a springy floor", 10.0, 60.0, most=2, words=True)
    ['Ball on a', 'springy f…']
    """

    def fits(line: str) -> bool:
        return width(line, size, bold=bold) <= room

    lines: list[str] = []
    rest = text
    while rest:
        if fits(rest):
            lines.append(rest)
            break
        if len(lines) == most - 1:
            lines.append(shorten(rest, size * (1.1 if bold else 1.0), room))
            break
        end = 0
        for signs in (frozenset(" "),) if words else _BREAKS:
            ends = (k + 1 for k, c in enumerate(rest) if c in signs)
            end = end or max((k for k in ends if fits(rest[:k].rstrip())), default=0)
        if end == 0:  # one word that is too long
            lines.append(shorten(rest, size * (1.1 if bold else 1.0), room))
            break
        lines.append(rest[:end].rstrip())
        rest = rest[end:].lstrip()
    return lines
