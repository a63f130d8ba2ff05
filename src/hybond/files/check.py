"""Check data against the records of `schema`, with messages for people.

msgspec decides whether data fits; it names neither the keys of tables nor what to try, so a
refusal is looked for once more, step by step, to say where it is.
"""

from __future__ import annotations

import math
import re
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from hybond.errors import FileError
from hybond.files import limits
from hybond.files.place import Place, quoted, shortened
from hybond.files.schema import Experiment, Waveform
from hybond.names import did_you_mean

_EXPECTED = re.compile(r"Expected `([^`]*)`(.*?)(?:, got `([^`]*)`)?(?: - at `\$(.*)`)?\Z")
_WORDS = {
    "str": "text",
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "array": "a list",
    "object": "a table",
}


def check_plain(data: Any, place: Place, *, depth: int = 0) -> None:
    """Refuse what no model file may hold: dates, null, inf, nan, endless nesting.

    Raises
    ------
    FileError
        HB-F108 (a value), HB-F103 (nesting).
    """
    if type(data) is str:
        # A lone surrogate (JSON can spell one) could never be saved again.
        if not data.isascii() and any("\ud800" <= c <= "\udfff" for c in data):
            raise place.refuse(
                f"{quoted(data)} holds half a character", code="HB-F108", hint="write it in full"
            )
    elif type(data) is bool:
        pass
    elif type(data) is int:
        if abs(data) >= limits.INTEGER:
            raise place.refuse(
                "a whole number of more than 63 bits",
                code="HB-F108",
                hint="write it as a float: 1e20",
            )
    elif type(data) is float:
        if not math.isfinite(data):
            raise place.refuse(
                f"{data} is not a finite number", code="HB-F108", hint="write a number"
            )
    elif type(data) is list or type(data) is dict:
        if depth >= limits.NESTING:
            raise too_deep(place)
        if type(data) is dict:
            for key, value in data.items():
                if type(key) is not str:
                    raise place.refuse(
                        f"the key {key!r} is not text", code="HB-F108", hint="put it in quotes"
                    )
                if len(key) > limits.KEY:
                    raise place.refuse(
                        f"a key of {len(key)} letters", code="HB-F108", hint="take a shorter name"
                    )
                if type(value) is not str or not (key.isascii() and value.isascii()):
                    check_plain(key, place, depth=depth + 1)
                    check_plain(value, place / key, depth=depth + 1)
        else:
            for k, value in enumerate(data):
                check_plain(value, place / k, depth=depth + 1)
    else:
        shown = "null" if data is None else f"a {type(data).__name__}"
        raise place.refuse(
            f"{shown} is not a value of a model",
            code="HB-F108",
            hint="numbers, text, true, false, lists and tables",
        )


def check(data: Any, shape: Any, place: Place) -> None:
    """Check `data` against a type or record.

    Raises
    ------
    FileError
        HB-F109 (unknown key), HB-F111 (missing key), HB-F112 (wrong type).
    """
    try:
        msgspec.convert(data, shape)
    except msgspec.ValidationError as error:
        raise _located(data, shape, place, str(error)) from None


_SECTIONS = {
    **dict.fromkeys(
        ("simulation", "simulate", "run", "solver", "settings", "options"), "experiment"
    ),
    **dict.fromkeys(("components", "nodes", "parts"), "elements"),
    **dict.fromkeys(("bonds", "connections", "connect", "wires", "edges"), "graph"),
    **dict.fromkeys(("params", "constants", "variables"), "parameters"),
    **dict.fromkeys(("output", "observables"), "signals"),
    **dict.fromkeys(("states", "state_machines", "switches", "modes"), "machines"),
}
"""What sections of a model are called elsewhere."""
_STARTS = (("q", "e"), ("p", "f"))
"""What is stored in a C and in an I, and what is measured of it: either says where it starts."""


@cache
def _fields(shape: type[msgspec.Struct]) -> dict[str, tuple[Any, bool]]:
    hints = get_type_hints(shape, include_extras=True)
    return {f.encode_name: (hints[f.name], f.required) for f in msgspec.structs.fields(shape)}


def _alternatives(shape: Any) -> list[Any]:
    union = get_args(shape) if get_origin(shape) in (Union, UnionType) else (shape,)
    return [get_args(s)[0] if get_origin(s) is Annotated else s for s in union]


def _fits(data: Any, shape: Any) -> str:
    try:
        msgspec.convert(data, shape)
    except msgspec.ValidationError as error:
        return str(error)
    return ""


def _located(data: Any, shape: Any, place: Place, message: str) -> FileError:
    """Return the error of the first part of `data` that does not fit."""
    if isinstance(data, dict):
        for choice in _alternatives(shape):
            if isinstance(choice, type) and issubclass(choice, msgspec.Struct):
                return _located_in_record(data, choice, place, message)
            if get_origin(choice) is dict:
                each = get_args(choice)[1]
                for key, value in data.items():
                    if wrong := _fits(value, each):
                        return _located(value, each, place / key, wrong)
    elif isinstance(data, list):
        for choice in _alternatives(shape):
            if get_origin(choice) is list:
                each = get_args(choice)[0]
                for k, value in enumerate(data):
                    if wrong := _fits(value, each):
                        return _located(value, each, place / k, wrong)
    return _wrong_type(data, shape, place, message)


def _located_in_record(
    data: dict[str, Any], shape: type[msgspec.Struct], place: Place, message: str
) -> FileError:
    fields = _fields(shape)
    for key in data:
        if key not in fields:
            what = "section or key of a model" if "elements" in fields else "key here"
            hint = did_you_mean(key, fields)
            if "elements" in fields and key in _fields(Experiment):
                hint = f"{key} = ... stands below [experiment]"
            elif "elements" in fields and key.lower() in _SECTIONS:
                hint = f"did you mean {_SECTIONS[key.lower()]!r}?"
            stored = [pair for pair in _STARTS if fields.keys() >= set(pair)]
            if stored and not hint.startswith("did"):  # most often how it starts is meant
                hint = f"{hint}; it starts at {' or '.join(stored[0])}: {stored[0][1]} = ..."
            return (place / key).refuse(f"{quoted(key)} is not a {what}", code="HB-F109", hint=hint)
    for key, (of, required) in fields.items():
        if key in data:
            if wrong := _fits(data[key], of):
                return _located(data[key], of, place / key, wrong)
        elif required:
            return place.refuse(f"{key!r} is missing", code="HB-F111", hint=f"add {key} = ...")
    return _wrong_type(data, shape, place, message)


def _wrong_type(data: Any, shape: Any, place: Place, message: str) -> FileError:
    hint = "see docs/model_files.md"
    choices = [c for s in _alternatives(shape) if get_origin(s) is Literal for c in get_args(s)]
    match = _EXPECTED.match(message)
    if choices:
        message = f"{describe(data)} is not one of {', '.join(map(repr, choices))}"
        hint = did_you_mean(str(data), map(str, choices))
    elif match:
        wanted, rest, _, path = match.groups()
        for index in re.findall(r"\[(\d+)\]", path or ""):
            place, data = place / int(index), data[int(index)]
        words = [_WORDS[w] for w in wanted.split(" | ") if w in _WORDS]
        if "a whole number" in words and "a number" in words:
            words.remove("a whole number")
        if words:
            message = f"{describe(data)}, where {' or '.join(words)}{rest} is needed"
        if words == ["a list"] and isinstance(data, str):
            hint = f'write ["{shortened(data)}"]'
        elif words == ["a table"] and place.path[-2:-1] == ("elements",):
            hint = 'write the kind of the element: { C = "1 mm/N" }'
        if shape is Waveform:
            hint = 'write { constant = "5 V" }, or a table or pwm: docs/model_files.md'
    return place.refuse(message, code="HB-F112", hint=hint)


def describe(data: Any) -> str:
    """Say what a value is, shortly.

    Examples
    --------
    >>> describe([1, 2]), describe("abc"), describe(True), describe({})
    ('a list of 2', "the text 'abc'", 'true', 'an empty table')
    """
    if isinstance(data, bool):
        return "true" if data else "false"
    if isinstance(data, str):
        return f"the text {quoted(data)}"
    if isinstance(data, int | float):
        return f"the number {data!r}"
    if isinstance(data, list):
        return f"a list of {len(data)}" if data else "an empty list"
    if isinstance(data, dict):
        keys = ", ".join(map(shortened, list(data)[:4])) + (", ..." if len(data) > 4 else "")
        return f"a table with {keys}" if data else "an empty table"
    return type(data).__name__


def too_deep(place: Place) -> FileError:
    """Return the refusal of too many levels."""
    return place.refuse(
        f"more than {limits.NESTING} tables and lists inside one another",
        code="HB-F103",
        hint="write fewer levels",
    )


def check_depth(data: Any, place: Place) -> None:
    """Refuse plain data with too many levels, whatever their values are: HB-F103.

    Examples
    --------
    >>> from hybond.files.place import Source
    >>> check_depth({"a": [[1]]}, Place(Source("small")))
    """
    level = [data]
    for _ in range(limits.NESTING):
        level = [
            inner
            for node in level
            for inner in (node.values() if isinstance(node, dict) else node)
            if isinstance(inner, dict | list)
        ]
        if not level:
            return
    raise too_deep(place)
