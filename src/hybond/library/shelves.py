"""Where ready parts are found, by name."""

from __future__ import annotations

import copy
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.names import did_you_mean

SHELVES = Path(__file__).parent
"""Where the parts are: a folder for each domain."""


@cache
def names() -> tuple[str, ...]:
    """Return the names of all parts, in order.

    Examples
    --------
    >>> import hybond as hb
    >>> "electrical.diode" in hb.library.names()
    True
    """
    # looked for once: each part that a model uses is asked for among them
    found = (path.relative_to(SHELVES).with_suffix("") for path in SHELVES.glob("*/*.toml"))
    return tuple(sorted(".".join(path.parts) for path in found))


@cache
def find(name: Any) -> Model | None:
    """Return the part of a name, shared by all who ask, or None."""
    if not isinstance(name, str) or name not in names():
        return None
    from hybond.files.load import load

    found = load(SHELVES.joinpath(*name.split(".")).with_suffix(".toml"))
    found.origin = None  # what is refused in a part is said where the part is used
    return found


def title_of(name: str) -> str:
    """Return the title of a part, for lists: its file is read no further than its first section.

    Examples
    --------
    >>> import hybond as hb
    >>> title_of("electrical.diode") == hb.library.sheet("electrical.diode").title
    True
    """
    text = SHELVES.joinpath(*name.split(".")).with_suffix(".toml").read_text(encoding="utf-8")
    head = re.split(r"(?m)^\[", text, maxsplit=1)[0]
    try:
        found = tomllib.loads(head)
    except tomllib.TOMLDecodeError:  # a line of a longer text begins like a section
        found = tomllib.loads(text)
    return str(found.get("title") or name.rpartition(".")[2])


def part(name: str) -> Model:
    """Return a copy of a part, to look at or to change.

    Raises
    ------
    ModelError
        HB-M105 if there is no such part.

    Examples
    --------
    >>> import hybond as hb
    >>> sorted(hb.library.part("electrical.diode").ports)
    ['minus', 'plus']
    """
    found = find(name)
    if found is None:
        raise ModelError(
            f"there is no ready part {name!r}",
            code="HB-M105",
            where=name,
            hint=did_you_mean(name, names()),
        )
    return copy.deepcopy(found)
