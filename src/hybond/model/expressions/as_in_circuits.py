"""Values of elements as circuit simulators write them, ``V(C)`` and ``I(L)``."""

from __future__ import annotations

import re

_OF_ONE = re.compile(r"\(\s*([A-Za-z_][\w.]*)\s*\)")
_CALLED = {"v": ("voltage", "e"), "u": ("voltage", "e"), "i": ("current", "f")}


def called_as_in_circuits(function: str, rest: str) -> str:
    """Return the remedy for ``V(C)`` and ``I(L)``, as circuit simulators have them.

    Examples
    --------
    >>> called_as_in_circuits("V", "(C) > 2"), called_as_in_circuits("V", "(a, b)")
    ('the voltage of C is its effort, C.e', '')
    """
    match = _OF_ONE.match(rest)
    if match is None or function.lower() not in _CALLED:
        return ""
    what, variable = _CALLED[function.lower()]
    kind = "effort" if variable == "e" else "flow"
    return f"the {what} of {match[1]} is its {kind}, {match[1]}.{variable}"
