"""Energy that is lost in jumps, by the junction where it goes.

Storage exchanges impulses through the power structure. The energy that an impulse brings to a
place is its area times the mean of the conjugate variable before and after; it adds up to nothing
over all places, but for the junctions that switch: before, the efforts of one that closes did not
add up, and after, those of one that opens did. What is left there is lost. For linear storage this
is exact (Tellegen's theorem and a quadratic energy); for other storage what the run recorded as
lost is split in the same proportion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError
from hybond.measures.window import Window
from hybond.model.expressions import Name, Number, names, substitute
from hybond.model.fieldless import reads_pre
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.records import dataclass
from hybond.runs.trace import Event, Visit

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]

ROUNDING = 1e-9
"""Part of the energy of a jump that counts as nothing."""


@dataclass(slots=True)
class Jump:
    """What one jump did to the energy: J by the number of the node."""

    t: float
    supplied: dict[int, float] = field(default_factory=dict)
    lost: dict[int, float] = field(default_factory=dict)
    shared: bool = False
    """Whether it was split between several junctions in proportion."""


def jumps_in(run: Result, window: Window) -> list[Jump]:
    """Return what the jumps within a window did to the energy; what writes nothing is left out."""
    found = []
    for event in run.events.with_impulses():
        if event.cause == "step" or not window.has(event.t):
            continue
        found += _of_event(run, event)
    return found


def _of_event(run: Result, event: Event) -> list[Jump]:
    graph = run.graph
    state = np.array(event.before, dtype=float)
    found = []
    for k, step in enumerate(event.steps):
        energy = step.energy
        if energy is None or step.kind == "mythical" or not step.areas:
            continue
        after = _moved(graph, state, step)
        first = k == 0 or not any(s.areas for s in event.steps[:k] if s.kind != "mythical")
        size = max(abs(energy.before), abs(energy.after), abs(energy.source))
        if abs(energy.lost) > 1e-15 * size or abs(energy.source) > 0.0:
            found.append(_of_step(run, event, step, state, after, first=first))
        state = after
    return found


def _moved(graph: FlatGraph, state: Vector, step: Visit) -> Vector:
    """Return the state after a step: each stored quantity jumps by the impulse of its rate."""
    after = state.copy()
    for s in graph.storages:
        rate = f"{'f' if s.kind == 'C' else 'e'}:{s.bond}"
        after[s.index] += s.sign * step.areas.get(rate, 0.0)
    return after


def _of_step(
    run: Result, event: Event, step: Visit, before: Vector, after: Vector, *, first: bool
) -> Jump:
    graph, areas = run.graph, step.areas
    assert step.energy is not None
    jump = Jump(event.t)
    struck = [n for n in graph.nodes if any(_area(areas, end.bond) for end in n.ends)]
    givers = [n for n in struck if n.kind in ("Se", "Sf") and not reads_pre(n)]
    givers = [n for n in givers if not n.domain.pseudo]
    switches = [n for n in struck if n.controlled]
    modes = _mode_before(graph, step), step.mode
    values = _Values(run, event, before, after, modes, first=first)
    supplied = {n.index: _supplied(n, areas, values, step.mode) for n in givers} if givers else {}
    own = [n for n in givers if not n.implied]
    if len(own) == 1:
        supplied[own[0].index] = step.energy.source
    lost = step.energy.lost
    for n in givers:
        if n.implied:
            # the law of a junction: what its source takes is a part of what is lost
            taken = -supplied.pop(n.index)
            jump.lost[owner_of(graph, n).index] = taken
            lost -= taken
    jump.supplied = supplied
    places = [*switches, *givers]
    if len(switches) == 1 and not givers:
        jump.lost[switches[0].index] = jump.lost.get(switches[0].index, 0.0) + lost
        return jump
    if not places:
        fired = {f.machine for f in step.fired}
        machines = [m for m in graph.machines if m.path in fired]
        places = [graph.nodes[k] for m in machines for k in sorted(m.controls)]
    weights: dict[int, float] = {}
    for n in places:
        at = owner_of(graph, n).index
        weights[at] = weights.get(at, 0.0) + _weight(n, areas, values, step.mode)
    for place, part in _split(weights, lost, jump).items():
        jump.lost[place] = jump.lost.get(place, 0.0) + part
    return jump


def _mode_before(graph: FlatGraph, step: Visit) -> Mode:
    """Return the mode that a step was entered from."""
    found = list(step.mode)
    machines = {m.path: m for m in graph.machines}
    for fired in reversed(step.fired):
        machine = machines.get(fired.machine)
        if machine is not None and fired.source in machine.states:
            found[machine.index] = machine.states.index(fired.source)
    return tuple(found)


def _split(weights: dict[int, float], lost: float, jump: Jump) -> dict[int, float]:
    """Return what was lost by place; nowhere (-1) if there is none."""
    if not weights:
        return {-1: lost} if lost else {}
    if len(weights) == 1:
        return {next(iter(weights)): lost}
    total = sum(weights.values())
    size = max(*(abs(w) for w in weights.values()), abs(lost))
    largest = max(weights, key=lambda k: abs(weights[k]))
    if abs(total - lost) <= ROUNDING * size:
        weights[largest] += lost - total
        return weights
    jump.shared = True
    if total > ROUNDING * size and min(weights.values()) >= -ROUNDING * size:
        return {k: lost * w / total for k, w in weights.items()}
    return {k: lost / len(weights) for k in weights}


def _weight(node: Node, areas: Mapping[str, float], values: _Values, mode: Mode) -> float:
    """Return what impulses bring to a junction, or to a source less what it is said to give."""
    if node.is_junction:

        def brought_by(area: float, other: str) -> float:
            # most have no impulse of one kind: what is beside it need not be read
            return area * values.mean(other) if area else 0.0

        return sum(
            end.sign
            * (
                brought_by(areas.get(f"e:{end.bond}", 0.0), f"f:{end.bond}")
                + brought_by(areas.get(f"f:{end.bond}", 0.0), f"e:{end.bond}")
            )
            for end in node.ends
        )
    own, other = ("e", "f") if node.kind == "Se" else ("f", "e")
    bond = node.ends[0].bond
    after = values.of_law(node, mode) if node.implied else values.after(f"{own}:{bond}")
    step = after - values.mean(f"{own}:{bond}")
    brought = areas.get(f"{other}:{bond}", 0.0) * step
    if area := areas.get(f"{own}:{bond}", 0.0):
        brought += area * (values.after(f"{other}:{bond}") - values.mean(f"{other}:{bond}"))
    return -node.ends[0].sign * brought


def _supplied(node: Node, areas: Mapping[str, float], values: _Values, mode: Mode) -> float:
    """Return the work of a source: impulse times its own value after the jump.

    One that follows what it reads may have an impulse itself, of what its bond has beside it then.

    Of one that the law of a junction brought in the value is that of `mode`, which carried it.
    """
    own, other = ("e", "f") if node.kind == "Se" else ("f", "e")
    bond = node.ends[0].bond
    area = areas.get(f"{other}:{bond}", 0.0)
    given = 0.0
    if area:
        after = values.of_law(node, mode) if node.implied else values.after(f"{own}:{bond}")
        given += area * after
    if not node.implied and (area := areas.get(f"{own}:{bond}", 0.0)):
        given += area * values.after(f"{other}:{bond}")
    return -node.ends[0].sign * given


def _area(areas: Mapping[str, float], bond: int) -> float:
    return areas.get(f"e:{bond}", 0.0) or areas.get(f"f:{bond}", 0.0)


def owner_of(graph: FlatGraph, node: Node) -> Node:
    """Return the junction whose law brought in a source, or the node itself."""
    if not node.implied:
        return node
    bond = graph.bonds[node.ends[0].bond]
    return graph.nodes[bond.head if bond.tail == node.index else bond.tail]


class _Values:
    """Bond variables before and after a jump, in the modes that it leads from and to."""

    def __init__(
        self,
        run: Result,
        event: Event,
        before: Vector,
        after: Vector,
        modes: tuple[Mode, Mode],
        *,
        first: bool,
    ) -> None:
        self._run = run
        self._event = event
        self._states = (before, after)
        self._modes = modes
        self._first = first
        self._known: dict[tuple[str, bool], float] = {}

    def after(self, name: str) -> float:
        return self._value(name, later=True)

    def of_law(self, node: Node, mode: Mode) -> float:
        """Return what a source of a junction's law gives after the jump, in a mode."""
        assert node.law is not None
        e = node.law.expressions[0]
        states = {n: n.split(":") for n in names(e) if n.startswith("in:")}
        here = {n: Number(float(mode[int(m)] == int(k))) for n, (_, m, k) in states.items()}
        signals = self._run.signals_of(self._run._segment_at(self._event.t, "right"))
        last = self._event.steps[-1].mode
        try:
            return signals.after(self._event.t, self._states[1], last, [substitute(e, here)])[0]
        except HybondError:
            return 0.0

    def mean(self, name: str) -> float:
        return 0.5 * (self._value(name, later=False) + self._value(name, later=True))

    def _value(self, name: str, *, later: bool) -> float:
        if (name, later) not in self._known:
            try:
                self._known[name, later] = self._read(name, later)
            except HybondError:
                # where a law has no value the split is in proportion to the others
                self._known[name, later] = 0.0
        return self._known[name, later]

    def _read(self, name: str, later: bool) -> float:
        run, event = self._run, self._event
        number = run._segment_at(event.t, "left")
        if not later and self._first and event.t > run.t_begin:
            asked = np.array([number])
            (found,) = run._of([Name(name)], asked, np.array([event.t]))
            return float(found[0])
        mode = self._modes[later]
        signals = run.signals_of(run._segment_at(event.t, "right"))
        return signals.after(event.t, self._states[later], mode, [Name(name)])[0]
