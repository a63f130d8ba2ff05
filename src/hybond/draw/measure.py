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
