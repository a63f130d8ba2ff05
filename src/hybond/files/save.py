"""Write models: to text, to a new file, into an existing file whose comments stay."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path
from typing import Any

from hybond.calls import called, named_file
from hybond.errors import FileError, UsageError
from hybond.files.check import check_plain
from hybond.files.decode import read_file_data
from hybond.files.encode import to_data
from hybond.files.load import load
from hybond.files.parse import format_of, parse, read_text
from hybond.files.place import Format, Place, Source
from hybond.files.schema import VERSION
from hybond.files.submodel_files import Reading, is_file
from hybond.files.toml_text import toml_text
from hybond.files.whole import write_whole
from hybond.model.builder import Model
from hybond.model.given import check_model
from hybond.model.parts import SubmodelPart


@called("hb.dumps(model)")
def dumps(model: Model, *, format: Format = "toml", inline: bool = False) -> str:
    """Return a model as the text of a model file, freshly laid out.

    Parameters
    ----------
    model : Model
    format : {"toml", "json"}
    inline : bool
        Whether submodels that are files become part of the text, so that it stands alone; else
        they stay references to files.

    Raises
    ------
    FileError
        HB-F110 if the model holds what no file can, and every error that reading the text would
        give: what is written can be read.

    Examples
    --------
    >>> from hybond.model.constructors import C, I, One
    >>> model = Model("oscillator", domain="translational", parameters={"k": "100 N/m"})
    >>> model.add(mass=I("1 kg", f="1 m/s"), spring=C("1/k"), v=One())
    >>> model.bond("v -> mass", "v -> spring")
    >>> print(dumps(model), end="")
    hybond = 1
    name = "oscillator"
    domain = "translational"
    <BLANKLINE>
    [parameters]
    k = "100 N/m"
    <BLANKLINE>
    [elements]
    mass = { I = "1 kg", f = "1 m/s" }
    spring = { C = "1/k" }
    v = { junction = 1 }
    <BLANKLINE>
    [graph]
    bonds = ["v -> mass", "v -> spring"]
    """
    if format not in ("toml", "json"):
        raise FileError(
            f"{format!r} is not a format", code="HB-F102", where="format", hint="'toml' or 'json'"
        )
    return _text(_checked_data(model, inline=inline), format)


@called('hb.save(model, "ball.toml")')
def save(model: Model, path: str | os.PathLike[str]) -> None:
    r"""Write a model to a file ending in ``.toml`` or ``.json``.

    An existing TOML file is edited: only what changed is touched, and comments, order and
    spelling stay. New keys come at the end of their section, new sections at their place in the
    usual order. Submodels that are files stay references; save them on their own.

    Parameters
    ----------
    model : Model
    path : str or path

    Raises
    ------
    FileError
        HB-F117 (something else is there), HB-F118 (a submodel's file says something else than
        the model), HB-F119 (cannot be written), and those of `dumps`. The file is then as
        before.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "block.toml")
    ...     _ = path.write_text("hybond = 1\n\n[parameters]\nm = 1  # kilograms\n")
    ...     model = load(path)
    ...     model.parameter(m=2, g="9.81 m/s^2")
    ...     save(model, path)
    ...     print(path.read_text(), end="")
    hybond = 1
    <BLANKLINE>
    [parameters]
    m = 2  # kilograms
    g = "9.81 m/s^2"
    """
    file = named_file(path, 'hb.save(model, "ball.toml")')
    format = format_of(file)
    data = _checked_data(model)
    if data["name"] == file.stem:
        del data["name"]
    _check_submodel_files(model, file)
    if not file.exists():
        _write(file, _text(data, format).encode())
        return
    text = read_text(file, str(file))
    if not text.strip():
        _write(file, _text(data, format).encode())
        return
    old = _existing(text, file, format)
    if format == "json":
        _write(file, _text(data, format).encode())
        return
    marked = file.read_bytes().startswith(b"\xef\xbb\xbf")
    _write(file, _edited(text, old, data, file).encode("utf-8-sig" if marked else "utf-8"))


def _text(data: dict[str, Any], format: Format) -> str:
    if format == "json":
        return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
    return toml_text(data)


def _checked_data(model: Any, *, inline: bool = False) -> dict[str, Any]:
    """Return the data of a model, after reading it once as a reader will."""
    if not isinstance(model, Model):
        check_model(model)
        raise UsageError(
            "a flat graph is not written: it is what a model means",
            code="HB-S130",
            where="model",
            hint="save the model that it was made of",
        )
    data = to_data(model, inline=inline)
    _canonical(data, Source(f"model {model.name}"), model.name)
    return data


def _canonical(data: dict[str, Any], source: Source, name: str) -> dict[str, Any]:
    """Return data as `to_data` would write it; submodel files are not looked at."""
    check_plain(data, Place(source))
    return to_data(read_file_data(data, Place(source), Reading(None, follow=False), name))


def _existing(text: str, file: Path, format: Format) -> dict[str, Any]:
    """Return the data of the model that is there, and refuse to overwrite anything else."""
    source = Source(str(file), text, format)
    try:
        data = parse(source)
        if data.get("hybond") != VERSION:
            raise FileError(
                f"not a hybond model of format version {VERSION}",
                code="HB-F106",
                hint="a model begins with hybond = 1",
                where=str(file),
            )
        with contextlib.suppress(FileError):
            # A model that is wrong somewhere is edited by its own data, not the canonical data.
            data = _canonical_for(data, source, file)
    except FileError as error:
        raise FileError(
            f"the file is there already and cannot be edited: {error.why}",
            code="HB-F117",
            where=error.where,
            hint="save under another name, or delete it",
        ) from None
    return data


def _canonical_for(data: dict[str, Any], source: Source, file: Path) -> dict[str, Any]:
    named = "name" in data
    data = _canonical(data, source, file.stem)
    if not named:
        del data["name"]
    return data


def _edited(text: str, old: dict[str, Any], new: dict[str, Any], file: Path) -> str:
    """Return the text edited to say `new`, verified by reading it."""
    from tomlkit.exceptions import TOMLKitError

    from hybond.files.edit import edit_toml, same

    if "name" in old:  # a name that is written stays written
        new = {**new, "name": new.get("name", file.stem)}
    for finely in (True, False):
        try:
            edited = edit_toml(text, old, new, finely=finely)
            source = Source(str(file), edited)
            found = _canonical_for(parse(source), source, file)
        except (FileError, TOMLKitError, LookupError, TypeError, ValueError, RecursionError):
            continue
        if same(found, new):
            return edited
    raise FileError(
        "the file is written in a way that cannot be edited",
        code="HB-F117",
        where=str(file),
        hint="save under another name, or delete it",
    )


def _check_submodel_files(model: Model, file: Path) -> None:
    """Refuse to write references that would mean something else than the model does."""
    inner = {id(m): m for key, m in model.models.items() if not is_file(key)}
    for key, part in model.elements.items():
        if not isinstance(part, SubmodelPart):
            continue
        if isinstance(part.model, Model):
            inner[id(part.model)] = part.model
        elif is_file(part.model) and (given := model.models.get(part.model)) is not None:
            beside = file.parent / part.model
            try:
                found = to_data(load(beside), inline=True)
                why = "says something else than the submodel of this model"
            except FileError as error:
                found, why = {}, f"cannot be read: {error.why}"
            from hybond.files.edit import same

            if not same(found, to_data(given, inline=True)):
                raise FileError(
                    f"the submodel file {str(beside)!r} {why}",
                    code="HB-F118",
                    where=f"{file}: elements.{key}",
                    hint="save the submodel there first, or write all in one: dumps(inline=True)",
                )
    for submodel in inner.values():
        _check_submodel_files(submodel, file)


def _write(file: Path, data: bytes) -> None:
    """Replace the file at once, so that a failure half-way leaves what was there."""
    try:
        write_whole(file, data)
    except OSError as error:
        raise FileError(
            f"cannot write the file: {error.strerror or error}",
            code="HB-F119",
            where=str(file),
            hint="check that the directory is there and yours",
        ) from None
