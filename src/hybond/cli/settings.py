"""``--set path=value``: parameters by dotted path, and what the parts of a model say."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from hybond.errors import ModelError, UsageError
from hybond.library import find
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.model.kinds import KINDS
from hybond.model.parts import InputPart, Integral, Part, Sampled, SubmodelPart
from hybond.names import did_you_mean, join


def flatten_with(model: Model, settings: Sequence[str]) -> FlatGraph:
    """Return the flat graph of `model` with settings applied; `model` itself stays as it is.

    Parameters
    ----------
    settings : sequence of str
        ``"path=value"``. A path leads to a parameter (``m``, ``motor.k``), the value of an
        element (``ball.I``), the start of a storage, an integral or a machine (``ball.f``,
        ``height.start``, ``floor.start``), or an input.

    Raises
    ------
    UsageError
        HB-X103 for a setting without ``=``.
    ModelError
        HB-M107 for a path that leads nowhere, with the nearest ones that do.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("block", parameters={"b": "2"})
    >>> m.add(mass=hb.I(1.0), rub=hb.R("b"), v=hb.One())
    >>> m.bond("v -> mass", "v -> rub")
    >>> graph = flatten_with(m, ["b=3", "mass.f=2"])
    >>> graph.parameters["b"], graph.storages[0].start
    (3.0, 2.0)
    """
    changed, parameters = _read(model, settings)
    try:
        return changed.flatten(parameters=parameters)
    except ModelError as error:
        if error.code == "HB-M107" and error.where in parameters:
            error.hint = did_you_mean(error.where, _paths(model, "", {}))
        raise


def model_with(model: Model, settings: Sequence[str]) -> Model:
    """Return a copy of `model` with settings applied, those of its own parameters included.

    Raises
    ------
    UsageError
        HB-X103 for a setting without ``=``, or of a parameter inside a submodel.
    """
    changed, parameters = _read(model, settings)
    own = {k: v for k, v in parameters.items() if k in model.parameters}
    for path in parameters.keys() - own.keys():
        raise UsageError(
            f"{path!r} is no parameter of the model itself, so it cannot be written into it",
            code="HB-X103",
            where="--set",
            hint=did_you_mean(path, model.parameters),
        )
    if own:
        changed = copy.copy(changed)
        changed.parameters = {**changed.parameters, **own}
    return changed


def changed_with(model: Model, settings: Sequence[str]) -> tuple[Model, dict[str, str]]:
    """Return a copy of `model` with its parts set, and the parameters that are set.

    Raises
    ------
    UsageError
        HB-X103 for a setting without ``=``.
    """
    return _read(model, settings)


def _read(model: Model, settings: Sequence[str]) -> tuple[Model, dict[str, str]]:
    """Return a copy with parts changed, and what is set that is no part."""
    parameters: dict[str, str] = {}
    changed = model
    for setting in settings:
        path, equals, value = (word.strip() for word in setting.partition("="))
        if not equals or not path or not value:
            raise UsageError(
                f"{setting!r} does not set anything",
                code="HB-X103",
                where="--set",
                hint="--set m=2kg",
            )
        found = _set(changed, path.split("."), value, {})
        if found is None:
            parameters[path] = value
        else:
            changed = found
    return changed, parameters


def _set(model: Model, names: list[str], value: str, known: Mapping[str, Model]) -> Model | None:
    """Return a copy of `model` in which a part is changed, or None if the path is no part's."""
    name, *rest = names
    known = {**known, **model.models}
    part = model.elements.get(name)
    if isinstance(part, Part) and len(rest) == 1:
        new_part = _changed(part, rest[0], value)
        return None if new_part is None else _copy(model, "elements", name, new_part)
    if isinstance(part, SubmodelPart) and rest:
        if len(rest) == 1 and rest[0] in part.inputs:
            inputs = {**part.inputs, rest[0]: value}
            return _copy(model, "elements", name, replace(part, inputs=inputs))
        inner = _inner(part, known)
        if inner is None or (len(rest) == 1 and rest[0] in inner.parameters):
            return None
        new_inner = _set(inner, rest, value, known)
        if new_inner is None:
            return None
        return _copy(model, "elements", name, replace(part, model=new_inner))
    signal = model.signals.get(name)
    if isinstance(signal, Integral | Sampled) and rest == ["start"]:
        return _copy(model, "signals", name, replace(signal, start=value))
    if name in model.machines and rest == ["start"]:
        return _copy(model, "machines", name, replace(model.machines[name], start=value))
    if name in model.inputs and not rest:
        return _copy(model, "inputs", name, InputPart(constant=value))
    return None


def _changed(part: Part, key: str, value: str) -> Part | None:
    if part.kind in ("0", "1"):
        return None
    if key == part.kind:
        return replace(part, value=value)
    starts = _starts(part)
    if key not in starts:
        return None
    options = {k: v for k, v in part.options.items() if k not in starts}
    return replace(part, options={**options, key: value})


def _starts(part: Part) -> tuple[str, ...]:
    """Return the keys a storage's start may have: its stored quantity, its co-energy variable."""
    about = KINDS.get(part.kind)
    return (about.energy, about.imposes or "") if about is not None and about.energy else ()


def _inner(part: SubmodelPart, known: Mapping[str, Model]) -> Model | None:
    if isinstance(part.model, Model):
        return part.model
    return known.get(part.model) or find(part.model)


def _copy(model: Model, group: str, name: str, part: object) -> Model:
    """Return a copy that shares all but the one group that differs."""
    new = copy.copy(model)
    setattr(new, group, {**getattr(model, group), name: part})
    return new


def _paths(model: Model, prefix: str, known: Mapping[str, Model]) -> Iterator[str]:
    """Return every path that can be set."""
    known = {**known, **model.models}
    for name in (*model.parameters, *model.inputs):
        yield join(prefix, name)
    for name, part in model.elements.items():
        path = join(prefix, name)
        if isinstance(part, SubmodelPart):
            inner = _inner(part, known)
            if inner is not None:
                yield from _paths(inner, path, known)
        elif part.kind not in ("0", "1"):
            yield from (join(path, key) for key in (part.kind, *_starts(part)))
    for name, signal in model.signals.items():
        if isinstance(signal, Integral | Sampled):
            yield join(prefix, name, "start")
    for name in model.machines:
        yield join(prefix, name, "start")
