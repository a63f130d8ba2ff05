"""What a slice of a run wrote down, as arrays, and what is read of a run by the library."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.kept_rows import StateRows
from hybond.records import dataclass

MACHINES_OF_STEP = 2
"""Where the states of machines begin in a row of `step_place`."""
MACHINES_OF_INSTANT = 3
COUNTS = (
    *("steps", "instants", "visits", "fireds", "hits", "reads", "overs", "opens", "slids"),
    *("slides", "rejected", "bond_rows", "turns"),
)
"""Numbers of the log; those of its warnings are beside them."""
FLOATS = (
    *("step_time", "step_until", "step_state", "step_dense", "step_bonds", "step_energy"),
    *("instant_time", "instant_state", "instant_since", "visit_energy", "hit_area", "read"),
    *("slide_time", "turn_time"),
)
INTS = (
    *("step_place", "step_bond", "instant_place", "visit", "fired", "hit", "over", "open", "slid"),
)
STEPS = ("step_time", "step_until", "step_state", "step_dense", "step_place")
"""Columns with a row for each step."""
STATES = ("step_state", "instant_state")
"""Columns of which much may be the same."""
_NUMBER, _NUMBERS = ctypes.c_int, ctypes.POINTER(ctypes.c_double)
_INDEX = ctypes.POINTER(ctypes.c_int)


class Seen(ctypes.Structure):
    """What is read of a run: as `HybondSeen` in ``library.c``."""

    _fields_ = (
        *(("y", _NUMBERS), ("state", _INDEX), ("tried", _INDEX)),
        *((name, ctypes.c_double) for name in ("t", "energy")),
        *((name, _NUMBER) for name in ("states", "evaluations", "modes_made")),
        ("propagated", _INDEX),
        *((name, _NUMBER) for name in ("settling", "stuck_machine", "stuck_events", "stuck_why")),
        *((name, ctypes.c_double) for name in ("stuck_t", "stuck_ratio")),
        *((name, _NUMBER) for name in ("warns", "abouts")),
        *((name, _INDEX) for name in ("warn", "warn_first")),
        *((name, _NUMBERS) for name in ("warn_time", "about")),
        *((name, _NUMBER) for name in COUNTS),
        *((name, _NUMBERS) for name in FLOATS),
        *((name, _INDEX) for name in INTS),
    )


@dataclass(frozen=True, slots=True)
class Rows:
    """What a slice of a run wrote down; `hybond.engine.run.log` says what the columns are."""

    step_time: NDArray[np.float64]
    """Shape (steps, 3). Begin and end of each step, and where it was ended, s."""
    step_until: NDArray[np.float64]
    """Shape (steps,). The next timed event, s."""
    step_state: StateRows
    """Shape (steps, 3, states). The state there."""
    step_dense: NDArray[np.float64]
    """Shape (steps, 4, states)."""
    step_place: NDArray[np.intc]
    """Shape (steps, 2 + 2 machines)."""
    instant_time: NDArray[np.float64]
    """Shape (instants, 2)."""
    instant_state: StateRows
    """Shape (instants, 2, states). Before and after."""
    instant_place: NDArray[np.intc]
    """Shape (instants, 3 + 2 machines)."""
    visit: NDArray[np.intc]
    """Shape (visits, 5)."""
    visit_energy: NDArray[np.float64]
    """Shape (visits, 3)."""
    fired: NDArray[np.intc]
    """Shape (transitions, 6)."""
    read: NDArray[np.float64]
    """Shape (values, 3)."""
    hit: NDArray[np.intc]
    """Shape (hits,)."""
    hit_area: NDArray[np.float64]
    """Shape (hits, 2)."""
    over: NDArray[np.intc]
    open: NDArray[np.intc]
    slid: NDArray[np.intc]
    slide_time: NDArray[np.float64]
    """Shape (slides,)."""
    warn: NDArray[np.intc]
    warn_first: NDArray[np.intc]
    """Shape (warnings,), (warnings + 1,). `warn` and `warn_first`: their kinds, and where their
    numbers begin in `about`."""
    warn_time: NDArray[np.float64]
    about: NDArray[np.float64]
    step_bonds: NDArray[np.float64]
    """Shape (points, 2 bonds). Of time-stepping: bond variables where steps end, and where a motion
    begins."""
    step_energy: NDArray[np.float64]
    """Shape (steps or 0, 3)."""
    instant_since: NDArray[np.float64]
    """Shape (instants,). When the step began within which it happened, s; -1 where it was
    located."""
    step_bond: NDArray[np.intc]
    """Shape (steps or 0,)."""
    turn_time: NDArray[np.float64]
    """Shape (turns,). When ``auto`` went over to ``radau``, or back."""


def rows_of(
    many: Mapping[str, int],
    copied: Callable[[str, type, tuple[int, ...]], Any],
    *,
    states: int,
    machines: int,
    bonds: int,
) -> Rows:
    """Return the rows of a log.

    Parameters
    ----------
    many : mapping
        `COUNTS`, ``warns`` and ``abouts``.
    copied : callable
        ``copied(name, type, shape)`` returns a column of the log as an array of its own.
    """
    steps, instants, warns = many["steps"], many["instants"], many["warns"]
    powered = steps if many["bond_rows"] else 0
    shapes: dict[str, tuple[int, ...]] = {
        "step_time": (steps, 3),
        "step_until": (steps,),
        "step_state": (steps, 3, states),
        "step_dense": (steps, 4, states),
        "step_place": (steps, MACHINES_OF_STEP + 2 * machines),
        "instant_time": (instants, 2),
        "instant_state": (instants, 2, states),
        "instant_place": (instants, MACHINES_OF_INSTANT + 2 * machines),
        "visit": (many["visits"], 5),
        "visit_energy": (many["visits"], 3),
        "fired": (many["fireds"], 6),
        "read": (many["reads"], 3),
        "hit": (many["hits"],),
        "hit_area": (many["hits"], 2),
        "over": (many["overs"],),
        "open": (many["opens"],),
        "slid": (many["slids"],),
        "slide_time": (many["slides"],),
        "warn": (warns,),
        "warn_first": (warns + 1 if warns else 0,),
        "warn_time": (warns,),
        "about": (many["abouts"],),
        "step_bonds": (many["bond_rows"], 2 * bonds),
        "step_energy": (powered, 3),
        "instant_since": (instants,),
        "step_bond": (powered,),
        "turn_time": (many["turns"],),
    }
    whole = {*INTS, "warn", "warn_first"}
    return Rows(
        **{
            name: copied(name, np.intc if name in whole else np.float64, shape)
            for name, shape in shapes.items()
        }
    )
