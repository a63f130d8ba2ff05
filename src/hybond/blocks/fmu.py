"""A functional mock-up unit as a block of a model: its names and units checked."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from hybond.blocks.description import Description, Variable, read_description
from hybond.errors import FileError
from hybond.model.parts import BlockPart, Value
from hybond.names import did_you_mean


def FMU(
    path: str | os.PathLike[str],
    /,
    *,
    every: Value,
    inputs: Mapping[str, Value] | None = None,
    outputs: Sequence[str] | None = None,
    parameters: Mapping[str, Value] | None = None,
    phase: Value = 0.0,
) -> BlockPart:
    """Return a functional mock-up unit for co-simulation (FMI 2.0, 3.0) as a block of signals.

    Only its description is read. Its code runs when the model is simulated with ``fmus=True``.

    Parameters
    ----------
    path : str or path
        A file that ends in ``.fmu``.
    every, phase : number or str
        The unit steps from instant to instant, ``phase + n*every``; its inputs are held between.
    inputs : mapping
        Name of an input of the unit to an expression of signals; others keep their start values.
    outputs : sequence of str
        Those that become signals, ``block.output``; default all of them.
    parameters : mapping
        Values of its parameters.

    Raises
    ------
    FileError
        HB-F160 not an FMU, HB-F161 one that cannot be a block, HB-F162 a variable that it has
        not.
    """
    return fmu_block(
        str(path),
        Path(path),
        where=str(path),
        every=every,
        inputs=inputs,
        outputs=outputs,
        parameters=parameters,
        phase=phase,
    )


def fmu_block(
    reference: str,
    path: Path | None,
    *,
    where: str,
    every: Value,
    inputs: Mapping[str, Value] | None = None,
    outputs: Sequence[str] | None = None,
    parameters: Mapping[str, Value] | None = None,
    phase: Value = 0.0,
) -> BlockPart:
    """Return a block; `reference` is the file as written, `path` where it is, None if unknown."""
    given, values = dict(inputs or {}), dict(parameters or {})
    if path is None:
        names = dict.fromkeys(outputs or (), 0.0)
        return BlockPart(given, names, every, phase, fmu=reference, parameters=values)
    unit = read_description(path, where)
    units = {}
    for what, names in (("input", given), ("parameter", values)):
        for name in names:
            variable = _find(unit, name, what, where)
            if variable.unit is not None:
                units[name] = str(variable.unit.dimension)
    chosen = (
        unit.of("output")
        if outputs is None
        else {name: _find(unit, name, "output", where) for name in outputs}
    )
    starts = {name: _start(variable) for name, variable in chosen.items()}
    return BlockPart(given, starts, every, phase, None, reference, unit, values, units)


def _start(variable: Variable) -> Value:
    """Return what an output is before the first instant, with its unit."""
    value = variable.start or 0.0
    if variable.unit is None:
        return value
    value = variable.unit.factor * value + variable.unit.offset
    return f"{value!r} {variable.unit.dimension}"


def _find(unit: Description, name: str, causality: str, where: str) -> Variable:
    found = unit.of(causality)
    if name not in found:
        raise FileError(
            f"the FMU {unit.name!r} has no {causality} {name!r}",
            code="HB-F162",
            where=where,
            hint=did_you_mean(name, found) or f"leave it out: it has no {causality}s at all",
        )
    return found[name]
