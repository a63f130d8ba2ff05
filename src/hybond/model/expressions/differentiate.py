"""Derivatives, and the simplification that keeps them readable."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from hybond.model.expressions.algebra import FOLDED
from hybond.model.expressions.compile import compile_expression
from hybond.model.expressions.slots import is_slotted, plain, slot_of, slotted, tree_of
from hybond.model.expressions.stable import beside_one
from hybond.model.expressions.tree import (
    LEVELS,
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
    Table,
    children,
    fold,
    rebuilt,
    transform,
    with_children,
)

ZERO = Number(0.0)
ONE = Number(1.0)
TWO = Number(2.0)


def simplify(e: Expr) -> Expr:
    """Fold constants and drop neutral terms.

    The value stays the same to the last bit, with one exception: a product with a literal 0, and
    0 divided by anything, become 0 even where the other factor may be infinite or nan. Numbers
    with a unit are not folded, so that the dimension of the whole stays what it was.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(simplify(parse("0*x + 1*(y + 2*3)^1")))
    y + 6
    """
    return _simplified(e, LEVELS)


def _simplified(e: Expr, levels: int) -> Expr:
    """Simplify a tree by recursion; what is `levels` deep in it without.

    Where it has been before there is nothing to do: a sum is made of sums that it has made.
    """
    kind = type(e)
    if kind is Name or kind is Number or hasattr(e, "_simple"):
        return e
    below = children(e)
    if not below:
        return e
    if levels == 0:
        return transform(e, _simpler)
    new = [_simplified(child, levels - 1) for child in below]
    found = _simpler(rebuilt(e, new))
    object.__setattr__(found, "_simple", True)
    return found


def differentiate(e: Expr, name: str) -> Expr:
    """Return the simplified derivative of `e` with respect to one name.

    A priori values, comparisons and texts count as constants, and so do `floor`, `ceil` and
    `sign`; jumps have no derivative. `min`, `max` and `if` differentiate the branch taken,
    ``abs(u)`` gives ``sign(u)*u'``, a table the slope of its segment, and ``mod(a, b)`` gives
    ``a' - floor(a/b)*b'``, its slope between two jumps.

    Parameters
    ----------
    name : str
        A path, as in `Name`.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> print(differentiate(parse("k*x^3 + sin(w*x) + pre(x)"), "x"))
    k*(3*x^2) + cos(w*x)*w
    >>> print(differentiate(parse("max(x, 2*y)"), "x"))
    if x >= 2*y then 1 else 0
    """

    def derive(node: Expr, prior: bool, below: list[Expr]) -> Expr:
        return _derivative(node, below, name)

    return fold(simplify(e), derive)


def _plain(e: Expr, value: float) -> bool:
    return isinstance(e, Number) and e.dimension is None and e.value == value


def _neutral(e: Expr, value: float) -> bool:
    """Whether a term is a number that changes nothing; one that may be changed is kept."""
    return isinstance(e, Number) and not is_slotted(e) and _plain(e, value)


def _both(a: Expr, b: Expr) -> bool:
    """Whether two operands are numbers that give a slotted one: zero is no matter then."""
    if not (isinstance(a, Number) and isinstance(b, Number)):
        return False
    literals = [e.value for e in (a, b) if not is_slotted(e)]
    return len(literals) < 2 and not any(abs(x) in (0.0, 1.0) for x in literals)


def _folded(e: Expr) -> Expr:
    """Return the value of a node whose subexpressions are all literals, else the node."""
    # In a table the value outside is nan, and a literal nan has no text.
    below = children(e)
    for child in below:
        if not (isinstance(child, Bool) or (isinstance(child, Number) and child.dimension is None)):
            return e
    points = (*e.x, *e.y) if isinstance(e, Table) else ()
    if any(map(is_slotted, below)) and not any(map(is_slotted, points)):
        return _followed(e, below)
    value = compile_expression(e, {}, FOLDED, pre_offset=0)(())
    if isinstance(value, bool):
        return Bool(value)
    # of a table with points that are slotted, the value is
    value = value if is_slotted(value) else float(value)
    return Number(value) if math.isfinite(plain(value)) else e


def _followed(e: Expr, below: tuple[Expr, ...]) -> Expr:
    """Return the value of a node of numbers, some of them slotted, as one that is slotted."""
    values = [b.value for b in below if isinstance(b, Number | Bool)]
    slots = next(slot.slots for slot in map(slot_of, values) if slot is not None)
    if isinstance(e, Binary) and e.op == "/" and not values[1]:
        return e
    numbers = (b if isinstance(b, Bool) else Number(plain(v)) for b, v in zip(below, values))
    value = compile_expression(with_children(e, tuple(numbers)), {}, FOLDED, pre_offset=0)(())
    trees = (b if isinstance(b, Bool) else tree_of(v) for b, v in zip(below, values))
    tree = with_children(e, tuple(trees))
    if isinstance(value, bool):
        slots.note(tree, holds=value)
        return Bool(value)
    return Number(slotted(value, tree, slots)) if math.isfinite(value) else e


def _simpler(e: Expr) -> Expr:
    """Simplify one node whose subexpressions are simple."""
    match e:
        case Binary(op, left, right):
            return _OPERATIONS[op](left, right, e)
        case Compare() | Call() | Table() | Not():
            return _folded(e)
        case Pre(Number() | Bool() as arg):
            return arg
        case Neg(Number(value, dimension)):
            return Number(-value, dimension)
        case Neg(Neg(arg)):
            return arg
        case If(Bool(value), then, orelse):
            return then if value else orelse
        case If(_, Number() | Name() as then, orelse) if then == orelse:
            return then
        case And(args) | Or(args):
            return _logic(e, args)
    return e


def _logic(e: Expr, args: tuple[Expr, ...]) -> Expr:
    neutral = Bool(isinstance(e, And))
    kept = tuple(a for a in args if a != neutral)
    if any(isinstance(a, Bool) for a in kept):
        return Bool(not neutral.value)
    if not kept:
        return neutral
    # A name may hold 2.0, which is true but not `true`: alone it would change the value.
    if len(kept) == 1:
        return kept[0] if isinstance(kept[0], Compare | And | Or | Not) else e
    return type(e)(kept) if isinstance(e, And | Or) else e


def _add(a: Expr, b: Expr, whole: Expr | None = None) -> Expr:
    """Return the simplified sum; `whole` is the sum as it stands, if it does."""
    if _neutral(a, 0.0):
        return b
    if _neutral(b, 0.0):
        return a
    if isinstance(b, Neg):
        return _sub(a, b.arg)
    return _folded(whole or Binary("+", a, b))


def _sub(a: Expr, b: Expr, whole: Expr | None = None) -> Expr:
    if _neutral(b, 0.0):
        return a
    if _neutral(a, 0.0):
        return _neg(b)
    if isinstance(b, Neg):
        return _add(a, b.arg)
    return _folded(whole or Binary("-", a, b))


def _neg(a: Expr) -> Expr:
    if isinstance(a, Number):
        return Number(-a.value, a.dimension)
    return a.arg if isinstance(a, Neg) else Neg(a)


def _mul(a: Expr, b: Expr, whole: Expr | None = None) -> Expr:
    if not (isinstance(a, Number) or isinstance(b, Number)) or _both(a, b):
        return _folded(whole or Binary("*", a, b))
    if _neutral(a, 0.0) or _neutral(b, 0.0):
        return ZERO
    if _plain(a, 0.0) or _plain(b, 0.0):
        return ZERO
    if _neutral(a, 1.0):
        return b
    if _neutral(b, 1.0):
        return a
    if _neutral(a, -1.0):
        return _neg(b)
    if _neutral(b, -1.0):
        return _neg(a)
    return _folded(whole or Binary("*", a, b))


def _div(a: Expr, b: Expr, whole: Expr | None = None) -> Expr:
    if _both(a, b):
        return _folded(whole or Binary("/", a, b))
    if _neutral(b, 1.0):
        return a
    if _plain(a, 0.0) and not _plain(b, 0.0):
        return ZERO
    return _folded(whole or Binary("/", a, b))


def _pow(a: Expr, b: Expr, whole: Expr | None = None) -> Expr:
    if _both(a, b):
        return _folded(whole or Binary("^", a, b))
    if _neutral(b, 1.0):
        return a
    if _plain(b, 0.0):
        return ONE
    return _folded(whole or Binary("^", a, b))


_OPERATIONS: Mapping[str, Callable[[Expr, Expr, Expr | None], Expr]] = {
    "+": _add,
    "-": _sub,
    "*": _mul,
    "/": _div,
    "^": _pow,
}


def _derivative(e: Expr, d: list[Expr], x: str) -> Expr:
    """Return the derivative of a node, given those of its subexpressions."""
    match e:
        case Name(path):
            return ONE if path == x else ZERO
        case Neg():
            return _neg(d[0])
        case Binary(op, left, right):
            return _of_binary(op, left, right, d[0], d[1])
        case If(cond):
            return _if(cond, d[1], d[2])
        case Table(arg) if not e.slope:
            return _mul(Table(arg, e.x, e.y, e.extrapolate, slope=True), d[0])
        case Call(function, args):
            return _of_call(function, args, d)
    return ZERO


def _if(cond: Expr, then: Expr, orelse: Expr) -> Expr:
    return _simpler(If(cond, then, orelse))


def _of_binary(op: str, a: Expr, b: Expr, da: Expr, db: Expr) -> Expr:
    if op == "+":
        return _add(da, db)
    if op == "-":
        return _sub(da, db)
    if op == "*":
        return _add(_mul(da, b), _mul(a, db))
    if op == "/":
        if db == ZERO:
            return _div(da, b)
        steep = _of_sigmoid(a, b, da, db)
        if steep is not None:
            return steep
        return _sub(_div(da, b), _div(_mul(a, db), _pow(b, TWO)))
    by_base = _mul(_mul(b, _pow(a, _sub(b, ONE))), da)
    if db == ZERO:
        return by_base
    return _add(by_base, _mul(_mul(_pow(a, b), _folded(Call("log", (a,)))), db))


def _of_sigmoid(a: Expr, b: Expr, da: Expr, db: Expr) -> Expr | None:
    """Return the derivative of ``a/(1 + exp(u))``, in which no square is too large; None of others.

    ``a`` is constant or ``exp(u)``, and ``db`` is ``exp(u)*u'``.
    """
    u = beside_one(b)
    du = None if u is None else _inner("exp", db)
    if u is None or du is None:
        return None
    below = _add(TWO, _mul(TWO, _folded(Call("cosh", (u,)))))
    if a == Call("exp", (u,)):
        return _div(du, below)
    return _neg(_div(_mul(a, du), below)) if da == ZERO else None


def _inner(function: str, d: Expr) -> Expr | None:
    """Return u' of a derivative ``function(u)*u'``, None of what does not have that form."""
    match d:
        case Binary("*", Call() as outer, du) if outer.function == function:
            return du
        case Call() if d.function == function:
            return ONE
        case Neg(Call() as outer) if outer.function == function:
            return Number(-1.0)
    return None


def _of_log(u: Expr, du: Expr) -> Expr | None:
    """Return the derivative of the logarithm of ``1 + exp(w)`` or ``cosh(w)``; None of others."""
    w = beside_one(u)
    steep = "exp"
    if w is None:
        if not (isinstance(u, Call) and u.function == "cosh"):
            return None
        w = u.args[0]
        steep = "sinh"
    dw = _inner(steep, du)
    if dw is None:
        return None
    if steep == "sinh":
        return _mul(_folded(Call("tanh", (w,))), dw)
    return _div(dw, _add(ONE, _folded(Call("exp", (_neg(w),)))))


def _of_call(function: str, args: tuple[Expr, ...], d: list[Expr]) -> Expr:
    u, du = args[0], d[0]
    own = _of_log(u, du) if function == "log" else None
    if own is not None:
        return own
    if len(args) == 1:
        return ZERO if du == ZERO else _mul(_outer(function, u), du)
    w, dw = args[1], d[1]
    match function:
        case "atan2":  # atan2(u, w) is the angle of the point (w, u)
            above = _sub(_mul(w, du), _mul(u, dw))
            return _div(above, _add(_pow(u, TWO), _pow(w, TWO)))
        case "hypot":
            return _div(_add(_mul(u, du), _mul(w, dw)), Call("hypot", (u, w)))
        case "mod":
            return _sub(du, _mul(Call("floor", (_div(u, w),)), dw))
    # min and max: the first argument that equals the result, so that ties are decided once.
    op = "<=" if function == "min" else ">="
    if len(args) == 2:
        return _if(Compare(op, u, w), du, dw)
    rest = _of_call(function, args[1:], d[1:])
    return _if(Compare(op, u, Call(function, args[1:])), du, rest)


def _outer(function: str, u: Expr) -> Expr:
    """Return the derivative of a function of one argument at `u`."""
    square = _pow(u, TWO)

    def call(name: str) -> Expr:
        return _folded(Call(name, (u,)))

    match function:
        case "sin":
            return call("cos")
        case "cos":
            return _neg(call("sin"))
        case "tan":
            return _add(ONE, _pow(call("tan"), TWO))
        case "asin":
            return _div(ONE, Call("sqrt", (_sub(ONE, square),)))
        case "acos":
            return _div(Number(-1.0), Call("sqrt", (_sub(ONE, square),)))
        case "atan":
            return _div(ONE, _add(ONE, square))
        case "sinh":
            return call("cosh")
        case "cosh":
            return call("sinh")
        case "tanh":
            return _sub(ONE, _pow(call("tanh"), TWO))
        case "exp":
            return call("exp")
        case "log":
            return _div(ONE, u)
        case "log10":
            return _div(ONE, _mul(u, Number(math.log(10.0))))
        case "sqrt":
            return _div(ONE, _mul(TWO, call("sqrt")))
        case "softplus":
            return _div(ONE, _add(ONE, Call("exp", (_neg(u),))))
        case "log_cosh":
            return call("tanh")
        case "expm1":
            return call("exp")
        case "log1p":
            return _div(ONE, _add(ONE, u))
        case "abs":
            return call("sign")
    return ZERO
