"""From formulas to rational functions; what is not rational in a formula becomes an atom."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hybond.equations.symbolic.rational import Rational
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Neg,
    Number,
    compile_expression,
    names,
    posterior_names,
    prior_names,
    to_text,
)

LARGEST = 32
"""Higher powers stay as they are written: multiplied out they would be no help to anyone."""


class Atoms:
    """Reads formulas, and remembers what each atom stands for that is not a plain name.

    Attributes
    ----------
    meaning : dict of str to Expr
        Such an atom, called by its own text, to its formula: ``sqrt(p:A)``, ``pi``.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> atoms = Atoms()
    >>> r = atoms.read(parse("sin(x)*a^2/(a*sin(x))"))
    >>> r == Rational.atom("a")
    True
    >>> atoms.read(parse("2*sin(x)")).evaluate(atoms.values({"x": 0.5}))
    0.9588510772084
    """

    def __init__(self) -> None:
        self.meaning: dict[str, Expr] = {}

    def read(self, e: Expr) -> Rational:
        """Return `e` as a rational function.

        Names, ``+ - * /`` and whole powers are taken as such; any other part is one atom. So is one
        over what is zero, which has no value as a rational function.
        """
        # No recursion: a formula may be deeper than Python's stack.
        done: list[Rational] = []
        stack = [(e, False)]
        while stack:
            node, ready = stack.pop()
            if ready:
                done.append(self._combined(node, done))
                continue
            match node:
                case Number(value) if math.isfinite(value) and value != math.pi:
                    done.append(Rational.of(value))
                case Name(path):
                    done.append(Rational.atom(path))
                case Neg(arg):
                    stack += [(node, True), (arg, False)]
                case Binary("^", left, right) if _whole(right) is not None:
                    stack += [(node, True), (left, False)]
                case Binary(op, left, right) if op != "^":
                    stack += [(node, True), (right, False), (left, False)]
                case _:
                    done.append(self._opaque(node))
        return done[0]

    def _combined(self, node: Expr, done: list[Rational]) -> Rational:
        b = done.pop()
        match node:
            case Neg():
                return -b
            case Binary("^", _, right):
                power = _whole(right) or 0
                return self._opaque(node) if b.is_zero and power < 0 else b**power
            case Binary(op):
                a = done.pop()
                if op == "/" and b.is_zero:
                    return a * self._opaque(Binary("/", Number(1.0), node.right))
                if op == "/":
                    return a / b
                return a * b if op == "*" else a - b if op == "-" else a + b
        raise TypeError(type(node).__name__)

    def _opaque(self, node: Expr) -> Rational:
        text = to_text(node)
        self.meaning.setdefault(text, node)
        return Rational.atom(text)

    def values(
        self, known: Mapping[str, float], prior: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """Return the known values and those of all atoms whose formula these determine.

        Parameters
        ----------
        known : mapping of str to float
            Values of names.
        prior : mapping of str to float
            Values of names inside ``pre(...)``.
        """
        before = prior or {}
        found = dict(known)
        for atom, e in self.meaning.items():
            if posterior_names(e) <= known.keys() and prior_names(e) <= before.keys():
                order = sorted(names(e))
                slots = {name: k for k, name in enumerate(order)}
                vector = [known.get(n, 0.0) for n in order] + [before.get(n, 0.0) for n in order]
                found[atom] = compile_expression(e, slots, pre_offset=len(order))(vector)
        return found


def _whole(e: Expr) -> int | None:
    """Return an exponent that is a whole number of moderate size."""
    match e:
        case Number(value):
            pass
        case Neg(Number(inner)):
            value = -inner
        case _:
            return None
    if math.isfinite(value) and value == int(value) and abs(value) <= LARGEST:
        return int(value)
    return None
