"""What a run slid in: which surfaces, and which modes were combined."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.rows import Rows
from hybond.equations.surfaces import Surface
from hybond.model.graph import Mode
from hybond.records import dataclass

Kind = Literal["additive", "product"]


@dataclass(frozen=True, slots=True)
class Combination:
    """The modes around some surfaces, as they are combined."""

    surfaces: tuple[int, ...] = ()
    """Their numbers in the tables; none if nothing is slid on."""
    product: bool = False
    """Whether all corners of the cube of their weights are combined."""
    mode: Mode = ()
    """The mode shown."""
    modes: NDArray[np.intc] | None = None
    """Shape (parts, machines), or None. The states of machines in each mode that is combined."""
    meant: tuple[int, ...] = ()
    """Of each junction law: 1 if it is friction that rests on the mean of these modes alone."""

    def of(self, machines: int) -> Combination:
        """Return the same of the first machines alone."""
        if len(self.mode) <= machines:
            return self
        modes = None if self.modes is None else np.ascontiguousarray(self.modes[:, :machines])
        return replace(self, mode=self.mode[:machines], modes=modes)

    def is_like(self, other: Combination) -> bool:
        """Whether the same surfaces are slid on in the same way."""
        return set(self.surfaces) == set(other.surfaces) and self.product == other.product


def flipped(mode: Mode, surfaces: Sequence[Surface], above: Sequence[int]) -> Mode:
    """Return a mode with the surfaces' machines below (0) or above (1)."""
    states = list(mode)
    for s, up in zip(surfaces, above, strict=True):
        states[s.machine] = s.above if up else s.below
    return tuple(states)


def corners_of(k: int, kind: Kind) -> list[tuple[int, ...]]:
    """Return the corners of the cube of weights whose fields a combination takes."""
    if kind == "product":
        return list(product((0, 1), repeat=k))
    return [(0,) * k, *(tuple(int(i == j) for i in range(k)) for j in range(k))]


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
        every, parts = rows.slid[at + 1 : at + 3].tolist()
        at += 3
        surfaces = tuple(rows.slid[at : at + many].tolist())
        at += many
        states = rows.slid[at : at + (1 + parts) * machines].reshape(1 + parts, machines)
        at += (1 + parts) * machines
        ports = int(rows.slid[at])
        meant = tuple(rows.slid[at + 1 : at + 1 + ports].tolist())
        at += 1 + ports
        yield t, Combination(surfaces, bool(every), tuple(states[0].tolist()), states[1:], meant)
