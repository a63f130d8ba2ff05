"""The balance of energy step by step: how wrong a step is, and how wrong it may be.

A step is accepted if the root mean square of its errors, each in units of what the tolerance lets
its state be wrong by, is at most one. An error e of a state changes what is stored by z e, z being
its co-energy variable: so by Cauchy and Schwarz a step may move the energy by no more than
``sqrt(n) |z tol|``. What it moves it by is read from its polynomial, which between the ends knows
less than at them, and powers may hang on small differences of what it says. Where that tells
against a run the step is integrated once more, from where it began, with powers beside states.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.signals import Signals
from hybond.engine.outcome.stretches import Stretch
from hybond.errors import HybondError
from hybond.model.expressions import Name
from hybond.model.graph import FlatGraph
from hybond.records import dataclass
from hybond.runs.trace import Segment, Trace

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

CLOSER = ((1e-5, 100.0), (1e-3, 0.01))
"""Parts of the tolerance of the run, and of what a step may be off by, with which its states and
its powers are integrated once more: the second where the first tells against it. Where a small
mass follows what drives it, its force is a difference that has few digits: no integral of it has
many, and it takes close states to have some. The first is a question of yes or no, and coarse."""
CLOSEST = 1e-13
"""No tolerance is below this."""
LOST = 10.0
"""So many times what is enough is too much: no other step can make that good."""
EVALUATIONS = 20_000
"""Of the field, in all steps of a run that are integrated once more."""
OF_A_STEP = 2_000
"""In one of them."""
LAST_DIGIT = 2.0**-46
"""Part of a state by which rounding may have moved it: some dozens of sums and products lie behind
what is propagated, or read from a polynomial."""


@dataclass(frozen=True, slots=True)
class Balance:
    """What the steps of a segment are off by.

    Parameters
    ----------
    off : array, shape (steps,)
        Change of stored + dissipated - supplied, J.
    allowed : array, shape (steps,)
        What the tolerance of the run lets each step be off by, J.
    """

    segment: Segment
    off: Vector
    allowed: Vector

    @property
    def beyond(self) -> Vector:
        """What each step is off by more than that, J."""
        return np.asarray(np.maximum(np.abs(self.off) - self.allowed, 0.0))

    @property
    def most(self) -> float:
        """The largest difference of the balance at two points, J."""
        return float(np.ptp(np.append(0.0, np.cumsum(self.off))))


@dataclass(frozen=True, slots=True)
class Balances:
    """The same of all segments in a stretch: of the step that ends at each of its points."""

    stretch: Stretch
    off: Vector
    allowed: Vector

    @property
    def beyond(self) -> Vector:
        """What the steps of each segment are off by more than they may, in all, J."""
        return self.stretch.sums(np.maximum(np.abs(self.off) - self.allowed, 0.0))

    @property
    def most(self) -> Vector:
        """The largest difference of the balance at two points of each segment, J."""
        sums = self.stretch.along(self.off)
        return self.stretch.most(sums) + self.stretch.most(-sums)

    def of(self, k: int, segments: Sequence[Segment]) -> Balance:
        """Return that of segment k of the stretch."""
        begins = [*self.stretch.begins.tolist(), len(self.off)]
        own = slice(begins[k] + 1, begins[k + 1])
        return Balance(segments[self.stretch.first + k], self.off[own], self.allowed[own])


class _TooLong(Exception):
    """A step takes more evaluations than are left."""


class Looked:
    """Steps of a run, looked at one by one.

    Parameters
    ----------
    size : array, shape (states,)
        The largest that each state has been, as `sizes_of` finds it.
    """

    def __init__(self, graph: FlatGraph, signals: Signals, size: Vector) -> None:
        numbers = signals.tables.numbers
        self.rtol, atol = numbers["rtol"], numbers["atol"]
        self.tolerance = self.rtol * size + (0.0 if math.isnan(atol) else atol)
        self._graph, self._signals, self._size = graph, signals, size
        stores, many = graph.storages, len(graph.bonds)
        self._powered = [not graph.bonds[s.bond].domain.pseudo for s in stores]
        self._z = np.array([s.bond + (0 if s.kind == "C" else many) for s in stores], dtype=np.intp)
        # efforts have no direction: p' = e whichever way the bond points
        self._sign = np.array([float(s.sign) if s.kind == "C" else 1.0 for s in stores])
        self._rates = [Name(f"{'f' if s.kind == 'C' else 'e'}:{s.bond}") for s in stores]
        self._left = EVALUATIONS
        self.spent = 0
        """Evaluations in the last step that was integrated once more."""

    def allowed(self, found: Stretch) -> Vector:
        """Return what the step that ends at each point may be off by, J."""
        stores, many = len(self._z), len(found.t)
        if not stores:
            return np.zeros(many)
        z = np.abs(found.bonds[self._z]).reshape(stores, many, -1).max(axis=2)
        z = z * (self.tolerance[:stores] * self._powered)[:, None]
        squares = np.maximum(z, np.concatenate([z[:, :1], z[:, :-1]], axis=1)) ** 2
        return found.steps(np.sqrt(len(self.tolerance) * squares.sum(axis=0)))

    def rounded(self, segment: Segment, steps: Vector) -> Vector:
        """Return what rounding of states lets the balance of some steps be off by, J.

        The force of what follows its drive at once is the small difference of two large ones: the
        last digit of a state is all that is known of it, and of the power that hangs on it.
        """
        found = np.zeros(len(segment.t) - 1)
        which = np.flatnonzero(steps)
        points = np.unique(np.append(which, which + 1))
        t, y = segment.t[points], np.array(segment.y[points])
        power = np.zeros(len(segment.t))
        try:
            here = self._signals.powers_at(segment, t, y)
            for i in range(len(self._size)):
                most = np.zeros(len(t))
                for part in (1.0 + LAST_DIGIT, 1.0 - LAST_DIGIT):
                    beside = y.copy()
                    beside[:, i] *= part
                    moved = self._signals.powers_at(segment, t, beside) - here
                    most = np.maximum(most, np.abs(moved[:, 1] - moved[:, 0]))
                power[points] += most
        except (HybondError, ValueError, ArithmeticError):
            return found
        power = np.where(np.isfinite(power), power, 0.0)
        found[which] = (np.maximum(power[1:], power[:-1]) * np.diff(segment.t))[which]
        return found

    def again(self, segment: Segment, k: int, allowed: float) -> float | None:
        """Return what step k is off by where it is integrated once more; None if it cannot be."""
        if segment.sliding is not None and self._graph.integrals:
            return None  # the rate of an integral may be that of a machine's state
        from scipy.integrate import solve_ivp

        signals, n = self._signals, len(self._size)
        rates = [*self._rates, *(i.rate for i in self._graph.integrals)]
        sign = np.concatenate([self._sign, np.ones(n - len(self._sign))])

        def field(t: float, w: Matrix) -> Matrix:
            times, y = np.full(w.shape[1], t), np.ascontiguousarray(w[:n].T)
            self._left -= len(times)
            if self._left < max(before_it - OF_A_STEP, 0):
                raise _TooLong
            found = np.array(signals.at(segment, rates, times, y)) * sign[:, None]
            return np.vstack([found, signals.powers_at(segment, times, y).T])

        low, high, before_it = float(segment.t[k]), float(segment.t[k + 1]), self._left
        tiny = np.finfo(float).tiny
        before, after = signals.stored(segment.y[k : k + 2])
        off = None
        for closer, part in CLOSER:
            rtol = max(closer * self.rtol, CLOSEST)
            try:
                made = solve_ivp(
                    *(field, (low, high), np.append(segment.y[k], [0.0, 0.0]), "Radau"),
                    vectorized=True,
                    rtol=rtol,
                    atol=np.append(rtol * self._size, [part * allowed] * 2) + tiny,
                )
            except (_TooLong, HybondError, ValueError, ArithmeticError):
                break
            finally:
                self.spent = before_it - self._left
            if not made.success:
                break
            supplied, dissipated = made.y[n:, -1]
            off = float(after - before + dissipated - supplied)
            if abs(off) <= allowed:
                break
        return off


def balances_of(
    looked: Looked, trace: Trace, found: Sequence[Balances], enough: float
) -> tuple[float, float]:
    """Return the largest difference of a balance, and the most that steps are off by beyond theirs.

    Parameters
    ----------
    enough : float
        J. Segments that are off by less, beyond what they may be, are taken as they are.
    """
    energy = beyond = 0.0
    doubtful: list[Balance] = []
    for some in found:
        most, wrong = some.most, some.beyond
        taken = (most <= enough) | (wrong <= enough)
        energy = max(energy, float(most[taken].max(initial=0.0)))
        beyond = max(beyond, float(wrong[taken].max(initial=0.0)))
        doubtful += [some.of(k, trace.segments) for k in np.flatnonzero(~taken).tolist()]
    for made in doubtful:
        allowed = made.allowed + looked.rounded(made.segment, made.beyond)
        balance = Balance(made.segment, made.off, allowed)
        off, sure = balance.off.copy(), 0.0
        order = np.argsort(-balance.beyond, kind="stable")
        rest = balance.beyond.sum() - np.cumsum(balance.beyond[order])
        needed = int(np.count_nonzero(rest > LOST * enough)) + 1
        for done, k in enumerate(order.tolist()):
            if looked.spent * (needed - done) > EVALUATIONS:
                break  # more steps than can be looked at so closely
            left = np.maximum(np.abs(off) - balance.allowed, 0.0)
            if left[k] == 0.0 or left.sum() <= 0.1 * enough or sure > LOST * enough:
                break
            again = looked.again(balance.segment, k, float(balance.allowed[k]))
            if again is None:
                break
            off[k] = again
            sure += max(abs(again) - float(balance.allowed[k]), 0.0)
        closer = Balance(balance.segment, off, balance.allowed)
        energy, beyond = max(energy, closer.most), max(beyond, float(closer.beyond.sum()))
    return energy, beyond
