"""Names for people: dotted paths, "did you mean", words in columns and in HTML."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

LONGEST = 200
"""Letters of a name that are compared: a stranger's may have a million."""


NEAREST = 3
"""Names that are meant at the most."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a remedy that lists the known names nearest to `name`.

    Examples
    --------
    >>> did_you_mean("bal.p", ["ball.p", "ball.f", "time"])
    "did you mean 'ball.p', 'ball.f'?"
    >>> did_you_mean("v", ["V", "R", "C"])
    "did you mean 'V'?"
    >>> did_you_mean("peak", ["max", "peak_to_peak"])
    "did you mean 'peak_to_peak'?"
    >>> did_you_mean("zzz", ["ball", "pad"])
    'known names: ball, pad'
    """
    import difflib

    choices, name = list(known), str(name)[:LONGEST]
    near = difflib.get_close_matches(name, choices, n=NEAREST, cutoff=0.6)
    # who forgets a capital means the name that is otherwise the same
    same = [c for c in choices if c.lower() == name.lower()]
    near = list(dict.fromkeys([*same, *near]))[:NEAREST]
    if not near and len(name) > 2:
        # who knows the first word of a name means what goes on behind it
        near = sorted(c for c in choices if c.startswith((f"{name}_", f"{name}.", f"{name}[")))
        near = near[:NEAREST]
    if near:
        return "did you mean " + ", ".join(repr(n) for n in near) + "?"
    if not choices:
        return ""
    known_names = sorted(set(choices))
    shown = ", ".join(known_names[:12])
    return f"known names: {shown}" + (", ..." if len(known_names) > 12 else "")


_MEANT = {
    "Model": {
        **dict.fromkeys(("run", "simulate", "sim"), 'hb.simulate(model, until="1 s")'),
        **dict.fromkeys(("save", "write", "to_toml"), 'hb.save(model, "model.toml")'),
        **dict.fromkeys(("connect", "bonds_add", "add_bond", "link"), 'model.bond("a -> b")'),
        **dict.fromkeys(("load", "read"), 'hb.load("model.toml")'),
        "plot": 'model.draw() for the graph; hb.simulate(model, until="1 s").plot("x") for a run',
    },
    "Result": {
        **dict.fromkeys(("t", "time", "times"), 'run["x"].t; run.t_end is when it ended'),
        **dict.fromkeys(("y", "x", "states", "values", "data"), 'run["x"].y; run.names lists x'),
        **dict.fromkeys(("signals", "keys", "variables"), "run.names"),
        **dict.fromkeys(("success", "message"), "run.status and run.error"),
        **dict.fromkeys(("to_dataframe", "dataframe", "df", "to_df"), "run.to_pandas()"),
        **dict.fromkeys(("save", "to_file"), 'run.to_csv("run.csv"), run.to_npz("run.npz")'),
    },
    "Signal": {
        **dict.fromkeys(("time", "times", "x"), "signal.t"),
        **dict.fromkeys(("value", "values", "data", "v"), "signal.y; signal.at(0.1) at a time"),
        **dict.fromkeys(("average", "avg"), "signal.mean()"),
        **dict.fromkeys(
            ("final", "last", "end"), "signal.y[-1]; run.final['c.e'] of what is stored"
        ),
        **dict.fromkeys(("maximum", "peak"), "signal.max()"),
        **dict.fromkeys(("minimum", "valley"), "signal.min()"),
    },
}
"""What somebody who comes from elsewhere asks objects for, and how it is said here."""


class Asked:
    """Objects that say what is meant where they are asked for what they do not have.

    Examples
    --------
    >>> class Signal(Asked):
    ...     y = 0.0
    >>> Signal().values
    Traceback (most recent call last):
        ...
    AttributeError: a Signal has no 'values'; try: signal.y; signal.at(0.1) at a time
    """

    __slots__ = ()

    if not TYPE_CHECKING:  # else nothing would be unknown to who checks types

        def __getattr__(self, name: str) -> Any:
            kind = type(self).__name__
            text = f"a {kind} has no {name!r}"
            if not name.startswith("_"):
                own = getattr(self, "__dict__", {})
                known = [n for n in (*dir(type(self)), *own) if not n.startswith("_")]
                text += f"; try: {_MEANT.get(kind, {}).get(name) or did_you_mean(name, known)}"
            raise AttributeError(text, name=name, obj=self)


def plural(noun: str, count: int) -> str:
    """Return a noun for a number of things.

    Examples
    --------
    >>> plural("machine", 2), plural("chain of bonds", 2), plural("machine", 1)
    ('machines', 'chains of bonds', 'machine')
    """
    head, space, rest = noun.partition(" ")
    return noun if count == 1 else f"{head}s{space}{rest}"


def port_number(text: str) -> int:
    """Return the number of a port as it is written, 0 if it is none.

    Examples
    --------
    >>> port_number("2"), port_number("²"), port_number("9" * 5000)
    (2, 0, 0)
    """
    return int(text) if len(text) < 10 and text.isascii() and text.isdigit() else 0


def is_number(text: str) -> bool:
    """Whether a text is a number as Python reads one."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def steps(path: str) -> list[str]:
    """Return the parts of a dotted path; dots in brackets are part of a name.

    Examples
    --------
    >>> steps("left.cell[1..n].q"), steps("v")
    (['left', 'cell[1..n]', 'q'], ['v'])
    """
    return re.split(r"\.(?![^\[\]]*\])", path)


def join(*parts: str) -> str:
    """Join the parts of a dotted path, leaving out empty ones."""
    return ".".join(p for p in parts if p)


def in_columns(
    rows: Iterable[Sequence[str]],
    justified: Callable[[str, int], str] = str.ljust,
    *,
    widest: int | None = None,
) -> list[str]:
    """Return rows of words as lines with straight columns.

    With `widest`, longer words do not make a column wider: they push the rest of their own line.

    Examples
    --------
    >>> in_columns([("a", "flow"), ("spring", "1")])
    ['a       flow', 'spring  1']
    >>> in_columns([("a", "flow"), ("long-winded", "1")], widest=4)
    ['a  flow', 'long-winded  1']
    """
    table = list(rows)
    most = widest or max((len(word) for row in table for word in row), default=0)
    widths = [max((n for n in map(len, column) if n <= most), default=0) for column in zip(*table)]
    return ["  ".join(map(justified, row, widths)).rstrip() for row in table]


def numbers_in_columns(rows: Iterable[Sequence[str]], *, words: Sequence[int]) -> list[str]:
    """Return rows as indented lines: columns of `words` from the left, numbers to the right.

    Examples
    --------
    >>> numbers_in_columns([("", "value"), ("v.f", "1"), ("m.p", "12.5")], words=[0])
    ['       value', '  v.f      1', '  m.p   12.5']
    """
    table = list(rows)
    widths = [max(map(len, column)) for column in zip(*table)]
    return [
        "  "
        + "  ".join(
            word.ljust(wide) if k in words else word.rjust(wide)
            for k, (word, wide) in enumerate(zip(row, widths))
        ).rstrip()
        for row in table
    ]


def html_table(rows: Iterable[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Return rows of words as a table of HTML, under a head if there is one.

    Examples
    --------
    >>> html_table([("a", "<b>")], ["name", "value"])
    '<table><tr><th>name</th><th>value</th></tr><tr><td>a</td><td>&lt;b&gt;</td></tr></table>'
    """
    from html import escape

    def line(words: Sequence[str], tag: str) -> str:
        cells = (f"<{tag}>{escape(word)}</{tag}>" for word in words)
        return f"<tr>{''.join(cells)}</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f"<table>{line(head, 'th') if head else ''}{body}</table>"


def html_lines(lines: Iterable[str]) -> str:
    """Return lines of text as paragraphs of HTML."""
    from html import escape

    return "".join(f"<p>{escape(line)}</p>" for line in lines)
