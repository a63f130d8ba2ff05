"""Tables of the laws of junctions: the columns `port_*` of `hybond.engine.model.Model`."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

from hybond.engine.tables.expressions import number_of
from hybond.equations.calculus import gradient, partial_time
from hybond.model.expressions import Expr, Number, names
from hybond.model.graph import FlatGraph
from hybond.model.joined import Joined
from hybond.model.laws import JunctionLaw
from hybond.model.planar_friction import HEADING, SLOW
from hybond.names import join

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

NONE = -2
"""What stands for an option that a law does not have."""
CONFIGURATIONS = 128
"""Ways to set what machines switch beside the laws up to which the tables say for each which
variable of each law is given, at some 2 ms each; beyond, the engine finds it from the equations of
what it enters."""
OPTIONS = ("limit", "breakaway", "gap", "gate", "restitution", "stiffness")


def put_laws(t: ModelTables) -> None:
    """Put the laws of junctions into the tables: a port for each junction that has one."""
    g = t.graph
    laws = [(m, law) for m in g.machines if m.law is not None for law in m.law.junctions]
    junctions = [n.index for n in g.nodes if n.is_junction]
    domains = sorted({g.nodes[law.node].domain.name for _, law in laws})
    t.numbers["ports"] = len(laws)
    t.ints["port_machine"] = [m.index for m, _ in laws]
    t.ints["port_node"] = [law.node for _, law in laws]
    by_name = sorted(range(len(laws)), key=lambda k: g.nodes[laws[k][1].node].path)
    t.ints["port_rank"] = sorted(range(len(laws)), key=by_name.__getitem__)
    t.ints["port_junction"] = [junctions.index(law.node) for _, law in laws]
    t.ints["port_domain"] = [domains.index(g.nodes[law.node].domain.name) for _, law in laws]
    t.ints["port_two_sided"] = [int(law.two_sided) for _, law in laws]
    t.ints["port_planar"] = [int(law.planar) for _, law in laws]
    t.ints["port_impulsive"] = [int(law.impulsive) for _, law in laws]
    for option in OPTIONS:
        _put_option(t, option, [law for _, law in laws])
    _put_gaps(t, [law for _, law in laws])
    _put_pairs(t, [law for _, law in laws])
    _put_slopes(t, [law for _, law in laws])
    _put_disks(t, [law for _, law in laws])
    _put_orientation(t)


def _put_option(t: ModelTables, option: str, laws: list[JunctionLaw]) -> None:
    numbers, constants = [], []
    for law in laws:
        e: Expr | None = getattr(law, option)
        number, constant = (NONE, 0.0) if e is None else t.values.entry(e, option)
        numbers.append(number)
        constants.append(constant)
    t.ints[f"port_{option}"] = numbers
    t.floats[f"port_{option}_constant"] = constants


def _put_gaps(t: ModelTables, laws: list[JunctionLaw]) -> None:
    """Put how fast gaps open; gaps and gates among the pairs: their rounding is of their terms."""
    # a constant gap says that the sides touch at all times, or never
    moving = [None if law.gap is None or not names(law.gap) else law.gap for law in laws]
    rates = [None if e is None else t.values.entry(partial_time(e, t.graph)) for e in moving]
    t.ints["port_gap_rate"] = [NONE if rate is None else rate[0] for rate in rates]
    t.floats["port_gap_rate_constant"] = [0.0 if rate is None else rate[1] for rate in rates]
    t.ints["port_gap_pair"] = _paired(t, [law.gap for law in laws])
    # what gates compare has rounding, as in the rules of their law
    t.ints["port_gate_pair"] = _paired(t, [law.gate for law in laws])


def _paired(t: ModelTables, said: list[Expr | None]) -> list[int]:
    """Put what is no number among the pairs; return where each of them is."""
    places = []
    for e in said:
        if e is None or isinstance(e, Number):
            places.append(-1)
            continue
        places.append(len(t.pairs))
        t.pairs.append(e)
    return places


def _column(g: FlatGraph, name: str) -> int:
    kind, _, index = name.partition(":")
    return int(index) + (len(g.bonds) if kind == "f" else 0)


def _put_pairs(t: ModelTables, laws: list[JunctionLaw]) -> None:
    """Put the common and the net variable of each port, sums of bond variables."""
    first, columns, values = [0], [], []
    for law in laws:
        for e in (law.common, law.net):
            for name, slope in gradient(e).items():
                assert isinstance(slope, Number)
                columns.append(_column(t.graph, name))
                values.append(number_of(slope.value))
            first.append(len(columns))
    t.ints["pair_first"] = first
    t.ints["pair_column"] = columns
    t.floats["pair_value"] = values


def _put_slopes(t: ModelTables, laws: list[JunctionLaw]) -> None:
    """Put how limits of friction follow bond variables."""
    first, columns, slopes, constants = [0], [], [], []
    for law in laws:
        for e in (law.limit, law.breakaway):
            for name, slope in gradient(e).items() if e is not None else ():
                number, constant = t.values.entry(slope)
                columns.append(_column(t.graph, name))
                slopes.append(number)
                constants.append(constant)
            first.append(len(columns))
    t.ints["limit_first"] = first
    t.ints["limit_column"] = columns
    t.ints["limit_slope"] = slopes
    t.floats["limit_slope_constant"] = constants


def _put_disks(t: ModelTables, laws: list[JunctionLaw]) -> None:
    """Put friction in the plane: the ports of each disk, and what it keeps between events."""
    g = t.graph
    own = [m for m in g.machines if m.law is not None and m.law.planar]
    at = {i.path: i.index for i in g.integrals}
    place = {law.node: k for k, law in enumerate(laws)}
    t.numbers["disks"] = len(own)
    t.ints["disk_machine"] = [m.index for m in own]
    t.ints["disk_port"] = [place[law.node] for m in own if m.law for law in m.law.junctions]
    t.ints["disk_heading"] = [at[join(m.path, HEADING)] for m in own]
    t.ints["disk_slow"] = [at[join(m.path, SLOW)] for m in own]
    t.ints["law_planar"] = [int(m.law is not None and m.law.planar) for m in g.machines]


def _put_orientation(t: ModelTables) -> None:
    """Put which variable of each law is given, for all that the other machines switch."""
    g = t.graph
    t.ints["orient"] = []
    t.ints["orient_place"] = []
    t.numbers["oriented"] = 1
    if not t.numbers["ports"]:
        return
    from hybond.causality.arrays import compile_arrays
    from hybond.causality.orientation import orientation

    kinds = _kinds_of_states(g)
    sizes = [1 + max(kind) for kind in kinds]
    arrays = compile_arrays(g)
    if math.prod(sizes) > CONFIGURATIONS:
        # those of the start are where the search begins for a setting that is entered
        t.numbers["oriented"] = 0
        t.ints["orient_place"] = [0 for kind in kinds for _ in kind]
        t.ints["orient"] = [int(v == "net") for v in orientation(g, g.start_mode, arrays).values()]
        return
    stride = math.prod(sizes)
    for kind, size in zip(kinds, sizes, strict=True):
        stride //= size
        t.ints["orient_place"] += [stride * k for k in kind]
    known: dict[frozenset[int], list[int]] = {}
    for setting in product(*(range(k) for k in sizes)):
        mode = tuple(kind.index(k) for kind, k in zip(kinds, setting, strict=True))
        on = g.on_nodes(mode)
        if on not in known:
            given = orientation(g, mode, arrays)
            known[on] = [int(v == "net") for v in given.values()]
        t.ints["orient"] += known[on]


def _kinds_of_states(g: FlatGraph) -> list[list[int]]:
    """Number the states of each machine by what they switch on where power reaches a law.

    A machine of signals alone, or of a clock of its own, has one kind of state, and so has a law.
    """
    laws = {law.node for m in g.machines if m.law is not None for law in m.law.junctions}
    near = {node for part in _parts(g) if not laws.isdisjoint(part) for node in part}
    found = []
    for m in g.machines:
        switched = [frozenset(near.intersection(m.on[k])) for k in range(len(m.states))]
        kinds = [switched[0]] * len(switched) if m.law is not None else switched
        different = list(dict.fromkeys(kinds))
        found.append([different.index(kind) for kind in kinds])
    return found


def _parts(g: FlatGraph) -> list[set[int]]:
    """Return the nodes that bonds join, part by part."""
    parts = Joined(range(len(g.nodes)))
    for bond in g.bonds:
        parts.join((bond.tail, bond.head))
    return [set(part) for part in parts.groups()]
