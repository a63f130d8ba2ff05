"""The contact at a controlled junction: what collides, and what is compressed between.

A compliant contact is a controlled 0-junction: OFF it carries no force, ON its flows balance.
Inertias behind it collide; a network of compliances and resistances behind it is compressed.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from hybond.analysis.restitution.branches import (
    MASS,
    WALL,
    Branch,
    Lead,
    blow,
    branches_at,
    harmonic,
    inverse,
    lead,
    pull,
    squared,
    times,
)
from hybond.analysis.restitution.compression import Squeezed, network
from hybond.errors import ModelError
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Machine, Mode
from hybond.names import did_you_mean
from hybond.units import Domain


@dataclass(frozen=True, slots=True)
class Body:
    """A part of the model that collides as one mass, seen from the contact."""

    inertias: tuple[str, ...]
    """The inertias that a blow at the contact sets in motion."""
    mass: Expr
    """Their mass at the contact, transformers included."""
    value: float
    """Its value, SI."""
    pull: float | None
    """Effort of its constant sources at the contact (against the body's motion); None if there are
    others."""
    others: tuple[str, ...]
    """Springs, dampers and sources of flow on the body: a blow does not move them."""
    branch: Branch = field(repr=False)
    gain: float = field(repr=False)
    """`branch` and `gain`: where it hangs on the contact."""


@dataclass(frozen=True, slots=True)
class Contact:
    """What collides at a junction and what is compressed.

    Parameters
    ----------
    junction : str
    node : int
    machine : str
        The machine that switches the junction.
    state : str
        The machine's state in which it is ON.
    mode : Mode
        The mode of the contact phase.
    bodies : tuple of Body
    mass : Expr
        The reduced mass of the bodies, ``m1*m2/(m1 + m2)`` for two.
    mass_value : float
    springs, dampers : tuple of str
        The elements that are compressed.
    squeezed : Squeezed or None
        Their network, reduced; None if it is not linear.
    refusal : ModelError or None
        Why there is no compliance and resistance for a formula.
    domain : Domain
        Of the junction, for units.
    behind, walls
        Branches with their gains: those that are compressed, those that do not move.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.analysis.restitution.contact import find_contact
    >>> m = hb.Model("drop", domain="translational", parameters={"m": "1 kg"})
    >>> m.add(ball=hb.I("m", f="-1 m/s"), v=hb.One(), contact=hb.Zero(), squeeze=hb.One(),
    ...       pad=hb.C("1 mm/N"), damper=hb.R("0.1 N*s/m"))
    >>> m.bond("contact -> v -> ball", "contact -> squeeze -> pad", "squeeze -> damper")
    >>> m.machine("floor", states={"away": [], "touching": ["contact"]}, start="away",
    ...           rules=["away -> touching when v.f < 0", "touching -> away when contact.e < 0"])
    >>> contact = find_contact(m.flatten(), "contact")
    >>> print(contact.mass, contact.compliance, contact.resistance)
    m pad.C damper.R
    >>> print(contact.squeezed)
    one flow [C = pad.C, R = damper.R]
    """

    junction: str
    node: int
    machine: str
    state: str
    mode: Mode
    bodies: tuple[Body, ...]
    mass: Expr
    mass_value: float
    springs: tuple[str, ...]
    dampers: tuple[str, ...]
    squeezed: Squeezed | None
    refusal: ModelError | None
    domain: Domain = field(repr=False)
    behind: tuple[tuple[Branch, float], ...] = field(repr=False)
    walls: tuple[tuple[Branch, float], ...] = field(repr=False)

    @property
    def compliance(self) -> Expr:
        """The compliance C of a Kelvin-Voigt contact."""
        return self._part("C").symbol

    @property
    def resistance(self) -> Expr | None:
        """The bond-graph resistance R of a Kelvin-Voigt contact; None if nothing dissipates."""
        return None if self._spring_alone() else self._part("R").symbol

    @property
    def values(self) -> tuple[float, float]:
        """The values of C and R, SI."""
        return self._part("C").value, 0.0 if self._spring_alone() else self._part("R").value

    def _spring_alone(self) -> bool:
        return self.squeezed is not None and self.squeezed.kind == "C"

    def _part(self, kind: str) -> Squeezed:
        s = self.squeezed
        if self.refusal is not None or s is None:
            raise self.refusal or AssertionError("a contact without network has a refusal")
        return s if s.kind == kind else next(p for p in s.parts if p.kind == kind)

    @property
    def others(self) -> tuple[str, ...]:
        """Springs and dampers on the bodies, which closed forms leave out."""
        return tuple(name for body in self.bodies for name in body.others)

    def approach(self, graph: FlatGraph, closing: float) -> dict[int, float]:
        """Return the flow of each inertia, by node, in an approach that a blow could stop.

        The bodies approach at the speed `closing` (positive: the effort of the junction becomes
        positive), with no common momentum; a single body has all of the speed.
        """
        found: dict[int, float] = {}
        for body in self.bodies:
            share = self.mass_value / body.value
            found |= blow(graph, body.branch, -closing * share / body.gain)
        return found


def find_contact(graph: FlatGraph, junction: str, *, state: str | None = None) -> Contact:
    """Return the contact at a controlled 0-junction.

    Parameters
    ----------
    junction : str
        Dotted path of the junction, or of a switched C or R.
    state : str
        The state of its machine that makes contact, if several switch it ON. Other machines are
        in their start state.

    Raises
    ------
    ModelError
        HB-A201 if the name is not that of a controlled 0-junction; HB-A202 if nothing collides
        there or nothing is compressed; HB-A205 for a structure that is not a tree of masses,
        springs, dampers and constant transformers.
    """
    node, machine, k = _switch(graph, junction, state)
    mode = tuple(k if m.index == machine.index else m.start for m in graph.machines)
    bodies, behind, walls = [], [], []
    compressed: list[tuple[Branch, Expr, float]] = []
    for branch, gain, value in branches_at(graph, node, mode):
        first = lead(graph, branch)
        if first.order == MASS:
            bodies.append(_body(graph, branch, gain, value, first))
        elif first.order == WALL:
            walls.append((branch, value))
        else:
            behind.append((branch, value))
            compressed.append((branch, gain, value))
    if not bodies:
        raise ModelError(
            f"nothing collides at {junction!r}: no inertia is rigidly behind it",
            code="HB-A202",
            where=junction,
            hint="restitution needs a mass that the contact force acts on",
        )
    if not compressed:
        raise ModelError(
            f"nothing is compressed at {junction!r}: the contact is rigid",
            code="HB-A202",
            where=junction,
            hint="attach a compliance and a resistance to the junction, or state a restitution",
        )
    inside = [b for branch, _ in behind for b in branch.walk()]
    squeezed, refusal = None, None
    try:
        squeezed = network(graph, compressed, junction)
    except ModelError as error:
        refusal = error
    return Contact(
        graph.nodes[node].path,
        node,
        machine.path,
        machine.states[k],
        mode,
        tuple(bodies),
        harmonic([b.mass for b in bodies]),
        1.0 / sum(1.0 / b.value for b in bodies),
        tuple(b.node.path for b in inside if b.kind == "C"),
        tuple(b.node.path for b in inside if b.kind == "R"),
        squeezed,
        refusal,
        graph.nodes[node].domain,
        tuple(behind),
        tuple(walls),
    )


def _switch(graph: FlatGraph, junction: str, state: str | None) -> tuple[int, Machine, int]:
    index = graph.by_path.get(junction)
    controlled = [n.path for n in graph.nodes if n.controlled and n.kind == "0"]
    hint = did_you_mean(junction, controlled) or "the model has no controlled 0-junction"
    if index is not None and not graph.nodes[index].is_junction:
        index = graph.by_path.get(f"{junction}.switch", index)
    if index is None:
        raise ModelError(
            f"there is no junction {junction!r}", code="HB-A201", where=junction, hint=hint
        )
    node = graph.nodes[index]
    machine = None if node.machine is None else graph.machines[node.machine]
    if machine is None or node.kind != "0":
        what = f"{node.kind}-junction" if node.is_junction else node.kind
        raise ModelError(
            f"{junction!r} is {'an uncontrolled' if machine is None else 'a controlled'} {what}; "
            "a contact is a controlled 0-junction, which carries no force while it is OFF",
            code="HB-A201",
            where=junction,
            hint=hint,
        )
    making = [
        k
        for k, on in enumerate(machine.on)
        if index in on and not (machine.fieldless and machine.fieldless[k])
    ]
    named = [k for k in making if state in (None, machine.states[k])]
    if not named:
        raise ModelError(
            f"the machine {machine.path!r} has no state {state!r} of contact"
            if making and state
            else f"no state of the machine {machine.path!r} keeps {junction!r} ON for a while",
            code="HB-A201" if making else "HB-A202",
            where=junction,
            hint=did_you_mean(state or "", [machine.states[k] for k in making])
            or "a state that makes contact by an impact law has no contact phase to look at",
        )
    return index, machine, named[0]


def _body(graph: FlatGraph, branch: Branch, gain: Expr, value: float, first: Lead) -> Body:
    scale = inverse(squared(gain))
    moved = blow(graph, branch, 1.0)
    below = list(branch.walk())
    return Body(
        tuple(graph.nodes[k].path for k, f in moved.items() if f),
        times(first.coefficient, scale),
        first.value / value**2,
        None if (found := pull(branch)) is None else found / value,
        tuple(
            b.node.path
            for b in below
            if b.kind in ("C", "R", "Sf") or (b.kind == "I" and not moved.get(b.node.index))
        ),
        branch,
        value,
    )
