"""Sources that compute: B, and E, G, F, H with a polynomial or an expression."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import combinations_with_replacement

from hybond.circuits.formulas import read_formula
from hybond.circuits.notices import Line
from hybond.model.expressions import Expr

PLACE = "read#"
"""Before the number of something read; no name in a netlist has such a sign."""
READ = re.compile(r"(?<![\w.])([vi])\s*\(\s*([^(),\s]+)\s*(?:,\s*([^(),\s]+)\s*)?\)", re.IGNORECASE)
_BRANCH = re.compile(
    r"(?<![\w.@#])([a-z][\w.]*)#branch\b|@([a-z][\w.]*)\[(?:i|id|current)\]", re.IGNORECASE
)
_B = re.compile(r"\S+\s+(\S+)\s+(\S+)\s+([vi])\s*=(?!=)\s*(.+)\Z", re.IGNORECASE | re.DOTALL)
_VALUE = re.compile(
    r"\S+\s+(\S+)\s+(\S+)\s+(?:value|vol|cur|v|i)\s*(?:=(?!=)\s*|(?=[{'\"]))(.+)\Z",
    re.IGNORECASE | re.DOTALL,
)
_POLY = re.compile(
    r"\S+\s+(\S+)\s+(\S+)\s+poly\s*\(\s*(\d+)\s*\)\s*(.+)\Z", re.IGNORECASE | re.DOTALL
)
_TABLE = re.compile(
    r"\S+\s+(\S+)\s+(\S+)\s+table\s*=?\s*\{([^{}]*)\}\s*=?\s*(.+)\Z", re.IGNORECASE | re.DOTALL
)


@dataclass(frozen=True, slots=True)
class Read:
    """A voltage between two nodes, or the current of an element, as written."""

    kind: str
    """``"v"`` or ``"i"``."""
    first: str
    second: str = "0"


@dataclass(frozen=True, slots=True)
class Law:
    """What a source imposes: an expression of what it reads, in V and A."""

    imposes: str
    """``"v"`` or ``"i"``."""
    formula: Expr
    """What is read stands in it as ``read#0``, ``read#1``, ..., time as ``time``."""
    reads: tuple[Read, ...]


def plainly(text: str) -> str:
    """Return a text with currents as ``i(...)`` where ngspice has other words for them.

    Examples
    --------
    >>> plainly("2*v1#branch + @r.x1.r2[i]")
    '2*i(v1) + i(r.x1.r2)'
    """
    return _BRANCH.sub(lambda match: f"i({match[1] or match[2]})", text)


def read_law(text: str, line: Line, imposes: str = "v") -> Law:
    """Return an expression with the voltages and currents that it reads.

    Raises
    ------
    FileError
        HB-F131.

    Examples
    --------
    >>> law = read_law("{2*V(a,b) + i(V1)*1k}", Line("x.cir", 1, ""))
    >>> str(law.formula), [(r.kind, r.first, r.second) for r in law.reads]
    ('2*read#0 + read#1*1000', [('v', 'a', 'b'), ('i', 'V1', '0')])
    """
    reads: dict[Read, int] = {}

    def placed(match: re.Match[str]) -> str:
        read = Read(match[1].lower(), match[2], match[3] or "0")
        return f" {PLACE}{reads.setdefault(read, len(reads))} "

    formula = read_formula(READ.sub(placed, plainly(text)), line)
    return Law(imposes, formula, tuple(reads))


def behaviour_of(line: Line) -> tuple[tuple[str, str], Law] | None:
    """Return the nodes and the law of a source that computes; None if the card is none.

    Raises
    ------
    FileError
        HB-F130, HB-F131, HB-F136.
    """
    kind = line.text[0].lower()
    if kind == "b":
        match = _B.match(line.text)
        if match is None:
            raise line.refuse(
                "a source B without a law", code="HB-F130", hint="B1 out 0 V=2*V(in), or I=..."
            )
        return (match[1], match[2]), read_law(match[4], line, match[3].lower())
    imposes = "v" if kind in "eh" else "i"
    match = _VALUE.match(line.text) if kind in "eg" else None
    if match is not None:
        return (match[1], match[2]), read_law(match[3], line, imposes)
    match = _TABLE.match(line.text) if kind in "eg" else None
    if match is not None:
        points = re.findall(r"\{[^{}]*\}|[^\s(),]+", match[4])
        text = f"table({match[3]}, {', '.join(p.strip('{}') for p in points)})"
        return (match[1], match[2]), read_law(text, line, imposes)
    match = _POLY.match(line.text)
    if match is None:
        return None
    text = _polynomial(int(match[3]), match[4], kind, line)
    return (match[1], match[2]), read_law(text, line, imposes)


def _polynomial(count: int, rest: str, kind: str, line: Line) -> str:
    """Return a polynomial as an expression; products of its variables come as SPICE orders them.

    After the constant those of one variable, then all of two, three: x, y, x*x, x*y, y*y, ...
    """
    words = re.findall(r"\{[^{}]*\}|[^\s(),]+", rest)
    width = 2 if kind in "eg" else 1
    given = words[width * count :]
    if count < 1 or not given:
        raise line.refuse(
            "a polynomial without coefficients",
            code="HB-F130",
            hint="E1 out 0 POLY(1) in 0 0 2 is twice the voltage of in",
        )
    sensed = words[: width * count]
    if width == 2:
        reads = [f"v({a},{b})" for a, b in zip(sensed[::2], sensed[1::2], strict=True)]
    else:
        reads = [f"i({name})" for name in sensed]
    factors = [f"({word.strip('{}')})" for word in given]
    if count == 1:
        if len(factors) == 1:  # then it is the gain, in every SPICE
            return f"{factors[0]}*{reads[0]}"
        powers = ["1", reads[0], *(f"{reads[0]}**{k}" for k in range(2, len(factors)))]
        return " + ".join(f"{c}*{x}" for c, x in zip(factors, powers, strict=True))
    powers = ["1", *reads]
    degree = 2
    while len(powers) < len(factors):
        powers += ["*".join(c) for c in combinations_with_replacement(reads, degree)]
        degree += 1
    # what is zero is left out: macro models have long rows of zeros
    terms = [(c, x) for c, x in zip(factors, powers, strict=False) if c.strip("()") != "0"]
    return " + ".join(f"{c}*{x}" for c, x in terms) or "0"
