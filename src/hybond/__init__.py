"""hybond: hybrid bond graphs in Python.

>>> import hybond as hb
"""

from hybond._version import __version__
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
from hybond.model.parts import (
    GY,
    TF,
    C,
    G,
    I,
    InputPart,
    Integral,
    One,
    R,
    Se,
    Sf,
    Submodel,
    Zero,
)
from hybond.result import Result, Signal
from hybond.simulate import simulate

Input = InputPart

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
    "dumps",
    "load",
    "loads",
    "save",
    "simulate",
]
