"""Which line of a JSON text says what, for messages."""

from __future__ import annotations

import json
import re

# possessive: nothing is kept of a long text to go back to
_TOKEN = re.compile(r'"[^"\\]*+(?:\\.[^"\\]*+)*+"|[\[\]{},:\n]|[^\s"\[\]{},:]+')


def find_line(text: str, path: tuple[str | int, ...]) -> int | None:
    r"""Return the line (from 1) of the key or list item at `path`, or of the nearest around it.

    Examples
    --------
    >>> find_line('{\n"graph": {\n"bonds": [\n"a -> b",\n3]}}', ("graph", "bonds", 1))
    5
    """
    line, found = 1, None
    deepest = 0
    stack: list[str | int | None] = []  # the key or index being read at each level
    for match in _TOKEN.finditer(text):
        token = match[0]
        if token == "\n":
            line += 1
            continue
        # Each item of a list and each key announces the path that it is at.
        if token in "]}":
            if stack:
                stack.pop()
            continue
        if token == ",":
            if stack and isinstance(stack[-1], int):
                stack[-1] += 1
            elif stack:
                stack[-1] = None
            continue
        if token == ":":
            continue
        if stack and stack[-1] is None and token[0] == '"':
            stack[-1] = _plain(token)
            token = ""
        depth = len(stack)
        if depth > deepest and tuple(stack) == path[:depth]:
            found, deepest = line, depth
            if depth == len(path):
                return found
        if token == "{":
            stack.append(None)
        elif token == "[":
            stack.append(0)
    return found


def _plain(token: str) -> str:
    try:
        return str(json.loads(token))
    except ValueError:
        return token[1:-1]
