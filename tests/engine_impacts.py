"""The laws of impacts of the engine on numbers, as Python runs it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from hybond.engine.impacts.compliant import compress
from hybond.engine.impacts.impact_laws import exchange_impulses
from hybond.engine.impacts.impact_records import CREATES_ENERGY, DEPENDS, EXCHANGED, make_impact
from hybond.engine.impacts.impact_records import Impact as Record
from hybond.engine.tables.options import IMPACTS
from hybond.errors import ModelError, NumericsError
from hybond.modes.impacts import laws as reference
from hybond.modes.impacts.case import Case
from hybond.modes.impacts.compliant import Compliant


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
    law: str = "newton",
    stiffness: ArrayLike = 1.0,
    exponent: float = 1.0,
    names: Sequence[str] = (),
) -> reference.Impact:
    """Return what `hybond.modes.impacts.laws.impact` does, by the engine.

    Contact after contact it has no law on numbers: there, and for numbers without meaning, it is
    the reference itself.
    """
    if law not in IMPACTS or law == "newton" or not np.all(np.asarray(stiffness) > 0.0):
        return reference.impact(
            W, v, eps=eps, law=law, stiffness=stiffness, exponent=exponent, names=names
        )
    case = Case.of(W, v, eps, law, names, 0.0)
    i = record(case.W, case.v, case.eps, stiffness, exponent)
    found = exchange_impulses(i, IMPACTS[law])
    if found != EXCHANGED:
        kind = ModelError if found == DEPENDS else NumericsError
        code = {CREATES_ENERGY: "HB-J201", DEPENDS: "HB-J202"}.get(found, f"HB-J20{found}")
        raise kind("", code=code, where=case.called(np.flatnonzero(i.blamed)))
    active = np.flatnonzero(np.array(i.impulses) > 0.0)
    flags = ("shares",) * i.shared + ("restitution",) * bool((case.eps[active] > 1.0).any())
    return reference.Impact(
        law,
        case.v,
        np.array(i.after),
        np.array(i.impulses),
        tuple(active.tolist()),
        i.energy,
        flags,
        i.error,
        i.springs.pieces,
    )


def compliant_impact(W: Any, v: Any, *, eps: Any, stiffness: Any, **options: Any) -> Compliant:
    """Return what `hybond.modes.impacts.compliant.compliant_impact` does, by the engine."""
    i = record(W, v, eps, stiffness, options.get("exponent", 1.0))
    if not compress(i, options.get("rtol", 1e-12), options.get("max_pieces", 2000)):
        raise NumericsError("", code="HB-J204")
    return Compliant(np.array(i.impulses), i.error, i.springs.pieces)
