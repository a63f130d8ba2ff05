"""Tables of elements: what selects the part that each of them plays, and these parts."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

from hybond.engine.tables.columns import INTS, ModelTables, put_rows
from hybond.engine.tables.machines import owners_of
from hybond.engine.tables.parts import put_parts
from hybond.equations.element_parts import Part, Parts
from hybond.errors import ModelError
from hybond.model.expressions import Bool, Expr, Number, names
from hybond.model.graph import FlatGraph, Machine, Node
from hybond.model.inputs import Constant, Pwm, Timetable
from hybond.model.kinds import RESISTORS, STORAGES, TWO_PORTS

MANY = 1024
"""Ways in which what is constant in a mode may select what one element says."""


def put_elements(t: ModelTables) -> None:
    """Put the elements into the tables, those first that say the same in every mode.

    Raises
    ------
    ModelError
        HB-E631 for one that says too many things.
    """
    g = t.graph
    parts = Parts(g)
    owners = owners_of(g)
    discrete = discrete_names(g)
    t.numbers["discrete"] = len(discrete)
    t.ints["discrete_kind"] = [1 if n.startswith("at:") else 2 for n in discrete]
    t.ints["discrete_index"] = [int(n.partition(":")[2]) for n in discrete]
    steady: list[Node] = []
    open_: list[Node] = []
    for node in g.nodes:
        if node.is_junction or node.kind in STORAGES:
            continue
        read = _selecting(node, discrete)
        (open_ if read or node.controlled else steady).append(node)
    elements = steady + open_
    t.numbers.update(elements=len(elements), steady=len(steady))
    t.ints["element_node"] = [node.index for node in elements]
    # by what they say: equal numbers may come from parameters that differ
    found: dict[Any, int] = {}
    kept: list[Part] = []
    selects, chosen = [], []
    for node in elements:
        select, variants = _variants(t, parts, node, discrete, owners)
        selects.append(select)
        own = []
        for part in variants:
            said = _said(part)
            if said not in found:
                found[said] = len(kept)
                kept.append(part)
            own.append((found[said],))
        chosen.append(own)
    put_rows(t, "select_first", selects, select_kind=INTS, select_index=INTS, select_many=INTS)
    put_rows(t, "element_first", chosen, element_part=INTS)
    put_parts(t, kept)
    per_element = [[kept[k] for (k,) in own] for own in chosen]
    sources = sum(any(p.source is not None for p in own) for own in per_element)
    ports = sum(len(m.law.junctions) for m in g.machines if m.law is not None)
    t.numbers["most_sources"] = sources + ports
    t.numbers["most_dynamic"] = sum(max(len(p.dynamic) for p in own) for own in per_element)


def _said(part: Part) -> tuple[Any, ...]:
    """Return a part as something that can be looked up."""
    rows = [tuple(sorted(row.items())) for row in (*part.power, *part.laws)]
    dynamic = [
        (d.kind, d.node, d.expression, *d.slopes.items(), *d.frozen.items(), *d.impulse_free)
        for d in part.dynamic
    ]
    return len(part.power), tuple(rows), tuple(dynamic), part.source, part.steady


def _selecting(node: Node, discrete: tuple[str, ...]) -> list[str]:
    """Return the names in an element's law that are constant in a configuration."""
    assert node.law is not None
    read: set[str] = set().union(*(names(e) for e in node.law.expressions))
    return sorted(n for n in read if n.startswith(("on:", "in:")) or n in discrete)


def _variants(
    t: ModelTables,
    parts: Parts,
    node: Node,
    discrete: tuple[str, ...],
    owners: Mapping[int, Machine],
) -> tuple[list[tuple[int, int, int]], list[Part]]:
    """Return what selects the part of an element, and its parts in that order."""
    g = t.graph
    read = _selecting(node, discrete)
    machines = {int(n.split(":")[1]) for n in read if n.startswith("in:")}
    machines |= {owners[int(n.split(":")[1])].index for n in read if n.startswith("on:")}
    if node.controlled:
        machines.add(owners[node.index].index)
    select = [(0, k, len(g.machines[k].states)) for k in sorted(machines)]
    for name in read:
        if name in discrete:
            kind, _, index = name.partition(":")
            levels = [0.0, 1.0] if kind == "at" else levels_of(g, int(index))
            select.append((1 if kind == "at" else 2, int(index), len(levels)))
    total = 1
    for _, _, many in select:
        total *= many
    if total > MANY:
        raise ModelError(
            f"what {node.kind} {node.path} says depends on {total} combinations of states",
            code="HB-E631",
            where=f"elements.{node.path}",
            hint="let the law read fewer machines, or inputs with fewer levels",
        )
    found = []
    for choice in product(*(range(many) for _, _, many in select)):
        state = {k: c for (kind, k, _), c in zip(select, choice, strict=True) if kind == 0}
        values = _settings(g, read, state, select, choice)
        off = node.controlled and not any(
            node.index in g.machines[k].on[c] for k, c in state.items()
        )
        found.append(parts.of(node, off, values))
    return select, found


def _settings(
    g: FlatGraph,
    read: list[str],
    state: dict[int, int],
    select: list[tuple[int, int, int]],
    choice: tuple[int, ...],
) -> dict[str, Expr]:
    """Return the names that an element reads with their values in one combination."""
    values: dict[str, Expr] = {}
    for name in read:
        kind, _, rest = name.partition(":")
        if kind == "in":
            machine, k = map(int, rest.split(":"))
            values[name] = Bool(state[machine] == k)
        elif kind == "on":
            on = any(int(rest) in g.machines[k].on[c] for k, c in state.items())
            values[name] = Bool(on)
        else:
            code = 1 if kind == "at" else 2
            at = next(i for i, s in enumerate(select) if s[:2] == (code, int(rest)))
            levels = [0.0, 1.0] if kind == "at" else levels_of(g, int(rest))
            values[name] = Number(levels[choice[at]])
    return values


def levels_of(g: FlatGraph, k: int) -> list[float]:
    """Return the levels of an input that is held, in the order of their numbers."""
    waveform = g.inputs[k].waveform
    if isinstance(waveform, Constant):
        return [waveform.level]
    if isinstance(waveform, Pwm):
        return [waveform.high, waveform.low]
    assert isinstance(waveform, Timetable)
    return list(dict.fromkeys(waveform.values))


def discrete_names(graph: FlatGraph) -> tuple[str, ...]:
    """Return the names of such inputs and comparisons of time that enter moduli or resistor laws.

    They select a configuration: with them constant, so are those rows.
    """
    held = {
        f"u:{i.index}"
        for i in graph.inputs
        if isinstance(i.waveform, Constant | Pwm)
        or (isinstance(i.waveform, Timetable) and not i.waveform.linear)
    }
    found: set[str] = set()
    for node in graph.nodes:
        if node.law is not None and node.kind in TWO_PORTS + RESISTORS:
            for e in node.law.expressions:
                found |= {n for n in names(e) if n in held or n.startswith("at:")}
    return tuple(sorted(found))
