"""A model in which all that is varied is a parameter: values of elements and starts, too.

The value of an element (``pad.C``) and a start (``ball.p``) become parameters of a copy of the
model, so that all of them are one kind of thing: a slot ``p:path`` in the laws of a graph.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from hybond.errors import EquationError, UsageError
from hybond.model.builder import Model
from hybond.model.hierarchy import submodel_of
from hybond.model.kinds import KINDS
from hybond.model.parts import Integral, Part, Sampled, SubmodelPart, Value
from hybond.model.paths import regrouped, settable, with_parts
from hybond.names import did_you_mean, join

OWN = "_by_"
"""What the name of a parameter begins with that stands for the value of an element or a start."""


@dataclass(frozen=True, slots=True)
class Opened:
    """A model in which all that is varied is a parameter."""

    names: tuple[str, ...]
    paths: tuple[str, ...]
    model: Model
    settable: tuple[str, ...]
    """Where each of `names` can be set: starts without a 0 behind them."""
    given: Mapping[str, Value]
    """Values of parameters other than the model's own."""
    modes: dict[Any, Any] = field(default_factory=dict, compare=False, repr=False)
    """Equations of modes, differentiated: the same for all values of what is varied."""


def opened_model(
    model: Model,
    asked: Sequence[str],
    parameters: Mapping[str, Value],
    *,
    where: str = "wrt",
) -> Opened:
    """Return a copy of a model in which all that is varied is a parameter.

    Parameters
    ----------
    asked : sequence of str
        Parameters (``m``), values of elements (``pad.C``), starts (``ball.p``, also ``ball.p0``).
    parameters : mapping
        Values by path, other than those of the model.
    where : str
        The argument that a refusal names.

    Raises
    ------
    UsageError
        HB-A520 for a path that cannot be set.
    EquationError
        HB-A521 for one that is no number.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", parameters={"R": "2 ohm"}, domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="1 V"), r=hb.R("R"))
    >>> m.bond("c -> r")
    >>> opened_model(m, ["R", "c.C", "c.e0"], {}).paths
    ('R', '_by_c_C', '_by_c_e')
    """
    asked = [asked] if isinstance(asked, str) else list(asked)
    if not asked:
        raise UsageError(
            "nothing is varied",
            code="HB-A520",
            where=where,
            hint=f"{where}=['m', 'pad.C', 'ball.p']",
        )
    known = list(settable(model))
    model, left = with_parts(model, parameters)
    paths, keys = [], []
    for name in asked:
        path = name
        if name not in known and name.endswith("0") and name[:-1] in known:
            path = name[:-1]
        if path not in known:
            raise UsageError(
                f"{name!r} is no parameter, no value of an element and no start",
                code="HB-A520",
                where=where,
                hint=did_you_mean(name, known) or ", ".join(known),
            )
        keys.append(path)
        model, own = _opened(model, path.split("."), "", {}, name)
        paths.append(own)
    return Opened(tuple(asked), tuple(paths), model, tuple(keys), left)


def _opened(
    model: Model, path: list[str], prefix: str, known: Mapping[str, Model], asked: str
) -> tuple[Model, str]:
    """Return a copy in which what a path leads to is a parameter, and the path of that."""
    name, *rest = path
    known = {**known, **model.models}
    if not rest and name in model.parameters:
        return model, join(prefix, name)
    part = model.elements.get(name)
    own = OWN + "_".join(path)
    if isinstance(part, SubmodelPart):
        if len(rest) == 1 and rest[0] in part.parameters:
            return model, join(prefix, name, rest[0])
        inner, below = _opened(submodel_of(part, "", known), rest, join(prefix, name), known, asked)
        if inner is part.model:
            return model, below
        new = replace(part, model=inner)
        return regrouped(model, "elements", name, new), below
    if isinstance(part, Part) and len(rest) == 1:
        if rest[0] == part.kind:
            value = _number(part.value, asked)
            model = regrouped(model, "elements", name, replace(part, value=own))
        else:
            about = KINDS[part.kind]
            starts = (about.energy, about.imposes or "")
            if any(k in part.options for k in starts) and rest[0] not in part.options:
                raise EquationError(
                    f"{asked} is not how the start of {name} is said",
                    code="HB-A521",
                    where=asked,
                    hint=f"{name}.{next(k for k in starts if k in part.options)}",
                )
            value = _number(part.options.get(rest[0], 0.0), asked)
            options = {**part.options, rest[0]: own}
            model = regrouped(model, "elements", name, replace(part, options=options))
    elif isinstance(signal := model.signals.get(name), Integral | Sampled) and rest == ["start"]:
        value = _number(signal.start, asked)
        model = regrouped(model, "signals", name, replace(signal, start=own))
    elif name in model.inputs and not rest and model.inputs[name].constant is not None:
        part_ = model.inputs[name]
        value = _number(part_.constant, asked)
        model = regrouped(model, "inputs", name, replace(part_, constant=own))
    else:
        raise EquationError(
            f"{asked} is no number", code="HB-A521", where=asked, hint="vary what is a number"
        )
    return regrouped(model, "parameters", own, value), join(prefix, own)


def _number(value: object, asked: str) -> Value:
    if value is None or isinstance(value, bool) or not isinstance(value, str | int | float):
        raise EquationError(
            f"{asked} is a law or a matrix and no number",
            code="HB-A521",
            where=asked,
            hint="give its law a parameter of its own, and vary that",
        )
    return value
