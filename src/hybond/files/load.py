"""Read models: from a file, from text, from plain data."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from hybond.calls import called, named_file
from hybond.errors import FileError
from hybond.files.check import check_plain
from hybond.files.decode import read_file_data
from hybond.files.parse import format_of, parse, read_text
from hybond.files.place import Format, Place, Source
from hybond.files.submodel_files import Reading
from hybond.model.builder import Model


@called('hb.load("ball.toml")')
def load(path: str | os.PathLike[str]) -> Model:
    r"""Read a model file; its suffix says whether it is TOML or JSON.

    Parameters
    ----------
    path : str or path
        A file ending in ``.toml`` or ``.json``. Submodels that are files are read with it; they
        are taken from the directory of `path` and below, never from elsewhere.

    Returns
    -------
    Model
        Named as the file says, else like the file.

    Raises
    ------
    FileError
        With the file, the line, the path in the file, and what to try.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "block.toml")
    ...     _ = path.write_text('hybond = 1\n[elements]\nmass = { I = "1 kg" }\n')
    ...     model = load(path)
    >>> model.name, model.elements["mass"]
    ('block', Part(kind='I', value='1 kg', options={}))
    """
    file = named_file(path, 'hb.load("ball.toml")')
    format = format_of(file)
    source = Source(str(file), read_text(file, str(file)), format)
    reading = Reading(file.parent)
    reading.top(file)
    return _read(parse(source), Place(source), reading, file.stem)


@called("hb.loads(text)")
def loads(
    text: str,
    *,
    format: Format = "toml",
    where: str = "<text>",
    base: str | os.PathLike[str] | None = None,
) -> Model:
    r"""Read a model from text.

    Parameters
    ----------
    text : str
    format : {"toml", "json"}
    where : str
        What messages call the text.
    base : str or path
        The directory that submodel files are taken from; without it they are refused.

    Raises
    ------
    FileError

    Examples
    --------
    >>> loads('hybond = 1\ntitle = "Nothing yet"').title
    'Nothing yet'
    >>> loads("hybond = 1\n[elements]\npad = { Cx = 1 }", where="pad.toml")
    Traceback (most recent call last):
        ...
    hybond.errors.FileError: HB-F113 at pad.toml:3: elements.pad.Cx: 'Cx' is not a kind of element
        3 | pad = { Cx = 1 }
      try: did you mean 'C'?
    """
    if format not in ("toml", "json"):
        raise FileError(
            f"{format!r} is not a format", code="HB-F102", where=where, hint="'toml' or 'json'"
        )
    if not isinstance(text, str):
        raise FileError(
            f"a {type(text).__name__} is not a text",
            code="HB-F104",
            where=where,
            hint='hb.load("ball.toml") reads a file',
        )
    bare = text.strip()
    if bare.lower().endswith((".toml", ".json")) and not any(c in bare for c in "\n=[{"):
        raise FileError(
            "not a hybond model: this is the name of a file",
            code="HB-F106",
            where=where,
            hint=f'hb.load("{bare}")',
        )
    source = Source(where, text, format)
    return _read(parse(source), Place(source), _reading(base), "model")


def from_data(
    data: dict[str, Any],
    *,
    where: str = "<data>",
    base: str | os.PathLike[str] | None = None,
) -> Model:
    """Return the model of plain data with the structure of a model file.

    Parameters
    ----------
    data : dict
        Text, numbers, true, false, lists and tables, as from `to_data`.
    where, base
        As in `loads`.

    Raises
    ------
    FileError

    Examples
    --------
    >>> from_data({"hybond": 1, "graph": {"bonds": ["a -> b"]}}).bonds
    ['a -> b']
    """
    place = Place(Source(where))
    if not isinstance(data, dict):
        raise place.refuse("not a hybond model: the whole is not a table", code="HB-F106")
    return _read(data, place, _reading(base), "model")


def _reading(base: str | os.PathLike[str] | None) -> Reading:
    return Reading(None if base is None else Path(base))


def _read(data: dict[str, Any], place: Place, reading: Reading, name: str) -> Model:
    check_plain(data, place)
    return read_file_data(data, place, reading, name)
