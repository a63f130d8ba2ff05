"""``.meas`` of a netlist: what it asks for, as it is written."""

from __future__ import annotations

import re
from dataclasses import dataclass

from hybond.circuits.behaviour import Law, read_law
from hybond.circuits.formulas import read_formula
from hybond.circuits.notices import Line
from hybond.model.expressions import Expr, Number

_HEAD = re.compile(
    r"(?:tran\s+)?(\w+)\s+(avg|rms|min|max|pp|integ|integral|max_at|min_at|find|deriv|when|trig"
    r"|param)\b\s*=?\s*(.+)\Z",
    re.IGNORECASE | re.DOTALL,
)
_WINDOW = re.compile(r"\b(from|to|td|at|val|rise|fall|cross)\s*=?\s*", re.IGNORECASE)
_EDGE = re.compile(r"\b(rise|fall|cross)\s*=\s*(\w+)", re.IGNORECASE)
_LEVEL = re.compile(r"\bval\s*=?\s*(\{[^}]*\}|'[^']*'|\S+)", re.IGNORECASE)
_EQUALS = re.compile(r"(?<![<>=!])=(?!=)")


BEGIN = Number(0.0)


@dataclass(frozen=True, slots=True)
class Crossing:
    """An instant: a time, or where one expression crosses another one."""

    law: Law | None
    """The difference that crosses zero; None if `at` is the time."""
    edge: str = "cross"
    count: int = 1
    """Which of the crossings; 0 is the last."""
    after: Expr = BEGIN
    """Crossings before this time do not count."""
    at: Expr | None = None


@dataclass(frozen=True, slots=True)
class Measure:
    """What a ``.meas`` line asks for.

    Parameters
    ----------
    kind : str
        Over a stretch of time ``"avg"``, ``"rms"``, ``"min"``, ``"max"``, ``"pp"``, ``"integ"``,
        ``"max_at"`` or ``"min_at"``; else ``"find"``, ``"deriv"``, ``"when"``, ``"trig"`` or
        ``"param"``.
    law : Law or None
        The expression that is measured.
    begin, end : Expr or None
        The stretch of time.
    when, until : Crossing or None
        The instant; of ``"trig"`` the two between which the time is measured.
    formula : Expr or None
        Of ``"param"``: an expression of measurements before it.
    """

    name: str
    kind: str
    line: Line
    law: Law | None = None
    begin: Expr | None = None
    end: Expr | None = None
    when: Crossing | None = None
    until: Crossing | None = None
    formula: Expr | None = None


def read_measure(rest: str, line: Line) -> Measure | None:
    """Return what a ``.meas`` line asks for, None if it is of another analysis or a form unknown.

    Raises
    ------
    FileError
        HB-F131.

    Examples
    --------
    >>> line = Line("x.cir", 1, "")
    >>> read_measure("tran vout AVG v(out) FROM=1m TO=2m", line).kind
    'avg'
    >>> read_measure("ac f0 WHEN vdb(out)=-3", line) is None
    True
    """
    match = _HEAD.match(rest)
    if match is None:
        return None
    name, kind, text = match[1].lower(), match[2].lower(), match[3].strip()
    text = re.sub(r"par\s*\(\s*'([^']*)'\s*\)", r"\1", text, flags=re.IGNORECASE)
    if kind == "param":
        return Measure(name, kind, line, formula=read_formula(text, line))
    if kind == "integral":
        kind = "integ"
    if kind == "trig":
        parts = re.split(r"\btarg\b", text, flags=re.IGNORECASE)
        if len(parts) != 2:
            return None
        first, second = (_crossing(part, line) for part in parts)
        if first is None or second is None:
            return None
        return Measure(name, kind, line, when=first, until=second)
    if kind == "when":
        crossing = _crossing(text, line)
        return None if crossing is None else Measure(name, kind, line, when=crossing)
    parts = re.split(r"\bwhen\b", text, maxsplit=1, flags=re.IGNORECASE)
    if len(parts) == 2 and kind in ("find", "deriv"):
        crossing = _crossing(parts[1], line)
        if crossing is None:
            return None
        return Measure(name, kind, line, read_law(parts[0], line), when=crossing)
    body, given = _windows(text, line)
    law = read_law(body, line)
    if kind in ("find", "deriv"):
        if "at" not in given:
            return None
        return Measure(name, kind, line, law, when=Crossing(None, at=given["at"]))
    if set(given) - {"from", "to"}:
        return None
    return Measure(name, kind, line, law, given.get("from"), given.get("to"))


def _windows(text: str, line: Line) -> tuple[str, dict[str, Expr]]:
    """Return what stands before the first of ``FROM``, ``TO``, ``AT``, ..., and their values."""
    found = list(_WINDOW.finditer(text))
    if not found:
        return text.strip(), {}
    ends = [m.start() for m in found[1:]] + [len(text)]
    given = {
        m[1].lower(): read_formula(text[m.end() : end].strip(), line)
        for m, end in zip(found, ends, strict=True)
        if m[1].lower() not in ("rise", "fall", "cross")
    }
    return text[: found[0].start()].strip(), given


def _crossing(text: str, line: Line) -> Crossing | None:
    edge = _EDGE.search(text)
    if edge is not None:
        text = text[: edge.start()] + text[edge.end() :]
    which = edge[2].lower() if edge is not None else "1"
    if which != "last" and not which.isdigit():
        return None
    body, given = _windows(text.strip(), line)
    if not body:
        return Crossing(None, at=given["at"]) if "at" in given else None
    sides = _EQUALS.split(body)
    if "val" in given:
        level = _LEVEL.search(text)
        sides = [body, level[1] if level is not None else ""]
    if len(sides) != 2:
        return None
    law = read_law(f"({_bare(sides[0])}) - ({_bare(sides[1])})", line)
    kind = edge[1].lower() if edge is not None else "cross"
    count = 0 if which == "last" else int(which)
    return Crossing(law, kind, count, given.get("td", Number(0.0)))


def _bare(text: str) -> str:
    return text.strip().strip("{}'")
