"""`Combined`: motion on switching surfaces, a combination of the modes between which it slides.

Filippov's equivalent motion. On the surfaces ``g_1 = 0, ..., g_k = 0`` the modes around give the
fields ``f_c``, and the motion is ``y' = sum_c coefficient_c f_c`` with weights ``lambda_j`` in
[0, 1] such that ``dg_i/dt = 0`` for all i:

* *additive*, where the switches act independently of each other (``f_11 - f_10 - f_01 + f_00 =
  0``): ``y' = f_0 + sum_j lambda_j (f_j - f_0)``, f_j having only machine j above its surface;
  one linear system of k equations from k + 1 fields;
* *product*, otherwise: all 2^k fields with the products of ``lambda_j`` and ``1 - lambda_j``
  (the multilinear combination), by Newton's method. It is a choice, and recorded as such.

Every bond variable is the same combination: the average of an infinitely fast switching. The
powers that meters read are averaged as powers, so that energy still balances. Modes that hold
stored quantities to different constraints are kept to all of them (`programs.common_space`).

Source: Filippov, *Differential equations with discontinuous righthand sides*, 1988; the product
form after Alexander & Seidman 1998 and Dieci & Lopez 2011.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.combinations import Kind
from hybond.equations.mode import ModeEquations, Solution
from hybond.equations.surfaces import Rates, Surface
from hybond.errors import NumericsError
from hybond.model.expressions import Expr, names
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.programs.blend import Blend, averaged, margins_of, solved
from hybond.programs.common_space import CommonSpace
from hybond.programs.program import Field, Program

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

KEPT = 256
"""Points whose combination is remembered: the weights are asked for where the motion was."""
AGREES = 1e-9
"""Parts give a switching function one value up to this part of what it reads: they are solved."""
NEWTON_STEPS = 30
STILL = 1e-14
"""Weights are of order one: a step of Newton's method below this is rounding, and the last."""
SOLVED = 1e-9
"""Weights are taken if the last of all steps was below this: it need not come to rounding."""
_STENCIL = ((1, 45.0 / 60.0), (2, -9.0 / 60.0), (3, 1.0 / 60.0))
"""Central difference of order six."""


@dataclass(slots=True)
class Combined(ModeEquations):
    """The equations of sliding on some surfaces; evaluates like those of one mode.

    What concerns jumps (constraints, structure) is that of the mode shown; where the parts do not
    agree on it, `common` has the constraints of all.
    """

    program: Program = field(default=None, repr=False)  # type: ignore[assignment]
    interval: Interval = field(default=None, repr=False)  # type: ignore[assignment]
    surfaces: tuple[Surface, ...] = ()
    kind: Kind = "additive"
    corners: list[tuple[int, ...]] = field(default_factory=list)
    """Of each part, which machines are above their surface."""
    parts: list[ModeEquations] = field(default_factory=list)
    laws: list[Rates | None] = field(default_factory=list)
    plain: list[object] = field(default_factory=list)
    common: CommonSpace | None = None
    """What the parts hold stored quantities to, if not all to the same."""
    branch: Callable[[Mode], Mode] = field(default=lambda mode: mode, repr=False)
    """What gives a mode the branches of its junction laws."""
    last: Vector | None = None
    memo: OrderedDict[tuple[float, ...], Blend] = field(default_factory=OrderedDict)

    @property
    def linear(self) -> bool:
        """Never one matrix product: the weights depend on the state."""
        return False

    # -- one point

    def blend(self, v: Sequence[float]) -> Blend:
        """Return the combination at the time, state and inputs in `v`."""
        key = (v[0], *v[self.slots.s], *v[self.slots.x])
        found = self.memo.get(key)
        if found is None:
            found = self._blend(list(v))
            self.memo[key] = found
            if len(self.memo) > KEPT:
                self.memo.popitem(last=False)
        return found

    def part_rates(self, v: list[float], *, kept: bool = True) -> tuple[list[Vector], Matrix]:
        """Return the bond variables of each part, and its ``y'`` as a row.

        Parts with constraints of their own are `kept` to those of all, by vanishing impulses.
        """
        program = self.program
        nx, ns = program.nx, program.ns
        solutions = []
        rates = np.empty((len(self.parts), nx + ns + 2))
        for row, part in zip(rates, self.parts, strict=True):
            w, row[:nx] = self.part(part, v, kept=kept)
            solutions.append(w)
            if ns:
                row[nx : nx + ns] = program.rates(v)
            row[nx + ns :] = program.meter.read(w)
        program.set_mode(v, self.mode)
        return solutions, rates

    def part(
        self, part: ModeEquations, v: list[float], *, kept: bool = True
    ) -> tuple[Vector, Vector]:
        """Return bond variables of a mode, written into `v`, and the rates of what is stored."""
        self.program.set_mode(v, part.mode)
        x = np.array(v[self.slots.x])
        w = part.solve(v, x)
        rates = np.asarray(part.storage.rates_of(w))
        if self.common is not None and kept:
            w, rates = self.common.kept(v, x, w, rates)
            v[self.slots.w] = w.tolist()
        return w, rates

    def surface_rates(self, v: list[float], rates: Matrix) -> Matrix:
        """Return ``dg_i/dt`` along each part's field, shape (k, parts)."""
        nx, ns = self.program.nx, self.program.ns
        found = np.empty((len(self.surfaces), len(rates)))
        for i, law in enumerate(self.laws):
            if law is not None:
                found[i] = law.along(v, rates[:, :nx], rates[:, nx : nx + ns])
            else:
                found[i] = [self._along(i, v, row) for row in rates]
        return found

    def switching(self, v: Sequence[float]) -> Vector:
        """Return the switching functions at the time and state in `v`, shape (k,)."""
        return np.array(
            [
                law.value(v) if law is not None else self._output(i, list(v))
                for i, law in enumerate(self.laws)
            ]
        )

    def _output(self, i: int, v: list[float], part: int = 0) -> float:
        """Return a switching function that reads bond variables, as one part gives it."""
        equations = self.parts[part]
        self.program.set_mode(v, equations.mode)
        equations.solve(v, np.array(v[self.slots.x]))
        return float(self.plain[i](v))  # type: ignore[operator]

    def outputs_agree(self, v: Sequence[float]) -> list[bool]:
        """Return for each surface whether all parts give its function the same value."""
        found = []
        for i, law in enumerate(self.laws):
            if law is not None:
                found.append(True)
                continue
            values = [self._output(i, list(v), k) for k in range(len(self.parts))]
            w = np.array(self.part_rates(list(v))[0])
            read = [n for n in names(self.surfaces[i].g) if n.startswith(("e:", "f:"))]
            columns = [self.slots.index[n] - self.slots.w.start for n in read]
            size = float(np.abs(w[:, columns]).max(initial=0.0)) + max(abs(a) for a in values)
            found.append(max(values) - min(values) <= AGREES * size)
        return found

    def _along(self, i: int, v: list[float], rate: Vector) -> float:
        """Differentiate a switching function along a field numerically."""
        nx, ns = self.program.nx, self.program.ns
        y = np.array([*v[self.slots.x], *v[self.slots.s]])
        speed = float(np.linalg.norm(rate[: nx + ns]))
        size = float(np.linalg.norm(y))
        h = 1e-3 * (size or 1.0) / speed if speed > 0.0 else 1e-3
        total = 0.0
        for k, c in _STENCIL:
            for sign in (1.0, -1.0):
                there = list(v)
                moved = y + sign * k * h * rate[: nx + ns]
                self.program.set_time(there, v[0] + sign * k * h, self.interval)
                there[self.slots.x], there[self.slots.s] = moved[:nx].tolist(), moved[nx:].tolist()
                total += sign * c * self._output(i, there)
        return total / h

    def _blend(self, v: list[float]) -> Blend:
        solutions, rates = self.part_rates(v)
        slopes = self.surface_rates(v, rates)
        n = rates.shape[1] - 2
        if self.kind == "additive":
            base, change = slopes[:, 0], slopes[:, 1:] - slopes[:, :1]
            weights = solved(change, -base, self._nowhere(v))
            coefficients = np.concatenate([[1.0 - weights.sum()], weights])
            directions = rates[1:, :n] - rates[0, :n]
        else:
            weights = self._product(slopes, v)
            coefficients = self._products(weights)
            by = self._product_slopes(weights)
            change, directions = slopes @ by, (by.T @ rates)[:, :n]
        return Blend(
            weights,
            coefficients,
            averaged(coefficients, np.array(solutions)),
            averaged(coefficients, rates),
            change,
            directions,
            solutions,
            None if self.common is None else self._pushes(v, weights),
        )

    def _pushes(self, v: list[float], weights: Vector) -> Matrix:
        """Return how fast each surface is approached from its two sides, jumps left out."""
        slopes = self.surface_rates(v, self.part_rates(v, kept=False)[1])
        found = np.ones((2, len(weights)))
        for j in range(len(weights)):
            speeds = []
            for side in (0.0, 1.0):
                there = weights.copy()
                there[j] = side
                if self.kind == "additive":
                    c = np.concatenate([[1.0 - there.sum()], there])
                else:
                    c = self._products(there)
                speeds.append(float(slopes[j] @ c))
            size = abs(speeds[0]) + abs(speeds[1])
            if size > 0.0:
                found[:, j] = speeds[0] / size, -speeds[1] / size
        return found

    def _nowhere(self, v: Sequence[float]) -> NumericsError:
        where = ", ".join(s.text for s in self.surfaces)
        return NumericsError(
            f"no combination of the modes stays on {where} at t = {v[0]:.9g} s",
            code="HB-N405",
            where=self.graph.mode_text(self.mode),
            hint="the surfaces touch or the switches cancel there; give the guards a hysteresis",
        )

    # -- the product combination

    def _products(self, weights: Vector) -> Vector:
        up = np.array(self.corners, dtype=float)
        return np.asarray(np.prod(up * weights + (1.0 - up) * (1.0 - weights), axis=1))

    def _product_slopes(self, weights: Vector) -> Matrix:
        """Return the derivatives of the coefficients, shape (parts, k)."""
        up = np.array(self.corners, dtype=float)
        factors = up * weights + (1.0 - up) * (1.0 - weights)
        found = np.empty_like(factors)
        for j in range(factors.shape[1]):
            rest = np.delete(factors, j, axis=1).prod(axis=1)
            found[:, j] = (2.0 * up[:, j] - 1.0) * rest
        return found

    def _product(self, slopes: Matrix, v: Sequence[float]) -> Vector:
        k = len(self.surfaces)
        start = self.last if self.last is not None else np.full(k, 0.5)
        for weights in (start, np.full(k, 0.5)):
            for _ in range(NEWTON_STEPS):
                residual = slopes @ self._products(weights)
                step = solved(slopes @ self._product_slopes(weights), residual, self._nowhere(v))
                weights = weights - step
                if np.abs(step).max() <= STILL:
                    break
            if np.abs(step).max() <= SOLVED and np.abs(weights - 0.5).max() <= 2.0:
                self.last = weights
                return weights
        raise self._nowhere(v)

    # -- what executive, locator and result ask of a mode's equations

    def solve(self, v: list[float], x: Vector) -> Vector:
        """Return the averaged bond variables, and write them into `v`."""
        v[self.slots.x] = x.tolist()
        w = self.blend(v).w
        v[self.slots.w] = w.tolist()
        return w

    def solution(self, v: list[float], x: Vector) -> Solution:
        """Return the averages with the size of their terms and their freedom."""
        w = self.solve(v, x)
        coefficients = np.abs(self.blend(v).coefficients)
        size, freedom = np.abs(w), [np.zeros((len(w), 0))]
        for c, part in zip(coefficients, self.parts, strict=True):
            own = part.solution(list(v), x)
            size = np.maximum(size, c * own.size)
            freedom.append(own.freedom)
        return Solution(w, size, np.hstack(freedom))

    def onto(self, t: float, y: Vector) -> Vector:
        """Return the state put back on the surfaces, along the fields that hold it there."""
        program = self.program
        n = program.nx + program.ns
        for _ in range(3):
            if self.common is not None:
                nx = program.nx
                y = np.concatenate([self.common.onto(self._at(t, y), y[:nx]), y[nx:]])
            v = self._at(t, y)
            off = self.switching(v)
            if not off.any():
                break
            here = self.blend(v)
            back = solved(here.slopes, off, self._nowhere(v)) @ here.directions
            moved = y[:n] - back
            if np.array_equal(moved, y[:n]):
                break
            y = np.concatenate([moved, y[n:]])
        return y

    def margins(self, v: Sequence[float]) -> Matrix:
        """Return how far the motion is from leaving each surface, below and above, shape (2, k)."""
        return margins_of(self.blend(v))

    def margins_at(self, columns: Sequence[Vector]) -> NDArray[np.float64]:
        """Return the margins at many points, given by columns of values; nan where none hold.

        Shape (2, k, points).
        """
        slots = self.slots
        rows = [columns[0], *columns[slots.s], *columns[slots.x]]
        found = np.full((2, len(self.surfaces), len(columns[0])), np.nan)
        for k, key in enumerate(zip(*(r.tolist() for r in rows), strict=True)):
            known = self.memo.get(key)
            if known is None:
                try:
                    known = self.blend([float(c[k]) for c in columns])
                except NumericsError:
                    continue
            found[:, :, k] = margins_of(known)
        return found

    # -- what results ask

    def _at(self, t: float, y: Vector) -> list[float]:
        nx, ns = self.program.nx, self.program.ns
        return self.program.values(t, self.interval, self.mode, y[:nx], y[nx : nx + ns])

    def shares(self, t: float, y: Vector) -> list[tuple[float, Mode]]:
        """Return the part of the time spent in each mode that is combined."""
        c = self.blend(self._at(t, y)).coefficients
        return [(float(a), part.mode) for a, part in zip(c, self.parts, strict=True)]

    def switched(self, e: Expr) -> bool:
        """Whether an expression reads what the sliding machines switch."""
        flags = set()
        for s in self.surfaces:
            machine = self.graph.machines[s.machine]
            flags |= {f"in:{s.machine}:{k}" for k in (s.below, s.above)}
            flags |= {f"on:{k}" for k in machine.on[s.below] ^ machine.on[s.above]}
        return bool(flags & names(e))

    def average(self, e: Expr, t: Vector, y: Vector) -> Vector:
        """Return the average of an expression over the modes, each with its own values."""
        f = self.program.compile(e)
        size = self.program.slots.size
        found = np.zeros(len(t))
        for k, (time, state) in enumerate(zip(t.tolist(), y, strict=True)):
            v = self._at(time, state)
            here = self.blend(v)
            for c, w, part in zip(here.coefficients, here.solutions, self.parts, strict=True):
                self.program.set_mode(v, part.mode)
                v[self.slots.w] = w.tolist()
                v[size:] = v[:size]
                found[k] += c * float(f(v))
        return found

    def each(self, t: Vector, y: Vector) -> Matrix:
        """Return the bond variables of every mode at every point, shape (2 * bonds, points)."""
        return np.array(
            [
                w
                for time, state in zip(t.tolist(), y, strict=True)
                for w in self.blend(self._at(time, state)).solutions
            ]
        ).T

    def motion(self) -> Field:
        """Return ``y' = field(t, y)``."""
        program = self.program
        nx, ns = program.nx, program.ns
        v = program.values(0.0, self.interval, self.mode, np.zeros(nx), np.zeros(ns))

        def sliding(t: float, y: Vector) -> Vector:
            program.evaluations += 1
            program.set_time(v, t, self.interval)
            v[self.slots.s], v[self.slots.x] = y[nx : nx + ns].tolist(), y[:nx].tolist()
            try:
                return self.blend(v).rates
            except NumericsError as error:
                program.refused = error
                return np.full(nx + ns + 2, np.nan)

        return sliding
