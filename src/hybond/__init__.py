"""hybond: hybrid bond graphs in Python.

Names are imported when they are first used, so that ``import hybond`` costs next to nothing.

>>> import hybond as hb
>>> model = hb.Model("oscillator", domain="translational")
>>> model.add(mass=hb.I("1 kg"), spring=hb.C("10 mm/N", q="5 cm"), v=hb.One())
>>> model.bond("v -> mass", "v -> spring")
>>> run = hb.simulate(model, until="1 s")
>>> run.status
'ok'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from hybond._version import __version__

if TYPE_CHECKING:
    from hybond.draw import draw, draw_mode
    from hybond.errors import (
        CausalityError,
        DivergenceOfTime,
        ExpressionError,
        FileError,
        HybondError,
        ModelError,
        NumericsError,
        UnitError,
        UsageError,
    )
    from hybond.files import dumps, load, loads, save
    from hybond.model.builder import Model
    from hybond.model.parts import GY, TF, C, G, I, Integral, One, R, Se, Sf, Submodel, Zero
    from hybond.model.parts import InputPart as Input
    from hybond.result import Result, Signal
    from hybond.simulation import simulate

_HOME = {
    **dict.fromkeys(
        (
            "CausalityError",
            "DivergenceOfTime",
            "ExpressionError",
            "FileError",
            "HybondError",
            "ModelError",
            "NumericsError",
            "UnitError",
            "UsageError",
        ),
        "hybond.errors",
    ),
    **dict.fromkeys(("dumps", "load", "loads", "save"), "hybond.files"),
    **dict.fromkeys(
        ("GY", "TF", "C", "G", "I", "Integral", "One", "R", "Se", "Sf", "Submodel", "Zero"),
        "hybond.model.parts",
    ),
    "Input": "hybond.model.parts",
    "Model": "hybond.model.builder",
    "Result": "hybond.result",
    "Signal": "hybond.result",
    "draw": "hybond.draw",
    "draw_mode": "hybond.draw",
    "simulate": "hybond.simulation",
}
_OTHER_NAME = {"Input": "InputPart"}

__all__ = [
    "GY",
    "TF",
    "C",
    "CausalityError",
    "DivergenceOfTime",
    "ExpressionError",
    "FileError",
    "G",
    "HybondError",
    "I",
    "Input",
    "Integral",
    "Model",
    "ModelError",
    "NumericsError",
    "One",
    "R",
    "Result",
    "Se",
    "Sf",
    "Signal",
    "Submodel",
    "UnitError",
    "UsageError",
    "Zero",
    "__version__",
    "draw",
    "draw_mode",
    "dumps",
    "load",
    "loads",
    "save",
    "simulate",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'hybond' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), _OTHER_NAME.get(name, name))
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
