"""A refusal of the engine as it says it: code, reason, place, and numbers."""

from __future__ import annotations

import ctypes

from hybond.records import dataclass


class FaultSeen(ctypes.Structure):
    """What is read of a refusal: as `HybondFault` in ``library.c``."""

    _fields_ = (
        *((name, ctypes.c_char_p) for name in ("code", "why", "place")),
        ("t", ctypes.c_double),
        ("many", ctypes.c_int),
        ("about", ctypes.POINTER(ctypes.c_double)),
    )


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a run was refused, as the engine says it."""

    code: str
    why: str
    place: str
    """`code`, `why` and `place`: empty texts if nothing was."""
    t: float
    """s."""
    about: tuple[float, ...]
    """What is known of it: `hybond.engine.reasons.facts` says what the numbers are."""


def refusal_of(library: ctypes.CDLL, run: ctypes.c_void_p, which: int) -> Refusal:
    """Return why a run stopped, 0, or why what was struck in it cannot rest, 1."""
    seen = FaultSeen()
    library.hybond_fault(run, ctypes.c_int(which), ctypes.byref(seen))
    code, why, place = ((t or b"").decode() for t in (seen.code, seen.why, seen.place))
    return Refusal(code, why, place, seen.t, tuple(seen.about[k] for k in range(seen.many)))
