"""Time derivatives of signals along a run, from its equations and not from differences.

Within a segment of a linear mode all bond variables are a matrix times co-energy variables,
source values and source rates; so are their derivatives, times the derivatives of these, which
the rates of storage give in turn. In a nonlinear mode the first derivative is a central
difference along the motion, higher ones are not available (NaN).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import partial_time, rate_name
from hybond.model.expressions import (
    Expr,
    Name,
    Number,
    differentiate,
    names,
    posterior_names,
    prior_names,
    simplify,
    substitute,
)
from hybond.result import Result
from hybond.runs.trace import Segment

Array = NDArray[np.float64]
ROOTS = ("e:", "f:", "x:", "s:")
STEP = 1e-4
"""Of the mean accepted step, of the segment or the run: the distance of a central difference."""


def affine_parts(e: Expr) -> tuple[dict[str, float], Expr] | None:
    """Return slopes by name and the rest, if `e` is affine in bonds and states, slopes constant.

    Examples
    --------
    >>> from hybond.model.expressions import Binary, Name, Number
    >>> affine_parts(Binary("+", Binary("*", Number(2.0), Name("e:0")), Name("time")))
    ({'e:0': 2.0}, Name(path='time'))
    """
    if prior_names(e):
        return None
    slopes: dict[str, float] = {}
    roots = sorted(n for n in posterior_names(e) if n.startswith(ROOTS))
    for name in roots:
        slope = differentiate(e, name)
        if not isinstance(slope, Number):
            return None
        slopes[name] = slope.value
    rest = simplify(substitute(e, {n: Number(0.0) for n in roots})) if roots else e
    return slopes, rest


class Motion:
    """The motion at some instants of one segment.

    Parameters
    ----------
    t : array, shape (m,)
    """

    def __init__(self, run: Result, segment: Segment, t: Array) -> None:
        self.run = run
        self.graph = run.graph
        self.segment = segment
        self.t = t
        self.signals = run.signals
        bonds = range(len(self.graph.bonds))
        self._bonds: list[Expr] = [Name(f"{kind}:{b}") for kind in "ef" for b in bonds]
        linear = all(self._matrix(s.node) is not None for s in self.graph.storages)
        self._sources = self.signals.sources(segment) if linear else None
        self._w: dict[int, Array] = {0: np.array(self.signals.of(segment, self._bonds, t))}

    def value(self, e: Expr) -> Array:
        """Return an expression in canonical names, shape (m,)."""
        return self.signals.of(self.segment, [e], self.t)[0]

    def derivative(self, e: Expr, order: int) -> Array:
        """Return a derivative of an expression along the motion, NaN where it has none here."""
        if order == 0:
            return self.value(e)
        parts = affine_parts(e)
        if parts is None:
            return self._chain(e) if order == 1 else np.full(self.t.shape, np.nan)
        slopes, rest = parts
        total = self._in_time(rest, order)
        for name, c in slopes.items():
            total = total + c * self._variable(name, order)
        return total

    def _in_time(self, e: Expr, order: int) -> Array:
        """Differentiate what reads time and inputs only; inputs are piecewise linear."""
        for _ in range(order):
            if e == Number(0.0):
                break
            e = partial_time(e, self.graph)
        return self.value(e)

    def _chain(self, e: Expr) -> Array:
        total = self.value(partial_time(e, self.graph))
        for name in sorted(n for n in posterior_names(e) if n.startswith(("e:", "f:"))):
            total = total + self.value(differentiate(e, name)) * self._variable(name, 1)
        return total

    def _variable(self, name: str, order: int) -> Array:
        kind, _, index = name.partition(":")
        k = int(index)
        if kind == "x":
            return np.asarray(self._rates(order)[k])
        if kind == "s":
            return self.derivative(self.graph.integrals[k].rate, order - 1)
        if self._sources is None and name in self._co_energy:
            # exact where a difference would not be
            sign, storage = self._co_energy[name]
            return np.asarray(sign * self._co_energies(order)[storage])
        return np.asarray(self.bonds(order)[k + (len(self.graph.bonds) if kind == "f" else 0)])

    def _matrix(self, node: int) -> tuple[tuple[float, ...], ...] | None:
        law = self.graph.nodes[node].law
        return None if law is None else law.matrix

    def _rates(self, order: int) -> Array:
        """Return a derivative of what is stored, shape (storages, m)."""
        w = self.bonds(order - 1)
        bonds = len(self.graph.bonds)
        found = [
            s.sign * w[bonds + s.bond] if s.kind == "C" else w[s.bond] for s in self.graph.storages
        ]
        return np.array(found).reshape(len(found), len(self.t))

    def _co_energies(self, order: int) -> Array:
        """Return a derivative of co-energy variables, power inward; zero where a law bends."""
        rates = self._rates(order)
        found = np.zeros_like(rates)
        for node, own in groupby(self.graph.storages, key=lambda s: s.node):
            matrix = self._matrix(node)
            ports = list(own)
            for s in ports if matrix is not None else ():
                assert matrix is not None
                found[s.index] = sum(matrix[s.port][o.port] * rates[o.index] for o in ports)
        return found

    @cached_property
    def _co_energy(self) -> dict[str, tuple[float, int]]:
        """Bond variables that are the co-energy variable of linear storage, with their sign."""
        found: dict[str, tuple[float, int]] = {}
        for s in self.graph.storages:
            law = self.graph.nodes[s.node].law
            if law is None or law.matrix is None:
                continue
            kind, sign = ("e", 1.0) if s.kind == "C" else ("f", float(s.sign))
            found[f"{kind}:{s.bond}"] = (sign, s.index)
            bond = self.graph.bonds[s.bond]
            for at in (bond.tail, bond.head):
                node = self.graph.nodes[at]
                if node.kind == ("0" if s.kind == "C" else "1"):
                    found.update({f"{kind}:{end.bond}": (sign, s.index) for end in node.ends})
        return found

    def bonds(self, order: int) -> Array:
        """Return a derivative of all bond variables, shape (2 * bonds, m)."""
        if order not in self._w:
            if self._sources is not None:
                self._w[order] = self._linear(*self._sources, order)
            elif order == 1:
                self._w[order] = self._difference
            else:
                self._w[order] = np.full_like(self._w[0], np.nan)
        return self._w[order]

    def _linear(self, sources: Sequence[Expr], rated: Sequence[bool], order: int) -> Array:
        nothing = np.zeros(self.t.shape)
        known = [
            *self._co_energies(order),
            *(self.derivative(e, order) for e in sources),
            *(
                self.derivative(e, order + 1) if asked else nothing
                for e, asked in zip(sources, rated, strict=True)
            ),
        ]
        return self.signals.by_knowns(self.segment, np.array(known).reshape(-1, len(self.t)))

    @cached_property
    def _difference(self) -> Array:
        t, run, graph = self.segment.t, self.run, self.graph
        steps = sum(len(s.t) for s in run.segments)
        # a segment between two events may be arbitrarily short: then as in the rest of the run
        h = STEP * max(float(t[-1] - t[0]) / max(len(t) - 1, 1), run.t_end / max(steps, 1))
        state = [Name(f"x:{s.index}") for s in graph.storages]
        state += [Name(f"s:{i.index}") for i in graph.integrals]
        moves = [rate_name(s) for s in graph.storages] + [i.rate for i in graph.integrals]
        both = self.signals.of(self.segment, [*state, *moves], self.t)
        y, rate = np.array(both).reshape(2, len(state), len(self.t))
        ahead, behind = (
            np.array(self.signals.at(self.segment, self._bonds, self.t + d, (y + d * rate).T))
            for d in (h, -h)
        )
        return np.asarray((ahead - behind) / (2.0 * h))


def numbered(e: Expr, values: Mapping[str, float]) -> Expr:
    """Put values of parameters in a formula."""
    known = {n: Number(values[n]) for n in sorted(names(e)) if n.startswith("p:") and n in values}
    return simplify(substitute(e, known)) if known else e
