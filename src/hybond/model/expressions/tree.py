"""The tree of an expression: small frozen nodes, and walks over them."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

from hybond.errors import ExpressionError
from hybond.records import dataclass
from hybond.units import Dimension

T = TypeVar("T")


class Expr:
    """Any node. Nodes are frozen, hashable and compared by structure.

    What has been found out of a node is noted there, as it never changes; it is no part of it.
    """

    __slots__ = ("_simple",)
    _simple: bool
    """There once `simplify` has had nothing to do, or has made the node."""

    def __str__(self) -> str:
        from hybond.model.expressions.text import to_text

        return to_text(self)


# `repr` stays that of a dataclass, so that a failing test shows the structure; `str` is the text.
@dataclass(frozen=True, slots=True)
class Number(Expr):
    """A number in SI units; `dimension` is None where the text gave no unit."""

    value: float
    dimension: Dimension | None = None


@dataclass(frozen=True, slots=True)
class Bool(Expr):
    """``true`` or ``false``."""

    value: bool


@dataclass(frozen=True, slots=True)
class Name(Expr):
    """A signal or parameter: ``ball.p``, ``lever.1.e``, ``"contact->v".e`` (quotes kept)."""

    path: str


@dataclass(frozen=True, slots=True)
class String(Expr):
    """A text to compare with, as in ``machine.state == "open"``."""

    text: str


@dataclass(frozen=True, slots=True)
class Pre(Expr):
    """The a priori value of `arg`."""

    arg: Expr


@dataclass(frozen=True, slots=True)
class Neg(Expr):
    """``-arg``."""

    arg: Expr


@dataclass(frozen=True, slots=True)
class Not(Expr):
    """``not arg``."""

    arg: Expr


@dataclass(frozen=True, slots=True)
class Binary(Expr):
    """Arithmetic; `op` is one of ``+ - * / ^``."""

    op: str
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class Compare(Expr):
    """A comparison; `op` is one of ``< <= > >= == !=``."""

    op: str
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class And(Expr):
    """``a and b and ...``; two or more arguments."""

    args: tuple[Expr, ...]


@dataclass(frozen=True, slots=True)
class Or(Expr):
    """``a or b or ...``; two or more arguments."""

    args: tuple[Expr, ...]


@dataclass(frozen=True, slots=True)
class If(Expr):
    """``if cond then then else orelse``."""

    cond: Expr
    then: Expr
    orelse: Expr


@dataclass(frozen=True, slots=True)
class Call(Expr):
    """A call of one of `FUNCTIONS`."""

    function: str
    args: tuple[Expr, ...]


@dataclass(frozen=True, slots=True)
class Table(Expr):
    """Piecewise linear interpolation of the points (`x`, `y`) at `arg`.

    Raises
    ------
    ExpressionError
        HB-E108 for points that are not a table.
    """

    arg: Expr
    """Where to read the table."""
    x: tuple[float, ...]
    y: tuple[float, ...]
    """`x` and `y`: the points; `x` increases strictly."""
    extrapolate: str = "error"
    """Outside the points: nan, or the end segments continued."""
    slope: bool = False
    """Read the slope of the segment instead of the value (at a point, of the segment to its right).
    The derivative of a table is such a table."""

    def __post_init__(self) -> None:
        hint = "give at least two points with strictly increasing x"
        if self.extrapolate not in ("error", "linear"):
            why = f"extrapolate is {self.extrapolate!r}"
            raise ExpressionError(
                why, code="HB-E108", where="table", hint="choose 'error' or 'linear'"
            )
        if len(self.x) != len(self.y) or len(self.x) < 2:
            why = f"a table with {len(self.x)} x values and {len(self.y)} y values"
            raise ExpressionError(why, code="HB-E108", where="table", hint=hint)
        for a, b in zip(self.x, self.x[1:], strict=False):
            if not a < b:
                why = f"the x values {a!r} and {b!r} of a table do not increase"
                raise ExpressionError(why, code="HB-E108", where="table", hint=hint)


MOST_ARGUMENTS = 64
"""Arguments of ``min`` and ``max``."""
GATHER = ("sum", "any", "all")
"""What takes members of an array, ``sum(cell[1..10].q)``, and is written out before it has a
meaning."""
FUNCTIONS: Mapping[str, tuple[int, int]] = {
    **dict.fromkeys(("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"), (1, 1)),
    **dict.fromkeys(("exp", "log", "log10", "sqrt", "abs", "sign", "floor", "ceil"), (1, 1)),
    **dict.fromkeys(("atan2", "hypot", "mod"), (2, 2)),
    **dict.fromkeys(("min", "max"), (2, MOST_ARGUMENTS)),
}
"""The functions and how many arguments each takes, least and most."""


_BELOW: dict[type[Expr], Callable[[Any], tuple[Expr, ...]]] = {
    **dict.fromkeys((Pre, Neg, Not, Table), lambda e: (e.arg,)),
    **dict.fromkeys((Binary, Compare), lambda e: (e.left, e.right)),
    **dict.fromkeys((And, Or, Call), lambda e: e.args),
    If: lambda e: (e.cond, e.then, e.orelse),
}
"""The subexpressions of each kind of node that has some."""
LEVELS = 64
"""Down to where walks are by recursion, which is quick: few trees are deeper, and Python has room
for 1000 calls, those of walks within walks too."""


def children(e: Expr) -> tuple[Expr, ...]:
    """Return the direct subexpressions of `e`, in reading order."""
    below = _BELOW.get(type(e))
    return () if below is None else below(e)


def with_children(e: Expr, new: tuple[Expr, ...]) -> Expr:
    """Return `e` with its subexpressions replaced; the same object if none changed."""
    if len(new) != len(children(e)):
        raise ValueError(f"{len(new)} subexpressions for {e!r}")
    return rebuilt(e, new)


def rebuilt(e: Expr, below: Sequence[Expr]) -> Expr:
    """Return `e` with as many subexpressions as it has; the same object if all are its own."""
    if all(map(operator.is_, children(e), below)):
        return e
    new = tuple(below)
    match e:
        case Pre() | Neg() | Not():
            return type(e)(new[0])
        case Table():
            return Table(new[0], e.x, e.y, e.extrapolate, e.slope)
        case Binary() | Compare():
            return type(e)(e.op, new[0], new[1])
        case And() | Or():
            return type(e)(new)
        case Call():
            return Call(e.function, new)
        case If():
            return If(*new)
    return e


def walk(e: Expr) -> Iterator[tuple[Expr, bool]]:
    """Yield every node in reading order, and whether it stands inside `Pre`."""
    stack = [(e, False)]
    while stack:
        node, prior = stack.pop()
        yield node, prior
        below = children(node)
        if below:
            inside = prior or type(node) is Pre
            stack.extend([(child, inside) for child in reversed(below)])


def names(e: Expr) -> set[str]:
    """Return the paths of all names, those inside `Pre` too."""
    found: set[str] = set()
    stack = [e]
    while stack:
        node = stack.pop()
        if type(node) is Name:
            found.add(node.path)
            continue
        below_of = _BELOW.get(type(node))
        if below_of is not None:
            stack += below_of(node)
    return found


def posterior_names(e: Expr) -> set[str]:
    """Return the paths of the names outside `Pre`."""
    return {node.path for node, prior in walk(e) if isinstance(node, Name) and not prior}


def prior_names(e: Expr) -> set[str]:
    """Return the paths of the names inside `Pre`."""
    return {node.path for node, prior in walk(e) if isinstance(node, Name) and prior}


def uses_pre(e: Expr) -> bool:
    """Say whether `e` reads an a priori value."""
    return any_kind(e, Pre)


def any_kind(e: Expr, *kinds: type[Expr]) -> bool:
    """Say whether a node of some kinds stands in `e`."""
    stack = [e]
    while stack:
        node = stack.pop()
        if type(node) in kinds:
            return True
        below_of = _BELOW.get(type(node))
        if below_of is not None:
            stack += below_of(node)
    return False


def calls(e: Expr) -> set[str]:
    """Return the functions that `e` calls."""
    found: set[str] = set()
    stack = [e]
    while stack:
        node = stack.pop()
        if type(node) is Call:
            found.add(node.function)
        below_of = _BELOW.get(type(node))
        if below_of is not None:
            stack += below_of(node)
    return found


def comparisons(e: Expr) -> list[Compare]:
    """Return the comparisons of `e` in reading order."""
    return [node for node, _ in walk(e) if isinstance(node, Compare)]


def fold(e: Expr, fn: Callable[[Expr, bool, list[T]], T]) -> T:
    """Return ``fn(node, prior, results)`` of the root, called bottom-up.

    `results` are those of the node's subexpressions, `prior` says whether the node stands inside
    `Pre`. The derivative of a long chain is deeper than Python's stack.
    """
    return _folded(e, fn, False, LEVELS)


def _folded(e: Expr, fn: Callable[[Expr, bool, list[T]], T], prior: bool, levels: int) -> T:
    """Fold a tree by recursion, which is quick; what is `levels` deep in it without."""
    kind = type(e)
    if kind is Name or kind is Number:
        return fn(e, prior, [])
    below_of = _BELOW.get(kind)
    if below_of is None:
        return fn(e, prior, [])
    if levels == 0:
        return _folded_deep(e, fn, prior)
    levels -= 1
    if kind is Binary:
        left, right = below_of(e)
        return fn(e, prior, [_folded(left, fn, prior, levels), _folded(right, fn, prior, levels)])
    inside = prior or kind is Pre
    return fn(e, prior, [_folded(child, fn, inside, levels) for child in below_of(e)])


def _folded_deep(e: Expr, fn: Callable[[Expr, bool, list[T]], T], prior: bool) -> T:
    """Fold a tree of any depth."""
    done: list[T] = []
    # a number of subexpressions that is below zero: they are not done yet
    stack = [(e, prior, -1)]
    while stack:
        node, prior, count = stack.pop()
        if count > 0:
            results = done[-count:]
            del done[-count:]
            done.append(fn(node, prior, results))
            continue
        below = children(node)
        if not below:
            done.append(fn(node, prior, []))
            continue
        stack.append((node, prior, len(below)))
        inside = prior or type(node) is Pre
        stack.extend([(child, inside, -1) for child in reversed(below)])
    return done[0]


def depth(e: Expr) -> int:
    """Return the number of levels of the tree; a leaf is 1."""

    def deeper(node: Expr, prior: bool, below: list[int]) -> int:
        return 1 + max(below, default=0)

    return fold(e, deeper)


def extent(e: Expr) -> tuple[int, int]:
    """Return the number of levels and of nodes of a tree, also of one too large to walk.

    What stands in it several times as one object is looked at once.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> e = parse("a + 1")
    >>> for _ in range(100):
    ...     e = Binary("*", e, e)
    >>> levels, nodes = extent(e)
    >>> levels, nodes == 2**102 - 1
    (102, True)
    """
    if not children(e):
        return 1, 1
    found: dict[int, tuple[int, int]] = {}
    stack = [e]
    while stack:
        node = stack[-1]
        below = children(node)
        waiting = [child for child in below if id(child) not in found]
        if waiting:
            stack.extend(waiting)
            continue
        stack.pop()
        each = [found[id(child)] for child in below]
        levels = 1 + max((k for k, _ in each), default=0)
        found[id(node)] = (levels, 1 + sum(k for _, k in each))
    return found[id(e)]


def transform(e: Expr, fn: Callable[[Expr], Expr]) -> Expr:
    """Rebuild `e` bottom-up: `fn` gets each node with its subexpressions already rebuilt.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> str(transform(parse("a + 2*a"), lambda n: Name("b") if n == Name("a") else n))
    'b + 2*b'
    """
    return _transformed(e, fn, LEVELS)


def _transformed(e: Expr, fn: Callable[[Expr], Expr], levels: int) -> Expr:
    """Rebuild a tree by recursion, which is quick; what is `levels` deep in it without."""
    kind = type(e)
    if kind is Name or kind is Number:
        return fn(e)
    below_of = _BELOW.get(kind)
    if below_of is None:
        return fn(e)
    if levels == 0:
        return _folded_deep(e, lambda node, _, new: fn(rebuilt(node, new) if new else node), False)
    levels -= 1
    below = below_of(e)
    if isinstance(e, Binary):
        left, right = below
        new = _transformed(left, fn, levels), _transformed(right, fn, levels)
        if new[0] is left and new[1] is right:
            return fn(e)
        return fn(Binary(e.op, *new))
    return fn(rebuilt(e, [_transformed(child, fn, levels) for child in below]))


def substitute(e: Expr, mapping: Mapping[str, Expr]) -> Expr:
    """Replace names by expressions, all at once, inside `Pre` too.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> str(substitute(parse("a*b"), {"a": parse("b + 1"), "b": parse("a")}))
    '(b + 1)*a'
    """
    if not mapping:
        return e
    return transform(e, lambda n: mapping.get(n.path, n) if isinstance(n, Name) else n)
