"""Names of Modelica for the names of a model, and units as Modelica writes them."""

from __future__ import annotations

import re

from hybond.units import Dimension

_TAKEN = """algorithm and annotation assert block break class connect connector constant
constrainedby der discrete each else elseif elsewhen encapsulated end enumeration equation
expandable extends external false final flow for function if import impure in initial inner input
loop model not operator or outer output package parameter partial protected public pure record
redeclare replaceable return stream then true type when while within time abs sign sqrt div mod rem
ceil floor integer sin cos tan asin acos atan atan2 sinh cosh tanh exp log log10 max min pre edge
change reinit sample terminal terminate smooth noEvent delay Real Integer Boolean String"""
_WORDS = frozenset(_TAKEN.split())


class Identifiers:
    """Gives each thing a name of its own that Modelica allows.

    Examples
    --------
    >>> names = Identifiers()
    >>> names.of("x:0", "ball.p"), names.of("other", "ball_p"), names.of("x:0", "ball.p")
    ('ball_p', 'ball_p_2', 'ball_p')
    >>> names.of("n", "in"), names.of("b", '"a -> b".e')
    ('in_', 'a_b_e')
    """

    def __init__(self) -> None:
        self._given: dict[str, str] = {}
        self._taken: set[str] = set(_WORDS)

    def of(self, key: str, wish: str) -> str:
        """Return the name of `key`, at the first time one like `wish`."""
        if key not in self._given:
            stem = re.sub(r"[^A-Za-z0-9]+", "_", wish).strip("_") or "v"
            if stem[0].isdigit():
                stem = f"v_{stem}"
            name, number = (f"{stem}_" if stem in _WORDS else stem), 1
            while name in self._taken:
                number += 1
                name = f"{stem}_{number}"
            self._taken.add(name)
            self._given[key] = name
        return self._given[key]


def unit_text(unit: Dimension | str | None) -> str:
    """Return a unit as Modelica writes it; empty if there is none or Modelica cannot write it.

    Examples
    --------
    >>> unit_text("N*s"), unit_text("m/s^2"), unit_text("m^3/(N*s)"), unit_text("1")
    ('N.s', 'm/s2', 'm3/(N.s)', '')
    """
    text = "" if unit is None else str(unit)
    if text == "1" or "^(" in text or not text.isascii():
        return ""
    return text.replace("*", ".").replace("^", "")


def in_unit(unit: Dimension | str | None) -> str:
    """Return how a declaration gives its unit; nothing where there is none to write.

    Examples
    --------
    >>> in_unit("N*s"), in_unit(None)
    ('(unit = "N.s")', '')
    """
    text = unit_text(unit)
    return f'(unit = "{text}")' if text else ""


def quoted(text: str) -> str:
    r"""Return a text as a string of Modelica, on one line.

    Examples
    --------
    >>> print(quoted('a "b" \\ c'))
    "a \"b\" \\ c"
    """
    plain = " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{plain}"'
