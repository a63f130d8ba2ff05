"""How a `Restitution` shows itself: plain text, Markdown, LaTeX, and the derivation in steps."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hybond.analysis.restitution.restitution import DT, Rebound, Restitution
from hybond.model.expressions import Binary, Expr, Name, Number, names, to_latex, to_text
from hybond.names import in_columns
from hybond.units import format_quantity, parse_unit

_TIME = parse_unit("s")[1]


@dataclass(frozen=True, slots=True)
class Step:
    """One step of the derivation: the paper's equation number, words, the equation twice."""

    number: int
    words: str
    text: str
    latex: str


def derivation(found: Restitution) -> tuple[Step, ...]:
    """Return the paper's steps (7) to (14) with the symbols of the model.

    Empty if there is no formula. `a` is the rate of change of the speed `v` of approach, `q` the
    compression; i is the instant of greatest compression, i-1 impact and i+1 release, one time
    step before and after.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.analysis.restitution.restitution import restitution
    >>> m = hb.Model("drop", domain="translational")
    >>> m.add(ball=hb.I("1 kg", f="-1 m/s"), contact=hb.Zero(), squeeze=hb.One(),
    ...       pad=hb.C("1 mm/N"), damper=hb.R("0.1 N*s/m"))
    >>> m.bond("contact -> ball", "contact -> squeeze -> pad", "squeeze -> damper")
    >>> m.machine("floor", states={"away": [], "touching": ["contact"]}, start="away",
    ...           rules=["away -> touching when ball.f < 0", "touching -> away when contact.e < 0"])
    >>> for step in derivation(restitution(m, "contact")):
    ...     print(f"({step.number})  {step.text}")
    (7)  v(after) = -ε*v(before)
    (8)  ball.I*a(i) = -q(i)/pad.C
    (9)  ball.I*a(i+1) = -damper.R*v(i+1) + ball.I*a(i-1)
    (10)  a(i+1) = damper.R*q(i)/(ball.I*Δt) + a(i-1)
    (11)  a(i+1) = -damper.R*pad.C/Δt*a(i) + a(i-1)
    (12)  (1 + damper.R*pad.C/Δt)*a(i+1) = a(i-1)
    (13)  v(i+1) = (1 + damper.R*pad.C/Δt)^-1*v(i-1)
    (14)  ε = (1 + damper.R*pad.C/Δt)^-1
    """
    if found.formula is None:
        return ()
    c, r, m = found.contact.compliance, found.contact.resistance, found.contact.mass
    resistance: Expr = Number(0.0) if r is None else r
    conductance = isinstance(r, Binary) and r.op == "/" and r.left == Number(1.0)
    ratio = found.formula
    if isinstance(found.formula, Binary) and isinstance(found.formula.left, Binary):
        ratio = found.formula.left.right

    def over(top: Expr, bottom: Expr) -> Expr:
        return Binary("/", top, bottom)

    def times(a: Expr, b: Expr) -> Expr:
        return Binary("*", a, b)

    def damping(flow: Expr) -> Expr:
        if conductance and isinstance(r, Binary):
            return over(flow, r.right)
        return times(resistance, flow)

    def drag(displacement: Expr) -> Expr:
        if conductance and isinstance(r, Binary):
            return over(displacement, times(times(m, r.right), DT))
        return over(times(resistance, displacement), times(m, DT))

    first, mid, last = Name("a_before"), Name("a_mid"), Name("a_last")
    q, v, v0 = Name("q_mid"), Name("v_last"), Name("v_before")
    lossless = r is None
    mean: Expr = Binary("+", Number(1.0), Number(0.0) if lossless else ratio)
    shown: list[tuple[int, str, Expr, Expr, str]] = [
        (7, "Newton's law of collision, whose ε is wanted", Name("v_after"), v0, "-ε*"),
        (
            8,
            "at greatest compression the speed is zero, so only the spring acts (sources are left "
            "out)",
            times(m, mid),
            over(q, c),
            "-",
        ),
        (
            9,
            "just before release the spring is free; damper and sources act, and sources alone "
            "gave the acceleration before contact",
            times(m, last),
            Binary("+", damping(v), times(m, first)),
            "-",
        ),
        (
            10,
            "the compression returns to zero within one time step: v(i+1) = -q(i)/Δt",
            last,
            Binary("+", drag(q), first),
            "",
        ),
        (
            11,
            "the greatest compression from (8): q(i) = -C*m*a(i)",
            last,
            Binary("+", times(ratio, mid), first),
            "-",
        ),
        (
            12,
            "compression and decompression are taken as mirror images: a(i) = a(i+1)",
            times(mean, last),
            first,
            "",
        ),
        (13, "each acceleration acts for one time step: v = a*Δt", v, times(found.formula, v0), ""),
        (14, "compared with (7)", Name("ε"), found.formula, ""),
    ]
    if lossless:
        shown = [shown[0], shown[1], shown[-1]]
    return tuple(
        Step(
            number,
            words,
            _in_words(f"{to_text(left)} = {sign}{to_text(right)}"),
            _in_symbols(f"{to_latex(left)} = {_latex_sign(sign)}{to_latex(right)}"),
        )
        for number, words, left, right, sign in shown
    )


_WORDS = {
    "v_after": "v(after)",
    "a_before": "a(i-1)",
    "a_mid": "a(i)",
    "a_last": "a(i+1)",
    "q_mid": "q(i)",
    "v_last": "v(i+1)",
}
_INDEX = {"before": "i-1", "mid": "i", "last": "i+1", "after": "+"}


def _in_words(text: str) -> str:
    for mark, word in _WORDS.items():
        text = text.replace(mark, word)
    return text.replace("v_before", "v(before)" if "ε*" in text else "v(i-1)")


def _latex_sign(sign: str) -> str:
    return sign.replace("ε*", r"\varepsilon \, ")


def _in_symbols(text: str) -> str:
    if "mathrm{after}" in text:
        return r"v^{+} = -\varepsilon \, v^{-}"
    for mark, index in _INDEX.items():
        text = text.replace(rf"_{{\mathrm{{{mark}}}}}", f"_{{{index}}}")
    return (
        text.replace(r"\mathrm{ε}", r"\varepsilon")
        .replace("ε", r"\varepsilon")
        .replace(r"\mathrm{Δt}", r"\Delta t")
    )


def formula_latex(formula: Expr) -> str:
    r"""Return ``\varepsilon = ...`` in LaTeX's math mode."""
    return _in_symbols(rf"\varepsilon = {to_latex(formula)}")


def warning(found: Restitution) -> str:
    """Return the warning that the formula's value depends on the time step, with values."""
    assert found.value is not None
    if found.contact.resistance is None:
        return "Nothing dissipates in this contact: all comes back, whatever the time step."
    others = ", ".join(
        f"{found.at(dt):.6g} at {format_quantity(dt, 's')}" for dt in (10 * found.dt, found.dt / 10)
    )
    return (
        f"The formula depends on the time step: {found.value:.6g} at "
        f"{format_quantity(found.dt, 's')}, {others}. It is no property of the contact."
    )


_METHODS = ("contact ends at", "sources", "impact speed", "method", "restitution", "contact time")


def _row(r: Rebound, unit: str) -> tuple[str, ...]:
    endless = math.isinf(r.duration)
    return (
        {"release": "zero force", "zero compression": "zero compression"}[r.ends],
        "act" if r.sources else "left out",
        "any" if r.speed is None else f"{r.speed:.6g} {unit}".rstrip(),
        r.method,
        "0 (no end)" if endless else f"{r.value:.6f}",
        "" if endless else format_quantity(r.duration, "s"),
    )


def _about(found: Restitution) -> list[str]:
    c = found.contact

    def value(number: float, which: str) -> str:
        effort, flow = c.domain.effort, c.domain.flow
        if effort is None or flow is None:
            return f"{number:.6g}"
        unit = {"m": effort * _TIME / flow, "C": flow * _TIME / effort, "R": effort / flow}[which]
        return format_quantity(number, unit)

    masses = " and ".join(", ".join(b.inertias) for b in c.bodies)
    lines = [
        f"collides: {masses}; mass {to_text(c.mass)} = {value(c.mass_value, 'm')}",
        f"compressed: {', '.join(c.springs + c.dampers)}",
    ]
    if c.refusal is None:
        compliance, resistance = c.values
        lines.append(f"C = {to_text(c.compliance)} = {value(compliance, 'C')}")
        if c.resistance is not None:
            lines.append(f"R = {to_text(c.resistance)} = {value(resistance, 'R')}")
    return lines


def plain(found: Restitution) -> str:
    """Return a restitution as plain text."""
    lines = [f"Restitution at {found.contact.junction} of: {found.title}"]
    lines += [f"  {line}" for line in _about(found)]
    lines.append("")
    if found.formula is None or found.value is None:
        assert found.refusal is not None
        lines.append(f"No formula ({found.refusal.code}): {found.refusal.why}")
    else:
        lines.append("Margetts & Ngwompo, equation (14)")
        shown = f" = {found.value:.6f}" if names(found.formula) else ""
        lines.append(f"  ε = {to_text(found.formula)}{shown}")
        lines.append(f"  {warning(found)}")
    lines += ["", "Contact phase integrated (no time step)"]
    rows = [_METHODS, *(_row(r, found.contact.domain.flow_unit) for r in found.rebounds)]
    lines += [f"  {line}" for line in in_columns(rows)]
    lines += [f"  note: {note}" for note in found.notes]
    steps = derivation(found)
    if steps:
        lines += ["", "Derivation (the paper's equation numbers)"]
        lines += [f"  ({s.number:>2}) {s.text:<48}  {s.words}".rstrip() for s in steps]
    return "\n".join(lines)


def markdown(found: Restitution) -> str:
    """Return a restitution as Markdown with LaTeX formulas."""
    lines = [f"**Restitution at `{found.contact.junction}`** of: {found.title}", ""]
    lines += [f"- {line}" for line in _about(found)]
    lines.append("")
    if found.formula is None or found.value is None:
        assert found.refusal is not None
        lines.append(f"No formula ({found.refusal.code}): {found.refusal.why}")
    else:
        shown = f" = {found.value:.6f}" if names(found.formula) else ""
        lines += [f"$${formula_latex(found.formula)}{shown}$$", "", warning(found)]
    lines += ["", "| " + " | ".join(_METHODS) + " |", "|" + " --- |" * len(_METHODS)]
    lines += [
        "| " + " | ".join(_row(r, found.contact.domain.flow_unit)) + " |" for r in found.rebounds
    ]
    lines += [""] + [f"- {note}" for note in found.notes]
    for s in derivation(found):
        lines += ["", f"({s.number}) {s.words}:", "", f"$${s.latex}$$"]
    return "\n".join(lines)
