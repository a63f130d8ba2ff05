"""What was met, put together: modes with their kinds, edges with how they are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from hybond.analysis.modes.records import Edge, Fires, Gap, Known, ModeNode, Transition
from hybond.model.graph import MANY, FlatGraph, Mode

Fired = tuple[tuple[int, int], ...]
"""Machines, and numbers of their rules."""
ORDER: tuple[Known, ...] = ("not excluded", "possible", "seen")
KINDS = ("start", "continuous", "pinnacle", "mythical")


def name_of(graph: FlatGraph, mode: Mode) -> str:
    """Return a mode for people: of many machines, all that are not in their start state.

    Examples
    --------
    >>> import hybond as hb
    >>> graph = hb.load("examples/diode_inductor.toml").flatten()
    >>> name_of(graph, (1, 0))
    'open, blocks'
    """
    if len(graph.machines) <= MANY:
        return graph.mode_text(mode)
    away = [
        f"{m.path} = {m.states[k]}"
        for m, k in zip(graph.machines, mode, strict=True)
        if k != m.start
    ]
    return ", ".join(away) or "all at start"


@dataclass
class Met:
    """Modes, edges and gaps in the order in which they were met."""

    graph: FlatGraph
    kinds: dict[Mode, set[str]] = field(default_factory=dict)
    edges: dict[tuple[Mode, Mode, Fired], Edge] = field(default_factory=dict)
    gaps: list[Gap] = field(default_factory=list)

    def mode(self, mode: Mode, *kinds: str) -> None:
        """Note a mode and what it was."""
        self.kinds.setdefault(mode, set()).update(kinds)

    def edge(
        self,
        source: Mode,
        target: Mode,
        fired: Fired,
        known: Known,
        *,
        begin: Mode | None = None,
        witness: Mapping[str, float] | None = None,
    ) -> None:
        """Note that rules lead from one mode to another; what is known best counts."""
        key = (source, target, fired)
        old = self.edges.get(key)
        if old is not None and ORDER.index(old.known) >= ORDER.index(known):
            return
        self.edges[key] = Edge(
            name_of(self.graph, source),
            name_of(self.graph, target),
            tuple(self._fires(m, k) for m, k in fired),
            known,
            "" if begin is None else name_of(self.graph, begin),
            dict(witness or {}),
        )

    def _fires(self, machine: int, rule: int) -> Fires:
        m = self.graph.machines[machine]
        r = m.rules[rule]
        return Fires(m.path, m.states[r.source], m.states[r.target], r.text)

    def not_excluded(self, most: int) -> None:
        """Note the rules that were not met, in the modes that were: nothing says they cannot fire.

        Parameters
        ----------
        most : int
            Edges up to which this is done.
        """
        met = {at for _, _, fired in self.edges for at in fired}
        for mode in list(self.kinds):
            for m in self.graph.machines:
                for k, rule in enumerate(m.rules):
                    if m.law is not None or rule.source != mode[m.index] or (m.index, k) in met:
                        continue
                    if len(self.edges) >= most:
                        return
                    target = list(mode)
                    target[m.index] = rule.target
                    self.mode(tuple(target))
                    self.edge(mode, tuple(target), ((m.index, k),), "not excluded")

    def nodes(self) -> tuple[ModeNode, ...]:
        """Return the modes with their kinds."""
        return tuple(
            ModeNode(name_of(self.graph, mode), tuple(k for k in KINDS if k in kinds))
            for mode, kinds in self.kinds.items()
        )

    def transitions(self, *, whole: bool) -> tuple[Transition, ...]:
        """Return all rules; `whole` says that one that was not met can never fire."""
        best: dict[tuple[int, int], Known] = {}
        for (_, _, fired), edge in self.edges.items():
            for at in fired:
                old = best.get(at)
                if old is None or ORDER.index(old) < ORDER.index(edge.known):
                    best[at] = edge.known
        found = []
        for m in self.graph.machines:
            if m.law is not None:
                continue
            for k, r in enumerate(m.rules):
                known = best.get((m.index, k))
                found.append(
                    Transition(
                        m.path,
                        m.states[r.source],
                        m.states[r.target],
                        r.text,
                        known or ("never" if whole else "not excluded"),
                    )
                )
        return tuple(found)

    def unreachable(self) -> tuple[str, ...]:
        """Return the states of machines that are in no mode that was met."""
        return tuple(
            f"{m.path}.{state}"
            for m in self.graph.machines
            if m.law is None
            for k, state in enumerate(m.states)
            if not any(mode[m.index] == k for mode in self.kinds)
        )
