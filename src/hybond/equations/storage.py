"""Storage laws of a graph: co-energy variables, stiffness, energy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.slots import Slots
from hybond.equations.tableau import stiffness, stored_names
from hybond.errors import ModelError
from hybond.model.expressions import compile_expression, substitute
from hybond.model.graph import FlatGraph, Storage

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Closure = Callable[[Sequence[float]], float]


@dataclass(slots=True)
class StorageLaws:
    """``z = dH/dx`` for all storage ports.

    Parameters
    ----------
    matrix : array, shape (n, n)
        Of the linear storages; zero rows for the others.
    bond, sign : arrays, shape (n,)
        Of each stored quantity: which bond variable is its rate, among efforts then flows, and
        with which sign: ``x' = sign * w[bond]``.
    """

    matrix: Matrix
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

    @staticmethod
    def of(graph: FlatGraph, slots: Slots) -> StorageLaws:
        """Read the laws of `graph`."""
        n = len(graph.storages)
        bonds = len(graph.bonds)
        matrix = np.zeros((n, n))
        bond = np.zeros(n, dtype=np.intp)
        sign = np.ones(n)
        laws: list[tuple[int, Closure]] = []
        slopes: list[tuple[int, int, Closure]] = []
        groups: dict[int, list[int]] = {}
        ports: dict[int, list[Storage]] = {}
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
                for t in siblings:
                    matrix[s.index, t.index] = node.law.matrix[s.port][t.port]
                continue
            groups.setdefault(s.node, []).append(s.index)
            law = substitute(node.law.expressions[s.port], stored_names(node, graph))
            laws.append((s.index, compile_expression(law, slots.index, pre_offset=slots.size)))
            for t in siblings:
                d = stiffness(node, s.port, t.port, graph)
                f = compile_expression(d, slots.index, pre_offset=slots.size)
                slopes.append((s.index, t.index, f))
        return StorageLaws(
            matrix,
            bond,
            sign,
            laws,
            slopes,
            [tuple(g) for g in groups.values()],
            np.array([graph.bonds[s.bond].domain.pseudo for s in graph.storages], dtype=bool),
            slots.x.start,
            2 * slots.size,
        )

    @property
    def linear(self) -> bool:
        """Whether all storage laws are linear."""
        return not self.laws

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
        z = self.matrix @ x
        if self.laws:
            v = self._values(x)
            for k, f in self.laws:
                z[k] = f(v)
        return np.asarray(z)

    def stiffness(self, x: Vector) -> Matrix:
        """Return dz/dx, shape (n, n)."""
        if not self.laws:
            return self.matrix
        m = self.matrix.copy()
        v = self._values(x)
        for i, j, f in self.slopes:
            m[i, j] = f(v)
        return m

    def energy(self, x: Vector) -> float:
        """Return the stored energy, J; that of a nonlinear storage is counted from x = 0.

        Storage on pseudo bonds has none: effort times flow is no power there.
        """
        total = float(self.linear_energy(x))
        for group in self.groups:
            if not self.pseudo[list(group)].any():
                total += self._along(x, group)
        return total

    def linear_energy(self, x: Vector) -> Vector:
        """Return the energy of linear storage, J, for states of shape (..., n): shape (...)."""
        true = np.where(self.pseudo, 0.0, x)
        return np.asarray(0.5 * ((true @ self.matrix) * true).sum(axis=-1))

    def stored(self, z: Vector, k: int, graph: FlatGraph) -> float:
        """Return the stored quantity of port k at the co-energy values `z` of its storage.

        Raises
        ------
        ModelError
            HB-M166 if the law cannot be inverted there.
        """
        node = graph.storages[k].node
        ports = [s.index for s in graph.storages if s.node == node]
        law = graph.nodes[node].law
        if law is not None and law.matrix is not None:
            x = np.linalg.solve(np.array(law.matrix), z[ports])
            return float(x[ports.index(k)])
        x = np.zeros(len(z))
        for _ in range(100):
            error = (self.co_energy(x) - z)[ports]
            slope = self.stiffness(x)[np.ix_(ports, ports)]
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

    def _along(self, x: Vector, group: tuple[int, ...]) -> float:
        """Integrate ``z dx`` from 0 along a ray; the law has an energy, so any path will do."""
        from scipy.integrate import quad

        laws = [f for k, f in self.laws if k in group]
        ends = x[list(group)].tolist()
        v = [0.0] * self.size

        def power(a: float) -> float:
            for k, b in zip(group, ends, strict=True):
                v[self.offset + k] = a * b
            return float(sum(f(v) * b for f, b in zip(laws, ends, strict=True)))

        value, _ = quad(power, 0.0, 1.0, epsabs=0.0, epsrel=1e-13, limit=200)
        return float(value)
