"""Tree to text: the language itself, LaTeX, Python."""

from __future__ import annotations

import keyword
import math
import re

from hybond.errors import ExpressionError
from hybond.model.expressions.slots import plain
from hybond.model.expressions.tree import (
    And,
    Binary,
    Bool,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    Pre,
    String,
    Table,
    children,
    fold,
    walk,
)

_IF, _OR, _AND, _NOT, _COMPARE, _SUM, _PRODUCT, _NEG, _POWER, _ATOM = range(1, 11)
_LEVEL = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT, "^": _POWER}
_SPACED = {"+": " + ", "-": " - ", "*": "*", "/": "/", "^": "^"}


def _level(e: Expr) -> int:
    match e:
        case If():
            return _IF
        case Or():
            return _OR
        case And():
            return _AND
        case Not():
            return _NOT
        case Compare():
            return _COMPARE
        case Binary():
            return _LEVEL[e.op]
        case Neg():
            return _NEG
        case Number() if math.copysign(1.0, plain(e.value)) < 0:
            return _NEG
    return _ATOM


def _float(value: float) -> str:
    """Write a float so that it reads back as the same float."""
    if value == math.pi:
        return "pi"
    if value == math.floor(value) and abs(value) < 1e15 and math.copysign(1.0, value) > 0:
        return str(int(value))
    if value == math.floor(value) and 0 < abs(value) < 1e15:
        return str(int(value))
    return repr(value)


def _paren(text: str) -> str:
    return f"({text})"


def _layout(e: Expr, below: list[str], power: str) -> str:
    """Write what the language and Python share: operators and their parentheses."""

    def at(k: int, level: int) -> str:
        return below[k] if _level(kids[k]) >= level else _paren(below[k])

    kids = children(e)
    match e:
        case Neg(arg):
            # `-2` reads as a number, so the negation of a number keeps its parentheses.
            bare = isinstance(arg, Number) and below[0] != "pi"
            return "-" + (_paren(below[0]) if bare else at(0, _NEG))
        case Not():
            return "not " + at(0, _NOT)
        case Compare(op):
            return f"{at(0, _SUM)} {op} {at(1, _SUM)}"
        case And():
            return " and ".join([at(k, _NOT) for k in range(len(kids))])
        case Or():
            return " or ".join([at(k, _AND) for k in range(len(kids))])
        case Binary("^"):
            return at(0, _ATOM) + power + at(1, _NEG)
        case Binary(op):
            level = _LEVEL[op]
            return at(0, level) + _SPACED[op] + at(1, level + 1)
    raise TypeError(type(e).__name__)


def to_text(e: Expr) -> str:
    """Write `e` in the language, with no more parentheses than needed.

    ``parse(to_text(e)) == e`` for every tree that `parse` can return. A table prints as
    ``table(arg)``, which does not read back.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> to_text(parse("(a*(b)) + -(x^2) - (y - 1e-3) * 10mA"))
    'a*b + -x^2 - (y - 0.001)*0.01 [A]'
    """
    return fold(e, _text)


def _text(e: Expr, prior: bool, below: list[str]) -> str:
    match e:
        case Number(number, dimension):
            value = plain(number)
            unit = "" if dimension is None else f" [{dimension}]"
            # `pi` is a name to the parser and takes no unit.
            return (repr(value) if unit and value == math.pi else _float(value)) + unit
        case Bool(value):
            return "true" if value else "false"
        case Name(path):
            return path
        case String(text):
            return f'"{text}"'
        case Pre():
            return f"pre({below[0]})"
        case Call(function):
            return f"{function}({', '.join(below)})"
        case Table():
            return f"{'table_slope' if e.slope else 'table'}({below[0]})"
        case If(cond):
            test = below[0] if _level(cond) > _IF else _paren(below[0])
            return f"if {test} then {below[1]} else {below[2]}"
    return _layout(e, below, "^")


def to_python(e: Expr, *, prefix: str = "math.") -> str:
    """Write `e` as a Python expression.

    Dots and other marks of a name become underscores, names inside ``pre(...)`` get the prefix
    ``pre_``. Units are left out. A table becomes a call ``table(arg, x, y, extrapolate)`` (or
    ``table_slope``), which the host defines.

    Parameters
    ----------
    prefix : str
        What stands before the functions of `math`.

    Raises
    ------
    ExpressionError
        HB-E109 if two names become the same identifier.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> to_python(parse("if pre(ball.p) > 0 then sin(x)^2 else -k*x"))
    'math.sin(x)**2 if pre_ball_p > 0 else -k*x'
    """
    used: dict[str, tuple[str, bool]] = {}
    for node, prior in walk(e):
        if isinstance(node, Name):
            mangled = python_name(node.path, prior=prior)
            first = used.setdefault(mangled, (node.path, prior))
            if first != (node.path, prior):
                why = f"{first[0]!r} and {node.path!r} both become {mangled!r} in Python"
                raise ExpressionError(why, code="HB-E109", where="names", hint="rename one of them")

    def write(node: Expr, prior: bool, below: list[str]) -> str:
        return _python(node, below, prior, prefix)

    return fold(e, write)


def python_name(path: str, *, prior: bool = False) -> str:
    """Return the Python identifier of a name.

    Examples
    --------
    >>> python_name('"contact->v".e'), python_name("ball.p", prior=True), python_name("lambda")
    ('contact_v_e', 'pre_ball_p', 'lambda_')
    """
    plain = re.sub(r"\W+", "_", path).strip("_") or "_"
    if prior:
        return "pre_" + plain
    if plain[0].isdigit():
        plain = "_" + plain
    return plain + "_" if keyword.iskeyword(plain) else plain


def _python(e: Expr, below: list[str], prior: bool, prefix: str) -> str:
    match e:
        case Number(number):
            value = plain(number)
            return f"{prefix}pi" if value == math.pi else _float(value)
        case Bool(value):
            return str(value)
        case Name(path):
            return python_name(path, prior=prior)
        case String(text):
            return repr(text)
        case Pre(arg):
            return below[0] if _level(arg) == _ATOM else _paren(below[0])
        case Call("sign"):
            return f"(lambda u: (u > 0) - (u < 0))({below[0]})"
        case Call("mod"):
            return f"(({below[0]}) % ({below[1]}))"
        case Call(function):
            called = function if function in ("abs", "min", "max") else prefix + function
            return f"{called}({', '.join(below)})"
        case Table(_, x, y, extrapolate, slope):
            called = "table_slope" if slope else "table"
            return f"{called}({below[0]}, {x!r}, {y!r}, {extrapolate!r})"
        case If(cond, then):
            test, yes = (
                _paren(text) if isinstance(child, If) else text
                for child, text in zip((cond, then), below, strict=False)
            )
            return f"{yes} if {test} else {below[2]}"
    return _layout(e, below, "**")


_GREEK = frozenset(
    """
    alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi rho sigma tau upsilon
    phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega
    """.split()  # noqa: SIM905
)
_LATEX_MARK = {"<": "<", "<=": r"\le", ">": ">", ">=": r"\ge", "==": "=", "!=": r"\ne"}
_LATEX_CALL = {
    "asin": r"\arcsin",
    "acos": r"\arccos",
    "atan": r"\arctan",
    "log": r"\ln",
    "log10": r"\log_{10}",
    **{f: "\\" + f for f in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "min", "max")},
}
_AROUND = {
    "sqrt": (r"\sqrt{", "}"),
    "abs": (r"\left|", r"\right|"),
    "floor": (r"\left\lfloor ", r"\right\rfloor"),
    "ceil": (r"\left\lceil ", r"\right\rceil"),
}


_ESCAPE = {"\\": r"\backslash{}", "~": r"\sim{}", "^": r"\hat{}"} | {m: "\\" + m for m in "_&%$#{}"}


def _escaped(text: str) -> str:
    text = re.sub(r"[\\~^_&%$#{}]", lambda m: _ESCAPE[m[0]], text)
    return text.replace("->", r"\to ").replace(" ", r"\ ") if '"' not in text else text


def _latex_name(path: str) -> str:
    """Write ``ball.p`` as the symbol p with the index ball."""
    quoted = re.fullmatch(r'"([^"]*)"\.(.*)', path)
    owner, _, last = path.rpartition(".")
    if quoted:
        rest, _, last = quoted[2].rpartition(".")
        arrow = r" \to ".join(_escaped(part.strip()) for part in quoted[1].split("->"))
        owner_text = arrow + ("." + _escaped(rest) if rest else "")
    else:
        owner_text = _escaped(owner)
    stem, _, index = last.partition("_")
    if not stem or (len(stem) > 1 and stem not in _GREEK):
        stem, index = last, ""
    if stem in _GREEK:
        symbol = "\\" + stem
    else:
        symbol = _escaped(stem) if len(stem) == 1 else rf"\mathrm{{{_escaped(stem)}}}"
    below = [part for part in (_escaped(index), owner_text) if part]
    return symbol + (rf"_{{\mathrm{{{', '.join(below)}}}}}" if below else "")


def _latex_number(e: Number) -> str:
    text = r"\pi" if plain(e.value) == math.pi else _float(plain(e.value))
    if "e" in text:
        digits, power = text.split("e")
        text = (digits + r" \cdot " if digits not in ("1", "1.0") else "") + f"10^{{{int(power)}}}"
    if e.dimension is not None and str(e.dimension) != "1":
        unit = str(e.dimension).replace("*", r"\,")
        unit = re.sub(r"\^\(?(-?[0-9/]+)\)?", r"^{\1}", unit)
        text += rf"\,\mathrm{{{unit}}}"
    return text


def to_latex(e: Expr) -> str:
    r"""Write `e` in LaTeX's math mode; an a priori value carries a superscript minus.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(to_latex(parse("-k*pre(ball.p)/m <= sqrt(omega_0)")))
    \frac{-k \, p_{\mathrm{ball}}^{-}}{m} \le \sqrt{\omega_{\mathrm{0}}}
    """
    return fold(e, _latex)


def _latex(e: Expr, prior: bool, below: list[str]) -> str:
    def at(k: int, level: int) -> str:
        # A fraction carries its own brackets.
        child = kids[k]
        bare = isinstance(child, Binary) and child.op == "/" and level <= _PRODUCT + 1
        return below[k] if bare or _level(child) >= level else _fenced(below[k])

    kids = children(e)
    match e:
        case Number():
            return _latex_number(e)
        case Bool(value):
            return r"\mathrm{true}" if value else r"\mathrm{false}"
        case Name(path):
            return _latex_name(path)
        case String(text):
            return rf"\text{{{_escaped(text)}}}"
        case Pre(arg):
            return (below[0] if isinstance(arg, Name) else _fenced(below[0])) + "^{-}"
        case Neg():
            # A product needs no brackets after a minus, another minus does.
            return "-" + (_fenced(below[0]) if below[0].startswith("-") else at(0, _PRODUCT))
        case Not():
            return r"\lnot " + at(0, _ATOM)
        case Compare(op):
            return f"{at(0, _SUM)} {_LATEX_MARK[op]} {at(1, _SUM)}"
        case And():
            return r" \land ".join([at(k, _NOT) for k in range(len(kids))])
        case Or():
            return r" \lor ".join([at(k, _AND) for k in range(len(kids))])
        case Binary("/"):
            return rf"\frac{{{below[0]}}}{{{below[1]}}}"
        case Binary("^", left):
            plain = re.fullmatch(r"[0-9.]+|\\pi", below[0]) or isinstance(left, Name)
            return f"{below[0] if plain else _fenced(below[0])}^{{{below[1]}}}"
        case Binary("*"):
            second = at(1, _PRODUCT + 1)
            second = _fenced(second) if second.startswith("-") else second
            return at(0, _PRODUCT) + (r" \cdot " if second[0].isdigit() else r" \, ") + second
        case Binary(op):
            second = at(1, _SUM + 1)
            return f"{at(0, _SUM)} {op} {_fenced(second) if second.startswith('-') else second}"
        case If():
            yes, no = rf"{below[1]} & \text{{if }} {below[0]}", below[2]
            return rf"\begin{{cases}} {yes} \\ {no} & \text{{otherwise}} \end{{cases}}"
        case Call(function):
            inner = ", ".join(below)
            if function in _AROUND:
                return inner.join(_AROUND[function])
            return _LATEX_CALL.get(function, rf"\operatorname{{{function}}}") + _fenced(inner)
        case Table():
            return r"\operatorname{table}" + ("'" if e.slope else "") + _fenced(below[0])
    raise TypeError(type(e).__name__)


def _fenced(text: str) -> str:
    return rf"\left({text}\right)"
