"""Which line of a TOML text says what: for messages, and for insertions that keep the rest.

The text is known to be valid TOML (or nearly), so this reads only as much as it must: strings and
comments (to skip them), brackets (to know when a value goes on), headers and keys.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from hybond.records import dataclass

_TOKEN = re.compile(
    r'"""[^"\\]*+(?:(?:\\.|"(?!""))[^"\\]*+)*+"{3,5}'
    r"|'{3}.*?'{3,5}"
    r'|"[^"\\\n]*+(?:\\.[^"\\\n]*+)*+"'
    r"|'[^'\n]*'"
    r"|\#[^\n]*"
    r"|[\[\]{},=\n]"
    r"|[A-Za-z0-9_-]+",
    re.DOTALL,
)
_ESCAPE = re.compile(r"\\(u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8}|.)", re.DOTALL)
_ESCAPED = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r"}


@dataclass(frozen=True, slots=True)
class Statement:
    """A header (``[a.b]``) or a key with its value, on lines `first` to `last` (from 0)."""

    path: tuple[str, ...]
    header: bool
    first: int
    last: int
    value: int = 0
    """Where its value begins: characters from the beginning of the text."""


def statements(text: str) -> Iterator[Statement]:
    r"""Yield the headers and keys of a TOML text in order; paths are complete.

    Examples
    --------
    >>> for s in statements("[a.b]\nc.d = [\n 1, # [x]\n]\n"):
    ...     print(s.path, s.header, s.first, s.last)
    ('a', 'b') True 0 0
    ('a', 'b', 'c', 'd') False 1 3
    """
    table: tuple[str, ...] = ()
    keys: list[str] = []  # of the statement being read
    state = ""  # "" before, "header", "key", "value"
    depth = line = first = start = 0
    for match in _TOKEN.finditer(text + "\n"):
        token = match[0]
        if token == "\n":
            if state == "value" and depth <= 0:
                yield Statement((*table, *keys), False, first, line, start)
            if depth <= 0 or state in ("header", "key"):
                state, keys, depth = "", [], 0
        elif token.startswith("#"):
            pass
        elif state == "value":
            depth += (token in ("[", "{")) - (token in ("]", "}"))
        elif token == "[":
            state, first = "header", line
        elif token == "]" and state == "header":
            table = tuple(keys)
            yield Statement(table, True, first, line)
            state, keys = "done", []
        elif token == "=" and state == "key":
            state, start = "value", match.end()
        elif state in ("", "header", "key"):
            if not state:
                state, first = "key", line
            keys.append(_unquote(token))
        line += token.count("\n")


def find_line(text: str, path: tuple[str | int, ...]) -> int | None:
    r"""Return the line (from 1) of the statement that says `path`, or the nearest around it.

    Of a value on several lines it is that of the item.

    Examples
    --------
    >>> find_line('[graph]\nbonds = [\n "a -> b",\n "b -> c",\n]\n', ("graph", "bonds", 1))
    4
    >>> find_line("[[step]]\nuntil = 1\n[[step]]\nuntil = 2\n", ("step", 1, "until"))
    4
    """
    first = next((k for k, key in enumerate(path) if isinstance(key, int)), len(path))
    names = tuple(str(key) for key in path[:first])
    found = list(statements(text))
    heads = [k for k, s in enumerate(found) if s.header and s.path == names]
    if first < len(path) and len(heads) > int(path[first]):
        return _line_in_table(text, found, heads, path, first)
    best: Statement | None = None
    inside: int | None = None
    for s in found:
        n = len(s.path)
        if names[:n] == s.path and (best is None or n > len(best.path)):
            best = s
        elif s.path[:first] == names and inside is None:
            inside = s.first + 1
    if best is not None and not best.header and best.last > best.first:
        rest = path[len(best.path) :]
        return best.first + 1 + _lines_down(text, best.value, rest)
    if best and len(best.path) == len(names):
        return best.first + 1
    return inside or (best.first + 1 if best else None)


def _line_in_table(
    text: str, found: list[Statement], heads: list[int], path: tuple[str | int, ...], first: int
) -> int:
    """Return the line of a path that leads into one of several tables, ``[[a.b]]``."""
    index = int(path[first])
    names, rest = found[heads[index]].path, path[first + 1 :]
    end = heads[index + 1] if index + 1 < len(heads) else len(found)
    best = found[heads[index]]
    for s in found[heads[index] + 1 : end]:
        own = s.path[len(names) :]
        if s.path[: len(names)] == names and own == rest[: len(own)]:
            best = s if len(s.path) > len(best.path) else best
    if best.header or best.last == best.first:
        return best.first + 1
    return best.first + 1 + _lines_down(text, best.value, rest[len(best.path) - len(names) :])


def _lines_down(text: str, start: int, path: tuple[str | int, ...]) -> int:
    """Return how many lines below the beginning of a value the item at `path` in it is."""
    line = found = deepest = 0
    stack: list[str | int | None] = []  # the key or index being read at each level
    for match in _TOKEN.finditer(text, start):
        token = match[0]
        if token == "\n":
            line += 1
        elif token.startswith("#") or token == "=":
            pass
        elif token in "]}":
            stack = stack[:-1]
            if not stack:
                break
        elif token == ",":
            stack[-1:] = [stack[-1] + 1 if stack and isinstance(stack[-1], int) else None]
        else:
            if stack and stack[-1] is None:
                stack[-1] = _unquote(token)
                token = ""
            depth = len(stack)
            if depth > deepest and tuple(stack) == path[:depth]:
                found, deepest = line, depth
            if token in ("[", "{"):
                stack.append(0 if token == "[" else None)
            line += token.count("\n")
    return found


def _unquote(token: str) -> str:
    if token.startswith("'"):
        return token.strip("'")
    if not token.startswith('"'):
        return token

    def plain(match: re.Match[str]) -> str:
        code = match[1]
        if code[0] in "uU" and len(code) > 1:
            number = int(code[1:], 16)
            return chr(number) if number < 0x110000 else match[0]
        return _ESCAPED.get(code, code)

    return _ESCAPE.sub(plain, token[1:-1])
