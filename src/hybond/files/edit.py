"""Change the values of a TOML text and leave the rest as it is: comments, order, spelling.

Values that differ are set, and keys that are gone are taken out, with tomlkit. New keys and new
tables are inserted into the text itself, at the end of the table or section they belong to, since
only there is it plain which blank lines and comments belong to what.
"""

from __future__ import annotations

from collections.abc import Mapping, MutableMapping
from difflib import SequenceMatcher
from typing import Any

from hybond.files.toml_lines import Statement, statements
from hybond.files.toml_text import ORDER, WIDTH, entry_text, table_text, value_text
from hybond.records import dataclass

_Path = tuple[str, ...]
COMPARED = 100_000
"""Pairs of items of two lists that are compared."""


@dataclass(frozen=True, slots=True)
class _Added:
    """A key that is new, and whether it gets a header of its own."""

    path: _Path
    value: Any
    as_table: bool


def edit_toml(text: str, old: dict[str, Any], new: dict[str, Any], *, finely: bool = True) -> str:
    r"""Return `text`, which says `old`, changed so that it says `new`.

    Parameters
    ----------
    old, new : dict
        Data of a model file; keys that are in neither are left alone.
    finely : bool
        Whether a list or inline table that changed is changed item by item; else it is written
        anew.

    Examples
    --------
    >>> text = "hybond = 1 # first\n\n[parameters]\n# mass of the ball\nm = 1\n"
    >>> old, new = {"parameters": {"m": 1}}, {"parameters": {"m": 2, "g": 9.81}}
    >>> print(edit_toml(text, old, new), end="")
    hybond = 1 # first
    <BLANKLINE>
    [parameters]
    # mass of the ball
    m = 2
    g = 9.81
    """
    import tomlkit

    windows = "\r\n" in text
    text = text.replace("\r\n", "\n")
    document = tomlkit.parse(text)
    headers = {s.path for s in statements(text) if s.header} | {()}
    added: list[_Added] = []
    _merge(document, old, new, (), headers, added, finely)
    text = tomlkit.dumps(document)
    for entry in added:
        text = _insert(text, entry)
    return text.replace("\n", "\r\n") if windows else text


def same(a: Any, b: Any) -> bool:
    """Return whether two pieces of data are equal, 1, 1.0 and true being three things.

    The order of keys does not count.

    Examples
    --------
    >>> same({"a": [1], "b": 2}, {"b": 2, "a": [1]}), same(1, 1.0), same(0.0, -0.0)
    (True, False, False)
    """
    if type(a) is not type(b):
        return False
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    if isinstance(a, list):
        return len(a) == len(b) and all(map(same, a, b))
    return repr(a) == repr(b)


def _merge(
    table: MutableMapping[str, Any],
    old: Mapping[str, Any],
    new: Mapping[str, Any],
    path: _Path,
    headers: set[_Path],
    added: list[_Added],
    finely: bool,
) -> None:
    from tomlkit.items import Array, InlineTable

    for key in old:
        if key not in new and key in table:
            del table[key]
    for key, value in new.items():
        if key not in table:
            # An inline or dotted table has no place of its own for new keys: change it in place.
            as_table = _as_table((*path, key), value, headers)
            if as_table or path in headers:
                added.append(_Added((*path, key), value, as_table))
            else:
                table[key] = _item(value)
        elif key not in old or not same(old[key], value):
            now = table[key]
            before = old.get(key)
            # tomlkit leaves stray spaces where a key goes or comes in an inline table.
            inline = isinstance(now, InlineTable) and (
                not finely
                or not isinstance(before, dict)
                or not isinstance(value, dict)
                or before.keys() != value.keys()
            )
            if isinstance(value, dict) and isinstance(now, MutableMapping) and not inline:
                before = before if isinstance(before, dict) else {}
                _merge(now, before, value, (*path, key), headers, added, finely)
            elif isinstance(now, Array) and isinstance(value, list) and value and finely:
                _merge_list(now, value)
            else:
                table[key] = _item(value)


def _merge_list(array: Any, new: list[Any]) -> None:
    """Change a list item by item, so that the comments on the items that stay, stay."""
    old = [value_text(item) for item in array.unwrap()]
    texts = [value_text(item) for item in new]
    several_lines = "\n" in array.as_string()
    for what, a, b, c, d in reversed(_differences(old, texts)):
        if what == "equal":
            continue
        paired = min(b - a, d - c)
        for k in range(paired):
            array[a + k] = _item(new[c + k])
        for k in reversed(range(a + paired, b)):
            del array[k]
        for k in range(c + paired, d):
            if several_lines and a + k - c == len(array):
                array.add_line(_item(new[k]), indent="  ")
            else:
                array.insert(a + k - c, _item(new[k]))


def _differences(old: list[str], new: list[str]) -> list[tuple[str, int, int, int, int]]:
    """Return what leads from one list to another, as `SequenceMatcher.get_opcodes` does.

    Of lists that differ in too much (`COMPARED`), as of a thousand items that are all the same,
    the parts between equal ends are one difference: the matcher may take cubic time.
    """
    first, most = 0, min(len(old), len(new))
    while first < most and old[first] == new[first]:
        first += 1
    last = 0
    while last < most - first and old[-1 - last] == new[-1 - last]:
        last += 1
    a, b = len(old) - last, len(new) - last
    if (a - first) * (b - first) > COMPARED:
        return [("replace", first, a, first, b)]
    matcher = SequenceMatcher(None, old[first:a], new[first:b], False)
    return [
        (what, first + i, first + j, first + k, first + m)
        for what, i, j, k, m in matcher.get_opcodes()
    ]


def _item(value: Any) -> Any:
    import tomlkit

    if isinstance(value, list) and len(value_text(value)) > WIDTH and len(value) > 1:
        return tomlkit.parse(entry_text("x", value))["x"]
    return tomlkit.value(value_text(value))


def _as_table(path: _Path, value: Any, headers: set[_Path]) -> bool:
    """Return whether a new value gets a header: a section, a machine, a model, or its likes do."""
    if not isinstance(value, dict):
        return False
    likes = any(len(h) >= len(path) and h[: len(path) - 1] == path[:-1] for h in headers)
    if path[:-1] not in headers and not likes:
        return len(path) == 1
    while path[:1] == ("models",) and len(path) > 1:
        path = path[2:]
    if not path or path[0] in ("machines", "models") or len(path) == 1:
        return len(path) < 3
    return likes and path[:-1] not in headers


def _insert(text: str, new: _Added) -> str:
    """Return the text with a new key or table in it."""
    lines = text.split("\n")
    if lines and not lines[-1]:
        lines.pop()
    found = list(statements(text))
    if new.as_table:
        at = _place_of_table(found, new.path, lines)
        block = ["", *table_text(new.path, new.value).split("\n")]
    else:
        at = _end_of_table(found, new.path[:-1])
        block = entry_text(new.path[-1], new.value).split("\n")
    return "\n".join([*lines[:at], *block, *lines[at:]]) + "\n"


def _end_of_table(found: list[Statement], table: _Path) -> int:
    """Return the line after the last statement of the table with this header."""
    last = 0
    inside = not table
    for s in found:
        if s.header:
            inside = s.path == table
        if inside:
            last = s.last + 1
    return last


def _place_of_table(found: list[Statement], path: _Path, lines: list[str]) -> int:
    """Return the line before which a new table goes: after its relatives, else by `ORDER`."""
    headers = [s for s in found if s.header]
    after: Statement | None = None
    for depth in range(len(path) - 1, 0, -1):
        relatives = [s for s in headers if s.path[:depth] == path[:depth]]
        if relatives:
            after = relatives[-1]
            break
    else:
        earlier = [s for s in headers if _rank(s.path) <= _rank(path)]
        if earlier:
            after = earlier[-1]
    following = [s for s in headers if after is None or s.first > after.first]
    if not following:
        return len(lines)
    # The comment just above a header belongs to it; blank lines above that separate.
    at = following[0].first
    while at > 0 and lines[at - 1].lstrip().startswith("#"):
        at -= 1
    while at > 0 and not lines[at - 1].strip():
        at -= 1
    return at


def _rank(path: _Path) -> int:
    return ORDER.index(path[0]) if path[0] in ORDER else -1
