"""The kernel's structures, as `c/hybond.h` declares them, and arrays to fill them with."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

INTEGER = ctypes.c_int32
REAL = ctypes.c_double
INTEGERS = ctypes.POINTER(INTEGER)
REALS = ctypes.POINTER(REAL)
ADDRESSES = ctypes.POINTER(ctypes.c_void_p)
DTYPES = {INTEGERS: np.int32, REALS: np.float64, ADDRESSES: np.uintp}


class Sampling(ctypes.Structure):
    """`hb_sampling`."""

    __slots__ = ()
    _fields_ = (
        *((name, REALS) for name in ("fractions", "left_over", "fine")),
        *((name, REAL) for name in ("unresolved", "near_zero", "rounding", "overshoot")),
    )


class Rows(ctypes.Structure):
    """`hb_rows`."""

    __slots__ = ()
    _fields_ = (("first", INTEGERS), ("column", INTEGERS), ("value", REALS))


_SIZES = """
    slots storages signals inputs stored_slot signal_slot input_slot input_rate_slot
    knowns rows free values entries affine
    laws sources spread supplied dissipated guards outputs slopes
    constraints agreements loose
    bonds bond_slot machines rules flag_count flag_slot
    fieldless enterable ports points
    flow moved watched
"""


class Mode(ctypes.Structure):
    """`hb_mode`."""

    __slots__ = ()
    _fields_ = (
        *((name, INTEGER) for name in _SIZES.split()),
        *((name, REAL) for name in ("cost", "flow_norm", "flow_unit")),
        ("code", INTEGERS),
        ("constants", REALS),
        ("co_energy", Rows),
        ("law_at", INTEGERS),
        ("law_code", INTEGERS),
        ("known", REALS),
        ("source_at", INTEGERS),
        ("source_code", INTEGERS),
        ("solved", Rows),
        ("by_free", REALS),
        ("measured", Rows),
        ("shares", Rows),
        ("by_share", REALS),
        ("spread_row", INTEGERS),
        ("spread_slot", INTEGERS),
        ("row_of", INTEGERS),
        ("value_code", INTEGERS),
        ("slope", REALS),
        ("entry_at", INTEGERS),
        ("entry_code", INTEGERS),
        ("entry_by_free", REALS),
        ("rate_row", INTEGERS),
        ("rate_sign", REALS),
        ("signal_code", INTEGERS),
        ("supplied_e", INTEGERS),
        ("supplied_f", INTEGERS),
        ("dissipated_e", INTEGERS),
        ("dissipated_f", INTEGERS),
        ("supplied_sign", REALS),
        ("dissipated_sign", REALS),
        ("guard_test", INTEGERS),
        ("guard_atoms", INTEGERS),
        ("atom_code", INTEGERS),
        ("size_code", INTEGERS),
        ("seen", REALS),
        ("output_code", INTEGERS),
        ("stiffness", REALS),
        ("slope_at", INTEGERS),
        ("slope_code", INTEGERS),
        ("constraint", Rows),
        ("agreement", Rows),
        ("known_reach", REALS),
        ("stored_reach", REALS),
        ("put_back", REALS),
        ("weighed", REALS),
        ("state", INTEGERS),
        ("flags", REALS),
        *((name, INTEGERS) for name in ("rule_machine", "rule_target", "rule_code")),
        ("contact_code", INTEGERS),
        ("kick", Rows),
        ("point", REALS),
        ("weight", REALS),
        ("guess", REALS),
        *((name, INTEGERS) for name in ("port_machine", "port_turn", "port_gate", "port_adrift")),
        ("port_drifts", INTEGERS),
        *((name, INTEGERS) for name in ("sense_code", "sense_push")),
        ("sense", Rows),
        ("flow_matrix", Rows),
        ("flow_scale", REALS),
        *((name, INTEGERS) for name in ("moved_at", "along", "generator_code", "watched_at")),
        ("levels", REALS),
        ("levels_known", INTEGERS),
    )


class Memory(ctypes.Structure):
    """`hb_memory`."""

    __slots__ = ()
    _fields_ = (
        *((name, REAL) for name in ("left", "span", "served")),
        *((name, INTEGER) for name in ("matrix", "slow", "first")),
        *((name, REALS) for name in ("jacobian", "real", "re", "im")),
        *((name, INTEGERS) for name in ("real_row", "pair_row")),
        ("polynomial", REALS),
    )


class Motion(ctypes.Structure):
    """`hb_motion`."""

    __slots__ = ()
    _fields_ = (
        *((name, REAL) for name in ("t", "h", "energy", "error_before", "h_before")),
        *((name, REAL) for name in ("max_step", "rtol", "atol", "negligible", "idle")),
        ("run_energy", REAL),
        ("instant", REAL),
        ("evaluations", ctypes.c_int64),
        ("controlled", INTEGER),
        ("method", INTEGER),
        *((name, REALS) for name in ("y", "f", "largest", "free", "rounding")),
        *((name, REALS) for name in ("input", "input_rate", "input_time", "v")),
        ("memory", Memory),
    )


class Trail(ctypes.Structure):
    """`hb_trail`."""

    __slots__ = ()
    _fields_ = (
        *((name, REALS) for name in ("t", "y", "outputs", "stop", "end", "dense")),
        ("rejected", INTEGERS),
    )


_SHARED = """
    modes machines states storages signals inputs slots bonds classes
    ats at_slot surfaces most_writes
"""


class Atlas(ctypes.Structure):
    """`hb_atlas`."""

    __slots__ = ()
    _fields_ = (
        *((name, INTEGER) for name in _SHARED.split()),
        *((name, REAL) for name in ("until", "event_tol", "rounded")),
        *(
            (name, REAL)
            for name in (
                "remaining",
                "soonest",
                "moment",
                "slow",
                "lively",
                "fading",
                "at_once",
                "vanished",
            )
        ),
        ("mode", ADDRESSES),
        *((name, INTEGERS) for name in ("bond_class", "storage_class", "store_slot")),
        *((name, REALS) for name in ("store_sign", "real")),
        *((name, INTEGERS) for name in ("contact_of", "rests_in", "ready")),
        *((name, INTEGERS) for name in ("surface_machine", "below", "above")),
        *((name, REALS) for name in ("since", "speed")),
    )


class Schedule(ctypes.Structure):
    """`hb_schedule`."""

    __slots__ = ()
    _fields_ = (
        ("count", INTEGER),
        *((name, REALS) for name in ("end", "at", "input", "rate", "time")),
    )


class Log(ctypes.Structure):
    """`hb_log`."""

    __slots__ = ()
    _fields_ = (
        *((name, REALS) for name in ("t", "before", "after", "energy", "approach")),
        *((name, INTEGERS) for name in ("steps", "mode", "interval", "timed", "changed")),
        *((name, INTEGERS) for name in ("struck", "fired", "wanted")),
        ("last", REAL),
        ("rows", INTEGER),
    )


_KINDS: dict[Any, dict[str, Any]] = {
    structure: {f[0]: f[1] for f in structure._fields_}
    for structure in (Sampling, Rows, Mode, Memory, Motion, Trail, Atlas, Schedule, Log)
}


class Filled:
    """A structure and the arrays that its pointers lead to, kept alive together.

    Parameters
    ----------
    structure : ctypes.Structure
    """

    def __init__(self, structure: ctypes.Structure) -> None:
        self.structure = structure
        self.arrays: dict[str, NDArray[Any]] = {}

    def put(self, name: str, values: Any, *, part: str = "") -> NDArray[Any]:
        """Give a pointer an array, made contiguous and of its type; return the array."""
        owner = getattr(self.structure, part) if part else self.structure
        kind = _KINDS[type(owner)][name]
        array: NDArray[Any] = np.ascontiguousarray(values, dtype=DTYPES[kind])
        self.arrays[f"{part}.{name}" if part else name] = array
        setattr(owner, name, ctypes.cast(array.__array_interface__["data"][0], kind))
        return array

    def put_rows(self, name: str, dense: NDArray[np.float64]) -> None:
        """Give sparse rows what is not zero in a matrix."""
        row, column = np.nonzero(dense)
        first = np.searchsorted(row, np.arange(len(dense) + 1))
        self.put_sparse(name, first, column, dense[row, column])

    def put_sparse(
        self,
        name: str,
        first: NDArray[np.intp],
        column: NDArray[np.intp],
        value: NDArray[np.float64],
    ) -> None:
        """Give sparse rows where each begins, columns and values."""
        self.put("first", first, part=name)
        self.put("column", column, part=name)
        self.put("value", value, part=name)

    def check(self) -> None:
        """Refuse a structure one of whose pointers leads nowhere."""
        for name, kind in ((f[0], f[1]) for f in type(self.structure)._fields_):
            parts = [f"{name}.{f[0]}" for f in Rows._fields_] if kind is Rows else [name]
            if (kind is Rows or kind in DTYPES) and not self.arrays.keys() >= set(parts):
                raise AssertionError(f"{type(self.structure).__name__}.{name} was not filled")
