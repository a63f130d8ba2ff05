"""Guards at jumps, on pairs of a finite part and an impulse."""

from __future__ import annotations

from collections.abc import Callable

from hybond.errors import ModelError
from hybond.export.modelica.expressions import Resolve, modelica
from hybond.model.expressions import (
    And,
    Binary,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    posterior_names,
    simplify,
    to_text,
)


class Pairs:
    """Guards on pairs: comparisons look at the impulse first, at the finite part if it is zero.

    Parameters
    ----------
    resolve : callable
        Names to finite parts.
    impulse : callable
        A canonical name to the text of its impulse, or None if it never has one.
    small : str
        The text of what counts as no impulse.
    """

    def __init__(self, resolve: Resolve, impulse: Callable[[str], str | None], small: str) -> None:
        self.resolve = resolve
        self.impulse = impulse
        self.small = small

    def condition(self, e: Expr, slack: Callable[[Expr], str] | None = None) -> str:
        """Return a guard as text.

        Parameters
        ----------
        slack : callable, optional
            What is compared with zero, to the text of the size below which it counts as zero.
        """
        match e:
            case And(args=args):
                return " and ".join(f"({self.condition(a, slack)})" for a in args)
            case Or(args=args):
                return " or ".join(f"({self.condition(a, slack)})" for a in args)
            case Not(arg=arg):
                return f"not ({self.condition(arg, slack)})"
            case Compare(op=op) if op not in ("==", "!="):
                return self._comparison(e, op, slack)
            case If(cond=cond, then=then, orelse=orelse):
                a, b, c = (self.condition(x, slack) for x in (cond, then, orelse))
                return f"if {a} then {b} else {c}"
        return modelica(e, self.resolve)

    def _comparison(self, e: Compare, op: str, slack: Callable[[Expr], str] | None) -> str:
        difference = simplify(Binary("-", e.left, e.right))
        finite, impulse = self.pair(difference)
        least = slack(e.left) if slack and op in ("<", ">") and e.right == Number(0.0) else ""
        if impulse is None and finite is None and not least:
            return modelica(e, self.resolve)
        text = modelica(difference, self.resolve) if finite is None else finite
        if impulse is not None:
            # one relation, not two: one of an impulse that is never there would be zero for ever
            text = f"(if noEvent(abs({impulse}) > {self.small}) then {impulse} else {text})"
        return f"{text} {op} {'-' if least and op == '<' else ''}{least or 0}"

    def pair(self, e: Expr) -> tuple[str | None, str | None]:
        """Return the finite part, None if it is plain, and the impulse, None if there is none."""
        match e:
            case Name(path=path):
                return None, self.impulse(path)
            case Neg(arg=arg):
                finite, impulse = self.pair(arg)
                return _minus(finite), _minus(impulse)
            case Binary(op=("+" | "-") as op):
                return self._sum(op, e)
            case Binary(op=("*" | "/") as op):
                return self._product(op, e)
            case Call(function="abs", args=(arg,)):
                finite, impulse = self.pair(arg)
                if impulse is None:
                    return (None if finite is None else f"abs({finite})"), None
                plain = self._finite(arg, finite)
                there = f"noEvent(abs({impulse}) > {self.small})"
                signed = f"noEvent(sign({impulse}))*({plain})"
                finite = f"(if {there} then {signed} else abs({plain}))"
                return finite, f"noEvent(abs({impulse}))"
        if self._reads_impulse(e):
            raise ModelError(
                f"{to_text(e)} of an impulse has no meaning",
                code="HB-E683",
                where="the Modelica text",
                hint="compare the impulse itself: its sign, or its size beside another",
            )
        return None, None

    def _finite(self, e: Expr, finite: str | None) -> str:
        return modelica(e, self.resolve) if finite is None else finite

    def _sum(self, op: str, e: Binary) -> tuple[str | None, str | None]:
        (f1, i1), (f2, i2) = self.pair(e.left), self.pair(e.right)
        finite = None
        if f1 is not None or f2 is not None:
            finite = f"({self._finite(e.left, f1)}) {op} ({self._finite(e.right, f2)})"
        if i1 is None:
            return finite, (i2 if op == "+" else _minus(i2))
        return finite, (i1 if i2 is None else f"{i1} {op} ({i2})")

    def _product(self, op: str, e: Binary) -> tuple[str | None, str | None]:
        (f1, i1), (f2, i2) = self.pair(e.left), self.pair(e.right)
        if i1 is None and i2 is None and f1 is None and f2 is None:
            return None, None
        if i2 is not None and (i1 is not None or op == "/"):
            raise ModelError(
                f"{to_text(e)} of impulses has no meaning",
                code="HB-E683",
                where="the Modelica text",
                hint="compare the impulses themselves",
            )
        left, right = self._finite(e.left, f1), self._finite(e.right, f2)
        finite = f"({left}){op}({right})" if f1 is not None or f2 is not None else None
        if i1 is not None:
            return finite, f"({i1}){op}({right})"
        return finite, (None if i2 is None else f"({left})*({i2})")

    def _reads_impulse(self, e: Expr) -> bool:
        return any(self.impulse(n) is not None for n in posterior_names(e))


def _minus(text: str | None) -> str | None:
    return None if text is None else f"-({text})"
