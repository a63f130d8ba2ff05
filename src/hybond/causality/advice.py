"""Where a resistor would make causality the same in all modes, and what stiffness it costs.

A resistor takes either causality, so one that stands between a switch and the rest absorbs what
switching turns ("causality resistance", G. Asher, *The robust modelling of variable topology
circuits using bond graphs*, ICBGM'93). In series it has to be small, in parallel
large, and then it makes a short time constant with the storage around it: the price.

Places next to the switches are tried, one resistor first, then two and three, and each trial is
judged by assigning causality to the changed graph in the modes of the machines involved.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product

from hybond.causality.advice_record import AT_MOST, Advice, Resistor, advice_text
from hybond.causality.assign import assign_off
from hybond.causality.dynamics import Dynamics, dynamics
from hybond.causality.graft import Grafted, Kind, Place, held, with_resistor
from hybond.causality.loop_gain import loop_gain
from hybond.causality.record import HEAD
from hybond.causality.reference import reference_mode
from hybond.causality.strokes import Strokes
from hybond.causality.time_constants import coefficients, time_constants
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.kinds import RESISTORS
from hybond.model.pins import pin_names

FASTER = 100.0
"""How much shorter than the shortest time constant of the model the proposed one is."""

TRIALS = 400
"""Sets of places that are tried for one group of switches."""

MODES = 32
"""Modes of a group that are examined in full; of more only those one machine away."""

BONDS = 400
"""Bonds above which time constants are those of the reference mode alone."""

_Known = dict[Mode, tuple[float, ...] | None]
"""Time constants by mode: most groups share the reference mode."""


def advise(graph: FlatGraph, found: Dynamics | None = None) -> tuple[Advice, ...]:
    """Return one advice per group of switches whose strokes reach storage or other switches.

    Parameters
    ----------
    found : Dynamics, optional
        What `dynamics` says of it.

    Examples
    --------
    A switch that opens a coil:

    >>> import hybond as hb
    >>> m = hb.Model("coil", domain="electrical")
    >>> m.add(V=hb.Se("10 V"), sw=hb.One(), r=hb.R("1 ohm"), l=hb.I("0.1 H"))
    >>> m.bond("V -> sw -> l", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> (advice,) = advise(m.flatten())
    >>> print(advice.text)
    Switching sw turns 'sw -> l'; l.p is integral or derivative, by the mode.
    A resistor r1 in parallel makes causality the same in all modes: put a 0-junction n1 into
    'sw -> l', as in "sw -> n1 -> l", "n1 -> r1".
    It makes a time constant of 0.1/R s: with R = 100 SI 0.001 s, 1/100 of the fastest (0.1 s).
    """
    if found is None:
        found = dynamics(graph, reference_mode(graph, mode=graph.reference, pins=graph.pins))
    advice = []
    known: _Known = {}
    for group in _groups(graph, found):
        turned = tuple(b for b, by in found.through.items() if not group.isdisjoint(by))
        if _reaches(graph, found, turned):
            advice.append(_advise(graph, found, sorted(group), turned, known))
    return tuple(advice)


def _groups(graph: FlatGraph, found: Dynamics) -> list[set[int]]:
    """Return the switches that turn strokes, joined if they share a bond or a machine."""
    groups: list[set[int]] = []
    for by in found.through.values():
        machines = {graph.nodes[k].machine for k in by}
        new = {k for k in by}
        rest = []
        for group in groups:
            if group & new or machines & {graph.nodes[k].machine for k in group}:
                new |= group
                machines |= {graph.nodes[k].machine for k in group}
            else:
                rest.append(group)
        groups = [*rest, new]
    return sorted(groups, key=min)


def _reaches(graph: FlatGraph, found: Dynamics, turned: tuple[int, ...]) -> bool:
    """Whether turned strokes reach storage, or a switch other than the one that turns them."""
    storage = {s.bond for s in graph.storages}
    together: set[int] = set()
    for bond in turned:
        by = found.through[bond]
        if bond in storage or _touches(graph, bond, by):
            return True
        together.update(by if len(by) > 1 else ())
    # Switches of one machine turn together: ask what each of them does alone.
    off = graph.off_nodes(found.reference.mode)
    base = assign_off(graph, off)
    for k in sorted(together):
        alone = assign_off(graph, off ^ {k})
        if len(alone.conflicts) > len(base.conflicts):
            return True
        if any(_touches(graph, b, (k,)) for b in turned if alone.strokes[b] != base.strokes[b]):
            return True
    return False


def _touches(graph: FlatGraph, bond: int, by: tuple[int, ...]) -> bool:
    """Whether a bond ends at a switch that is not among `by`."""
    ends = (graph.bonds[bond].tail, graph.bonds[bond].head)
    return any(graph.nodes[k].controlled and k not in by for k in ends)


@dataclass(frozen=True, slots=True)
class _Judged:
    """How causality is over the modes of a group: conflicts, strokes turned outside, late."""

    conflicts: int
    turned: int
    late: int


def _advise(
    graph: FlatGraph,
    found: Dynamics,
    switches: list[int],
    turned: tuple[int, ...],
    known: _Known,
) -> Advice:
    modes = _modes(graph, found.reference.mode, switches)
    own = {k: at for k in switches if (at := _own_resistors(graph, k))}
    absorbed = frozenset(b for at in own.values() for b in at)
    now = _judge(Grafted(graph), modes)
    places = list(_places(graph, [k for k in switches if k not in own], switches, turned))
    best: tuple[_Judged, Grafted, tuple[Place, ...]] | None = None
    trials = 0
    for count in range(AT_MOST + 1):
        for chosen in combinations(places, count):
            if best is not None and not best[0].late:
                break
            trials += 1
            split = [p.bond for p, _ in chosen if p.bond >= 0]
            if trials > TRIALS or len(set(split)) < len(split):
                continue
            free = Grafted(graph, inside=absorbed)
            for place, side in chosen:
                free = with_resistor(free, place, side=side)
            fixed = free
            for k in switches:
                if k in own or any(p.node == k for p, _ in chosen):
                    fixed = held(fixed, k)
            for grafted in [free] if fixed is free else [free, fixed]:
                judged = _judge(grafted, modes)
                good = not judged.turned and judged.conflicts == 0 and judged.late <= now.late
                if good and (best is None or judged.late < best[0].late):
                    best = (judged, grafted, tuple(p for p, _ in chosen))
        if best is not None:
            break
    constants = _constants(graph, modes, known)
    resistors: tuple[Resistor, ...] = ()
    pins: dict[str, str] = {}
    if best is not None:
        fastest = constants[0] if constants else None
        resistors = _resistors(graph, best[1], best[2], modes, fastest)
        given = best[1].graph.pins.items()
        pins = pin_names(best[1].graph, {b: s for b, s in given if b not in graph.pins})
    storages = tuple(s.path for s in graph.storages if s.bond in turned)
    names = tuple(_name(graph.nodes[k]) for k in switches)
    bonds = tuple(graph.bonds[b].name for b in turned)
    return Advice(
        switches=names,
        bonds=bonds,
        storages=storages,
        resistors=resistors,
        pins=pins,
        fastest=constants[0] if constants else None,
        slowest=constants[-1] if constants else None,
        text=advice_text(names, bonds, storages, resistors, pins, constants),
    )


def _modes(graph: FlatGraph, reference: Mode, switches: list[int]) -> list[Mode]:
    """Return the reference mode first, then the others that the machines of a group make."""
    machines = sorted({m for k in switches if (m := graph.nodes[k].machine) is not None})
    states = [range(len(graph.machines[m].states)) for m in machines]
    found = {reference: None}
    if math.prod(len(s) for s in states) <= MODES:
        for chosen in product(*states):
            mode = list(reference)
            for m, state in zip(machines, chosen, strict=True):
                mode[m] = state
            found[tuple(mode)] = None
    else:
        for m, own in zip(machines, states, strict=True):
            for state in own:
                found[(*reference[:m], state, *reference[m + 1 :])] = None
    return list(found)


def _judge(grafted: Grafted, modes: list[Mode]) -> _Judged:
    graph = grafted.graph
    strokes = Strokes(graph, modes[0], pins=graph.pins)
    base = list(strokes.strokes)
    conflicts, late = int(strokes.conflict), len(strokes.derivative)
    turned: set[int] = set()
    for mode in modes[1:]:
        strokes.switch(mode)
        turned |= {b for b, s in enumerate(strokes.strokes) if s != base[b]}
        conflicts += strokes.conflict
        late += len(strokes.derivative)
        strokes.undo()
    return _Judged(conflicts, len(turned - grafted.inside), late)


def _own_resistors(graph: FlatGraph, switch: int) -> list[int]:
    """Return the bonds between a switch and resistors at it: strokes that may turn there."""
    node = graph.nodes[switch]
    found = []
    for end in node.ends:
        bond = graph.bonds[end.bond]
        far = graph.nodes[bond.tail if end.inward else bond.head]
        if node.is_junction and far.kind in RESISTORS and len(far.ends) == 1:
            found.append(end.bond)
    return found


def _places(
    graph: FlatGraph, bare: list[int], switches: list[int], turned: tuple[int, ...]
) -> Iterator[tuple[Place, int]]:
    """Yield where a resistor might help, with the node whose side of a split bond may turn.

    The switches in `bare` have no resistor of their own.
    """
    seen: set[Place] = set()
    for k in switches:
        node = graph.nodes[k]
        places: list[tuple[Place, int]] = []
        if k in bare and node.is_junction and not node.hidden:
            places.append((Place(_kind(node), node=k), k))
        both: tuple[Kind, ...] = ("0", "1")
        kinds = [kind for kind in both if kind != node.kind]
        for end in node.ends:
            bond = graph.bonds[end.bond]
            far = graph.nodes[bond.tail if end.inward else bond.head]
            behind = node.hidden and far.path == _name(node)
            if end.bond not in turned or far.kind in RESISTORS or behind:
                continue
            for kind in kinds:
                if far.kind == kind and not far.controlled:
                    places.append((Place(kind, node=far.index), k))
                else:
                    places.append((Place(kind, bond=end.bond), k))
        for place, side in places:
            if place not in seen:
                seen.add(place)
                yield place, side


def _kind(node: Node) -> Kind:
    return "0" if node.kind == "0" else "1"


def _resistors(
    graph: FlatGraph,
    grafted: Grafted,
    places: tuple[Place, ...],
    modes: list[Mode],
    fastest: float | None,
) -> tuple[Resistor, ...]:
    after = grafted.graph
    stiffness = coefficients(after)
    strokes = Strokes(after, modes[0], pins=after.pins)
    gains: dict[int, list[float | None]] = {bond: [] for bond in grafted.resistors}
    for mode in modes:
        if mode != strokes.mode:
            strokes.switch(mode)
        off = after.off_nodes(mode)
        for bond, place in zip(grafted.resistors, places, strict=True):
            gives_flow = strokes.strokes[bond] == HEAD
            if gives_flow is (place.kind == "1"):
                at = tuple(strokes.strokes)
                gains[bond].append(loop_gain(after, at, off, bond, stiffness))
    found = []
    for bond, place in zip(grafted.resistors, places, strict=True):
        seen = gains[bond]
        gain = None if None in seen else max((g for g in seen if g is not None), default=0.0)
        value = tau = None
        if gain and fastest is not None:
            tau = fastest / FASTER
            value = tau * gain if place.kind == "1" else 1.0 / (tau * gain)
        added = after.bonds[bond]
        found.append(
            Resistor(
                name=after.nodes[added.head].path,
                kind=place.kind,
                junction=after.nodes[added.tail].path,
                splits=graph.bonds[place.bond].name if place.bond >= 0 else "",
                value=value,
                time_constant=tau,
                gain=gain,
            )
        )
    return tuple(found)


def _constants(graph: FlatGraph, modes: list[Mode], known: _Known) -> tuple[float, ...]:
    """Return the time constants in `modes`, fastest first; none if they are not known."""
    found: list[float] = []
    for mode in modes if len(graph.bonds) <= BONDS else modes[:1]:
        if mode not in known:
            known[mode] = time_constants(graph, mode)
        constants = known[mode]
        if constants is None:
            return ()
        found += constants
    return tuple(sorted(found))


def _name(node: Node) -> str:
    return node.path.removesuffix(".switch") if node.hidden else node.path
