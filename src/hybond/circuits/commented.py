"""The text of a converted model, each element with the line that it comes from."""

from __future__ import annotations

import re

from hybond.circuits.circuit import Conversion
from hybond.files import dumps
from hybond.files.place import shortened

WIDTH = 60
"""Characters of a line of the netlist that a comment shows."""
_ENTRY = re.compile(r"([A-Za-z_][A-Za-z0-9_]*) = ")


def commented_text(conversion: Conversion) -> str:
    """Return a conversion as the text of a TOML model file with comments.

    Examples
    --------
    >>> from hybond.model.builder import Model
    >>> from hybond.model.constructors import R, Se
    >>> model = Model("lamp", domain="electrical")
    >>> model.add(V1=Se("10 V"), R1=R("5 ohm"))
    >>> model.bond("V1 -> R1")
    >>> print(commented_text(Conversion(model, (), {"R1": "line 3: R1 in 0 5"})), end="")
    hybond = 1
    name = "lamp"
    domain = "electrical"
    <BLANKLINE>
    [elements]
    V1 = { Se = "10 V" }
    R1 = { R = "5 ohm" }  # line 3: R1 in 0 5
    <BLANKLINE>
    [graph]
    bonds = ["V1 -> R1"]
    """
    rows = dumps(conversion.model).split("\n")
    inside = False
    for k, row in enumerate(rows):
        if row.startswith("["):
            inside = row == "[elements]"
        elif inside and (match := _ENTRY.match(row)) and match[1] in conversion.origins:
            # a control character would end the comment, or make the file no TOML
            plain = "".join(c if c.isprintable() else " " for c in conversion.origins[match[1]])
            rows[k] = f"{row}  # {shortened(plain, WIDTH)}"
    return "\n".join(rows)
