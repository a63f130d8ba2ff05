"""What makes a unit not fit its place: a parameter's own, or a domain that another element says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from hybond.errors import HybondError
from hybond.model.expressions import Number, names, parse
from hybond.model.graph import Node
from hybond.model.kinds import TWO_PORTS
from hybond.model.resolve import Resolver
from hybond.units import try_quantity


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
