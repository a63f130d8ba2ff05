"""Tables of courses: what time, or a phase, does in laws, sources, rates, guards and kinks.

A course is known before it is met, so that a step can be chosen by what lies ahead of it
(`engine.run.courses_ahead`). Sums are taken apart: each term is a course of its own. What a phase
of the plant does, such as the angle of a flywheel, is a course too: it is foreseen by how fast its
argument moves.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

from hybond.engine.expressions import code as c
from hybond.engine.expressions.course_parts import (
    ARC,
    AT_INPUT,
    AT_PLANT,
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
from hybond.engine.inputs.calls import FREE
from hybond.engine.tables.beforehand import Beforehand
from hybond.engine.tables.code import ONE
from hybond.engine.tables.columns import INTS, ModelTables, put_rows
from hybond.engine.tables.course_forms import bounded
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
from hybond.model.expressions.stable import stable
from hybond.model.expressions.tree import children, fold, walk

if TYPE_CHECKING:
    from collections.abc import Iterator

ALWAYS, OF_SOURCE, OF_SWITCH, OF_RULE = 0, 1, 2, 3
"""When a course counts: always, where a source acts, a switch is ON, a rule is asked."""
PLANT = ("e:", "f:", "x:")
TURNING = ("sin", "cos", "tan", "mod", "exp", "tanh", "cosh", "sinh")
"""Functions by which what moves evenly can do something in no time."""
_RISING = ("exp", "tanh", "sinh")
"""Those of them that only go one way: alone, one of them goes there and does not come back."""
_LEVEL = ("log", "log10", "atan", "acos", "asin")
"""Functions that are all but level from far: where they dip no polynomial of a step shows it."""
_ONE_WAY = (*_RISING, *_LEVEL, "sqrt")
"""Functions that go one way where they have a value; ``1/x`` does so too."""
MOST_SHOWN = 4.0
"""Powers up to which a polynomial through samples of a step does."""
_ARITHMETIC = {"+": c.ADD, "-": c.SUBTRACT, "*": c.MULTIPLY, "/": c.DIVIDE, "^": c.RAISE}
_CALLED = {"abs": c.ABSOLUTE, "sign": c.SIGN, "hypot": c.LENGTH, "min": c.LEAST, "max": c.GREATEST}
_COMPARED = {"<": LESS, "<=": LESS, ">": GREATER, ">=": GREATER, "==": SAME, "!=": SAME}


def put_courses(t: ModelTables) -> None:
    """Put courses into the tables, with what they are made of, and when each counts."""
    users: dict[Expr, dict[tuple[int, int], None]] = {}
    group: dict[Expr, int] = {}
    wholes: dict[Expr, int] = {}
    phases: set[Expr] = set()
    compares: dict[Expr, Expr | None] = {}
    before = Beforehand(t)
    for e, user, compared in _read(t):
        own = _own(t, user)
        for whole in (*_timed_parts(before, e), *_phased(before, e, user, compared, own)):
            for term in _terms(whole):
                phased = _has_phase(before, term, compared, own)
                if _bends(term) and (phased or before.covers(term)):
                    if term not in group:
                        group[term] = wholes.setdefault(whole, len(wholes))
                    users.setdefault(term, {})[user] = None
                    phases |= {term} if phased else set()
                    alone = compared and phased and compares.get(term, e) == e
                    compares[term] = e if alone else None
    made = _Making(t, before)
    t.ints["course_root"] = [made.place_of(bounded(e)) for e in users]
    t.ints["course_group"] = [group[e] for e in users]
    t.ints["course_place"] = [_place_of(t, *next(iter(own))) for own in users.values()]
    t.ints["course_whole"] = [
        -1 if e is None else made.place_of(bounded(e)) for e in compares.values()
    ]
    t.ints["course_phase"] = [int(e in phases) for e in users]
    t.ints["course_value"] = [t.values.number(e) for e in users]
    rows = [list(own) for own in users.values()]
    put_rows(t, "course_first", rows, course_user=INTS, course_index=INTS)
    nodes = list(made.place)
    for k, name in enumerate(("course_op", "course_left", "course_right", "course_third")):
        t.ints[name] = [int(node[k]) for node in nodes]
    t.floats["course_number"] = made.numbers
    t.ints["course_signal"] = [int(name.partition(":")[2]) for name in made.rates]
    t.ints["course_plant"] = list(made.plants)
    t.numbers.update(courses=len(users), course_nodes=len(nodes), course_signals=len(made.rates))
    t.numbers["course_plants"] = len(made.plants)


def _read(t: ModelTables) -> Iterator[tuple[Expr, tuple[int, int], bool]]:
    """Yield what a step evaluates, and what it ends at, with when that counts, and which it is."""
    for k, number in enumerate(t.ints["source_value"]):
        if number >= 0:
            yield t.values.all[number], (OF_SOURCE, k), False
    for number, node in zip(t.ints["dynamic_value"], t.ints["dynamic_node"], strict=True):
        yield t.values.all[number], (ALWAYS, node + 1), False
    for name in ("co_energy", "integral_rate"):
        for number in t.ints[name]:
            if number >= 0:
                yield t.values.all[number], (ALWAYS, 0), False
    for name in ("port_limit", "port_gap", "port_gate"):
        for number in t.ints[name]:
            if number >= 0:
                yield t.values.all[number], (ALWAYS, 0), False
    first = t.ints["atom_first"]
    for rule, watched in enumerate(t.ints["rule_watched"]):
        for a in range(first[rule], first[rule + 1]) if watched else ():
            yield t.values.all[t.ints["atom_value"][a]], (OF_RULE, rule), True
    for k, switch in enumerate(t.ints["kink_switch"]):
        number = t.ints["atom_value"][int(t.numbers["kink_atom"]) + k]
        yield t.values.all[number], (OF_SWITCH, switch) if switch >= 0 else (ALWAYS, 0), True


def _place_of(t: ModelTables, user: int, which: int) -> int:
    """Return who says a course: an element, -1: the rate of a signal, else ``-2 - rule``."""
    if user == OF_SOURCE:
        return t.ints["source_node"][which]
    return -2 - which if user == OF_RULE else which - 1


def _timed_parts(before: Beforehand, e: Expr) -> list[Expr]:
    """Return the largest parts of an expression that change with time alone.

    Those of which all is known beforehand: no function in Python, nothing from outside.
    """
    found: list[Expr] = []
    stack = [e]
    while stack:
        part = stack.pop()
        if not any(before.moves(n) for n in names(part)):
            continue
        if before.covers(part):
            found.append(part)
        elif not isinstance(part, Pre):
            stack += children(part)
    return found


def _own(t: ModelTables, user: tuple[int, int]) -> frozenset[str]:
    """Return the effort and the flow of what says an expression: no phase turns a law by itself.

    How a law of its own effort or flow bends is seen by the steps that solve it.
    """
    if user[0] != OF_SOURCE:
        return frozenset()
    bond = t.ints["source_bond"][user[1]]
    return frozenset((f"e:{bond}", f"f:{bond}"))


def _phased(
    before: Beforehand, e: Expr, user: tuple[int, int], compared: bool, own: frozenset[str]
) -> list[Expr]:
    """Return an expression if a phase of the plant turns something in it, and may turn it back.

    What does not come back is seen at the end of a step: there a rate is another one. What time
    alone does in it is a course for itself; beside it the plant goes against it where a loop is
    closed, and what both leave is far smaller than either. A guard is no rate.
    """
    if uses_pre(e) or not _has_phase(before, e, compared, own):
        return []
    timed = None if compared else before
    return [] if _rises(stable(e), timed) <= 1 else [e]


def _has_phase(before: Beforehand, e: Expr, compared: bool, own: frozenset[str]) -> bool:
    """Whether a function in it reads a phase that the plant moves, and all else is there to see."""
    if any(n.startswith("u:") and not before.is_known(n) for n in names(e)):
        return False
    turned = (
        argument
        for part, _ in walk(e)
        if isinstance(part, Call) and part.function in TURNING
        for argument in part.args
    )
    dipping = _dipping(e) if compared else ()
    return any(_is_phase(before, argument, own) for argument in chain(turned, dipping))


def _dipping(e: Expr) -> Iterator[Expr]:
    """Yield what moves in a comparison that may dip unseen, and come back: ``1/(1 + x^2) - 0.5``.

    What is a polynomial of the state is one of a step, which shows where it dips.
    """
    if _rises(e, None, _ONE_WAY) <= 1:
        return
    for part, _ in walk(e):
        match part:
            case Call(function, (a,)) if function in _LEVEL:
                yield a
            case Binary("/", _, b):
                yield b
            case Binary("^", a, Number(n)) if n not in (1.0, 2.0, 3.0, MOST_SHOWN):
                yield a
            case Binary("^", _, b) if not isinstance(b, Number):
                yield b


def _is_phase(before: Beforehand, e: Expr, own: frozenset[str]) -> bool:
    """Whether an argument goes on with time by what the plant says."""
    read = names(e)
    if any(n.startswith("s:") and not before.is_known(n) for n in read):
        return True
    plant = any(n.startswith(PLANT) for n in read)
    return plant and any(before.moves(n) or (n.startswith(PLANT) and n not in own) for n in read)


def _rises(e: Expr, timed: Beforehand | None, rising: tuple[str, ...] = _RISING) -> int:
    """Return how many functions rise in what is even otherwise in the plant and time; 2: or other.

    ``tanh(k*(a - b)) + c*a`` has one; the difference of two is a pulse, and so is their product.
    What is known beforehand is even as well, if it is given what that is.
    """
    match e:
        case Neg(a):
            return _rises(a, timed, rising)
        case Binary(op="+" | "-"):
            return _rises(e.left, timed, rising) + _rises(e.right, timed, rising)
        case Binary(op="*", left=a, right=b) if not (_is_moved(a, timed) and _is_moved(b, timed)):
            return _rises(a, timed, rising) + _rises(b, timed, rising)
        case Binary(op="/", left=a, right=b) if not _is_moved(b, timed):
            return _rises(a, timed, rising)
        case (
            Binary(op="/", left=a, right=Binary("+", Number(n), Call("exp") as b))
            | Binary(op="/", left=a, right=Binary("+", Call("exp") as b, Number(n)))
        ) if n >= 0.0 and not _is_moved(a, timed):
            return _rises(b, timed, rising)
        case Call(function, (a,)) if function in rising and _is_moved(e, timed):
            return max(1, _rises(a, timed, rising))
        case Binary(op="/", left=a, right=b) if rising is not _RISING and not _is_moved(a, timed):
            return max(1, _rises(b, timed, rising))
        case Name(path):
            return 2 if path.startswith("u:") and _is_moved(e, timed) else 0
    return 2 if _is_moved(e, timed) else 0


def _is_moved(e: Expr, timed: Beforehand | None) -> bool:
    """Whether anything in it goes on while nothing happens, other than what time alone does."""
    if timed is not None and timed.covers(e):
        return False
    return any(n == "time" or n.startswith(("u:", "s:", *PLANT)) for n in names(e))


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

    def __init__(self, t: ModelTables, before: Beforehand) -> None:
        self.t = t
        self.before = before
        self.place: dict[tuple[int, int, int, int], int] = {}
        self.numbers: list[float] = []
        self.kept: dict[float, int] = {}
        self.rates: dict[str, int] = {}
        """Where those of integrated signals stand, each behind those that it reads."""
        self.plants: dict[int, int] = {}

    def place_of(self, e: Expr) -> int:
        """Return where an expression stands among the parts."""
        return fold(e, self._node)

    def _place_rates(self, signal: str) -> None:
        """Place the rate of a signal that is an integral of others, behind those of these."""
        waiting = [signal] if self._is_integral(signal) else []
        while waiting:
            path = waiting[-1]
            rate = self.before.rate_of(path)
            read = [n for n in sorted(names(rate)) if self._is_integral(n)]
            first = [n for n in read if n not in self.rates]
            waiting += first
            if not first:
                waiting.pop()
                if path not in self.rates:
                    self.rates[path] = self.place_of(bounded(rate))

    def _is_integral(self, name: str) -> bool:
        """Whether it is a signal that moves by a rate whose parts can be foreseen."""
        if not name.startswith("s:") or not self._moves(name):
            return False
        return not self.before.goes_round(name) and not uses_pre(self.before.rate_of(name))

    def _moves(self, signal: str) -> bool:
        rate = self.before.rate_of(signal)
        return bool(names(rate)) or rate != Number(0.0)

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
                    self._place_rates(path)
                    if path in self.rates:
                        known = self.before.is_known(path)
                        slot, at = self.t.slots.index[path], self.rates[path]
                        return self._put(AT_SIGNAL, slot, at, int(not known))
                if kind in ("e", "f", "x") or (kind == "s" and self._moves(path)):
                    slot = self.t.slots.index[path]
                    return self._put(AT_PLANT, slot, self.plants.setdefault(slot, len(self.plants)))
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
