"""Names of a bond graph from those of a netlist: letters, digits and _, each used once."""

from __future__ import annotations

import re

from hybond.model.builder import RESERVED


class GraphNames:
    """Gives out names that a model may have, each once, whatever the case of letters.

    Examples
    --------
    >>> names = GraphNames()
    >>> [names.take(t) for t in ("X1.R+3", "x1_r_3", "pi")], names.take("3", "n")
    (['X1_R_3', 'x1_r_3_2', 'pi_2'], 'n3')
    """

    def __init__(self) -> None:
        self._taken = {word.lower() for word in RESERVED}
        self._next: dict[str, int] = {}

    def free(self, text: str) -> bool:
        """Whether a name is still to be had, as it is."""
        return text.lower() not in self._taken

    def take(self, text: str, prefix: str = "") -> str:
        """Return the name for a text; `prefix` comes before one that begins with a digit."""
        stem = re.sub(r"[^A-Za-z0-9_]+", "_", text).rstrip("_") or (prefix or "x")
        if not re.match(r"[A-Za-z_]", stem):
            stem = f"{prefix or 'x'}{stem}"
        name = stem
        while name.lower() in self._taken:
            number = self._next.get(stem.lower(), 1) + 1
            self._next[stem.lower()] = number
            name = f"{stem}_{number}"
        self._taken.add(name.lower())
        return name
