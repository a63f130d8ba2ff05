"""Flat ends of resistors' laws as states of machines: there a law fixes one variable alone.

``f = max(-2, min(2, e))`` says of a flow of 2 nothing but that the effort is 2 or more: the other
variable is determined by the rest of the model, as that of a source. Where what is stored decides
the flow, such an end is an end stop. So the law is cut into pieces, each the state of a machine:
a flat end holds its value and lets the other variable go, what is between is the law, continued in
a straight line beyond its corners; a corner that is passed leads to the next piece. Laws that can
do without, because the rest always determines what they read, stay as they are (`flat_ends`).

A law that is flat in its middle is no such case: beside what is stored it is dry friction, for
which there are junctions with a law.

Corners are found in numbers. In a law with slots they are then said in parameters: where what is
compared is straight in the argument, and where a bounded function is taken of a multiple of it. Of
other laws the numbers are settled: other parameters make another model.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from hybond.model.expressions import (
    Binary,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Number,
    Table,
    differentiate,
    names,
    simplify,
    substitute,
    to_text,
    transform,
    turning,
)
from hybond.model.expressions.slots import (
    PREFIX,
    Slotted,
    is_slotted,
    plain,
    settled,
    slot_of,
    tree_of,
)
from hybond.model.expressions.tree import walk
from hybond.model.flat_ends import needing_ends
from hybond.model.graph import FlatGraph, Machine, Node, Rule
from hybond.model.law_ends import (
    MOST,
    End,
    argument_of,
    corners_of,
    ends_in_numbers,
    ends_of,
    function_of,
    is_bent,
    values_within,
    with_numbers,
)
from hybond.records import dataclass

BESIDE = 2.0**-30
"""Part of the way to the middle of a law at which its slope beside a corner is taken."""
SAME = 1e-9
"""Part of a corner within which one that is found in another way is the same."""
FARTHER = 2.0
"""Times as far as its limit that a law goes on with its own slope, before it does so with less."""
LEAVES = 1.5
"""Times as far as its limit that it is left for it: there nothing tells what is across it."""
LOW, FOLLOWS, HIGH = "low", "follows", "high"
"""What pieces are called: flat ends, and what is between."""
LONG = 40
"""Letters of an expression of parameters that a guard shows at most."""
WHY = "where a law ends in a flat piece"


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of a law between two values of its argument, which may be infinite.

    Parameters
    ----------
    low, high : float
        Where it begins and ends, in SI.
    said : Expr
        What the law is there; between flat ends it goes on beyond them in straight lines.
    """

    low: float
    high: float
    said: Expr

    @property
    def name(self) -> str:
        """What the state of the machine is called."""
        if not isinstance(self.said, Number):
            return FOLLOWS
        return LOW if math.isinf(plain(self.low)) else HIGH


def with_flat_pieces(graph: FlatGraph) -> FlatGraph:
    """Return a graph in which flat ends that may be constraints are states of machines.

    Parameters
    ----------
    graph : FlatGraph
        Resistors with more than one port, those that have a machine of their name, and those whose
        laws read signals, or jump at an end, stay as they are.

    Returns
    -------
    FlatGraph
        With a machine of the name of each resistor that is cut; the same graph if none is.
    """
    taken = {m.path for m in graph.machines}
    bent = [n.index for n in graph.nodes if is_bent(n) and n.path not in taken]
    found = needing_ends(graph.nodes, graph.bonds, bent)
    found = [k for k in found if ends_of(graph.nodes[k])]
    found = needing_ends(graph.nodes, graph.bonds, found)
    if not found:
        return graph
    nodes = list(graph.nodes)
    machines = list(graph.machines)
    for k in sorted(found, key=lambda k: nodes[k].path):
        law = nodes[k].law
        assert law is not None
        pieces = pieces_of(law.expressions[0], argument_of(nodes[k]))
        match ends_of(nodes[k]):
            case [End(way, at, outer)] if outer is not None:
                limit = next(p.high if way < 0 else p.low for p in pieces if p.name != FOLLOWS)
                machine = _machine(nodes[k], len(machines), pieces, LEAVES)
                machine = replace(machine, led_on=(at, FARTHER * plain(limit)))
            case _:
                machine = _machine(nodes[k], len(machines), pieces, 1.0)
        whole = pieces[0].said
        for n, piece in enumerate(pieces[1:], 1):
            whole = If(Name(f"in:{machine.index}:{n}"), piece.said, whole)
        nodes[k] = replace(nodes[k], law=replace(law, expressions=(whole,)))
        machines.append(machine)
    reference = graph.reference
    if reference is not None:
        reference = (*reference, *(m.start for m in machines[len(graph.machines) :]))
    return replace(graph, nodes=tuple(nodes), machines=tuple(machines), reference=reference)


def pieces_of(e: Expr, own: str) -> list[Piece]:
    """Return the pieces of a law that has flat ends, in the order of its argument `own`."""
    now = with_numbers(e, plain)
    ends = ends_in_numbers(now, own)
    if now is not e:
        try:
            followed = _in_parameters(e, own, ends)
            with _nothing_new(e):
                return _pieces(_between(e, own, ends), e, own, followed)
        except _OnlyNumbers:
            e = with_numbers(e, lambda x: settled(x, WHY))
    return _pieces(_between(e, own, ends), e, own, ends)


def _pieces(middle: Expr, e: Expr, own: str, ends: tuple[End, ...]) -> list[Piece]:
    """Return the pieces of a law, given what it is between its ends."""
    low, high = _bounds(ends)
    slope = differentiate(middle, own)
    straight = own not in names(simplify(slope))
    pieces: list[Piece] = []
    line: Expr
    for end in ends:
        at, level = end.at, _value(e, own, end.at)
        if end.outer is not None:
            near, level = level, _value(e, own, end.way * 10.0**MOST)
            rise = (level - _value(e, own, end.outer)) / (at - end.outer)
            if len(ends) == 1:
                # it goes on as it is: within rounding of what is stored, the other variable is not
                own_rise = _value(slope, own, at)
                if plain(own_rise) * plain(rise) <= 0.0:
                    own_rise = rise
                tangent = _line(own, at, near, own_rise)
                at = at + (level - near) / own_rise
                beyond = FARTHER * at
                far = _line(own, beyond, near + own_rise * (beyond - end.at), rise)
                side = Compare(">" if end.way > 0 else "<", Name(own), Number(beyond))
                line = If(side, far, tangent)
            else:
                line = _line(own, at, near, rise)
                at = at + (level - near) / rise
        elif not straight:
            inner = _middle(low, high)
            chord = (_value(middle, own, inner) - level) / (inner - at)
            rise = _value(slope, own, at + BESIDE * (inner - at))
            if not (math.isfinite(plain(rise)) and abs(plain(rise)) > 1e-3 * abs(plain(chord))):
                rise = chord
            line = _line(own, at, level, rise)
        if not straight:
            side = Compare(">" if end.way > 0 else "<", Name(own), Number(end.at))
            middle = If(side, line, middle)
        bounds = (at, math.inf) if end.way > 0 else (-math.inf, at)
        pieces.append(Piece(*bounds, Number(level)))
        low, high = (low, at) if end.way > 0 else (at, high)
    return sorted([*pieces, Piece(low, high, middle)], key=lambda piece: plain(piece.low))


def _bounds(ends: tuple[End, ...]) -> tuple[float, float]:
    low = next((end.at for end in ends if end.way < 0), -math.inf)
    return low, next((end.at for end in ends if end.way > 0), math.inf)


def _between(e: Expr, own: str, ends: tuple[End, ...]) -> Expr:
    """Return what a law is between its ends, given in numbers: without branches if it is one."""
    low, high = _bounds(ends)
    if any(low < x < high for x in corners_of(with_numbers(e, plain), own)):
        return e
    at = values_within(low, high)[0]

    def value(part: Expr) -> float:
        return function_of(with_numbers(part, plain), own)(at)

    def taken(node: Expr) -> Expr:
        match node:
            case If():
                return node.then if value(node.cond) else node.orelse
            case Call("min" | "max", args):
                found = value(node)
                return next((a for a in args if value(a) == found), node)
            case Call("abs", (arg,)):
                return arg if value(arg) > 0.0 else Neg(arg)
            case Call("sign"):
                return Number(value(node))
            case Table(arg, x, y):
                k = max(0, min(len(x) - 2, bisect_right(list(map(plain, x)), value(arg)) - 1))
                rise = (y[k + 1] - y[k]) / (x[k + 1] - x[k])
                return _line_of(arg, x[k], y[k], rise)
        return node

    return simplify(transform(e, taken))


def _middle(low: float, high: float) -> float:
    """Return a value between two, of which one is finite."""
    if math.isinf(plain(low)):
        return high - (abs(high) + 1.0)
    return low + (abs(low) + 1.0) if math.isinf(plain(high)) else 0.5 * (low + high)


def _value(e: Expr, own: str, at: float) -> float:
    """Return a law at a value of its argument, in parameters if either says so."""
    found = simplify(substitute(e, {own: Number(at)}))
    if isinstance(found, Number):
        return found.value
    # something in it may be beyond all numbers, and the whole is one: 1/(1 + exp(at))
    known = function_of(e, own)(at) if with_numbers(e, plain) is e else math.nan
    if not math.isfinite(known):
        raise _OnlyNumbers
    return known


def _line(own: str, at: float, level: float, rise: float) -> Expr:
    return _line_of(Name(own), at, level, rise)


def _line_of(arg: Expr, at: float, level: float, rise: float) -> Expr:
    away = Binary("-", arg, Number(at))
    return Binary("+", Number(level), Binary("*", Number(rise), away))


def _machine(node: Node, index: int, pieces: list[Piece], leaves: float) -> Machine:
    bond = node.ends[0]
    assert node.law is not None
    read = Name(f"{'e' if node.law.output == 'f' else 'f'}:{bond.bond}")
    same = node.law.output == "f" or bond.inward
    # what goes into the element is the variable of its bond, or its negative
    argument: Expr = read if same else Neg(read)
    letter = f"{node.path}.{'e' if node.law.output == 'f' else 'f'}"
    written = letter if same else f"-{letter}"
    rules = []
    for k, (one, other) in enumerate(itertools.pairwise(pieces)):
        for source, target, op, at in ((k, k + 1, ">", one.high), (k + 1, k, "<", other.low)):
            if pieces[source].name == FOLLOWS:
                at = leaves * at
            guard = Compare(op, argument, Number(at))
            text = f"{written} {op} {_written(at)}"
            rules.append(Rule(source, target, guard, text, ((letter, read),)))
    states = tuple(p.name for p in pieces)
    nothing: frozenset[int] = frozenset()
    many = len(states)
    return Machine(
        index,
        node.path,
        states,
        (nothing,) * many,
        states.index(FOLLOWS),
        tuple(rules),
        (False,) * many,
        pieces=True,
    )


def _written(at: float) -> str:
    if not is_slotted(at):
        return f"{at:.9g}"
    text = to_text(tree_of(at)).replace(PREFIX, "")
    return text if len(text) <= LONG else "where its law ends"


# -- in parameters


class _OnlyNumbers(Exception):
    """Ends of a law that are not said in parameters."""


@contextmanager
def _nothing_new(e: Expr) -> Iterator[None]:
    """Compare numbers of a law whose corners are in order: nothing more is asked of parameters.

    That one is this number is: of what is computed with numbers.
    """
    (slots, *_) = (x.slots for x in _slotted(e))
    before = dict(slots.conditions)
    try:
        yield
    finally:
        after = (c for c in slots.conditions if isinstance(c, Compare) and c.op == "==")
        slots.conditions = before | dict.fromkeys(after)


def _slotted(e: Expr) -> Iterator[Slotted]:
    for node, _ in walk(e):
        found = (*node.x, *node.y) if isinstance(node, Table) else (node,)
        yield from (slot for slot in map(slot_of, found) if slot is not None)


def _in_parameters(e: Expr, own: str, ends: tuple[End, ...]) -> tuple[End, ...]:
    """Return the ends of a law as expressions of parameters; what makes them ends is asked of them.

    Raises
    ------
    _OnlyNumbers
    """
    corners = [c for atom in _atoms(e) if (c := _zero(atom, own)) is not None]
    corners.sort(key=plain)
    kept: list[float] = corners[:1]
    for x in corners[1:]:
        if x == kept[-1]:
            continue
        if not kept[-1] < x:
            raise _OnlyNumbers
        kept.append(x)
    found = []
    for end in ends:
        if end.outer is None:
            near = [x for x in kept if math.isclose(plain(x), end.at, rel_tol=SAME, abs_tol=SAME)]
            if len(near) != 1:
                raise _OnlyNumbers
            found.append(replace(end, at=near[0]))
        elif kept:
            raise _OnlyNumbers
        else:
            scale = _scale(e, own)
            found.append(replace(end, at=end.at * plain(scale) / scale))
    return tuple(found)


def _atoms(e: Expr) -> list[Expr]:
    """Return what changes its sign at corners, of least and largest values each with each."""
    found: list[Expr] = []
    for atom in turning(e):
        match atom:
            case Binary("-", left, right):
                found += [Binary("-", a, b) for a in _leaves(left) for b in _leaves(right)]
            case _:
                found.append(atom)
    return list(dict.fromkeys(found))


def _leaves(e: Expr) -> list[Expr]:
    if isinstance(e, Call) and e.function in ("min", "max"):
        return [leaf for arg in e.args for leaf in _leaves(arg)]
    return [e]


def _zero(atom: Expr, own: str) -> float | None:
    """Return where an expression that is straight in the argument is zero; None if nowhere."""
    rise = simplify(differentiate(atom, own))
    if not isinstance(rise, Number) or (is_slotted(rise.value) and not plain(rise.value)):
        raise _OnlyNumbers
    if not rise.value:
        _ask_sign(_value(atom, own, 0.0))
        return None
    _ask_sign(rise.value)
    return -_value(atom, own, 0.0) / rise.value


def _ask_sign(value: float) -> None:
    """Ask of the parameters that a number has the sign that it has."""
    now = plain(value)
    if is_slotted(value) and not (now and (value > 0.0 if now > 0.0 else value < 0.0)):
        raise _OnlyNumbers


def _scale(e: Expr, own: str) -> float:
    """Return the factor with which the argument goes into the one function that bends a law."""
    calls = {n for n, _ in walk(e) if isinstance(n, Call) and own in names(n)}
    if len(calls) != 1:
        raise _OnlyNumbers
    (call,) = calls
    outside = transform(e, lambda node: Name("bent") if node == call else node)
    rise = simplify(differentiate(outside, "bent"))
    factor = simplify(differentiate(call.args[0], own)) if len(call.args) == 1 else rise
    if (
        names(outside) != {"bent"}
        or not isinstance(rise, Number)
        or not isinstance(factor, Number)
        or len(call.args) != 1
        or is_slotted(offset := _value(call.args[0], own, 0.0))
        or offset != 0.0
    ):
        raise _OnlyNumbers
    _ask_sign(rise.value)
    _ask_sign(factor.value)
    return factor.value
