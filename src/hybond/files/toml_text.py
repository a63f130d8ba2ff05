"""Plain data to a fresh TOML text, laid out for people."""

from __future__ import annotations

import json
import re
from typing import Any

ORDER = (
    "hybond",
    "name",
    "title",
    "about",
    "domain",
    "indeterminate",
    "parameters",
    "elements",
    "graph",
    "signals",
    "inputs",
    "machines",
    "blocks",
    "causality",
    "ports",
    "models",
    "experiment",
    "symbol",
    "layout",
)
"""The order of the keys and sections of a model."""

WIDTH = 100
_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


def toml_text(data: dict[str, Any]) -> str:
    """Return the TOML text of the data of a model file.

    Examples
    --------
    >>> print(toml_text({"hybond": 1, "elements": {"v": {"junction": 1}}}), end="")
    hybond = 1
    <BLANKLINE>
    [elements]
    v = { junction = 1 }
    """
    return "\n\n".join(_model(data, ())) + "\n"


def table_text(path: tuple[str, ...], data: dict[str, Any]) -> str:
    """Return the text of a new table at `path`, with the tables within it."""
    within = path
    while within[:1] == ("models",) and len(within) > 1:
        within = within[2:]
    if not within:
        return "\n\n".join(_model(data, path))
    return "\n\n".join(_section(path, within, data))


def entry_text(key: str, value: Any) -> str:
    """Return ``key = value``; a list that would make the line too long gets a line per item."""
    line = f"{key_text(key)} = {value_text(value)}"
    if len(line) <= WIDTH or not isinstance(value, list) or len(value) < 2:
        return line
    items = "".join(f"  {value_text(item)},\n" for item in value)
    return f"{key_text(key)} = [\n{items}]"


def value_text(value: Any) -> str:
    """Return a value on one line.

    Examples
    --------
    >>> value_text({"C": "1 mm/N", "q": [0.1, 0], "x y": True})
    '{ C = "1 mm/N", q = [0.1, 0], "x y" = true }'
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    if isinstance(value, dict):
        inside = ", ".join(f"{key_text(k)} = {value_text(v)}" for k, v in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    return repr(value)  # the shortest text that reads back as the same number


def key_text(key: str) -> str:
    """Return a key, quoted if it must be."""
    return key if _BARE.match(key) else _text(key)


def _text(value: str) -> str:
    if '"' in value and value.isprintable() and not {"'", "\\"} & set(value):
        return f"'{value}'"  # a guard that asks for the name of a state
    # The escapes of JSON are escapes of TOML; but TOML also forbids a bare DEL.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _model(data: dict[str, Any], path: tuple[str, ...]) -> list[str]:
    """Return the text blocks of a model: its own keys, then its sections."""
    keys = sorted(data, key=lambda k: ORDER.index(k) if k in ORDER else len(ORDER))
    own = [entry_text(key, data[key]) for key in keys if not isinstance(data[key], dict)]
    if path and (own or not data):
        own.insert(0, _header(path))
    blocks = ["\n".join(own)] if own else []
    for key in keys:
        if isinstance(data[key], dict):
            blocks += _section((*path, key), (key,), data[key])
    return blocks


def _section(path: tuple[str, ...], within: tuple[str, ...], data: dict[str, Any]) -> list[str]:
    """Return the blocks of a section; `within` is its path in the model it belongs to."""
    if within in (("models",), ("machines",)) and data:
        # what is no table, where the data are those of a model half written
        loose = {k: v for k, v in data.items() if not isinstance(v, dict)}
        blocks = _section(path, (), loose) if loose else []
        for key, inner in data.items():
            if isinstance(inner, dict) and within == ("models",):
                blocks += _model(inner, (*path, key))
            elif isinstance(inner, dict):
                blocks += _section((*path, key), ("machines", key), inner)
        return blocks
    return ["\n".join([_header(path), *(entry_text(k, v) for k, v in data.items())])]


def _header(path: tuple[str, ...]) -> str:
    return "[" + ".".join(map(key_text, path)) + "]"
