"""The point at which equations are wanted as numbers, in the model's words or canonical names."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from hybond.equations.booleans import Naming
from hybond.equations.display import Display
from hybond.equations.element_parts import parameter_values
from hybond.errors import EquationError
from hybond.model.expressions import Name
from hybond.model.graph import FlatGraph


def point(graph: FlatGraph, values: Mapping[str, float] | None) -> dict[str, float]:
    """Return numbers by canonical name.

    Parameters
    ----------
    values : mapping or None
        By what the model calls them, ``w``, ``c.q``, ``m``, or by canonical names, ``s:0``.

    Raises
    ------
    ModelError
        HB-M120 for a name that the model does not have.
    EquationError
        HB-Q101 for a signal that is made of others.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add(c=hb.C(1), g=hb.G("1 + w"), n=hb.Zero())
    >>> m.bond("n -> c", "n -> g")
    >>> m.signal(w=hb.Integral("c.e"))
    >>> point(m.flatten(), {"w": 0.5})
    {'s:0': 0.5}
    """
    return {_canonical(graph, name): number for name, number in (values or {}).items()}


def _canonical(graph: FlatGraph, name: str) -> str:
    if ":" in name:
        return name
    if f"p:{name}" in parameter_values(graph):
        return f"p:{name}"
    found = graph.signal(name)
    if isinstance(found, Name):
        return found.path
    raise EquationError(
        f"{name} is made of other signals, so it is nothing to be given",
        code="HB-Q101",
        where="the equations",
        hint="give what it is made of",
    )


def caller(graph: FlatGraph) -> Callable[[str], str]:
    """Return what says how the model calls a canonical name."""
    return Display(graph, Naming(graph), {}).name
