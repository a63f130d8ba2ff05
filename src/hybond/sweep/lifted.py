"""A model whose elements and starts take their values from parameters, so that slots hold them.

Values of elements, starts and inputs by path make a copy of a model. Who sets them ten thousand
times gives them to a parameter of the model that they are in, and sets that.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import replace

from hybond.model.builder import Model
from hybond.model.hierarchy import submodel_of
from hybond.model.parts import SubmodelPart
from hybond.model.paths import with_part
from hybond.names import join

PREFIX = "swept_"


def lifted(model: Model, paths: Sequence[str]) -> tuple[Model, dict[str, str]]:
    """Return a copy with a parameter for each path of a part, and the parameter of each path.

    Paths that are parameters already stay what they are.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("block", parameters={"b": 2})
    >>> m.add(mass=hb.I("1 kg"), rub=hb.R("b"), v=hb.One())
    >>> new, of = lifted(m, ["mass.I", "b"])
    >>> new.elements["mass"].value, of
    ('swept_mass_I', {'mass.I': 'swept_mass_I', 'b': 'b'})
    """
    of: dict[str, str] = {}
    for path in paths:
        model, of[path] = _lifted(model, path.split("."), path, {})
    return model, of


def _lifted(
    model: Model, names: list[str], path: str, known: dict[str, Model]
) -> tuple[Model, str]:
    known = {**known, **model.models}
    part = model.elements.get(names[0])
    if isinstance(part, SubmodelPart) and len(names) > 2:
        inner = submodel_of(part, "", known)
        changed, name = _lifted(inner, names[1:], path, known)
        if changed is inner:
            return model, path
        new = copy.copy(model)
        new.elements = {**model.elements, names[0]: replace(part, model=changed)}
        return new, join(names[0], name)
    if names[0] in model.parameters and len(names) == 1:
        return model, path
    name = _free(model, PREFIX + "_".join(names))
    found = with_part(model, ".".join(names), name)
    if found is None:
        return model, path
    found = copy.copy(found) if found is model else found
    found.parameters = {**model.parameters, name: 0.0}
    return found, name


def _free(model: Model, name: str) -> str:
    taken = {*model.parameters, *model.elements, *model.signals, *model.machines, *model.inputs}
    while name in taken:
        name += "_"
    return name
