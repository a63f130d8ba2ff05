"""``.tran``: how long a run lasts, where its output points are, from where it starts; ``.step``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from hybond.circuits.cards import words_of
from hybond.circuits.formulas import read_formula
from hybond.circuits.notices import Line, Notices
from hybond.model.expressions import Binary, Expr, Number

OUTPUTS = 1000
"""Output points of a run whose ``.tran`` names no step."""


NONE = Number(0.0)


@dataclass(frozen=True, slots=True)
class Transient:
    """A ``.tran`` line."""

    line: Line
    step: Expr
    """Distance of output points."""
    stop: Expr
    uic: bool
    edge: Expr = NONE
    """What an edge without a time of its own lasts: the step, where one is written."""
    startup: bool = False
    """Whether the sources are off at first, and come up within the first 20 us."""
    start: Expr = NONE
    """From when on simulators keep what they compute."""


def read_transient(rest: str, line: Line, notices: Notices) -> Transient:
    """Return what a ``.tran`` line says; a step of zero is none, as in LTspice.

    Raises
    ------
    FileError
        HB-F130, HB-F131.

    Examples
    --------
    >>> line = Line("x.net", 9, ".tran 0 5m 0 1u startup")
    >>> found = read_transient("0 5m 0 1u startup", line, Notices())
    >>> str(found.step), str(found.stop), found.startup
    ('1e-06', '0.005', True)
    """
    words = words_of(rest, line)
    flags = {w.lower() for w in words} & {"uic", "startup", "steady", "nodiscard"}
    if "steady" in flags:
        notices.add(line, "steady is left out: the run lasts until its stop time")
    words = [w for w in words if w.lower() not in flags]
    times = [read_formula(w, line) for w in words]
    if not 1 <= len(times) <= 4:
        raise line.refuse(
            f"{len(times)} times", code="HB-F130", hint=".tran step stop [start [max]] [uic]"
        )
    start = times[2] if len(times) > 2 else NONE
    if start != NONE:
        notices.add(
            line,
            "all of the run is kept, also before the start of output; .meas without FROM begins at "
            "the latter",
        )
    stop = times[0] if len(times) == 1 else times[1]
    edge = times[0] if len(times) > 1 else Number(0.0)
    step = edge
    if edge == Number(0.0):
        step = Binary("/", stop, Number(float(OUTPUTS)))
        if len(times) == 4 and times[3] != Number(0.0):
            step = times[3]
    return Transient(line, step, stop, "uic" in flags, edge, "startup" in flags, start)


@dataclass(frozen=True, slots=True)
class StepLine:
    """A ``.step`` line, its values as they are written."""

    name: str
    """In lower case."""
    written: str
    line: Line
    form: str
    """``"list"``, ``"lin"``, ``"dec"`` or ``"oct"``."""
    values: tuple[Expr, ...]
    """All of a list; else first, last, and distance or number."""


def read_step(rest: str, line: Line) -> StepLine:
    """Return what a ``.step`` line says.

    Raises
    ------
    FileError
        HB-F131, HB-F137 (what is stepped is no parameter).

    Examples
    --------
    >>> line = Line("x.net", 1, "")
    >>> read_step("param R list 10 20", line).form, read_step("dec param C 1n 1u 5", line).form
    ('list', 'dec')
    """
    words = [w for w in words_of(rest, line) if w not in "()"]
    form = "lin"
    if words and words[0].lower() in ("lin", "dec", "oct"):
        form = words.pop(0).lower()
    if len(words) < 3 or words[0].lower() != "param" or not re.fullmatch(r"\w+", words[1]):
        raise line.refuse(
            "what is stepped is no parameter",
            code="HB-F137",
            hint=".step param R 10 100 10, and {R} where it is used",
        )
    name, given = words[1].lower(), words[2:]
    if given[0].lower() in ("list", "lin", "dec", "oct"):
        form = given.pop(0).lower()
    if form != "list" and len(given) != 3:
        raise line.refuse(
            "a range has three numbers", code="HB-F130", hint="first, last, distance (or number)"
        )
    return StepLine(name, words[1], line, form, tuple(read_formula(w, line) for w in given))
