"""Mixed-Boolean rows: coefficients that depend on the mode through a few switches each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from hybond.equations.booleans import Cube, Naming
from hybond.equations.patterns import Space
from hybond.equations.regions import Region
from hybond.equations.ring import Ring, Row
from hybond.equations.switch_form import SwitchForm
from hybond.model.graph import Mode

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Part(Generic[T]):
    """What one region adds to a row: one row per combination of its switches."""

    space: Space
    rows: tuple[Row[T], ...]
    void: frozenset[int] = frozenset()
    """Combinations without rows: the region has no solution there."""


@dataclass(frozen=True, slots=True)
class MixedRow(Generic[T]):
    """A row whose coefficients depend on the mode: ``base + sum of parts``, summing to zero."""

    base: Row[T]
    parts: tuple[Part[T], ...] = ()

    def at(self, mode: Mode, ring: Ring[T]) -> Row[T]:
        """Return the row in one mode."""
        if not self.parts:
            return self.base
        rows = [(ring.one, part.rows[part.space.index(mode)]) for part in self.parts]
        return ring.collect([(ring.one, self.base), *rows])

    def mapped(self, change: Callable[[Row[T]], Row[T]]) -> MixedRow[T]:
        """Return the row with a linear change of columns made in every mode."""
        parts = tuple(Part(p.space, tuple(change(r) for r in p.rows), p.void) for p in self.parts)
        return MixedRow(change(self.base), parts)

    def silenced(self, space: Space, dead: Sequence[set[int]], ring: Ring[T]) -> MixedRow[T]:
        """Return the row without some columns in some combinations of `space`.

        Parameters
        ----------
        dead : sequence of set of int
            Per combination: the columns that are zero in it.
        """
        columns = set().union(*dead)
        if not columns & set(self.columns()):
            return self
        moved = {k: c for k, c in self.base.items() if k in columns}
        base = {k: c for k, c in self.base.items() if k not in columns}
        own = next((p.rows for p in self.parts if p.space == space), ({},) * space.count)
        void = next((p.void for p in self.parts if p.space == space), frozenset())
        rows = tuple(
            {
                k: c
                for k, c in ring.collect([(ring.one, moved), (ring.one, row)]).items()
                if k not in gone
            }
            for row, gone in zip(own, dead, strict=True)
        )
        others = tuple(p for p in self.parts if p.space != space)
        return MixedRow(base, (*others, Part(space, rows, void)))

    def columns(self) -> list[int]:
        """Return the columns that occur in some mode, in order."""
        found = set(self.base)
        for part in self.parts:
            for row in part.rows:
                found |= row.keys()
        return sorted(found)

    def entry(self, column: int, ring: Ring[T], naming: Naming) -> list[tuple[Cube, T]]:
        """Return one coefficient as Boolean products times mode-independent coefficients."""
        base = {column: self.base[column]} if column in self.base else {}
        tables = [
            (
                part.space,
                [{k: row[k] for k in (column,) if k in row} for row in part.rows],
                part.void,
            )
            for part in self.parts
            if any(column in row for row in part.rows)
        ]
        if not tables:
            return [((), base[column])] if base else []
        best: list[tuple[Cube, T]] | None = None
        for k, (space, rows, void) in enumerate(tables):
            # the mode-independent part goes into one of the tables, if that is shorter
            whole = [ring.collect([(ring.one, base), (ring.one, row)]) for row in rows]
            rest = [
                term
                for j, (other, table, gaps) in enumerate(tables)
                if j != k
                for term in _terms(other, table, column, naming, gaps)
            ]
            for candidate in _candidates(space, whole, base, column, ring, naming, void):
                found = [*candidate, *rest]
                if best is None or _length(found, ring) < _length(best, ring):
                    best = found
        assert best is not None
        return best


def _candidates(
    space: Space,
    whole: list[Row[T]],
    base: Row[T],
    column: int,
    ring: Ring[T],
    naming: Naming,
    void: frozenset[int],
) -> Iterator[list[tuple[Cube, T]]]:
    """Yield a table as a baseline, the same in all modes, and what differs from it."""
    yield _terms(space, whole, column, naming, void)
    if not base:
        return
    seen: list[Row[T]] = []
    for row in [base, *whole]:
        if column not in row:
            continue
        baseline = {column: row[column]}
        if any(baseline == other for other in seen):
            continue
        seen.append(baseline)
        rest = [
            ring.collect(
                [(ring.one, {k: c for k, c in r.items() if k == column}), (ring.of(-1.0), baseline)]
            )
            for r in whole
        ]
        yield [((), baseline[column]), *_terms(space, rest, column, naming, void)]


def _terms(
    space: Space,
    rows: Sequence[Row[T]],
    column: int,
    naming: Naming,
    void: frozenset[int] = frozenset(),
) -> list[tuple[Cube, T]]:
    values: list[tuple[T, set[int]]] = []
    for k, row in enumerate(rows):
        if column not in row or k in void:
            continue
        for value, where in values:
            if value == row[column]:
                where.add(k)
                break
        else:
            values.append((row[column], {k}))
    return [
        (cube, value)
        for value, where in values
        for cube in naming.cubes(space, frozenset(where), void)
    ]


def _length(terms: list[tuple[Cube, T]], ring: Ring[T]) -> int:
    return sum(3 + 2 * len(cube) + ring.cost(c) for cube, c in terms)


def mixed_row(
    form: SwitchForm[T],
    value: Row[T],
    region_at: dict[int, Region[T]],
    *,
    target: int | None = None,
) -> MixedRow[T]:
    """Return ``target - value = 0`` (or just ``value``) without eliminated switch variables.

    Parameters
    ----------
    value : Row
        Knowns, switch variables and tears.
    region_at : dict
        Variable to the region that eliminated it.
    target : int, optional
        The rate that `value` gives; where it gave way to a constraint, that constraint is the
        row.
    """
    ring = form.ring
    minus = ring.of(-1.0)
    rest = {k: c for k, c in value.items() if k not in region_at}
    regions: dict[int, Region[T]] = {}
    for k in value:
        if k in region_at:
            regions[id(region_at[k])] = region_at[k]
    own: Row[T] = {} if target is None else {target: ring.one}
    sign = ring.one if target is None else minus
    base = ring.collect([(ring.one, own), (sign, rest)])
    parts = []
    for region in regions.values():
        inside = [(sign * value[k], k) for k in value if region_at.get(k) is region]  # type: ignore[operator]
        rows: list[Row[T]] = []
        gives_way = target is not None and any(target in r for r in region.replaced)
        void = frozenset(region.void)
        for k, (values, replaced) in enumerate(zip(region.values, region.replaced, strict=True)):
            if k in void:
                rows.append({})
                continue
            if target is not None and target in replaced:
                rows.append({k: minus * c for k, c in replaced[target].items()})  # type: ignore[operator]
                continue
            added = [(c, values[k]) for c, k in inside]
            if gives_way:
                added.append((ring.one, base))
            rows.append(ring.collect(added))
        if gives_way:
            # only this region reaches the row: all of it is tabulated
            base = {}
        if len(rows) == 1:
            base = ring.collect([(ring.one, base), (ring.one, rows[0])])
        elif any(rows):
            parts.append(Part(region.space, tuple(rows), void))
    return MixedRow(base, tuple(parts))


def closing_row(form: SwitchForm[T], switch: int) -> MixedRow[T]:
    """Return the closing row of a kept switch variable, by the states of its own machines."""
    from hybond.equations.regions import space_of_switch

    space = space_of_switch(form, switch)
    rows = []
    for states in space.states():
        at = dict(zip(space.machines, states, strict=True))
        rows.append(form.closing(switch, tuple(at[m] for m in form.closer(switch).machines)))
    if len(rows) == 1:
        return MixedRow(rows[0])
    return MixedRow({}, (Part(space, tuple(rows)),))


def cleared(row: MixedRow[T], ring: Ring[T]) -> MixedRow[T]:
    """Return the row multiplied through by denominators that the state can make zero.

    A modulus that passes through zero (a crank at dead centre) would divide by zero there,
    though the equation itself is well: ``J' / sin + M' = F / sin`` is ``J' + sin M' = F``.
    """
    if len(row.parts) > 1:
        return row
    if not row.parts:
        return MixedRow(ring.cleared(row.base))
    ((part),) = row.parts
    whole = [
        {} if k in part.void else ring.collect([(ring.one, row.base), (ring.one, r)])
        for k, r in enumerate(part.rows)
    ]
    plain = [ring.cleared(r) for r in whole]
    if plain == whole:
        return row
    return MixedRow({}, (Part(part.space, tuple(plain), part.void),))
