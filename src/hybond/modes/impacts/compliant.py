"""An impact through the compliance of its contacts: the law of Liu, Zhao and Brogliato.

Each closed contact i is a spring ``F_i = k_i d_i**m`` (`m` the exponent: 1 linear, 1.5 Hertz) that
is so stiff that positions do not move while it acts. With `P` the impulses, ``v = v0 + W P`` the
separating velocities and ``E_i = k_i d_i**(m + 1)/(m + 1)`` the potential energies, the paper
integrates over an impulse,

    dP_i/dP_1 = (k_i/k_1)**(1/(m + 1)) * (E_i/E_1)**(m/(m + 1))            (its distributing law)
    dE_i/dP_i = -v_i             while v_i <= 0   (compression)
    dE_i/dP_i = -v_i / e_i**2    while v_i > 0    (expansion; e_i the energetic restitution)

A contact ends when its energy is used up, and begins again if it is approached again; the impact
ends when no contact has energy and none approaches. Expansion returns ``e_i**2`` of the work of
compression and that is Stronge's restitution; the second line and the third are the "bi-stiffness"
contact, whose force is continuous where compression turns into expansion.

These equations are singular where a contact begins (E = 0). In the variable d they are not: since
``dE_i = F_i dd_i``, the same law in a time-like variable t is

    dP_i/dt = F_i = k_i d_i**m,    dd_i/dt = -v_i  or  -v_i/e_i**2

which starts by the relative velocities alone and is what is integrated here. Only ratios of
stiffness matter; scaled by the fastest approach, the impulses do not depend on speed.

Where e = 0 expansion has no duration: the limit e -> 0 is taken with velocities that are e times w
and a time that is e times s, in which all other contacts stand still,

    dw_i/ds = dv_i/dt,    dd_i/ds = -max(w_i, 0)        until no w > 0 has something left to expand.

A contact that is not used up by that is compressed again from there.

Gaps do not open during an impact (positions are frozen): a contact that has ended is in contact
again as soon as it is approached. Finite springs behave so only where no contact closes twice.

References
----------
C. Liu, Z. Zhao, B. Brogliato, "Frictionless multiple impacts in multibody systems. I. Theoretical
framework", Proc. R. Soc. A 464:3193-3211, 2008, doi:10.1098/rspa.2008.0078.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.errors import NumericsError

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Indices = NDArray[np.intp]

REST = 1e-11
"""An impact is over when what approaches is below this part of the first approach, and what is
stored below its square of the energy."""

MARGIN = 1e-14
"""A contact changes its phase when it is past its bound by this much, in scaled variables: then a
value that only touches the bound by rounding never repeats an event."""

PAST = 1e-14
"""Scaled time by which an event is passed, absolute and relative."""

LOOSER = 1e2
"""The error is measured against a second integration whose tolerance is larger by this."""


@dataclass(frozen=True, slots=True)
class Compliant:
    """What an impact through compliant contacts left.

    Parameters
    ----------
    impulses : ndarray, shape (n,)
        Impulse of each contact.
    error : float
        Largest difference of a velocity after the impact, in its unit, from an integration with a
        looser tolerance: an upper estimate of the error of integration.
    pieces : int
        Number of smooth pieces that were integrated.
    """

    impulses: Array
    error: float
    pieces: int


def compliant_impact(
    W: Array,
    v: Array,
    *,
    eps: Array,
    stiffness: Array,
    exponent: float = 1.0,
    rtol: float = 1e-12,
    max_pieces: int | None = None,
) -> Compliant:
    """Integrate an impact through its contacts' compression and expansion.

    Parameters
    ----------
    W : ndarray, shape (n, n)
        Response of the separating velocities to impulses; symmetric, positive semi-definite.
    v : ndarray, shape (n,)
        Separating velocities before; negative ones approach.
    eps : ndarray, shape (n,)
        Energetic restitution of each contact.
    stiffness : ndarray, shape (n,)
        Stiffness of each contact; only ratios matter.
    exponent : float
        Force is stiffness times indentation to this power: 1 linear, 1.5 Hertz.
    rtol : float
        Relative tolerance of the integration.
    max_pieces : int or None
        Limit on the smooth pieces; None is 2000 and 200 more per contact.

    Returns
    -------
    Compliant

    Raises
    ------
    NumericsError
        HB-J204: the contacts are still active after `max_pieces` pieces.

    Examples
    --------
    Three equal balls that touch, the first arrives with 1 m/s; elastic, linear contacts:

    >>> W = np.array([[2.0, -1.0], [-1.0, 2.0]])
    >>> done = compliant_impact(W, np.array([-1.0, 0.0]), eps=np.ones(2), stiffness=np.ones(2))
    >>> p, q = done.impulses
    >>> [round(float(x), 4) for x in (1 - p, p - q, q)]
    [-0.1303, 0.1502, 0.98]
    """
    approach = float(np.max(-v, initial=0.0))
    if not approach > 0.0:
        return Compliant(np.zeros(len(v)), 0.0, 0)
    mass = float(np.max(np.diag(W)))  # scaled: W ~ 1, v ~ 1, k ~ 1, hence time and impulse ~ 1
    k = stiffness / np.exp(np.mean(np.log(stiffness)))
    limit = 2000 + 200 * len(v) if max_pieces is None else max_pieces
    runs = [
        _Contacts(W / mass, v / approach, eps, k, exponent).run(tolerance, limit)
        for tolerance in (rtol, min(LOOSER * rtol, 1e-3))
    ]
    fine, coarse = (P for P, _ in runs)
    error = float(np.max(np.abs(W / mass @ (fine - coarse)))) + REST
    return Compliant(fine * (approach / mass), error * approach, runs[0][1])


class _Contacts:
    """The contacts during one impact: which are released, and which compressed or expanding."""

    def __init__(self, W: Array, v: Array, eps: Array, k: Array, m: float) -> None:
        self.W, self.v0, self.eps, self.k, self.m = W, v, eps, k, m
        self.n = len(v)
        self.plastic = eps == 0.0
        # What the indentation falls by per distance travelled apart.
        self.recoil = 1.0 / np.where(self.plastic, 1.0, eps) ** 2
        self.released: Bools = v > 0.0

    def run(self, rtol: float, limit: int) -> tuple[Array, int]:
        from scipy.integrate import solve_ivp

        n = self.n
        y = np.zeros(2 * n)
        for pieces in range(limit):
            y = self.decide(y, rtol)
            if self.over(y):
                return y[:n], pieces
            rates = self.rates()
            options = {"method": "DOP853", "rtol": rtol, "atol": rtol}
            done = solve_ivp(rates, (0.0, 1e9), y, events=self.end_of_phase(y), **options)
            if done.status != 1:
                raise NumericsError(
                    f"the compliant impact did not reach its next phase ({done.message})",
                    code="HB-J204",
                    hint="are the stiffnesses many orders of magnitude apart? use poisson",
                )
            # The event is found on the interpolant, the state there by a step of its own, which
            # ends past the root by more than the root's tolerance.
            near, root = done.t[-2:]
            span = (near, root * (1.0 + PAST) + PAST)
            y = solve_ivp(rates, span, done.y[:, -2], **options).y[:, -1]
        raise NumericsError(
            f"the contacts are still active after {limit} phases of compression and expansion",
            code="HB-J204",
            hint="use poisson, or a restitution of 0 instead of a very small one",
        )

    def speeds(self, y: Array) -> Array:
        speeds: Array = self.v0 + self.W @ y[: self.n]
        return speeds

    def forces(self, y: Array) -> Array:
        d = np.maximum(y[self.n :], 0.0)
        force: Array = np.where(self.released, 0.0, self.k * d**self.m)
        return force

    def rates(self) -> Callable[[float, Array], Array]:
        """Return the right-hand side in the present phases: the inner loop of all this."""
        n, W, v0, m = self.n, self.W, self.v0, self.m
        k = np.where(self.released, 0.0, self.k)
        coming = np.where(self.released, 0.0, -1.0)
        leaving = coming * self.recoil

        def rates(t: float, y: Array) -> Array:
            out = np.empty(2 * n)
            force = np.maximum(y[n:], 0.0)
            if m != 1.0:
                force **= m
            force *= k
            v = W @ y[:n]
            v += v0
            out[:n] = force
            np.multiply(v, np.where(v > 0.0, leaving, coming), out=out[n:])
            return out

        return rates

    def over(self, y: Array) -> bool:
        """Whether nothing approaches and nothing is stored."""
        stored = self.forces(y) @ np.maximum(y[self.n :], 0.0) / (self.m + 1.0)
        return bool(np.max(-self.speeds(y)) <= REST and stored <= REST**2)

    def decide(self, y: Array, rtol: float) -> Array:
        """Give each contact its phase, from velocities and indentations alone."""
        n = self.n
        d = np.maximum(y[n:], 0.0)
        v = self.speeds(y)
        self.released = np.where(self.released, v >= 0.0, (d <= 0.0) & (v > 0.0))
        d[self.released] = 0.0
        y = np.concatenate([y[:n], d])
        stopped = (self.plastic & (d > 0.0) & (v >= -10 * MARGIN)).nonzero()[0]
        if len(stopped):
            d[stopped] = self.drop(stopped, y, rtol)
            self.released[stopped] = (d[stopped] <= 0.0) & (v[stopped] > 0.0)
        return np.concatenate([y[:n], d])

    def drop(self, stopped: Indices, y: Array, rtol: float) -> Array:
        """Indentations of plastic contacts after their expansion, which takes no time."""
        from scipy.integrate import solve_ivp

        n = len(stopped)
        W, k, d = self.W[np.ix_(stopped, stopped)], self.k[stopped], y[self.n + stopped]
        force = self.forces(y)
        force[stopped] = 0.0
        load = (self.W @ force)[stopped]

        def rates(s: float, y: Array) -> Array:
            a = W @ (k * np.maximum(y[n:], 0.0) ** self.m) + load
            return np.concatenate([a, -np.maximum(y[:n], 0.0)])

        def expands(s: float, y: Array) -> float:
            return float(np.max(np.where(y[n:] > 0.0, y[:n], -1.0)))

        expands.terminal = True  # type: ignore[attr-defined]
        expands.direction = -1.0  # type: ignore[attr-defined]
        start = np.concatenate([np.zeros(n), d])
        done = solve_ivp(
            rates, (0.0, 1e9), start, method="DOP853", rtol=rtol, atol=rtol, events=expands
        )
        left: Array = done.y[n:, -1]
        return np.where(left <= rtol, 0.0, left)

    def end_of_phase(self, y: Array) -> Callable[[float, Array], float]:
        """Return a function that falls through zero where the first contact changes its phase."""
        n = self.n
        free = ~self.released
        corner = free & (self.eps != 1.0)  # the rates have a corner at v = 0
        v = self.speeds(y)
        turns = np.where(np.abs(v) > MARGIN, v, self.W @ self.forces(y)) > 0.0
        way = np.where(turns, 1.0, -1.0)[corner]

        def left(y: Array) -> Array:
            v = self.speeds(y)
            return np.concatenate([y[n:][free], v[self.released], way * v[corner]])

        margin = MARGIN + np.maximum(-left(y), 0.0)

        def event(t: float, y: Array) -> float:
            return float(np.min(left(y) + margin))

        event.terminal = True  # type: ignore[attr-defined]
        event.direction = -1.0  # type: ignore[attr-defined]
        return event
