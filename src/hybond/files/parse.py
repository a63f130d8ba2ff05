"""TOML and JSON text to plain data: bounded, without duplicates, never running anything."""

from __future__ import annotations

import errno
import json
import os
import re
import stat
import tomllib
from pathlib import Path
from typing import Any

from hybond.errors import FileError
from hybond.files import limits
from hybond.files.place import Format, Source, line_of, quoted, shortened
from hybond.files.toml_syntax import explain
from hybond.names import did_you_mean

_TOML_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)\Z")
_MASKED = re.compile(
    r'"""[^"\\]*+(?:(?:\\.|"(?!""))[^"\\]*+)*+"{3,5}'
    r"|'{3}.*?'{3,5}"
    r'|"[^"\\\n]*+(?:\\.[^"\\\n]*+)*+"'
    r"|'[^'\n]*'"
    r"|\#[^\n]*",
    re.DOTALL,
)
_LONG_KEY = re.compile(r"(?<![\w.-])(?:[\w-]++\.){20,}+")
_LONG_KEYS = 1000
CIRCUITS = (".cir", ".net", ".sp", ".spi", ".ckt", ".spice", ".asc")
"""Endings of SPICE netlists and of schematics that are read as such."""
BOND_GRAPHS = (".bg",)
"""Endings of files of BondGraphTools."""
_LOOKED_AT = 1000
"""Files of a folder among which one that is not there is looked for."""
_ENDINGS = (".toml", ".json", *CIRCUITS, *BOND_GRAPHS)
_DIGITS = "a number has more digits than can be read"
_SHORTER = "write it with fewer digits, as 1e20"
_JSON = (
    ("delimiter", "a comma or a colon is missing", "put it before what stands here"),
    ("property name", "a key in double quotes is missing", 'write "key": value, no comma before }'),
    ("control character", "a line break or control character in a text", "write it as \\n"),
    ("unterminated", "a text is not closed", 'close it with "'),
    ("escape", "an escape that JSON has not", "write \\\\ for a \\"),
    (
        "expecting value",
        "a value is missing",
        'write a number, "text", true, false, [...] or {...}',
    ),
    ("extra data", "something follows the end of the model", "put all of it in one { ... }"),
)
_DEEPEST_KEY = 2 * limits.LEVELS + 12


def format_of(path: Path) -> Format:
    """Return the format that the suffix of a path stands for.

    Examples
    --------
    >>> format_of(Path("ball.toml"))
    'toml'
    """
    suffix = path.suffix.lower()
    if suffix == ".toml":
        return "toml"
    if suffix == ".json":
        return "json"
    hint = "model files end in .toml or .json"
    if path.name:
        for ending in (".toml", ".json"):
            if suffix not in CIRCUITS + BOND_GRAPHS and path.with_suffix(ending).is_file():
                hint = f"did you mean {path.with_suffix(ending)}?"
    if suffix in CIRCUITS + BOND_GRAPHS:
        hint = f"make a model of it first: hybond convert {path.name} {path.stem}.toml"
    if suffix in (".py", ".ipynb"):
        hint = (
            "what is Python is not run by opening it: run it yourself, and let it end with "
            f'hb.save(model, "{path.stem}.toml"); model.check() says in it what hybond check says'
        )
    raise FileError(
        f"{suffix!r} is not a kind of model file" if suffix else "the file name has no suffix",
        code="HB-F102",
        where=str(path),
        hint=hint,
    )


def read_text(path: Path, name: str) -> str:
    """Return the text of a regular file of bounded size.

    Raises
    ------
    FileError
        HB-F101 (cannot be read), HB-F103 (too large), HB-F104 (not text).
    """
    try:
        data = read_regular(path, limits.FILE_BYTES + 1)
    except FileNotFoundError:
        raise _unreadable("there is no such file", name, hint=_near(path)) from None
    except IsADirectoryError:
        raise _unreadable("it is a directory", name) from None
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", "") or str(error)
        if os.path.isdir(path):  # Windows says only that permission is denied
            why = "it is a directory"
        raise _unreadable(why, name) from None
    return decode_text(data, name)


def read_regular(path: Path, most: int) -> bytes:
    """Return the first bytes of a regular file; a device or a pipe would never end.

    Raises
    ------
    OSError
        Of the system, or because it is another kind of file.
    """
    # Not blocking: a pipe that nobody writes to must not hang us before we see what it is.
    descriptor = os.open(
        path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    )
    with open(descriptor, "rb") as file:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, "it is a directory", str(path))
        if not stat.S_ISREG(mode):
            raise OSError(errno.EINVAL, "it is not an ordinary file", str(path))
        return file.read(most)


def _near(path: Path) -> str:
    """Return the files beside `path` that may be meant."""
    try:
        with os.scandir(path.parent) as found:
            names = [f.name for f, _ in zip(found, range(_LOOKED_AT)) if f.name[0] != "."]
    except OSError:
        return f"check the path: there is no folder {str(path.parent)!r}"
    kind = path.suffix.lower()
    near = [n for n in names if n.lower().endswith(kind) and n.lower().endswith(_ENDINGS)]
    return (did_you_mean(path.name, near) if len(near) < 40 else "") or "check the path"


def _unreadable(why: str, name: str, hint: str = "") -> FileError:
    return FileError(f"cannot read the file: {why}", code="HB-F101", where=name, hint=hint)


def decode_text(data: bytes, name: str) -> str:
    """Return bytes as text (UTF-8, a byte order mark allowed)."""
    if len(data) > limits.FILE_BYTES:
        raise FileError(
            f"larger than {limits.FILE_BYTES // 2**20} MiB",
            code="HB-F103",
            hint="put parts of it into files of their own",
            where=name,
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise FileError(
            f"byte 0x{data[error.start]:02x} on line {line} is not UTF-8 text",
            code="HB-F104",
            where=name,
            hint="save it as UTF-8 (µ and ° of older programs are often Latin-1: "
            "iconv -f latin1 -t utf-8); a binary file is not a model",
        ) from None


def parse(source: Source) -> dict[str, Any]:
    """Return the data of a source.

    Raises
    ------
    FileError
        HB-F105 (syntax, with line and column), HB-F106 (not a model), HB-F103 (nesting).
    """
    if len(source.text) > limits.FILE_BYTES:
        raise FileError(
            f"larger than {limits.FILE_BYTES // 2**20} MiB",
            code="HB-F103",
            hint="put parts of it into files of their own",
            where=source.name,
        )
    if not source.text.strip():
        raise FileError(
            "the file is empty",
            code="HB-F106",
            where=source.name,
            hint="a model begins with hybond = 1",
        )
    try:
        data = _parse_toml(source) if source.format == "toml" else _parse_json(source)
    except RecursionError:
        raise FileError(
            f"more than {limits.NESTING} tables and lists inside one another",
            code="HB-F103",
            hint="write fewer levels, or [headers] for tables",
            where=source.name,
        ) from None
    if not isinstance(data, dict):
        raise FileError(
            "not a hybond model: the whole is not a table",
            code="HB-F106",
            hint="a model begins with hybond = 1",
            where=source.name,
        )
    return data


def _parse_toml(source: Source) -> Any:
    if source.text.count(".") > _DEEPEST_KEY:
        # tomllib takes quadratic time for a.a.a.a... = 1; no model needs such keys, or many.
        masked = re.sub(r"(?<![ \t])[ \t]*+\.[ \t]*+", ".", _MASKED.sub("s", source.text))
        long = [key.count(".") for key in re.findall(_LONG_KEY, masked)]
        if len(long) > _LONG_KEYS or max(long, default=0) >= _DEEPEST_KEY:
            raise FileError(
                f"a key of more than {_DEEPEST_KEY} parts, or more than {_LONG_KEYS} keys of "
                "more than 20",
                code="HB-F103",
                hint="write fewer levels, or [headers] for tables",
                where=source.name,
            )
    try:
        return tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        message = str(error)
        match = _TOML_PLACE.search(message)
        lines = source.text.split("\n")
        line = int(match[1]) if match and match[1] else len(lines)
        column = int(match[2]) if match and match[2] else len(lines[-1]) + 1
        at = sum(len(row) + 1 for row in lines[: line - 1]) + column - 1
        # at the end there may be nothing but empty lines
        while line > 1 and not lines[line - 1].strip():
            line -= 1
            column = len(lines[line - 1]) + 1
            at = min(at, sum(len(row) + 1 for row in lines[: line - 1]) + column - 1)
        why, hint = explain(source.text, at, message)
        raise _syntax("TOML", why, source, line, column, hint) from None
    except ValueError:  # more digits than Python converts
        raise _syntax("TOML", _DIGITS, source, None, None, _SHORTER) from None


def _parse_json(source: Source) -> Any:
    def table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        data = dict(pairs)
        if len(data) < len(pairs):
            keys = [key for key, _ in pairs]
            twice = next(key for k, key in enumerate(keys) if key in keys[:k])
            why = f"the key {quoted(twice)} is there twice"
            raise _syntax("JSON", why, source, None, None, "take one of them out")
        return data

    def constant(word: str) -> float:
        raise FileError(
            f"{word} is not a finite number",
            code="HB-F108",
            where=source.name,
            hint="write a number",
        ).said_in(source.name)

    try:
        return json.loads(source.text, object_pairs_hook=table, parse_constant=constant)
    except json.JSONDecodeError as error:
        why, hint = _json_words(error.msg)
        raise _syntax("JSON", why, source, error.lineno, error.colno, hint) from None
    except ValueError:  # more digits than Python converts
        raise _syntax("JSON", _DIGITS, source, None, None, _SHORTER) from None


def _json_words(message: str) -> tuple[str, str]:
    """Return the reason and the remedy of what the parser of JSON says."""
    low = message.lower()
    for said, why, hint in _JSON:
        if said in low:
            return why, hint
    return "the text cannot be read from here on", "look for a missing comma or quote"


def _syntax(
    language: str, why: str, source: Source, line: int | None, column: int | None, hint: str
) -> FileError:
    where = source.name + (f":{line}:{column}" if line else "")
    error = FileError(
        f"not {language}: {shortened(why, 200)}", code="HB-F105", where=where, hint=hint
    )
    return error.said_in(source.name, line, line_of(source, line))
