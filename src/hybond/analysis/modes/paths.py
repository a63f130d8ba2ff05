"""How an instant is settled from all states of a mode at once: paths of modes, each with its cell.

The procedure of the engine (MB, algorithms 2 and 3), with cells of states in place of a state:
modes are tried from the same stored state, the first rule of each machine that holds fires, and
where none does the state is written. A path ends where a mode holds, where none can be entered, or
where it comes back to itself: then time does not go on from any state of its cell. Since the cells
of paths do not overlap, time always goes on if no path comes back: MB's criterion, that the sets
which the modes of a cycle leave have no state in common.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.modes.cases import NotAffine, Pair, Read, Values, truths, values
from hybond.analysis.modes.cell import FLAT, Cell, Programs, Row
from hybond.analysis.modes.entry import Barred, Entries, Entry
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Mode, Rule

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
End = Literal["holds", "cycle", "barred", "open"]

WRITES = 8
"""Writes at one instant after which a path is left open."""
DEEP = 60
"""Modes tried at one instant after which a path is left open."""


@dataclass(frozen=True)
class Visit:
    """A mode of a path: how it was entered, and what became of it."""

    mode: Mode
    fired: tuple[tuple[int, int], ...]
    """Rules that led to it: machine and number of its rule."""
    written: bool = False
    """Whether its jump was written: a pinnacle, or the mode that holds."""


@dataclass(frozen=True)
class Path:
    """What happens from all states of a cell."""

    begin: Mode
    """The mode in which time was before."""
    visits: tuple[Visit, ...]
    """The first one is `begin`, entered with what the surroundings are now."""
    cell: Cell
    end: End
    why: str = ""
    back: int = -1
    """Of a cycle: the visit that the last one repeats."""
    stand: Cell | None = None
    """The part of the cell in which nothing outside jumps; None if there is none."""

    @property
    def last(self) -> Mode:
        """The mode at its end."""
        return self.visits[-1].mode


@dataclass(frozen=True)
class Space:
    """The variables of cells: the states of the held model, then what was held just before.

    Parameters
    ----------
    states : int
        Stored, integrated and held.
    jumping : tuple of int
        Which of them may have jumped: inputs and what time makes, but not time.
    """

    states: int
    jumping: tuple[int, ...]

    @property
    def many(self) -> int:
        """All variables."""
        return self.states + len(self.jumping)

    def now(self) -> Matrix:
        """Return the states of the instant as rows over variables and one."""
        return np.eye(self.states, self.many + 1)

    def before(self) -> Matrix:
        """Return the states just before it."""
        rows = self.now()
        for k, state in enumerate(self.jumping):
            rows[state] = 0.0
            rows[state, self.states + k] = 1.0
        return rows


@dataclass(frozen=True)
class _Point:
    """Where a path stands: what is stored, what ``pre()`` reads, the mode that is tried."""

    cell: Cell
    stored: Matrix
    before: dict[str, Vector]
    old: Mode
    """The mode whose values ``pre()`` reads."""
    visits: tuple[Visit, ...]
    since: int = 0
    """The first visit since the last write: from there on the stored state is the same."""
    fired: bool = False
    stays: bool = False
    """Whether the mode's jump was just written, so that it is not entered again."""
    writes: tuple[tuple[int, Mode, Matrix], ...] = ()

    @property
    def mode(self) -> Mode:
        return self.visits[-1].mode


@dataclass
class Instants:
    """Instants of a held model, from all states of a mode at once.

    Parameters
    ----------
    graph : FlatGraph
        Held.
    entries : Entries
        Of the same without rules.
    space : Space
    programs : Programs
    where : tuple of Expr
        Conditions that states are known to meet.
    """

    graph: FlatGraph
    entries: Entries
    space: Space
    programs: Programs
    where: tuple[Expr, ...] = ()

    def paths(self, mode: Mode) -> Iterator[Path]:
        """Yield the paths from a mode in which time was, over all of its states."""
        start = (Visit(mode, (), written=True),)
        whole = Cell((), np.zeros(self.space.many), self.programs)
        try:
            entry = self.entries.of(mode)
            before = self.space.before()
            cell: Cell | None = whole
            terms = len(self.entries.lifted.terms)
            full = self._with_terms(before, np.zeros((terms, self.space.many + 1)))
            moved = entry.after[: self.space.states] @ full - before
            for row in self._significant(moved):
                cell = None if cell is None else cell.cut(Row(row[:-1], -float(row[-1]), "="))
            if cell is None:
                return
            finite = {n: v @ full for n, v in entry.finite.items()}
            at = self._values(finite, {}, finite, mode, mode)
            cells = [cell]
            for condition in self.where:
                cells = [p for c in cells for p, holds in truths(condition, c, at) if holds]
        except Barred as barred:
            yield Path(mode, start, whole, "barred", _said(barred))
            return
        except NotAffine as other:
            yield Path(mode, start, whole, "open", f"{other} is not affine")
            return
        for part in cells:
            point = _Point(part, self.space.now(), finite, mode, start)
            yield from self._from(point)

    def _from(self, point: _Point) -> Iterator[Path]:
        """Yield the paths on from a point."""
        if len(point.visits) > DEEP or len(point.writes) > WRITES:
            yield self._path(point, "open", "the state is written again and again")
            return
        try:
            entry = self.entries.of(point.mode)
            after, now, jump = self._entered(point, entry)
            at = self._values(now, jump, point.before, point.mode, point.old)
            cases = list(self._firing(point.cell, point.mode, at))
        except Barred as barred:
            yield self._path(point, "barred", _said(barred))
            return
        except NotAffine as other:
            yield self._path(point, "open", f"{other} is not affine")
            return
        for cell, rules in cases:
            own = replace(point, cell=cell)
            if rules:
                yield from self._fire(own, rules)
            else:
                yield from self._rest(own, after, now)

    def _entered(
        self, point: _Point, entry: Entry
    ) -> tuple[Matrix, dict[str, Vector], dict[str, Vector]]:
        """Return the state after entering the mode, and the parts of the signals."""
        terms = [self._term(e, point) for e in self.entries.lifted.terms]
        full = self._with_terms(point.stored, np.array(terms).reshape(-1, self.space.many + 1))
        finite = {n: v @ full for n, v in entry.finite.items()}
        if point.stays:
            return point.stored, point.before, {}
        impulse = {n: v @ full for n, v in entry.impulse.items()}
        return entry.after[: self.space.states] @ full, finite, impulse

    def _term(self, e: Expr, point: _Point) -> Vector:
        at = self._values(point.before, {}, point.before, point.old, point.old)
        found = [pair for _, pair in values(e, point.cell, at)]
        if len(found) != 1:
            raise NotAffine(f"pre({e})")
        return found[0].finite

    def _with_terms(self, stored: Matrix, terms: Matrix) -> Matrix:
        one = np.zeros(self.space.many + 1)
        one[-1] = 1.0
        return np.vstack([stored, terms, one])

    def _firing(
        self, cell: Cell, mode: Mode, at: Values, machine: int = 0
    ) -> Iterator[tuple[Cell, tuple[tuple[int, int], ...]]]:
        """Yield the parts of a cell with the rules that fire there, first of each machine."""
        if machine == len(self.graph.machines):
            yield cell, ()
            return
        m = self.graph.machines[machine]
        own = [(k, r) for k, r in enumerate(m.rules) if r.source == mode[machine]]
        for part, rule in self._first(cell, own, at):
            for piece, rest in self._firing(part, mode, at, machine + 1):
                yield piece, rest if rule < 0 else ((machine, rule), *rest)

    def _first(
        self, cell: Cell, rules: list[tuple[int, Rule]], at: Values
    ) -> Iterator[tuple[Cell, int]]:
        if not rules:
            yield cell, -1
            return
        k, rule = rules[0]
        for part, holds in truths(rule.guard, cell, at):
            if holds:
                yield part, k
            else:
                yield from self._first(part, rules[1:], at)

    def _fire(self, point: _Point, rules: tuple[tuple[int, int], ...]) -> Iterator[Path]:
        target = list(point.mode)
        for machine, k in rules:
            target[machine] = self.graph.machines[machine].rules[k].target
        visit = Visit(tuple(target), rules)
        visits = (*point.visits, visit)
        for k in range(point.since, len(point.visits)):
            if point.visits[k].mode == visit.mode:
                yield self._path(replace(point, visits=visits), "cycle", back=k)
                return
        yield from self._from(replace(point, visits=visits, fired=True, stays=False))

    def _rest(self, point: _Point, after: Matrix, now: dict[str, Vector]) -> Iterator[Path]:
        """Go on where no rule fires: the mode holds, or its jump is written."""
        moved = bool(self._significant(after - point.stored))
        if not point.fired and not moved:
            yield self._hold(point)
            return
        visits = (*point.visits[:-1], replace(point.visits[-1], written=True))
        for k, mode, stored in point.writes:
            if mode != point.mode:
                continue
            # the same state written twice: over and over, where it is the same
            again: Cell | None = point.cell
            for row in self._significant(after - stored):
                again = None if again is None else again.cut(Row(row[:-1], -row[-1], "="))
            if again is not None:
                own = replace(point, cell=again, visits=visits)
                yield self._path(own, "cycle", back=k)
                if not self._significant(after - stored):
                    return
        wrote = (*point.writes, (len(visits) - 1, point.mode, after))
        yield from self._from(
            replace(
                point,
                stored=after,
                before=now,
                old=point.mode,
                visits=visits,
                since=len(visits) - 1,
                fired=False,
                stays=True,
                writes=wrote,
            )
        )

    def _hold(self, point: _Point) -> Path:
        for m, k in zip(self.graph.machines, point.mode, strict=True):
            if m.fieldless and m.fieldless[k]:
                why = f"the state {m.states[k]!r} of {m.path} is fieldless, and no rule leaves it"
                return self._path(point, "barred", why)
        return self._path(point, "holds")

    def _path(self, point: _Point, end: End, why: str = "", back: int = -1) -> Path:
        begin = point.visits[0].mode
        return Path(begin, point.visits, point.cell, end, why, back, self._still(point.cell))

    def _still(self, cell: Cell) -> Cell | None:
        """Return the part of a cell in which nothing outside jumps, if there is one."""
        found: Cell | None = cell
        for k, state in enumerate(self.space.jumping):
            a = np.zeros(self.space.many)
            a[state], a[self.space.states + k] = 1.0, -1.0
            found = None if found is None else found.cut(Row(a, 0.0, "="))
        return found

    def _values(
        self,
        finite: dict[str, Vector],
        impulse: dict[str, Vector],
        before: dict[str, Vector],
        mode: Mode,
        old: Mode,
    ) -> Values:
        none = np.zeros(self.space.many + 1)

        def reading(parts: dict[str, Vector], jumps: dict[str, Vector], of: Mode) -> Read:
            on = self.graph.on_nodes(of)

            def read(name: str) -> Pair | bool:
                kind, _, rest = name.partition(":")
                if kind == "in":
                    machine, _, state = rest.partition(":")
                    return of[int(machine)] == int(state)
                if kind == "on":
                    return int(rest) in on
                return Pair(jumps.get(name, none), parts[name])

            return read

        return Values(reading(finite, impulse, mode), reading(before, {}, old), self.space.many)

    def _significant(self, rows: Matrix) -> list[Vector]:
        """Return the rows that are not zero but for rounding."""
        scale = np.append(self.programs.scale, 1.0)
        own = np.append(self.programs.scale[: self.space.states], 1.0)
        return [
            row
            for row, size in zip(rows, own, strict=False)
            if float(np.max(np.abs(row * scale))) > 10.0 * FLAT * size
        ]


def _said(barred: Barred) -> str:
    return f"{barred.error.code}: {barred.error.why}"
