"""Strokes of a level in one mode, as they are printed: from the graph, or from what there is of it.

While a model is drawn it means nothing yet: elements lack bonds, guards read what is not there.
Its causality can be told all the same, from kinds and bonds alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hybond.causality.arrays import compile_arrays
from hybond.causality.dynamics import causality_of, dynamics
from hybond.causality.explain import conflict_error
from hybond.causality.reference import reference_mode
from hybond.draw.sketch import Arrow, sketch
from hybond.errors import HybondError
from hybond.files.load import from_data
from hybond.model.arrays import base_of, is_array
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph, Mode
from hybond.model.kinds import TWO_PORTS
from hybond.names import join, steps
from hybond.studio.chains import links, node_of
from hybond.studio.levels import Data, bonds_of, table
from hybond.studio.view import kind_of


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a text means.

    Parameters
    ----------
    model : Model or None
    graph : FlatGraph or None
        What the strokes are of.
    whole : bool
        Whether that is the model; else it is what can be told of it.
    error : HybondError or None
        Why it is not the model.
    """

    model: Model | None
    graph: FlatGraph | None
    whole: bool
    error: HybondError | None = None


def meaning(data: Data, *, base: str | None, where: str) -> Meaning:
    """Return what the data of a model file mean, as far as they do.

    Examples
    --------
    >>> data = {"hybond": 1, "elements": {"V": {"Se": "1 V"}, "L": {"I": "1 H"},
    ...         "v": {"junction": 1}, "R": {"R": "x"}}, "graph": {"bonds": ["V -> v -> L"]}}
    >>> known = meaning(data, base=None, where="rl.toml")
    >>> known.whole, known.error.code, len(known.graph.bonds)
    (False, 'HB-M130', 2)
    """
    model = None
    try:
        model = from_data(data, base=base, where=where)
        graph = model.flatten()
        return Meaning(model, graph, True)
    except HybondError as error:
        told = error
    try:
        drawn = from_data(skeleton(data), base=base, where=where)
        graph = drawn.flatten()
        return Meaning(model, graph, False, told)
    except HybondError:
        return Meaning(model, None, False, told)


def skeleton(data: Data) -> Data:
    """Return kinds, bonds and states alone, without what is not joined to anything.

    Examples
    --------
    >>> skeleton({"hybond": 1, "elements": {"r": {"R": "u*x"}, "v": {"junction": 1}, "c": {"C": 1}},
    ...           "graph": {"bonds": ["v -> r"]}})["elements"]
    {'r': {'R': 1}, 'v': {'junction': 1}}
    """
    elements = {k: v for k, v in table(data, "elements").items() if isinstance(v, dict)}
    kinds = {name: kind_of(entry) for name, entry in elements.items()}
    bonds = [b for b in links(bonds_of(data)) if b.tail != b.head]
    while True:
        count: dict[str, int] = {}
        bonds = [
            b for b in bonds if {node_of(b.tail, kinds), node_of(b.head, kinds)} <= kinds.keys()
        ]
        for b in bonds:
            for end in (b.tail, b.head):
                node = node_of(end, kinds)
                count[node] = count.get(node, 0) + 1
        least = {name: 2 if kind in TWO_PORTS else 1 for name, kind in kinds.items()}
        poor = {
            name
            for name, kind in kinds.items()
            if kind == "?" or (kind not in ("0", "1") and count.get(name, 0) < least[name])
        }
        if not poor:
            break
        kinds = {k: v for k, v in kinds.items() if k not in poor}
    kept: Data = {}
    for name, kind in kinds.items():
        entry = elements[name]
        if kind in ("0", "1"):
            kept[name] = {k: v for k, v in entry.items() if k in ("junction", "law")}
        elif kind == "part":
            kept[name] = {"submodel": entry["submodel"]}
        else:
            value = entry[kind]
            kept[name] = {kind: value if isinstance(value, list) else 1}
    machines = {}
    for name, machine in table(data, "machines").items():
        states = table(machine, "states") if isinstance(machine, dict) else {}
        if states and machine.get("start") in states:
            listed = {
                s: [n for n in on if node_of(str(n), kept) in kept] if isinstance(on, list) else []
                for s, on in states.items()
            }
            machines[name] = {"states": listed, "start": machine["start"]}
    found: Data = {
        "hybond": 1,
        "elements": kept,
        "graph": {"bonds": [f"{b.tail} -> {b.head}" for b in bonds]},
    }
    if machines:
        found["machines"] = machines
    if any("[" in name for name in kept):
        found["parameters"] = table(data, "parameters")
    if "models" in data:
        found["models"] = data["models"]
    return found


def strokes(known: Meaning, mode: Mode | None, path: str) -> dict[str, Any]:
    """Return the strokes of the bonds of a level, and what is OFF or in derivative causality.

    A part is OFF when every junction in it that is switched is.

    Bonds are told by the numbers of their chain and arrow where the graph is the model, and by
    their ends where it is what can be told of it.
    """
    graph = known.graph
    if graph is None:
        return {"bonds": {}, "nodes": {}, "conflicts": []}
    compiled = compile_arrays(graph)
    reference = reference_mode(graph, arrays=compiled)
    mode = graph.start_mode if mode is None else mode
    causality = causality_of(graph, mode, reference=reference, arrays=compiled)
    shown = sketch(
        graph,
        mode=mode,
        causality=causality,
        dynamic_bonds=dynamics(graph, reference, arrays=compiled).dynamic,
        title=False,
    )
    bonds: dict[str, Any] = {}
    path = first_member(path, graph)
    prefix = join(path, "graph.bonds[")
    written_bonds = [b for b in graph.bonds if b.where]
    for written, arrow in zip(written_bonds, shown.arrows, strict=True):
        if not written.where.startswith(prefix):
            continue
        chain = written.where[len(prefix) : -1]
        if not known.whole:
            chain, key = "", written.name
        else:
            key = f"{chain}.{written.arrow}"
        bonds.setdefault(key, _arrow(arrow))  # of a range the first is shown for all
    nodes: dict[str, Any] = {}
    own = () if path or known.model is None else known.model.elements
    arrays = {base_of(key): key for key in own if is_array(key)}
    start = f"{path}." if path else ""
    switched: dict[str, list[bool]] = {}
    for symbol in shown.symbols:
        if not symbol.path.startswith(start):
            continue
        if "." in symbol.path[len(start) :]:
            if symbol.controlled:
                part = steps(symbol.path[len(start) :])[0]
                switched.setdefault(part, []).append(symbol.off)
            continue
        about = {
            "off": symbol.off,
            "derivative": symbol.derivative,
            "controlled": symbol.controlled,
        }
        told: dict[str, Any] = {k: True for k, v in about.items() if v}
        if known.whole and symbol.parameter and symbol.kind not in ("0", "1"):
            told["says"] = symbol.parameter
        name = symbol.path[len(start) :]
        nodes[name] = told
        if base_of(name) in arrays:
            # the first member is shown for all, its value is not that of all
            one = {k: v for k, v in told.items() if k != "says"}
            nodes[arrays.pop(base_of(name))] = one
    for name, off in switched.items():  # a part is OFF when all that is switched in it is
        if all(off):
            nodes[name] = {"off": True}
            if base_of(name) in arrays:
                nodes[arrays.pop(base_of(name))] = {"off": True}
    conflicts = [] if _decided_by_laws(graph) else causality.conflicts
    return {
        "bonds": bonds,
        "nodes": nodes,
        "conflicts": [conflict_error(graph, mode, c).to_dict() for c in conflicts],
    }


def first_member(path: str, graph: FlatGraph) -> str:
    """Return a path with the first member in place of each array: one is shown for all."""
    if "[" not in path:
        return path
    wanted = [base_of(step) for step in steps(path)]
    for node in graph.nodes:
        own = steps(node.path)[: len(wanted)]
        if [base_of(step) for step in own] == wanted:
            return ".".join(own)
    return path


def _decided_by_laws(graph: FlatGraph) -> bool:
    """Whether laws of junctions choose branches that have a causality; others are not entered."""
    return any(m.law is not None for m in graph.machines)


def _arrow(arrow: Arrow) -> dict[str, Any]:
    found: dict[str, Any] = {"strokes": list(arrow.strokes)}
    if arrow.dashed:
        found["dashed"] = list(arrow.dashed)
    if arrow.late:
        found["late"] = list(arrow.late)
    for name in ("off", "conflict", "integral"):
        if getattr(arrow, name):
            found[name] = True
    return found


def mode_of(known: Meaning, states: Mapping[str, str] | None) -> Mode | None:
    """Return the mode with these states, None if the graph has no such machines any more."""
    graph = known.graph
    if graph is None or not states:
        return None
    by_path = {m.path: m for m in graph.machines}
    kept = {k: v for k, v in states.items() if k in by_path and v in by_path[k].states}
    return graph.mode_of(kept)
