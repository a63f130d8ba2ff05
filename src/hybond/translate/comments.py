"""The comments and empty lines of a source text, by line."""

from __future__ import annotations

import io
import re
import tokenize
from dataclasses import dataclass, field

_FOR_TOOLS = re.compile(r"#\s*(noqa|type:|pragma|mypy:|ruff:|fmt:)")


@dataclass(frozen=True, slots=True)
class Comments:
    """What `tokenize` sees and `ast` does not."""

    own: dict[int, tuple[int, str]] = field(default_factory=dict)
    """Comments that have a line to themselves: line to column and text."""
    behind: dict[int, str] = field(default_factory=dict)
    """Comments behind code."""
    blank: set[int] = field(default_factory=set)
    """Lines with nothing in them."""

    def between(self, first: int, last: int, column: int = 0) -> tuple[str, ...]:
        """Return the comments on lines of their own from `first` to `last`, from `column` on."""
        found = (self.own[k] for k in range(first, last + 1) if k in self.own)
        return tuple(text for at, text in found if at >= column)


def comments_of(text: str) -> Comments:
    r"""Return the comments of a source text.

    Examples
    --------
    >>> found = comments_of("a = 1  # one\n\n# two\nb = 2\n")
    >>> found.behind, found.own, found.blank
    ({1: 'one'}, {3: (0, 'two')}, {2})
    """
    lines = text.splitlines()
    found = Comments(blank={k + 1 for k, line in enumerate(lines) if not line.strip()})
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type != tokenize.COMMENT or _FOR_TOOLS.match(token.string):
            continue
        line, column = token.start
        said = token.string.removeprefix("#").strip()
        if lines[line - 1][:column].strip():
            found.behind[line] = said
        else:
            found.own[line] = (column, said)
    return found
