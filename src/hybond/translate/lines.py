"""Lines of printed code: wrapped where they are long, comments made of docstrings."""

from __future__ import annotations

import re
import textwrap

WIDTH = 98
_SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}$", re.M)


def wrapped(text: str, indent: int) -> list[str]:
    """Return a statement in lines of at most `WIDTH` characters, broken at its outer operators.

    Examples
    --------
    >>> for line in wrapped("total = " + " + ".join(["first_long_name"] * 7) + ";", 0):
    ...     print(line)
    total = first_long_name + first_long_name + first_long_name + first_long_name
            + first_long_name + first_long_name + first_long_name;
    """
    lines: list[str] = []
    room = WIDTH - indent
    pad = " " * indent
    while len(text) > room:
        at = _break(text, room)
        if at <= 0:
            break
        lines.append(pad + text[:at].rstrip())
        text = text[at:].lstrip()
        pad = " " * (indent + 8)
        room = WIDTH - indent - 8
    lines.append(pad + text)
    return lines


def _break(text: str, room: int) -> int:
    """Return where to break: at the least depth of brackets, as far right as there is room."""
    best, least, depth, quoted = -1, 10_000, 0, False
    k = 0
    while k < min(len(text), room):
        c = text[k]
        if c == "\\" and quoted:
            k += 2
            continue
        if c == '"':
            quoted = not quoted
        elif not quoted:
            if c in "([{":
                depth += 1
            elif c in ")]}":
                depth -= 1
            elif c == " " and k > 8 and depth <= least and _good(text, k):
                best, least = k, depth
        k += 1
    return best


def _good(text: str, k: int) -> bool:
    if text[k - 1] in ",;":
        return True
    return re.match(r" (&&|\|\||[-+*/?:%&|^]|[<>=!]=|[<>]) ", text[k : k + 4]) is not None


def prose(doc: str) -> list[str]:
    r"""Return a docstring as plain lines: without marks of markup, and without its examples.

    Examples
    --------
    >>> prose("Return ``a``.\n\nExamples\n--------\n>>> f()\n1")
    ['Return a.']
    >>> prose("Return `a`.\n\nParameters\n----------\nb : int\n    A number.")
    ['Return a.', '', 'Parameters:', 'b : int', '    A number.']
    """
    kept: list[str] = []
    heads = list(_SECTION.finditer(doc))
    ends = [h.start() for h in heads[1:]] + [len(doc)]
    kept.append(doc[: heads[0].start()] if heads else doc)
    for head, end in zip(heads, ends):
        if head[1] != "Examples":
            kept.append(f"{head[1]}:{doc[head.end() : end]}")
    text = "\n".join(part.strip() for part in kept if part.strip())
    text = text.replace("\n" + "Parameters:", "\n\nParameters:")
    return plain(text).splitlines()


def plain(text: str) -> str:
    """Return a text without backticks, and without what ends a comment.

    Examples
    --------
    >>> plain("``x*/`` is `a`")
    'x* / is a'
    """
    return text.replace("``", "").replace("`", "").replace("*/", "* /").replace("/*", "/ *")


def block_comment(lines: list[str], *, opener: str = "/*") -> list[str]:
    r"""Return lines as one comment.

    Examples
    --------
    >>> print("\n".join(block_comment(["One.", "", "Two."])))
    /* One.
     *
     * Two.
     */
    """
    if len(lines) == 1 and len(lines[0]) < WIDTH - 5:
        return [f"{opener} {lines[0]} */"]
    first, *rest = lines
    return [f"{opener} {first}", *(f" * {line}".rstrip() for line in rest), " */"]


def line_comments(texts: tuple[str, ...], indent: int) -> list[str]:
    """Return comments on lines of their own."""
    found = []
    for text in texts:
        said = plain(text).rstrip("\\")
        for line in textwrap.wrap(said, WIDTH - indent - 3) or [""]:
            found.append(f"{' ' * indent}// {line}".rstrip())
    return found
