"""What a modeller writes: elements, junctions, signals, inputs, machines, submodels.

These records hold the text as written (quantities, expressions), not its meaning; `flatten`
gives them their meaning. They are the same in Python and in a model file.

`constructors` makes the elements among them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import Any

from hybond.calls import called, fits
from hybond.errors import ModelError
from hybond.records import dataclass

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
    """A name in the models of the containing model or of the library, or a `Model`."""
    parameters: Mapping[str, Value] = field(default_factory=dict)
    inputs: Mapping[str, Value] = field(default_factory=dict)
    """Input of the submodel to what it is here: an expression of signals, a condition, a value."""


@fits('hb.Integral("v.f", start="3 m")')
@dataclass(frozen=True, slots=True)
class Integral:
    """An integrated signal: ``s' = rate``, from `start`."""

    rate: str
    start: Value = 0.0


@fits('hb.Sampled("c.e", every="1 ms")')
@dataclass(frozen=True, slots=True)
class Sampled:
    """A sampled signal: set to `value` at ``phase + n*every``, n = 0, 1, ..., and held between.

    What the value reads is *a priori*: as it was just before the instant. All signals that are
    sampled at one instant are so at once.

    Parameters
    ----------
    value : str
        An expression, or a condition, which counts as 1 or 0.
    every : number or str
        The period, s.
    start : number or str
        What the signal is before its first sample.
    phase : number or str
        The first instant, s.

    Examples
    --------
    >>> Sampled("u + k*(ref - motor.f)", every="1 ms")
    Sampled(value='u + k*(ref - motor.f)', every='1 ms', start=0.0, phase=0.0)
    """

    value: str
    every: Value
    start: Value = 0.0
    phase: Value = 0.0


@dataclass(frozen=True, slots=True)
class BlockPart:
    """A block of signals that is called at the instants ``phase + n*every``.

    Its outputs are signals, ``block.output``, held from instant to instant.
    """

    inputs: Mapping[str, Value]
    """Name of an input to an expression, which is read a priori."""
    outputs: Mapping[str, Value]
    """Name of an output to its value before the first instant, which has its unit."""
    every: Value
    phase: Value = 0.0
    """`every` and `phase`: s."""
    function: Callable[[float, dict[str, float]], Mapping[str, float]] | None = None
    """``function(t, u) -> y``, where u and y are dicts by name; from Python only."""
    fmu: str | None = None
    """The file of a functional mock-up unit, as written."""
    description: Any = field(default=None, compare=False)
    """What the FMU says of itself."""
    parameters: Mapping[str, Value] = field(default_factory=dict)
    """Values of its parameters."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Units of those inputs and parameters that have one."""


@fits('hb.Input(constant="5 N")')
@dataclass(frozen=True, slots=True)
class InputPart:
    """An input. Exactly one of `constant`, `table`, `pwm`, `function` is given."""

    constant: Value = None
    table: Sequence[Sequence[Value]] | None = None
    """Points: times and values."""
    linear: bool = False
    """Join the table's points by straight lines; else each value is held."""
    period: Value = None
    """The table begins anew that long after its first time, again and again."""
    pwm: Mapping[str, Value] | None = None
    """``period``, ``duty``, ``high`` (1), ``low`` (0), ``phase`` (0)."""
    function: Callable[[float], float] | None = None
    """``function(t) -> float``, from Python only."""
    breaks: Sequence[float] = ()
    """The times where `function` is not smooth."""


@dataclass(frozen=True, slots=True)
class MachinePart:
    """A state machine: which controlled junctions each state switches ON, and its rules.

    Rules are written ``"away -> touching when height <= 0 and v.f < 0"``.
    """

    states: Mapping[str, Sequence[str]]
    start: str
    rules: Sequence[str] = ()


def Block(
    function: Callable[[float, dict[str, float]], Mapping[str, float]],
    /,
    *,
    outputs: Mapping[str, Value] | Sequence[str],
    every: Value,
    inputs: Mapping[str, Value] | None = None,
    phase: Value = 0.0,
) -> BlockPart:
    """Return a block of signals that a Python function computes at instants.

    Parameters
    ----------
    function : callable
        ``function(t, u) -> y``: the time in s, the inputs by name in SI, the outputs by name. It
        is called once per instant, in order, and may keep a state of its own; such a state
        begins anew only if the caller sees to it.
    outputs : sequence of str, or mapping
        Names; with a mapping their values before the first instant, which carry their units.
    every, phase : number or str
        The instants are ``phase + n*every``.
    inputs : mapping
        Name to an expression, read a priori: as it is just before the instant.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("hover", domain="translational")
    >>> m.add(body=hb.I("1 kg"), thrust=hb.Se("pilot.force"), weight=hb.Se("-9.81 N"), v=hb.One())
    >>> m.bond("thrust -> v -> body", "weight -> v")
    >>> m.block(pilot=hb.Block(
    ...     lambda t, u: {"force": 9.81 - 5.0 * u["speed"]},
    ...     inputs={"speed": "v.f - 1 [m/s]"}, outputs={"force": "0 N"}, every="10 ms"))
    >>> round(float(hb.simulate(m, until="3 s")["v.f"].at(3.0)), 6)
    1.0
    """
    values = outputs if isinstance(outputs, Mapping) else dict.fromkeys(outputs, 0.0)
    return BlockPart(dict(inputs or {}), dict(values), every, phase, function)


@called('hb.Submodel("electrical.diode", V_on="0.7 V")', code="HB-M105", kind=ModelError)
def Submodel(
    model: Any, /, *, inputs: Mapping[str, Value] | None = None, **parameters: Value
) -> SubmodelPart:
    """Return an instance of a submodel with its parameters and inputs.

    Parameters
    ----------
    model : str or Model
        A name in the models of the containing model, a ready part of the library
        (``"electrical.diode"``), or a `Model`.
    inputs : mapping
        Inputs of the submodel to what they are here: an expression of signals, a condition
        (which counts as 1 or 0), a number or a quantity. The others keep their own value.
    **parameters
        Values of its parameters, in the parameters of the containing model.

    Examples
    --------
    >>> Submodel("electrical.switch", inputs={"gate": "time > 1 [ms]"}, R_on="1 mohm").parameters
    {'R_on': '1 mohm'}
    """
    return SubmodelPart(model, parameters, dict(inputs or {}))
