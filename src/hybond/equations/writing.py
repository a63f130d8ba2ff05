"""State equations in writing: text, LaTeX, Markdown."""

from __future__ import annotations

from typing import Any

from hybond.equations.booleans import Cube
from hybond.equations.display import joined, signed, split
from hybond.equations.mixed import MixedRow
from hybond.equations.notation import LatexNotation, Notation, in_latex, in_markdown
from hybond.equations.state_form import StateEquations
from hybond.model.expressions import Expr, Number
from hybond.model.expressions import names as names_of
from hybond.model.expressions import to_text as expr_text
from hybond.model.graph import Mode
from hybond.model.parametric import INVERSE
from hybond.units import format_quantity

Terms = dict[Cube, list[tuple[str, Any]]]
"""Per Boolean product: name of a variable and its coefficient."""

INLINE = 24
"""A source whose formula is up to this long stands in the equations as it is."""


def write_text(eq: StateEquations[Any], mode: Mode | None = None) -> str:
    """Return the equations as text.

    Parameters
    ----------
    mode : tuple of int, optional
        One mode; default all, with Booleans.
    """
    writer = _Writer(eq, mode, Notation(eq.display))
    lines = writer.equations()
    where = writer.where()
    if where:
        lines += ["where", *(f"  {line}" for line in where)]
    return "\n".join(lines + [f"# {note}" for note in _notes(eq, mode)])


def write_markdown(eq: StateEquations[Any], mode: Mode | None = None) -> str:
    """Return the equations for Markdown: one aligned formula and a list."""
    writer = _Writer(eq, mode, LatexNotation(eq.display))
    where = [f"- ${line}$" for line in writer.where()]
    notes = [f"- {note}" for note in _notes(eq, mode)]
    return "\n".join([in_markdown(writer.equations()), "", *where, *notes]).rstrip() + "\n"


def write_latex(eq: StateEquations[Any], mode: Mode | None = None) -> str:
    """Return the equations as a LaTeX ``align*``; what is to be said besides as comments."""
    writer = _Writer(eq, mode, LatexNotation(eq.display))
    rows = [*writer.equations(), *("& " + line for line in writer.where())]
    return in_latex(rows, _notes(eq, mode))


def _notes(eq: StateEquations[Any], mode: Mode | None) -> list[str]:
    """Say what the Booleans are, which mode the form starts from and what was kept."""
    graph = eq.graph
    notes = []
    if mode is not None:
        notes.append(f"mode: {graph.mode_text(mode)}")
    else:
        for k, b in enumerate(eq.naming.booleans):
            about = graph.machines[b.machine]
            states = ", ".join(about.states[s] for s in sorted(b.states))
            if k == 20:
                notes.append(f"... {len(eq.naming.booleans) - 20} more Booleans")
                break
            notes.append(f"{eq.display.kappa(k)} = 1 when {about.path} is {states or 'never'}")
    for node in graph.nodes if eq.symbolic else ():
        letter = INVERSE.get(node.kind)
        if letter and len(node.ends) > 1 and node.law is not None and node.law.matrix is not None:
            notes.append(f"{node.path}.{letter} is the inverse of {node.path}.{node.kind}")
    zero = sorted(eq.display.name(name) for name in eq.ring.vanished)
    if zero:
        notes.append(f"zero in this model, and left out: {', '.join(zero)}")
    if mode is None:
        for region in eq.regions:
            reasons = sorted(set(region.void.values()))
            for why in reasons:
                gaps = frozenset(k for k, reason in region.void.items() if reason == why)
                where = " or ".join(eq.display.cube(c) for c in eq.naming.cubes(region.space, gaps))
                notes.append(f"not where {where} is 1: {why}")
    if eq.lost:
        names = ", ".join(eq.variable_name(k) for k in eq.lost)
        notes.append(f"undetermined, and read by nothing: {names}")
    for region in eq.regions:
        stays = [k for k in region.variables if k in eq.kept]
        if stays:
            kept = ", ".join(eq.variable_name(k) for k in stays)
            notes.append(f"kept as variables: {kept} ({region.why_kept})")
        lost = sorted({v for variables in region.undetermined for v in variables})
        if lost:
            names = ", ".join(eq.variable_name(k) for k in lost)
            notes.append(f"undetermined in some mode, and without effect on the rates: {names}")
    return notes


class _Writer:
    """Which terms an equation has."""

    def __init__(self, eq: StateEquations[Any], mode: Mode | None, say: Notation) -> None:
        self.eq = eq
        self.mode = mode
        self.say = say

    def equations(self) -> list[str]:
        """Return one equation per state, one per kept variable, then the outputs."""
        found = [self._equation(row) for row in self.eq.rows]
        for name, row in zip(self.eq.output_names, self.eq.outputs, strict=True):
            found.append(self.say.equals(self.say.variable(name), self._sum(self._terms(row, 1.0))))
        return found

    def where(self) -> list[str]:
        """Return the laws and sources that the equations name, not aligned."""
        eq = self.eq
        found = []
        read: set[str] = set()
        for k in eq.laws:
            e = self._law(k)
            read |= {n for n in names_of(e) if n.startswith(("e:", "f:"))}
            found.append(self.say.equals(self.say.variable(eq.law_name(k)), self.say.formula(e)))
        for name in sorted(read, key=lambda n: (n[0], int(n[2:]))):
            row = eq.bond_row(name)
            text = self.say.variable(self.eq.display.name(name))
            value = self._sum(self._terms(row, 1.0))
            if value != text:
                found.append(self.say.equals(text, value))
        found += self._integrals()
        for k in eq.sources:
            e = self._law(k)
            if not self._inline(k):
                found.append(
                    self.say.equals(self.say.variable(eq.source_name(k)), self.say.formula(e))
                )
        return [line.replace("&= ", "= ") for line in found]

    def _integrals(self) -> list[str]:
        """Return the rates of the integrated signals that the equations read, or their samples."""
        eq = self.eq
        read = {n for row in (*eq.rows, *eq.outputs) for n in eq.names_in(row)}
        read |= {n for k in (*eq.sources, *eq.laws) for n in names_of(self._law(k))}
        samples = {k: s for s in eq.graph.samples if s.block is None for k in s.signals}
        blocks = {k for s in eq.graph.samples if s.block is not None for k in s.signals}
        found, seen = [], set()
        while wanted := sorted(n for n in read if n.startswith("s:") and n not in seen):
            for name in wanted:
                seen.add(name)
                integral = eq.graph.integrals[int(name[2:])]
                if int(name[2:]) in blocks:
                    continue
                if int(name[2:]) in samples:
                    sample = samples[int(name[2:])]
                    now = self.say.equals(
                        self.say.variable(integral.path), self.say.formula(sample.values[0])
                    )
                    found.append(now + self.say.every(format_quantity(sample.every, "s")))
                    read |= names_of(sample.values[0])
                    continue
                row = eq.signal_row(integral.rate)
                value = (
                    self.say.formula(integral.rate)
                    if row is None
                    else self._sum(self._terms(row, 1.0))
                )
                found.append(self.say.equals(self.say.rate(integral.path), value))
                read |= names_of(integral.rate)
        return found

    def _law(self, column: int) -> Expr:
        own = self.eq.column(column)
        if own.kind == "storage":
            return self.eq.storage_law(own.index)
        assert own.formula is not None
        return own.formula

    def _inline(self, column: int) -> bool:
        own = self.eq.column(column)
        e = own.formula
        return (
            e is not None
            and not isinstance(e, Number)
            and len(expr_text(self.eq.display.expression(e))) <= INLINE
        )

    def _equation(self, row: MixedRow[Any]) -> str:
        left = self._sum(self._terms(row, 1.0, kinds=("rate",)))
        right = self._sum(self._terms(row, -1.0, kinds=("state", "input", "law")))
        return self.say.equals(left, right)

    def _terms(
        self,
        row: MixedRow[Any],
        sign: float,
        kinds: tuple[str, ...] = ("rate", "state", "input", "law"),
    ) -> Terms:
        eq, ring = self.eq, self.eq.ring
        factor, minus = ring.of(sign), ring.of(-1.0)
        found: Terms = {}
        columns = row.columns() if self.mode is None else sorted(row.at(self.mode, ring))
        order = {"state": 0, "law": 1, "input": 2, "rate": 3}
        columns.sort(key=lambda k: (order[eq.place[k][0]], eq.place[k][1]))
        for k in columns:
            kind, j = eq.place[k]
            if kind not in kinds:
                continue
            if self.mode is None:
                terms = row.entry(k, ring, eq.naming)
            else:
                terms = [((), row.at(self.mode, ring)[k])]
            for cube, c in terms:
                negative, name = self._name(k, kind, j)
                sign = minus * factor if negative else factor
                found.setdefault(cube, []).append((name, sign * c))
        return found

    def _name(self, column: int, kind: str, j: int) -> tuple[bool, str]:
        """Return what a column is called, and whether that has a sign in front."""
        eq = self.eq
        match kind:
            case "state":
                return False, self.say.variable(eq.states[j])
            case "rate":
                return False, self.say.rate(eq.states[j])
            case "law":
                return False, self.say.variable(eq.law_names[j])
            case _ if self._inline(column):
                negative, text = signed(self.say.formula(self._law(column)))
                return negative, text if _simple(text) else f"({text})"
            case _:
                return False, self.say.variable(eq.source_name(column))

    def _sum(self, terms: Terms) -> str:
        total: list[str] = []
        for cube in sorted(terms, key=lambda c: (len(c), c)):
            parts = [self.say.term(piece, name) for name, c in terms[cube] for piece in split(c)]
            if cube and len(parts) == 1:
                ((name, c),) = terms[cube]
                parts = [self.say.term(c, name, cube)]
            elif cube:
                parts = [self.say.grouped(cube, parts)]
            total += parts
        return joined(total) if total else "0"


def _simple(text: str) -> bool:
    """Whether a term is a product: no sum outside brackets."""
    return " + " not in text and " - " not in text and not text.startswith("-")
