"""How the laws of junctions feel each other over a step: ``w = M l + q``, made once per mode.

`M` is what algebra and storage pass on within the step. Where they cancel (a law between
inductors that are in series already) rounding is left, which a complementarity problem would take
for a law that something can be done about; such entries are set to zero by the size of their terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.equations.leakage import null_space
from hybond.solvers.lcp import positive_semidefinite
from hybond.solvers.pivoting import balance

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]

IDLE = 1e-14
"""Part of the largest response below which a law does nothing."""
ROUNDED = 1e-13
"""An entry of the coupling below this part of its terms is rounding."""
MOVES = 1e-7
"""Part of its terms from which a sum counts as moved by a share."""


@dataclass(slots=True)
class Coupling:
    """The laws over one step, linearised.

    Parameters
    ----------
    gain : array, shape (bond variables, ports)
        Bond variables at the end of the step by `l`.
    push : array, shape (states, ports)
        The state at the end of the step by `l`.
    M : array, shape (ports, ports)
        ``w`` by `l`.

    Examples
    --------
    The same contact twice: what one of them carries more and the other less moves nothing.

    >>> twice = Coupling(np.ones((1, 2)), np.ones((1, 2)), np.ones((2, 2)))
    >>> twice.semidefinite, np.abs(twice.still).round(3).tolist()
    (True, [[1.0], [1.0]])
    """

    gain: Matrix
    push: Matrix
    M: Matrix
    _known: dict[str, object] = field(default_factory=dict)

    @property
    def deaf(self) -> Mask:
        """Laws whose `w` nothing changes: below zero it is rounding, or there is no solution."""
        return np.asarray(~self.M.any(axis=1))

    @property
    def idle(self) -> Mask:
        """Laws that neither change any `w` nor feel any `l`."""
        return np.asarray(self.deaf & ~self.M.any(axis=0))

    @property
    def semidefinite(self) -> bool:
        """Whether the laws of any of its ports have one convex set of solutions."""
        if "semidefinite" not in self._known:
            self._known["semidefinite"] = positive_semidefinite(self.M)
        return bool(self._known["semidefinite"])

    @property
    def still(self) -> Matrix:
        """The `l` that may differ between two solutions: columns, mostly none.

        Those that no power is spent on, for a passive graph; elsewhere those that change no `w`.
        They leave what is stored alone.
        """
        if "still" not in self._known:
            self._known["still"] = self._still()
        return np.asarray(self._known["still"])

    def still_at(self, q: Vector, slopes: Sequence[Vector]) -> Matrix:
        """Return what two solutions of the laws at `q` may differ by.

        `slopes` are those of limits of friction: a share on which a limit depends is not free.
        All solutions z of a monotone problem agree in ``(M + M') z`` and ``q z`` (Cottle, Pang and
        Stone, *The Linear Complementarity Problem*, theorem 3.1.7).
        """
        still = self.still
        rows = [*slopes, q] if self.semidefinite else list(slopes)
        if not rows or not still.shape[1]:
            return still
        seen = cleared(np.array(rows), still)
        seen = seen[seen.any(axis=1)]
        return still @ null_space(seen) if len(seen) else still

    def _still(self) -> Matrix:
        n = len(self.M)
        # units apart: efforts and flows are of very different sizes
        d = balance(self.M)
        scaled = self.M * d * d[:, None]
        if self.semidefinite:
            scaled = scaled + scaled.T
        if n and not _singular(scaled):
            return np.zeros((n, 0))
        basis = d[:, None] * null_space(scaled)
        basis = basis / np.abs(basis).max(axis=0, initial=0.0)
        moved = cleared(self.push, basis)
        moved = moved[moved.any(axis=1)]
        return np.asarray(basis @ null_space(moved) if len(moved) else basis)


def cleared(rows: Matrix, basis: Matrix) -> Matrix:
    """Return ``rows @ basis`` with what is nothing but cancellation as zero."""
    product = rows @ basis
    return np.where(np.abs(product) <= MOVES * (np.abs(rows) @ np.abs(basis)), 0.0, product)


def couple(
    partner: Matrix, gain: Matrix, push: Matrix, state: Matrix, noise: Matrix | None = None
) -> Coupling:
    """Return the coupling of laws whose graph answers to `l` and to the state.

    Parameters
    ----------
    partner : array, shape (ports, bond variables)
        ``w`` by bond variables.
    gain : array, shape (bond variables, ports)
        Bond variables by `l`, the state being held.
    push : array, shape (states, ports)
        The state at the end of the step by `l`.
    state : array, shape (bond variables, states)
        Bond variables by the state, `l` being held.
    noise : array, shape (bond variables, ports), optional
        What rounding is in the whole gain, if it is more than that of exact matrices.
    """
    whole = gain + state @ push
    M = partner @ whole
    terms = np.abs(gain) + np.abs(state) @ np.abs(push)
    doubt = ROUNDED * (np.abs(partner) @ terms)
    if noise is not None:
        doubt = doubt + np.abs(partner) @ noise
    M = np.where(np.abs(M) <= doubt, 0.0, M)
    small = np.abs(M) <= IDLE * np.abs(M).max(initial=0.0)
    idle = small.all(axis=1) & small.all(axis=0)
    M[idle] = 0.0
    M[:, idle] = 0.0
    return Coupling(whole, push, M)


def _singular(scaled: Matrix) -> bool:
    """Whether a balanced matrix may be singular: cheap, and no if it clearly is not."""
    try:
        inverse = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        return True
    size = np.abs(inverse).sum(axis=0).max() * np.abs(scaled).sum(axis=0).max()
    return not size < 1e9
