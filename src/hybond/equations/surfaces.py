"""Switching surfaces: where a machine's two rules, forth and back, share one switching function.

A pair of states ``below`` and ``above`` has a surface ``g = 0`` if one comparison of the rule
``below -> above`` asks for ``g > 0`` and one of the rule ``above -> below`` for ``g < 0``, with
the same g and no hysteresis between them; other comparisons joined by ``and`` only allow it.
Where one rule is the negation of the other, ``a > 0 or b > 0`` and ``a <= 0 and b <= 0``, the
surface is that of the whole: ``max(a, b) = 0``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

from hybond.equations.given_by_sources import GivenBySources
from hybond.model.expressions import (
    And,
    Binary,
    Call,
    Compare,
    Expr,
    Name,
    Neg,
    Not,
    Number,
    Or,
    Pre,
    compile_expression,
    names,
    simplify,
    transform,
)
from hybond.model.expressions.slots import is_slotted, plain
from hybond.model.expressions.tree import fold, walk
from hybond.model.graph import FlatGraph, Rule
from hybond.records import dataclass

SCALES = (1.0, 1e-4, 1e-8, 1e-12)
"""Sizes of the values at which two switching functions are compared: a small band shows."""
SAME = 1e-9
"""Part by which factors of a term may differ and it is left open whether they are the same."""
_OPPOSITE = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}


@dataclass(frozen=True, slots=True)
class Surface:
    """The surface ``g = 0`` between two states of a machine."""

    machine: int
    below: int
    above: int
    """`below` and `above`: the states in which the machine is for ``g < 0`` and ``g > 0``."""
    g: Expr
    """The switching function, in canonical names."""
    text: str
    """The surface as written: ``v.f = 0``."""
    up: Rule
    down: Rule
    """`up` and `down`: the rules ``below -> above`` and ``above -> below``."""
    up_rest: tuple[Expr, ...]
    down_rest: tuple[Expr, ...]
    """`up_rest` and `down_rest`: what else each of them asks for."""


def surfaces_of(graph: FlatGraph) -> tuple[Surface, ...]:
    """Return the switching surfaces of all machines with rules of their own.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("relay")
    >>> m.add(c=hb.C(1.0, q=1.0), u=hb.Sf('if r.state == "plus" then 1 else -1'), n=hb.Zero())
    >>> m.bond("u -> n -> c")
    >>> m.machine("r", states={"plus": [], "minus": []}, start="minus",
    ...           rules=["plus -> minus when c.q > 0", "minus -> plus when c.q < 0"])
    >>> [s.text for s in surfaces_of(m.flatten())]
    ['c.q = 0']
    """
    found: list[Surface] = []
    for machine in graph.machines:
        if machine.law is not None or machine.pieces:
            continue
        joining: dict[frozenset[int], list[Rule]] = {}
        for rule in machine.rules:
            joining.setdefault(frozenset((rule.source, rule.target)), []).append(rule)
        for up, *others in joining.values():
            # a third rule between two states: which of them decides is not for us to say
            if len(others) == 1 and (others[0].source, others[0].target) == (up.target, up.source):
                found += _between(machine.index, up, others[0])
    return tuple(_led_by_motion(graph, found))


def _led_by_motion(graph: FlatGraph, found: list[Surface]) -> list[Surface]:
    """Return surfaces without those of what sources alone decide: these are crossed, never held.

    But those that their own machine makes jump stay, so that this is told.
    """
    doubtful = [s for s in found if not any(n.startswith(("s:", "x:")) for n in names(s.g))]
    if not doubtful:
        return found
    given = GivenBySources(graph)
    left = []
    for s in found:
        reads = given.read_by(s.g)
        if reads is None or s.machine in _deciding(graph, given, reads):
            left.append(s)
    return left


def _deciding(graph: FlatGraph, given: GivenBySources, reads: Iterable[int]) -> set[int]:
    """Return machines that have a say at once: those read, those that their rules read, and on."""
    found: set[int] = set()
    todo = list(reads)
    while todo:
        k = todo.pop()
        if k not in found:
            found.add(k)
            for rule in graph.machines[k].rules:
                todo += given.machines_in(rule.guard)
    return found


@lru_cache(1024)
def _between(machine: int, up: Rule, down: Rule) -> tuple[Surface, ...]:
    """Return the surface of two rules, if they have one.

    What was found is kept: most rules are the same in runs with other parameters.
    """
    whole = _whole(machine, up, down)
    if whole is not None:
        return (whole,)
    forth, back = _parts(up.guard), _parts(down.guard)
    for one in forth:
        for other in back:
            if not (isinstance(one, Compare) and isinstance(other, Compare)):
                continue
            g, h = _positive(one), _positive(other)
            if g is None or h is None or not _steered(g) or not _opposite(g, h):
                continue
            text = _text(up, one, len(forth))
            up_rest = tuple(e for e in forth if e is not one)
            down_rest = tuple(e for e in back if e is not other)
            return (Surface(machine, up.source, up.target, g, text, up, down, up_rest, down_rest),)
    return ()


def _whole(machine: int, up: Rule, down: Rule) -> Surface | None:
    """Return the surface of two rules with ``or`` of which one is the negation of the other."""
    forth, back = _plain(up.guard), _plain(down.guard)
    g = _level(forth)
    if g is None or not isinstance(g, Call) or not _steered(g) or not _negated(forth, back):
        return None
    text = f"{_written(up, g)} = 0"
    return Surface(machine, up.source, up.target, g, text, up, down, (), ())


def _level(guard: Expr) -> Expr | None:
    """Return what is positive where a guard holds and negative where it does not."""
    match guard:
        case Compare():
            return _positive(guard)
        case And() | Or():
            levels = [_level(e) for e in guard.args]
            if any(e is None for e in levels):
                return None
            function = "min" if isinstance(guard, And) else "max"
            return Call(function, tuple(e for e in levels if e is not None))
        case _:
            return None


def _negated(one: Expr, other: Expr) -> bool:
    """Whether a guard is the negation of another, comparison by comparison."""
    if isinstance(one, Compare) and isinstance(other, Compare):
        g, h = _positive(one), _positive(other)
        return g is not None and h is not None and _opposite(g, h)
    if not isinstance(one, And | Or) or not isinstance(other, And | Or):
        return False
    if isinstance(one, And) == isinstance(other, And) or len(one.args) != len(other.args):
        return False
    left = list(other.args)
    for e in one.args:
        match = next((k for k in left if _negated(e, k)), None)
        if match is None:
            return False
        left.remove(match)
    return True


def _text(rule: Rule, atom: Compare, count: int) -> str:
    """Return the surface as the modeller would write it."""
    outside, before = rule.said, ""
    while outside != before:
        before, outside = outside, re.sub(r"\([^()]*\)", lambda m: "_" * len(m[0]), outside)
    found = [m.span() for m in re.finditer("[<>]=?", outside)]
    if count == 1 and len(found) == 1 and "not" not in rule.said:
        left, right = rule.said[: found[0][0]], rule.said[found[0][1] :]
        return f"{left.strip()} = {right.strip()}"
    return f"{_written(rule, atom.left)} = {_written(rule, atom.right)}"


def _written(rule: Rule, e: Expr) -> str:
    """Return an expression with the names that a rule gives what it reads."""
    back: dict[Expr, Expr] = {known: Name(text) for text, known in rule.reads}
    return str(transform(e, lambda n: back.get(n, n)))


def _plain(guard: Expr) -> Expr:
    """Return a guard without ``pre``, and with ``not`` carried into its comparisons."""
    return _carried(transform(guard, lambda e: e.arg if isinstance(e, Pre) else e), negate=False)


def _carried(e: Expr, *, negate: bool) -> Expr:
    match e:
        case Not():
            return _carried(e.arg, negate=not negate)
        case And() | Or():
            args = tuple(_carried(a, negate=negate) for a in e.args)
            return And(args) if isinstance(e, And) != negate else Or(args)
        case Compare() if negate and e.op in _OPPOSITE:
            return Compare(_OPPOSITE[e.op], e.left, e.right)
        case _:
            return Not(e) if negate else e


def _parts(guard: Expr) -> list[Expr]:
    """Return what a guard asks for, all at once."""
    todo: list[Expr] = [_plain(guard)]
    parts: list[Expr] = []
    while todo:
        e = todo.pop(0)
        if isinstance(e, And):
            todo = [*e.args, *todo]
        else:
            parts.append(e)
    return parts


def _positive(atom: Compare) -> Expr | None:
    """Return what is positive where a comparison holds."""
    if atom.op in (">", ">="):
        return simplify(Binary("-", atom.left, atom.right))
    if atom.op in ("<", "<="):
        return simplify(Binary("-", atom.right, atom.left))
    return None


def moves(e: Expr) -> bool:
    """Whether an expression changes while time passes."""
    return any(n == "time" or n.startswith(("u:", "s:", "x:", "e:", "f:")) for n in names(e))


def _steered(g: Expr) -> bool:
    """Whether a quantity is one that the motion can hold: more than time and inputs."""
    return any(n.startswith(("s:", "x:", "e:", "f:")) for n in names(g))


def _opposite(g: Expr, h: Expr) -> bool:
    """Whether ``h = -g`` for all values: at generic ones, of several sizes."""
    match g, h:
        case Binary("-", a, b), Binary("-", c, d) if (a, b) == (d, c):
            return True
    linear = _opposite_terms(g, h)
    if linear is not None:
        return linear
    wanted = sorted(names(g) | names(h))
    slot = {name: k for k, name in enumerate(wanted)}
    f, k = (compile_expression(e, slot, pre_offset=0) for e in (g, h))
    compared = 0
    for v in _generic(len(wanted)):
        a, b = f(v), k(v)
        if not math.isfinite(plain(a + b)):
            continue
        compared += 1
        if abs(a + b) > 1e-12 * (abs(a) + abs(b)):
            return False
    return compared > 0


def _opposite_terms(g: Expr, h: Expr) -> bool | None:
    """Whether ``h = -g`` where both are sums of terms with factors that may be changed.

    Then factors are compared, so that what is written down of them is short. None: nothing can be
    changed, or these are no such sums, or factors differ by what may be rounding.
    """
    if not _changeable(g) and not _changeable(h):
        return None
    one, other = _terms(g), _terms(h)
    if one is None or other is None or _may_meet({*one, *other}):
        return None
    sums = []
    for term in {**one, **other}:
        a, b = one.get(term, 0.0), other.get(term, 0.0)
        total = a + b
        if 0.0 < abs(plain(total)) <= SAME * (abs(plain(a)) + abs(plain(b))):
            return None
        sums.append(total)
    # what no parameter changes first: then there is nothing to write down
    sums.sort(key=is_slotted)
    return all(not c for c in sums)


def _changeable(e: Expr) -> bool:
    """Whether a number in an expression may be changed."""
    return any(is_slotted(n) for n, _ in walk(e))


def _terms(e: Expr) -> dict[tuple[Expr, ...], float] | None:
    """Return the factor of each term of a sum; None if it is no sum of terms."""

    def of(node: Expr, _: bool, below: list[Any]) -> dict[tuple[Expr, ...], float] | None:
        if any(b is None for b in below):
            return None
        match node:
            case Number(value):
                return {(): value}
            case Name():
                return {(node,): 1.0}
            case Neg():
                return {k: -c for k, c in below[0].items()}
            case Binary(op="+" | "-"):
                left, right = below
                found = dict(left)
                for k, c in right.items():
                    found[k] = found.get(k, 0.0) + (c if node.op == "+" else -c)
                return found
            case Binary(op="*") if len(below[0]) == len(below[1]) == 1:
                ((one, a),), ((other, b),) = below[0].items(), below[1].items()
                return {tuple(sorted((*one, *other), key=str)): a * b}
            case Binary(op="*") if {()} in (below[0].keys(), below[1].keys()):
                constant, rest = below if below[0].keys() == {()} else below[::-1]
                return {k: constant[()] * c for k, c in rest.items()}
            case Binary(op="/") if below[1].keys() == {()}:
                return {k: c / below[1][()] for k, c in below[0].items()}
        return {(node,): 1.0}

    found: dict[tuple[Expr, ...], float] | None = fold(e, of)
    return found


def _may_meet(terms: Iterable[tuple[Expr, ...]]) -> bool:
    """Whether parts of terms that differ now would not with other numbers in them."""
    parts = {e for term in terms for e in term if _changeable(e)}
    blank = {transform(e, lambda n: Number(0.0) if isinstance(n, Number) else n) for e in parts}
    return len(blank) < len(parts)


@lru_cache
def _generic(count: int) -> tuple[list[float], ...]:
    """Return values of so many names, several of each size, the same in every run."""
    from random import Random

    generator = Random(7)
    return tuple(
        [scale * generator.uniform(0.3, 1.7) for _ in range(count)]
        for scale in SCALES
        for _ in range(3)
    )


def way_beside(one: Surface, other: Surface) -> int:
    """Return 1 if two machines switch on one surface, -1 if with sides exchanged, else 0."""
    if names(one.g) != names(other.g):
        return 0
    if _opposite(one.g, other.g):
        return -1
    return int(_opposite(one.g, Binary("-", Number(0.0), other.g)))


def with_hysteresis(surfaces: Sequence[Surface], band: float) -> dict[Rule, Expr]:
    """Return the guards of the surfaces' rules, moved `band` beyond their surface."""
    moved = {}
    for s in surfaces:
        for rule, g, rest in (
            (s.up, s.g, s.up_rest),
            (s.down, Binary("-", Number(0.0), s.g), s.down_rest),
        ):
            beyond: Expr = Compare(">", g, Number(band))
            moved[rule] = And((beyond, *rest)) if rest else beyond
    return moved
