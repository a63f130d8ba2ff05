"""Badges: short words on the elements of a drawing, such as what an analysis found of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hybond.errors import UsageError
from hybond.names import did_you_mean

Tone = Literal["grey", "blue", "orange", "red", "purple", "green"]
TONES: tuple[Tone, ...] = ("grey", "blue", "orange", "red", "purple", "green")

KNOWN: dict[str, Tone] = {
    "derivative": "orange",
    "dependent": "orange",
    "loop": "blue",
    "stiff": "purple",
    "uncontrollable": "red",
    "unobservable": "red",
    "conflict": "red",
    "controllable": "green",
    "observable": "green",
    "invariant": "green",
}
"""The colours of the words that analyses use; any other word is grey."""


@dataclass(frozen=True, slots=True)
class Badge:
    """A short text in a coloured frame, beside an element."""

    text: str
    tone: Tone = "grey"


def badges(marks: Mapping[str, str | tuple[str, str] | Badge]) -> dict[str, Badge]:
    """Return the badges that `marks` stand for.

    Parameters
    ----------
    marks : mapping of path to mark
        A mark is a word, or ``(text, tone)``. The word decides on the tone: see `KNOWN`.

    Raises
    ------
    UsageError
        HB-D107 for a tone that does not exist.

    Examples
    --------
    >>> badges({"pad": "derivative", "ball": ("12 kHz", "purple")})["pad"].tone
    'orange'
    """
    found = {}
    for path, mark in marks.items():
        if isinstance(mark, str):
            words = mark.split()
            known = [KNOWN[w] for w in words if w in KNOWN]
            mark = Badge(mark, known[0] if known else "grey")
        elif isinstance(mark, tuple):
            tones = [t for t in TONES if t == mark[1]]
            if not tones:
                raise UsageError(
                    f"there is no tone {mark[1]!r}",
                    code="HB-D107",
                    where=path,
                    hint=did_you_mean(mark[1], TONES) or f"one of {', '.join(TONES)}",
                )
            mark = Badge(mark[0], tones[0])
        found[path] = mark
    return found
