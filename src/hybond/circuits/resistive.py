"""Sources that compute their current from their own voltage, or the other way round: resistors.

A varistor is written as ``B1 a 0 I=v(a)/40 + (v(a)/200)^5``. As a resistor with a law it says what
it is: nothing but its own two variables, and it takes energy only. Laws that may give energy, as
those of tunnel diodes, those that read anything else, and those that compare stay sources. So do
those with a sign that are flatter at zero than a square: as resistors they would run no better, for
read backwards, as a coil reads them, they are steep without bound either way.
"""

from __future__ import annotations

import math
from itertools import pairwise

from hybond.circuits.behaviour import PLACE, Law
from hybond.circuits.formulas import names_in
from hybond.model.expressions import (
    Call,
    Compare,
    Expr,
    Name,
    Neg,
    compile_expression,
    parse,
    substitute,
)
from hybond.model.expressions.tree import walk

OWN = "own"
"""The name of its own variable in a formula."""
LEVELS = tuple(m * 10.0**k for k in range(-9, 7) for m in (1.0, 2.0, 5.0))
"""Sizes at which a law is tried, in V or A."""
FLAT = (1e-6, 1e-3)
"""Those between which it shows whether it is flatter at zero than a square."""


def resistive(law: Law, a: str, b: str, key: str) -> Expr | None:
    """Return what a source between two nodes computes from its own variable alone, or None.

    Parameters
    ----------
    a, b, key : str
        Its nodes, and its name in lower case.

    Examples
    --------
    >>> from hybond.circuits.behaviour import read_law
    >>> from hybond.circuits.notices import Line
    >>> line = Line("x.cir", 1, "")
    >>> str(resistive(read_law("v(a)/40 + v(a)^3", line, "i"), "a", "0", "b1"))
    'own/40 + own^3'
    >>> resistive(read_law("-v(a)/40", line, "i"), "a", "0", "b1") is None
    True
    """
    means: dict[str, Expr] = {}
    for k, read in enumerate(law.reads):
        own = Name(OWN)
        if law.imposes == "i" and read.kind == "v" and {read.first, read.second} == {a, b}:
            means[f"{PLACE}{k}"] = own if read.first == a else Neg(own)
        elif law.imposes == "v" and read.kind == "i" and read.first.lower() == key:
            means[f"{PLACE}{k}"] = own
        else:
            return None
    if not means or any(isinstance(part, Compare) for part, _ in walk(law.formula)):
        return None
    whole = substitute(law.formula, means)
    return whole if set(names_in(whole)) == {OWN} and _takes_energy(whole) else None


def as_law(imposes: str, formula: Expr, sign: int) -> dict[str, str]:
    """Return such a formula as the law of a resistor whose variables are `sign` times its own.

    Examples
    --------
    >>> as_law("i", parse("own/40 + own^3"), 1)
    {'f': '1 A*(e/1 [V]/40 + (e/1 [V])^3)'}
    """
    given, unit, read = ("f", "A", "e/1 [V]") if imposes == "i" else ("e", "V", "f/1 [A]")
    own = parse(read) if sign > 0 else parse(f"-{read}")
    text = str(substitute(formula, {OWN: own}))
    return {given: f"{'' if sign > 0 else '-'}1 {unit}*({text})"}


def _takes_energy(formula: Expr) -> bool:
    """Whether a law rises through zero, wherever it has been tried."""
    at = compile_expression(formula, {OWN: 0}, pre_offset=0)
    found = []
    for x in (*(-level for level in reversed(LEVELS)), 0.0, *LEVELS):
        try:
            y = float(at([x]))
        except (ArithmeticError, ValueError):
            y = math.nan
        if math.isnan(y):
            return False
        found.append((x, y))
    rises = all(p[1] <= q[1] for p, q in pairwise(found))
    signs = all((x > 0.0) == (y > 0.0) or y == 0.0 for x, y in found)
    near, far = (abs(dict(found)[x]) for x in FLAT)
    signed = any(isinstance(part, Call) for part, _ in walk(formula))
    flat = signed and near < 0.1 * (FLAT[0] / FLAT[1]) ** 2 * far
    return rises and signs and dict(found)[0.0] == 0.0 and not flat
