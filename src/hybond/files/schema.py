"""The shape of a model file, format version 1, as records: what keys there are, of what type.

`decode` checks data against these records and `json_schema` publishes them, so there is one
description of the format. What records cannot say (exactly one kind per element, square
matrices, names used once) is checked in `elements` and `decode`.
"""

from __future__ import annotations

from inspect import cleandoc
from typing import Annotated, Any, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from hybond.options import Choice, Impact

VERSION = 1

Number = int | float
Scalar = int | float | str
Each = int | float | str | list[int | float | str]
"""A value; in an array it may be a list with one for each member."""
Row = tuple[int | float | str, int | float | str]
Listed = list[int | float | str | list[int | float | str]]
"""The matrix of a field, or a value for each member of an array."""


class LawTable(Struct, forbid_unknown_fields=True):
    """A law as points: a row of arguments, a row of values."""

    table: tuple[list[Scalar], list[Scalar]]
    extrapolate: Literal["error", "linear"] | UnsetType = UNSET


Output = int | float | str | LawTable | list[int | float | str | LawTable]


class LawOfC(Struct, forbid_unknown_fields=True):
    """A law that gives the effort from the displacement: ``{ e = "k*q + k3*q^3" }``."""

    e: Output


class LawOfI(Struct, forbid_unknown_fields=True):
    """A law that gives the flow from the momentum."""

    f: Output


class LawOfR(Struct, forbid_unknown_fields=True):
    """A law that gives the effort from the flow or the flow from the effort: one of the two."""

    e: Output | UnsetType = UNSET
    f: Output | UnsetType = UNSET


Start = int | float | str | list[int | float | str]


class CElement(Struct, forbid_unknown_fields=True):
    """A capacitance or spring; starts at displacement `q` or effort `e`."""

    C: int | float | str | LawOfC | Listed
    q: Start | UnsetType = UNSET
    e: Start | UnsetType = UNSET
    domain: str | UnsetType = UNSET


class IElement(Struct, forbid_unknown_fields=True):
    """An inertia or inductance; starts at momentum `p` or flow `f`."""

    I: int | float | str | LawOfI | Listed
    p: Start | UnsetType = UNSET
    f: Start | UnsetType = UNSET
    domain: str | UnsetType = UNSET


class RElement(Struct, forbid_unknown_fields=True):
    """A resistance; `impulsive` if its law acts on impulses too."""

    R: int | float | str | LawOfR | Listed
    impulsive: bool | UnsetType = UNSET
    domain: str | UnsetType = UNSET


class GElement(Struct, forbid_unknown_fields=True):
    """A conductance; `impulsive` if its law acts on impulses too."""

    G: int | float | str | LawOfR | Listed
    impulsive: bool | UnsetType = UNSET
    domain: str | UnsetType = UNSET


class SeElement(Struct, forbid_unknown_fields=True):
    """An effort source; `impulsive` says whether what it reads gives it impulses too."""

    Se: Each
    impulsive: bool | UnsetType = UNSET
    domain: str | UnsetType = UNSET


class SfElement(Struct, forbid_unknown_fields=True):
    """A flow source; `impulsive` says whether what it reads gives it impulses too."""

    Sf: Each
    impulsive: bool | UnsetType = UNSET
    domain: str | UnsetType = UNSET


class TFElement(Struct, forbid_unknown_fields=True):
    """A transformer with its modulus."""

    TF: Each
    domain: str | UnsetType = UNSET


class GYElement(Struct, forbid_unknown_fields=True):
    """A gyrator with its modulus."""

    GY: Each
    domain: str | UnsetType = UNSET


class JunctionElement(Struct, forbid_unknown_fields=True):
    """A 0-junction (common effort) or a 1-junction (common flow), perhaps with a law of its own.

    A junction with a law is an ideal diode, a contact or dry friction: it needs no machine.
    """

    junction: Literal[0, 1]
    law: Literal["diode", "thyristor", "unilateral", "coulomb", "relay"] | UnsetType = UNSET
    gate: str | UnsetType = UNSET
    gap: str | UnsetType = UNSET
    restitution: Each | UnsetType = UNSET
    stiffness: Each | UnsetType = UNSET
    limit: Each | UnsetType = UNSET
    breakaway: Each | UnsetType = UNSET
    pair: str | UnsetType = UNSET
    impulsive: bool | UnsetType = UNSET
    domain: str | UnsetType = UNSET


class SubmodelElement(Struct, forbid_unknown_fields=True):
    """An instance of a submodel: a name of [models] or of the library, or a model file."""

    submodel: Annotated[str, Meta(min_length=1)]
    parameters: dict[str, Each] | UnsetType = UNSET
    inputs: dict[str, Each] | UnsetType = UNSET


ELEMENTS: dict[str, type[Struct]] = {
    "C": CElement,
    "I": IElement,
    "R": RElement,
    "G": GElement,
    "Se": SeElement,
    "Sf": SfElement,
    "TF": TFElement,
    "GY": GYElement,
    "junction": JunctionElement,
    "submodel": SubmodelElement,
}
"""The record of each kind key; exactly one kind key makes an element."""


class Graph(Struct, forbid_unknown_fields=True):
    """The bonds, as they are drawn."""

    bonds: list[str] | UnsetType = UNSET


class Dynamic(Struct, forbid_unknown_fields=True):
    """A signal that is the integral of an expression over time, or samples one."""

    integral: str | UnsetType = UNSET
    sample: str | UnsetType = UNSET
    every: Scalar | UnsetType = UNSET
    phase: Scalar | UnsetType = UNSET
    start: Scalar | UnsetType = UNSET


class Pulses(Struct, forbid_unknown_fields=True):
    """Pulse-width modulation."""

    period: Scalar
    duty: Scalar
    high: Scalar | UnsetType = UNSET
    low: Scalar | UnsetType = UNSET
    phase: Scalar | UnsetType = UNSET


class Waveform(Struct, forbid_unknown_fields=True):
    """An input: a constant, a table of (time, value), or pulses; exactly one of them."""

    constant: Scalar | UnsetType = UNSET
    table: Annotated[list[Row], Meta(min_length=1)] | UnsetType = UNSET
    linear: bool | UnsetType = UNSET
    period: Scalar | UnsetType = UNSET
    pwm: Pulses | UnsetType = UNSET


class Machine(Struct, forbid_unknown_fields=True):
    """A state machine: the controlled junctions that each state switches ON, and its rules."""

    states: dict[str, list[str]]
    start: str
    rules: list[str] | UnsetType = UNSET


class ScriptStep(Struct, forbid_unknown_fields=True):
    """One step of a script: what is set at its beginning, and what ends it."""

    label: str | UnsetType = UNSET
    set: dict[str, Scalar] | UnsetType = UNSET
    until: Scalar | list[Scalar] | UnsetType = UNSET
    lasts: Scalar | UnsetType = UNSET
    repeat: int | UnsetType = UNSET
    steps: list[ScriptStep] | UnsetType = UNSET


class Experiment(Struct, forbid_unknown_fields=True):
    """What a run of the model is, unless the caller says otherwise."""

    until: Scalar | list[Scalar] | UnsetType = UNSET
    start: str | dict[str, Scalar] | UnsetType = UNSET
    script: list[ScriptStep] | UnsetType = UNSET
    solver: str | UnsetType = UNSET
    rtol: Number | UnsetType = UNSET
    atol: Number | UnsetType = UNSET
    step: Scalar | UnsetType = UNSET
    max_step: Scalar | UnsetType = UNSET
    theta: Number | UnsetType = UNSET
    plot: list[str] | UnsetType = UNSET
    outputs: list[str] | UnsetType = UNSET
    measure: list[str] | UnsetType = UNSET
    max_writes: int | UnsetType = UNSET
    max_events: int | UnsetType = UNSET
    max_steps: int | UnsetType = UNSET
    event_tol: Scalar | UnsetType = UNSET
    sliding: Choice | UnsetType = UNSET
    hysteresis: Scalar | UnsetType = UNSET
    impact: Impact | UnsetType = UNSET
    points: Annotated[int, Meta(ge=1)] | UnsetType = UNSET


class Causality(Struct, forbid_unknown_fields=True):
    """What the modeller fixes of causality: strokes of bonds, and the reference mode."""

    pins: dict[str, str] | UnsetType = UNSET
    reference: dict[str, str] | UnsetType = UNSET


class Block(Struct, forbid_unknown_fields=True):
    """A functional mock-up unit as a block of signals."""

    fmu: Annotated[str, Meta(min_length=1)]
    every: Scalar
    phase: Scalar | UnsetType = UNSET
    inputs: dict[str, Scalar] | UnsetType = UNSET
    parameters: dict[str, Scalar] | UnsetType = UNSET
    outputs: list[str] | UnsetType = UNSET


class Drawn(Struct, forbid_unknown_fields=True):
    """What a part looks like in schematics."""

    pins: dict[str, tuple[Number, Number]]
    lines: list[str] | UnsetType = UNSET
    fills: list[str] | UnsetType = UNSET
    circles: list[tuple[Number, Number, Number]] | UnsetType = UNSET
    words: list[tuple[str, Number, Number]] | UnsetType = UNSET
    upright: bool | UnsetType = UNSET


class Submodel(Struct, forbid_unknown_fields=True):
    """A model inside a model: the sections of a file."""

    name: Annotated[str, Meta(min_length=1)] | UnsetType = UNSET
    title: str | UnsetType = UNSET
    about: str | UnsetType = UNSET
    domain: str | UnsetType = UNSET
    indeterminate: Literal["error", "least leakage"] | UnsetType = UNSET
    parameters: dict[str, Scalar] | UnsetType = UNSET
    elements: dict[str, dict[str, Any]] | UnsetType = UNSET
    graph: Graph | UnsetType = UNSET
    signals: dict[str, Scalar | Dynamic] | UnsetType = UNSET
    inputs: dict[str, Waveform] | UnsetType = UNSET
    machines: dict[str, Machine] | UnsetType = UNSET
    blocks: dict[str, Block] | UnsetType = UNSET
    causality: Causality | UnsetType = UNSET
    ports: dict[str, str] | UnsetType = UNSET
    models: dict[str, Submodel] | UnsetType = UNSET
    experiment: Experiment | UnsetType = UNSET
    symbol: Drawn | UnsetType = UNSET
    layout: dict[str, tuple[Number, Number]] | UnsetType = UNSET


class File(Submodel, forbid_unknown_fields=True):
    """A hybond model file, format version 1."""

    hybond: Literal[1] = msgspec.field(default=1)


_OF_SAMPLES = ("sample", "every", "phase")


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of the format; ``model.schema.json`` is a copy of it.

    Examples
    --------
    >>> sorted(json_schema()["$defs"]["Machine"]["required"])
    ['start', 'states']
    """
    shapes = [File, *ELEMENTS.values()]
    references, parts = msgspec.json.schema_components(shapes, ref_template="#/$defs/{name}")
    for part in parts.values():
        # as it is read, however far it is set in: some releases of msgspec leave that
        if "description" in part:
            part["description"] = cleandoc(part["description"])
    # msgspec has no union of records without a tag: here the kind key is the tag.
    one_element = {"oneOf": list(references[1:])}
    for model in ("File", "Submodel"):
        parts[model]["properties"]["elements"]["additionalProperties"] = one_element
    parts["File"]["required"] = ["hybond"]
    parts["LawOfR"].update(minProperties=1, maxProperties=1)
    parts["Dynamic"]["oneOf"] = [
        {"required": ["integral"], "not": {"anyOf": [{"required": [k]} for k in _OF_SAMPLES]}},
        {"required": ["sample", "every"]},
    ]
    parts["Waveform"]["oneOf"] = [{"required": [k]} for k in ("constant", "table", "pwm")]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "hybond model, format version 1",
        **references[0],
        "$defs": parts,
    }
