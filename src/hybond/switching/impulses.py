"""The impulse bond graph of a jump: each bond with its impulse, mean flow and work."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hybond.errors import ModelError
from hybond.model.expressions import Number
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.junction_structure import Row, junction_rows, two_port_rows
from hybond.model.kinds import SOURCES, TWO_PORTS

Vector = NDArray[np.float64]

ROUNDING = 1e-12
"""Works below this part of the largest are rounding and not listed."""


class JumpStep(Protocol):
    """A step of an event, as a run records it."""

    @property
    def mode(self) -> Mode: ...  # noqa: D102
    @property
    def kind(self) -> str: ...  # noqa: D102
    @property
    def impulses(self) -> Mapping[str, float]: ...  # noqa: D102


class JumpEvent(Protocol):
    """An event of a run."""

    @property
    def t(self) -> float: ...  # noqa: D102
    @property
    def before(self) -> Vector: ...  # noqa: D102
    @property
    def steps(self) -> Sequence[Any]: ...  # noqa: D102


class Run(Protocol):
    """What has a flat graph and events: a `Result`."""

    @property
    def graph(self) -> FlatGraph: ...  # noqa: D102
    @property
    def events(self) -> Sequence[Any]: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class BondImpulse:
    """A bond of the impulse bond graph."""

    name: str
    impulse: float
    """Area of the effort's impulse, along the arrow: a momentum in mechanics."""
    mean_flow: float
    """``(f_before + f_after) / 2``; nan where no impulse needs it."""
    flow_impulse: float
    mean_effort: float
    """`flow_impulse` and `mean_effort`: the dual pair: a charge, and the mean of the efforts."""

    @property
    def work(self) -> float:
        """Energy that the jump sends along the arrow, J."""
        return _times(self.impulse, self.mean_flow) + _times(self.flow_impulse, self.mean_effort)


@dataclass(frozen=True, slots=True)
class ImpulseBondGraph:
    """The reading of one written jump."""

    t: float
    mode: str
    bonds: tuple[BondImpulse, ...]
    """In the order of the graph; those without impulse have zeros."""
    stored: Mapping[str, float] = field(default_factory=dict)
    """Energy that each storage took, J, by element."""
    taken: Mapping[str, float] = field(default_factory=dict)
    """Energy that the jump gave to the other elements: sources, impact laws, junctions that were
    switched, J."""

    def __getitem__(self, name: str) -> BondImpulse:
        """Return the bond called `name`, as written."""
        for bond in self.bonds:
            if bond.name == name:
                return bond
        raise KeyError(name)

    @property
    def energy_change(self) -> float:
        """Change of the stored energy, J: the sum of the works at storages."""
        return math.fsum(self.stored.values())


def impulse_bond_graph(run: Run, event: JumpEvent) -> tuple[ImpulseBondGraph, ...]:
    """Return the impulse bond graph of each jump that an event wrote.

    A bond of the impulse bond graph carries an impulse and the mean of the flows before and after
    it. Their product is the energy that passes in the jump: with linear storage, exactly, since
    ``½ m (f² - f₀²) = m (f - f₀) · (f + f₀)/2``. Junctions, transformers and gyrators balance these
    products as they balance power; what is left is with sources, impact laws and the junctions that
    were switched. Electrical jumps of charge are the dual: flow impulse times mean effort.

    Parameters
    ----------
    run : Result
    event : Event
        One of ``run.events``.

    Raises
    ------
    ModelError
        HB-M197 if the event wrote no jump, a storage that jumped is nonlinear, or the structure
        does not tell the mean flow of a bond with an impulse.

    Notes
    -----
    D. Zimmer and F. E. Cellier, *Impulse-bond graphs*, ICBGM 2007. The paper derives the impulse
    bond graph from the regular one and solves it for the jump; here the jump is known, and the
    reading distributes its energy.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("two capacitors", domain="electrical")
    >>> m.add(a=hb.C("1 F", e="10 V"), b=hb.C("2 F", e="4 V"), left=hb.Zero(), right=hb.Zero(),
    ...       sw=hb.One())
    >>> m.bond("left -> a", "right -> b", "left -> sw -> right")
    >>> m.machine("S", states={"open": [], "closed": ["sw"]}, start="open",
    ...           rules=["open -> closed when time >= 1"])
    >>> run = hb.simulate(m, until=2)
    >>> (jump,) = hb.switching.impulse_bond_graph(run, run.events[1])
    >>> jump["left -> sw"].flow_impulse, jump["left -> sw"].mean_effort, jump["left -> sw"].work
    (4.0, 8.0, 32.0)
    >>> dict(jump.stored), dict(jump.taken)
    ({'a': -32.0, 'b': 20.0}, {'sw': 12.0})
    """
    graph = run.graph
    bonds = len(graph.bonds)
    x = np.array(event.before[: len(graph.storages)], dtype=float)
    found = []
    mode = _mode_before(run, event)
    for step in event.steps:
        if step.kind == "mythical":
            continue
        before, mode = mode, step.mode
        if not step.impulses:
            continue
        areas = _areas(graph, step)
        after = x.copy()
        for s in graph.storages:
            after[s.index] += areas[s.bond] if s.kind == "I" else s.sign * areas[bonds + s.bond]
        means = _means(graph, before, mode, x, after)
        found.append(_reading(graph, event.t, mode, areas, means))
        x = after
    if not found:
        raise ModelError(
            f"the event at t = {event.t:.9g} s wrote no jump",
            code="HB-M197",
            where=f"t = {event.t:.9g} s",
            hint="choose an event with a step that has impulses and is not mythical",
        )
    return tuple(found)


def _times(area: float, mean: float) -> float:
    return 0.0 if area == 0.0 else area * mean


def _areas(graph: FlatGraph, step: JumpStep) -> Vector:
    """Return the impulse area of each effort and flow, shape (2 * bonds,).

    The record has those of elements and of junctions' common variables; the rest, such as the
    effort between two 1-junctions, follows from the junction structure.
    """
    bonds = len(graph.bonds)
    off = graph.off_nodes(step.mode)
    known: dict[int, float] = {}
    for node in graph.nodes:
        if node.hidden or not node.ends:
            continue
        if node.is_junction:
            common, first = ("e", 0) if node.kind == "0" else ("f", bonds)
            ends = node.ends if node.index not in off else node.ends[:1]
            for end in ends:
                known[first + end.bond] = step.impulses.get(f"{node.path}.{common}", 0.0)
            continue
        for end in node.ends:
            port = f".{end.port + 1}" if len(node.ends) > 1 else ""
            for variable, first in (("e", 0), ("f", bonds)):
                name = f"{node.path}{port}.{variable}"
                known[first + end.bond] = step.impulses.get(name, 0.0)
    rows = [r for n in graph.nodes for r in _structure(n, bonds, off=n.index in off)]
    areas = _complete(rows, known, 2 * bonds)
    # what no row tells is a share among parallel ways; it moves no storage
    return np.where(np.isnan(areas), 0.0, areas)


def _mode_before(run: Run, event: JumpEvent) -> Mode | None:
    """Return the mode that the event ends; None at the start."""
    mode: Mode | None = None
    for other in run.events:
        if other is event:
            return mode
        mode = other.steps[-1].mode
    return None


def _reading(
    graph: FlatGraph, t: float, mode: Mode, areas: Vector, means: Vector
) -> ImpulseBondGraph:
    bonds = len(graph.bonds)
    rows = []
    for bond in graph.bonds:
        k = bond.index
        row = BondImpulse(
            bond.name,
            float(areas[k]),
            float(means[bonds + k]),
            float(areas[bonds + k]),
            float(means[k]),
        )
        if math.isnan(row.work):
            raise ModelError(
                f"the structure does not tell the mean of {bond.name!r}, which has an impulse "
                f"at t = {t:.9g} s",
                code="HB-M197",
                where=bond.name,
                hint="its element must share a junction with one whose flow (effort) is known",
            )
        rows.append(row)
    works = {
        node.path: math.fsum(end.sign * rows[end.bond].work for end in node.ends)
        for node in graph.nodes
    }
    least = ROUNDING * max((abs(r.work) for r in rows), default=0.0)
    storages = {graph.nodes[s.node].path for s in graph.storages}
    return ImpulseBondGraph(
        t,
        graph.mode_text(mode),
        tuple(rows),
        {path: w for path, w in works.items() if path in storages and w != 0.0},
        {path: w for path, w in works.items() if path not in storages and abs(w) > least},
    )


def _means(graph: FlatGraph, before: Mode | None, mode: Mode, x: Vector, after: Vector) -> Vector:
    """Return the mean of each effort and flow, nan where the structure does not tell.

    What the jump does not switch holds before and after. What remains open is then asked of the
    junctions that are ON in the mode of the jump: the flow of an impact law is the difference of
    the flows that its junction joins.
    """
    bonds = len(graph.bonds)
    known: dict[int, float] = {}
    for s in graph.storages:
        z = _mean_co_energy(graph, s.index, x, after)
        known[s.bond if s.kind == "C" else bonds + s.bond] = z if s.kind == "C" else s.sign * z
    for node in graph.nodes:
        value = None if node.law is None else node.law.expressions[0]
        if node.kind in SOURCES and not node.controlled and isinstance(value, Number):
            known[node.ends[0].bond + (0 if node.kind == "Se" else bonds)] = value.value
    on = graph.on_nodes(mode)
    was_on = graph.on_nodes(before) if before is not None else frozenset()
    same = [
        n
        for n in graph.nodes
        if not n.controlled or (before is not None and (n.index in on) == (n.index in was_on))
    ]
    off = frozenset(n.index for n in same if n.controlled) - on
    always = [r for n in same for r in _structure(n, bonds, off=n.index in off)]
    means = _complete(always, known, 2 * bonds)
    known |= {k: float(v) for k, v in enumerate(means) if not math.isnan(v)}
    switched = [r for n in graph.nodes if n.index in on for r in _structure(n, bonds, off=False)]
    return _complete([*always, *switched], known, 2 * bonds)


def _mean_co_energy(graph: FlatGraph, index: int, x: Vector, after: Vector) -> float:
    """Return the mean of a storage's co-energy variable; nan for a nonlinear one at rest."""
    storage = graph.storages[index]
    node = graph.nodes[storage.node]
    own = [s for s in graph.storages if s.node == node.index]
    assert node.law is not None
    if node.law.matrix is None:
        if all(x[s.index] == after[s.index] for s in own):
            return math.nan
        raise ModelError(
            f"{node.kind} {node.path!r} is nonlinear, so its energy is not impulse times mean",
            code="HB-M197",
            where=node.path,
            hint="read the energies of the step: step.energy",
        )
    coefficients = node.law.matrix[storage.port]
    return 0.5 * math.fsum(coefficients[s.port] * float(x[s.index] + after[s.index]) for s in own)


def _structure(node: Node, bonds: int, *, off: bool) -> Iterable[Row]:
    """Return the rows of a junction or of a two-port with a constant modulus; else none."""
    if node.is_junction:
        return junction_rows(node, bonds, off=off)
    if node.kind not in TWO_PORTS or node.law is None:
        return []
    tree = Number(0.0) if off else node.law.expressions[0]
    if not isinstance(tree, Number):
        return []
    return two_port_rows(node, tree.value, bonds)


def _complete(rows: Iterable[Row], known: Mapping[int, float], size: int) -> Vector:
    """Return all variables that `known` and the rows determine, nan for the rest."""
    values = np.full(size, np.nan)
    for k, v in known.items():
        values[k] = v
    open_ones = [k for k in range(size) if math.isnan(values[k])]
    column = {k: j for j, k in enumerate(open_ones)}
    used = [r for r in rows if any(k in column for k in r)]
    if not used:
        return values
    table, right = np.zeros((len(used), len(open_ones))), np.zeros(len(used))
    for i, row in enumerate(used):
        for k, c in row.items():
            if k in column:
                table[i, column[k]] += c
            else:
                right[i] -= c * values[k]
    solution, *_ = np.linalg.lstsq(table, right, rcond=1e-12)
    _, singular, vt = np.linalg.svd(table)
    rank = int((singular > 1e-12 * singular.max(initial=0.0)).sum())
    told = np.abs(vt[rank:]).max(axis=0, initial=0.0) < 1e-9
    for k, v, sure in zip(open_ones, solution, told, strict=True):
        if sure:
            values[k] = v
    return values
