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


class Sampling(ctypes.Structure):
    """`hb_sampling`."""

    __slots__ = ()
    _fields_ = (
        *((name, REALS) for name in ("fractions", "left_over", "fine")),
        *((name, REAL) for name in ("unresolved", "near_zero", "rounding")),
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
"""


class Mode(ctypes.Structure):
    """`hb_mode`."""

    __slots__ = ()
    _fields_ = (
        *((name, INTEGER) for name in _SIZES.split()),
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
    )


class Motion(ctypes.Structure):
    """`hb_motion`."""

    __slots__ = ()
    _fields_ = (
        *((name, REAL) for name in ("t", "h", "error_before", "energy")),
        *((name, REAL) for name in ("max_step", "rtol", "atol", "negligible", "idle")),
        ("input_time", REAL),
        ("run_energy", REAL),
        ("instant", REAL),
        ("evaluations", ctypes.c_int64),
        ("controlled", INTEGER),
        *((name, REALS) for name in ("y", "f", "largest", "free")),
        *((name, REALS) for name in ("rounding", "input", "input_rate", "v")),
    )


class Trail(ctypes.Structure):
    """`hb_trail`."""

    __slots__ = ()
    _fields_ = (
        *((name, REALS) for name in ("t", "y", "outputs", "stop", "end", "dense")),
        ("rejected", INTEGERS),
    )


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
        kind = {f[0]: f[1] for f in type(owner)._fields_}[name]
        dtype = np.int32 if kind is INTEGERS else np.float64
        array: NDArray[Any] = np.ascontiguousarray(values, dtype=dtype)
        self.arrays[f"{part}.{name}" if part else name] = array
        setattr(owner, name, array.ctypes.data_as(kind))
        return array

    def check(self) -> None:
        """Refuse a structure one of whose pointers leads nowhere."""
        for name, kind in ((f[0], f[1]) for f in type(self.structure)._fields_):
            parts = [f"{name}.{f[0]}" for f in Rows._fields_] if kind is Rows else [name]
            if kind in (Rows, INTEGERS, REALS) and not self.arrays.keys() >= set(parts):
                raise AssertionError(f"{type(self.structure).__name__}.{name} was not filled")
