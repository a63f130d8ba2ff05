"""Powers of what may be below zero, which simulators take in two ways."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hybond.circuits.formulas import evaluate
from hybond.model.expressions import Binary, Call, Expr, If, Name
from hybond.model.expressions.tree import walk


def powers_below_zero(formula: Expr, known: Mapping[str, float]) -> Iterator[str]:
    """Yield exponents of powers whose base may be below zero, and which are not even then.

    Examples
    --------
    >>> from hybond.circuits.formulas import read_formula
    >>> from hybond.circuits.notices import Line
    >>> line = Line("x.cir", 1, "")
    >>> for text in ("x^3 + x^2", "abs(x)^1.5", "(x*x + 1)^n", "y/abs(x)**n"):
    ...     formula = read_formula(text, line)
    ...     print(list(powers_below_zero(formula, {"n": 2.5})))
    ['3']
    []
    []
    []
    >>> list(powers_below_zero(read_formula("-x**n", line), {"n": 2.5}))
    ['2.5']
    """
    for part, _ in walk(formula):
        if not isinstance(part, Binary) or part.op != "^":
            continue
        exponent = _number(part.right, known)
        if not _is_even(exponent) and not _is_never_below_zero(part.left, known):
            yield f"{exponent:g}" if exponent is not None else str(part.right)


def _number(e: Expr, known: Mapping[str, float]) -> float | None:
    """Return the value of what does not change, or None."""
    try:
        return evaluate(e, known)
    except (KeyError, ArithmeticError, ValueError):
        return None


def _is_even(exponent: float | None) -> bool:
    return exponent is not None and exponent % 2.0 == 0.0


def _is_never_below_zero(e: Expr, known: Mapping[str, float]) -> bool:
    """Whether a base is zero or more as it is written."""
    number = _number(e, known)
    if number is not None:
        return number >= 0.0
    if isinstance(e, Name):
        return e.path == "time"
    if isinstance(e, If):
        return all(_is_never_below_zero(x, known) for x in (e.then, e.orelse))
    if isinstance(e, Call):
        if e.function in ("abs", "sqrt", "exp", "cosh"):
            return True
        found = [_is_never_below_zero(x, known) for x in e.args]
        return (e.function == "max" and any(found)) or (e.function == "min" and all(found))
    if not isinstance(e, Binary):
        return False
    if e.op == "^":
        return _is_even(_number(e.right, known)) or _is_never_below_zero(e.left, known)
    if e.op == "*" and e.left == e.right:
        return True
    both = _is_never_below_zero(e.left, known) and _is_never_below_zero(e.right, known)
    return e.op in ("+", "*", "/") and both
