"""What entering a mode does, as affine maps that the engine itself tells at a few states.

That they are affine is known from the laws of the mode; the engine's answers at as many states as
there are coefficients then give them all, and more states confirm it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.modes.cases import NotAffine
from hybond.analysis.modes.held import Lifted, straight
from hybond.engine.outcome.apart import Apart
from hybond.errors import HybondError
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
    children,
    names,
    simplify,
)
from hybond.model.expressions.tree import transform, with_children
from hybond.model.graph import FlatGraph, Mode
from hybond.model.kinds import TWO_PORTS

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

CHECKED = 2
"""States beyond those needed, at which the maps must be right."""
CLOSE = 1e-7
"""How close, against the largest term."""
CLEAN = 1e-11
"""Coefficients below this part of the largest one of their row are rounding."""


@dataclass(frozen=True)
class Entry:
    """Entering a mode from states ``y``: rows of coefficients of ``y``, then a constant.

    Parameters
    ----------
    after : array, shape (states, states + 1)
        The state after the jump.
    finite, impulse : dict of str to array, shape (states + 1,)
        Parts of each signal after it, by canonical name.
    """

    after: Matrix
    finite: dict[str, Vector]
    impulse: dict[str, Vector]


class Barred(Exception):
    """A mode cannot be entered; the error says why."""

    def __init__(self, error: HybondError) -> None:
        super().__init__(str(error))
        self.error = error


@dataclass
class Entries:
    """What entering modes of a lifted model does; each mode is asked once.

    Parameters
    ----------
    lifted : Lifted
    read : tuple of str
        Canonical names whose values are asked for.
    scale : array, shape (states,)
        Of the states of the lifted model.
    """

    lifted: Lifted
    read: tuple[str, ...]
    scale: Vector
    known: dict[Mode, Entry | Barred | NotAffine] = field(default_factory=dict)

    @cached_property
    def apart(self) -> Apart:
        """What answers."""
        return Apart(self.lifted.graph)

    def of(self, mode: Mode) -> Entry:
        """Return what entering a mode does.

        Raises
        ------
        Barred
        NotAffine
        """
        if mode not in self.known:
            try:
                self.known[mode] = self._made(mode)
            except HybondError as error:
                self.known[mode] = Barred(error)
            except NotAffine as error:
                self.known[mode] = error
        found = self.known[mode]
        if isinstance(found, Entry):
            return found
        raise found

    def _made(self, mode: Mode) -> Entry:
        check_straight(self.lifted.graph, mode)
        start = np.zeros(len(self.scale))
        points = [start, *np.diag(self.scale)]
        # not on any plane of the others, and the same every time
        turns = np.random.default_rng(1).uniform(-1.0, 1.0, (CHECKED, len(start)))
        points += list(turns * self.scale)
        answers = np.array([self._answer(mode, y) for y in points])
        many = len(start) + 1
        base = answers[0]
        slopes = (answers[1:many] - base) / self.scale[:, None]
        rows = np.vstack([slopes, base]).T
        size = np.abs(rows) * np.append(self.scale, 1.0)
        most = np.max(size, axis=1, keepdims=True)
        rows = np.where(size < CLEAN * np.maximum(most, np.abs(base)[:, None]), 0.0, rows)
        for y, got in zip(points[many:], answers[many:], strict=True):
            off = np.abs(rows @ np.append(y, 1.0) - got)
            if np.any(off > CLOSE * (most[:, 0] + np.abs(base))):
                where = self.lifted.graph.mode_text(mode)
                raise NotAffine(f"what is found on entering ({where})")
        n, k = len(start), len(self.read)
        return Entry(
            rows[:n],
            dict(zip(self.read, rows[n : n + k], strict=True)),
            dict(zip(self.read, rows[n + k :], strict=True)),
        )

    def _answer(self, mode: Mode, y: Vector) -> Vector:
        """Return the state after, finite parts and impulses of what is read, in one row."""
        event = self.apart.settled(y, mode)
        step = event.steps[0]
        expressions = [Name(name) for name in self.read]
        finite = self.apart.signals.after(0.0, event.after, mode, expressions)
        impulse = [step.areas.get(name, 0.0) for name in self.read]
        loose = set(step.undetermined) & self._told
        if loose:
            raise NotAffine(f"a guard that reads {', '.join(sorted(loose))}, undetermined here")
        return np.array([*event.after, *finite, *impulse])

    @cached_property
    def _told(self) -> set[str]:
        """What is read, as an event names it."""
        graph = self.lifted.graph
        found = set()
        for name in self.read:
            kind, _, k = name.partition(":")
            if kind in "ef":
                bond = graph.bonds[int(k)]
                ends = (graph.nodes[bond.tail], graph.nodes[bond.head])
                found |= {f'"{bond.name}".{kind}', *(f"{n.path}.{kind}" for n in ends)}
        return found


def check_straight(graph: FlatGraph, mode: Mode) -> None:
    """Raise `NotAffine` unless all laws are affine in a mode."""
    flags = flags_of(graph, mode)
    laws: list[tuple[str, Expr]] = []
    for node in graph.nodes:
        if node.law is None or node.law.matrix is not None:
            continue
        if node.impulsive:
            raise NotAffine(f"the law of {node.path}, which carries impulses,")
        own = [in_mode(e, flags) for e in node.law.expressions]
        if node.kind in TWO_PORTS and any(names(e) for e in own):
            raise NotAffine(f"the modulus of {node.path}")
        laws += [(node.path, e) for e in own]
    laws += [(i.path, in_mode(i.rate, flags)) for i in graph.integrals]
    for path, e in laws:
        if not straight(e):
            raise NotAffine(f"the law of {path}")


def flags_of(graph: FlatGraph, mode: Mode) -> dict[str, bool]:
    """Return what the flags of states and switches are in a mode, by canonical name."""
    on = graph.on_nodes(mode)
    found = {f"on:{n.index}": n.index in on for n in graph.nodes if n.controlled}
    for m in graph.machines:
        for k in range(len(m.states)):
            found[f"in:{m.index}:{k}"] = mode[m.index] == k
    return found


def in_mode(e: Expr, flags: Mapping[str, bool]) -> Expr:
    """Return what an expression is where flags are known.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> str(in_mode(parse("if a and not b then 2*c else d"), {"a": True, "b": False}))
    '2*c'
    """

    def settle(node: Expr) -> Expr:
        match node:
            case Name() if node.path in flags:
                return Bool(flags[node.path])
            case Not(arg=Bool(value)):
                return Bool(not value)
            case And() | Or():
                decides = isinstance(node, Or)
                if Bool(decides) in node.args:
                    return Bool(decides)
                left = tuple(a for a in node.args if not isinstance(a, Bool))
                if not left:
                    return Bool(not decides)
                return left[0] if len(left) == 1 else type(node)(left)
            case If(cond=Bool(value)):
                return node.then if value else node.orelse
            case Binary() | Neg() | Call() | Compare():
                below = children(node)
                plain = tuple(Number(float(b.value)) if isinstance(b, Bool) else b for b in below)
                return with_children(node, plain)
            case _:
                return node

    found = simplify(transform(e, settle))
    return Number(float(found.value)) if isinstance(found, Bool) else found


def read_by(expressions: Iterable[Expr]) -> tuple[str, ...]:
    """Return the signals that expressions read: no flags."""
    found: set[str] = set()
    for e in expressions:
        found |= {n for n in names(e) if not n.startswith(("on:", "in:"))}
    return tuple(sorted(found))
