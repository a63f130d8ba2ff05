"""From the place of a refusal in a model to the line of the file that says it."""

from __future__ import annotations

import re
from collections.abc import Collection

from hybond.errors import HybondError, UsageError
from hybond.model.arrays import base_of, is_array, parts_of
from hybond.model.builder import Model
from hybond.model.origin import SECTIONS, Path, as_read
from hybond.model.parts import SubmodelPart

_STEP = r"([A-Za-z_]\w*(?:\[[^\[\]]*[^\[\]\d][^\[\]]*\])?)|\[(\d+)\]|\."
_OTHER = ("graph", "causality", "experiment", "models", "layout")
_KEYS = ("domain", "indeterminate", "title", "about", "name")


def locate(error: HybondError, model: Model, overrides: Collection[str] = ()) -> HybondError:
    r"""Note in a refusal the file, the line and what it says, if the model comes from a file.

    Parameters
    ----------
    error : HybondError
        Its `where` is a path in the model: ``elements.S1.r.R``, ``graph.bonds[2]``, ``S1.R_on``.
    overrides : collection of str
        Paths whose values are not those of the file.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.loads('hybond = 1\n[elements]\nr = { R = "2 kg" }\n', where="r.toml")
    >>> error = locate(HybondError("no", code="HB-U103", where="elements.r.R"), m)
    >>> error.file, error.line, error.written
    ('r.toml', 3, 'r = { R = "2 kg" }')
    """
    if error.file or model.origin is None:
        return error
    if error.where in overrides:
        return error
    found = _line(model, error.where)
    if found is None and isinstance(error, UsageError):
        return error  # what the call says is in no file
    file, line, written = found or (model.origin.within(())[0], None, "")
    return error.said_in(file, line, written)


def _line(model: Model, where: str) -> tuple[str, int | None, str] | None:
    path = _steps(where)
    if not path:
        return None
    section = ""
    if path[0] in SECTIONS and len(path) > 1 and isinstance(path[1], str):
        section, path = str(path[0]), path[1:]
    return _in(model, section, path, {})


def _steps(where: str) -> Path:
    """Return the keys and indices of a path; nothing if it is no path."""
    steps: list[str | int] = []
    at = 0
    while at < len(where):
        match = re.compile(_STEP).match(where, at)
        if match is None:
            return ()
        at = match.end()
        if match[1]:
            steps.append(match[1])
        elif match[2]:
            steps.append(int(match[2]))
    return tuple(steps)


def _in(
    model: Model, section: str, path: Path, known: dict[str, Model]
) -> tuple[str, int | None, str] | None:
    """Return the line of a path in one model, or in a submodel that it goes into."""
    if model.origin is None:
        return None
    known = {**known, **model.models}
    path = _of_array(model, path)
    name = path[0]
    part = model.elements.get(str(name))
    if isinstance(part, SubmodelPart) and len(path) > 1:
        inner = part.model if isinstance(part.model, Model) else known.get(part.model)
        own = str(path[1])
        for group, given in (("parameters", part.parameters), ("inputs", part.inputs)):
            if own in given and len(path) == 2 and as_read(model, "elements", str(name)):
                return model.origin.within(("elements", name, group, own))
        deeper = None if inner is None else _in(inner, section, path[1:], known)
        if deeper is not None:
            return deeper
        return model.origin.within(("elements", name)) if _same(model, name) else None
    if name == "graph" and not section:
        whole = len(path) < 3 or not isinstance(path[2], int)
        if whole or as_read(model, "bonds", path[2]):
            return model.origin.within(path)
        return None
    if name in _OTHER or (name in _KEYS and not section):
        return model.origin.within(path)
    for group in (section,) if section else SECTIONS:
        if name in getattr(model, group):
            if not as_read(model, group, str(name)):
                return None
            return model.origin.within((group, *path))
    return None


def _of_array(model: Model, path: Path) -> Path:
    """Return a path with the array that a member belongs to as one key."""
    if len(path) < 2 or not isinstance(path[1], int) or path[0] in _OTHER:
        return path
    arrays = [
        key
        for group in (model.elements, model.signals, model.inputs, model.machines, model.ports)
        for key in group
        if is_array(key) and base_of(key) == path[0]
    ]
    within = [key for key in arrays if (found := parts_of(key)) and _holds(found, path[1])]
    return ((within or arrays)[0], *path[2:]) if arrays else path


def _holds(key: tuple[str, str, str, str], index: int) -> bool:
    first, last = key[2:]
    literal = first.isdecimal() and last.isdecimal()
    return literal and int(first) <= index <= int(last)


def _same(model: Model, name: str | int) -> bool:
    return as_read(model, "elements", str(name))
