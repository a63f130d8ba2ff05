"""A coefficient of restitution from the compliance and resistance of a contact.

Margetts & Ngwompo, in their paper on the bouncing ball as a causally dynamic hybrid bond graph,
derive ``epsilon = (1 + R*C/dt)^-1`` (equation 14) from the state equations of the contact mode.
It depends on the time step dt. The contact phase itself, integrated, gives a value that does
not; `restitution` shows both.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from hybond.analysis.restitution.contact import Contact, find_contact
from hybond.analysis.restitution.contact_phase import compressive_sign, is_linear, simulated_phase
from hybond.analysis.restitution.half_period import (
    ENDS,
    Ends,
    Phase,
    half_period,
    loaded_half_period,
)
from hybond.calls import called
from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.expressions import Binary, Expr, Name, Number, to_text
from hybond.model.given import check_model
from hybond.model.graph import FlatGraph
from hybond.model.parts import Value
from hybond.units import parse_unit, try_quantity

DT = Name("Δt")
_ONE = Number(1.0)


@dataclass(frozen=True, slots=True)
class Rebound:
    """A restitution found by integrating the contact phase."""

    ends: Ends
    """When contact ends: the force, or the compression, is back at zero."""
    method: Literal["closed form", "simulation"]
    sources: bool
    """Whether sources act (weight); then the value depends on the speed of impact."""
    speed: float | None
    """Speed of impact, SI; None if the value is the same for all."""
    value: float
    """0 if the contact never ends."""
    duration: float
    """Of the contact phase, s; infinite if it never ends."""


@dataclass(frozen=True, slots=True)
class Restitution:
    """The restitution of a contact: the paper's formula and the integrated contact phase.

    Shows itself as text, in a notebook as Markdown with formulas.

    Parameters
    ----------
    title : str
        The model's title.
    contact : Contact
    dt : float
        The time step of the formula, s.
    formula : Expr or None
        ``(1 + R*C/Δt)^-1`` in the model's own symbols.
    value : float or None
        Its value at `dt`.
    refusal : HybondError or None
        Why there is no formula.
    rebounds : tuple of Rebound
        Values that do not depend on a time step.
    notes : tuple of str
        What was left out, and why.
    """

    title: str
    contact: Contact
    dt: float
    formula: Expr | None
    value: float | None
    refusal: HybondError | None
    rebounds: tuple[Rebound, ...]
    notes: tuple[str, ...]

    def at(self, dt: float) -> float:
        """Return the formula's value at another time step.

        Raises
        ------
        ModelError
            If there is no formula.
        """
        return paper_value(self.contact, dt)

    def rebound(
        self,
        ends: Ends = "release",
        *,
        method: Literal["closed form", "simulation"] | None = None,
        sources: bool = False,
    ) -> Rebound | None:
        """Return one of the integrated values (the first that fits), or None."""
        for r in self.rebounds:
            if r.ends == ends and r.sources == sources and method in (None, r.method):
                return r
        return None

    def text(self) -> str:
        """Return formula, values and derivation as plain text."""
        from hybond.analysis.restitution.report import plain

        return plain(self)

    def markdown(self) -> str:
        """Return formula, values and derivation as Markdown with LaTeX formulas."""
        from hybond.analysis.restitution.report import markdown

        return markdown(self)

    def latex(self) -> str:
        """Return the formula in LaTeX's math mode; empty if there is none."""
        from hybond.analysis.restitution.report import formula_latex

        return "" if self.formula is None else formula_latex(self.formula)

    def record(self) -> dict[str, Any]:
        """Return everything as plain data for JSON; infinite durations are None."""
        c = self.contact
        return {
            "junction": c.junction,
            "machine": c.machine,
            "state": c.state,
            "bodies": [
                {"inertias": list(b.inertias), "mass": to_text(b.mass), "value": b.value}
                for b in c.bodies
            ],
            "mass": {"formula": to_text(c.mass), "value": c.mass_value},
            "springs": list(c.springs),
            "dampers": list(c.dampers),
            "dt": self.dt,
            "formula": None if self.formula is None else to_text(self.formula),
            "latex": self.latex() or None,
            "value": self.value,
            "refusal": None if self.refusal is None else self.refusal.to_dict(),
            "integrated": [
                {
                    "ends": r.ends,
                    "method": r.method,
                    "sources": r.sources,
                    "speed": r.speed,
                    "value": r.value,
                    "duration": r.duration if math.isfinite(r.duration) else None,
                }
                for r in self.rebounds
            ],
            "notes": list(self.notes),
        }

    def __str__(self) -> str:
        return self.text()

    def _repr_markdown_(self) -> str:
        return self.markdown()


@called('hb.restitution(model, "contact")')
def restitution(
    model: Model | FlatGraph,
    junction: str,
    *,
    dt: float | str = "1 ms",
    speed: float | str | None = None,
    state: str | None = None,
    parameters: Mapping[str, Value] | None = None,
    solver: str | None = None,
) -> Restitution:
    """Return the coefficient of restitution that a compliant contact amounts to.

    Parameters
    ----------
    model : Model or FlatGraph
    junction : str
        The controlled 0-junction of the contact.
    dt : float or str
        The time step of equation (14), s or a quantity.
    speed : float or str, optional
        Speed of impact, SI or a quantity. Needed where the value depends on it: with sources
        (weight), and for laws that are not linear.
    state : str, optional
        The state that makes contact, if several do.
    parameters : mapping
        Values by dotted path that replace the model's own.
    solver : str, optional
        Of the simulated contact phase; chosen by its stiffness.

    Raises
    ------
    ModelError
        HB-A201, HB-A202 or HB-A205 if there is no contact that could be analysed. A missing
        formula alone (HB-A203, HB-A204) is not raised but reported, as `Restitution.refusal`.
    UsageError
        HB-A207 for a time step or speed that is not positive.

    References
    ----------
    Margetts & Ngwompo, equations (7) to (14).

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.analysis.restitution.restitution import restitution
    >>> m = hb.Model("drop", domain="translational", parameters={"m": "1 kg"})
    >>> m.add(ball=hb.I("m", f="-1 m/s"), v=hb.One(), contact=hb.Zero(), squeeze=hb.One(),
    ...       pad=hb.C("1 mm/N"), damper=hb.G("10 m/(N*s)"))
    >>> m.bond("contact -> v -> ball", "contact -> squeeze -> pad", "squeeze -> damper")
    >>> m.machine("floor", states={"away": [], "touching": ["contact"]}, start="away",
    ...           rules=["away -> touching when v.f < 0", "touching -> away when contact.e < 0"])
    >>> found = restitution(m, "contact", dt="1 ms")
    >>> print(found.formula)
    (1 + pad.C/(damper.G*Δt))^-1
    >>> round(found.value, 6)
    0.909091
    >>> round(found.rebound("zero compression").value, 6)
    0.995045
    """
    check_model(model)
    graph = model.flatten(parameters=parameters) if isinstance(model, Model) else model
    step = _positive(dt, "s", "dt")
    contact = find_contact(graph, junction, state=state)
    unit = graph.nodes[contact.node].domain.flow_unit or "1"
    given = None if speed is None else _positive(speed, unit, "speed")
    formula, value, refusal = None, None, contact.refusal
    if refusal is None:
        formula, value = paper_formula(contact), paper_value(contact, step)
    rebounds, notes = _integrated(graph, contact, given, solver)
    return Restitution(
        graph.title or graph.name,
        contact,
        step,
        formula,
        value,
        refusal,
        tuple(rebounds),
        tuple(notes),
    )


def paper_formula(contact: Contact) -> Expr:
    """Return equation (14) in the model's symbols: ``(1 + R*C/Δt)^-1``.

    For a conductance it reads ``(1 + C/(G*Δt))^-1``, as the paper's R is flow per effort.

    Raises
    ------
    ModelError
        HB-A203 if the contact is not a spring in parallel with a damper, HB-A204 if a law is not
        linear.
    """
    c, r = contact.compliance, contact.resistance
    if r is None:
        return _ONE
    if isinstance(r, Binary) and r.op == "/" and r.left == _ONE:
        ratio = Binary("/", c, Binary("*", r.right, DT))
    else:
        ratio = Binary("/", Binary("*", r, c), DT)
    return Binary("^", Binary("+", _ONE, ratio), Number(-1.0))


def paper_value(contact: Contact, dt: float) -> float:
    """Return the value of equation (14) at a time step.

    Raises
    ------
    ModelError
        As `paper_formula`.
    """
    c, r = contact.values
    return 1.0 / (1.0 + r * c / dt)


def _integrated(
    graph: FlatGraph, contact: Contact, speed: float | None, solver: str | None
) -> tuple[list[Rebound], list[str]]:
    rebounds: list[Rebound] = []
    notes: list[str] = []
    linear = is_linear(graph, contact.mode)
    votes = compressive_sign(graph, contact)
    sign = votes or 1
    loads = _acting(graph)
    if contact.others:
        notes.append(
            f"no closed form: {', '.join(contact.others)} stay on the bodies during contact"
        )
    if not linear and speed is None:
        notes.append("the laws are not linear: give speed= for the integrated contact phase")
        return rebounds, notes
    if not votes and (loads or not linear):
        notes.append(
            f"the rules of {contact.machine!r} do not tell which way the contact pushes; "
            "a positive effort of the junction is taken as pressure"
        )
    for sources in (False, True):
        if sources and not loads:
            continue
        if sources and speed is None:
            notes.append(
                f"with {', '.join(loads)} the value depends on the speed of impact: give speed="
            )
            continue
        at = speed if sources or not linear else None
        if sources and contact.refusal is None and any(b.pull is None for b in contact.bodies):
            notes.append(f"no closed form with {', '.join(loads)}: they do not act on one mass")
        for ends in ENDS:
            if contact.refusal is None and not contact.others:
                phase = _closed(contact, ends, speed=speed if sources else None, sign=sign)
                if phase is not None:
                    rebounds.append(_rebound(ends, "closed form", sources, at, phase))
            try:
                phase = simulated_phase(
                    graph,
                    contact,
                    ends=ends,
                    speed=speed or 1.0,
                    loads=sources,
                    sign=sign,
                    solver=solver,
                )
            except HybondError as error:
                notes.append(f"no simulated value ({ends}): {error.why} ({error.code})")
                continue
            rebounds.append(_rebound(ends, "simulation", sources, at, phase))
    return rebounds, notes


def _rebound(
    ends: Ends,
    method: Literal["closed form", "simulation"],
    sources: bool,
    speed: float | None,
    phase: Phase,
) -> Rebound:
    return Rebound(ends, method, sources, speed, phase.value, phase.duration)


def _closed(contact: Contact, ends: Ends, *, speed: float | None, sign: int) -> Phase | None:
    c, r = contact.values
    if speed is None:
        return half_period(contact.mass_value, c, r, ends=ends)
    pull = 0.0
    for body in contact.bodies:
        if body.pull is None:
            return None
        pull += sign * body.pull / body.value
    return loaded_half_period(contact.mass_value, c, r, ends=ends, speed=speed, pull=pull)


def _acting(graph: FlatGraph) -> list[str]:
    """Return the sources that are not zero."""
    return [
        n.path
        for n in graph.nodes
        if n.kind in ("Se", "Sf")
        and n.law is not None
        and (n.law.matrix is None or n.law.matrix[0][0] != 0.0)
    ]


def _positive(value: float | str, unit: str, where: str) -> float:
    """Return a positive SI number from a number or a quantity in `unit`."""
    number: float | None = None
    if isinstance(value, int | float) and not isinstance(value, bool):
        number = float(value)
    elif isinstance(value, str):
        quantity = try_quantity(value)
        if quantity is not None and quantity.dimension in (parse_unit(unit)[1], parse_unit("1")[1]):
            number = quantity.value
    if number is None or not 0.0 < number < math.inf:
        raise UsageError(
            f"{where} = {value!r} is not a positive quantity in {unit}",
            code="HB-A207",
            where=where,
            hint=f'write {where}=0.001 or {where}="1 {unit}"',
        )
    return number
