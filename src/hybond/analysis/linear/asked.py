"""What a linearisation is asked for: inputs and outputs by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybond.errors import EquationError, UsageError
from hybond.measures.naming import read_name
from hybond.model.builder import Model
from hybond.model.expressions import Expr, Name, Number, names
from hybond.model.expressions.slots import PREFIX, Slots
from hybond.model.flatten import flatten
from hybond.model.graph import FlatGraph, Node
from hybond.model.kinds import SOURCES
from hybond.model.unit_words import unit_of
from hybond.names import did_you_mean


@dataclass(frozen=True, slots=True)
class Inputs:
    """Inputs as they were asked for.

    Parameters
    ----------
    names : tuple of str
    columns : tuple of str
        What they are in rows: ``source:k``, ``u:k``, ``p:path``.
    units : tuple of str
    values : tuple of Expr or float
        What they have at a point: an expression of a source's bond or an input, or a number.
    graph : FlatGraph
        The graph in which parameters that are inputs stand in laws.
    """

    names: tuple[str, ...]
    columns: tuple[str, ...]
    units: tuple[str, ...]
    values: tuple[Expr | float, ...]
    graph: FlatGraph


def inputs_of(model: Model | FlatGraph, graph: FlatGraph, asked: Sequence[str] | None) -> Inputs:
    """Return inputs by name: sources, inputs of the model, parameters.

    Parameters
    ----------
    asked : sequence of str or None
        ``V`` and ``V.e`` both are the source V. None: all sources and inputs.

    Raises
    ------
    UsageError
        HB-A501 for what is none of these.
    EquationError
        HB-A502 for a parameter that cannot be followed into the laws.
    """
    sources = {n.path: n for n in graph.nodes if n.kind in SOURCES and not n.implied}
    own = {i.path: i.index for i in graph.inputs}
    if asked is None:
        asked = [*own, *(path for path, n in sources.items() if not _driven(n))]
    if isinstance(asked, str):
        asked = [asked]
    wanted: list[str] = []
    columns: list[str] = []
    units: list[str] = []
    values: list[Expr | float] = []
    for name in asked:
        path = _source_path(name, sources)
        if name in own:
            at: Expr = Name(f"u:{own[name]}")
            columns.append(f"u:{own[name]}")
            units.append(input_unit(graph, own[name]))
            values.append(at)
        elif path is not None:
            node = sources[path]
            at = Name(f"{'e' if node.kind == 'Se' else 'f'}:{node.ends[0].bond}")
            columns.append(f"source:{node.index}")
            units.append(unit_of(at, graph))
            values.append(at)
        elif isinstance(graph.parameters.get(name), float | int):
            wanted.append(name)
            columns.append(PREFIX + name)
            units.append("")
            values.append(float(graph.parameters[name]))
        else:
            known = [*own, *sources, *graph.parameters]
            raise UsageError(
                f"{name!r} is no source, no input of the model and no parameter",
                code="HB-A501",
                where="inputs",
                hint=did_you_mean(name, known),
            )
    followed = _followed(model, graph, wanted, units, columns)
    return Inputs(tuple(asked), tuple(columns), tuple(units), tuple(values), followed)


def input_unit(graph: FlatGraph, index: int) -> str:
    """Return the unit of an input of the model: that of the source which it is, if it is one.

    A torque is then in N*m, which its dimension alone does not tell from J.
    """
    name = Name(f"u:{index}")
    for node in graph.nodes:
        if node.kind in SOURCES and node.law is not None and node.law.expressions[0] == name:
            kind = "e" if node.kind == "Se" else "f"
            return unit_of(Name(f"{kind}:{node.ends[0].bond}"), graph)
    return unit_of(name, graph)


def _driven(node: Node) -> bool:
    """Whether a source only passes on what the model says elsewhere, or is a plain zero."""
    assert node.law is not None
    e = node.law.expressions[0]
    return bool(names(e) - {"time"}) or (isinstance(e, Number) and e.value == 0.0)


def _source_path(name: str, sources: Mapping[str, Node]) -> str | None:
    if name in sources:
        return name
    path, _, variable = name.rpartition(".")
    node = sources.get(path)
    if node is None or variable != ("e" if node.kind == "Se" else "f"):
        return None
    return path


def _followed(
    model: Model | FlatGraph,
    graph: FlatGraph,
    wanted: Sequence[str],
    units: list[str],
    columns: Sequence[str],
) -> FlatGraph:
    """Return the graph with parameters as slots in its laws; write their units."""
    if not wanted:
        return graph
    if not isinstance(model, Model):
        raise EquationError(
            f"{wanted[0]} is a parameter, and a run has only its value",
            code="HB-A502",
            where="inputs",
            hint="linearise the model: hb.linearise(model, at={...}) with the states of the run",
        )
    slots = Slots(set(wanted), moving=True)
    made = flatten(model, {}, slots)
    for path in wanted:
        if path in slots.fixed:
            raise EquationError(
                f"{path} cannot be varied: it goes into {slots.fixed[path]}",
                code="HB-A502",
                where="inputs",
                hint="vary another parameter, or compare two runs",
            )
        dimension = slots.parameters[path].dimension
        text = "" if dimension is None else str(dimension)
        units[list(columns).index(PREFIX + path)] = "" if text == "1" else text
    return made


def outputs_of(graph: FlatGraph, asked: Sequence[str] | None) -> dict[str, Expr]:
    """Return outputs by name in canonical names; by default what the experiment plots, or states.

    Raises
    ------
    UsageError
        HB-S109 for a signal that there is not.
    """
    if isinstance(asked, str):
        asked = [asked]
    if asked is None:
        asked = [str(name) for name in graph.experiment.get("plot", ())]
        if not asked:
            asked = [s.path for s in graph.storages] + [i.path for i in graph.integrals]
    return {name: graph.signals.get(name) or read_name(graph, name) for name in asked}
