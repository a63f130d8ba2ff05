"""Parts of a model by dotted path: values of elements, starts, inputs; for `parameters=` and --set.

A path leads to a parameter (``m``, ``motor.k``), to the value of an element (``ball.I``), to the
start of a storage, an integral or a machine (``ball.f``, ``height.start``, ``floor.start``), or to
an input. Of an array it leads to one member, ``c[3].C``, or to all, as written: ``c[1..n].C``.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from hybond.errors import ModelError
from hybond.model.arrays import is_array, with_member_apart
from hybond.model.builder import Model
from hybond.model.hierarchy import submodel_of
from hybond.model.kinds import KINDS
from hybond.model.parts import InputPart, Integral, Part, Sampled, SubmodelPart, Value
from hybond.names import did_you_mean, join, steps

_OF_A_RUN = frozenset({"until", "solver", "rtol", "atol", "step"})
"""What is told to a run, and is often taken for a parameter."""


def with_parts(model: Model, given: Mapping[str, Value]) -> tuple[Model, dict[str, Value]]:
    """Return a copy of a model with its parts set, and what of `given` is no part.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("block", parameters={"b": 2})
    >>> m.add(mass=hb.I("1 kg"), rub=hb.R("b"), v=hb.One())
    >>> new, left = with_parts(m, {"mass.I": "3 kg", "b": 4})
    >>> new.elements["mass"].value, m.elements["mass"].value, left
    ('3 kg', '1 kg', {'b': 4})
    """
    left: dict[str, Value] = {}
    for path, value in given.items():
        found = with_part(model, path, value)
        if found is None:
            left[path] = value
        else:
            model = found
    return model, left


def with_part(model: Model, path: str, value: Value) -> Model | None:
    """Return a copy of a model in which one part is set, None if the path is no part's."""
    return _set(model, steps(path), value, {}) if isinstance(path, str) else None


def settable(model: Model) -> Iterator[str]:
    """Return every path that can be set.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", parameters={"r": 2})
    >>> m.add(c=hb.C("1 mF"))
    >>> list(settable(m))
    ['r', 'c.C', 'c.q', 'c.e']
    """
    return _paths(model, "", {})


def settable_like(model: Model, wrong: str) -> str:
    """Return what may be meant by a path that sets nothing: what can be set that is like it.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", parameters={"r": 2})
    >>> m.add(c=hb.C("1 mF"))
    >>> settable_like(m, "c")
    "did you mean 'c.C', 'c.q', 'c.e'?"
    >>> settable_like(m, "until")
    'until is told to the run: --until, or simulate(..., until=...)'
    """
    if wrong in _OF_A_RUN:
        return f"{wrong} is told to the run: --{wrong}, or simulate(..., {wrong}=...)"
    paths = list(settable(model))
    under = [p for p in paths if p.rpartition(".")[0] == wrong]
    if under:
        return "did you mean " + ", ".join(map(repr, under[:3])) + "?"
    return did_you_mean(wrong, paths)


def _set(model: Model, names: list[str], value: Value, known: Mapping[str, Model]) -> Model | None:
    """Return a copy of `model` in which a part is changed, or None if the path is no part's."""
    name, *rest = names
    known = {**known, **model.models}
    if is_array(name) and not any(name in group for group in _arrays(model)):
        model = with_member_apart(model, name)
    part = model.elements.get(name)
    if isinstance(part, Part) and len(rest) == 1:
        new_part = _changed(part, rest[0], value)
        return None if new_part is None else regrouped(model, "elements", name, new_part)
    if isinstance(part, SubmodelPart) and rest:
        if len(rest) == 1 and rest[0] in part.inputs:
            inputs = {**part.inputs, rest[0]: value}
            return regrouped(model, "elements", name, replace(part, inputs=inputs))
        inner = _inner(part, known)
        if inner is not None and len(rest) == 1 and rest[0] in inner.parameters:
            if ".." not in name:
                return None
            given = {**part.parameters, rest[0]: value}
            return regrouped(model, "elements", name, replace(part, parameters=given))
        if inner is None:
            return None
        new_inner = _set(inner, rest, value, known)
        if new_inner is None:
            return None
        return regrouped(model, "elements", name, replace(part, model=new_inner))
    signal = model.signals.get(name)
    if isinstance(signal, Integral | Sampled) and rest == ["start"]:
        return regrouped(model, "signals", name, replace(signal, start=value))
    if name in model.machines and rest == ["start"]:
        return regrouped(model, "machines", name, replace(model.machines[name], start=value))
    if name in model.inputs and not rest:
        return regrouped(model, "inputs", name, InputPart(constant=value))
    return None


def _arrays(model: Model) -> tuple[dict[str, Any], ...]:
    return model.elements, model.signals, model.inputs, model.machines


def _changed(part: Part, key: str, value: Value) -> Part | None:
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


def regrouped(model: Model, group: str, name: str, part: object) -> Model:
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


def _inner(part: SubmodelPart, known: Mapping[str, Model]) -> Model | None:
    try:
        return submodel_of(part, "", known)
    except ModelError:
        return None
