"""The laws of impacts of the engine on numbers, as Python runs it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.engine.impacts.compliant import compress
from hybond.engine.impacts.impact_laws import exchange_impulses
from hybond.engine.impacts.impact_records import (
    CANNOT_STOP,
    CREATES_ENERGY,
    DEPENDS,
    EXCHANGED,
    NEVER_ENDS,
    make_impact,
)
from hybond.engine.impacts.impact_records import Impact as Record
from hybond.engine.tables.options import IMPACTS

LAWS = [name for name in IMPACTS if name != "newton"]
"""Those that see all closed contacts at once."""
CODES = {
    CREATES_ENERGY: "HB-J201",
    DEPENDS: "HB-J202",
    CANNOT_STOP: "HB-J203",
    NEVER_ENDS: "HB-J204",
}


@dataclass(frozen=True)
class Impact:
    """What contacts exchanged; `flags` say whether impulses are shared."""

    after: NDArray[np.float64]
    impulses: NDArray[np.float64]
    active: tuple[int, ...]
    energy: float
    shared: bool
    error: float
    pieces: int


class Refused(Exception):
    """An impact has no answer by its law."""

    def __init__(self, code: str, contacts: list[int]) -> None:
        super().__init__(code)
        self.code = code
        self.contacts = contacts


def record(W: ArrayLike, v: ArrayLike, eps: ArrayLike, stiffness: ArrayLike, m: float) -> Record:
    """Return the impact as the engine has it."""
    speeds = np.asarray(v, dtype=float).tolist()
    n = len(speeds)
    i = make_impact(n)
    i.n, i.w, i.v, i.exponent = n, np.asarray(W, dtype=float).ravel().tolist(), speeds, m
    i.eps = np.broadcast_to(np.asarray(eps, dtype=float), n).tolist()
    i.stiffness = np.broadcast_to(np.asarray(stiffness, dtype=float), n).tolist()
    return i


def impact(
    W: ArrayLike,
    v: ArrayLike,
    *,
    eps: ArrayLike,
    law: str,
    stiffness: ArrayLike = 1.0,
    exponent: float = 1.0,
) -> Impact:
    """Return what contacts exchange that are closed."""
    i = record(W, v, eps, stiffness, exponent)
    found = exchange_impulses(i, IMPACTS[law])
    if found != EXCHANGED:
        raise Refused(CODES[found], np.flatnonzero(i.blamed).tolist())
    active = tuple(np.flatnonzero(np.array(i.impulses) > 0.0).tolist())
    return Impact(
        np.array(i.after),
        np.array(i.impulses),
        active,
        i.energy,
        i.shared,
        i.error,
        i.springs.pieces,
    )


def compliant_impact(W: Any, v: Any, *, eps: Any, stiffness: Any, **options: Any) -> Impact:
    """Return what contacts exchange that are stiff springs."""
    i = record(W, v, eps, stiffness, options.get("exponent", 1.0))
    if not compress(i, options.get("rtol", 1e-12), options.get("max_pieces", 2000)):
        raise Refused("HB-J204", [])
    z = np.array(i.impulses)
    return Impact(np.array([]), z, (), 0.0, False, i.error, i.springs.pieces)
