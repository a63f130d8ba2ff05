"""Imports what programs of the pages need, in the process that they are forked from.

And does what takes long and is the same for all: the run time of exported programs is printed, and
the sources of the library are read.
"""

from __future__ import annotations

import gc
import importlib
import pkgutil

import hybond as hb
from hybond.engine.compiled.sources import digest

OTHERS = (
    *("matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg", "matplotlib.pyplot"),
    *("pandas", "scipy.linalg", "scipy.optimize", "scipy.stats", "tomlkit"),
)

APART = ("hybond.cli", "hybond.studio", "hybond.__main__", "hybond.engine.compiled._engine")
"""Begins a program, or is the library itself."""


def preload() -> None:
    """Import all of hybond but what begins a program, and print one."""
    for name in OTHERS:
        importlib.import_module(name)
    for found in pkgutil.walk_packages(hb.__path__, "hybond."):
        if not found.name.startswith(APART):
            importlib.import_module(found.name)
    digest()
    model = hb.Model("rc")
    model.experiment["until"] = "1 s"
    model.add(c=hb.C(1, q=1), r=hb.R(1), node=hb.Zero())
    model.bond("node -> c", "node -> r")
    hb.export(model, to="c")
    gc.collect()
    gc.freeze()  # programs look for garbage in what they make


preload()
