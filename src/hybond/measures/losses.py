"""`Losses`: where the energy of a run came from and where it went, element by element."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.audit import is_balanced
from hybond.errors import UsageError
from hybond.measures.energies import check_located, energies_into, power_nodes
from hybond.measures.jumps import jumps_in, owner_of
from hybond.measures.value import shown
from hybond.measures.window import TOLERANCE, Window
from hybond.model.graph import FlatGraph, Node
from hybond.names import did_you_mean, html_lines, html_table, in_columns
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]

COLUMNS = ("supplied", "dissipated", "lost", "stored")
SET = "(set)"
"""The row of what a script gave or took when it set what storages are made of."""
SAME = 2.0
"""Times as much as the audit finds unbalanced in all the run may be so in a part of it."""
NOWHERE = "(jumps)"
"""The row of what was lost in jumps that belong to no junction: an inconsistent start."""
_KINDS = {"Se": "source", "Sf": "source", "R": "resistor", "G": "resistor"}
_KINDS |= {"C": "storage", "I": "storage", "0": "switch", "1": "switch"}


@dataclass(frozen=True, slots=True)
class Row:
    """The energy of one element, J: ``supplied = dissipated + lost + stored`` over all rows.

    Parameters
    ----------
    name, kind : str
        Path; ``source``, ``resistor``, ``storage``, ``switch`` or, of several, ``part``.
    supplied : float
        What it gave, as a source; negative if it took.
    dissipated : float
        What it took while time passed, as a resistor or the law of a junction.
    lost : float
        What was lost there in jumps.
    stored : float
        How much more is stored at the end than at the start.
    """

    name: str
    kind: str
    supplied: float = 0.0
    dissipated: float = 0.0
    lost: float = 0.0
    stored: float = 0.0

    @property
    def taken(self) -> float:
        """What went into it, J; negative if it gave."""
        return self.dissipated + self.lost + self.stored - self.supplied


@dataclass(frozen=True, slots=True)
class Losses:
    """Energy of a window, element by element; prints as a table.

    Parameters
    ----------
    rows : tuple of Row
    start, end : float
        s.
    through : float
        All that passed between elements, J: what `unbalanced` is measured by.
    unit : str
        ``"J"``, or ``"W"`` of `mean_power`.
    notes : tuple of str
        What was decided on the way.
    rtol : float
        The tolerance of the run.
    beyond : float
        The part of `through` that its steps had no right to, where more than 10 rtol is unbalanced
        and the audit of the run knows of it.
    """

    rows: tuple[Row, ...]
    start: float
    end: float
    through: float
    unit: str = "J"
    notes: tuple[str, ...] = ()
    rtol: float = 1e-8
    beyond: float = math.inf

    @property
    def supplied(self) -> float:
        """What sources gave, less what they took."""
        return sum(r.supplied for r in self.rows)

    @property
    def dissipated(self) -> float:
        """What resistors and laws took while time passed."""
        return sum(r.dissipated for r in self.rows)

    @property
    def lost(self) -> float:
        """What was lost in jumps."""
        return sum(r.lost for r in self.rows)

    @property
    def stored(self) -> float:
        """How much more is stored at the end."""
        return sum(r.stored for r in self.rows)

    @property
    def unbalanced(self) -> float:
        """What is supplied and went nowhere: rounding, and the tolerance of the run."""
        return self.supplied - self.dissipated - self.lost - self.stored

    def holds(self, rtol: float | None = None) -> bool:
        """Whether it adds up, by the rule of `Result.audit`: at the tolerance of the run, or 1e-8.

        With an `rtol` below that of the run, what its steps may be wrong by is held against it.
        """
        wrong = abs(self.unbalanced)
        part = wrong / self.through if self.through > 0.0 else 0.0 if wrong == 0.0 else math.inf
        return is_balanced(part, self.beyond, made=self.rtol, asked=rtol)

    def __getitem__(self, name: str) -> Row:
        """Return the row of an element, or what those of a submodel add up to; HB-R111."""
        own = [r for r in self.rows if r.name == name]
        return own[0] if own else _sum(name, self._within(name))

    def __iter__(self) -> Any:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def mean_power(self) -> Losses:
        """Return the same divided by the length of the window, in W."""
        if self.unit == "W":
            return self
        length = self.end - self.start
        rows = tuple(
            Row(r.name, r.kind, *(getattr(r, c) / length for c in COLUMNS)) for r in self.rows
        )
        through = self.through / length
        return replace(self, rows=rows, through=through, unit="W")

    def grouped(self, depth: int = 1) -> Losses:
        """Return it with submodels as rows: paths of more than `depth` words are added up."""
        groups: dict[str, list[Row]] = {}
        for row in self.rows:
            groups.setdefault(".".join(row.name.split(".")[:depth]), []).append(row)
        rows = tuple(
            rows[0] if len(rows) == 1 and rows[0].name == name else _sum(name, rows)
            for name, rows in groups.items()
        )
        return replace(self, rows=rows)

    def efficiency(
        self, loads: str | Sequence[str], *, sources: str | Sequence[str] | None = None
    ) -> float:
        """Return what loads took, as a part of what sources gave.

        Parameters
        ----------
        loads, sources : str or sequence of str
            Elements or submodels; by default all sources that gave, but for the loads.

        Raises
        ------
        UsageError
            HB-R111 for a name that is not there; HB-R112 if nothing was given.
        """
        wanted = [r for name in _listed(loads) for r in self._within(name)]
        used = {r.name for r in wanted}
        if sources is None:
            givers = [r for r in self.rows if r.supplied > 0.0 and r.name not in used]
        else:
            givers = [r for name in _listed(sources) for r in self._within(name)]
        given = -sum(r.taken for r in givers)
        if not given > 0.0:
            raise UsageError(
                f"{', '.join(r.name for r in givers) or 'no source'} gave nothing in the window",
                code="HB-R112",
                where="sources",
                hint="name what feeds the loads: sources=",
            )
        return sum(r.taken for r in wanted) / given

    def _within(self, name: str) -> list[Row]:
        found = [r for r in self.rows if r.name == name or r.name.startswith(f"{name}.")]
        if not found:
            known = {r.name for r in self.rows} | {r.name.split(".")[0] for r in self.rows}
            raise UsageError(
                f"no energy of {name!r}",
                code="HB-R111",
                where="losses",
                hint=did_you_mean(name, sorted(known)),
            )
        return found

    # -- other forms

    def table(self) -> dict[str, list[Any]]:
        """Return columns: element, kind, supplied, dissipated, lost, stored."""
        found: dict[str, list[Any]] = {"element": [r.name for r in self.rows]}
        found["kind"] = [r.kind for r in self.rows]
        return found | {c: [getattr(r, c) for r in self.rows] for c in COLUMNS}

    def to_pandas(self) -> Any:
        """Return a DataFrame with a row for each element."""
        import pandas as pd

        return pd.DataFrame(self.table()).set_index("element")

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "start": self.start,
            "end": self.end,
            "unit": self.unit,
            "rows": [
                {"element": r.name, "kind": r.kind, **{c: getattr(r, c) for c in COLUMNS}}
                for r in self.rows
            ],
            "total": {c: getattr(self, c) for c in COLUMNS},
            "unbalanced": self.unbalanced,
            "through": self.through,
            "notes": list(self.notes),
        }

    def text_rows(self) -> list[tuple[str, ...]]:
        """Return the table for people: head, elements, total."""

        def words(row: Any) -> list[str]:
            values = (getattr(row, c) for c in COLUMNS)
            return [shown(v, self.unit) if abs(v) > 1e-12 * self.through else "" for v in values]

        head = ("element", "kind", "supplied", "dissipated", "lost in jumps", "stored")
        body = [(r.name, r.kind, *words(r)) for r in self.rows]
        return [head, *body, ("total", "", *words(self))]

    def __str__(self) -> str:
        window = f"t = {self.start:.9g} s to {self.end:.9g} s"
        return "\n".join([window, *in_columns(self.text_rows()), *self.notes])

    def _repr_html_(self) -> str:
        head, *body = self.text_rows()
        return html_table(body, head) + html_lines(self.notes)


def _listed(names: str | Sequence[str]) -> list[str]:
    return [names] if isinstance(names, str) else list(names)


def _sum(name: str, rows: Iterable[Row]) -> Row:
    own = list(rows)
    return Row(name, "part", *(sum(getattr(r, c) for r in own) for c in COLUMNS))


def losses_of(run: Result, window: Window) -> Losses:
    """Return where the energy of a window came from and where it went.

    Elements that neither gave nor took are left out, those on pseudo bonds too: effort times flow
    is no power there.

    Raises
    ------
    UsageError
        HB-R113 for time-stepping: its steps do not tell jumps from motion.
    NumericsError
        HB-R103, HB-R104.
    """
    check_located(run)
    graph = run.graph
    nodes = power_nodes(graph)
    passed = energies_into(run, nodes, window, tolerance=TOLERANCE)
    into = dict(zip((n.index for n in nodes), passed.total.tolist(), strict=True))
    book = _Book(graph)
    given = _set_by_script(run, window)
    for node in nodes:
        if node.kind in ("Se", "Sf") and not node.implied:
            book.add(node, supplied=-into[node.index])
        elif not node.about.energy:
            book.add(owner_of(graph, node), dissipated=into[node.index])
    for node, change in _stored(run, nodes, window):
        book.add(node, stored=change)
    jumps = jumps_in(run, window)
    for jump in jumps:
        for k, energy in jump.supplied.items():
            book.add(graph.nodes[k], supplied=energy)
        for k, energy in jump.lost.items():
            book.add(graph.nodes[k] if k >= 0 else None, lost=energy)
    through = float(np.abs(passed.energy).sum()) / 2.0
    through += sum(abs(e) for j in jumps for e in (*j.lost.values(), *j.supplied.values()))
    notes = []
    shared = sum(j.shared for j in jumps)
    if shared:
        notes.append(f"of {shared} jumps the loss is split in proportion between their switches")
    pseudo = [
        n.path
        for n in graph.nodes
        if n.ends
        and n.domain.pseudo
        and not n.is_junction
        # clocks of controllers are generic, and not worth a word beside what has energy
        and (n.domain.effort is not None or not nodes)
    ]
    if pseudo:
        notes.append(f"on pseudo bonds there is no energy: {', '.join(pseudo[:8])}")
    through += abs(given)
    rows = book.rows(through)
    if abs(given) > 1e-15 * through:
        rows = (*rows, Row(SET, "script", supplied=given))
    rtol = run.signals.tables.numbers["rtol"]
    found = Losses(rows, window.start, window.end, through, notes=tuple(notes), rtol=rtol)
    if found.holds() or not through > 0.0:
        return found
    audit = run.audit()
    known = abs(found.unbalanced) <= SAME * audit.energy * through
    return replace(found, beyond=audit.beyond) if known else found


class _Book:
    """Sums by element."""

    def __init__(self, graph: FlatGraph) -> None:
        self._graph = graph
        self._sums: dict[int, dict[str, float]] = {}

    def add(self, node: Node | None, **energies: float) -> None:
        own = self._sums.setdefault(-1 if node is None else node.index, {})
        for column, value in energies.items():
            own[column] = own.get(column, 0.0) + value

    def rows(self, through: float) -> tuple[Row, ...]:
        """Return the rows in the order of the graph; a hidden switch counts with its element."""
        found: dict[str, Row] = {}
        for k in sorted(self._sums, key=lambda k: (k < 0, k)):
            node = None if k < 0 else self._graph.nodes[k]
            name, kind = NOWHERE, "start"
            if node is not None:
                name, kind = node.path, _KINDS.get(node.kind, node.kind)
                if node.hidden:
                    name = name.rpartition(".")[0]
            old = found.get(name, Row(name, kind))
            sums = {c: getattr(old, c) + self._sums[k].get(c, 0.0) for c in COLUMNS}
            found[name] = Row(name, old.kind, **sums)
        least = 1e-15 * through
        return tuple(r for r in found.values() if any(abs(getattr(r, c)) > least for c in COLUMNS))


def _stored(run: Result, nodes: Sequence[Node], window: Window) -> list[tuple[Node, float]]:
    """Return how much more each storage has at the end of a window than at its start."""
    begin, end = state_at_start(run, window), state_at_end(run, window)
    graph = run.graph
    storages = [n for n in nodes if n.about.energy]
    rows = [begin]
    for node in storages:
        own = begin.copy()
        for s in graph.storages:
            if s.node == node.index:
                own[s.index] = end[s.index]
        rows.append(own)
    early, late = (run.signals_of(k) for k in _numbers(run, window))
    if early is late:
        energy = late.stored(np.array(rows))
        return [(n, float(e - energy[0])) for n, e in zip(storages, energy[1:], strict=True)]
    # parameters were set on the way: each storage alone, by what it is at either time
    alone: list[Vector] = []
    for state, signals in ((begin, early), (end, late)):
        own = np.tile(state, (len(storages) + 1, 1))
        for k, node in enumerate(storages):
            for s in graph.storages:
                own[k + 1, s.index] = 0.0 if s.node == node.index else state[s.index]
        energy = signals.stored(own)
        alone.append(energy[0] - energy[1:])
    return [(n, float(b - a)) for n, a, b in zip(storages, *alone, strict=True)]


def _numbers(run: Result, window: Window) -> tuple[int, int]:
    """Return the segments in which a window begins and ends, by their numbers."""
    first = 0 if window.first else run._segment_at(window.start, "right")
    return first, run._segment_at(window.end, "right")


def _set_by_script(run: Result, window: Window) -> float:
    """Return the energy that storages have more when a script sets what they are."""
    found = 0.0
    for t, before, after, state in run.changes():
        if window.has(t):
            found += float(after.stored(state[None])[0] - before.stored(state[None])[0])
    return found


def state_at_start(run: Result, window: Window) -> Vector:
    """Return what is stored when a window begins, before what belongs to it happens."""
    events = run.trace.events
    if window.first and events and events.times[0] == window.start:
        return np.asarray(events[0].before, dtype=float)
    return _right(run, window.start)


def state_at_end(run: Result, window: Window) -> Vector:
    """Return what is stored when a window is over, after what happened at its end."""
    return _right(run, window.end)


def _right(run: Result, t: float) -> Vector:
    events = run.trace.events
    if t == run.t_end and run._settled_at_end:
        return np.asarray(events[-1].after, dtype=float)
    segment = run.segments[run._segment_at(t, "right")]
    if t > segment.t[-1]:
        state, _ = run.signals_of(run._segment_at(t, "right")).rest(segment, t)
        return np.asarray(state, dtype=float)
    return np.asarray(segment.at(t), dtype=float)
