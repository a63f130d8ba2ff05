"""What a slice of a run wrote down, as arrays, and what is read of a run by the library."""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

MACHINES_OF_STEP = 2
"""Where the states of machines begin in a row of `step_place`."""
MACHINES_OF_INSTANT = 3
_ENDS = ("settling", "rejected", "stuck_machine", "stuck_events", "stuck_why")
_COUNTS = (
    *("steps", "instants", "visits", "fireds", "hits", "reads", "overs", "opens", "slids"),
    *("slides", "warns", "abouts"),
)
_FLOATS = (
    *("step_time", "step_until", "step_state", "step_dense"),
    *("instant_time", "instant_state", "visit_energy", "hit_area", "read"),
    *("slide_time", "warn_time", "about"),
)
_INTS = (
    *("step_place", "instant_place", "visit", "fired", "hit", "over", "open", "slid"),
    *("warn", "warn_first"),
)


class Seen(ctypes.Structure):
    """What is read of a run: as `HybondSeen` in ``library.c``."""

    _fields_ = (
        ("y", ctypes.POINTER(ctypes.c_double)),
        ("state", ctypes.POINTER(ctypes.c_int)),
        ("tried", ctypes.POINTER(ctypes.c_int)),
        ("t", ctypes.c_double),
        ("energy", ctypes.c_double),
        *((name, ctypes.c_int) for name in ("status", "states", "evaluations", "modes_made")),
        ("propagated", ctypes.POINTER(ctypes.c_int)),
        *((n, ctypes.c_int) for n in _ENDS),
        *((n, ctypes.c_double) for n in ("stuck_t", "stuck_ratio")),
        *((n, ctypes.c_int) for n in _COUNTS),
        *((n, ctypes.POINTER(ctypes.c_double)) for n in _FLOATS),
        *((n, ctypes.POINTER(ctypes.c_int)) for n in _INTS),
        ("bond_rows", ctypes.c_int),
        *(
            (n, ctypes.POINTER(ctypes.c_double))
            for n in ("step_bonds", "step_energy", "instant_since")
        ),
        ("step_bond", ctypes.POINTER(ctypes.c_int)),
    )


@dataclass(frozen=True, slots=True)
class Rows:
    """What a slice of a run wrote down; `hybond.engine.run.log` says what the columns are.

    Parameters
    ----------
    step_time : array, shape (steps, 3)
        Begin and end of each step, and where it was ended, s.
    step_until : array, shape (steps,)
        The next timed event, s.
    step_state : array, shape (steps, 3, states)
        The state there.
    step_dense : array, shape (steps, 4, states)
    step_place : array of int, shape (steps, 2 + 2 machines)
    instant_time : array, shape (instants, 2)
    instant_state : array, shape (instants, 2, states)
        Before and after.
    instant_place : array of int, shape (instants, 3 + 2 machines)
    visit : array of int, shape (visits, 5)
    visit_energy : array, shape (visits, 3)
    fired : array of int, shape (transitions, 6)
    read : array, shape (values, 3)
    hit : array of int, shape (hits,)
    hit_area : array, shape (hits, 2)
    over, open, slid : arrays of int
    slide_time : array, shape (slides,)
    warn, warn_first : arrays of int, shape (warnings,), (warnings + 1,)
        Their kinds, and where their numbers begin in `about`.
    warn_time, about : array
    step_bonds : array, shape (points, 2 bonds)
        Of time-stepping: bond variables where steps end, and where a motion begins.
    step_energy : array, shape (steps or 0, 3)
    instant_since : array, shape (instants,)
        When the step began within which it happened, s; -1 where it was located.
    step_bond : array of int, shape (steps or 0,)
    """

    step_time: NDArray[np.float64]
    step_until: NDArray[np.float64]
    step_state: NDArray[np.float64]
    step_dense: NDArray[np.float64]
    step_place: NDArray[np.intc]
    instant_time: NDArray[np.float64]
    instant_state: NDArray[np.float64]
    instant_place: NDArray[np.intc]
    visit: NDArray[np.intc]
    visit_energy: NDArray[np.float64]
    fired: NDArray[np.intc]
    read: NDArray[np.float64]
    hit: NDArray[np.intc]
    hit_area: NDArray[np.float64]
    over: NDArray[np.intc]
    open: NDArray[np.intc]
    slid: NDArray[np.intc]
    slide_time: NDArray[np.float64]
    warn: NDArray[np.intc]
    warn_first: NDArray[np.intc]
    warn_time: NDArray[np.float64]
    about: NDArray[np.float64]
    step_bonds: NDArray[np.float64]
    step_energy: NDArray[np.float64]
    instant_since: NDArray[np.float64]
    step_bond: NDArray[np.intc]


def copied_floats(begin: Any, *shape: int) -> NDArray[np.float64]:
    """Return an array of numbers of the library as our own."""
    size = math.prod(shape)
    return np.ctypeslib.as_array(begin, (size,)).reshape(shape).copy() if size else np.zeros(shape)


def copied_ints(begin: Any, *shape: int) -> NDArray[np.intc]:
    """Return an array of whole numbers of the library as our own."""
    size = math.prod(shape)
    if not size:
        return np.zeros(shape, dtype=np.intc)
    return np.ctypeslib.as_array(begin, (size,)).reshape(shape).copy()
