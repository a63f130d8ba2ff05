"""Quantised-state simulation: QSS1 to QSS3, and LIQSS1 to LIQSS3 for stiff models.

Instead of asking where the state is at given times, ask when it has moved by a quantum. Each state
`x` is seen by the others only through its quantised state `q`, a polynomial one degree lower::

    x' = field(t, q)        between quantum events x is a polynomial of the method's order
    when |x_i - q_i| has grown to the quantum of i:  q_i starts anew from x_i (a quantum event)

A bond graph whose integrators are of this kind is the quantised bond graph of Kofman and Junco, a
discrete event model in the sense of DEVS. Here it keeps the contract of every other solver: a step
ends at the next quantum event of any state, and its interpolant is that polynomial itself.

Two more things end a step: `t_end`, and, where the field is not affine, the end of the time for
which its derivatives are known (see `hybond.solvers.qss_rates`).
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from hybond.engine.outcome.polynomial import Polynomial
from hybond.solvers.base import FloatArray, Scale, Solver, Step, StepFailure, first_not_finite
from hybond.solvers.qss_learn import learn, reached, sizes_of
from hybond.solvers.qss_motion import Motion
from hybond.solvers.qss_quanta import leaves, place
from hybond.solvers.qss_rates import Fitted, Indices, Rates

NUDGE = 0.1
"""A state put back on its constraints by less than this part of its quantum keeps its quanta."""
TOGETHER = 1e-6
"""Quantum events this close, as a part of the step before them, are made together."""
CROWD = 100
"""Steps in a row too short to advance time after which the run is given up."""
START = 1e-3
"""A state with no size yet gets this part of the tolerance of what it is on its way to."""
LESSONS = 8
"""Times that a field may turn out to be affine with another matrix before it is called not so."""
SWEEPS = 2
"""Times that all linearly implicit quantised states are placed at a start."""


class QuantizedState(Solver):
    """What all quantised-state methods share; a subclass is an order and a way of quantising.

    Parameters
    ----------
    scale : callable
        ``scale(y0, y1)``: the quantum per state, shape (n,); read at each quantum event, so that
        quantisation is logarithmic if `scale` follows the state. ``inf``: a quadrature, integrated
        along with the others and without events.
    rtol : float
        Relative tolerance behind `scale`: says how large a state is whose quantum is given.
    max_step : float, optional
        Largest step.

    Notes
    -----
    In a stable linear system ``x' = A x + b`` the error is never more than
    ``|V| |Re(L)^-1 L| |V^-1| quantum``, with ``A = V L V^-1``, whatever the order [1]_.

    References
    ----------
    .. [1] E. Kofman, "A second-order approximation for DEVS simulation of continuous systems",
       Simulation 78(2), 2002, and "A third order discrete event method for continuous system
       simulation", Latin American Applied Research 36, 2006.
    .. [2] E. Kofman, S. Junco, "Quantized bond graphs: an approach for discrete event simulation
       of physical systems", Proc. ICBGM 2001.
    .. [3] F. E. Cellier, E. Kofman, *Continuous System Simulation*, Springer 2006, chapters 11, 12.

    Examples
    --------
    >>> from hybond.solvers.qss import QSS2
    >>> solver = QSS2(lambda y0, y1: np.full(1, 1e-4), rtol=1e-4)
    >>> solver.start(lambda t, y: -y, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    >>> t, steps = 0.0, 0
    >>> while t < 1.0:
    ...     step = solver.step(1.0)
    ...     t, steps = step.t1, steps + 1
    >>> bool(abs(step.y1[0] - np.exp(-1.0)) < 1e-4), steps < 60
    (True, True)
    """

    adaptive = True
    implicit: ClassVar[bool] = False

    def __init__(self, scale: Scale, *, rtol: float, max_step: float = math.inf) -> None:
        super().__init__()
        if not max_step > 0.0:
            raise ValueError(f"max_step must be positive, not {max_step}")
        self._scale = scale
        self._rtol = rtol
        self._max_step = float(max_step)
        self._motion = Motion(0.0, np.empty((0, 0)), np.empty((0, 0)), np.empty((0, 0)))
        self._before = self._motion
        """The motion of the last step."""
        self._states: Indices = np.empty(0, dtype=np.intp)
        self._rest: Indices = np.empty(0, dtype=np.intp)
        self._quanta = np.empty(0)
        self._floor = np.empty(0)
        """Least quantum of each state until the next start."""
        self._at = np.empty(0)
        """When each state leaves its band or touches its quantised state."""
        self._touches = np.empty(0)
        self._due: Indices = np.empty(0, dtype=np.intp)
        self._rates: Rates | None = None
        self._stale = True
        """Whether the derivatives have to be fitted before the next step."""
        self._moved: tuple[int, float] | None = None
        self._crowded = 0
        self._bound = math.inf
        self._sizes = np.empty(0)
        self._lessons = 0

    @property
    def h(self) -> float:
        """Size of the last step. Setting it has no effect: quantum events come when they come."""
        return self._h

    @h.setter
    def h(self, value: float) -> None:
        pass

    # -- starting

    def _begin(self, t_bound: float, *, forget: bool, moved: bool) -> None:
        if forget:
            self._rates = None
            self._learn(t_bound)
            self._reset()
        elif moved:
            x = self._y[self._states]
            m = self._motion
            near = np.abs(x - m.x[0]) <= NUDGE * self._quanta
            if m.t == self._t and near.all():
                m.x[0] = x
                self._schedule(np.arange(x.size))
            else:
                self._read_quanta(np.arange(x.size))
                self._reset()

    def _evaluate(self, t: float, x: FloatArray) -> FloatArray:
        y = self._y.copy()
        y[self._states] = x
        return self._derivative(t, y)

    def _learn(self, t_bound: float) -> None:
        """Find out what the field is like, and what to measure the states by."""
        t, y = self._t, self._y
        f = self._finite_derivative(t, y)
        scale = self._scale(y, y)
        self._states = np.flatnonzero(scale < np.inf)
        self._rest = np.flatnonzero(~(scale < np.inf))
        x, rate, scale = y[self._states], f[self._states], scale[self._states]
        span = t_bound - t if math.isfinite(t_bound) and t_bound > t else 0.0
        self._bound = t_bound
        self._sizes = sizes_of(x, rate, scale / self._rtol, span)
        self._lessons = 1
        self._rates = self._lesson(x, f, span)
        self._floor = np.full(x.size, np.finfo(np.float64).tiny)
        if not (scale > 0.0).all():
            far = reached(x, rate, self._rates.jacobian, span)
            self._floor = START * self._rtol * far
        self._quanta = np.maximum(scale, self._floor)

    def _lesson(self, x: FloatArray, f: FloatArray, span: float) -> Rates:
        return learn(
            self._evaluate,
            self._t,
            x,
            f,
            sizes=self._sizes,
            states=self._states,
            rest=self._rest,
            span=span,
        )

    def _learn_again(self, h: float) -> None:
        """Learn where the field was not what it had been learnt to be.

        Either it is not affine after all, or the states have grown so much that the digits of the
        matrix no longer suffice.
        """
        m = self._motion
        assert self._rates is not None
        self._sizes = np.maximum(self._sizes, np.maximum(np.abs(m.x[0]), np.abs(m.quantised(h))))
        self._lessons += 1
        if self._lessons <= LESSONS:
            span = max(self._bound - self._t, 0.0) if math.isfinite(self._bound) else 0.0
            self._rates = self._lesson(m.x[0].copy(), self._finite_derivative(m.t, self._y), span)
        else:
            self._rates = Fitted(
                self._evaluate, self._states, self._rest, self._rates.jacobian, reach=h
            )

    def _reset(self) -> None:
        """Quantise all states anew, as at an event of all of them."""
        assert self._rates is not None
        n = self.order
        x = self._y[self._states]
        m = Motion(self._t, np.zeros((n + 1, x.size)), np.zeros((n, x.size)), np.empty((n, 0)))
        m.r = np.zeros((n, self._rest.size))
        m.x[0] = x
        term = self._rates.first(self._t, x)
        bad = first_not_finite(term)
        if bad is not None:
            raise StepFailure.not_finite(self._t, 0.0, int(self._states[bad]))
        for k in range(n):
            m.q[k] = m.x[k]
            m.x[k + 1] = term / (k + 1)
            term = self._rates.jacobian @ m.x[k + 1]
        self._motion = m
        self._touches = np.full(x.size, np.inf)
        self._at = np.full(x.size, np.inf)
        self._due = np.empty(0, dtype=np.intp)
        self._moved = None
        if self.implicit:
            fastest_first = np.argsort(np.diagonal(self._rates.jacobian), kind="stable")
            for _ in range(SWEEPS):
                for i in fastest_first.tolist():
                    self._quantise(i)
        self._schedule(np.arange(x.size))
        self._stale = not self._rates.exact

    # -- quantum events

    def _read_quanta(self, states: Indices) -> None:
        scale = self._scale(self._y, self._y)[self._states[states]]
        self._quanta[states] = np.maximum(scale, self._floor[states])

    def _happen(self, due: Indices) -> None:
        """Make the quantum events of the states `due`."""
        assert self._rates is not None
        self._read_quanta(due)
        self._moved = None
        if self.implicit:
            changed = [self._quantise(i) for i in due.tolist()]
        else:
            # all of them from where they were before any of them
            m = self._motion
            change = m.x[:-1, due] - m.q[:, due]
            m.q[:, due] = m.x[:-1, due]
            changed = []
            for k, i in enumerate(due.tolist()):
                changed.append(self._rates.moved(m, i, change[:, k]))
                self._moved = (i, float(change[0, k]))
        if due.size > 1:
            self._moved = None
        self._stale = not self._rates.exact
        if not self._stale:
            self._schedule(np.unique(np.concatenate([due, *changed])))

    def _quantise(self, i: int) -> Indices:
        """Place the linearly implicit quantised state of `i`; return whose derivatives changed."""
        assert self._rates is not None
        m = self._motion
        a = float(self._rates.jacobian[i, i])
        before = m.q[:, i].copy()
        degrees = np.arange(1.0, self.order + 1.0)
        u = (degrees * m.x[1:, i] - a * before).tolist()
        q, h = place(float(m.x[0, i]), u, a, quantum=float(self._quanta[i]))
        m.q[:, i] = q
        change = m.q[:, i] - before
        self._touches[i] = m.t + h
        self._moved = (i, float(change[0]))
        return self._rates.moved(m, i, change)

    def _schedule(self, states: Indices) -> None:
        """Compute when each of `states` has its next event."""
        m = self._motion
        d = m.x[:, states].copy()
        d[:-1] -= m.q[:, states]
        for i, column, quantum in zip(
            states.tolist(), d.T.tolist(), self._quanta[states].tolist(), strict=True
        ):
            self._at[i] = min(m.t + leaves(column, quantum), self._touches[i])

    # -- steps

    def step(self, t_end: float) -> Step:
        """Go to the next quantum event of any state, or to `t_end`."""
        t_end = float(t_end)
        self._remaining(t_end)
        with np.errstate(all="ignore"):
            return self._step(t_end)

    def _step(self, t_end: float) -> Step:
        rejected = 0
        due, self._due = self._due, np.empty(0, dtype=np.intp)
        if due.size:
            self._happen(due)
        late = np.flatnonzero(self._at <= self._t)
        if late.size and not due.size:
            # pushed out of its band where it was put back on its constraints
            self._happen(late)
        while True:
            self._renew(t_end)
            t1 = self._end(t_end)
            assert self._rates is not None
            if self._rates.confirm(self._motion, t1 - self._t, self._quanta):
                return self._take(self._motion, self._y, t1, rejected)
            rejected += 1
            if self._rates.exact:
                self._learn_again(t1 - self._t)
            self._stale = True

    def _renew(self, t_end: float) -> None:
        assert self._rates is not None
        if not self._stale:
            return
        everyone = np.arange(self._states.size)
        self._schedule(everyone)
        horizon = min(t_end, float(self._at.min(initial=math.inf))) - self._t
        self._rates.renew(self._motion, min(horizon, self._max_step), self._moved)
        self._moved = None
        self._schedule(everyone)
        self._stale = False

    def _end(self, t_end: float) -> float:
        """Return where the step ends."""
        assert self._rates is not None
        t = self._t
        first = float(self._at.min(initial=math.inf))
        t1 = min(first, self._rates.until, t + self._max_step)
        smallest = 4.0 * math.ulp(t)
        self._crowded = self._crowded + 1 if t1 < t + smallest else 0
        if self._crowded > CROWD:
            blame = int(self._states[int(self._at.argmin())]) if self._at.size else None
            raise StepFailure.underflow(t, max(t1 - t, 0.0), blame)
        t1 = max(t1, t + smallest)
        return t_end if t1 > t_end - smallest else t1

    def _take(self, m: Motion, y0: FloatArray, t1: float, rejected: int) -> Step:
        """Make the step of a motion to `t1`, and go on from there."""
        assert self._rates is not None
        t0 = m.t
        h = t1 - t0
        n = self.order
        m.r = self._rates.quadratures(m, h)
        powers = (h ** np.arange(1, n + 1))[:, None]
        coefficients = np.empty((n, y0.size))
        coefficients[:, self._states] = m.x[1:] * powers
        coefficients[:, self._rest] = m.r * powers / np.arange(1, n + 1)[:, None]
        y1: FloatArray = y0 + coefficients.sum(axis=0)
        bad = first_not_finite(y1)
        if bad is not None:
            raise StepFailure.not_finite(t0, h, bad)
        y1.flags.writeable = False
        self._retryable = (t0, y0, np.empty(0))
        self._before = m
        self._motion = m.later(h)
        self._motion.t = t1
        self._motion.x[0] = y1[self._states]
        self._t, self._y, self._h = t1, y1, h
        self._due = np.flatnonzero(self._at <= t1 + TOGETHER * h)
        self._stale = t1 >= self._rates.until
        interpolant = Polynomial(t0, t1, y0, y1, coefficients)
        return Step(t0, t1, y0, y1, interpolant, math.nan, self._counted(), rejected)

    def retry(self, t_end: float) -> Step:
        """Cut the last step off at `t_end`: the same polynomials of the states.

        Only quadratures may have to be sampled anew: a fit of theirs is good over all of a step.
        """
        _, y0, _ = self._last(t_end)
        with np.errstate(all="ignore"):
            return self._take(self._before, y0, float(t_end), 0)
