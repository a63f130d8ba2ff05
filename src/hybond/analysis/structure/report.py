"""How a structural analysis shows itself: table, Markdown, HTML, data, marks for a drawing."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from hybond.analysis.structure.rows import ModeStructure, Property, Word
from hybond.errors import UsageError
from hybond.model.graph import FlatGraph, Mode
from hybond.names import html_lines, html_table, in_columns

CAVEAT = "Per-mode results imply nothing about the switched system."
HEADER = (
    "mode",
    "order",
    "derivative",
    "solvable",
    "impulse-free",
    "controllable",
    "observable",
    "loops",
    "stiffness",
)
SHOWN = 4
"""Names per cell; all are in the record."""


@dataclass(frozen=True)
class StructureReport:
    """The structure of a model, mode by mode; prints as a table.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.analysis.structure.structure import structure
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R("1 kohm"), c=hb.C("1 mF"))
    >>> m.bond("V -> i -> r", "i -> c")
    >>> report = structure(m, outputs=["c.e"])
    >>> report.summary["controllable, finite"], report.marks(())
    ((True, True), {})
    >>> report.record()["modes"][0]["poles"]
    [[-1.0, 0.0]]
    """

    graph: FlatGraph
    rows: tuple[ModeStructure, ...]
    selection: str
    """Which modes these are."""
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def row(self, mode: Mode | Mapping[str, str]) -> ModeStructure:
        """Return the row of a mode, a tuple or ``{machine: state}``.

        Raises
        ------
        UsageError
            HB-A102 if that mode was not analysed.
        """
        wanted = self.graph.mode_of(mode)
        for row in self.rows:
            if row.mode == wanted:
                return row
        raise UsageError(
            f"the mode {self.graph.mode_text(wanted)} was not analysed",
            code="HB-A102",
            where="mode",
            hint="name it in modes=[...]",
        )

    @property
    def summary(self) -> dict[str, tuple[bool | None, bool | None] | None]:
        """Per property: whether it holds in each mode, and in some mode, of those analysed.

        None if it was asked of no mode. What a refused mode would say is unknown: an answer that
        hangs on it is None.
        """
        tests: dict[str, Callable[[ModeStructure], bool | None]] = {
            "solvable": lambda r: r.solvable,
            "impulse-free": lambda r: r.impulse_free,
            "all storage integral": lambda r: not r.derivative,
            "no algebraic loop": lambda r: not r.loops,
        }
        for what in ("controllable", "observable"):
            for k, where in enumerate(("finite", "at infinity", "impulse")):
                tests[f"{what}, {where}"] = _test(what, k)
        found: dict[str, tuple[bool | None, bool | None] | None] = {}
        for name, test in tests.items():
            seen = [None if r.refused else test(r) for r in self.rows]
            if all(s is None for s in seen):
                found[name] = None
            else:
                unknown = any(s is None and r.refused for s, r in zip(seen, self.rows, strict=True))
                known = [s for s in seen if s is not None]
                each = all(known) and (None if unknown else len(known) == len(seen))
                found[name] = (each, any(known) or (None if unknown else False))
        return found

    def table(self) -> str:
        """Return the rows as aligned text, one line per mode.

        ``controllable`` and ``observable`` have three words: at finite frequencies, at infinity,
        of impulses. ``no*`` holds for nearly all values of the elements, but not at these.
        """
        cells = [HEADER, *(_cells(r) for r in self.rows)]
        return "\n".join(in_columns(cells))

    def notes(self) -> list[str]:
        """Return what there is to say, per mode."""
        found = []
        for row in self.rows:
            if row.refused is not None:
                found.append(f"{row.text}: {row.refused['code']} {row.refused['why']}")
            found += [f"{row.text}: {note}" for note in row.notes]
        if self.graph.integrals:
            names = listed(tuple(i.path for i in self.graph.integrals))
            found.append(f"integrated signals ({names}) are no states of this analysis")
        return found

    def __str__(self) -> str:
        lines = [f"Structure of {self.graph.name}, {self.selection}", "", self.table()]
        if any(r.controllable or r.observable for r in self.rows):
            lines.append(
                "(controllable, observable: at finite frequencies, at infinity, of impulses)"
            )
        notes = self.notes()
        lines += ["", *notes] if notes else []
        if len(self.rows) > 1:
            lines += [
                "",
                *in_columns([("", "in each mode", "in some mode"), *self._summary_cells()]),
            ]
        lines += ["", CAVEAT]
        return "\n".join(line.rstrip() for line in lines)

    def __repr__(self) -> str:
        return str(self)

    def _summary_cells(self) -> list[tuple[str, ...]]:
        return [
            (name, *("unknown" if v is None else _word(v) for v in verdict))
            for name, verdict in self.summary.items()
            if verdict is not None
        ]

    def to_markdown(self) -> str:
        """Return table, notes and summary as Markdown."""

        def rows(cells: list[tuple[str, ...]]) -> list[str]:
            first, *rest = [
                "| " + " | ".join(c.replace("|", "\\|").replace("*", "\\*") for c in r) + " |"
                for r in cells
            ]
            return [first, "|" + " --- |" * len(cells[0]), *rest]

        lines = rows([HEADER, *(_cells(r) for r in self.rows)])
        lines += ["", *(f"- {note}" for note in self.notes())]
        if len(self.rows) > 1:
            lines += ["", *rows([("", "in each mode", "in some mode"), *self._summary_cells()])]
        return "\n".join([*lines, "", CAVEAT])

    def _repr_html_(self) -> str:
        parts = [html_lines([self.selection]), html_table([_cells(r) for r in self.rows], HEADER)]
        if notes := self.notes():
            parts.append("<ul>" + "".join(f"<li>{html.escape(n)}</li>" for n in notes) + "</ul>")
        if len(self.rows) > 1:
            parts.append(html_table(self._summary_cells(), ("", "in each mode", "in some mode")))
        return "".join([*parts, f"<p>{CAVEAT}</p>"])

    def to_pandas(self) -> Any:
        """Return a DataFrame, one row per mode (pandas must be installed)."""
        import pandas as pd

        return pd.DataFrame([dict(zip(HEADER, _cells(r), strict=True)) for r in self.rows])

    def record(self) -> dict[str, Any]:
        """Return everything as plain data that JSON can hold."""
        return {
            "model": self.graph.name,
            "selection": self.selection,
            "inputs": list(self.inputs),
            "outputs": list(self.outputs),
            "modes": [
                {**r.record(), "states_of_machines": self.graph.mode_names(r.mode)}
                for r in self.rows
            ],
            "summary": {
                name: None if v is None else {"in each mode": v[0], "in some mode": v[1]}
                for name, v in self.summary.items()
            },
            "caveat": CAVEAT,
        }

    def marks(self, mode: Mode | Mapping[str, str]) -> dict[str, str]:
        """Return one word per element that is out of the ordinary in a mode, for a drawing.

        The words are ``uncontrollable``, ``unobservable``, ``derivative``, ``loop`` and
        ``stiff``; an element that deserves several has the first of these.
        """
        row = self.row(mode)
        graph = self.graph
        node_of = {s.path: graph.nodes[s.node].path for s in graph.storages}
        groups: list[tuple[str, list[str]]] = []
        for word, has in (("uncontrollable", row.controllable), ("unobservable", row.observable)):
            if has is not None:
                groups.append((word, [node_of[s] for s in has.storages if s in node_of]))
        groups.append(("derivative", [node_of[s] for s in row.derivative]))
        cut = {b.name: b for b in graph.bonds}
        groups.append(("loop", [_element(graph, cut[name].index) for name in row.loops]))
        if row.stiffness is not None and row.stiffness.stiff:
            fast = [node_of[s] for s in row.stiffness.fast if s in node_of]
            groups.append(("stiff", [*fast, *row.stiffness.resistors]))
        found: dict[str, str] = {}
        for word, nodes in groups:
            for path in nodes:
                found.setdefault(path, word)
        return found


def _element(graph: FlatGraph, bond: int) -> str:
    """Return the end of a bond that is an element, or else its tail."""
    ends = (graph.nodes[graph.bonds[bond].tail], graph.nodes[graph.bonds[bond].head])
    return next((n.path for n in ends if not n.is_junction), ends[0].path)


def _test(what: str, k: int) -> Callable[[ModeStructure], bool | None]:
    def test(row: ModeStructure) -> bool | None:
        has: Property | None = getattr(row, what)
        return None if has is None else has.actual[k]

    return test


def _word(value: bool | None) -> Word:
    return "-" if value is None else "yes" if value else "no"


def _property(has: Property | None) -> str:
    if has is None:
        return "-"
    pairs = zip(has.actual, has.structural, strict=True)
    return " ".join("yes" if a else "no*" if s else "no" for a, s in pairs)


def listed(names: tuple[str, ...]) -> str:
    """Return names joined by commas; of many the first ones, and how many more there are.

    Examples
    --------
    >>> listed(("a", "b")), listed(("a", "b", "c", "d", "e", "f"))
    ('a, b', 'a, b, c, d and 2 more')
    """
    if len(names) <= SHOWN + 1:
        return ", ".join(names)
    return f"{', '.join(names[:SHOWN])} and {len(names) - SHOWN} more"


def _cells(row: ModeStructure) -> tuple[str, ...]:
    if row.refused is not None:
        return (row.text, row.refused["code"], *[""] * (len(HEADER) - 2))
    return (
        row.text,
        "-" if row.order is None else str(row.order),
        listed(row.derivative),
        _word(row.solvable),
        _word(row.impulse_free),
        _property(row.controllable),
        _property(row.observable),
        listed(row.loops),
        "-" if row.stiffness is None else f"{row.stiffness.ratio:.2g}",
    )
