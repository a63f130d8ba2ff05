"""Levels of a model: the whole, and the submodels that are opened in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hybond.names import steps

Data = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Level:
    """One model of a file, as it is opened.

    Parameters
    ----------
    path : str
        Of the instance, such as ``"car.wheel"``; empty for the whole model.
    keys : tuple of str or None
        Where the file says it: ``()``, or ``("models", "wheel")``. None for what the file does
        not say itself, a ready part or another file: it can be looked at.
    data : dict
        What is said there.
    name : str
        Of the model that is opened.
    """

    path: str
    keys: tuple[str, ...] | None
    data: Data
    name: str = ""

    @property
    def editable(self) -> bool:
        """Whether the file says it itself."""
        return self.keys is not None


def level_of(data: Data, path: str) -> Level | None:
    """Return the level that a path of instances opens, None if there is no such submodel.

    Examples
    --------
    >>> inner = {"elements": {"m": {"I": 1}}}
    >>> data = {"models": {"wheel": inner}, "elements": {"left": {"submodel": "wheel"}}}
    >>> level_of(data, "left").keys, level_of(data, "right")
    (('models', 'wheel'), None)
    """
    level = Level("", (), data, str(data.get("name", "")))
    known: dict[str, tuple[tuple[str, ...] | None, Data]] = _models(level)
    for part in steps(path) if path else ():
        element = table(level.data, "elements").get(part)
        name = element.get("submodel") if isinstance(element, Mapping) else None
        if not isinstance(name, str):
            return None
        keys, inner = known.get(name) or (None, ready(name))
        if inner is None:
            return None
        level = Level(f"{level.path}.{part}" if level.path else part, keys, inner, name)
        known = {**known, **_models(level)}
    return level


def _models(level: Level) -> dict[str, tuple[tuple[str, ...] | None, Data]]:
    return {
        name: (None if level.keys is None else (*level.keys, "models", name), inner)
        for name, inner in table(level.data, "models").items()
        if isinstance(inner, dict)
    }


def ready(name: str) -> Data | None:
    """Return the data of a ready part, None if there is none of this name."""
    from hybond.files.encode import to_data
    from hybond.library import find

    model = find(name)
    return None if model is None else to_data(model)


def table(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Return a table of the data, an empty one for what is missing or none.

    Examples
    --------
    >>> table({"elements": 3}, "elements"), table({}, "graph")
    ({}, {})
    """
    found = data.get(key)
    return found if isinstance(found, dict) else {}


def bonds_of(data: Mapping[str, Any]) -> list[str]:
    """Return the bonds of a level as written; what is no text is left out by the reader."""
    found = table(data, "graph").get("bonds")
    return [b if isinstance(b, str) else "" for b in found] if isinstance(found, list) else []
