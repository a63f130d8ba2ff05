"""What makes a unit not fit its place: a parameter's own, or a domain that another element says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from hybond.errors import HybondError, UnitError
from hybond.model.builder import Model
from hybond.model.expressions import Number, names, parse
from hybond.model.graph import Node
from hybond.model.hierarchy import submodel_of
from hybond.model.kinds import TWO_PORTS
from hybond.model.origin import SECTIONS
from hybond.model.parts import SubmodelPart
from hybond.model.resolve import Resolver
from hybond.names import join
from hybond.units import DIMENSIONLESS, try_quantity


def units_of(values: Iterable[Any], parameters: Mapping[str, Number]) -> str:
    """Return the units of the parameters that values are made of, as words to be put behind.

    Examples
    --------
    >>> from hybond.units import parse_unit
    >>> units_of(["2*h0"], {"h0": Number(3.0, parse_unit("s")[1])})
    ' (the parameter h0 is in s)'
    >>> units_of(["3 s"], {})
    ''
    """
    found: dict[str, str] = {}
    for value in values:
        if not isinstance(value, str) or try_quantity(value) is not None:
            continue
        try:
            used = names(parse(value))
        except HybondError:
            continue
        for name in sorted(used & parameters.keys()):
            dimension = parameters[name].dimension
            if dimension is not None:
                found[name] = f"the parameter {name} is in {dimension}"
    return f" ({', '.join(found.values())})" if found else ""


def declared_elsewhere(node: Node, resolver: Resolver, domain: str) -> str | None:
    """Return the element that gives a node a domain which is not that of its model.

    Parameters
    ----------
    resolver : Resolver
        Of the model, which knows its bonds.
    domain : str
        Of the model that contains the node.
    """
    if domain in (node.domain.name, "generic"):
        return None
    own = resolver.opened.nodes.get(node.path)
    if own is None or own.part.options.get("domain") is not None:
        return None
    seen, waiting = {node.index}, [node.index]
    while waiting:
        for end in resolver.nodes[waiting.pop()].ends:
            bond = resolver.bonds[end.bond]
            for k in (bond.tail, bond.head):
                other = resolver.nodes[k]
                if k in seen or other.kind in TWO_PORTS:
                    continue
                seen.add(k)
                if other.kind in ("0", "1"):
                    waiting.append(k)
                written = resolver.opened.nodes.get(other.path)
                if written and written.part.options.get("domain") == node.domain.name:
                    return other.path
    return None


def of_a_given_parameter(
    error: HybondError, model: Model, overrides: Mapping[str, Any]
) -> HybondError:
    """Return the refusal of a parameter that a part is given in another unit than its own, if any.

    What is refused within the part does not name what was written: this is the place of it.

    Parameters
    ----------
    error : HybondError
        Of units that do not fit, somewhere in the model.
    model : Model
    overrides : mapping
        Values of parameters by path.
    """
    known, path = dict(model.models), ""
    steps = error.where.split(".")
    for name in steps[1:] if steps[0] in SECTIONS else steps:
        part = model.elements.get(name)
        if not isinstance(part, SubmodelPart):
            break
        path = join(path, name)
        try:
            model = submodel_of(part, path, known)
        except HybondError:
            break
        known |= model.models
        given = {k: overrides.get(f"{path}.{k}", v) for k, v in part.parameters.items()}
        given |= {
            k: overrides[f"{path}.{k}"] for k in model.parameters if f"{path}.{k}" in overrides
        }
        for k, value in given.items():
            own, other = (try_quantity(str(v)) for v in (model.parameters.get(k, ""), value))
            if own is None or other is None or DIMENSIONLESS in (own.dimension, other.dimension):
                continue
            if own.dimension != other.dimension:
                return UnitError(
                    f"{str(value)!r} is in {other.dimension}; the parameter {k} of "
                    f"{model.name!r} is in {own.dimension}",
                    code="HB-U103",
                    where=f"{path}.{k}",
                    hint=f"a value in {own.dimension}, such as {model.parameters[k]}",
                )
    return error
