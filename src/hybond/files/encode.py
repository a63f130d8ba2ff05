"""A `Model` to plain data: the structure of a model file, defaults left out."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from hybond.errors import FileError
from hybond.files import limits
from hybond.files.place import Path, dotted
from hybond.files.schema import VERSION
from hybond.files.submodel_files import is_file
from hybond.model.builder import RESERVED, Model
from hybond.model.parts import (
    BlockPart,
    InputPart,
    Integral,
    MachinePart,
    Part,
    Sampled,
    SubmodelPart,
)


def to_data(model: Model, *, inline: bool = False) -> dict[str, Any]:
    """Return a model as plain data with the structure of a model file.

    Parameters
    ----------
    inline : bool
        Whether submodels that are files become part of the data, so that it stands alone; else
        they stay references.

    Raises
    ------
    FileError
        HB-F110 if the model holds what no file can: a callable, an object.

    Examples
    --------
    >>> from hybond.model.constructors import I
    >>> model = Model("block")
    >>> model.add(mass=I("1 kg"))
    >>> to_data(model)
    {'hybond': 1, 'name': 'block', 'elements': {'mass': {'I': '1 kg'}}}
    """
    return {"hybond": VERSION, **_sections(model, (), [], inline)}


def _sections(model: Model, path: Path, inside: list[Model], inline: bool) -> dict[str, Any]:
    if any(model is outer for outer in inside):
        names = " -> ".join(m.name for m in [*inside, model])
        raise _refuse(f"a model contains itself: {names}", path, "HB-F116", "take a submodel out")
    if len(inside) > limits.LEVELS:
        why = f"more than {limits.LEVELS} models inside one another"
        raise _refuse(why, path, "HB-F103", "put models side by side")
    inside = [*inside, model]
    models = _Models(model, inline)
    elements = {
        key: _element(part, (*path, "elements", key), models)
        for key, part in model.elements.items()
    }
    data: dict[str, Any] = {"name": model.name}
    if model.title:
        data["title"] = model.title
    if model.about:
        data["about"] = model.about
    if model.domain != "generic":
        data["domain"] = model.domain
    if model.indeterminate != "error":
        data["indeterminate"] = model.indeterminate
    sections: dict[str, Any] = {
        "parameters": model.parameters,
        "elements": elements,
        "graph": {"bonds": model.bonds} if model.bonds else {},
        "signals": {k: _signal(v) for k, v in model.signals.items()},
        "inputs": {k: _input(v, (*path, "inputs", k)) for k, v in model.inputs.items()},
        "machines": {k: _machine(v) for k, v in model.machines.items()},
        "blocks": {k: _block(v, (*path, "blocks", k)) for k, v in model.blocks.items()},
        "causality": _causality(model),
        "ports": model.ports,
        "models": {
            key: _submodel(key, inner, (*path, "models", key), inside, inline)
            for key, inner in models.written.items()
        },
        "experiment": model.experiment,
        "symbol": {} if model.symbol is None else model.symbol.to_data(),
        "layout": model.layout,
    }
    for key, section in sections.items():
        if section:
            data[key] = _plain(section, (*path, key))
    return data


def _submodel(
    key: str, model: Model, path: Path, inside: list[Model], inline: bool
) -> dict[str, Any]:
    data = _sections(model, path, inside, inline)
    if data["name"] == key:
        del data["name"]
    return data


class _Models:
    """The names under which the submodels of one model are written."""

    def __init__(self, model: Model, inline: bool) -> None:
        self.given = model.models
        self.inline = inline
        self.written = {k: m for k, m in model.models.items() if not is_file(k)}
        # A new name must not be one that an element already gives to a model of the library.
        self.taken = set(RESERVED)
        for part in model.elements.values():
            if isinstance(part, SubmodelPart) and isinstance(part.model, str):
                self.taken.add(part.model)

    def name(self, model: Any) -> str:
        if isinstance(model, str):
            if not (self.inline and is_file(model) and model in self.given):
                return model
            model = self.given[model]
        for key, known in self.written.items():
            if known is model:
                return key
        stem = re.sub(r"\W", "_", model.name, flags=re.ASCII)
        stem = stem if re.match(r"[A-Za-z_]", stem) else f"m_{stem}"
        name, number = stem, 1
        while name in self.written or name in self.taken:
            number += 1
            name = f"{stem}_{number}"
        self.written[name] = model
        return name


def _element(part: Any, path: Path, models: _Models) -> dict[str, Any]:
    if isinstance(part, SubmodelPart):
        if not isinstance(part.model, str | Model):
            raise _refuse(f"{part.model!r} is not a model", path, "HB-F110")
        given = {"parameters": part.parameters, "inputs": part.inputs}
        return {
            "submodel": models.name(part.model),
            **{key: values for key, values in given.items() if values},
        }
    if not isinstance(part, Part):
        raise _refuse(f"{part!r} is not an element", path, "HB-F110")
    if part.kind in ("0", "1"):
        return {"junction": int(part.kind), **part.options}
    return {part.kind: part.value, **part.options}


def _signal(signal: str | float | Integral | Sampled) -> Any:
    if not isinstance(signal, Integral | Sampled):
        return signal
    start = {} if repr(signal.start) == "0.0" else {"start": signal.start}
    if isinstance(signal, Integral):
        return {"integral": signal.rate, **start}
    phase = {} if repr(signal.phase) == "0.0" else {"phase": signal.phase}
    return {"sample": signal.value, "every": signal.every, **start, **phase}


def _input(given: InputPart, path: Path) -> dict[str, Any]:
    if given.function is not None:
        raise _refuse(
            "a Python function cannot be written to a model file",
            path,
            "HB-F110",
            "give the input as a table: hb.Input(table=[(0, 0), (1, 5)], linear=True)",
        )
    data: dict[str, Any] = {}
    if given.constant is not None:
        data["constant"] = given.constant
    if given.table is not None:
        data["table"] = given.table
    if given.linear:
        data["linear"] = True
    if given.period is not None:
        data["period"] = given.period
    if given.pwm is not None:
        data["pwm"] = given.pwm
    return data


def _block(block: BlockPart, path: Path) -> Any:
    if block.fmu is None:
        raise _refuse(
            "a Python function cannot be written to a model file",
            path,
            "HB-F110",
            "write what it does as sampled signals, or as an FMU",
        )
    outputs: Any = list(block.outputs)
    if block.description is not None and outputs == list(block.description.of("output")):
        outputs = None
    phase = None if repr(block.phase) == "0.0" else block.phase
    options = {"inputs": block.inputs, "parameters": block.parameters, "outputs": outputs}
    given = {k: v for k, v in {"phase": phase, **options}.items() if v}
    return {"fmu": block.fmu, "every": block.every, **given}


def _machine(machine: MachinePart) -> dict[str, Any]:
    data = {"states": machine.states, "start": machine.start}
    return {**data, "rules": machine.rules} if machine.rules else data


def _causality(model: Model) -> dict[str, Any]:
    given = {"pins": model.pins, "reference": model.reference_states}
    return {key: value for key, value in given.items() if value}


def _plain(value: Any, path: Path) -> Any:
    """Return a value with tuples, arrays and NumPy numbers made lists and numbers."""
    if isinstance(value, bool):
        return bool(value)
    if isinstance(value, str):
        return str(value)
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return float(value)
    if isinstance(value, Mapping):
        return {key: _plain(v, (*path, str(key))) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v, (*path, k)) for k, v in enumerate(value)]
    if hasattr(value, "tolist"):  # NumPy's arrays and numbers, without importing NumPy
        plain = value.tolist()
        if isinstance(plain, bool | int | float | str | list):
            return _plain(plain, path)
    raise _refuse(
        f"{value!r} cannot be written to a model file",
        path,
        "HB-F110",
        "a number, text, or a list or table of them",
    )


def _refuse(why: str, path: Path, code: str, hint: str = "") -> FileError:
    return FileError(why, code=code, where=dotted(path), hint=hint)
