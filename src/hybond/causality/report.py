"""What `hybond.causality` returns: the causality of a model for people."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from hybond.causality.ahead import ConflictsAhead, conflicts_ahead, smallest
from hybond.causality.assign import assign
from hybond.causality.dynamics import Dynamics, Kind, causality_of, dynamics
from hybond.causality.explain import chain, describe_conflict, reason
from hybond.causality.record import Causality
from hybond.causality.reference import reference_mode
from hybond.model.builder import Model, graph_of
from hybond.model.graph import FlatGraph, Mode
from hybond.model.pins import pin_names
from hybond.names import in_columns
from hybond.records import dataclass

CONFLICTS_HERE = 20
"""Conflicts of one such mode that are looked at: of hundreds in one place most say the same."""
MANY_BONDS = 60
"""Bonds above which a report lists only those whose stroke depends on the mode."""

MODES_AHEAD = 3000
"""Reachable modes looked at for conflicts, and at most as many for each region."""

CONFLICTS_NEARBY = 50
"""Conflicts one switch away from the reference mode that are looked into."""


@dataclass(frozen=True, slots=True)
class BondCausality:
    """The causality of one bond in one mode."""

    name: str
    """The bond as written."""
    at: str
    """The node at the stroke: it receives the effort."""
    kind: Kind
    """The same in every mode, proved; dependent on the mode; or the same in all modes examined."""
    through: tuple[str, ...]
    """The controlled junctions and switched elements that turn a dynamic stroke."""
    why: str
    """What set the stroke."""

    @property
    def words(self) -> str:
        """The kind as a phrase: ``dynamic through contact``."""
        return f"{self.kind} through {', '.join(self.through)}" if self.through else self.kind


@dataclass(frozen=True)
class CausalityReport:
    """The causality of a graph in one mode, and how it depends on the mode.

    Shows itself as a table (``print``) and, in a notebook, as a drawing with dashed strokes on
    the bonds whose causality depends on the mode.
    """

    graph: FlatGraph
    mode: Mode
    """The mode shown."""
    causality: Causality
    """The strokes of that mode, with reasons, loops and conflicts."""
    dynamics: Dynamics
    """Which bonds depend on the mode; `dynamics.reference` is the reference mode."""

    @cached_property
    def bonds(self) -> tuple[BondCausality, ...]:
        """One record per bond, in the order of the graph."""
        return tuple(
            BondCausality(
                bond.name,
                self.graph.nodes[self.causality.stroke_at(bond.index)].path.removesuffix(".switch"),
                self.dynamics.kinds[bond.index],
                self._switches(self.dynamics.through.get(bond.index, ())),
                reason(self.graph, self.causality, bond.index),
            )
            for bond in self.graph.bonds
        )

    @cached_property
    def ahead(self) -> ConflictsAhead:
        """Reachable modes without causality; looked for when first asked for."""
        groups = machine_groups(self.graph, self.dynamics)
        return conflicts_ahead(self.graph, groups=groups, limit=MODES_AHEAD)

    @property
    def derivative(self) -> tuple[str, ...]:
        """The stored quantities in derivative causality."""
        return tuple(self.graph.storages[k].path for k in self.causality.derivative)

    @property
    def loops(self) -> tuple[str, ...]:
        """The bonds whose stroke was chosen freely: each cuts an algebraic loop."""
        return tuple(self.graph.bonds[b].name for b in self.causality.loops)

    @property
    def conflicts(self) -> tuple[str, ...]:
        """The conflicts of the mode shown, one paragraph each."""
        conflicts = self.causality.conflicts
        return tuple(describe_conflict(self.graph, self.mode, c) for c in conflicts)

    def why(self, bond: str) -> list[str]:
        """Return why a bond (named as written) has its stroke: one line per bond of the chain.

        Raises
        ------
        KeyError
            For a bond that is not there.
        """
        for known in self.graph.bonds:
            if known.name == bond:
                return chain(self.graph, self.causality, known.index)
        raise KeyError(bond)

    def lines(self, *, every: bool | None = None) -> list[str]:
        """Return the report as lines of text.

        Parameters
        ----------
        every : bool, optional
            Whether bonds that do not depend on the mode are listed; by default if there are not
            more than `MANY_BONDS`.
        """
        graph, reference = self.graph, self.dynamics.reference
        lines = [
            f"reference mode ({graph.mode_text(reference.mode)}), {reference.how}: "
            f"{reference.integral} of {reference.storages} stored "
            f"quantit{'y' if reference.storages == 1 else 'ies'} in integral causality"
        ]
        if self.mode != reference.mode:
            lines.append(f"shown: mode ({graph.mode_text(self.mode)})")
        lines.append(self.counts())
        listed = [b for b in self.bonds if b.kind == "dynamic"]
        if len(self.bonds) <= MANY_BONDS if every is None else every:
            listed = list(self.bonds)
        if listed:
            lines += ["", *_table(listed), ""]
        if graph.pins:
            pins = ", ".join(f"{bond!r} at {node}" for bond, node in pin_names(graph).items())
            lines.append(f"pinned: {pins}")
        if self.derivative:
            late = ", ".join(self.derivative)
            lines.append(f"derivative causality: {late} (dependent on other storages or sources)")
        if self.dynamics.storages:
            paths = ", ".join(graph.storages[k].path for k in self.dynamics.storages)
            lines.append(f"integral or derivative, by the mode: {paths}")
        if self.loops:
            names = ", ".join(map(repr, self.loops))
            lines.append(f"algebraic loop through {names} (solved at each evaluation)")
        lines += [f"conflict: {text}" for text in self.conflicts]
        lines += ahead_lines(self.ahead)
        return lines[:-1] if not lines[-1] else lines

    def counts(self) -> str:
        """Return how many bonds are of each kind, as a phrase."""
        kinds = self.dynamics.kinds
        text = f"{len(kinds)} bonds: {kinds.count('invariant')} invariant, "
        text += f"{kinds.count('dynamic')} dynamic"
        if kept := kinds.count("kept"):
            text += f", {kept} kept in all modes examined"
        regions = len(self.dynamics.regions)
        if regions:
            text += f"; {regions} region{'s' if regions > 1 else ''} of dynamic causality"
        return text

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data."""
        graph, reference = self.graph, self.dynamics.reference
        return {
            "model": graph.name,
            "mode": graph.mode_names(self.mode),
            "reference": {
                "mode": graph.mode_names(reference.mode),
                "how": reference.how,
                "integral": reference.integral,
                "storages": reference.storages,
            },
            "bonds": [
                {
                    "name": b.name,
                    "stroke": b.at,
                    "kind": b.kind,
                    "through": list(b.through),
                    "reason": b.why,
                }
                for b in self.bonds
            ],
            "pins": pin_names(graph),
            "derivative": list(self.derivative),
            "loops": list(self.loops),
            "conflicts": list(self.conflicts),
            "regions": [
                {
                    "bonds": [graph.bonds[b].name for b in region.bonds],
                    "switches": list(self._switches(region.switches)),
                    "whole": region.whole,
                }
                for region in self.dynamics.regions
            ],
            "ahead": {
                "modes": len(self.ahead.looked_at.modes),
                "complete": self.ahead.looked_at.complete,
                "without_causality": self.ahead.modes,
                "causes": [
                    {
                        "text": one.text,
                        "switches": {path: on for path, on in one.conflict.switches},
                        "mode": graph.mode_names(one.mode),
                        "modes": one.modes,
                    }
                    for one in self.ahead.found
                ],
            },
        }

    def _switches(self, nodes: tuple[int, ...]) -> tuple[str, ...]:
        return tuple(self.graph.nodes[k].path.removesuffix(".switch") for k in nodes)

    def __str__(self) -> str:
        return "\n".join(self.lines())

    __repr__ = __str__

    def _repr_svg_(self) -> str:
        from hybond.draw import draw

        drawing = draw(
            self.graph,
            mode=self.mode,
            causality=self.causality,
            dynamic_bonds=self.dynamics.dynamic,
        )
        return drawing.svg()


def causality(
    model: Model | FlatGraph, mode: Mapping[str, str] | Mode | None = None
) -> CausalityReport:
    """Return the causality of a model: strokes, reasons, and what depends on the mode.

    Parameters
    ----------
    model : Model or FlatGraph
    mode : mapping of machine to state, optional
        The mode to show; machines that are left out are in their start state. Without it the
        reference mode: the one that the model gives, else the best found.

    Raises
    ------
    ModelError
        HB-M144 for a machine or state that does not exist.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("chopper")
    >>> m.add(V=hb.Se(10), sw=hb.One(), j=hb.Zero(), r=hb.R(1), c=hb.C(1))
    >>> m.bond("V -> sw -> j -> c", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> report = hb.causality(m)
    >>> report.bonds[3].at, report.bonds[3].words
    ('r', 'dynamic through sw')
    >>> hb.causality(m, {"S": "open"}).bonds[3].at
    'sw'
    """
    graph = graph_of(model)
    reference = reference_mode(graph, mode=graph.reference, pins=graph.pins)
    found = dynamics(graph, reference)
    if mode is None:
        shown = reference.mode
    else:
        shown = graph.mode_of(mode)
    same = shown == reference.mode
    strokes = reference.causality if same else causality_of(graph, shown, reference=reference)
    return CausalityReport(graph, shown, strokes, found)


def machine_groups(graph: FlatGraph, found: Dynamics) -> list[tuple[int, ...]]:
    """Return the machines of each region of dynamic causality, and of each conflict nearby.

    A switch that conflicts with what is ON in the reference mode may belong to no region, since
    there are no strokes that it turns.
    """
    switches = [region.switches for region in found.regions]
    reference = found.reference.mode
    for m, state in found.without[:CONFLICTS_NEARBY]:
        mode = (*reference[:m], state, *reference[m + 1 :])
        for conflict in assign(graph, mode).conflicts[:CONFLICTS_HERE]:
            least = smallest(graph, mode, conflict)
            switches.append(tuple(graph.by_path[path] for path, _ in least.switches))
    groups: dict[tuple[int, ...], None] = {}
    for nodes in switches:
        machines = {graph.nodes[k].machine for k in nodes}
        groups[tuple(sorted(m for m in machines if m is not None))] = None
    return list(groups)


def ahead_lines(ahead: ConflictsAhead) -> list[str]:
    """Return the modes ahead without causality as lines; none if there are none."""
    if not ahead.found:
        return []
    looked = len(ahead.looked_at.modes)
    many = f"{looked} reachable modes" if ahead.looked_at.complete else f"the first {looked} modes"
    has = "has" if ahead.modes == 1 else "have"
    lines = [f"conflicts ahead: {ahead.modes} of {many} {has} no causality"]
    for one in ahead.found:
        lines.append(f"  in {one.modes} of them: {one.text}")
    return lines


def _table(bonds: list[BondCausality]) -> list[str]:
    rows = [("bond", "stroke at", "causality", "reason")]
    rows += [(b.name, b.at, b.words, b.why) for b in bonds]
    return in_columns(rows)
