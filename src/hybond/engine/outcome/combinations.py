"""What a run slid in: which surfaces, and which modes were combined."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.native import Rows
from hybond.model.graph import Mode


@dataclass(frozen=True, slots=True)
class Combination:
    """The modes around some surfaces, as they are combined.

    Parameters
    ----------
    surfaces : tuple of int
        Their numbers in the tables; none if nothing is slid on.
    product : bool
        Whether all corners of the cube of their weights are combined.
    mode : Mode
        The mode shown.
    modes : array of int, shape (parts, machines), or None
        The states of machines in each mode that is combined.
    """

    surfaces: tuple[int, ...] = ()
    product: bool = False
    mode: Mode = ()
    modes: NDArray[np.intc] | None = None

    def is_like(self, other: Combination) -> bool:
        """Whether the same surfaces are slid on in the same way."""
        return set(self.surfaces) == set(other.surfaces) and self.product == other.product


ALONE = Combination()
"""Nothing is slid on."""


def combinations(rows: Rows, machines: int) -> Iterator[tuple[float, Combination]]:
    """Yield the combinations that begin in a slice of a run, with when they do."""
    at = 0
    for t in rows.slide_time.tolist():
        many = int(rows.slid[at])
        if many == 0:
            yield t, ALONE
            at += 1
            continue
        product, parts = rows.slid[at + 1 : at + 3].tolist()
        at += 3
        surfaces = tuple(rows.slid[at : at + many].tolist())
        at += many
        states = rows.slid[at : at + (1 + parts) * machines].reshape(1 + parts, machines)
        at += (1 + parts) * machines
        yield t, Combination(surfaces, bool(product), tuple(states[0].tolist()), states[1:])
