"""Rates, jumps and signals in one mode, explicit in what is stored, given and modulated."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any

from hybond.equations.calculus import localised
from hybond.equations.derive import state_equations
from hybond.equations.element_parts import sends_impulses
from hybond.equations.peeling import Peeling
from hybond.equations.ring import Row
from hybond.equations.state_form import StateEquations
from hybond.equations.symbolic.rational import Rational
from hybond.equations.symbolic.show import to_expr
from hybond.errors import EquationError, ModelError
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Number,
    Pre,
    differentiate,
    names,
    posterior_names,
    simplify,
    substitute,
    transform,
)
from hybond.model.graph import FlatGraph, Mode
from hybond.model.laws import Law

ONE = -1
"""The column of what stands alone."""


class Form:
    """The mixed-Boolean equations of a graph, and their solution mode by mode.

    Columns of the rows that are returned: `ONE`, or those of the equations.
    """

    def __init__(self, graph: FlatGraph, reference: Mode | None = None) -> None:
        self.eq: StateEquations[Any] = state_equations(graph, reference=reference)
        self.graph = graph
        self.ring = self.eq.ring
        self.n = len(graph.storages)
        self.size = self.n + len(self.eq.kept)
        self._rates: dict[Mode, Peeling[Any] | None] = {}
        self._jumps: dict[Mode, Peeling[Any] | None] = {}

    @cached_property
    def machines(self) -> tuple[int, ...]:
        """The machines that rates depend on; of each row alone if all storage is integral."""
        return tuple(
            sorted({m for row in self.eq.rows for p in row.parts for m in p.space.machines})
        )

    def row_machines(self, row: Any) -> set[int]:
        """Return the machines that a row and what it stands on depend on."""
        own = {m for p in row.parts for m in p.space.machines}
        if any(self._moves(k) for k in row.columns()):
            own |= set(self.machines)
        return own

    def _moves(self, k: int) -> bool:
        """Whether a column is an unknown: a rate, or a variable that was kept."""
        kind, j = self.eq.place.get(k, ("lost", 0))
        return kind in ("rate", "lost") or (kind == "state" and j >= self.n)

    def _known(self, row: Row[Any]) -> Row[Any]:
        """Return a row with unknowns as columns 0 .. size - 1, and all others above."""
        found = {}
        for k, c in row.items():
            kind, j = self.eq.place[k]
            found[
                j if kind == "rate" or (kind == "state" and j >= self.n) else self.size + 1 + k
            ] = c
        return found

    def _back(self, row: Row[Any]) -> Row[Any]:
        return {(ONE if k == self.size else k - self.size - 1): c for k, c in row.items()}

    def void(self, mode: Mode) -> bool:
        """Whether the equations have no solution, or too many, in a mode."""
        return any(space.index(mode) in gaps for space, gaps in self.eq.void)

    def constraint(self, row: Row[Any]) -> bool:
        """Whether a row in one mode has no rate: it fixes what is stored."""
        return not any(map(self._moves, row))

    def rates(self, mode: Mode) -> Peeling[Any] | None:
        """Return the rates in a mode; None if they are not determined."""
        if mode not in self._rates:
            self._rates[mode] = self._solved(mode, jump=False)
        return self._rates[mode]

    def jumps(self, mode: Mode) -> Peeling[Any] | None:
        """Return what stored quantities jump by on entry of a mode."""
        if mode not in self._jumps:
            self._jumps[mode] = self._solved(mode, jump=True)
        return self._jumps[mode]

    def _solved(self, mode: Mode, *, jump: bool) -> Peeling[Any] | None:
        if self.void(mode):
            return None
        rows = []
        for mixed in self.eq.rows:
            row = mixed.at(mode, self.ring)
            if not row:
                return None
            if not self.constraint(row):
                rows.append(
                    {k: c for k, c in self._known(row).items() if k < self.size}
                    if jump
                    else self._known(row)
                )
            else:
                rows.append(self._stepped(row) if jump else self._moved(row))
        solution = Peeling(self.ring, rows, self.size)
        if solution.free() or any(solution.constraints):
            return None
        return solution

    def _stepped(self, row: Row[Any]) -> Row[Any]:
        """Return a constraint at the state after a jump: ``c (x + jump) + ... = 0``."""
        found = self._known(row)
        for k, c in row.items():
            kind, j = self.eq.place[k]
            if kind == "law":
                raise _nonlinear(self.eq, k)
            if kind == "state":
                found[j] = c
        return found

    def _moved(self, row: Row[Any]) -> Row[Any]:
        """Return the time derivative of a constraint."""
        ring = self.ring
        parts: list[tuple[Any, Row[Any]]] = []
        for k, c in row.items():
            kind, j = self.eq.place[k]
            for column, d in self._motion(self._expr(c)):
                # the coefficient moves: times what it multiplies
                if column == self.size:
                    parts.append((ring.read(d), {self.size + 1 + k: ring.one}))
                else:
                    if kind != "state":
                        raise _nonlinear(self.eq, k)
                    parts.append((ring.read(Binary("*", d, Name(f"x:{j}"))), {column: ring.one}))
            if kind == "state":
                parts.append((c, {j: ring.one}))
                continue
            if kind == "law":
                own = self.eq.column(k)
                if own.kind != "storage":
                    raise _nonlinear(self.eq, k)
                formula: Expr = self.eq.storage_law(own.index)
            else:
                formula = self.eq.column(k).formula or Number(0.0)
            for column, d in self._motion(formula):
                parts.append((c * ring.read(d), {column: ring.one}))
        return ring.collect(parts)

    def _motion(self, e: Expr) -> list[tuple[int, Expr]]:
        """Return the time derivative: columns of rates, and what is known, to coefficients."""
        still = transform(e, lambda n: Name("held") if isinstance(n, Pre) else n)
        known: Expr = Number(0.0)
        found: list[tuple[int, Expr]] = []
        for name in sorted(names(still)):
            d = simplify(differentiate(still, name))
            if d == Number(0.0):
                continue
            kind, _, index = name.partition(":")
            match kind:
                case "time":
                    rate: Expr = Number(1.0)
                case "u":
                    rate = Name(f"du:{index}")
                case "s":
                    rate = self.graph.integrals[int(index)].rate
                case "x":
                    found.append((int(index), d))
                    continue
                case _:
                    continue
            known = Binary("+", known, Binary("*", d, rate))
        known = simplify(known)
        return found if known == Number(0.0) else [*found, (self.size, known)]

    def _expr(self, c: Rational) -> Expr:
        return to_expr(c, meaning=self.ring.meaning)

    # -- what a model reads

    def rate(self, storage: int, mode: Mode) -> Row[Any] | None:
        """Return the rate of a stored quantity."""
        solution = self.rates(mode)
        return None if solution is None else self._back(solution.value(storage))

    def jump(self, storage: int, mode: Mode) -> Row[Any] | None:
        """Return what a stored quantity jumps by, in terms of what was stored before."""
        solution = self.jumps(mode)
        return None if solution is None else self._back(solution.value(storage))

    def signal(self, name: str, mode: Mode) -> Row[Any] | None:
        """Return an effort or flow of a bond; None if the mode leaves it open."""
        mixed = self.eq.bond_row(name)
        if self._open(name, mode) or any(p.space.index(mode) in p.void for p in mixed.parts):
            return None
        found = mixed.at(mode, self.ring)
        if any(k not in self.eq.place for k in found):
            return None
        row = self._known(found)
        if any(k < self.size for k in row):
            solution = self.rates(mode)
            if solution is None:
                return None
            row = solution.reduce(row)
        return self._back(row)

    def impulse(self, name: str, mode: Mode) -> Row[Any] | None:
        """Return the impulse of an effort or flow, in columns 0 .. n - 1 of jumps."""
        found = self.eq.bond_row(name).at(mode, self.ring)
        if self.void(mode) or any(k not in self.eq.place for k in found):
            return None
        row = {k: c for k, c in self._known(found).items() if k < self.size}
        if any(k >= self.n for k in row):
            solution = self.jumps(mode)
            if solution is None:
                return None
            row = self._in_jumps(row)
        return row

    def _in_jumps(self, row: Row[Any]) -> Row[Any]:
        if any(k >= self.n for k in row):
            raise ModelError(
                "an impulse goes through a loop that no formula closes in all modes",
                code="HB-E682",
                where=self.graph.name,
                hint="export C, Java or an FMU: they decide it mode by mode",
            )
        return row

    def _open(self, name: str, mode: Mode) -> bool:
        kind, _, index = name.partition(":")
        column = int(index) + (len(self.graph.bonds) if kind == "f" else 0)
        raw = self.eq.form.solution.value(column)
        for region in self.eq.regions:
            if not region.undetermined:
                continue
            k = region.space.index(mode)
            if k < len(region.undetermined) and any(v in raw for v in region.undetermined[k]):
                return True
        return False


def without_impulses(graph: FlatGraph) -> FlatGraph:
    """Return the graph as a jump sees it: sources that read what may have an impulse are zero."""
    nodes = list(graph.nodes)
    changed: dict[int, Expr] = {}
    for node in graph.nodes:
        if node.kind not in ("Se", "Sf") or node.law is None:
            continue
        if sends_impulses(node, localised(node, node.law.expressions)):
            continue
        e = node.law.expressions[0]
        own = "e:" if node.kind == "Se" else "f:"
        read = {n for n in posterior_names(e) if n.startswith(own)}
        if read:
            changed[node.index] = substitute(e, {n: Number(0.0) for n in read})
            nodes[node.index] = replace(
                node, law=Law(node.law.output, (simplify(changed[node.index]),), None)
            )
    if not changed:
        return graph
    before = graph.parametric

    def parametric(index: int) -> Any:
        assert before is not None
        found = before(index)
        if index not in changed:
            return found
        e = found.expressions[0]
        own = "e:" if graph.nodes[index].kind == "Se" else "f:"
        zero = {n: Number(0.0) for n in posterior_names(e) if n.startswith(own)}
        return replace(found, matrix=None, expressions=(simplify(substitute(e, zero)),))

    return replace(graph, nodes=tuple(nodes), parametric=parametric if before else None)


def _nonlinear(eq: StateEquations[Any], column: int) -> EquationError:
    own = eq.column(column)
    name = eq.law_name(column) if eq.place[column][0] == "law" else eq.source_name(column)
    return EquationError(
        f"a mode fixes what is stored through {name}, which is not linear ({own.kind})",
        code="HB-E682",
        where=eq.graph.name,
        hint="make the law linear, or put storage or resistance between",
    )
