"""Radau IIA of order 5 for stiff modes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from hybond.engine.outcome.polynomial import Polynomial
from hybond.solvers.base import (
    FloatArray,
    Scale,
    State,
    Step,
    StepFailure,
    Twinned,
    first_not_finite,
)
from hybond.solvers.collocation import C1, C2, collocation, continued
from hybond.solvers.control import first_step, worst_component
from hybond.solvers.dense import Joined
from hybond.solvers.newton import ITERATIONS, Choice, Factors, Stages, norm, solve_stages

Jacobian: TypeAlias = Callable[[float, FloatArray], FloatArray]

_EPS = float(np.finfo(np.float64).eps)

# Size of the next step: after Hairer and Wanner, IV.8, with Gustafsson's prediction.
_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 8.0
_SMALLEST_ERROR = 1e-2
_KEEP = 1.2
"""Growth below which a step of the old size, with its factors, is the cheaper one."""

_ENOUGH = 0.001
"""Part of the tolerance that Newton's iteration may leave; what it leaves adds up over steps."""

_FRESH = 0.05
"""Last correction, in units of the tolerance, up to which quadratures take it for nothing."""

_SLOW = 1e-3
"""Rate of convergence, over more than two iterations, that asks for a new Jacobian."""


class _Memory(NamedTuple):
    """What one step leaves to the next."""

    jacobian: FloatArray | None = None
    current: bool = False
    """Whether `jacobian` was made at the start of the step to come."""
    left: float = 1.0
    """`Stages.left` of the last iteration that converged."""
    coefficients: FloatArray | None = None
    """Collocation polynomial to foresee the stages by, and the step it belongs to."""
    span: float = 1.0
    origin: float = 1.0
    """1 if that step ends where the next one starts, 0 if it starts there."""
    h: float = 0.0
    """Size of the last step whose size the error decided; 0 without one."""
    error: float = 0.0


class RadauIIA(Twinned):
    """Implicit Runge-Kutta, order 5, L-stable, adaptive; dense output of order 3.

    The dense output is the collocation polynomial. Jacobian and factors of the linear systems
    are kept over steps for as long as Newton's iteration converges fast with them.

    A component of infinite scale is a quadrature: nothing may depend on it. It is integrated
    with the weights of the method, from the stages of the others, and has no part in the
    linear algebra.

    Parameters
    ----------
    scale : callable
        ``scale(y0, y1)``: the error a step may make, per component, shape (n,); ``inf`` for a
        quadrature.
    rtol : float, optional
        Relative tolerance behind `scale`: ``scale/rtol`` is taken as the size of a component
        when differences for the Jacobian are chosen.
    max_step : float, optional
        Largest step.
    jacobian : callable, optional
        ``jacobian(t, y)``, shape (n, n). By default forward differences, one evaluation for
        each component that is not a quadrature. The attribute `jacobian` may be set anew
        before each `start`.

    References
    ----------
    Hairer, Wanner, *Solving Ordinary Differential Equations II*, IV.8. K. Gustafsson,
    "Control-theoretic techniques for stepsize selection in implicit Runge-Kutta methods", ACM
    Trans. Math. Softw. 20(4), 1994.

    Examples
    --------
    >>> solver = RadauIIA(lambda y0, y1: 1e-9 + 1e-6 * np.abs(y1))
    >>> stiff = lambda t, y: -1e6 * (y - np.cos(t))
    >>> solver.start(stiff, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    >>> t, steps = 0.0, 0
    >>> while t < 1.0:
    ...     step = solver.step(1.0)
    ...     t, steps = step.t1, steps + 1
    >>> bool(abs(step.y1[0] - np.cos(1.0)) < 1e-5), steps < 40
    (True, True)
    """

    name = "radau"
    order = 5
    adaptive = True
    implicit = True

    def __init__(
        self,
        scale: Scale,
        *,
        rtol: float = 1e-6,
        max_step: float = math.inf,
        jacobian: Jacobian | None = None,
    ) -> None:
        super().__init__(scale, max_step)
        self.jacobian = jacobian
        self._rtol = float(rtol)
        # Below ten units of rounding of the state itself no iteration can come.
        self._enough = max(_ENOUGH, 10.0 * _EPS / self._rtol) if rtol > 0.0 else _ENOUGH
        self._chosen: Choice = slice(0, 0)
        self._indices = np.empty(0, dtype=np.intp)
        self._quadratures = np.empty(0, dtype=np.intp)
        self._memory = _Memory()
        self._replay = _Memory()
        """The memory to repeat the last step with."""
        self._factors: Factors | None = None

    def _begin(self, t_bound: float, *, forget: bool, moved: bool) -> None:
        t, y = self._t, self._y
        if moved:
            self._f = self._finite_derivative(t, y)
            self._memory = self._memory._replace(current=False)
        scale = self._scale(y, y)
        if forget or not np.array_equal(np.flatnonzero(scale < np.inf), self._indices):
            self._choose(scale)
        if forget:
            limit = min(self._max_step, t_bound - t) if t_bound > t else self._max_step
            self._h = first_step(self._derivative, t, y, self._f, scale=scale, order=3, limit=limit)

    def _choose(self, scale: FloatArray) -> None:
        """Learn which components are quadratures, and forget all else."""
        controlled = scale < np.inf
        indices = np.flatnonzero(controlled)
        m = indices.size
        self._memory = _Memory()
        self._factors = None
        self._indices = indices
        self._chosen = slice(0, m) if m == 0 or indices[-1] == m - 1 else indices
        self._quadratures = np.flatnonzero(~controlled)

    @property
    def own(self) -> bool:
        """Whether a function gives its Jacobian."""
        return self.jacobian is not None

    def state(self) -> State:
        """Return where the solver stands and what it has learnt of its steps.

        Its Jacobian and its polynomial are not part of it: whoever goes on makes them anew.
        """
        memory, count = self._memory, max(self._indices.size, 1)
        return State(self._t, self._y, self._f, self._h, memory.error, memory.h, count)

    def resume(self, state: State) -> None:
        """Go on from a state that the same method reached elsewhere, once it is started there."""
        super().resume(state)
        with np.errstate(all="ignore"):
            self._choose(self._scale(state.y, state.y))
        self._memory = _Memory(h=state.h_before, error=state.error_before)

    def step(self, t_end: float) -> Step:
        """Make one step that satisfies the tolerance."""
        t_end = float(t_end)
        self._remaining(t_end)
        start = (self._t, self._y, self._f)
        with np.errstate(all="ignore"):
            piece, error, rejected = self._advance(t_end)
        self._retryable = start
        return Step(piece.t0, piece.t1, piece.y0, piece.y1, piece, error, self._counted(), rejected)

    def retry(self, t_end: float) -> Step:
        """Repeat the last step, ending at `t_end`: in one step, if that is accurate enough.

        Past the end of the last step it may take several. Unlike other solvers this one
        controls the error of a retry too, and may raise HB-N201. Jacobian and step size of the
        steps to come are those of before.
        """
        t_end = float(t_end)
        t0, y0, f0 = self._last(t_end)
        before = (self._t, self._y, self._f, self._h, self._memory, self._replay)
        self._t, self._y, self._f, self._memory = t0, y0, f0, self._replay
        self._h = t_end - t0
        pieces: list[Polynomial] = []
        largest, rejected = 0.0, 0
        try:
            with np.errstate(all="ignore"):
                while self._t < t_end:
                    piece, error, more = self._advance(t_end)
                    pieces.append(piece)
                    largest, rejected = max(largest, error), rejected + more
        except StepFailure:
            self._t, self._y, self._f, self._h, self._memory, self._replay = before
            raise
        *_, self._h, memory, self._replay = before
        self._memory = memory._replace(
            current=False,
            coefficients=self._memory.coefficients,
            span=self._memory.span,
        )
        interpolant = pieces[0] if len(pieces) == 1 else Joined(pieces)
        y1 = pieces[-1].y1
        return Step(t0, t_end, y0, y1, interpolant, largest, self._counted(), rejected)

    def _advance(self, t_end: float) -> tuple[Polynomial, float, int]:
        """Make one step that satisfies the tolerance; return it, its error and rejections."""
        assert self._field is not None
        field, chosen, memory = self._field, self._chosen, self._memory
        t0, y0, f0 = self._t, self._y, self._f
        remaining = t_end - t0
        smallest = 10.0 * math.ulp(t0)
        h = max(min(self._h, self._max_step), smallest)
        may_land = remaining <= self._max_step * (1.0 + 1e-12)
        rejected = 0
        tolerance = self._scale(y0, y0)[chosen]
        while True:
            if memory.jacobian is None:
                memory = memory._replace(jacobian=self._matrix(t0, y0), current=True)
            trial = h
            # A little longer rather than a sliver of a step afterwards.
            t1 = t_end if may_land and remaining <= 1.01 * h else min(t0 + h, t_end)
            h = t1 - t0
            shrink, blame = 0.5, f0
            factors = self._factorised(memory, h)
            if factors is not None:
                stages = solve_stages(
                    field,
                    t0,
                    t1,
                    y0,
                    z=self._foreseen(memory, h),
                    chosen=chosen,
                    factors=factors,
                    scale=self._scale,
                    tolerance=tolerance,
                    enough=self._enough,
                    left=memory.left,
                )
                self._evaluations += 3 * stages.iterations
                if stages.converged:
                    error, shrink, blame = self._error(stages, factors, t1, rejected=rejected)
                    if error <= 1.0:
                        piece, f1 = self._finish(stages, t1)
                        if piece is not None:
                            break
                        shrink, blame = _SHRINK, f1
                elif stages.finite:
                    blame = np.zeros(y0.size)
                    blame[chosen] = np.abs(stages.last).max(axis=0, initial=0.0)
                else:
                    shrink = _SHRINK
                    blame = stages.f[~np.isfinite(stages.f).all(axis=1)][0]
                if not (stages.converged or memory.current):
                    # The Jacobian may be to blame; where something is not finite, h as well.
                    memory = memory._replace(jacobian=None)
                    shrink = 1.0 if stages.finite else shrink
            rejected += 1
            if shrink < 1.0 and h * shrink < smallest:
                raise self._failure(h, blame)
            h *= shrink
        rounds = (2 * ITERATIONS + 1) / (2 * ITERATIONS + stages.iterations)
        factor = _SAFETY * rounds * max(error, 1e-10) ** -0.25
        cut = h < 0.99 * trial
        if memory.h > 0.0 and not cut:
            # Gustafsson: the error is expected to go on changing as over the last two steps.
            trend = h / memory.h * (memory.error / max(error, 1e-10)) ** 0.25
            factor *= min(1.0, trend)
        factor = min(max(factor, _SHRINK), 1.0 if rejected else _GROW)
        slow = stages.iterations > 2 and stages.rate > _SLOW
        self._replay = memory._replace(
            left=stages.left, coefficients=piece.coefficients, span=h, origin=0.0
        )
        if cut and factor >= 1.0:
            # Cut short by t_end: its small error says little about the size after it.
            self._h = max(trial, h * factor)
        else:
            self._h = h if not slow and 1.0 <= factor < _KEEP else h * factor
        self._memory = _Memory(
            None if slow else memory.jacobian,
            False,
            stages.left,
            piece.coefficients,
            h,
            1.0,
            memory.h if cut else h,
            memory.error if cut else max(error, _SMALLEST_ERROR),
        )
        self._t, self._y, self._f = t1, piece.y1, f1
        return piece, error, rejected

    def _factorised(self, memory: _Memory, h: float) -> Factors | None:
        """Return factors for a step of size `h`, or None if there are none."""
        assert memory.jacobian is not None
        if self._factors is None or not self._factors.serves(memory.jacobian, h):
            try:
                self._factors = Factors(memory.jacobian, h)
            except np.linalg.LinAlgError:
                self._factors = None
        return self._factors

    def _foreseen(self, memory: _Memory, h: float) -> FloatArray:
        """Return the stages to begin the iteration with."""
        if memory.coefficients is None:
            return np.zeros((3, self._indices.size))
        coefficients = memory.coefficients[:, self._chosen]
        return continued(coefficients, h / memory.span, memory.origin)

    def _error(
        self, stages: Stages, factors: Factors, t1: float, *, rejected: int
    ) -> tuple[float, float, FloatArray]:
        """Return the norm of the error, the factor to shrink a step by, and the error."""
        chosen, y0 = self._chosen, self._y
        t0 = self._t
        h = t1 - t0
        rows = (collocation().error / h).dot(stages.z)
        vector = factors.filtered(self._f[chosen] + rows)
        tolerance = self._scale(y0, stages.y[2])[chosen]
        error = norm(vector, tolerance)
        if error > 1.0 and (rejected or self._memory.h == 0.0):
            # In a fast transient the estimate is too large; filtered twice it is right.
            shifted = y0.copy()
            shifted[chosen] += vector
            again = factors.filtered(self._derivative(t0, shifted)[chosen] + rows)
            twice = norm(again, tolerance)
            if twice < error:
                vector, error = again, twice
        full = np.zeros(y0.size)
        full[chosen] = vector
        if error <= 1.0:
            return error, 1.0, full
        rounds = (2 * ITERATIONS + 1) / (2 * ITERATIONS + stages.iterations)
        return error, min(max(_SAFETY * rounds * error**-0.25, _SHRINK), _SAFETY), full

    def _finish(self, stages: Stages, t1: float) -> tuple[Polynomial | None, FloatArray]:
        """Return the step and the derivative at its end; None and what is not finite, if so."""
        assert self._field is not None
        method = collocation()
        t0, y0, chosen, quadratures = self._t, self._y, self._chosen, self._quadratures
        h = t1 - t0
        y1 = stages.y[2].copy()
        f1 = self._derivative(t1, y1)
        z = stages.z
        if quadratures.size:
            if stages.size > _FRESH:
                # Powers must be those of the stages as corrected, not as foreseen: nothing
                # else controls their error.
                self._evaluations += 2
                stages.f[0] = self._field(t0 + C1 * h, stages.y[0])
                stages.f[1] = self._field(t0 + C2 * h, stages.y[1])
            stages.f[2] = f1
            z = np.empty((3, y0.size))
            z[:, chosen] = stages.z
            z[:, quadratures] = (h * method.a).dot(stages.f[:, quadratures])
            y1[quadratures] = y0[quadratures] + z[2, quadratures]
        for values in (f1, y1):
            if not math.isfinite(values.dot(values)) and not np.isfinite(values).all():
                return None, values
        y1.flags.writeable = False
        return Polynomial(t0, t1, y0, y1, method.polynomial.dot(z)), f1

    def _matrix(self, t: float, y: FloatArray) -> FloatArray:
        """Return the Jacobian, given or by forward differences, without the quadratures."""
        if self.jacobian is not None:
            matrix = np.array(self.jacobian(t, y), dtype=np.float64)
            matrix = matrix[self._chosen][:, self._chosen]
        else:
            matrix = self._differences(t, y)
        bad = np.flatnonzero(~np.isfinite(matrix).all(axis=1))
        if bad.size:
            raise StepFailure.not_finite(t, self._h, int(self._indices[bad[0]]))
        return matrix

    def _differences(self, t: float, y: FloatArray) -> FloatArray:
        """Return forward differences at the start of the step, where the derivative is known."""
        chosen, f = self._chosen, self._f[self._chosen]
        tolerance = self._scale(y, y)[chosen]
        size = np.maximum(np.abs(y[chosen]), tolerance / self._rtol)
        size[size == 0.0] = 1.0
        # In the direction of motion: a state at the edge of where its law is defined is more
        # likely to have come from there than to go there.
        delta = math.sqrt(_EPS) * np.copysign(size, f)
        columns = np.empty((f.size, f.size))
        for k, j in enumerate(self._indices.tolist()):
            for signed in (delta[k], -delta[k]):
                shifted = y.copy()
                shifted[j] += signed
                column = (self._derivative(t, shifted)[chosen] - f) / (shifted[j] - y[j])
                if math.isfinite(column.dot(column)) or np.isfinite(column).all():
                    break
            columns[k] = column
        return columns.T

    def _failure(self, h: float, blame: FloatArray) -> StepFailure:
        bad = first_not_finite(blame)
        if bad is not None:
            return StepFailure.not_finite(self._t, h, bad)
        scale = self._scale(self._y, self._y)
        return StepFailure.underflow(self._t, h, worst_component(blame, scale))
