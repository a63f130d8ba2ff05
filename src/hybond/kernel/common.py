"""What the plans of all modes of a graph have in common, made once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybond.engine.tables.guards import magnitude, seen_in_motion
from hybond.equations.calculus import gradient, partial_time
from hybond.kernel.bytecode import Book
from hybond.model.expressions import Expr, Neg
from hybond.model.graph import Machine, Rule
from hybond.programs.program import Program


@dataclass(frozen=True, slots=True)
class Guard:
    """A guard while time passes.

    Parameters
    ----------
    rule : Rule
    test : Expr
    atoms : tuple of Expr
        The differences of its comparisons.
    sizes : tuple of Expr
        What the magnitudes of their terms add up to.
    """

    rule: Rule
    test: Expr
    atoms: tuple[Expr, ...]
    sizes: tuple[Expr, ...]


@dataclass(frozen=True, slots=True)
class Followed:
    """An expression, its derivatives by bond variables, and by time while these are held."""

    e: Expr
    slopes: dict[str, Expr]
    push: Expr


class Common:
    """Expressions that many modes ask for, and their code.

    Expressions are told apart by identity: what is kept here stays the same object.

    Raises
    ------
    Declined
        For an expression that the kernel was not made for.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self.book = Book(program.slots.index, pre_offset=program.slots.size)
        self._guards: dict[int, Guard] = {}
        self._wanted: dict[tuple[int, bool], Expr] = {}
        self._followed: dict[int, Followed] = {}
        for _, law, slope in program.storage.expressions:
            self._add((law, slope))
        self._add([signal.rate for signal in program.graph.integrals])

    def guard(self, rule: Rule) -> Guard:
        """Return a guard as it is while time passes."""
        found = self._guards.get(id(rule))
        if found is None:
            test, atoms = seen_in_motion(rule)
            sizes = [magnitude(a) for a in atoms]
            found = self._guards[id(rule)] = Guard(rule, test, tuple(atoms), tuple(sizes))
            self._add((test, *atoms, *sizes))
        return found

    def wanted(self, machine: Machine, on: bool) -> Expr:
        """Return what must be positive for a diode to stay in its branch."""
        assert machine.law is not None
        found = self._wanted.get((machine.index, on))
        if found is None:
            found = machine.law.common if on else Neg(machine.law.net)
            self._wanted[machine.index, on] = found
            self._add((found,))
        return found

    def follow(self, e: Expr) -> Followed:
        """Return the derivatives of an expression that lasts."""
        found = self._followed.get(id(e))
        if found is None:
            push = partial_time(e, self.program.graph)
            found = self._followed[id(e)] = Followed(e, gradient(e), push)
            self._add((push,))
        return found

    def _add(self, expressions: Sequence[Expr]) -> None:
        for e in expressions:
            self.book.add(e)
