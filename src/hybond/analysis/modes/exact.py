"""All states of every mode: edges, gaps and what is left open, by cells."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.modes.asked import Asked, modes_of, without_repeats
from hybond.analysis.modes.cell import Programs, Spent, conditions
from hybond.analysis.modes.entry import Entries, read_by
from hybond.analysis.modes.held import Held, guards_of, without_rules
from hybond.analysis.modes.paths import Instants, Path, Space
from hybond.analysis.modes.records import Gap, Known
from hybond.analysis.modes.steps import Met, name_of
from hybond.errors import DivergenceOfTime, HybondError
from hybond.model.expressions import Name
from hybond.model.graph import Mode

Vector = NDArray[np.float64]

GAPS = 40
"""Sets of states without a mode that are told."""


@dataclass
class Cells:
    """The exact exploration of a held model.

    Parameters
    ----------
    held : Held
    scale : array, shape (states,)
        A usual size of everything stored, integrated and held.
    met : Met
    limit : int
        Modes looked at.
    programs : int
        Linear programs solved.
    """

    held: Held
    scale: Vector
    met: Met
    limit: int
    programs: int
    open: dict[Mode, str] = field(default_factory=dict)
    """Modes with states of which nothing is told, with the reason."""
    left_out: list[str] = field(default_factory=list)
    untold: int = 0
    """Sets of states without a mode beyond those that are told."""

    def explore(self, first: Iterable[Mode]) -> None:
        """Look at the states of all modes that follow those given, breadth first."""
        held = self.held
        self._asked = Asked(held.graph)
        lifted = without_rules(held.graph)
        read = read_by([*guards_of(held.graph), *lifted.terms, *held.where])
        begin = len(held.names) - len(held.given)
        jumping = tuple(begin + k for k, e in enumerate(held.given) if e != Name("time"))
        space = Space(len(held.names), jumping)
        programs = Programs(np.append(self.scale, self.scale[list(jumping)]), self.programs)
        entries = Entries(lifted, read, np.append(self.scale, np.ones(len(lifted.terms))))
        instants = Instants(held.graph, entries, space, programs, held.where)
        queue = deque(dict.fromkeys(first))
        done = set(queue)
        looked = 0
        while queue:
            if looked >= self.limit or programs.spent:
                break
            mode = queue.popleft()
            looked += 1
            try:
                for path in instants.paths(mode):
                    self._take(path)
                    if path.end == "holds" and path.last not in done:
                        done.add(path.last)
                        queue.append(path.last)
            except Spent:
                self.open[mode] = "its states are cut into more cells than are looked at"
                break
        if self.untold:
            self.left_out.append(f"{self.untold} more sets of states from which no mode holds")
        if queue or programs.spent:
            graph = self.held.graph
            names = ", ".join(f"({name_of(graph, m)})" for m in list(queue)[:4])
            more = f" and {len(queue) - 4} more" if len(queue) > 4 else ""
            spent = f"{programs.cuts} cuts of states and " if programs.spent else ""
            self.left_out.append(
                f"after {spent}{looked} modes: what follows {names or 'them'}{more}"
            )

    def _take(self, path: Path) -> None:
        met = self.met
        visits = path.visits
        if path.end == "open":
            self.open.setdefault(path.begin, path.why)
        if path.end == "holds" and self._known(path):
            return
        if path.end in ("cycle", "barred") and len(met.gaps) >= GAPS:
            self.untold += 1
            return
        found = self._witness(path)
        known: Known = "possible" if found is not None else "not excluded"
        named = {} if found is None else self._named(found)
        for k, visit in enumerate(visits):
            if k:
                met.edge(
                    visits[k - 1].mode,
                    visit.mode,
                    visit.fired,
                    known,
                    begin=path.begin,
                    witness=named,
                )
            if k and not (path.end == "holds" and k + 1 == len(visits)):
                met.mode(visit.mode, "pinnacle" if visit.written else "mythical")
        if path.end == "holds":
            met.mode(path.last, "continuous")
        if path.end in ("cycle", "barred"):
            self._gap(path, found, named)

    def _known(self, path: Path) -> bool:
        """Whether a path tells nothing that others did not tell."""
        kinds, edges = self.met.kinds, self.met.edges
        for k, visit in enumerate(path.visits):
            last = k + 1 == len(path.visits)
            kind = "continuous" if last else "pinnacle" if visit.written else "mythical"
            if (k or last) and kind not in kinds.get(visit.mode, ()):
                return False
            if k:
                edge = edges.get((path.visits[k - 1].mode, visit.mode, visit.fired))
                if edge is None or edge.known == "not excluded":
                    return False
        return True

    def _witness(self, path: Path) -> Vector | None:
        """Return a state at which the engine does as the path says, None if it does not."""
        if path.stand is None:
            return None
        small = path.stand.programs.near(path.stand.rows) if not path.stand.programs.spent else None
        many = len(self.held.names)
        for point in (small, path.stand.point, path.cell.point):
            if point is not None and self._does(path, point[:many]):
                return np.asarray(point[:many])
        return None

    def _does(self, path: Path, y: Vector) -> bool:
        got = self._asked.settled(y, path.begin)
        modes = without_repeats([v.mode for v in path.visits])
        if isinstance(got, HybondError):
            if path.end == "cycle":
                return isinstance(got, DivergenceOfTime)
            return path.end in ("barred", "open") and not isinstance(got, DivergenceOfTime)
        there = modes_of(got, path.begin)
        return there == modes if path.end == "holds" else False

    def _named(self, y: Vector) -> dict[str, float]:
        return {n: float(v) + 0.0 for n, v in zip(self.held.names, y, strict=True)}

    def _gap(self, path: Path, y: Vector | None, named: dict[str, float]) -> None:
        graph = self.held.graph
        cycle = path.end == "cycle"
        modes = [v.mode for v in path.visits]
        why = f"({name_of(graph, modes[path.back])}) again, and so on" if cycle else path.why
        names = [*self.held.names]
        names += [f"pre({names[k]})" for k in self._jumping]
        self.met.gaps.append(
            Gap(
                begin=name_of(graph, path.begin),
                states=conditions(path.cell, names) or ("any state",),
                modes=tuple(name_of(graph, m) for m in modes),
                why=why,
                cycle=cycle,
                witness=named,
                confirmed=y is not None
                and self._asked.stops(y, path.begin, "HB-N401" if cycle else ""),
            )
        )

    @property
    def _jumping(self) -> tuple[int, ...]:
        begin = len(self.held.names) - len(self.held.given)
        return tuple(begin + k for k, e in enumerate(self.held.given) if e != Name("time"))
