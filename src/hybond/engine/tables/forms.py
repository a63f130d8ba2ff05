"""What in a model is linear in states and in functions of time that solve equations of their own.

A *form* is a row of numbers: an expression as a sum of bond variables, stored quantities, signals
and generators. Each source has two, its value and its rate; then each row that is evaluated has
one, and each rate of an integrated signal. Where there is none, the reason has a number.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from hybond.engine.tables.expressions import number_of
from hybond.engine.tables.generators import (
    CONSTANT,
    Found,
    Generators,
    Terms,
    constant,
    generators,
    of_name,
    terms_of,
)
from hybond.engine.tables.options import METHODS
from hybond.equations.element_parts import Dynamic, Source
from hybond.model.expressions import Expr, names
from hybond.model.inputs import Called, Constant, Timetable
from hybond.options import QUANTISED

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

STORAGE = "nonlinear storage"
LINEAR = [METHODS[name] for name in ("exact", "auto", *QUANTISED)]
"""Methods that read forms."""
LAWS = "laws that are not linear"
_STORED = ("x:", "s:", "e:", "f:")
_COLUMNS = {
    "ints": (
        *("form_first", "form_column", "form_why", "generator_first", "generator_column"),
        *("generator_value", "generator_moving"),
    ),
    "floats": ("form_value", "generator_rate"),
}


def put_forms(t: ModelTables, sources: list[Source], dynamics: list[Dynamic]) -> None:
    """Put the forms of a model into its tables, if it is run by the method that reads them."""
    if t.numbers["method"] in LINEAR:
        _Making(t).put(sources, dynamics)
        return
    t.numbers.update(generators=0, generator_one=0, forms_why=-1, reasons=0)
    t.ints.update({name: [] for name in _COLUMNS["ints"]})
    t.floats.update({name: [] for name in _COLUMNS["floats"]})


class _Making:
    """Forms being made."""

    def __init__(self, t: ModelTables) -> None:
        self.t = t
        self.reasons = [STORAGE, LAWS]

    def put(self, sources: list[Source], dynamics: list[Dynamic]) -> None:
        t, g = self.t, self.t.graph
        rates = [self._terms(i.rate, bonds=True) for i in g.integrals]
        held = self._not_linear(rates)
        found = [self._source(s, s.value) for s in sources]
        found += [self._source(s, s.rate) for s in sources]
        found += [LAWS if isinstance(f, str) else f for f in map(self._dynamic, dynamics)]
        found = [self._free_of(f, held) for f in found]
        t.numbers["forms_why"] = self._followed(held)
        found += [
            "not linear" if i.index in held else f for i, f in zip(g.integrals, rates, strict=True)
        ]
        made = generators(
            [CONSTANT, *(k for f in found if isinstance(f, dict) for k in f if not _stored(k[2]))],
            self._slope,
        )
        t.ints["form_why"] = [self._number(f) if isinstance(f, str) else -1 for f in found]
        self._rows("form", [self._row(f, made) for f in found], "value")
        lower = [_entries(row) for row in made.matrix.tolist()]
        self._rows("generator", lower, "rate")
        t.ints["generator_value"] = [t.values.number(e, "a generator") for e in made.expressions]
        t.ints["generator_moving"] = [int(a) for a in made.moving]
        t.numbers.update(
            generators=len(made.expressions),
            generator_one=made.place[CONSTANT],
            reasons=len(self.reasons),
        )
        t.reasons = self.reasons

    def _number(self, reason: str) -> int:
        if reason not in self.reasons:
            self.reasons.append(reason)
        return self.reasons.index(reason)

    def _terms(self, e: Expr, *, bonds: bool) -> Found:
        """Return an expression as terms, linear in what is stored, or why it has none."""
        found = self._found(e, bonds=bonds, level=False)
        if isinstance(found, str):
            # inputs that never change may be factors, if they are taken for their levels
            found = self._found(e, bonds=bonds, level=True)
        return found

    def _found(self, e: Expr, *, bonds: bool, level: bool) -> Found:
        def known(path: str) -> Found:
            if path.startswith(("e:", "f:")) and not bonds:
                return "a bond variable"
            return self._name(path, level=level)

        found = terms_of(e, known)
        straight = isinstance(found, str) or all(map(_straight, found))
        return found if straight else "a product with what is stored"

    def _name(self, path: str, *, level: bool) -> Found:
        kind, _, index = path.partition(":")
        if kind in ("on", "in"):
            return "a condition that varies"
        if kind not in ("u", "du"):
            return of_name(path)
        waveform = self.t.graph.inputs[int(index)].waveform
        if isinstance(waveform, Called):
            return "an input that is a function in Python"
        if kind == "u" and level and isinstance(waveform, Constant):
            return constant(waveform.level)
        return of_name(path) if kind == "u" or _slopes(waveform) else constant(0.0)

    def _slope(self, path: str) -> str | None:
        """Return the name of the slope of an input, None if it has none."""
        kind, _, index = path.partition(":")
        sloping = kind == "u" and _slopes(self.t.graph.inputs[int(index)].waveform)
        return f"du:{index}" if sloping else None

    def _source(self, source: Source, e: Expr) -> Found:
        # a rate may follow bond variables: where it is asked for, they are solved for with it
        found = self._terms(e, bonds=e is source.rate)
        where = self.t.graph.nodes[source.node].path
        return f"{found} in the source {where}" if isinstance(found, str) else found

    def _dynamic(self, row: Dynamic) -> Found:
        return self._terms(row.expression, bonds=True)

    def _not_linear(self, rates: list[Found]) -> set[int]:
        """Return the signals that do not move linearly, with those that follow them."""
        held = {k for k, terms in enumerate(rates) if isinstance(terms, str)}
        while more := {
            k
            for k, terms in enumerate(rates)
            if k not in held and isinstance(terms, dict) and _signals(terms) & held
        }:
            held |= more
        return held

    def _followed(self, held: set[int]) -> int:
        """Return why no mode can be propagated: one such signal follows another; or -1."""
        integrals = self.t.graph.integrals
        for k in sorted(held):
            read = {int(n[2:]) for n in names(integrals[k].rate) if n.startswith("s:")}
            for other in sorted(read & held):
                path = integrals[other].path
                follows = "" if other == k else f"{integrals[k].path} follows {path}, which "
                return self._number(f"{follows or path + ' '}does not move linearly")
        return -1

    def _free_of(self, found: Found, held: set[int]) -> Found:
        if isinstance(found, str):
            return found
        other = sorted(_signals(found) & held)
        if not other:
            return found
        path = self.t.graph.integrals[other[0]].path
        return f"a source follows {path}, which does not move linearly"

    def _row(self, found: Found, made: Generators) -> list[tuple[int, float]]:
        if isinstance(found, str):
            return []
        g, slots = self.t.graph, self.t.slots
        bonds, stored = 2 * len(g.bonds), len(g.storages)
        first = bonds + stored + len(g.integrals)
        row = [(first + k, a) for k, a in made.row(_timed(found)).items()]
        for key, c in found.items():
            factor = c.real
            if not _stored(key[2]):
                continue
            path = key[2][0]
            kind, _, index = path.partition(":")
            if kind in ("e", "f"):
                row.append((slots.index[path] - slots.w.start, factor))
            else:
                row.append((bonds + int(index) + (stored if kind == "s" else 0), factor))
        return sorted(row, key=lambda entry: entry[0])

    def _rows(self, name: str, rows: list[list[tuple[int, float]]], value: str) -> None:
        first = [0]
        for row in rows:
            first.append(first[-1] + len(row))
        self.t.ints[f"{name}_first"] = first
        self.t.ints[f"{name}_column"] = [k for row in rows for k, _ in row]
        self.t.floats[f"{name}_{value}"] = [number_of(c) for row in rows for _, c in row]


def _slopes(waveform: object) -> bool:
    return isinstance(waveform, Timetable) and waveform.linear


def _stored(factors: Iterable[str]) -> bool:
    return any(name.startswith(_STORED) for name in factors)


def _straight(key: tuple[complex, float, tuple[str, ...]]) -> bool:
    """Whether a term is linear in what is stored, with a constant factor, or free of it."""
    return not _stored(key[2]) or (not key[0] and not key[1] and len(key[2]) == 1)


def _signals(terms: Terms) -> set[int]:
    return {int(n[2:]) for key in terms for n in key[2] if n.startswith("s:")}


def _timed(terms: Terms) -> Terms:
    return {key: c for key, c in terms.items() if not _stored(key[2])}


def _entries(row: list[float]) -> list[tuple[int, float]]:
    return [(k, c) for k, c in enumerate(row) if c]
