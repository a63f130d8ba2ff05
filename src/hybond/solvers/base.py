"""The step contract: what every solver takes, gives and promises.

A solver knows nothing of modes, guards or events. Whoever drives it tells it where to `start`
(and whether what follows is a continuation or comes after a jump), asks for one `step` at a
time, never beyond a given time, and may ask to `retry` the last step with an end that suits
better, such as the time of an event found inside it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hybond.errors import NumericsError

if TYPE_CHECKING:
    from hybond.solvers.exact import Linear

FloatArray: TypeAlias = NDArray[np.float64]

Field: TypeAlias = Callable[[float, FloatArray], FloatArray]
"""``field(t, y) -> y'``, all of shape (n,). It must not change `y`; it may reuse its result."""

Scale: TypeAlias = Callable[[FloatArray, FloatArray], FloatArray]
"""``scale(y0, y1)``: per component the error that one step may make; ``inf``: not controlled.

A component that is not controlled is a quadrature: the field must not depend on it. Which
components are ``inf`` may change only where a solver starts.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One accepted step.

    A step owns the times ``t0 <= t < t1``. Its end `t1` is the start of the next one: `y1` is
    the limit from the left there, and an event at `t1` happens after `y1`.

    Attributes
    ----------
    t0, t1 : float
        Start and end, ``t0 < t1``.
    y0, y1 : ndarray, shape (n,)
        The states there, read-only.
    interpolant : callable
        Dense output: a time gives shape (n,), an array of k times gives (n, k). At `t0` and
        `t1` it returns `y0` and `y1` bit for bit. Outside it extrapolates.
    error : float
        Weighted norm of the estimated error, at most 1 for an accepted step; nan if the solver
        does not say.
    evaluations : int
        Evaluations of the field since the step before (or for this retry), with those of
        rejected attempts, of Jacobians and of the start.
    rejected : int
        Attempts that were rejected.
    """

    t0: float
    t1: float
    y0: FloatArray
    y1: FloatArray
    interpolant: Callable[[float | FloatArray], FloatArray]
    error: float
    evaluations: int
    rejected: int


@dataclass(frozen=True, slots=True)
class State:
    """Where a solver stands.

    Parameters
    ----------
    t : float
    y, f : array, shape (n,)
        State and derivative.
    h : float
        Size of the next step to try.
    error_before, h_before : float
        Norm of the error, and size, of the last step that tells of the next one; whatever of that
        the method makes use of.
    controlled : int
        Components whose error counts.
    """

    t: float
    y: FloatArray
    f: FloatArray
    h: float = 0.0
    error_before: float = 0.0
    h_before: float = 0.0
    controlled: int = 0


class StepFailure(NumericsError):
    """A step that cannot be made.

    Parameters
    ----------
    why : str
        The reason.
    code : str
        ``"HB-N201"`` (step size underflow) or ``"HB-N202"`` (derivative not finite).
    t, h : float
        Start and size of the step that failed.
    component : int or None
        Index of the state that is to blame, for the caller to name; None if there is none.
    hint : str
        What to try.

    Examples
    --------
    >>> failure = StepFailure.underflow(2.0, 1e-15, 3)
    >>> failure.code, failure.component
    ('HB-N201', 3)
    """

    def __init__(
        self, why: str, *, code: str, t: float, h: float, component: int | None, hint: str = ""
    ) -> None:
        super().__init__(why, code=code, hint=hint)
        self.t = t
        self.h = h
        self.component = component

    @classmethod
    def underflow(cls, t: float, h: float, component: int | None) -> StepFailure:
        """Return the failure of a step that would have to be too small to advance time."""
        blame = "" if component is None else f"; state {component} dominates the error"
        return cls(
            f"step size underflow at t = {t:.9g}: h = {h:.3g} is still too large{blame}",
            code="HB-N201",
            t=t,
            h=h,
            component=component,
            hint="look for a state that grows without bound or a law with a jump inside; "
            "loosen the tolerances, or use solver 'radau' if the model is stiff",
        )

    @classmethod
    def not_finite(cls, t: float, h: float, component: int | None) -> StepFailure:
        """Return the failure of a derivative (or state) that is infinite or not a number."""
        blame = "" if component is None else f" of state {component}"
        size = f", h = {h:.3g}" if h else ""
        return cls(
            f"the derivative{blame} is not finite near t = {t:.9g}{size}",
            code="HB-N202",
            t=t,
            h=h,
            component=component,
            hint="look for a division by zero, a root or logarithm of a negative number, "
            "or an overflow in the laws that feed this state",
        )


def first_not_finite(values: FloatArray) -> int | None:
    """Return the index of the first value that is infinite or nan, or None.

    Examples
    --------
    >>> first_not_finite(np.array([1.0, np.nan]))
    1
    """
    bad = np.flatnonzero(~np.isfinite(values))
    return int(bad[0]) if bad.size else None


class Solver(ABC):
    """A method that advances ``y' = field(t, y)`` step by step.

    Attributes
    ----------
    name : str
        The name users choose it by.
    order : int
        Order of the solution at the ends of the steps.
    adaptive : bool
        Whether it chooses its step size.
    """

    name: ClassVar[str]
    order: ClassVar[int]
    adaptive: ClassVar[bool]
    propagates: ClassVar[bool] = False
    """Whether it wants to know, before each start, what the field is where that is linear."""
    linear: Linear | None = None

    def __init__(self) -> None:
        self._field: Field | None = None
        self._t = math.nan
        self._y: FloatArray = np.empty(0)
        self._h = 0.0
        self._evaluations = 0
        self._retryable: tuple[float, FloatArray, FloatArray] | None = None
        """Start, state and derivative of the last step."""

    def start(self, field: Field, t: float, y: FloatArray, *, t_bound: float, jumped: bool) -> None:
        """Begin, or go on after an event.

        Parameters
        ----------
        field : callable
            The derivative from now on.
        t : float
            Time to start from.
        y : ndarray, shape (n,)
            State to start from; it is copied.
        t_bound : float
            End of the run; bounds the first step and is not enforced afterwards.
        jumped : bool
            True: field or state was discontinuous; forget derivative, Jacobian and history of
            steps. False: go on. Then a `t` or `y` other than the end of the last step costs
            only a new derivative, the step size is kept. The first start counts as jumped.

        Raises
        ------
        StepFailure
            HB-N202 if the state, or the derivative where it is needed, is not finite.
        """
        y = np.array(y, dtype=np.float64)
        y.flags.writeable = False
        bad = first_not_finite(y)
        if bad is not None:
            raise StepFailure.not_finite(t, 0.0, bad)
        forget = jumped or self._field is None or y.size != self._y.size
        moved = forget or t != self._t or not np.array_equal(y, self._y)
        self._field, self._t, self._y = field, float(t), y
        self._retryable = None
        with np.errstate(all="ignore"):
            self._begin(t_bound, forget=forget, moved=moved)

    @abstractmethod
    def _begin(self, t_bound: float, *, forget: bool, moved: bool) -> None:
        """Prepare the first step from the new ``_t, _y``; `moved`: the derivative is stale."""

    @abstractmethod
    def step(self, t_end: float) -> Step:
        """Make one step that ends at `t_end` exactly, or before it.

        Raises
        ------
        StepFailure
            HB-N201 or HB-N202. The solver stays at the start of the step.
        """

    @abstractmethod
    def retry(self, t_end: float) -> Step:
        """Repeat the last step from its start, ending at `t_end` exactly.

        For landing on an event with the accuracy of a step. `t_end` lies within the last step
        or slightly past it: there is no step size control. May be called again; the next
        `step` goes on from the last retry.

        Raises
        ------
        StepFailure
            HB-N202 if a derivative on the way is not finite.
        """

    @property
    def h(self) -> float:
        """Size of the next step to try; may be set.

        A hint: `start` after a jump chooses anew, and solvers of fixed step ignore it.
        """
        return self._h

    @h.setter
    def h(self, value: float) -> None:
        if not value > 0.0:
            raise ValueError(f"a step size must be positive, not {value}")
        self._h = float(value)

    def _derivative(self, t: float, y: FloatArray) -> FloatArray:
        """Evaluate the field, count it, and copy the result."""
        assert self._field is not None
        self._evaluations += 1
        return np.array(self._field(t, y), dtype=np.float64)

    def _finite_derivative(self, t: float, y: FloatArray, *, h: float = 0.0) -> FloatArray:
        """Evaluate the field where a derivative that is not finite cannot be avoided."""
        f = self._derivative(t, y)
        bad = first_not_finite(f)
        if bad is not None:
            raise StepFailure.not_finite(t, h, bad)
        return f

    def _counted(self) -> int:
        """Return the evaluations since the last call."""
        count, self._evaluations = self._evaluations, 0
        return count

    def _remaining(self, t_end: float) -> float:
        if self._field is None:
            raise RuntimeError("step() before start()")
        remaining = t_end - self._t
        if not remaining > 0.0:
            raise ValueError(f"step to {t_end} from {self._t}: the end must be later")
        return remaining

    def _last(self, t_end: float) -> tuple[float, FloatArray, FloatArray]:
        """Return start, state and derivative of the step to retry."""
        if self._retryable is None:
            raise RuntimeError("retry() without a step since start()")
        if not t_end > self._retryable[0]:
            raise ValueError(f"retry to {t_end} from {self._retryable[0]}: must be later")
        return self._retryable


class Twinned(Solver):
    """A solver whose method can also be followed elsewhere, by turns.

    Parameters
    ----------
    scale : callable
        ``scale(y0, y1)``: the error a step may make, per component, shape (n,); ``inf`` for a
        quadrature.
    max_step : float
        Largest step.

    Attributes
    ----------
    implicit : bool
        Whether a step solves systems of the size of the state.
    """

    implicit: ClassVar[bool]

    def __init__(self, scale: Scale, max_step: float) -> None:
        super().__init__()
        if not max_step > 0.0:
            raise ValueError(f"max_step must be positive, not {max_step}")
        self._scale = scale
        self._max_step = float(max_step)
        self._f: FloatArray = np.empty(0)

    @property
    def max_step(self) -> float:
        """Largest step."""
        return self._max_step

    @property
    def own(self) -> bool:
        """Whether it does what only it can do, such as to ask a function for its Jacobian."""
        return False

    @abstractmethod
    def state(self) -> State:
        """Return where the solver stands and what it has learnt."""

    def resume(self, state: State) -> None:
        """Go on from a state that the same method reached elsewhere, once it is started there."""
        self._field = self._field or _nowhere
        self._t, self._y, self._f, self._h = state.t, state.y, state.f, state.h
        self._retryable = None


def _nowhere(t: float, y: FloatArray) -> FloatArray:
    """Stand for the field until a start gives one."""
    raise RuntimeError("step() before start()")
