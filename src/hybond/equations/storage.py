"""Storage laws of a graph: co-energy variables, stiffness, energy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hybond.equations.kinks import bends
from hybond.equations.slots import Slots
from hybond.equations.sparse import Sparse
from hybond.equations.stored_laws import stiffness, stored_names
from hybond.errors import ModelError
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Neg,
    Number,
    compile_expression,
    substitute,
    turning,
)
from hybond.model.expressions.tree import fold
from hybond.model.graph import FlatGraph, Storage

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Closure = Callable[[Sequence[float]], float]

EXACT = 15
"""Degree up to which the energy of a polynomial law is found without error control."""


@dataclass(slots=True)
class StorageLaws:
    """``z = dH/dx`` for all storage ports.

    Parameters
    ----------
    matrix : Sparse, shape (n, n)
        Of the linear storages; rows without entries for the others.
    bond, sign : arrays, shape (n,)
        Of each stored quantity: which bond variable is its rate, among efforts then flows, and
        with which sign: ``x' = sign * w[bond]``.
    """

    matrix: Sparse
    bond: NDArray[np.intp]
    sign: Vector
    laws: list[tuple[int, Closure]]
    slopes: list[tuple[int, int, Closure]]
    groups: list[tuple[int, ...]]
    """The ports of each nonlinear storage."""
    pseudo: NDArray[np.bool_]
    """Storage ports on pseudo bonds."""
    offset: int
    size: int
    expressions: list[tuple[int, Expr, Expr]]
    """Of each nonlinear port: its law, and its own stiffness."""
    degrees: list[int | None]
    """Of each group: of its laws as polynomials of what is stored; None if they are none."""
    ports: dict[int, list[int]]
    """Of each storage, by node."""
    turning: dict[int, list[Closure]] = field(default_factory=dict)
    """Of each nonlinear port: what changes its sign where its law has a kink."""
    _last: tuple[bytes, float] | None = None
    _law: dict[int, Closure] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Find the laws by port."""
        self._law = dict(self.laws)

    @staticmethod
    def of(graph: FlatGraph, slots: Slots) -> StorageLaws:
        """Read the laws of `graph`."""
        n = len(graph.storages)
        bonds = len(graph.bonds)
        entries: list[tuple[int, int, float]] = []
        bond = np.zeros(n, dtype=np.intp)
        sign = np.ones(n)
        laws: list[tuple[int, Closure]] = []
        slopes: list[tuple[int, int, Closure]] = []
        expressions: list[tuple[int, Expr, Expr]] = []
        groups: dict[int, list[int]] = {}
        ports: dict[int, list[Storage]] = {}
        degrees: dict[int, int | None] = {}
        turns: dict[int, list[Closure]] = {}
        for s in graph.storages:
            ports.setdefault(s.node, []).append(s)
        for s in graph.storages:
            # reversing an arrow reverses the flow into the element, not the effort on it
            if s.kind == "C":
                bond[s.index], sign[s.index] = bonds + s.bond, s.sign
            else:
                bond[s.index] = s.bond
            node = graph.nodes[s.node]
            assert node.law is not None
            siblings = ports[s.node]
            if node.law.matrix is not None:
                own_row = node.law.matrix[s.port]
                entries += [(s.index, t.index, own_row[t.port]) for t in siblings]
                continue
            groups.setdefault(s.node, []).append(s.index)
            law = substitute(node.law.expressions[s.port], stored_names(node, graph, siblings))
            own = polynomial_degree(law)
            before = degrees.get(s.node, 0)
            degrees[s.node] = None if own is None or before is None else max(own, before)
            laws.append((s.index, compile_expression(law, slots.index, pre_offset=slots.size)))
            turns[s.index] = [
                compile_expression(a, slots.index, pre_offset=slots.size) for a in turning(law)
            ]
            for t in siblings:
                d = stiffness(node, s.port, t.port, graph, siblings)
                f = compile_expression(d, slots.index, pre_offset=slots.size)
                slopes.append((s.index, t.index, f))
                if t is s:
                    expressions.append((s.index, law, d))
        rows, columns, values = zip(*entries, strict=True) if entries else ((), (), ())
        return StorageLaws(
            Sparse.of((n, n), rows, columns, values),
            bond,
            sign,
            laws,
            slopes,
            [tuple(g) for g in groups.values()],
            np.array([graph.bonds[s.bond].domain.pseudo for s in graph.storages], dtype=bool),
            slots.x.start,
            2 * slots.size,
            expressions,
            list(degrees.values()),
            {node: [s.index for s in own] for node, own in ports.items()},
            turns,
        )

    @property
    def linear(self) -> bool:
        """Whether all storage laws are linear."""
        return not self.laws

    @property
    def degree(self) -> int | None:
        """The highest degree of all laws, if all are polynomials of no more than `EXACT`."""
        known = [1, *(d for d in self.degrees if d is not None)]
        return max(known) if len(known) > len(self.degrees) and max(known) <= EXACT else None

    def rates_of(self, w: Vector) -> Vector:
        """Return the rates that bond variables `w`, one after the other or as columns, make."""
        taken = w[self.bond]
        return np.asarray(self.sign[:, None] * taken if w.ndim > 1 else self.sign * taken)

    def _values(self, x: Vector) -> list[float]:
        v = [0.0] * self.size
        v[self.offset : self.offset + len(x)] = x.tolist()
        return v

    def co_energy(self, x: Vector) -> Vector:
        """Return z, shape (n,): the effort of each C, the flow of each I, power inward."""
        z = self.matrix.times(x)
        if self.laws:
            v = self._values(x)
            for k, f in self.laws:
                z[k] = f(v)
        return np.asarray(z)

    def coupled(self, x: Vector) -> Vector:
        """Return what the other ports of its field add to each co-energy variable, shape (n,).

        The sum of magnitudes: in a field a co-energy variable may be the difference of large terms.
        """
        m = self.matrix
        other = m.row != m.column
        found = np.zeros(len(x))
        np.add.at(found, m.row[other], np.abs(m.value[other] * x[m.column[other]]))
        if self.coupling:
            v = self._values(x)
            for i, j, f in self.coupling:
                found[i] += abs(f(v) * float(x[j]))
        return found

    @property
    def coupling(self) -> list[tuple[int, int, Closure]]:
        """The slopes of nonlinear laws by what other ports store."""
        return [(i, j, f) for i, j, f in self.slopes if i != j]

    def stiffness(self, x: Vector, ports: Sequence[int] | None = None) -> Matrix:
        """Return dz/dx, shape (n, n), or that of some ports by each other."""
        which = range(len(x)) if ports is None else ports
        m = self.matrix.dense() if ports is None else self.matrix.block(ports)
        if self.slopes:
            place = {k: i for i, k in enumerate(which)}
            v = self._values(x)
            for i, j, f in self.slopes:
                if i in place and j in place:
                    m[place[i], place[j]] = f(v)
        return m

    def own_stiffness(self, x: Vector) -> Vector:
        """Return the derivative of each port's co-energy variable by what it stores itself."""
        found = self.matrix.diagonal()
        if self.slopes:
            v = self._values(x)
            for i, j, f in self.slopes:
                if i == j:
                    found[i] = f(v)
        return found

    def energy(self, x: Vector) -> float:
        """Return the stored energy, J; that of a nonlinear storage is counted from x = 0.

        Storage on pseudo bonds has none: effort times flow is no power there.
        """
        # settling asks for the same state again and again
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            total = float(self.linear_energy(x))
            v = self._values(np.zeros(len(x))) if self.groups else []
            for group, degree in zip(self.groups, self.degrees, strict=True):
                if not any(self.pseudo[k] for k in group):
                    total += self._along(x, group, degree, v)
            self._last = key, total
        return self._last[1]

    def linear_energy(self, x: Vector) -> Vector:
        """Return the energy of linear storage, J, for states of shape (..., n): shape (...)."""
        true = np.where(self.pseudo, 0.0, x)
        return np.asarray(0.5 * (self.matrix.after(true) * true).sum(axis=-1))

    def stored(self, z: Vector, k: int, graph: FlatGraph) -> float:
        """Return the stored quantity of port k at the co-energy values `z` of its storage.

        Raises
        ------
        ModelError
            HB-M166 if the law cannot be inverted there.
        """
        node = graph.storages[k].node
        ports = self.ports[node]
        law = graph.nodes[node].law
        if law is not None and law.matrix is not None:
            x = np.linalg.solve(np.array(law.matrix), z[ports])
            return float(x[ports.index(k)])
        x = np.zeros(len(z))
        for _ in range(100):
            error = (self.co_energy(x) - z)[ports]
            slope = self.stiffness(x, ports)
            step = np.linalg.lstsq(slope, error, rcond=None)[0]
            if not step.any() and error.any():
                # flat at this point (a cubic spring at rest): look aside
                step = -np.sign(error) * 1e-3
            x[ports] -= step
            met = np.abs((self.co_energy(x) - z)[ports]) <= 1e-9 * np.abs(z[ports]).max()
            if met.all() and (np.abs(step) <= 1e-12 * np.abs(x[ports]).max()).all():
                return float(x[k])
        raise ModelError(
            f"no stored quantity gives the start value {z[k]:g}",
            code="HB-M166",
            where=graph.storages[k].path,
            hint="give the stored quantity itself",
        )

    def _along(
        self, x: Vector, group: tuple[int, ...], degree: int | None, v: list[float]
    ) -> float:
        """Integrate ``z dx`` from 0 along a ray; the law has an energy, so any path will do.

        `v` are values to work in.
        """
        laws = [self._law[k] for k in group]
        ends = x[list(group)].tolist()

        def go(a: float) -> None:
            for k, b in zip(group, ends, strict=True):
                v[self.offset + k] = a * b

        def power(a: float) -> float:
            go(a)
            return float(sum(f(v) * b for f, b in zip(laws, ends, strict=True)))

        if degree is not None and degree <= EXACT:
            # Gauss's formula with n points is exact up to degree 2 n - 1
            points, weights = gauss(degree // 2 + 1)
            return sum(w * power(a) for a, w in zip(points, weights, strict=True))
        from scipy.integrate import quad

        def followed(f: Closure) -> Callable[[float], float]:
            def at(a: float) -> float:
                go(a)
                return f(v)

            return at

        # the rule samples: of a spring with play it may see nothing but the play
        ways = bends([followed(f) for k in group for f in self.turning[k]])
        marks = [0.0, *ways, 1.0]
        # a piece without force need not have none to the last bit
        nothing = 1e-15 * max(abs(power(a)) for a in marks)
        pieces = (
            quad(power, low, high, epsabs=nothing, epsrel=1e-13, limit=200)[0]
            for low, high in pairwise(marks)
        )
        return float(sum(pieces))


@cache
def gauss(count: int) -> tuple[list[float], list[float]]:
    """Return points and weights of Gauss's formula on [0, 1]."""
    if count == 1:
        return [0.5], [1.0]
    points, weights = np.polynomial.legendre.leggauss(count)
    return (0.5 * (points + 1.0)).tolist(), (0.5 * weights).tolist()


def polynomial_degree(e: Expr) -> int | None:
    """Return the degree of an expression as a polynomial of all its names; None if it is none.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> polynomial_degree(parse("1000*q + 2*q^3")), polynomial_degree(parse("q/3 - q*p"))
    (3, 2)
    >>> polynomial_degree(parse("sin(q)")) is None
    True
    """

    def of(node: Expr, _: bool, below: list[int | None]) -> int | None:
        known = [d for d in below if d is not None]
        if len(known) < len(below):
            return None
        match node:
            case Number():
                return 0
            case Name():
                return 1
            case Neg():
                return known[0]
            case Binary(op="+" | "-"):
                return max(known)
            case Binary(op="*"):
                return sum(known)
            case Binary(op="/"):
                return known[0] if known[1] == 0 else None
            case Binary(op="^", right=Number(value)) if value in range(1, EXACT + 1):
                return known[0] * int(value)
        return None

    return fold(e, of)
