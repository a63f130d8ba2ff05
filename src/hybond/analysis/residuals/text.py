"""Residuals in writing: text, LaTeX, Markdown, SymPy, plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from hybond.analysis.residuals.jets import Jet
from hybond.analysis.residuals.sensor_rows import Known
from hybond.equations.booleans import Cube
from hybond.equations.display import joined, split
from hybond.equations.notation import LatexNotation, Notation, in_markdown, leading
from hybond.model.expressions import Number
from hybond.model.expressions import to_text as expr_text
from hybond.model.graph import Mode
from hybond.names import in_columns

if TYPE_CHECKING:
    from hybond.analysis.residuals.residuals import Residual, Residuals

Form = Literal["text", "latex"]
Terms = dict[Cube, list[tuple[Jet, Any]]]
INLINE = 6
"""Length up to which a constant source stands in a residual as its formula."""
OPEN, CLOSE = r"\left(", r"\right)"


def terms_of(residual: Residual, mode: Mode | None = None) -> Terms:
    """Return jets with coefficients per Boolean product; sources first, then sensors."""
    about = residual.of
    jets = about.jets
    row = residual.row
    found: Terms = {}
    columns = row.columns() if mode is None else sorted(row.at(mode, about.ring))
    columns.sort(key=lambda k: _order(about, jets.jets[k]))
    for k in columns:
        if mode is None:
            parts = row.entry(k, about.ring, about.naming)
        else:
            parts = [((), row.at(mode, about.ring)[k])]
        for cube, c in parts:
            found.setdefault(cube, []).append((jets.jets[k], c))
    return found


def _order(about: Residuals, jet: Jet) -> tuple[Any, ...]:
    known = about.jets.known[jet.column]
    return (known.kind == "sensor", jet.order, -jet.column)


def write_residual(residual: Residual, mode: Mode | None = None, *, form: Form = "text") -> str:
    """Return the formula of one residual."""
    latex = form == "latex"
    say = (LatexNotation if latex else Notation)(residual.of.display)
    total: list[str] = []
    terms = terms_of(residual, mode)
    for cube in sorted(terms, key=lambda c: (len(c), [(v, not on) for v, on in c])):
        pieces = [
            (name, p)
            for j, c in terms[cube]
            for name, factor in [_named(residual.of, j, c, form)]
            for p in split(factor)
        ]
        groups = _gathered(pieces, latex)
        whole = cube if len(groups) == 1 else ()
        parts = []
        for name, c in groups:
            part = say.term(c, name, whole)
            if name.startswith(OPEN):
                # a fraction's bar binds as brackets do
                inner = name.removeprefix(OPEN).removesuffix(CLOSE)
                part = part.replace(rf"\frac{{{name}}}", rf"\frac{{{inner}}}")
            parts.append(part)
        total += [say.grouped(cube, parts)] if cube and not whole else parts
    return joined(leading(total)) if total else "0"


def _named(about: Residuals, jet: Jet, c: Any, form: Form) -> tuple[str, Any]:
    """Return a jet's name and coefficient; a constant that is a formula stands as it is."""
    inline = _inline(about, about.jets.known[jet.column])
    if inline is not None:
        return "", c * inline
    return name_of(about, jet, form), c


def _inline(about: Residuals, known: Known) -> Any:
    if not known.constant or isinstance(known.formula, Number):
        return None
    value = about.ring.read(known.formula)
    return value if value.length <= INLINE else None


def _gathered(pieces: list[tuple[str, Any]], latex: bool) -> list[tuple[str, Any]]:
    """Write ``De1/R - De2/R`` as ``(De1 - De2)/R``."""
    groups: list[tuple[Any, list[str]]] = []
    for name, c in pieces:
        for factor, members in groups:
            together = bool(name) and members[0] != "" and factor.length
            if together and factor == c:
                members.append(name)
                break
            if together and factor == -c:
                members.append(f"-{name}")
                break
        else:
            groups.append((c, [name]))
    found = []
    for c, members in groups:
        if len(members) == 1:
            found.append((members[0], c))
            continue
        inner = joined(members)
        found.append((f"{OPEN}{inner}{CLOSE}" if latex else f"({inner})", c))
    return found


def name_of(about: Residuals, jet: Jet, form: Form = "text") -> str:
    """Return what a sensor, source or derivative is called."""
    name = about.jets.known[jet.column].name
    if form == "text":
        return Notation(about.display).rate(name if _plain(name) else f"({name})", jet.order)
    return LatexNotation(about.display).rate(name, jet.order)


def _plain(name: str) -> bool:
    return not any(c in name for c in "+-*/^ ") or name.startswith('"')


def residual_sympy(residual: Residual, mode: Mode | None = None) -> Any:
    """Return a residual as a SymPy expression."""
    import sympy

    show = residual.of.display
    total = sympy.Integer(0)
    for cube, parts in terms_of(residual, mode).items():
        product = sympy.Integer(1)
        for v, positive in cube:
            kappa = sympy.Symbol(show.kappa(v), real=True)
            product *= kappa if positive else 1 - kappa
        for jet, c in parts:
            name, c = _named(residual.of, jet, c, "text")
            total += product * show.sympy(c) * (sympy.Symbol(name, real=True) if name else 1)
    return total


def where_of(about: Residuals) -> list[str]:
    """Return what sources and Booleans in the residuals are."""
    show = about.display
    found = []
    for k in about.known:
        if k.kind == "source" and _inline(about, k) is None:
            formula = expr_text(show.expression(k.formula))
            if formula != k.name:
                found.append(f"{k.name} = {formula}")
        elif k.name in about.graph.signals and k.kind == "sensor":
            formula = expr_text(show.expression(k.formula))
            found.append(f"{k.name} = {formula}")
    used: set[int] = set()
    for residual in about:
        for cube in terms_of(residual):
            used |= {v for v, _ in cube}
    for v in sorted(used):
        b = about.naming.booleans[v]
        machine = about.graph.machines[b.machine]
        states = " or ".join(machine.states[s] for s in sorted(b.states))
        found.append(f"{show.kappa(v)} = 1 when {machine.path} is {states or 'never'}")
    return found


def notes_of(about: Residuals) -> list[str]:
    """Return origins, where residuals are silent, and what the sensors do not reach."""
    found = ["; ".join(f"{r.name}: {r.origin}" for r in about)]
    if about.mode is not None:
        found.append(f"only for the mode {about.graph.mode_text(about.mode)}")
    for r in about:
        if r.silent:
            found.append(f"{r.name} says nothing (0 = 0) while {' or '.join(r.silent)} = 1")
    found += [f"HB-A305: {u}" for u in about.unobserved]
    for path, why in about.unused.items():
        if not any(u.path.startswith(f"{path}.") for u in about.unobserved):
            found.append(f"the law of {path} is in no residual: {why}")
    for region in about.regions.large:
        names = ", ".join(_switch_name(about, s) for s in region.switches[:6])
        found.append(f"left out around {names}: {region.why_left_out}")
    if about.special:
        found.append("some residual holds by a coincidence of the values of parameters")
    found.append(diagnostic_note(about))
    return [n for n in found if n]


def diagnostic_note(about: Residuals) -> str:
    """Return the verdict of diagnostic causality in one line."""
    verdict = about.diagnostic
    if verdict.exists:
        return "diagnostic causality exists"
    reasons = [*verdict.missing.values(), *verdict.storages.values(), *verdict.conflicts]
    text = "no diagnostic causality"
    return f"{text}: {reasons[0]}" if reasons else text


def _switch_name(about: Residuals, switch: int) -> str:
    column = about.given.column(switch)
    return "" if column is None else about.graph.nodes[column.index].path


def write_page(about: Residuals, mode: Mode | None = None) -> str:
    """Return all residuals with what their names mean."""
    lines = [f"{r.name} = {r.text(mode)}" for r in about]
    where = where_of(about)
    if where:
        lines += ["where", *(f"  {line}" for line in where)]
    return "\n".join([*lines, *(f"# {note}" for note in notes_of(about))])


HEADER = ("", "compares", "sensors", "order", "formula")


def _cells(about: Residuals) -> list[tuple[str, ...]]:
    return [(r.name, r.origin, ", ".join(r.sensors) or "-", str(r.order), r.text()) for r in about]


def write_table(about: Residuals) -> str:
    """Return one line per residual."""
    return "\n".join(in_columns([HEADER, *_cells(about)]))


def write_markdown(about: Residuals) -> str:
    """Return residuals and notes as Markdown."""
    lines = [in_markdown([f"{r.name} &= {r.latex()}" for r in about]), ""]
    lines += [f"- {line}" for line in [*where_of(about), *notes_of(about)]]
    return "\n".join(lines) + "\n"


def record_of(about: Residuals) -> dict[str, Any]:
    """Return plain data."""
    verdict = about.diagnostic
    return {
        "model": about.graph.name,
        "sensors": list(about.sensors),
        "residuals": [
            {
                "name": r.name,
                "origin": r.origin,
                "formula": r.text(),
                "sensors": list(r.sensors),
                "sources": list(r.sources),
                "order": r.order,
                "silent": list(r.silent),
            }
            for r in about
        ],
        "sources": {
            k.name: k.formula.value
            if isinstance(k.formula, Number)
            else expr_text(about.display.expression(k.formula))
            for k in about.known
            if k.kind == "source"
        },
        "complete": about.complete,
        "unobserved": [{"path": u.path, "where": u.where, "why": u.why} for u in about.unobserved],
        "unused": dict(about.unused),
        "diagnostic_causality": {"exists": verdict.exists},
    }
