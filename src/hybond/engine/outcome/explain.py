"""What happened at an instant, in words: transitions with what their guards read, impulses."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.engine.tables import ModelTables
from hybond.engine.tables.contacts import rules_of
from hybond.equations.surfaces import surfaces_of
from hybond.model.expressions import names
from hybond.model.graph import FlatGraph, Machine, Mode, Rule
from hybond.model.kinds import TWO_PORTS
from hybond.records import dataclass
from hybond.runs.trace import Energy, Fired, Visit, VisitKind

if TYPE_CHECKING:
    from hybond.engine.outcome.records import Instants


Vector = NDArray[np.float64]
KINDS: tuple[VisitKind, ...] = ("mythical", "pinnacle", "continuous")
LANDS, SLIDES_ON, SLIDES_OFF, PARTS = -2, -3, -4, -10
OVER_A_STEP = -7
WHY = {
    -1: "complementarity",
    LANDS: "impacts accumulate",
    -5: "the other surfaces push it back",
    -6: "its jump throws it back",
    OVER_A_STEP: "complementarity over the step",
    -8: "holds where the step ends",
    -9: "goes along with what slides, or slid",
}
"""Why a transition fired if no rule did: as in `hybond.engine.instant.told`."""
SURFACES = {
    SLIDES_ON: "pushed into from both sides",
    SLIDES_OFF: "no longer pushed into from both sides",
    PARTS: "it has jumped away",
}
OPEN_BEFORE, OPEN_SINCE = 2, 3
"""When what a guard reads was open: as in `indeterminate` and `open_integrals` of the engine."""
SLIDING = -1
"""The state of a machine that slides."""


@dataclass(frozen=True, slots=True)
class NamedRows:
    """Signals that are signed sums of bond variables."""

    names: tuple[str, ...]
    """``x.e``, ``x.f`` of one-ports, the common variable of junctions, and the net variable of
    controlled ones."""
    name: NDArray[np.intp]
    variable: NDArray[np.intp]
    """Shape (terms,). `name` and `variable`: to which name each term belongs, and the bond variable
    that it takes."""
    sign: Vector
    """Shape (terms,)."""

    def of(self, w: Vector, floor: Vector) -> dict[str, float]:
        """Return the signals of `w` that stand out of `floor`, shape (2 * bonds,), by name."""
        n = len(self.names)
        values = np.bincount(self.name, self.sign * w[self.variable], n)
        limits = np.bincount(self.name, np.abs(self.sign) * floor[self.variable], n)
        return {
            name: float(a)
            for name, a, b in zip(self.names, values, limits, strict=True)
            if abs(a) > b
        }


def named_rows(graph: FlatGraph) -> NamedRows:
    """Return the named signals of a graph."""
    bonds = len(graph.bonds)
    names: list[str] = []
    entries: list[tuple[int, int, float]] = []

    def add(name: str, terms: list[tuple[int, float]]) -> None:
        entries.extend((len(names), k, sign) for k, sign in terms)
        names.append(name)

    implied = {n.ends[0].bond for n in graph.nodes if n.implied}
    for node in graph.nodes:
        if node.hidden or node.implied or not node.ends:
            continue
        if node.is_junction:
            common, other = ("e", "f") if node.kind == "0" else ("f", "e")
            first = 0 if common == "e" else bonds
            add(f"{node.path}.{common}", [(first + node.ends[0].bond, 1.0)])
            if node.controlled:
                net = [
                    (bonds - first + end.bond, float(end.sign))
                    for end in node.ends
                    if end.bond not in implied
                ]
                add(f"{node.path}.{other}", net)
            continue
        for end in node.ends:
            port = f".{end.port + 1}" if len(node.ends) > 1 else ""
            add(f"{node.path}{port}.e", [(end.bond, 1.0)])
            add(f"{node.path}{port}.f", [(bonds + end.bond, 1.0)])
    name, variable, sign = np.array(entries).reshape(-1, 3).T
    return NamedRows(tuple(names), name.astype(np.intp), variable.astype(np.intp), sign)


class Explaining:
    """The words of one model."""

    def __init__(self, tables: ModelTables) -> None:
        graph = self.graph = tables.graph
        ruled = [
            (machine, f.rule)
            for machine, own in zip(graph.machines, rules_of(graph), strict=True)
            for f in own
        ]
        self._rules = [rule for _, rule in ruled]
        self._ruled = [machine for machine, _ in ruled]
        self._laws = [law for m in graph.machines if m.law is not None for law in m.law.junctions]
        self.surfaces = surfaces_of(graph)
        self._bonds = tables.bonds

    # what only impulses ask for is made when there is one: it has a row for each bond
    @cached_property
    def _named(self) -> NamedRows:
        return named_rows(self.graph)

    @cached_property
    def _terms(self) -> list[int]:
        """How many bond variables each name is a sum of."""
        rows = self._named
        found: list[int] = np.bincount(rows.name, minlength=len(rows.names)).tolist()
        return found

    @cached_property
    def _of_bond(self) -> dict[int, list[tuple[int, float]]]:
        """The names that each bond variable is in, and its sign there."""
        rows = self._named
        found: dict[int, list[tuple[int, float]]] = {}
        for name, variable, sign in zip(
            rows.name.tolist(), rows.variable.tolist(), rows.sign.tolist(), strict=True
        ):
            found.setdefault(variable, []).append((name, sign))
        return found

    def steps(self, found: Instants, k: int) -> tuple[Visit, ...]:
        """Return the modes visited at instant k."""
        mode = found.before(k)
        first, beyond = int(found.visit[k]), int(found.visit[k + 1])
        steps = []
        for v in range(first, beyond):
            mode = self.entered(found, v, mode)
            if v + 1 == beyond:
                # a machine that slides, or is pushed back, is shown where the run says
                mode = tuple(found.states[k].tolist())
            steps.append(self._step(found, v, mode))
        return tuple(steps)

    def entered(self, found: Instants, v: int, mode: Mode) -> Mode:
        """Return the mode that the transitions of a visit lead to from another."""
        states = list(mode)
        fired = found.rows.fired[found.fired[v] : found.fired[v + 1], :3].tolist()
        for machine, _, target in fired:
            if target != SLIDING:
                states[machine] = target
        return tuple(states)

    def _step(self, found: Instants, v: int, mode: Mode) -> Visit:
        rows = found.rows
        hits = slice(int(found.hit[v]), int(found.hit[v + 1]))
        impulses: dict[str, float] = {}
        exchanged: dict[str, float] = {}
        struck_bonds: dict[str, float] = {}
        if hits.stop > hits.start:
            areas = rows.hit_area[hits].tolist()
            struck = list(zip(rows.hit[hits].tolist(), areas, strict=True))
            impulses = self._impulses(struck)
            exchanged = self._exchanged(struck, mode)
            bonds = len(self.graph.bonds)
            struck_bonds = {
                f"{'e' if k < bonds else 'f'}:{k % bonds}": area
                for k, (area, floor) in struck
                if abs(area) > floor
            }
        energy = None
        if rows.visit[v, 4]:
            before, after, given = rows.visit_energy[v].tolist()
            energy = Energy(before, after, given, before + given - after)
        return Visit(
            mode,
            KINDS[int(rows.visit[v, 0])],
            self.fired(found, v),
            impulses,
            energy,
            self.open(found, v),
            exchanged,
            struck_bonds,
        )

    def fired(self, found: Instants, v: int) -> tuple[Fired, ...]:
        """Return the transitions into a mode visited."""
        return tuple(self._fired(found, f) for f in range(found.fired[v], found.fired[v + 1]))

    def open(self, found: Instants, v: int) -> tuple[str, ...]:
        """Return the bond variables that the equations of a mode visited leave open."""
        numbers = found.rows.open[found.open[v] : found.open[v + 1]].tolist()
        return tuple(dict.fromkeys(self._bonds[k] for k in numbers))

    def nodes_open(self, found: Instants, v: int) -> set[int]:
        """Return the nodes with a bond variable that the equations of a mode visited leave open."""
        bonds = self.graph.bonds
        numbers = found.rows.open[found.open[v] : found.open[v + 1]].tolist()
        at = [bonds[k % len(bonds)] for k in numbers]
        return {n for b in at for n in (b.tail, b.head)}

    def stored_open(self, found: Instants, v: int) -> tuple[str, ...]:
        """Return the stored quantities whose rates the equations of a mode visited leave open."""
        numbers = set(found.rows.open[found.open[v] : found.open[v + 1]].tolist())
        bonds = len(self.graph.bonds)
        return tuple(
            s.path
            for s in self.graph.storages
            if (s.bond if s.kind == "I" else bonds + s.bond) in numbers
        )

    def rule(self, number: int) -> Rule:
        """Return a rule by its number in the library."""
        return self._rules[number]

    def machine_of(self, rule: int) -> Machine:
        """Return the machine of a rule."""
        return self._ruled[rule]

    def bond_variable(self, k: int) -> str:
        """Return the name of bond variable k: that of a port, or of a junction that it is at."""
        bonds = len(self.graph.bonds)
        bond = self.graph.bonds[k % bonds]
        nodes = [self.graph.nodes[end] for end in (bond.tail, bond.head)]
        variable = "e" if k < bonds else "f"
        ports = [n for n in nodes if not n.is_junction and not n.hidden and len(n.ends) == 1]
        return f"{ports[0].path}.{variable}" if ports else f'"{bond.name}".{variable}'

    def guard_on_open(self, rule: int, when: int, free: Sequence[int], mode: Mode) -> str:
        """Say that a guard reads what the equations of a mode leave open: variables `free`.

        `when` is `OPEN_BEFORE` if that was so before the instant.
        """
        if when == OPEN_SINCE:
            return self._on_open_integrals(rule, {f"s:{k}" for k in free}, mode)
        guard = self._rules[rule]
        bonds = len(self.graph.bonds)
        moved = {f"{'e' if k < bonds else 'f'}:{k % bonds}" for k in free}
        before = when == OPEN_BEFORE
        reads = [(name, e) for name, e in guard.reads if name.startswith("pre(") == before]
        read = ", ".join(name for name, e in reads if names(e) & moved)
        where = "before this instant" if before else f"in mode ({self.graph.mode_text(mode)})"
        return f"the guard {guard.said!r} reads {read}, which the equations leave open {where}"

    def _on_open_integrals(self, reader: int, free: set[str], mode: Mode) -> str:
        """Say that a guard, or the gap of port ``-1 - reader``, reads integrals of what is open."""
        if reader >= 0:
            guard = self._rules[reader]
            what = f"the guard {guard.said!r}"
            read = [name for name, e in guard.reads if names(e) & free]
        else:
            law = self._laws[-1 - reader]
            what = f"the gap of {self.graph.nodes[law.node].path}"
            named = {f"s:{i.index}": i.path for i in self.graph.integrals}
            found = names(law.gap) if law.gap is not None else frozenset()
            read = [named[name] for name in sorted(found & free)]
        where = f"in mode ({self.graph.mode_text(mode)})"
        open_ = "an integral" if len(read) == 1 else "integrals"
        return f"{what} reads {', '.join(read)}, {open_} of what the equations leave open {where}"

    def _fired(self, found: Instants, f: int) -> Fired:
        rows = found.rows
        number, source, target, why = rows.fired[f, :4].tolist()
        machine = self.graph.machines[number]
        reads = rows.read[found.read[f] : found.read[f + 1]].tolist()
        values: dict[str, float] = {}
        impulses: dict[str, float] = {}
        over: tuple[str, ...] = ()
        if why >= 0:
            rule = self._rules[why]
            guard = rule.said
            for (name, _), (finite, impulse, strikes) in zip(rule.reads, reads, strict=True):
                values[name] = finite
                if strikes:
                    impulses[name] = impulse
            over = tuple(
                self._rules[r].said for r in rows.over[found.over[f] : found.over[f + 1]].tolist()
            )
        elif why in SURFACES:
            guard = f"{self.surfaces[int(reads[0][0])].text}: {SURFACES[why]}"
        else:
            guard = WHY[why]
            if why == LANDS:
                values = {"impacts": reads[0][0], "t": reads[1][0]}
            elif why == OVER_A_STEP and machine.law is not None:
                for k, law in enumerate(machine.law.junctions):
                    node = self.graph.nodes[law.node]
                    common, net = ("e", "f") if node.kind == "0" else ("f", "e")
                    values[f"{node.path}.{common}"] = reads[2 * k][0]
                    values[f"{node.path}.{net}"] = reads[2 * k + 1][0]
        return Fired(
            machine.path,
            "sliding" if source == SLIDING else machine.states[source],
            "sliding" if target == SLIDING else machine.states[target],
            guard,
            values,
            impulses,
            over,
        )

    # -- impulses

    def _impulses(self, struck: list[tuple[int, list[float]]]) -> dict[str, float]:
        """Return the signals that carry an impulse, by name, in the order of the graph."""
        totals: dict[int, float] = {}
        limits: dict[int, float] = {}
        for variable, (area, floor) in struck:
            for name, sign in self._of_bond.get(variable, ()):
                totals[name] = totals.get(name, 0.0) + sign * area
                # all terms of a sum are of one kind, and so is what counts as none
                limits[name] = self._terms[name] * floor
        called = self._named.names
        return {called[n]: a for n, a in sorted(totals.items()) if abs(a) > limits[n]}

    @cached_property
    def _passing(self) -> dict[int, list[tuple[int, int | None, str]]]:
        """Of bond variables what passes there: place, the node that must be OFF, name."""
        bonds = len(self.graph.bonds)
        found: dict[int, list[tuple[int, int | None, str]]] = {}
        place = 0
        for node in self.graph.nodes:
            if node.kind in ("Se", "0"):
                passing = ["f"] * len(node.ends)
            elif node.kind in ("Sf", "1"):
                passing = ["e"] * len(node.ends)
            elif node.kind in TWO_PORTS:
                # a zero modulus shorts side 1 and opens (TF) or shorts (GY) side 2
                passing = ["f", "e" if node.kind == "TF" else "f"]
            else:
                continue
            source = node.kind in ("Se", "Sf")
            if not source and not node.controlled:
                continue
            for end, variable in zip(node.ends, passing, strict=True):
                at = end.bond + (bonds if variable == "f" else 0)
                name = f'"{self.graph.bonds[end.bond].name}".{variable}'
                found.setdefault(at, []).append((place, None if source else node.index, name))
                place += 1
        return found

    def _exchanged(self, struck: list[tuple[int, list[float]]], mode: Mode) -> dict[str, float]:
        """Return what passed through source bonds and bonds of what is OFF."""
        found = []
        off: frozenset[int] | None = None
        for variable, (area, _) in struck:
            for place, node, name in self._passing.get(variable, ()):
                if node is not None:
                    off = self.graph.off_nodes(mode) if off is None else off
                    if node not in off:
                        continue
                found.append((place, name, area))
        return {name: area for _, name, area in sorted(found)}
