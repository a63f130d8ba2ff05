"""Model files and netlists to a Model and back."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hybond.files.encode import to_data
    from hybond.files.load import from_data, load, loads
    from hybond.files.save import dumps, save

_HOME = {
    **dict.fromkeys(("from_data", "load", "loads"), "hybond.files.load"),
    **dict.fromkeys(("dumps", "save"), "hybond.files.save"),
    "to_data": "hybond.files.encode",
}

__all__ = ["dumps", "from_data", "load", "loads", "save", "to_data"]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'hybond.files' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOME[name]), name)
    return value
