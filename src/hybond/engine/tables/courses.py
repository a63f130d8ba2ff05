"""Tables of courses: what time alone does in laws, sources, rates, guards and kinks.

A course is known before it is met, so that a step can be chosen by what lies ahead of it
(`engine.run.courses_ahead`). Sums are taken apart: each term is a course of its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.expressions import code as c
from hybond.engine.expressions.course_parts import (
    ARC,
    AT_INPUT,
    AT_SIGNAL,
    AT_TIME,
    BOTH,
    CHOOSE,
    EITHER,
    GREATER,
    HELD,
    LESS,
    OPPOSITE,
    SAME,
)
from hybond.engine.inputs.calls import CALLED, FREE
from hybond.engine.tables.code import ONE
from hybond.engine.tables.columns import INTS, ModelTables, put_rows
from hybond.engine.tables.expressions import number_of
from hybond.model.expressions import (
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
    names,
    simplify,
    uses_pre,
)
from hybond.model.expressions.tree import children, fold, walk

if TYPE_CHECKING:
    from collections.abc import Iterator

ALWAYS, OF_SOURCE, OF_SWITCH, OF_RULE = 0, 1, 2, 3
"""When a course counts: always, where a source acts, a switch is ON, a rule is asked."""
_ARITHMETIC = {"+": c.ADD, "-": c.SUBTRACT, "*": c.MULTIPLY, "/": c.DIVIDE, "^": c.RAISE}
_CALLED = {"abs": c.ABSOLUTE, "sign": c.SIGN, "hypot": c.LENGTH, "min": c.LEAST, "max": c.GREATEST}
_COMPARED = {"<": LESS, "<=": LESS, ">": GREATER, ">=": GREATER, "==": SAME, "!=": SAME}


def put_courses(t: ModelTables) -> None:
    """Put courses into the tables, with what they are made of, and when each counts."""
    users: dict[Expr, dict[tuple[int, int], None]] = {}
    group: dict[Expr, int] = {}
    wholes: dict[Expr, int] = {}
    for e, user in _read(t):
        for whole in _timed_parts(t, e):
            for term in _terms(whole):
                if _bends(term):
                    if term not in group:
                        group[term] = wholes.setdefault(whole, len(wholes))
                    users.setdefault(term, {})[user] = None
    made = _Making(t)
    t.ints["course_root"] = [made.place_of(e) for e in users]
    t.ints["course_group"] = [group[e] for e in users]
    t.ints["course_place"] = [_place_of(t, *next(iter(own))) for own in users.values()]
    t.ints["course_value"] = [t.values.number(e) for e in users]
    rows = [list(own) for own in users.values()]
    put_rows(t, "course_first", rows, course_user=INTS, course_index=INTS)
    nodes = list(made.place)
    for k, name in enumerate(("course_op", "course_left", "course_right", "course_third")):
        t.ints[name] = [int(node[k]) for node in nodes]
    t.floats["course_number"] = made.numbers
    t.ints["course_signal"] = list(made.signals)
    t.numbers.update(courses=len(users), course_nodes=len(nodes), course_signals=len(made.signals))


def _read(t: ModelTables) -> Iterator[tuple[Expr, tuple[int, int]]]:
    """Yield what a step evaluates, and what it ends at, with when that counts."""
    for k, number in enumerate(t.ints["source_value"]):
        if number >= 0:
            yield t.values.all[number], (OF_SOURCE, k)
    for name in ("dynamic_value", "co_energy", "integral_rate"):
        for number in t.ints[name]:
            if number >= 0:
                yield t.values.all[number], (ALWAYS, 0)
    for name in ("port_limit", "port_gap", "port_gate"):
        for number in t.ints[name]:
            if number >= 0:
                yield t.values.all[number], (ALWAYS, 0)
    first = t.ints["atom_first"]
    for rule, watched in enumerate(t.ints["rule_watched"]):
        for a in range(first[rule], first[rule + 1]) if watched else ():
            yield t.values.all[t.ints["atom_value"][a]], (OF_RULE, rule)
    for k, switch in enumerate(t.ints["kink_switch"]):
        number = t.ints["atom_value"][int(t.numbers["kink_atom"]) + k]
        yield t.values.all[number], (OF_SWITCH, switch) if switch >= 0 else (ALWAYS, 0)


def _place_of(t: ModelTables, user: int, which: int) -> int:
    """Return who says a course: an element, -1: the rate of a signal, else ``-2 - rule``."""
    if user == OF_SOURCE:
        return t.ints["source_node"][which]
    return -2 - which if user == OF_RULE else -1


def _timed_parts(t: ModelTables, e: Expr) -> list[Expr]:
    """Return the largest parts of an expression that change with time alone.

    Those of which all is known beforehand: no function in Python, nothing from outside.
    """
    found: list[Expr] = []
    stack = [e]
    while stack:
        part = stack.pop()
        read = names(part)
        if not any(_moves(t, n) for n in read):
            continue
        if all(_is_known(t, n) for n in read) and not any(
            isinstance(p, Pre) for p, _ in walk(part)
        ):
            found.append(part)
        elif not isinstance(part, Pre):
            stack += children(part)
    return found


def _moves(t: ModelTables, name: str) -> bool:
    """Whether a name stands for what goes on with time while nothing happens."""
    return name == "time" or (name.startswith(("u:", "s:")) and _is_known(t, name))


def _is_known(t: ModelTables, name: str) -> bool:
    """Whether all is known of it beforehand: of a signal, by a rate that reads no other."""
    kind, _, index = name.partition(":")
    if kind in ("u", "du"):
        return t.ints["input_kind"][int(index)] != CALLED
    if kind == "s":
        rate = t.values.all[t.ints["integral_rate"][int(index)]]
        plain = all(not n.startswith("s:") and _is_known(t, n) for n in names(rate))
        return plain and not uses_pre(rate)
    return kind in ("time", "on", "in", "at")


def _terms(e: Expr) -> list[Expr]:
    """Return the terms of a sum that change, each with the factor that it has, but for its sign."""
    found: list[Expr] = []
    stack: list[tuple[Expr, Expr | None]] = [(e, None)]
    while stack:
        part, factor = stack.pop()
        match part:
            case Binary(op="+" | "-"):
                stack += [(part.left, factor), (part.right, factor)]
            case Neg():
                stack.append((part.arg, factor))
            case (
                Binary(op="*", left=Number() as a, right=b)
                | Binary(op="*", left=b, right=Number() as a)
            ):
                stack.append((b, a if factor is None else simplify(Binary("*", factor, a))))
            case _:
                found.append(part if factor is None else Binary("*", factor, part))
    return found


def _bends(e: Expr) -> bool:
    """Whether it is more than a power of time, which any method resolves."""
    return bool(names(e)) and any(
        isinstance(p, Call | Table | If | Compare)
        or (isinstance(p, Binary) and p.op in "/^" and bool(names(p)))
        for p, _ in walk(e)
    )


class _Making:
    """What courses are made of, the same part once: rows of what it is, and what it works on."""

    def __init__(self, t: ModelTables) -> None:
        self.t = t
        self.place: dict[tuple[int, int, int, int], int] = {}
        self.numbers: list[float] = []
        self.kept: dict[float, int] = {}
        self.signals: dict[int, None] = {}

    def place_of(self, e: Expr) -> int:
        """Return where an expression stands among the parts."""
        return fold(e, self._node)

    def _put(self, op: int, left: int = 0, right: int = 0, third: int = 0) -> int:
        return self.place.setdefault((op, left, right, third), len(self.place))

    def _number(self, value: float) -> int:
        number = number_of(value)
        if number not in self.kept:
            self.kept[number] = len(self.numbers)
            self.numbers.append(number)
        return self.kept[number]

    def _node(self, e: Expr, prior: bool, below: list[int]) -> int:
        match e:
            case Number() | Bool():
                return self._put(c.NUMBER, self._number(e.value))
            case Name("time"):
                return self._put(AT_TIME)
            case Name(path):
                kind, _, index = path.partition(":")
                if kind == "s":
                    rate = self.t.values.all[self.t.ints["integral_rate"][int(index)]]
                    if names(rate) or rate != Number(0.0):
                        self.signals[int(index)] = None
                        return self._put(AT_SIGNAL, self.t.slots.index[path], self.place_of(rate))
                if kind == "u" and self.t.ints["input_kind"][int(index)] != FREE:
                    return self._put(AT_INPUT, int(index))
                return self._put(HELD, self.t.slots.index[path])
            case Neg():
                return self._put(c.NEGATE, below[0])
            case Not():
                return self._put(OPPOSITE, below[0])
            case Binary(op):
                return self._put(_ARITHMETIC[op], *below)
            case Compare(op):
                return self._put(_COMPARED[op], below[0], below[1], int(op == "!="))
            case And() | Or():
                return self._folded(BOTH if isinstance(e, And) else EITHER, below)
            case If():
                return self._put(CHOOSE, below[1], below[2], below[0])
            case Table(_, x, y, extrapolate, slope):
                at = len(self.numbers)
                self.numbers += [float(len(x)), float(extrapolate == "linear"), *x, *y]
                return self._put(c.SLOPE if slope else c.READ, below[0], at)
            case Call(function) if function in ONE:
                return self._put(c.APPLY, below[0], ONE[function])
            case Call(function) if function in _CALLED:
                what = _CALLED[function]
                if len(below) == 1:
                    return self._put(what, below[0])
                return self._folded(what, below)
            case Call(function):
                return self._put(ARC if function == "atan2" else c.APPLY_TO_TWO, *below)
        raise TypeError(type(e).__name__)

    def _folded(self, op: int, below: list[int]) -> int:
        found = below[0]
        for other in below[1:]:
            found = self._put(op, found, other)
        return found
