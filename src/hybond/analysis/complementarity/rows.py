"""The rows of a linear complementarity system: rates and answers in states, sources and laws.

Three eliminations follow one another. The switch form has one variable per switch; those of
machines written by hand are closed in their mode. What is still free then are the efforts and
flows of storage in derivative causality: the constraints on what is stored, differentiated, give
them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from hybond.analysis.complementarity.ports import Port
from hybond.equations.calculus import partial_time
from hybond.equations.derive import storage_rows
from hybond.equations.peeling import Peeling
from hybond.equations.ring import Ring, Row, substituted
from hybond.equations.switch_form import SwitchForm, switch_form
from hybond.errors import CausalityError
from hybond.model.expressions import Expr, Number
from hybond.model.graph import FlatGraph, Mode

T = TypeVar("T")


@dataclass
class Derived(Generic[T]):
    """Rows of a linear complementarity system."""

    rates: list[Row[T]]
    answers: list[Row[T]]
    """`rates` and `answers`: one per stored quantity, one per law."""
    constraints: list[Row[T]]
    """Zero in every branch of the laws."""
    states: tuple[int, ...]
    inputs: tuple[int, ...]
    laws: tuple[int, ...]
    """`states`, `inputs` and `laws`: the columns of the rows."""
    names: dict[int, str]
    formulas: dict[int, Expr]
    """`names` and `formulas`: of the inputs, by column."""


def derive_rows(
    graph: FlatGraph, mode: Mode, ports: tuple[Port, ...], ring: Ring[T], *, symbolic: bool
) -> Derived[T] | None:
    """Return the rows in a mode of the machines written by hand.

    None if something that the rows read stays undetermined.
    """
    form = switch_form(graph, ring, reference_of(mode, ports), symbolic=symbolic)
    nodes = {p.law.node: p for p in ports}
    own: dict[int, int] = {}
    for s in form.switches:
        column = form.column(s)
        assert column is not None
        if column.index in nodes and graph.nodes[column.index].is_junction:
            own[column.index] = s
    closed = _Closed(form, mode, set(own.values()))
    laws = [own[p.law.node] for p in ports]
    sign = {own[p.law.node]: ring.of(1.0 if p.given == "common" else -1.0) for p in ports}

    def in_l(row: Row[T]) -> Row[T]:
        return {k: sign[k] * c if k in sign else c for k, c in row.items()}  # type: ignore[operator]

    rates = [
        in_l(closed.reduce(form.targets[form.partner["rate", s.index, 0]])) for s in graph.storages
    ]
    answers = []
    for p in ports:
        other = 1 if p.given == "common" else 0
        row = closed.reduce(form.closing(own[p.law.node], (other,)))
        way = ring.of(-1.0 if p.given == "common" else 1.0)
        answers.append(in_l({k: way * c for k, c in row.items()}))  # type: ignore[operator]
    constraints = [in_l(row) for row in closed.constraints]
    stored = storage_rows(form, symbolic=symbolic)
    rates = [substituted(ring, r, stored) for r in rates]
    answers = [substituted(ring, r, stored) for r in answers]
    constraints = [substituted(ring, r, stored) for r in constraints]
    constraints = [r for r in constraints if r]
    labels = {
        k: _source_name(form, k)
        for k in range(form.rows.unknowns, _end(form))
        if _is(form, k, "source")
    }
    formulas: dict[int, Expr] = {k: _formula(form, k) for k in labels}
    states = [form.partner["stored", s.index, 0] for s in graph.storages]
    free = closed.free
    if free or constraints:
        hidden = [
            _differentiated(row, rates, states, set(laws), form, ring, labels, formulas)
            for row in constraints
        ]
        last = Renumbered(ring, hidden, free)
        if any(row for row in last.constraints):
            raise _too_high(graph, mode)
        rates, answers = ([last.reduce(r) for r in rows] for rows in (rates, answers))
        if any(k in last.free for r in (*rates, *answers) for k in r):
            return None
    read = {k for r in (*rates, *answers) for k in r}
    return Derived(
        rates,
        answers,
        constraints,
        tuple(states),
        tuple(k for k in sorted(labels) if k in read),
        tuple(laws),
        labels,
        formulas,
    )


def reference_of(mode: Mode, ports: tuple[Port, ...]) -> Mode:
    """Return the mode in which each `l` is zero."""
    reference = list(mode)
    for port in ports:
        reference[port.machine] = 1 if port.given == "net" else 0
    return tuple(reference)


class Renumbered(Generic[T]):
    """A peeling whose unknowns are some columns, wherever they stand."""

    def __init__(self, ring: Ring[T], rows: list[Row[T]], unknowns: list[int]) -> None:
        self._at = {k: j for j, k in enumerate(unknowns)}
        self._back = list(unknowns)
        self._n = len(unknowns)
        self._peeling = Peeling(ring, [self._there(r) for r in rows], self._n)
        self.constraints = [self._here(self._peeling.settled(r)) for r in self._peeling.constraints]
        self.free = [self._back[k] for k in self._peeling.free()]

    def _there(self, row: Row[T]) -> Row[T]:
        return {self._at.get(k, k + self._n): c for k, c in row.items()}

    def _here(self, row: Row[T]) -> Row[T]:
        return {self._back[k] if k < self._n else k - self._n: c for k, c in row.items()}

    def reduce(self, row: Row[T]) -> Row[T]:
        """Return a row with the unknowns replaced, as far as they are determined."""
        return self._here(self._peeling.settled(self._peeling.reduce(self._there(row))))


class _Closed(Renumbered[T]):
    """The switch form with all switches closed but those of junctions with laws."""

    def __init__(self, form: SwitchForm[T], mode: Mode, left: set[int]) -> None:
        others = [s for s in form.switches if s not in left]
        rows = [form.closing(s, tuple(mode[m] for m in form.closer(s).machines)) for s in others]
        super().__init__(form.ring, [*rows, *form.constraints], [*others, *form.tears])


def _end(form: SwitchForm[T]) -> int:
    return form.rows.unknowns + len(form.rows.columns)


def _is(form: SwitchForm[T], k: int, kind: str) -> bool:
    column = form.column(k)
    return column is not None and column.kind == kind


def _formula(form: SwitchForm[T], k: int) -> Expr:
    column = form.column(k)
    assert column is not None and column.formula is not None
    return column.formula


def _source_name(form: SwitchForm[T], k: int) -> str:
    """Return the name of a source column, with a number if its element has several."""
    column = form.column(k)
    assert column is not None
    same = [
        j
        for j in range(form.rows.unknowns, _end(form))
        if _is(form, j, "source")
        and form.rows.columns[j - form.rows.unknowns].index == column.index
    ]
    path = form.graph.nodes[column.index].path
    return path if len(same) == 1 else f"{path}#{same.index(k) + 1}"


def _differentiated(
    row: Row[T],
    rates: list[Row[T]],
    states: list[int],
    laws: set[int],
    form: SwitchForm[T],
    ring: Ring[T],
    labels: dict[int, str],
    formulas: dict[int, Expr],
) -> Row[T]:
    """Return the time derivative of a constraint; rates of sources get columns of their own."""
    parts: list[tuple[T, Row[T]]] = []
    for k, c in row.items():
        if k in states:
            parts.append((c, rates[states.index(k)]))
            continue
        if k in laws:
            raise CausalityError(
                "a law is tied to a constraint on what is stored",
                code="HB-C104",
                where=form.graph.name,
                hint="look at what stands in parallel or in series with it",
            )
        rate = partial_time(formulas[k], form.graph)
        if rate == Number(0.0):
            continue
        label = f"{labels[k]}'"
        at = next((j for j, name in labels.items() if name == label), None)
        if at is None:
            at = _end(form) + len(labels)
            labels[at], formulas[at] = label, rate
        parts.append((c, {at: ring.one}))
    return ring.collect(parts)


def _too_high(graph: FlatGraph, mode: Mode) -> CausalityError:
    return CausalityError(
        "a constraint on storage leaves no rate free that could keep it",
        code="HB-C103",
        where=graph.mode_text(mode),
        hint="a controlled source prescribes what it also measures; add storage or resistance",
    )
