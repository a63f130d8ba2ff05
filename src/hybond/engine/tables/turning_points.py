"""Where a comparison turns because something in it is zero: what that is, from within outwards.

``exp(-x^2)`` turns where x is zero, whatever goes one way is made of it, and ``abs(abs(x) - 3)``
where ``abs(x) - 3`` is and where x is. Between such places it goes as what is within does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.tables.columns import INTS, put_rows
from hybond.equations.surfaces import moves
from hybond.model.expressions import (
    Binary,
    Call,
    Expr,
    If,
    Neg,
    Number,
    Table,
    comparisons,
    turning,
)
from hybond.model.expressions.rounded_roots import magnitude
from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import fold, walk

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

MOST = 16
"""Of one guard, the outermost of them."""
_RISING = ("exp", "tanh", "sinh", "atan")
"""Functions of which several make a pulse."""


def put_turning_points(t: ModelTables, kinks: list[Expr]) -> None:
    """Put those of all guards into the tables, then of these kinks, behind what they compare."""
    first = t.ints["atom_first"]
    compared = [
        [t.values.all[k] for k in t.ints["atom_value"][first[r] : first[r + 1]]]
        for r in range(len(first) - 1)
    ]
    place: dict[Expr, int] = {}
    start = len(t.ints["atom_value"])
    rows = []
    for own in (*compared, *([k] for k in kinks)):
        poles = {a for e in own for a in fold(e, _poles)}
        found = turning_points(own)
        rows.append([(start + place.setdefault(a, len(place)), int(a in poles)) for a in found])
    put_rows(t, "turn_first", rows, turn_atom=INTS, turn_pole=INTS)
    t.ints["atom_value"] += [t.values.number(a) for a in place]
    t.ints["atom_size"] += [t.values.number(magnitude(a)) for a in place]
    t.ints["atom_zero"] += [1] * len(place)


def turning_points(compared: list[Expr]) -> list[Expr]:
    """Return what is zero where any of these turns.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> for text in ("time^8 - 1", "exp(-(time - a)^2)", "abs(abs(time) - 3)", "time*exp(time)"):
    ...     print(*turning_points([parse(text)]), sep=", ")
    time
    time - a
    time, abs(time) - 3
    time, exp(time)
    """
    found = dict.fromkeys(a for e in compared for a in (*fold(e, _inside), *_pulsed(e)))
    return [a for a in found if moves(a) and a not in compared][-MOST:]


def _pulsed(e: Expr) -> list[Expr]:
    """Return about where functions that go one way do so, if there are several of them."""
    rising = [p.args[0] for p, _ in walk(e) if isinstance(p, Call) and p.function in _RISING]
    rising = [a for a in dict.fromkeys(rising) if moves(a)]
    return rising if len(rising) > 1 else []


def _inside(e: Expr, prior: bool, below: list[list[Expr]]) -> list[Expr]:
    return [a for own in below for a in own] + ([] if prior else [_base(a) for a in _own(e)])


def _own(e: Expr) -> list[Expr]:
    """Return what is zero where the outermost function of an expression turns."""
    match e:
        case Call("abs" | "cosh", (a,)):
            return [a]
        case Call("hypot", args):
            return list(args)
        case Call("min" | "max" | "floor" | "ceil" | "mod" | "sign") | Table():
            return turning(e)
        case Binary("^", a, Number(power)):
            return [a] if is_slotted(power) or (power % 2.0 == 0.0 or power < 0.0) else []
        case Binary("*", a, b) if moves(a) and moves(b):
            return [a, b]
        case Binary("/", a, b) if moves(b):
            return [a, b]
        case If():
            return [Binary("-", c.left, c.right) for c in comparisons(e.cond)]
    return []


def _poles(e: Expr, prior: bool, below: list[list[Expr]]) -> list[Expr]:
    """Return what is zero where an expression has no value."""
    match e:
        case Binary("/", _, a) | Call("log" | "log10", (a,)):
            own = _factors(a)
        case Binary("^", a, Number(power)) if not is_slotted(power) and power < 0.0:
            own = _factors(a)
        case _:
            own = []
    return [a for inner in below for a in inner] + own


def _factors(e: Expr) -> list[Expr]:
    """Return what is zero where a product is, and what it is of."""
    match e:
        case Binary("*", a, b):
            return [e, *_factors(a), *_factors(b)]
        case Binary("^", a, Number()) | Call("abs" | "sqrt", (a,)) | Neg(a):
            return [e, *_factors(a)]
    return [e]


def _base(e: Expr) -> Expr:
    """Return what is zero where a size or a power is."""
    while True:
        match e:
            case Binary("^", a, Number()) | Call("abs", (a,)):
                e = a
            case _:
                return e
