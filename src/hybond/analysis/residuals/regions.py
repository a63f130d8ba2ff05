"""Residuals of all modes: switch variables eliminated where they meet, by Boolean tables.

A switch variable that the closing rows of its own switch give becomes a table of one switch in
each residual that it enters. Where closing rows alone do not give it (an ideal switch between two
sensors), the switch variables, unknowns and constraints that meet form a region, eliminated in
each combination of its machines' states; which row is left over may then differ from combination
to combination, and the residual is one row in each.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from hybond.analysis.residuals.region_solver import Item, RegionSolver
from hybond.analysis.residuals.sensor_rows import SensorRows
from hybond.analysis.residuals.unit_pivots import (
    UnitPivots,
)
from hybond.equations.mixed import MixedRow, Part
from hybond.equations.patterns import MOST_PATTERNS, Space, space_of
from hybond.equations.ring import Row, Symbols, substituted
from hybond.equations.symbolic.rational import Rational
from hybond.errors import EquationError
from hybond.model.graph import Mode
from hybond.model.joined import Joined


@dataclass(slots=True)
class Region:
    """Variables that are eliminated together."""

    space: Space
    switches: list[int]
    free: list[int]
    constraints: list[int] = field(default_factory=list)
    """`switches`, `free` and `constraints`: the last by position in `UnitPivots.constraints`."""
    values: list[dict[int, Row[Rational]]] = field(default_factory=list)
    """Per combination: what each variable is."""
    open: list[set[int]] = field(default_factory=list)
    """Per combination: variables that no sensor determines."""
    special: bool = False
    """Whether a coefficient that is zero only at the model's own values was dropped."""
    left: list[dict[Item, Row[Rational]]] = field(default_factory=list)
    """Per combination: rows among knowns, by the row that they come from."""
    why_left_out: str = ""
    """Empty if it was eliminated."""

    @property
    def variables(self) -> set[int]:
        """Switch variables and free unknowns."""
        return {*self.switches, *self.free}


@dataclass(slots=True)
class Found:
    """Residuals before they are named."""

    rows: list[tuple[Item, MixedRow[Rational]]]
    """Columns are knowns."""
    regions: list[Region]
    large: list[Region]
    """Regions that were not eliminated; their constraints are left out."""


def global_rows(given: SensorRows, pivots: UnitPivots, *, mode: Mode | None = None) -> Found:
    """Eliminate switch variables and free unknowns from the constraints that are left.

    Parameters
    ----------
    mode : tuple of int, optional
        Only this mode: nothing is tabulated then, however many switches meet.
    """
    return _Elimination(given, pivots, mode).found


class _Elimination:
    def __init__(self, given: SensorRows, pivots: UnitPivots, mode: Mode | None) -> None:
        self.given = given
        self.mode = mode
        self.ring = given.ring
        self.constraints = [row for _, row in pivots.constraints]
        self.kinds = [given.kinds[r] for r, _ in pivots.constraints]
        self.variables = set(given.switches) | set(pivots.free)
        self.closing = {
            at: None if row is None else pivots.reduce(row)
            for at, row in given.closing.items()
            if mode is None or at == (at[0], self._key(at[0], mode))
        }
        self.large: list[Region] = []
        groups = self._groups(())
        explicit: list[Region] = []
        rest: list[Region] = []
        for group in groups:
            (explicit if self._explicit(group) else rest).append(group)
        self.explicit = explicit
        # What closing rows do not give is eliminated with the constraints around it. A variable
        # that they do give stands in such a region once more if its constraints are there.
        held = {v for g in rest for v in g.variables}
        near = [row.keys() & self.variables for row in self.constraints if row.keys() & held]
        joined = self._groups(near) if rest else []
        regions = [g for g in joined if g.variables & held]
        for region in regions:
            region.constraints = [
                k for k, row in enumerate(self.constraints) if row.keys() & held & region.variables
            ]
            if region.space.count > MOST_PATTERNS:
                region.why_left_out = "too many switches meet without a sensor between"
            else:
                self._tabulate(region)
            if region.why_left_out:
                self.large.append(region)
        self.regions = [g for g in regions if g not in self.large]
        self.found = Found(self._rows(), [*self.explicit, *self.regions], self.large)

    def _key(self, switch: int, mode: Mode) -> tuple[object, ...]:
        states = tuple(mode[m] for m in self.given.switches[switch])
        return self.given.key(switch, states)

    # -- groups

    def _groups(self, together: Iterable[Iterable[int]]) -> list[Region]:
        """Group variables that share a closing row, or that `together` lists."""
        joined = Joined(sorted(self.variables))
        for (switch, _), row in self.closing.items():
            joined.join([switch, *((row or {}).keys() & self.variables)])
        for members in together:
            joined.join(members)
        found = []
        for members in joined.groups():
            switches = [v for v in members if v in self.given.switches]
            free = [v for v in members if v not in self.given.switches]
            found.append(Region(self._space(switches), switches, free))
        return found

    def _space(self, switches: list[int]) -> Space:
        given = self.given
        if self.mode is not None:
            return Space((), (), ())
        machines = sorted({m for s in switches for m in given.switches[s]})

        def key(machine: int, state: int) -> object:
            return tuple(
                given.key(s, (state,)) if given.switches[s] == (machine,) else state
                for s in switches
                if machine in given.switches[s]
            )

        return space_of(given.graph, machines, key)

    def _closing_rows(
        self, region: Region, states: tuple[int, ...]
    ) -> list[tuple[Item, Row[Rational] | None]]:
        at = dict(zip(region.space.machines, states, strict=True))
        rows = []
        for s in region.switches:
            own = tuple((self.mode or at)[m] for m in self.given.switches[s])
            rows.append((("closing", s), self.closing[s, self.given.key(s, own)]))
        return rows

    # -- explicit groups

    def _explicit(self, group: Region) -> bool:
        """Whether closing rows give all variables of a group in every combination."""
        if group.free or group.space.count > MOST_PATTERNS:
            return False
        tables = []
        for states in group.space.states():
            rows = self._closing_rows(group, states)
            if any(row is None for _, row in rows):
                return False
            solver = RegionSolver(
                self.given,
                self.kinds,
                group.variables,
                [(tag, row) for tag, row in rows if row is not None],
            )
            if solver.open or solver.left:
                return False
            tables.append(solver.solved)
        group.values = tables
        group.open = [set() for _ in tables]
        group.left = [{} for _ in tables]
        return True

    # -- regions

    def _tabulate(self, region: Region) -> None:
        for states in region.space.states():
            rows = [(t, row) for t, row in self._closing_rows(region, states) if row is not None]
            rows += [(("constraint", k), self.constraints[k]) for k in region.constraints]
            try:
                solver = RegionSolver(self.given, self.kinds, region.variables, rows)
            except EquationError:
                region.why_left_out = "the sensors are too far away for a formula to be read"
                region.values, region.open, region.left = [], [], []
                return
            region.values.append(solver.solved)
            region.open.append(solver.open)
            region.special |= solver.special
            region.left.append(_placed(solver))

    # -- rows

    def _rows(self) -> list[tuple[Item, MixedRow[Rational]]]:
        ring = self.ring
        at = {v: g for g in self.explicit for v in g.variables}
        tabulated = {k for g in [*self.regions, *self.large] for k in g.constraints}
        found: list[tuple[Item, MixedRow[Rational]]] = []
        for k, row in enumerate(self.constraints):
            if k in tabulated:
                continue
            base = {c: v for c, v in row.items() if c not in at}
            parts = []
            for group in {id(at[c]): at[c] for c in row if c in at}.values():
                inside = {c: v for c, v in row.items() if at.get(c) is group}
                rows = tuple(substituted(ring, inside, values) for values in group.values)
                if len(rows) == 1:
                    base = ring.collect([(ring.one, base), (ring.one, rows[0])])
                elif any(rows):
                    parts.append(Part(group.space, rows))
            found.append((("constraint", k), _rebased(ring, base, parts)))
        for region in self.regions:
            tags = dict.fromkeys(tag for left in region.left for tag in left)
            for tag in sorted(tags):
                rows = tuple(left.get(tag, {}) for left in region.left)
                found.append((tag, _compared(ring, region.space, rows)))
        return found


def _compared(ring: Symbols, space: Space, rows: tuple[Row[Rational], ...]) -> MixedRow[Rational]:
    """Return rows per combination; what the shortest says stands in front if all others say it."""
    base = min(rows, key=lambda row: (len(row), sum(map(ring.cost, row.values()))))
    minus = ring.of(-1.0)
    differ = tuple(ring.collect([(ring.one, row), (minus, base)]) for row in rows)
    if not any(differ):
        return MixedRow(base)
    if all(len(d) < len(row) for d, row in zip(differ, rows, strict=True) if d):
        return MixedRow(base, (Part(space, differ),))
    return MixedRow({}, (Part(space, rows),))


def _rebased(ring: Symbols, base: Row[Rational], parts: list[Part[Rational]]) -> MixedRow[Rational]:
    """Let each part be nothing in that combination which leaves least to write."""

    def length(*rows: Row[Rational]) -> int:
        return sum(1 + ring.cost(c) for row in rows for c in row.values())

    minus = ring.of(-1.0)
    moved: list[Part[Rational]] = []
    for part in parts:
        best: tuple[int, Row[Rational], tuple[Row[Rational], ...]] | None = None
        for own in ({}, *part.rows):
            front = ring.collect([(ring.one, base), (ring.one, own)])
            rows = tuple(ring.collect([(ring.one, row), (minus, own)]) for row in part.rows)
            measure = length(front, *rows)
            if best is None or measure < best[0]:
                best = (measure, front, rows)
        assert best is not None
        base = best[1]
        moved.append(Part(part.space, best[2]))
    return MixedRow(base, tuple(moved))


def _placed(solver: RegionSolver) -> dict[Item, Row[Rational]]:
    """Give closing rows that are left the places of constraints that were used instead."""
    found = {tag: row for tag, row in solver.left.items() if tag[0] == "constraint"}
    loose = {tag: row for tag, row in solver.left.items() if tag[0] == "closing"}
    places = {tag: v for tag, v in solver.used.items() if tag[0] == "constraint"}
    for tag in sorted(loose):
        own = [p for p, v in places.items() if v == tag[1]]
        place = min(own or places, default=tag)
        places.pop(place, None)
        found[place] = loose[tag]
    return found
