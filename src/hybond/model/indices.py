"""Names of members, ``cell[n].out``, and ranges of them, ``cell[1..n].out``, from text to names.

Ranges in one text run together: each takes its next member, and all have one length. In an
expression ``sum``, ``any``, ``all``, ``min`` and ``max`` gather what a range stands for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

from hybond.errors import ExpressionError, ModelError
from hybond.model.expressions import (
    And,
    Binary,
    Bool,
    Call,
    Expr,
    Name,
    Number,
    Or,
    names,
    substitute,
    transform,
)
from hybond.model.expressions.slots import settled
from hybond.model.expressions.tree import GATHER, MOST_ARGUMENTS, extent
from hybond.model.scope import Scope, constant
from hybond.names import did_you_mean, join, steps
from hybond.units import DIMENSIONLESS

MEMBERS = 10_000
"""Members of one array, and bonds of one text."""
MAX_NODES = 20_000
"""Values and operators of what gathers members, written out."""
COUNTED = "how many members an array has is part of what the model is made of"
INSIDE = re.compile(r"(?<=\w)\[([^\[\]]*)\]")
"""What stands in the brackets behind a name."""


def whole(text: str, scope: Scope, where: str) -> int:
    """Return an index: a whole number, not negative, made of numbers and parameters.

    Raises
    ------
    ModelError
        HB-M152, and HB-M107 for what is no parameter.
    """
    if text.isdecimal() and text.isascii() and len(text) < 10:
        return int(text)
    number = constant(text.strip(), scope.parameters, where)
    value = settled(number.value, COUNTED)
    if number.dimension not in (None, DIMENSIONLESS) or value != int(value) or value < 0:
        shown = f"{value:g}" + (f" {number.dimension}" if number.dimension else "")
        raise ModelError(
            f"the index {text!r} is {shown}: it must be a whole number, 0 or more",
            code="HB-M152",
            where=where,
            hint="count with whole numbers: cell[1..10], or n = 10 and cell[1..n]",
        )
    return int(value)


def span(inside: str, scope: Scope, where: str) -> range:
    """Return the indices of ``1..n``, or of one index.

    Raises
    ------
    ModelError
        HB-M152 for bounds that are no range, or one with too many members.
    """
    low, dots, high = inside.partition("..")
    first = whole(low, scope, where)
    last = whole(high, scope, where) if dots else first
    if last < first - 1:
        raise ModelError(
            f"the range [{inside}] goes backwards, from {first} to {last}",
            code="HB-M152",
            where=where,
            hint=f"write [{last}..{first}]; [1..0] has no members",
        )
    if last - first >= MEMBERS:
        raise ModelError(
            f"the range [{inside}] has {last - first + 1} members, the limit is {MEMBERS}",
            code="HB-M152",
            where=where,
            hint="let an array of submodels hold arrays, or take fewer",
        )
    return range(first, last + 1)


def one(text: str, scope: Scope, where: str) -> str:
    """Return a name or bond with its indices as numbers.

    Raises
    ------
    ModelError
        HB-M153 if it has a range.

    Examples
    --------
    >>> import hybond as hb
    >>> one("cell[n].out", Scope("", hb.Model(), {"n": Number(3.0)}), "")
    'cell[3].out'
    """
    if "[" not in text:
        return text
    found = spread(text, scope, where)
    if len(found) != 1 or ".." in text:
        raise ModelError(
            f"{text!r} names several members, where one is needed",
            code="HB-M153",
            where=where,
            hint="write one index, or gather them: sum(cell[1..10].q), max, min, any, all",
        )
    return found[0]


def of_an_array(text: str, scope: Scope, where: str, arrays: Mapping[str, Iterable[int]]) -> str:
    """Return a name with its indices as numbers; HB-M154 where there is no such array."""
    base = join(scope.prefix, text.partition("[")[0])
    if not text.startswith('"') and base not in arrays:
        why, hint = no_member(f"{base}[0]", arrays) or ("", "")
        raise ModelError(
            f"{text!r} is not known here: {why}",
            code="HB-M154",
            where=where,
            hint=f"{hint}; a unit stands after a number: 5 [m/s]",
        )
    return one(text, scope, where)


def spread(text: str, scope: Scope, where: str) -> list[str]:
    """Return the names that a name with ranges stands for.

    Examples
    --------
    >>> import hybond as hb
    >>> spread("cell[1..2].out", Scope("", hb.Model()), "")
    ['cell[1].out', 'cell[2].out']
    """
    return [names[0] for names in together([text], scope, where)]


def together(ends: Sequence[str], scope: Scope, where: str) -> list[list[str]]:
    """Return names of which several may have a range, range by range: all of one length.

    Raises
    ------
    ModelError
        HB-M153 for ranges of unequal length, HB-M152 for bounds that are no range.

    Examples
    --------
    >>> import hybond as hb
    >>> together(["a[1..2]", "node", "a[2..3]"], Scope("", hb.Model()), "")
    [['a[1]', 'node', 'a[2]'], ['a[2]', 'node', 'a[3]']]
    """
    if not any("[" in end for end in ends):
        return [list(ends)]
    found: dict[str, range] = {}
    for inside in (i for end in ends for i in INSIDE.findall(end)):
        found[inside] = span(inside, scope, where)
    ranges = {inside: r for inside, r in found.items() if ".." in inside}
    lengths = {len(r) for r in ranges.values()}
    if len(lengths) > 1:
        counts = ", ".join(f"[{inside}] has {len(r)}" for inside, r in ranges.items())
        raise ModelError(
            f"ranges that run together have unequal lengths: {counts}",
            code="HB-M153",
            where=where,
            hint='write "cell[1..n-1].out -> cell[2..n].in": as many on each side',
        )

    def at(k: int) -> Callable[[re.Match[str]], str]:
        return lambda m: f"[{found[m[1]][k if '..' in m[1] else 0]}]"

    count = lengths.pop() if lengths else 1
    return [[INSIDE.sub(at(k), end) for end in ends] for k in range(count)]


def gathered(e: Call, scope: Scope, where: str) -> Expr:
    """Return what ``sum``, ``any``, ``all``, ``min`` or ``max`` of members is, written out.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.model.expressions import parse
    >>> str(gathered(parse("sum(c[1..3].q*k)"), Scope("", hb.Model()), ""))
    'c[1].q*k + (c[2].q*k + c[3].q*k)'
    """
    terms = [term for arg in e.args for term in _each(arg, scope, where)]
    if e.function in ("any", "all"):
        joined = Or if e.function == "any" else And
        return joined(tuple(terms)) if len(terms) > 1 else [*terms, Bool(e.function == "all")][0]
    if e.function == "sum":
        return _balanced(terms, lambda a, b: Binary("+", a, b)) if terms else Number(0.0)
    if not terms:
        raise ModelError(
            f"{e.function} of no members has no value",
            code="HB-M153",
            where=where,
            hint="take an array that has members",
        )
    while len(terms) > MOST_ARGUMENTS:
        rows = [terms[k : k + MOST_ARGUMENTS] for k in range(0, len(terms), MOST_ARGUMENTS)]
        terms = [Call(e.function, tuple(row)) if len(row) > 1 else row[0] for row in rows]
    return Call(e.function, tuple(terms)) if len(terms) > 1 else terms[0]


def without_ranges(e: Expr, scope: Scope, where: str) -> Expr:
    """Return a tree with what gathers members written out, and all indices as numbers."""

    def plain(inner: Expr) -> Expr:
        if isinstance(inner, Call) and gathers(inner):
            return gathered(inner, scope, where)
        return inner

    whole_tree = transform(e, plain)
    several = [n for n in names(whole_tree) if "[" in n]
    return substitute(whole_tree, {n: Name(one(n, scope, where)) for n in several})


def gathers(e: Call) -> bool:
    """Whether a call is one of members: these are written out before anything else is done."""
    return e.function in GATHER or (
        e.function in ("min", "max") and any(".." in n for arg in e.args for n in names(arg))
    )


def _each(arg: Expr, scope: Scope, where: str) -> list[Expr]:
    arg = transform(
        arg, lambda e: gathered(e, scope, where) if isinstance(e, Call) and gathers(e) else e
    )
    several = sorted(n for n in names(arg) if ".." in n)
    if not several:
        return [arg]
    rows = together(several, scope, where)
    if len(rows) * extent(arg)[1] > MAX_NODES:
        raise ExpressionError(
            f"with all its members the expression has more than {MAX_NODES} values and operators",
            code="HB-E107",
            where=where,
            hint="gather fewer, or let signals of an array be gathered",
        )
    return [substitute(arg, {n: Name(own) for n, own in zip(several, row)}) for row in rows]


def _balanced(terms: Sequence[Expr], join_two: Callable[[Expr, Expr], Expr]) -> Expr:
    if len(terms) == 1:
        return terms[0]
    half = len(terms) // 2
    return join_two(_balanced(terms[:half], join_two), _balanced(terms[half:], join_two))


def no_member(path: str, arrays: Mapping[str, Iterable[int]]) -> tuple[str, str] | None:
    """Return why a path names no member of an array, and what to write; None if that is not it.

    Examples
    --------
    >>> no_member("cell[4].q", {"cell": [1, 2, 3]})
    ("the array 'cell' has the members 1 to 3, no 4", 'write cell[3], or make the array longer')
    >>> no_member("cell.q", {"cell": [1, 2, 3]})
    ("'cell' is an array", 'write which member: cell[1]')
    """
    parts = steps(path)
    for k, step in enumerate(parts):
        name, bracket, inside = step.partition("[")
        base = join(*parts[:k], name)
        known = sorted(arrays[base]) if base in arrays else []
        if base in arrays and not bracket:
            return f"{base!r} is an array", f"write which member: {base}[{min(known, default=1)}]"
        index = inside.rstrip("]")
        if bracket and base not in arrays:
            return f"{base!r} is no array", did_you_mean(base, arrays) or f"write {base}"
        if bracket and index.isdecimal() and int(index) not in known:
            if not known:
                return f"the array {base!r} has no members", "make it longer"
            near = min(known, key=lambda n: abs(n - int(index)))
            runs = known == list(range(known[0], known[-1] + 1))
            shown = f"{known[0]} to {known[-1]}" if runs else ", ".join(map(str, known[:8]))
            why = f"the array {base!r} has the members {shown}, no {index}"
            return why, f"write {base}[{near}], or make the array longer"
    return None
