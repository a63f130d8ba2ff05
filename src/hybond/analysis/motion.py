"""Time derivatives of signals along a run, from its equations and not from differences.

Within a segment of a linear mode all bond variables are a matrix times co-energy variables,
source values and source rates; so are their derivatives, times the derivatives of these, which
the rates of storage give in turn. In a nonlinear mode the first derivative is a central
difference along the motion, higher ones are not available (NaN).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import partial_time
from hybond.model.expressions import (
    Expr,
    Number,
    differentiate,
    names,
    posterior_names,
    prior_names,
    simplify,
    substitute,
)
from hybond.modes.jump import on_constraints
from hybond.programs.interval import Interval
from hybond.result import Result
from hybond.trace import Segment

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
    run : Result
    segment : Segment
    t : array, shape (m,)
    """

    def __init__(self, run: Result, segment: Segment, t: Array) -> None:
        self.run = run
        self.graph = run.graph
        self.program = run.program
        self.segment = segment
        self.t = t
        assert isinstance(segment.interval, Interval)
        self.interval = segment.interval
        self.equations = self.program.equations(segment.mode, self.interval, float(segment.t[0]))
        self.y = np.array(
            [
                on_constraints(
                    self.program,
                    self.equations,
                    self.interval,
                    float(a),
                    segment.at(float(a)),
                    energy=run.trace.energy,
                )
                for a in t
            ]
        )
        self.v = self.program.evaluate_many(t, self.y, self.interval, self.equations)
        self.linear = self.equations.linear and self.equations.storage.linear
        self._w: dict[int, Array] = {0: self.v[self.program.slots.w]}

    def value(self, e: Expr) -> Array:
        """Return an expression in canonical names, shape (m,)."""
        found = self.program.compile_arrays(e)(list(self.v))
        return np.array(np.broadcast_to(np.asarray(found, dtype=float), self.t.shape))

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
            return np.asarray(self.equations.storage.rates_of(self.bonds(order - 1))[k])
        if kind == "s":
            return self.derivative(self.graph.integrals[k].rate, order - 1)
        if not self.linear and name in self._co_energy:
            # exact where a difference would not be
            sign, storage = self._co_energy[name]
            own = self.equations.storage
            rates = own.rates_of(self.bonds(order - 1))
            return np.asarray(sign * own.matrix.times(rates)[storage])
        return np.asarray(self.bonds(order)[k + (len(self.graph.bonds) if kind == "f" else 0)])

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
            if self.linear:
                self._w[order] = self._linear(order)
            elif order == 1:
                self._w[order] = self._difference
            else:
                self._w[order] = np.full_like(self._w[0], np.nan)
        return self._w[order]

    def _linear(self, order: int) -> Array:
        own = self.equations
        sources = own.tableau.sources
        nz, nu = len(self.graph.storages), len(sources)
        xi = np.zeros((nz + 2 * nu, len(self.t)))
        xi[:nz] = own.storage.matrix.times(own.storage.rates_of(self.bonds(order - 1)))
        needed = own.finite.known.used()
        for k, source in enumerate(sources):
            if needed[nz + k]:
                xi[nz + k] = self.derivative(source.value, order)
            if needed[nz + nu + k]:
                xi[nz + nu + k] = self.derivative(source.value, order + 1)
        w = own.finite.by_knowns(xi)
        return np.asarray(w if own.project is None else own.project @ w)

    @cached_property
    def _difference(self) -> Array:
        field = self.program.field(self.equations, self.interval)
        t, run = self.segment.t, self.run
        steps = sum(len(s.t) for s in run.segments)
        # a segment between two events may be arbitrarily short: then as in the rest of the run
        h = STEP * max(float(t[-1] - t[0]) / max(len(t) - 1, 1), run.t_end / max(steps, 1))
        found = np.empty_like(self._w[0])
        bonds = self.program.slots.w
        for k, (a, y) in enumerate(zip(self.t, self.y, strict=True)):
            rate = field(float(a), y)
            ends = [
                self.program.evaluate(float(a) + d, y + d * rate, self.interval, self.equations)[
                    bonds
                ]
                for d in (h, -h)
            ]
            found[:, k] = (np.array(ends[0]) - np.array(ends[1])) / (2.0 * h)
        return found


def numbered(e: Expr, values: Mapping[str, float]) -> Expr:
    """Put values of parameters in a formula."""
    known = {n: Number(values[n]) for n in sorted(names(e)) if n.startswith("p:") and n in values}
    return simplify(substitute(e, known)) if known else e
