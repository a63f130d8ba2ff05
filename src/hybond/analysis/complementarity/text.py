"""A complementarity system in writing: text, LaTeX, Markdown, plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hybond.analysis.complementarity.ports import LawPort
from hybond.equations.display import joined, signed, split
from hybond.equations.notation import LatexNotation, Notation, in_latex, in_markdown
from hybond.equations.symbolic.rational import Rational
from hybond.model.expressions import Expr, Number
from hybond.model.expressions import names as names_of
from hybond.model.expressions import to_text as expr_text

if TYPE_CHECKING:
    from hybond.analysis.complementarity.form import ComplementarityForm


def write_text(form: ComplementarityForm) -> str:
    """Return the system as text."""
    writer = _Text(form)
    lines = [f"{left} = {right}" for left, right in writer.equations()]
    lines += [line for law in form.laws for line in writer.condition(law)]
    lines.append("where")
    for law in form.laws:
        lines.append(f"  {law.given} = {law.given_signal}, {law.given_words}")
        lines.append(f"  {law.answer} = {law.answer_signal}, {law.answer_words}")
    lines += [f"  {left} = {right}" for left, right in writer.where()]
    lines += [f"# {note}" for note in notes(form)]
    return "\n".join(lines)


def write_latex(form: ComplementarityForm) -> str:
    """Return the system as a LaTeX ``align*``; words as comments."""
    writer = _Latex(form)
    rows = [f"{left} &= {right}" for left, right in writer.equations()]
    rows += [f"& {line}" for law in form.laws for line in writer.condition(law)]
    rows += [f"& {left} = {right}" for left, right in (*writer.pairs(), *writer.where())]
    return in_latex(rows, notes(form))


def write_markdown(form: ComplementarityForm) -> str:
    """Return the system for Markdown: one aligned formula and a list."""
    writer = _Latex(form)
    rows = [f"{left} &= {right}" for left, right in writer.equations()]
    rows += [f"& {line}" for law in form.laws for line in writer.condition(law)]
    words = {law.given: law.given_words for law in form.laws}
    words |= {law.answer: law.answer_words for law in form.laws}
    pairs = zip(
        (n for law in form.laws for n in (law.given, law.answer)), writer.pairs(), strict=True
    )
    lines = [f"- ${left} = {right}$, {words[name]}" for name, (left, right) in pairs]
    lines += [f"- ${left} = {right}$" for left, right in writer.where()]
    lines += [f"- {note}" for note in notes(form)]
    return "\n".join([in_markdown(rows), "", *lines]) + "\n"


def to_data(form: ComplementarityForm) -> dict[str, Any]:
    """Return plain data; matrix entries as ``[row, column, text]``, indices from 0."""
    show = form.display

    def text(e: Expr | None) -> str | None:
        return None if e is None else expr_text(show.expression(e))

    p = form.properties
    return {
        "mode": {
            name: state
            for name, state in form.graph.mode_names(form.mode).items()
            if name not in {law.path for law in form.laws}
        },
        "states": list(form.states),
        "inputs": {name: text(form.formulas[name]) for name in form.inputs},
        "laws": [
            {
                "junction": law.path,
                "law": law.kind,
                "l": law.given_signal,
                "w": law.answer_signal,
                "bounded": {"given": "l", "answer": "w"}.get(law.bounded, "both"),
                **{
                    name: text(getattr(law, name))
                    for name in ("limit", "breakaway", "gap", "gate", "restitution")
                    if getattr(law, name) is not None
                },
            }
            for law in form.laws
        ],
        "matrices": {
            name: [[i, j, m.text_of(i, j)] for i, j in sorted(m.entries)]
            for name in "ABECDFac"
            for m in (getattr(form, name),)
        },
        "numbers": {name: value.tolist() for name, value in form.numbers().items()},
        "constraints": list(form.constraints),
        "nonlinear": list(form.nonlinear),
        "point": None if form.point is None else dict(form.point),
        "D semidefinite": p.semidefinite,
        "passive": p.passive,
        "relative degrees": list(p.degrees),
    }


def notes(form: ComplementarityForm) -> list[str]:
    """Say what the system is, in words."""
    graph = form.graph
    found = []
    hand = [m.index for m in graph.machines if m.law is None]
    if hand:
        names = graph.mode_names(form.mode)
        states = ", ".join(
            f"{graph.machines[k].path} = {names[graph.machines[k].path]}" for k in hand
        )
        found.append(f"with {states}")
    if form.nonlinear:
        found.append(f"not linear: {', '.join(form.nonlinear)}")
        point = ", ".join(f"{k} = {x:.6g}" for k, x in (form.point or {}).items())
        found.append(f"linearised at the start, t = 0{f', {point}' if point else ''}")
    found += [f"in every branch: {c}" for c in form.constraints]
    zero = sorted(form.display.name(name) for name in form.vanished)
    if zero:
        found.append(f"zero in this model, and left out: {', '.join(zero)}")
    read = _inputs_of_coefficients(form)
    if read:
        values = ", ".join(
            f"{form.display.name(name)} = {form.A.values[name]:.6g}" for name in read
        )
        found.append(f"numbers are those with {values}, at the start")
    return found + form.properties.sentences(form.given, form.answers)


def _inputs_of_coefficients(form: ComplementarityForm) -> list[str]:
    """Return the inputs that coefficients read, whose formulas stand for atoms as well."""
    atoms = {
        atom
        for matrix in (getattr(form, name) for name in "ABECDF")
        for terms in matrix.entries.values()
        for _, c in terms
        if isinstance(c, Rational)
        for atom in c.atoms()
    }
    meaning = form.display.meaning
    read = {n for a in atoms for n in (names_of(meaning[a]) if a in meaning else (a,))}
    return sorted(n for n in read if n.startswith("u:"))


class _Writer:
    """What text and LaTeX share."""

    def __init__(self, form: ComplementarityForm, say: Notation) -> None:
        self.form = form
        self.say = say

    def equations(self) -> list[tuple[str, str]]:
        """Return left and right side of each row."""
        form = self.form
        found = []
        for k, name in enumerate(form.states):
            found.append((self.say.rate(name), self._row(k, (form.A, form.B, form.E, form.a))))
        for k, name in enumerate(form.answers):
            found.append((self.say.variable(name), self._row(k, (form.C, form.F, form.D, form.c))))
        return found

    def _row(self, k: int, matrices: tuple[Any, ...]) -> str:
        parts = []
        for m in matrices:
            for j, name in enumerate(m.columns):
                for _, c in m.terms(k, j):
                    variable = "" if name == "1" else self._column(name)
                    parts += [self.say.term(piece, variable) for piece in split(c)]
        return joined(parts) if parts else "0"

    def _column(self, name: str) -> str:
        return self.say.rate(name[:-1]) if name.endswith("'") else self.say.variable(name)

    def where(self) -> list[tuple[str, str]]:
        """Return what inputs are, and rates of the integrated signals that are read."""
        form = self.form
        found = [(self._column(n), self.say.formula(form.formulas[n])) for n in form.inputs]
        read = {n for e in form.formulas.values() for n in names_of(e)}
        for law in form.laws:
            for e in (law.limit, law.breakaway, law.gap, law.gate, law.restitution):
                read |= names_of(e) if e is not None else set()
        seen: set[str] = set()
        while wanted := sorted(n for n in read if n.startswith("s:") and n not in seen):
            for name in wanted:
                seen.add(name)
                integral = form.graph.integrals[int(name[2:])]
                found.append((self.say.rate(integral.path), self.say.formula(integral.rate)))
                read |= names_of(integral.rate)
        return found

    def pairs(self) -> list[tuple[str, str]]:
        """Return each `l` and `w` and the signal that it is."""
        found = []
        for law in self.form.laws:
            for name, signal in (
                (law.given, law.given_signal),
                (law.answer, law.answer_signal),
            ):
                minus, path = signed(signal)
                text = self.say.variable(path)
                found.append((self.say.variable(name), f"-{text}" if minus else text))
        return found


class _Text(_Writer):
    def __init__(self, form: ComplementarityForm) -> None:
        super().__init__(form, Notation(form.display))

    def condition(self, law: LawPort) -> list[str]:
        """Return the lines that say how a pair is bounded."""
        g, w = law.given, law.answer
        if law.bounded != "one-sided":
            held, free = (g, w) if law.bounded == "given" else (w, g)
            assert law.limit is not None
            limit = self.say.formula(law.limit)
            size = limit if limit.replace(".", "").replace("_", "").isalnum() else f"({limit})"
            ways = f"{held} = -{size} where {free} > 0, {limit} where {free} < 0"
            lines = [f"-{size} <= {held} <= {limit}, {ways}"]
            if law.breakaway is not None:
                lines.append(
                    f"  at rest ({free} = 0) |{held}| <= {self.say.formula(law.breakaway)}"
                )
            return lines
        lines = [f"0 <= {g} ⟂ {w} >= 0"]
        off = g if law.orientation == "common" else w
        if law.gap is not None:
            lines[0] += f" where {self.say.formula(law.gap)} <= 0; elsewhere {off} = 0"
        if law.gate is not None:
            lines[0] += f"; {off} begins only while {self.say.formula(law.gate)}"
        if law.restitution is not None and law.restitution != Number(0.0):
            net = w if law.orientation == "common" else g
            eps = self.say.formula(law.restitution)
            other = g if net == w else w
            lines.append(f"  in an impact 0 <= {other} ⟂ {net} + {eps}*pre({net}) >= 0")
        return lines


class _LawNotation(LatexNotation):
    """LaTeX in which the variables of laws have their letters."""

    def __init__(self, form: ComplementarityForm) -> None:
        super().__init__(form.display)
        self.own = {*form.given, *form.answers}

    def variable(self, name: str) -> str:
        if name in self.own:
            letter = {"λ": r"\lambda", "ω": r"\omega"}.get(name[0], name[0])
            return f"{letter}_{{{name[1:]}}}"
        return super().variable(name)


class _Latex(_Writer):
    def __init__(self, form: ComplementarityForm) -> None:
        super().__init__(form, _LawNotation(form))

    def condition(self, law: LawPort) -> list[str]:
        """Return the lines that say how a pair is bounded."""
        g, w = self.say.variable(law.given), self.say.variable(law.answer)
        if law.bounded != "one-sided":
            held, free = (g, w) if law.bounded == "given" else (w, g)
            assert law.limit is not None
            limit = self.say.formula(law.limit)
            lines = [rf"{held} \in -\left({limit}\right) \, \mathrm{{Sgn}}\left({free}\right)"]
            if law.breakaway is not None:
                size = self.say.formula(law.breakaway)
                lines[0] += rf", \quad \left|{held}\right| \le {size} \text{{ at }} {free} = 0"
            return lines
        lines = [rf"0 \le {g} \perp {w} \ge 0"]
        off = g if law.orientation == "common" else w
        if law.gap is not None:
            lines[0] += rf" \text{{ where }} {self.say.formula(law.gap)} \le 0"
            lines[0] += rf", \text{{ elsewhere }} {off} = 0"
        if law.gate is not None:
            lines[0] += rf", \quad {off} \text{{ begins only while }} {self.say.formula(law.gate)}"
        if law.restitution is not None and law.restitution != Number(0.0):
            net, other = (w, g) if law.orientation == "common" else (g, w)
            eps = self.say.formula(law.restitution)
            lines.append(
                rf"0 \le {other} \perp {net}^+ + {eps} \, {net}^- \ge 0 \text{{ in an impact}}"
            )
        return lines
