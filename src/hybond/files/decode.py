"""Plain data to a `Model`: what `tomllib`, `json` or a caller gives, checked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hybond.errors import ModelError
from hybond.files.check import check, describe
from hybond.files.elements import read_element
from hybond.files.place import Place, shortened
from hybond.files.schema import VERSION, File
from hybond.files.submodel_files import Reading, is_file
from hybond.model.builder import Model
from hybond.model.origin import Origin, snapshot
from hybond.model.parts import InputPart, Integral, MachinePart, Sampled, SubmodelPart
from hybond.model.symbol import LARGEST, MARKS, Symbol, points_of


def read_file_data(data: dict[str, Any], place: Place, reading: Reading, name: str) -> Model:
    """Return the model of a whole file; `name` is its name if it gives none.

    Raises
    ------
    FileError
        HB-F106 (not a model), HB-F107 (version), and those of `read_model`.
    """
    if "hybond" not in data:
        raise place.refuse(
            "not a hybond model: it has no key 'hybond'",
            code="HB-F106",
            hint=f"a model begins with hybond = {VERSION}",
        )
    version = data["hybond"]
    if type(version) is not int or version < 1:
        raise (place / "hybond").refuse(
            f"{describe(version)}, where the version of the format is needed",
            code="HB-F107",
            hint=f"hybond = {VERSION}",
        )
    if version > VERSION:
        raise (place / "hybond").refuse(
            f"the file is of format version {version}; this hybond reads up to {VERSION}",
            code="HB-F107",
            hint="update hybond: pip install --upgrade hybond",
        )
    check(data, File, place)
    return read_model(data, place, reading, name)


def read_model(data: dict[str, Any], place: Place, reading: Reading, name: str) -> Model:
    """Return the model of data that `check` has accepted as a `Submodel`."""
    model = Model(data.get("name", name), title=data.get("title", ""))
    model.about = data.get("about", model.about)
    model.domain = data.get("domain", model.domain)
    model.indeterminate = data.get("indeterminate", model.indeterminate)
    for key, value in data.get("parameters", {}).items():
        _name(model, key, place / "parameters" / key)
        model.parameters[key] = value
    elements = data.get("elements", {})
    reading.count_elements(len(elements), place / "elements")
    for key, value in elements.items():
        _name(model, key, place / "elements" / key, array=True)
        model.elements[key] = read_element(value, place / "elements" / key, array="[" in key)
    model.bonds = list(data.get("graph", {}).get("bonds", ()))
    for key, value in data.get("signals", {}).items():
        _name(model, key, place / "signals" / key, array=True)
        model.signals[key] = (
            _dynamic(value, place / "signals" / key) if isinstance(value, dict) else value
        )
    for key, value in data.get("inputs", {}).items():
        _name(model, key, place / "inputs" / key, array=True)
        model.inputs[key] = _input(value, place / "inputs" / key)
    for key, value in data.get("machines", {}).items():
        _name(model, key, place / "machines" / key, array=True)
        states = {state: tuple(on) for state, on in value["states"].items()}
        model.machines[key] = MachinePart(states, value["start"], tuple(value.get("rules", ())))
    for key, value in data.get("blocks", {}).items():
        at = place / "blocks" / key
        _name(model, key, at)
        from hybond.blocks.fmu import fmu_block  # few models have blocks

        model.blocks[key] = fmu_block(
            value["fmu"],
            reading.unit(value["fmu"], at / "fmu"),
            where=str(at),
            **{k: v for k, v in value.items() if k != "fmu"},
        )
    causality = data.get("causality", {})
    model.pins = dict(causality.get("pins", {}))
    model.reference_states = dict(causality.get("reference", {}))
    for key, value in data.get("ports", {}).items():
        _name(Model(), key, place / "ports" / key, array=True)
        model.ports[key] = value
    for key, value in data.get("models", {}).items():
        _name(Model(), key, place / "models" / key)
        with reading.inside(place / "models" / key):
            model.models[key] = read_model(value, place / "models" / key, reading, key)
    model.experiment = dict(data.get("experiment", {}))
    model.origin = Origin(place.within, snapshot(model))
    if "symbol" in data:
        model.symbol = _symbol(data["symbol"], model.ports, place / "symbol")
    model.layout = {key: (x, y) for key, (x, y) in data.get("layout", {}).items()}
    for key, part in model.elements.items():
        if not (isinstance(part, SubmodelPart) and is_file(part.model)):
            continue
        if part.model not in model.models:
            found = reading.file(part.model, place / "elements" / key / "submodel")
            if found is not None:
                model.models[part.model] = found
    return model


def _name(model: Model, name: str, place: Place, *, array: bool = False) -> None:
    """Refuse a name that the builder refuses, with the code of the builder."""
    try:
        model._new_name(name, array=array)
    except ModelError as error:
        raise place.refuse(shortened(error.why, 120), code=error.code, hint=error.hint) from None


def _symbol(data: dict[str, Any], ports: Mapping[str, str], place: Place) -> Symbol:
    """Return a symbol; HB-F120 for one that cannot be drawn, or has a pin that is no port."""
    found = Symbol(
        {k: (float(x), float(y)) for k, (x, y) in data["pins"].items()},
        tuple(data.get("lines", ())),
        tuple(data.get("fills", ())),
        tuple((float(x), float(y), float(r)) for x, y, r in data.get("circles", ())),
        tuple((str(t), float(x), float(y)) for t, x, y in data.get("words", ())),
        data.get("upright", False),
    )
    why = next((f"{k!r} is no port" for k in found.pins if k not in ports), "")
    places = [*found.pins.values(), *(c[:2] for c in found.circles), *(w[1:] for w in found.words)]
    if any(not abs(v) <= LARGEST for p in places for v in p):
        why = why or f"it goes farther out than {LARGEST:g}"
    if len(found.lines) + len(found.fills) + len(found.circles) + len(found.words) > MARKS:
        why = why or f"it has more than {MARKS} lines, circles and words"
    for text in (*found.lines, *found.fills):
        try:
            points_of(text)
        except ValueError as error:
            why = why or str(error)
    if why:
        raise place.refuse(
            f"the symbol cannot be drawn: {why}",
            code="HB-F120",
            hint='pins = { plus = [-2, 0] } with names of ports, lines = ["-2,0 -0.5,0"]',
        )
    return found


def _dynamic(data: dict[str, Any], place: Place) -> Integral | Sampled:
    start = data.get("start", 0.0)
    of_samples = sorted(data.keys() & {"sample", "every", "phase"})
    if "integral" in data and of_samples:
        raise place.refuse(
            f"a signal is an integral or a sample; this has {of_samples[0]!r} as well",
            code="HB-F113",
            hint='{ integral = "v.f" } or { sample = "v.f", every = "1 ms" }',
        )
    for key in ("sample", "every") if of_samples else ("integral",):
        if key not in data:
            raise place.refuse(
                f"{key!r} is missing", code="HB-F111", hint=f"add {key} = ... in this place"
            )
    if not of_samples:
        return Integral(data["integral"], start)
    return Sampled(data["sample"], data["every"], start, data.get("phase", 0.0))


def _input(data: dict[str, Any], place: Place) -> InputPart:
    given = [key for key in ("constant", "table", "pwm") if key in data]
    if len(given) != 1:
        raise place.refuse(
            f"an input is one of constant, table, pwm; this is {describe(data)}",
            code="HB-F113",
            hint='{ constant = "5 V" }',
        )
    for key in ("linear", "period"):
        if key in data and given != ["table"]:
            raise (place / key).refuse(
                f"{key!r} belongs to a table, not to {given[0]!r}",
                code="HB-F114",
                hint="leave it out",
            )
    return InputPart(
        constant=data.get("constant"),
        table=data.get("table"),
        linear=data.get("linear", False),
        period=data.get("period"),
        pwm=data.get("pwm"),
    )
