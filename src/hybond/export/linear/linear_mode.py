"""All equations of a linear mode in one descriptor: storage, integrals, sources, outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.equations.derive import state_equations
from hybond.equations.state_form import StateEquations
from hybond.errors import EquationError
from hybond.model.expressions import (
    Expr,
    If,
    Number,
    compile_expression,
    differentiate,
    names,
    simplify,
    substitute,
    to_text,
    uses_pre,
)
from hybond.model.expressions.tree import transform
from hybond.model.graph import FlatGraph, Mode

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Extended:
    """``E v' = A v + B u`` with integrals, sources and outputs among the variables."""

    E: Matrix
    A: Matrix
    B: Matrix
    variables: tuple[str, ...]
    """Stored quantities, integrated signals, kept pseudo-states, sources, outputs."""
    stored: int
    """How many of them may be states: stored quantities and integrals."""
    inputs: tuple[str, ...]
    """Every source and every input of the model."""
    default: tuple[int, ...]
    """Those that come from outside."""
    outputs: list[int]
    """Where the outputs stand among the variables."""


def extended(graph: FlatGraph, mode: Mode, outputs: tuple[str, ...]) -> Extended:
    """Return all equations of a mode.

    Raises
    ------
    EquationError
        HB-E671 for what is not linear, HB-Q103 for a nonlinear law, HB-Q105 if the mode leaves a
        variable open.
    """
    for sample in graph.samples:
        raise EquationError(
            f"{sample.path} is sampled: it changes at instants, not with a rate",
            code="HB-E671",
            where=sample.path,
            hint="take the controller out and make what it sets an input of the model",
        )
    for integral in graph.integrals:
        _refuse_pre(integral.rate, integral.path)
    eq = state_equations(graph, symbolic=False).in_mode(mode)
    return _Assembly(graph, mode, eq, outputs).made()


class _Assembly:
    def __init__(
        self, graph: FlatGraph, mode: Mode, eq: StateEquations[Any], outputs: tuple[str, ...]
    ) -> None:
        self.graph, self.mode, self.eq, self.wanted = graph, mode, eq, outputs
        n, m = len(graph.storages), len(graph.integrals)
        kept, p = len(eq.kept), len(eq.sources)
        self.integral0, self.kept0 = n, n + m
        self.source0 = n + m + kept
        self.output0 = self.source0 + p
        self.size = self.output0 + len(outputs)
        self.inputs = (*(i.path for i in graph.inputs), *eq.inputs)
        self.on = graph.on_nodes(mode)
        self.read: set[str] = set()

    def made(self) -> Extended:
        graph, eq = self.graph, self.eq
        rows: list[tuple[Matrix, Matrix, Matrix]] = []
        for mixed in eq.rows:
            e, a, b = self._empty()
            self._add(e, a, mixed.at(self.mode, eq.ring), 1.0)
            rows.append((e, -a, b))
        for integral in graph.integrals:
            e, a, b = self._linear(integral.rate, integral.path)
            e = -e
            e[self.integral0 + integral.index] += 1.0
            rows.append((e, a, b))
        free = []
        for j, column in enumerate(eq.sources):
            formula = eq.column(column).formula
            e, a, b = self._linear(formula or Number(0.0), eq.source_name(column), exogenous=True)
            if not (e.any() or a.any() or b.any()):
                free.append(j)
            a[self.source0 + j] -= 1.0
            b[len(graph.inputs) + j] = 1.0
            rows.append((-e, a, b))
        for j, text in enumerate(self.wanted):
            e, a, b = self._linear(self._signal(text), text)
            a[self.output0 + j] -= 1.0
            rows.append((-e, a, b))
        E, A, B = (np.array([r[k] for r in rows]) for k in range(3))
        variables = (
            *(s.path for s in graph.storages),
            *(i.path for i in graph.integrals),
            *(eq.variable_name(k) for k in eq.kept),
            *(f"source {name}" for name in eq.inputs),
            *self.wanted,
        )
        E, A, B, variables, stored = self._square(E, A, B, variables)
        default = [i.index for i in graph.inputs if f"u:{i.index}" in self.read]
        default += [len(graph.inputs) + j for j in free]
        outputs = [variables.index(name, stored) for name in self.wanted] if self.wanted else []
        return Extended(E, A, B, variables, stored, self.inputs, tuple(default), outputs)

    def _square(
        self, E: Matrix, A: Matrix, B: Matrix, variables: tuple[str, ...]
    ) -> tuple[Matrix, Matrix, Matrix, tuple[str, ...], int]:
        """Drop rows that say nothing in this mode, and variables that nothing reads."""
        rows = (E != 0.0).any(axis=1) | (A != 0.0).any(axis=1)
        if B[~rows].any():
            raise self._open("sources contradict each other")
        columns = (E[rows] != 0.0).any(axis=0) | (A[rows] != 0.0).any(axis=0)
        columns[: self.kept0] = True
        if int(rows.sum()) != int(columns.sum()):
            raise self._open("the equations of this mode do not determine all variables")
        kept = tuple(name for name, k in zip(variables, columns) if k)
        return (
            E[np.ix_(rows, columns)],
            A[np.ix_(rows, columns)],
            B[rows],
            kept,
            self.kept0,
        )

    def _open(self, why: str) -> EquationError:
        return EquationError(
            why,
            code="HB-Q105",
            where=self.graph.mode_text(self.mode),
            hint="hybond analyse tells what is undetermined",
        )

    def _empty(self) -> tuple[Matrix, Matrix, Matrix]:
        return np.zeros(self.size), np.zeros(self.size), np.zeros(len(self.inputs))

    def _signal(self, text: str) -> Expr:
        if text in self.graph.signals:
            return self.graph.signals[text]
        assert self.graph.read is not None
        return self.graph.read(text)

    # -- one expression

    def _linear(
        self, e: Expr, where: str, *, exogenous: bool = False
    ) -> tuple[Matrix, Matrix, Matrix]:
        """Return the coefficients of rates, variables and inputs in an expression."""
        _refuse_pre(e, where)
        rate, state, given = self._empty()
        fixed = self._in_mode(e)
        read = sorted(names(fixed))
        if exogenous and all(_of_time(name) for name in read):
            return rate, state, given  # a function of time alone is what the source is driven by
        for name in read:
            kind, _, index = name.partition(":")
            slope = simplify(differentiate(fixed, name))
            if exogenous and _of_time(name) and all(map(_of_time, names(slope))):
                continue
            if names(slope) or _of_time(name):
                raise _nonlinear(e, where)
            value = float(compile_expression(slope, {}, pre_offset=0)([]))
            k = int(index)
            match kind:
                case "x":
                    state[k] += value
                case "s":
                    state[self.integral0 + k] += value
                case "u":
                    self.read.add(name)
                    given[k] += value
                case _:
                    row = self.eq.bond_row(name).at(self.mode, self.eq.ring)
                    self._add(rate, state, row, value)
        return rate, state, given

    def _in_mode(self, e: Expr) -> Expr:
        """Return an expression with everything discrete at its value in this mode."""
        values: dict[str, Expr] = {}
        for name in names(e):
            kind, *rest = name.split(":")
            match kind:
                case "on":
                    values[name] = Number(float(int(rest[0]) in self.on))
                case "in":
                    values[name] = Number(float(self.mode[int(rest[0])] == int(rest[1])))
        return simplify(transform(substitute(e, values), _decided))

    def _add(self, rate: Matrix, state: Matrix, row: Mapping[int, Any], factor: float) -> None:
        """Add a row of the mode's equations to the coefficients of variables."""
        for k, c in row.items():
            kind, j = self._place(k)
            target = rate if kind == "rate" else state
            target[j] += factor * float(c)

    def _place(self, column: int) -> tuple[str, int]:
        kind, j = self.eq.place[column]
        match kind:
            case "law":
                self.eq.refuse(column)
            case "input":
                return "state", self.source0 + j
            case "state" if j >= len(self.graph.storages):
                return "state", self.kept0 + j - len(self.graph.storages)
        return kind, j


def _decided(e: Expr) -> Expr:
    """Return a choice as the branch that is taken where its condition reads no signal."""
    if isinstance(e, If) and not names(e.cond):
        return e.then if float(compile_expression(e.cond, {}, pre_offset=0)([])) else e.orelse
    return e


def _of_time(name: str) -> bool:
    return name == "time" or name.startswith("at:")


def _refuse_pre(e: Expr, where: str) -> None:
    if uses_pre(e):
        raise EquationError(
            "a law that reads pre() holds at an instant and describes no motion",
            code="HB-E671",
            where=where,
            hint="choose a mode with a field",
        )


def _nonlinear(e: Expr, where: str) -> EquationError:
    return EquationError(
        f"{to_text(e)} is not linear with constant coefficients",
        code="HB-E671",
        where=where,
        hint="make what it reads an input or a parameter, or choose another output",
    )
