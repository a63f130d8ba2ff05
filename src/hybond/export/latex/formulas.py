"""Long formulas over several lines, and those that cannot be broken made to fit."""

from __future__ import annotations

import re

WIDE = 88
"""Printed characters of a line of formulas, about."""

FITTED = r"""\newsavebox{\hbbox}
\newcommand{\fitted}[1]{\sbox{\hbbox}{#1}%
  \ifdim\wd\hbbox>\linewidth\resizebox{\linewidth}{!}{\usebox{\hbbox}}\else\usebox{\hbbox}\fi}
\newcommand{\formula}[1]{\fitted{$\displaystyle #1$}}
\newcommand{\continued}[1]{\hspace*{2em}\begin{minipage}{\dimexpr\linewidth-2em}%
  \formula{#1}\end{minipage}}"""
"""Commands that the formulas use: what is wider than the line is made smaller."""


def formulas(align: str) -> tuple[list[str], list[str]]:
    r"""Return the lines of an ``align*`` as paragraphs, and its comments.

    Examples
    --------
    >>> lines, notes = formulas("\\begin{align*}\na &= b \\\\\n& c = 1\n\\end{align*}\n% a note")
    >>> lines
    ['\\noindent\\formula{a = b}\\par', '\\noindent\\formula{c = 1}\\par']
    >>> notes
    ['a note']
    """
    notes = [line[2:] for line in align.splitlines() if line.startswith("% ")]
    body = align.partition("\\begin{align*}\n")[2].partition("\n\\end{align*}")[0]
    found = []
    for line in body.split(" \\\\\n"):
        first, *others = broken(line.removeprefix("& ").replace(" &= ", " = ", 1))
        found.append(rf"\noindent\formula{{{first}}}\par")
        found += [rf"\noindent\continued{{{other}}}\par" for other in others]
    return (found if body else []), notes


def broken(formula: str) -> list[str]:
    """Return a formula as lines, broken before a sign that stands in no bracket.

    Examples
    --------
    >>> broken("a = b + c")
    ['a = b + c']
    >>> [len(line) for line in broken("y = " + " + ".join(["x"] * 60))]
    [173, 67]
    """
    parts = _terms(formula)
    lines, width = [parts[0]], printed_width(parts[0])
    for part in parts[1:]:
        more = printed_width(part)
        if width + more > WIDE:
            lines.append(part.strip())
            width = more
        else:
            lines[-1] += part
            width += more
    return lines


def _terms(formula: str) -> list[str]:
    """Split before ``+``, ``-`` and ``=`` outside brackets."""
    parts, depth, start = [], 0, 0
    for match in re.finditer(r"\\left|\\right|[{}()]| (?=[-+=] )", formula):
        match match[0]:
            case "{" | "(" | r"\left":
                depth += 1
            case "}" | ")" | r"\right":
                depth -= 1
            case _ if depth == 0 and formula[match.start() - 1] not in "&":
                if match.start() > start:
                    parts.append(formula[start : match.start()])
                start = match.start()
    return [*parts, formula[start:]]


def printed_width(formula: str) -> int:
    """Return about how many characters a formula prints; of a fraction, the wider part."""
    text = formula
    pattern = re.compile(r"\\frac\{((?:[^{}]|\{[^{}]*\})*)\}\{((?:[^{}]|\{[^{}]*\})*)\}")
    while (found := pattern.search(text)) is not None:
        above, below = printed_width(found[1]), printed_width(found[2])
        text = text[: found.start()] + "x" * max(above, below) + text[found.end() :]
    text = re.sub(r"\\(mathrm|bar|dot|left|right|operatorname|text|,)", "", text)
    text = re.sub(r"\\[A-Za-z]+", "x", text)
    return len(re.sub(r"[{}\\_^ ]", "", text))
