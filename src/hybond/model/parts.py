"""What a modeller writes: elements, junctions, signals, inputs, machines, submodels.

These records hold the text as written (quantities, expressions), not its meaning; `flatten`
gives them their meaning. They are the same in Python and in a model file.

Examples
--------
>>> Se("10 V")
Part(kind='Se', value='10 V', options={})
>>> I("m", f="2 m/s").options
{'f': '2 m/s'}
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

Value = Any
"""A number, a quantity or expression as text, a matrix, or ``{"e": ...}`` / ``{"f": ...}``."""


@dataclass(frozen=True, slots=True)
class Part:
    """A node of the graph: `kind` is a kind of `kinds.KINDS`."""

    kind: str
    value: Value = None
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class SubmodelPart:
    """An instance of a submodel, with parameters given in the scope that contains it."""

    model: Any
    """A name in the models of the containing model, or a `Model`."""
    parameters: Mapping[str, Value] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Integral:
    """An integrated signal: ``s' = rate``, from `start`."""

    rate: str
    start: Value = 0.0


@dataclass(frozen=True, slots=True)
class InputPart:
    """An input. Exactly one of `constant`, `table`, `pwm`, `function` is given.

    Parameters
    ----------
    constant : number or str
    table : sequence of (time, value)
    linear : bool
        Join the table's points by straight lines; else each value is held.
    period : number or str
        The table begins anew that long after its first time, again and again.
    pwm : mapping
        ``period``, ``duty``, ``high`` (1), ``low`` (0), ``phase`` (0).
    function : callable
        ``function(t) -> float``, from Python only.
    breaks : sequence of float
        The times where `function` is not smooth.
    """

    constant: Value = None
    table: Sequence[Sequence[Value]] | None = None
    linear: bool = False
    period: Value = None
    pwm: Mapping[str, Value] | None = None
    function: Callable[[float], float] | None = None
    breaks: Sequence[float] = ()


@dataclass(frozen=True, slots=True)
class MachinePart:
    """A state machine: which controlled junctions each state switches ON, and its rules.

    Rules are written ``"away -> touching when height <= 0 and v.f < 0"``.
    """

    states: Mapping[str, Sequence[str]]
    start: str
    rules: Sequence[str] = ()


def _one_port(kind: str) -> Callable[..., Part]:
    def make(value: Value, **options: Any) -> Part:
        return Part(kind, value, options)

    make.__name__ = kind
    make.__doc__ = f"Return a {kind} element with this value or law; see `hybond.Model`."
    return make


C = _one_port("C")
I = _one_port("I")
R = _one_port("R")
G = _one_port("G")
Se = _one_port("Se")
Sf = _one_port("Sf")
TF = _one_port("TF")
GY = _one_port("GY")


def Zero(**options: Any) -> Part:
    """Return a 0-junction: common effort."""
    return Part("0", None, options)


def One(**options: Any) -> Part:
    """Return a 1-junction: common flow."""
    return Part("1", None, options)


def Submodel(model: Any, **parameters: Value) -> SubmodelPart:
    """Return an instance of a submodel (a name or a `Model`) with its parameters."""
    return SubmodelPart(model, parameters)
