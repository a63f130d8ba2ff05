"""Flat ends of resistors' laws as states of machines: there a law fixes one variable alone.

``f = max(-2, min(2, e))`` says of a flow of 2 nothing but that the effort is 2 or more: the other
variable is determined by the rest of the model, as that of a source. Where what is stored decides
the flow, such an end is an end stop. So the law is cut into pieces, each the state of a machine:
a flat end holds its value and lets the other variable go, what is between is the law, continued in
a straight line beyond its corners; a corner that is passed leads to the next piece.

A law that is flat in its middle is no such case: beside what is stored it is dry friction, for
which there are junctions with a law.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import replace

from hybond.model.expressions import (
    Binary,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Number,
    compile_expression,
    differentiate,
    names,
    simplify,
    turning,
)
from hybond.model.graph import FlatGraph, Machine, Node, Rule
from hybond.model.kinds import RESISTORS
from hybond.model.laws import Law
from hybond.records import dataclass

LEAST, MOST = -12, 12
"""Powers of ten, in SI units, between which corners are looked for."""
PER_DECADE = 6
JUMPS = 1e-9
"""Part of the height of a law by which its pieces may be apart at a corner."""
REACHED = 1e-6
"""Part of the height of a law that bends towards a limit within which it counts as that."""
LOW, FOLLOWS, HIGH = "low", "follows", "high"
"""What pieces are called: flat ends, and what is between."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of a law between two values of its argument, which may be infinite.

    Parameters
    ----------
    low, high : float
        Where it begins and ends, in SI.
    level : float or None
        What the law is there, if it is flat.
    """

    low: float
    high: float
    level: float | None


def with_flat_pieces(graph: FlatGraph, paths: Iterable[str]) -> FlatGraph:
    """Return a graph in which flat pieces of the laws of resistors are states of machines.

    Parameters
    ----------
    graph : FlatGraph
    paths : iterable of str
        The resistors. Those that have one already, and those without a flat piece, a value at which
        the law jumps or more than one port stay as they are.

    Returns
    -------
    FlatGraph
        With a machine of the name of each resistor that is cut; the same graph if none is.
    """
    nodes = list(graph.nodes)
    machines = list(graph.machines)
    taken = {m.path for m in machines}
    warnings = []
    for path in sorted(set(paths) - taken):
        node = nodes[graph.by_path[path]]
        pieces = pieces_of(node)
        if not pieces or node.law is None:
            continue
        machine = _machine(node, len(machines), pieces)
        if _ended(node.law.expressions[0], _argument(node)) != node.law.expressions[0]:
            warnings.append(
                f"the law of {path} counts as at its limit within {REACHED:g} of its height"
            )
        nodes[node.index] = replace(node, law=_law(node, machine, pieces))
        machines.append(machine)
    many = len(graph.machines)
    if len(machines) == many:
        return graph
    reference = graph.reference
    if reference is not None:
        reference = (*reference, *(m.start for m in machines[many:]))
    return replace(
        graph,
        nodes=tuple(nodes),
        machines=tuple(machines),
        warnings=(*graph.warnings, *warnings),
        reference=reference,
        written=None,
    )


def pieces_of(node: Node) -> list[Piece]:
    """Return the pieces of a resistor's law in the order of its argument; none if none is flat."""
    law = node.law
    if (
        node.kind not in RESISTORS
        or law is None
        or law.matrix is not None
        or len(law.expressions) != 1
    ):
        return []
    (e,) = law.expressions
    own = _argument(node)
    if node.impulsive or node.controlled or names(e) != {own}:
        return []
    e = _ended(e, own)
    value = _function(e, own)
    slope = _function(differentiate(e, own), own)
    ends = [-math.inf, *sorted(_corners(e, own)), math.inf]
    levels: list[float | None] = []
    for low, high in itertools.pairwise(ends):
        inside = _within(low, high)
        levels.append(value(inside[0]) if all(slope(x) == 0.0 for x in inside) else None)
    begin = next((k for k, a in enumerate(levels) if a != levels[0]), len(levels))
    end = next((k for k in range(len(levels), 0, -1) if levels[k - 1] != levels[-1]), 0)
    if levels[0] is None:
        begin = 0
    if levels[-1] is None:
        end = len(levels)
    if begin >= end or (begin == 0 and end == len(levels)):
        return []
    found = [Piece(ends[begin], ends[end], None)]
    if begin > 0:
        found.insert(0, Piece(-math.inf, ends[begin], levels[0]))
    if end < len(levels):
        found.append(Piece(ends[end], math.inf, levels[-1]))
    return [] if _jumps(found, value) else found


def _ended(e: Expr, own: str) -> Expr:
    """Return a law that reaches the limits that it bends towards: in straight lines at the end."""
    value = _function(e, own)
    corners = _corners(e, own)
    found = e
    for way, op in ((1.0, ">"), (-1.0, "<")):
        outer = way * max((way * x for x in corners), default=0.0)
        far = way * 10.0**MOST
        limit, height = value(far), abs(value(far) - value(outer))
        if not (height > 0.0 and abs(limit - value(0.1 * far)) <= 1e-5 * REACHED * height):
            continue
        near, beyond = outer, far
        while (middle := 0.5 * (near + beyond)) not in (near, beyond):
            if abs(value(middle) - limit) > REACHED * height:
                near = middle
            else:
                beyond = middle
        if near == outer:
            continue  # it jumps there
        rise = (limit - value(outer)) / (near - outer)
        end = near + (limit - value(near)) / rise
        line = If(Compare(op, Name(own), Number(near)), _line(own, near, value(near), rise), found)
        found = If(Compare(op, Name(own), Number(end)), Number(limit), line)
    return found


def _jumps(pieces: list[Piece], value: Callable[[float], float]) -> bool:
    """Whether a law is not one line through its corners, or has no value beside one."""
    most = max(abs(value(_within(p.low, p.high)[0])) for p in pieces)
    for one, other in itertools.pairwise(pieces):
        before = value(math.nextafter(one.high, -math.inf)) if one.level is None else one.level
        behind = value(math.nextafter(other.low, math.inf)) if other.level is None else other.level
        if not abs(behind - before) <= JUMPS * max(most, abs(behind), abs(before)):
            return True
    return False


def _argument(node: Node) -> str:
    assert node.law is not None
    return "law:e" if node.law.output == "f" else "law:f"


def _function(e: Expr, own: str) -> Callable[[float], float]:
    compiled = compile_expression(e, {own: 0}, pre_offset=0)

    def value(x: float) -> float:
        try:
            return float(compiled([x]))
        except (ArithmeticError, ValueError):
            return math.nan

    return value


def _corners(e: Expr, own: str) -> set[float]:
    """Return where an expression has kinks: what is compared changes its sign there."""
    sizes = [10.0 ** (k / PER_DECADE) for k in range(LEAST * PER_DECADE, MOST * PER_DECADE + 1)]
    grid = [*(-x for x in reversed(sizes)), 0.0, *sizes]
    found = set()
    for atom in turning(e):
        compared = _function(atom, own)
        at = [(x, compared(x)) for x in grid]
        for (low, a), (high, b) in itertools.pairwise(at):
            if a == 0.0:
                found.add(low)
            elif a * b < 0.0:
                found.add(_root(compared, low, high))
    return found


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function changes its sign, to the last digit."""
    before = f(low)
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return high if abs(f(high)) <= abs(f(low)) else low
        here = f(middle)
        if here == 0.0:
            return middle
        if here * before > 0.0:
            low = middle
        else:
            high = middle


def _within(low: float, high: float) -> list[float]:
    """Return some values between two."""
    if math.isfinite(low) and math.isfinite(high):
        return [low + part * (high - low) for part in (0.5, 0.03, 0.97)]
    if math.isfinite(low):
        return [low + part * max(abs(low), 1.0) for part in (1.0, 1e-3, 1e3)]
    if math.isfinite(high):
        return [high - part * max(abs(high), 1.0) for part in (1.0, 1e-3, 1e3)]
    return [0.0, -1.0, 1.0]


def _machine(node: Node, index: int, pieces: list[Piece]) -> Machine:
    bond = node.ends[0]
    assert node.law is not None
    read = Name(f"{'e' if node.law.output == 'f' else 'f'}:{bond.bond}")
    plain = node.law.output == "f" or bond.inward
    argument: Expr = read if plain else Neg(read)
    letter = f"{node.path}.{'e' if node.law.output == 'f' else 'f'}"
    written = letter if plain else f"-{letter}"
    rules = []
    for k, (one, other) in enumerate(itertools.pairwise(pieces)):
        for source, target, op, at in ((k, k + 1, ">", one.high), (k + 1, k, "<", other.low)):
            guard = Compare(op, argument, Number(at))
            text = f"{written} {op} {at:.9g}"
            rules.append(Rule(source, target, guard, text, ((letter, read),)))
    states = tuple(_named(p) for p in pieces)
    start = states.index(FOLLOWS)
    nothing: frozenset[int] = frozenset()
    many = len(states)
    return Machine(
        index,
        node.path,
        states,
        (nothing,) * many,
        start,
        tuple(rules),
        (False,) * many,
        pieces=True,
    )


def _named(piece: Piece) -> str:
    return FOLLOWS if piece.level is None else LOW if math.isinf(piece.low) else HIGH


def _law(node: Node, machine: Machine, pieces: list[Piece]) -> Law:
    """Return the law by the state of its machine."""
    law = node.law
    assert law is not None
    (e,) = law.expressions
    own = _argument(node)
    e = _ended(e, own)
    whole: Expr | None = None
    for k, piece in enumerate(pieces):
        said = _continued(e, own, piece) if piece.level is None else Number(piece.level)
        whole = said if whole is None else If(Name(f"in:{machine.index}:{k}"), said, whole)
    assert whole is not None
    return replace(law, expressions=(whole,))


def _continued(e: Expr, own: str, piece: Piece) -> Expr:
    """Return a law within a piece, in a straight line beyond its corners."""
    value = _function(e, own)
    slope = _function(differentiate(e, own), own)
    inside = _within(piece.low, piece.high)
    straight = {slope(x) for x in inside}
    if len(straight) == 1 and not _bends(e, own, piece):
        (one,) = straight
        at = piece.high if math.isfinite(piece.high) else piece.low
        return simplify(_line(own, at, value(at), one))
    said = e
    for at, op in ((piece.high, ">"), (piece.low, "<")):
        if math.isfinite(at):
            away = _within(piece.low, piece.high)[0]
            near = math.nextafter(at, away)
            rise = slope(near)
            chord = (value(away) - value(near)) / (away - near)
            if not (math.isfinite(rise) and abs(rise) > 1e-3 * abs(chord)):
                rise = chord
            said = If(Compare(op, Name(own), Number(at)), _line(own, at, value(near), rise), said)
    return said


def _bends(e: Expr, own: str, piece: Piece) -> bool:
    return any(piece.low < x < piece.high for x in _corners(e, own))


def _line(own: str, at: float, level: float, rise: float) -> Expr:
    away = Binary("-", Name(own), Number(at))
    return Binary("+", Number(level), Binary("*", Number(rise), away))
