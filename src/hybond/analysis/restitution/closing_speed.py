"""The speed at which a contact closes, as text in the model's own names.

An impact law reads it before the jump, so it is made of what is stored (velocities of inertias)
and of what is constant (moduli, walls at constant speed).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from hybond.analysis.restitution.branches import Branch, coefficient
from hybond.analysis.restitution.contact import Contact
from hybond.errors import ModelError
from hybond.model.expressions import Name, to_text
from hybond.model.graph import FlatGraph
from hybond.units import DIMENSIONLESS, try_quantity


def cannot(why: str, where: str, hint: str) -> ModelError:
    """Return the refusal of a contact that no impact law can replace."""
    return ModelError(why, code="HB-A206", where=where, hint=hint)


@dataclass(frozen=True, slots=True)
class _Term:
    """``sign * text``, a part of the closing speed."""

    sign: int
    text: str


def closing_speed(graph: FlatGraph, contact: Contact) -> tuple[str, bool]:
    """Return the flow out of the contact's junction as text, and whether it is turned around.

    What flows out of the bodies is compressed: the sum of their flows into the contact.

    Raises
    ------
    ModelError
        HB-A206 if it is not made of stored quantities and constants.
    """
    terms: list[_Term] = []
    for branch, gain in [(b.branch, b.gain) for b in contact.bodies] + list(contact.walls):
        for term in _flow(graph, branch):
            factor = "" if abs(gain) == 1.0 else f"{abs(gain)!r}*"
            terms.append(_Term(-term.sign * (1 if gain > 0 else -1), factor + term.text))
    turned = not any(t.sign > 0 for t in terms)
    if turned:
        terms = [replace(t, sign=-t.sign) for t in terms]
    terms.sort(key=lambda t: -t.sign)
    first, *rest = terms
    return first.text + "".join(f" {'+' if t.sign > 0 else '-'} {t.text}" for t in rest), turned


def _flow(graph: FlatGraph, branch: Branch) -> list[_Term]:
    """Return the flow into a branch, in terms of what is stored or constant."""
    node = branch.node
    if branch.kind == "I":
        return [_Term(branch.sign, f"{node.path}.f")]
    if branch.kind == "Sf":
        return _wall(branch)
    if branch.kind == "1":
        if not node.controlled and any(c.kind == "I" for c in branch.children):
            return [_Term(branch.sign, f"{node.path}.f")]
        for child in branch.children:
            if any(b.kind in ("I", "Sf") for b in child.walk()):
                return [
                    replace(t, sign=t.sign * child.sign * branch.sign) for t in _flow(graph, child)
                ]
    if branch.kind == "TF":
        far = _flow(graph, branch.children[0])
        # near flow = gain * far flow; entered by port 2 the gain is the modulus
        modulus = _modulus(graph, branch)
        symbol = to_text(branch.gain)
        times = symbol == to_text(coefficient(graph, node)[0])
        return [
            replace(t, text=f"{modulus}*{t.text}" if times else f"{t.text}/{modulus}") for t in far
        ]
    if branch.kind == "0" and all(
        any(b.kind in ("I", "Sf") for b in c.walk()) for c in branch.children
    ):
        return [t for c in branch.children for t in _flow(graph, c)]
    raise cannot(
        f"the speed of {node.path!r} is not given by stored momentum alone",
        node.path,
        "an impact law needs the velocities before impact",
    )


def _modulus(graph: FlatGraph, branch: Branch) -> str:
    """Return a constant modulus as it can be written in an expression."""
    symbol, value = coefficient(graph, branch.node)
    plain = isinstance(symbol, Name) and symbol.path == f"{branch.node.path}.m"
    if plain:
        return _constant(branch.node.label, value)
    return f"({to_text(symbol)})"


def _constant(label: str, value: float) -> str:
    """Return a value as it can stand in an expression, with the unit it was written with."""
    quantity = try_quantity(label)
    if quantity is None:
        return f"({label})" if label else f"({value!r})"
    unit = "" if quantity.dimension == DIMENSIONLESS else f" [{quantity.dimension}]"
    return f"({quantity.value!r}{unit})"


def _wall(branch: Branch) -> list[_Term]:
    node = branch.node
    if node.is_junction:
        return []
    if node.law is None or node.law.matrix is None:
        raise cannot(
            f"the speed of {node.path!r} is not constant",
            node.path,
            "an impact law needs the velocities before impact",
        )
    if node.law.matrix[0][0] == 0.0:
        return []
    return [_Term(branch.sign, _constant(node.label, node.law.matrix[0][0]))]
