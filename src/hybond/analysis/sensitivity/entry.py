"""What entering a mode makes of the variations of what is stored: its map, differentiated.

    x+ = x + D nu,    G z(x+) = c          (the jump that conserves state)

The bond variables w+ after the jump and the impulse areas J satisfy

    r(w+, x+, t, p, pre) = 0,   r_J(J, pre, p) = 0,   x+ = x + R J        R: which areas are rates

so that, all differentiated together, with the unknowns dw and dJ,

    r_w dw + r_x R dJ = -(r_x dx + r_t dt + r_p dp + r_pre dpre)
    r_JJ dJ           = -(r_Jp dp + r_Jpre dpre)

and dx+ = dx + R dJ. Shares that the mode leaves open fall out of it, or there is no answer.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.fields import Field
from hybond.analysis.sensitivity.gradients import AREA
from hybond.analysis.sensitivity.solving import opens, smallest
from hybond.analysis.sensitivity.tangent import At, Tangent, Undetermined

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Before:
    """What is varied before a mode is entered, as columns of some basis.

    Parameters
    ----------
    x : array, shape (states, basis)
    t : array, shape (basis,)
    p : array, shape (parameters, basis)
    field : Field
        Of the mode in which a priori values are.
    written : array, shape (states, basis)
        The state of that mode: what was written last.
    """

    x: Vector
    t: Vector
    p: Vector
    field: Field
    written: Vector

    def prior(self, name: str) -> Vector:
        """Return how an a priori value is varied, shape (basis,)."""
        kind, _, index = name.partition(":")
        columns = self.field.tangent.columns
        if name in columns.states:
            return np.asarray(self.written[columns.states.index(name)])
        if name == "time":
            return self.t
        if kind == "u":
            k = int(index)
            rate = float(np.ravel(self.field.at.values[f"du:{k}"])[0])
            return np.asarray(rate * self.t + self.field.at.inputs[0, k] @ self.p)
        if kind in ("e", "f"):
            row = self.field.tangent.rows.bonds.index(name)
            written = np.vstack([self.written, self.t[None], self.p])
            return np.asarray(self.field.bonds[0, row] @ written)
        return np.zeros_like(self.t)

    @property
    def all(self) -> Vector:
        """All columns: states, time, parameters."""
        return np.vstack([self.x, self.t[None], self.p])


def entered(tangent: Tangent, at: At, areas: Mapping[str, float], before: Before) -> Vector:
    """Return how the state is varied after a mode was entered, shape (states, basis).

    Parameters
    ----------
    at : At
        Values after the jump in that mode, one point.
    areas : mapping
        The impulse areas of bond variables, by canonical name.

    Raises
    ------
    Undetermined
        If the mode leaves open how the state is varied.
    """
    bonds = tangent.rows.bonds
    slopes = tangent.of_entry
    by_w, direct = tangent.slopes(at)
    rates = np.zeros((len(tangent.columns.states), len(bonds)))
    moves = slopes.moves.at(at.values, 1)[0]
    rates[: len(moves)] = moves
    rates = rates @ tangent.rows.spread
    by_w, by_x = by_w[0], direct[0][:, : len(rates)]
    held = direct[0] @ before.all
    if tangent.prior:
        prior = np.array([before.prior(name) for name in tangent.prior])
        held = held + tangent.by_prior(at)[0] @ prior
    # impulse areas: the same structure, with moduli as they were
    values = {**before.field.at.values, **{AREA + n_: areas.get(n_, 0.0) for n_ in bonds}}
    by_area = slopes.by_area.at(values, 1)[0] @ tangent.rows.spread
    area_held = np.zeros((len(by_area), held.shape[1]))
    if areas:
        area_held = slopes.direct.at(At(values, before.field.at.inputs, 1))[0] @ before.all
        by_bonds = slopes.by_bonds.at(values, 1)[0]
        if by_bonds.any():
            area_held += by_bonds @ np.array([before.prior(name) for name in bonds])
    w = by_w.shape[1]
    left = np.zeros((len(by_w) + len(by_area), 2 * w))
    left[: len(by_w), :w], left[: len(by_w), w:] = by_w, by_x @ rates
    left[len(by_w) :, w:] = by_area
    right = np.vstack([held, area_held])
    if opens(left, np.hstack([np.zeros_like(rates), rates])):
        raise Undetermined("the mode that is entered leaves open how its state is shared")
    found = smallest(left[None], -right[None])[0]
    off = left @ found + right
    size = np.abs(left) @ np.abs(found) + np.abs(right)
    if (np.abs(off) > 1e-6 * size.max(axis=0, initial=0.0)).any():
        raise Undetermined("nearby states would have no jump into the mode that is entered")
    return np.asarray(before.x + rates @ found[w:])
