"""What a contact compresses, reduced by series and parallel to one spring and one damper."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hybond.analysis.restitution.branches import (
    ONE,
    Branch,
    coefficient,
    harmonic,
    inverse,
    squared,
    times,
    total,
)
from hybond.errors import ModelError
from hybond.model.expressions import Expr, to_text
from hybond.model.graph import FlatGraph


@dataclass(frozen=True, slots=True)
class Squeezed:
    """A network of springs and dampers: a leaf (``kind`` C or R) or parts at a junction."""

    kind: str
    """Spring, damper, parts with one flow, parts with one effort."""
    symbol: Expr = ONE
    """Compliance or resistance of a leaf, seen from the contact."""
    value: float = 0.0
    parts: tuple[Squeezed, ...] = ()

    def __str__(self) -> str:
        if not self.parts:
            return f"{self.kind} = {to_text(self.symbol)}"
        inside = ", ".join(str(p) for p in self.parts)
        return f"{'one flow' if self.kind == '1' else 'one effort'} [{inside}]"


def network(
    graph: FlatGraph, compressed: list[tuple[Branch, Expr, float]], junction: str
) -> Squeezed:
    """Return what the branches of a contact amount to: a spring, or a spring and a damper.

    Parameters
    ----------
    compressed : list of (Branch, gain symbol, gain)
        The massless branches of the contact's junction.

    Raises
    ------
    ModelError
        HB-A202 for a rigid contact; HB-A203 for another network (Maxwell, chains, masses or
        sources within), HB-A204 for a law that is not linear.
    """
    parts = []
    for branch, gain, value in compressed:
        found = _reduced(graph, branch)
        if found == "free":
            raise _no_formula(junction, f"{branch.node.path!r} prescribes the contact's effort")
        if isinstance(found, Squeezed):
            parts.append(_seen_through(found, gain, value))
    if not parts:
        raise ModelError(
            f"nothing gives way at {junction!r}: the contact is rigid",
            code="HB-A202",
            where=junction,
            hint="look for sources of flow between contact and compliance",
        )
    s = _joined("0", parts)
    if s.kind == "C" or (s.kind == "1" and [p.kind for p in s.parts] == ["C", "R"]):
        return s
    if s.kind == "R":
        raise _no_formula(junction, "only a damper is compressed, which gives nothing back")
    raise _no_formula(junction, f"the contact is not a spring in parallel with a damper: {s}")


def _no_formula(where: str, why: str) -> ModelError:
    return ModelError(
        why,
        code="HB-A203",
        where=where,
        hint="equation (14) holds for one spring and one damper with a common flow; use the value "
        "of the integrated contact phase",
    )


def _reduced(graph: FlatGraph, branch: Branch) -> Squeezed | str:
    """Return the network of a branch, ``"free"`` (no effort) or ``"rigid"`` (no flow)."""
    node = branch.node
    if branch.kind in ("C", "R"):
        symbol, value = coefficient(graph, node)
        if value != value:
            raise ModelError(
                f"the law of {node.kind} {node.path!r} is not linear",
                code="HB-A204",
                where=node.path,
                hint="equation (14) needs a constant C and R; give speed= for the value of the "
                "integrated contact phase",
            )
        return Squeezed(branch.kind, symbol, value)
    if branch.kind == "I":
        raise _no_formula(node.path, f"the inertia {node.path!r} moves within what is compressed")
    if branch.kind in ("Se", "Sf"):
        law = node.law
        if not node.is_junction and (law is None or law.matrix is None or law.matrix[0][0]):
            raise _no_formula(node.path, f"the source {node.path!r} acts on what is compressed")
        return "free" if branch.kind == "Se" else "rigid"
    below = [_reduced(graph, c) for c in branch.children]
    if branch.kind == "TF":
        (far,) = below
        return (
            _seen_through(far, branch.gain, branch.gain_value) if isinstance(far, Squeezed) else far
        )
    stops, passes = ("rigid", "free") if branch.kind == "1" else ("free", "rigid")
    if stops in below:
        return stops
    parts = [b for b in below if isinstance(b, Squeezed)]
    return _joined(branch.kind, parts) if parts else passes


def _seen_through(s: Squeezed, gain: Expr, value: float) -> Squeezed:
    """Return a network as it looks from the near side of a transformer."""
    if gain == ONE and value * value == 1.0:
        return s
    if s.parts:
        return Squeezed(s.kind, parts=tuple(_seen_through(p, gain, value) for p in s.parts))
    if s.kind == "C":
        return Squeezed("C", times(s.symbol, squared(gain)), s.value * value**2)
    return Squeezed("R", times(s.symbol, inverse(squared(gain))), s.value / value**2)


def _joined(kind: str, parts: list[Squeezed]) -> Squeezed:
    """Join parts at a junction; like leaves become one, a junction within its like dissolves."""
    flat = [q for p in parts for q in (p.parts if p.kind == kind else (p,))]
    springs = [p for p in flat if p.kind == "C"]
    dampers = [p for p in flat if p.kind == "R"]
    joined = [_leaf("C", springs, add=kind == "0"), _leaf("R", dampers, add=kind == "1")]
    left = [p for p in joined if p is not None]
    left += [p for p in flat if p.kind in ("0", "1")]
    return left[0] if len(left) == 1 else Squeezed(kind, parts=tuple(left))


def _leaf(kind: str, parts: list[Squeezed], *, add: bool) -> Squeezed | None:
    if len(parts) < 2:
        return parts[0] if parts else None
    symbols, values = [p.symbol for p in parts], [p.value for p in parts]
    if add:
        return Squeezed(kind, total(symbols), sum(values))
    # a damper of resistance zero makes the whole zero
    value = 1.0 / sum(1.0 / v if v else math.inf for v in values)
    return Squeezed(kind, harmonic(symbols), value)
