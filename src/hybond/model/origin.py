"""Where a model was read from: which line of which file says what.

A model may be changed after it was read. What is then no more as the file says is not looked for
there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from hybond.records import dataclass

SECTIONS = ("elements", "parameters", "signals", "inputs", "machines", "blocks", "ports")
"""What a model has by name."""
KEYS = ("domain", "indeterminate", "experiment", "bonds")
"""What it has besides."""

Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Origin:
    """The place of a model in a file.

    Parameters
    ----------
    within : callable
        From the path of a key in the model to the file, the line and what the line says.
    read : mapping
        What was read, by section.
    """

    within: Callable[[Path], tuple[str, int | None, str]]
    read: Mapping[str, Any]


def snapshot(model: Any) -> dict[str, Any]:
    """Return what a model says now, to be compared with what it says later.

    Examples
    --------
    >>> import hybond as hb
    >>> snapshot(hb.Model("m", parameters={"r": 2}))["parameters"]
    {'r': 2}
    """
    found: dict[str, Any] = {name: dict(getattr(model, name)) for name in SECTIONS}
    for name in KEYS:
        value = getattr(model, name)
        found[name] = list(value) if isinstance(value, list) else value
    return found


def as_read(model: Any, section: str, key: str | int | None = None) -> bool:
    r"""Whether a part of a model is still what the file says.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.loads('hybond = 1\n[parameters]\nr = 2\n')
    >>> before = as_read(m, "parameters", "r")
    >>> m.parameter(r=3)
    >>> before, as_read(m, "parameters", "r")
    (True, False)
    """
    if model.origin is None:
        return False
    then, now = model.origin.read[section], getattr(model, section)
    if key is None:
        return bool(then is now or then == now)
    try:
        return bool(then[key] is now[key] or then[key] == now[key])
    except (KeyError, IndexError):
        return False
