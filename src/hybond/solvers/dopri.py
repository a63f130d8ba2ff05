"""The Runge-Kutta pair 5(4) of Dormand and Prince."""

from __future__ import annotations

import math

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
from hybond.solvers.control import error_norm, first_step, worst_component

_C2, _C3, _C4, _C5 = 1 / 5, 3 / 10, 4 / 5, 8 / 9

# One table, so that one product by h serves the stages (rows 1 to 5), the solution (6), the
# error estimate (7) and the dense output (8 to 11: coefficients of x, x^2, x^3, x^4).
_TABLE = np.array(
    [
        [0, 0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0],
        [-71 / 57600, 0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40],
        [1, 0, 0, 0, 0, 0, 0],
        [
            -8048581381 / 2820520608,
            0,
            131558114200 / 32700410799,
            -1754552775 / 470086768,
            127303824393 / 49829197408,
            -282668133 / 205662961,
            40617522 / 29380423,
        ],
        [
            8663915743 / 2820520608,
            0,
            -68118460800 / 10900136933,
            14199869525 / 1410260304,
            -318862633887 / 49829197408,
            2019193451 / 616988883,
            -110615467 / 29380423,
        ],
        [
            -12715105075 / 11282082432,
            0,
            87487479700 / 32700410799,
            -10690763975 / 1880347072,
            701980252875 / 199316789632,
            -1453857185 / 822651844,
            69997945 / 29380423,
        ],
    ]
)

# Hairer's PI controller: the exponent of the present error, and of the one before.
_BETA = 0.04
_EXPONENT = 0.2 - 0.75 * _BETA
_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 10.0
_SMALLEST_ERROR = 1e-4


class DormandPrince(Twinned):
    """Explicit Runge-Kutta 5(4), adaptive, with Shampine's dense output of order 4.

    The first derivative of a step is the last of the step before (FSAL): six evaluations per
    accepted step. The norm of the error is the root mean square over the controlled components
    in units of their scale.

    Parameters
    ----------
    scale : callable
        ``scale(y0, y1)``: the error a step may make, per component, shape (n,); ``inf`` for a
        component that must not influence the step size.
    max_step : float, optional
        Largest step.

    References
    ----------
    J. R. Dormand, P. J. Prince, "A family of embedded Runge-Kutta formulae", J. Comput. Appl.
    Math. 6(1), 1980. L. F. Shampine, "Some practical Runge-Kutta formulas", Math. Comput. 46,
    1986. Control: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.4
    and IV.2 (of volume II).

    Examples
    --------
    >>> solver = DormandPrince(lambda y0, y1: 1e-9 + 1e-6 * np.abs(y1))
    >>> solver.start(lambda t, y: -y, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    >>> t = 0.0
    >>> while t < 1.0:
    ...     step = solver.step(1.0)
    ...     t = step.t1
    >>> bool(abs(step.y1[0] - np.exp(-1.0)) < 1e-6)
    True
    """

    name = "rk45"
    order = 5
    adaptive = True
    implicit = False

    def __init__(self, scale: Scale, *, max_step: float = math.inf) -> None:
        super().__init__(scale, max_step)
        self._controlled = 1
        self._error_before = _SMALLEST_ERROR
        self._ht = np.empty_like(_TABLE)
        self._allocate(0)

    def _allocate(self, n: int) -> None:
        # Stages and views of them are made once: for small systems slicing costs as much as
        # arithmetic.
        self._k = np.zeros((7, n))
        self._k_flat = self._k.reshape(-1)
        self._stages = [(self._ht[i, :i], self._k[:i]) for i in range(7)]
        self._error_row = self._ht[7]
        self._dense_rows = self._ht[8:]

    def _begin(self, t_bound: float, *, forget: bool, moved: bool) -> None:
        t, y = self._t, self._y
        if y.size != self._k.shape[1]:
            self._allocate(y.size)
        if moved:
            self._f = self._finite_derivative(t, y)
        scale = self._scale(y, y)
        # At least 1, so that with nothing controlled the norm is 0 and not 0/0.
        self._controlled = max(int(np.count_nonzero(scale < np.inf)), 1)
        if forget:
            self._error_before = _SMALLEST_ERROR
            limit = min(self._max_step, t_bound - t) if t_bound > t else self._max_step
            self._h = self._first_size(scale, limit)

    def _first_size(self, scale: FloatArray, limit: float) -> float:
        """Choose the first step after a jump, no longer than `limit`, s."""
        t, y, f = self._t, self._y, self._f
        return first_step(self._derivative, t, y, f, scale=scale, order=4, limit=limit)

    def step(self, t_end: float) -> Step:
        """Make one step that satisfies the tolerance."""
        t_end = float(t_end)
        remaining = self._remaining(t_end)
        t0, y0, f0 = self._t, self._y, self._f
        smallest = 10.0 * math.ulp(t0)
        h = max(min(self._h, self._max_step), smallest)
        may_land = remaining <= self._max_step * (1.0 + 1e-12)
        rejected = 0
        with np.errstate(all="ignore"):
            while True:
                trial = h
                # A little longer rather than a sliver of a step afterwards.
                t1 = t_end if may_land and remaining <= 1.01 * h else t0 + h
                t1 = min(t1, t_end)
                h = t1 - t0
                y1, error, vector = self._attempt(t0, y0, f0, t1)
                if error <= 1.0:
                    break
                rejected += 1
                finite = math.isfinite(error)
                factor = _SAFETY * error**-_EXPONENT if finite else _SHRINK
                smaller = h * max(factor, _SHRINK)
                if smaller < smallest:
                    raise self._failure(t0, h, y0, y1, vector)
                h = smaller
            factor = _SAFETY * max(error, 1e-10) ** -_EXPONENT * self._error_before**_BETA
            factor = min(max(factor, _SHRINK), 1.0 if rejected else _GROW)
            if h < 0.99 * trial:
                # Cut short by t_end: its small error says little about the size after it.
                self._h = max(trial, h * factor) if factor >= 1.0 else h * factor
            else:
                self._h = h * factor
                self._error_before = max(error, _SMALLEST_ERROR)
            return self._accept(t0, t1, y0, y1, f0, error, rejected)

    def state(self) -> State:
        """Return where the solver stands and what it has learnt."""
        before, count = self._error_before, self._controlled
        return State(self._t, self._y, self._f, self._h, before, controlled=count)

    def resume(self, state: State) -> None:
        """Go on from a state that the same method reached elsewhere, once it is started there."""
        super().resume(state)
        self._error_before, self._controlled = state.error_before, state.controlled

    def retry(self, t_end: float) -> Step:
        """Repeat the last step with the size that ends it at `t_end`; six evaluations."""
        t0, y0, f0 = self._last(t_end)
        t1 = float(t_end)
        with np.errstate(all="ignore"):
            y1, error, vector = self._attempt(t0, y0, f0, t1)
            if not math.isfinite(error):
                raise self._failure(t0, t1 - t0, y0, y1, vector)
            return self._accept(t0, t1, y0, y1, f0, error, 0)

    def _attempt(
        self, t0: float, y0: FloatArray, f0: FloatArray, t1: float
    ) -> tuple[FloatArray, float, FloatArray]:
        """Return the state at `t1`, the norm of its error (nan: not finite) and the error."""
        field, k, stages = self._field, self._k, self._stages
        assert field is not None
        h = t1 - t0
        np.multiply(_TABLE, h, out=self._ht)
        self._evaluations += 6
        k[0] = f0
        a, stage = stages[1]
        k[1] = field(t0 + _C2 * h, y0 + a.dot(stage))
        a, stage = stages[2]
        k[2] = field(t0 + _C3 * h, y0 + a.dot(stage))
        a, stage = stages[3]
        k[3] = field(t0 + _C4 * h, y0 + a.dot(stage))
        a, stage = stages[4]
        k[4] = field(t0 + _C5 * h, y0 + a.dot(stage))
        a, stage = stages[5]
        k[5] = field(t1, y0 + a.dot(stage))
        a, stage = stages[6]
        y1: FloatArray = y0 + a.dot(stage)
        k[6] = field(t1, y1)
        vector: FloatArray = self._error_row.dot(k)
        # Squares see anything not finite in two calls; they overflow before the values do,
        # hence the second look.
        suspect = not math.isfinite(self._k_flat.dot(self._k_flat) + y1.dot(y1))
        if suspect and not (np.isfinite(k).all() and np.isfinite(y1).all()):
            return y1, math.nan, vector
        scale = self._scale(y0, y1)
        ratios = vector / scale
        error = math.sqrt(ratios.dot(ratios) / self._controlled)
        if math.isnan(error):
            # 0/0: a scale of zero where there is no error.
            error = error_norm(vector, scale)
        return y1, error, vector

    def _accept(
        self,
        t0: float,
        t1: float,
        y0: FloatArray,
        y1: FloatArray,
        f0: FloatArray,
        error: float,
        rejected: int,
    ) -> Step:
        y1.flags.writeable = False
        self._retryable = (t0, y0, f0)
        self._t, self._y, self._f = t1, y1, self._k[6].copy()
        interpolant = Polynomial(t0, t1, y0, y1, self._dense_rows.dot(self._k))
        return Step(t0, t1, y0, y1, interpolant, error, self._counted(), rejected)

    def _failure(
        self, t0: float, h: float, y0: FloatArray, y1: FloatArray, vector: FloatArray
    ) -> StepFailure:
        for values in (*self._k, y1):
            bad = first_not_finite(values)
            if bad is not None:
                return StepFailure.not_finite(t0, h, bad)
        return StepFailure.underflow(t0, h, worst_component(vector, self._scale(y0, y1)))
