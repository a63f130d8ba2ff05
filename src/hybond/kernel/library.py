"""The compiled kernel, loaded once; and why it is not there if it is not."""

from __future__ import annotations

import ctypes
import functools
import os
from pathlib import Path

from hybond.kernel.build import NAME, digest
from hybond.kernel.structs import Atlas, Log, Mode, Motion, Sampling, Schedule, Trail


@functools.cache
def library() -> ctypes.CDLL | str:
    """Return the library, or a text that says why there is none.

    The environment variable ``HYBOND_KERNEL`` names another file, or says ``off``.
    """
    chosen = os.environ.get("HYBOND_KERNEL", "")
    if chosen == "off":
        return "HYBOND_KERNEL is off"
    path = Path(chosen) if chosen else Path(__file__).parent / NAME
    if not path.is_file():
        if chosen:
            return f"HYBOND_KERNEL names {chosen}, which is no file"
        return f"{NAME} was not built (pip install -v says why)"
    try:
        kernel = ctypes.CDLL(str(path))
        kernel.hb_source.restype = ctypes.c_char_p
        made = kernel.hb_source().decode()
    except (OSError, AttributeError) as error:
        return f"{path.name} cannot be loaded: {error}"
    if digest() not in ("", made):
        return f"{path.name} was built from other sources: install hybond again"
    kernel.hb_march.restype = ctypes.c_int32
    kernel.hb_march.argtypes = [
        ctypes.POINTER(Mode),
        ctypes.POINTER(Motion),
        ctypes.POINTER(Sampling),
        ctypes.c_double,
        ctypes.c_int32,
        ctypes.c_int32,
        ctypes.POINTER(Trail),
        ctypes.POINTER(ctypes.c_int32),
    ]
    kernel.hb_run.restype = ctypes.c_int32
    kernel.hb_run.argtypes = [
        ctypes.POINTER(Atlas),
        ctypes.POINTER(Motion),
        ctypes.POINTER(Sampling),
        ctypes.POINTER(Schedule),
        ctypes.c_int32,
        ctypes.c_int32,
        ctypes.c_int32,
        ctypes.c_double,
        ctypes.POINTER(Trail),
        ctypes.POINTER(Log),
    ]
    return kernel
