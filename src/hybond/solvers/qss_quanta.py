"""Quantisation of one state: when it leaves its band, and where a new quantised state is put.

``x`` is a state, ``q`` its quantised state, both polynomials of the time ``s`` since now; ``d`` is
``x - q``. Coefficients are listed from the constant up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

_FAR = 1e200
"""A time that is never reached, whatever the unit."""
_WEAK = 0.1
"""Own feedback times duration below which a state is quantised as if it had none."""
_ITERATIONS = 80


def leaves(d: Sequence[float], quantum: float) -> float:
    """Return the first ``s >= 0`` at which ``|d(s)| >= quantum``; inf if there is none.

    Between its extrema a polynomial is monotone, so that the first piece whose end is outside the
    band holds exactly one crossing.

    Parameters
    ----------
    d : sequence of float
        Two to four coefficients.
    quantum : float
        Half the width of the band, positive.

    Examples
    --------
    >>> leaves([0.0, 0.0, 0.0, 8.0], 1.0)
    0.5
    >>> round(leaves([0.5, -3.0, 1.0], 1.0), 9)     # falls to -1 before it rises to 1
    0.633974596
    >>> leaves([0.5, 0.0], 1.0)
    inf
    """
    d0, d1, d2, d3 = (*d, 0.0, 0.0)[:4]
    if not abs(d0) < quantum:
        return 0.0
    if d0 == 0.0 and d1 == 0.0 and (d2 == 0.0 or d3 == 0.0):
        if d2 == 0.0:
            return (quantum / abs(d3)) ** (1.0 / 3.0) if d3 else math.inf
        return math.sqrt(quantum / abs(d2))
    low = 0.0
    for end in _extrema(d1, d2, d3):
        if abs(d0 + end * (d1 + end * (d2 + end * d3))) >= quantum:
            return _crossing(d0, d1, d2, d3, quantum, low, end)
        low = end
    reach = [(quantum / abs(a)) ** (1.0 / k) for k, a in ((1, d1), (2, d2), (3, d3)) if a != 0.0]
    if not reach:
        return math.inf
    step = min(reach)
    if step == 0.0:
        # a coefficient beyond all bounds; whoever makes the step will find the state not finite
        return low
    high = low + step
    while not abs(d0 + high * (d1 + high * (d2 + high * d3))) >= quantum:
        step *= 2.0
        high = low + step
        if not high < _FAR:
            return math.inf
    return _crossing(d0, d1, d2, d3, quantum, low, high)


def _extrema(d1: float, d2: float, d3: float) -> list[float]:
    """Return the positive roots of ``d1 + 2 d2 s + 3 d3 s^2``, ascending."""
    root = d2 * d2 - 3.0 * d3 * d1
    if not root > 0.0:
        return []
    far = -(d2 + math.copysign(math.sqrt(root), d2))
    found = {s for s in (far / (3.0 * d3) if d3 else 0.0, d1 / far) if 0.0 < s < _FAR}
    return sorted(found)


def _crossing(
    d0: float, d1: float, d2: float, d3: float, quantum: float, low: float, high: float
) -> float:
    """Return where ``|d|`` reaches `quantum` in a bracket where it does so once (Newton)."""
    sign = 1.0 if d0 + high * (d1 + high * (d2 + high * d3)) > 0.0 else -1.0
    s = 0.5 * (low + high)
    for _ in range(_ITERATIONS):
        value = sign * (d0 + s * (d1 + s * (d2 + s * d3))) - quantum
        if value >= 0.0:
            high = s
        else:
            low = s
        slope = sign * (d1 + s * (2.0 * d2 + s * 3.0 * d3))
        new = s - value / slope if slope > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) <= 1e-13 * new or new in (low, high):
            return new
        s = new
    return high


def place(x: float, u: Sequence[float], a: float, *, quantum: float) -> tuple[list[float], float]:
    """Return a linearly implicit quantised state, and for how long it serves.

    Of ``x' = a q + u`` with ``a < 0``: the polynomial `q` that `x` will touch with all but its
    last derivative, ``x - q = c (s - h)^n``, at the largest ``h`` for which it begins no further
    than half a quantum from `x`. If that is so for every h, `q` is where x stops changing its
    n-th derivative, and serves until something else changes: a fast state rests on its
    equilibrium instead of chattering about it. With own feedback that is weak over h, or none or
    unstable, `q` is the ordinary one of QSS, `x` itself.

    Parameters
    ----------
    x : float
        The state now.
    u : sequence of float, length n
        Coefficients of what changes it besides itself; n is the order.
    a : float
        Its own feedback, the diagonal of the Jacobian, 1/s.
    quantum : float
        Half the width of the band.

    Returns
    -------
    q : list of float, length n
    h : float
        Seconds until `x` touches `q`, where a new one is due; inf for an equilibrium, and if
        leaving the band is what ends it.

    References
    ----------
    G. Migoni, M. Bortolotto, E. Kofman, F. E. Cellier, "Linearly implicit quantization-based
    integration methods for stiff ordinary differential equations", Simul. Model. Pract. Theory
    35, 2013. The condition of touching is the one of order n written as one formula.

    Examples
    --------
    >>> place(1.0, [0.0], -1000.0, quantum=0.25)         # x' = -1000 q: an eighth below
    ([0.875], 0.000142857)
    >>> place(0.1, [0.0], -1000.0, quantum=0.25)         # within the band of its equilibrium
    ([0.0], inf)
    """
    n = len(u)
    q, alpha = _taylor(x, u, a, [0.0] * n)
    if alpha == 0.0:
        return q, math.inf
    plain = (quantum / abs(alpha)) ** (1.0 / n)
    if not a * plain < -_WEAK:
        return q, math.inf
    band = 0.5 * quantum
    factorial = math.factorial(n)
    last = alpha * factorial * (-1.0) ** n / abs(a) ** n
    if abs(last) <= band:
        return _taylor(x, u, a, [last] + [0.0] * (n - 1))[0], math.inf
    h = _duration(abs(alpha) / band, -a, n)
    c = alpha / sum((-a * h) ** k / math.factorial(k) for k in range(n + 1))
    ahead = [c * math.comb(n, k) * (-h) ** (n - k) for k in range(n)]
    return _taylor(x, u, a, ahead)[0], h


def _taylor(
    x: float, u: Sequence[float], a: float, ahead: Sequence[float]
) -> tuple[list[float], float]:
    """Return `q` with ``x - q`` beginning with the coefficients `ahead`, and the last of x."""
    q: list[float] = []
    for k, (input_, difference) in enumerate(zip(u, ahead, strict=True)):
        q.append(x - difference)
        x = (a * q[k] + input_) / (k + 1)
    return q, x


def _duration(ratio: float, rate: float, n: int) -> float:
    """Return the h with ``ratio h^n = sum (rate h)^k / k!``, k to n (Newton in 1/h).

    As a polynomial of 1/h it is convex and rising, and the start is to the right of its root.
    """
    coefficients = [rate**k / math.factorial(k) for k in range(n + 1)]
    v = float(ratio ** (1.0 / n))
    for _ in range(_ITERATIONS):
        value, slope = 0.0, 0.0
        for b in coefficients:
            value, slope = value * v + b, slope * v + value
        change = (value - ratio) / slope
        v -= change
        if change <= 1e-14 * v:
            break
    return 1.0 / v
