"""Diagnostic causality: one assignment for all modes, so that one set of residuals serves all.

The sequential causality assignment procedure for hybrid bond graphs (SCAPH) of C. B. Low,
D. Wang, S. Arogeti and J. B. Zhang, *Causality assignment and model approximation for hybrid
bond graph: fault diagnosis perspectives*, IEEE Trans. Automation Science and Engineering 7(3),
2010: sources, then controlled junctions, then storage, then the rest.

A controlled junction that is ON is told its common variable through one bond, the determining
one; OFF, it tells every bond. So exactly that bond turns, and nothing else if its other end is an
element that takes either causality: a resistor, or a source of the variable in question (a flow
source at a 1-junction, cut off with it). Which of several resistors takes it makes no difference
elsewhere. A sensor that is used as a source of what it measures tells its junction in all modes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

from hybond.causality.assign import assign_off
from hybond.causality.demands import fixed_ends, imposing
from hybond.causality.explain import describe_conflict
from hybond.causality.record import Causality
from hybond.errors import ModelError
from hybond.model.graph import End, FlatGraph, Node
from hybond.model.kinds import RESISTORS, TWO_PORTS, Variable
from hybond.names import did_you_mean


@dataclass(frozen=True, slots=True)
class Absorber:
    """What takes the change of a controlled junction, so that nothing else has to."""

    node: int
    """The resistor or source; the junction itself if it has a sensor, or is a two-port whose
    strokes are the same ON and OFF."""
    bond: int
    """The bond that turns, -1 if none does."""
    kind: Literal["resistor", "source", "sensor", "two-port"]
    note: str = ""
    """What it takes beyond structure, if anything."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A diagnostic causality, or why there is none.

    Parameters
    ----------
    exists : bool
        Whether every controlled junction has an absorber, every storage its preferred causality
        and no variable two causes, checked by switching each controlled junction.
    strokes : tuple of int
        Per bond, with all controlled junctions ON.
    absorbers : mapping
        Controlled node to what absorbs its change.
    missing : mapping
        Controlled node to the reason why nothing does.
    storages : mapping
        Storage (index of `FlatGraph.storages`) that cannot have its preferred causality, to the
        reason.
    conflicts : tuple of str
        Two causes that sources alone make.
    """

    exists: bool
    strokes: tuple[int, ...]
    absorbers: Mapping[int, Absorber]
    missing: Mapping[int, str]
    storages: Mapping[int, str]
    conflicts: tuple[str, ...]


Storage = Literal["derivative", "integral"]


def diagnostic_causality(
    graph: FlatGraph, *, sensors: Iterable[str] = (), storage: Storage = "derivative"
) -> Diagnostic:
    """Assign one causality that holds in all modes, but for a bond per controlled junction.

    Parameters
    ----------
    graph : FlatGraph
        Its pins are kept.
    sensors : iterable of str
        Junctions whose common variable is measured (``"n1"``, also ``"n1.e"``): in a diagnosis
        the measured value is a source there.
    storage : {"derivative", "integral"}
        The preferred causality of storage. Derivative needs no start values, integral no
        differentiation.

    Raises
    ------
    ModelError
        HB-M101 for a sensor that is not at a junction.

    Examples
    --------
    A switch with a resistance absorbs its own change, an ideal one does not:

    >>> import hybond as hb
    >>> m = hb.Model("chopper")
    >>> m.add(V=hb.Se(10), sw=hb.One(), n=hb.Zero(), r=hb.R(1), c=hb.C(1))
    >>> m.bond("V -> sw -> n -> c", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> graph = m.flatten()
    >>> found = diagnostic_causality(graph, sensors=["n"])
    >>> found.exists, graph.nodes[found.absorbers[1].node].path
    (True, 'r')
    >>> m.bonds.remove("sw -> r"); _ = m.elements.pop("r")
    >>> found = diagnostic_causality(m.flatten(), sensors=["n"])
    >>> found.exists, found.missing[1]
    (False, 'neither a resistor nor a flow source is connected to 1-junction sw')
    """
    measured = frozenset(_sensor(graph, name) for name in sensors)
    # What is measured is told to all bonds, as a junction that is OFF tells them zero.
    switched = graph.nodes
    graph = replace(
        graph,
        nodes=tuple(replace(n, controlled=n.controlled or n.index in measured) for n in switched),
    )
    groups: list[tuple[int, bool, dict[int, int]]] = []
    absorbers: dict[int, Absorber] = {}
    missing: dict[int, str] = {}
    for node in switched:
        if node.controlled:
            absorber = _absorber(graph, node, measured)
            if absorber is None:
                missing[node.index] = _nothing(node)
            else:
                absorbers[node.index] = absorber
                groups.append((node.index, True, _strokes_of(node, absorber)))
    for s in graph.storages:
        gives: Variable = "e" if (s.kind == "C") is (storage == "integral") else "f"
        groups.append((s.index, False, {s.bond: imposing(s.sign > 0, gives)}))

    pins = dict(graph.pins)
    causality = assign_off(graph, measured, pins=_joined(pins, groups))
    storages: dict[int, str] = {}
    conflicts: tuple[str, ...] = ()
    if causality.conflicts:
        # One after the other, in the order of the procedure; what cannot be had is left out.
        causality = assign_off(graph, measured, pins=pins)
        known = {(c.node, c.bonds) for c in causality.conflicts}
        conflicts = tuple(_text(graph, measured, causality))
        for index, is_junction, wanted in groups:
            tried = assign_off(graph, measured, pins={**pins, **wanted})
            fresh = [c for c in tried.conflicts if (c.node, c.bonds) not in known]
            if fresh or any(pins.get(b, stroke) != stroke for b, stroke in wanted.items()):
                why = next(iter(_text(graph, measured, tried)), "a pin says otherwise")
                if is_junction:
                    del absorbers[index]
                    missing[index] = why
                else:
                    storages[index] = why
            else:
                pins.update(wanted)
                causality = tried
    sound = all(
        _only_absorbed(graph, causality.strokes, measured, node, absorber)
        for node, absorber in absorbers.items()
    )
    return Diagnostic(
        exists=sound and not (missing or storages or conflicts),
        strokes=causality.strokes,
        absorbers=absorbers,
        missing=missing,
        storages=storages,
        conflicts=conflicts,
    )


def _sensor(graph: FlatGraph, name: str) -> int:
    path = name if name in graph.by_path else name.rpartition(".")[0]
    index = graph.by_path.get(path, -1)
    if index < 0 or not graph.nodes[index].is_junction:
        junctions = [n.path for n in graph.nodes if n.is_junction and not n.hidden]
        raise ModelError(
            f"the sensor {name!r} is not at a junction",
            code="HB-M101",
            where="sensors",
            hint=did_you_mean(name, junctions),
        )
    return index


def _absorber(graph: FlatGraph, node: Node, measured: frozenset[int]) -> Absorber | None:
    """Return what can take the change of a controlled node; a source must, if there is one."""
    if node.kind in TWO_PORTS:
        return Absorber(node.index, -1, "two-port")
    if node.index in measured:
        return Absorber(node.index, -1, "sensor")
    matching = "Se" if node.kind == "0" else "Sf"
    for end in node.ends:
        other = graph.nodes[_other_end(graph, node, end)]
        if other.kind == matching:
            what = "effort" if matching == "Se" else "flow"
            note = f"its {what} has to be zero while {node.path} is OFF"
            return Absorber(other.index, end.bond, "source", note)
    for end in node.ends:
        other = graph.nodes[_other_end(graph, node, end)]
        zero = {other.ends[k].bond for k, _, _ in fixed_ends(other, frozenset())}
        if other.kind in RESISTORS and end.bond not in zero:
            linear = other.law is None or (other.law.linear and len(other.ends) == 1)
            note = "" if linear else f"the law of {other.path} has to be solvable both ways"
            return Absorber(other.index, end.bond, "resistor", note)
    return None


def _other_end(graph: FlatGraph, node: Node, end: End) -> int:
    bond = graph.bonds[end.bond]
    return bond.tail if bond.head == node.index else bond.head


def _strokes_of(node: Node, absorber: Absorber) -> dict[int, int]:
    """Return the strokes at a controlled node that is ON which let `absorber` do its work."""
    if absorber.kind == "two-port":
        ends = fixed_ends(node, frozenset({node.index}))
        return {node.ends[k].bond: imposing(node.ends[k].inward, v) for k, v, _ in ends}
    if absorber.bond < 0:
        return {}
    # The junction is told its common variable: the bond brings it, so imposes the other one.
    end = next(e for e in node.ends if e.bond == absorber.bond)
    return {end.bond: imposing(end.inward, "f" if node.kind == "0" else "e")}


def _joined(
    pins: Mapping[int, int], groups: Iterable[tuple[int, bool, Mapping[int, int]]]
) -> dict[int, int]:
    joined = dict(pins)
    for _, _, wanted in groups:
        for bond, stroke in wanted.items():
            joined.setdefault(bond, stroke)
    return joined


def _only_absorbed(
    graph: FlatGraph,
    strokes: tuple[int, ...],
    measured: frozenset[int],
    node: int,
    absorber: Absorber,
) -> bool:
    """Whether switching `node` OFF turns the absorber's bond and leaves all others valid."""
    turned = list(strokes)
    if absorber.bond >= 0:
        turned[absorber.bond] = 1 - turned[absorber.bond]
    cut_off = frozenset({absorber.node} if absorber.kind == "source" else ())
    pins = dict(enumerate(turned))
    after = assign_off(graph, measured | {node}, pins=pins, unknown=cut_off)
    before = assign_off(graph, measured, pins=dict(enumerate(strokes)))
    return after.strokes == tuple(turned) and len(after.conflicts) <= len(before.conflicts)


def _nothing(node: Node) -> str:
    title = f"{node.kind}-junction {node.path}"
    what = "an effort" if node.kind == "0" else "a flow"
    return f"neither a resistor nor {what} source is connected to {title}"


def _text(graph: FlatGraph, measured: frozenset[int], causality: Causality) -> list[str]:
    """Describe conflicts; what imposes like an OFF junction here is a sensor."""
    texts = []
    for conflict in causality.conflicts:
        text = describe_conflict(graph, None, conflict)
        text = text.replace("the pin at", "the stroke wanted at")
        text = text.replace("it is pinned at", "it is wanted at")
        for k in sorted(measured):
            title = f"{graph.nodes[k].kind}-junction {graph.nodes[k].path}"
            text = text.replace(f"OFF {title}", f"the sensor at {title}")
        texts.append(text)
    return texts
