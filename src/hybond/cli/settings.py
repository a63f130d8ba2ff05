"""``--set path=value``: parameters by dotted path, and what the parts of a model say."""

from __future__ import annotations

import copy
from collections.abc import Sequence

from hybond.cli.lists import scaled
from hybond.errors import UsageError
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.model.paths import with_part
from hybond.names import did_you_mean


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
    return changed.flatten(parameters=parameters)


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
        value = scaled(value)
        if not equals or not path or not value:
            raise UsageError(
                f"{setting!r} does not set anything",
                code="HB-X103",
                where="--set",
                hint="--set m=2kg",
            )
        found = with_part(changed, path, value)
        if found is None:
            parameters[path] = value
        else:
            changed = found
    return changed, parameters
