"""What hangs on a junction in one mode: a tree of branches, and how each answers a blow.

Efforts and flows are those *into* a branch: for the bond that leads into it, the effort of the
bond and ``sign`` times its flow, ``sign`` being +1 if the half arrow points into the branch.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from hybond.errors import HybondError, ModelError
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Number,
    compile_expression,
    names,
    parse,
    simplify,
    substitute,
)
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.hierarchy import without_units
from hybond.names import join
from hybond.units import try_quantity

ONE = Number(1.0)
LETTER = {"C": "C", "I": "I", "R": "R", "G": "G", "TF": "m"}
FREE, SPRING, DAMPER, MASS, WALL = -9, -1, 0, 1, 9
"""Powers of s in the leading term of an impedance: what a branch is to a sudden flow."""


@dataclass(frozen=True, slots=True)
class Branch:
    """A node entered through a bond, and the branches behind it.

    `gain` is 1 except for a transformer, where it is the effort of the far side per effort of
    the near side (and the near flow per far flow).
    """

    node: Node
    kind: str
    bond: int
    sign: int
    children: tuple[Branch, ...] = ()
    gain: Expr = ONE
    gain_value: float = 1.0

    def walk(self) -> Iterator[Branch]:
        """Yield this branch and all behind it."""
        yield self
        for child in self.children:
            yield from child.walk()


@dataclass(frozen=True, slots=True)
class Lead:
    """The leading term of an impedance for fast changes, ``coefficient * s^order``."""

    order: int
    coefficient: Expr = ONE
    value: float = 1.0


def branches_at(graph: FlatGraph, junction: int, mode: Mode) -> list[tuple[Branch, Expr, float]]:
    """Return the branches of a 0-junction in `mode`, with the gain from the junction to each.

    The value of a gain may be negative; its symbol leaves the sign out.

    Junctions that pass its effort on (0-junctions next to it, transformers between, 1-junctions
    with two bonds) are opened: their branches are its own.

    Raises
    ------
    ModelError
        HB-A205 for a loop, a gyrator, a field or a modulated transformer.
    """
    found: list[tuple[Branch, Expr, float]] = []
    for branch in trees_at(graph, junction, mode):
        _open(branch, ONE, 1.0, found)
    return found


def trees_at(graph: FlatGraph, junction: int, mode: Mode) -> list[Branch]:
    """Return the branches on a junction's own bonds, nothing opened.

    Raises
    ------
    ModelError
        As `branches_at`.
    """
    off = graph.off_nodes(mode)
    seen = {junction}
    found = []
    for end in graph.nodes[junction].ends:
        bond = graph.bonds[end.bond]
        far = bond.head if bond.tail == junction else bond.tail
        found.append(_branch(graph, far, end.bond, off, seen))
    return found


def opens(branch: Branch) -> bool:
    """Whether a branch passes the effort of the junction before it on."""
    return branch.kind in ("0", "TF") or (branch.kind, len(branch.children)) == ("1", 1)


def _open(
    branch: Branch, gain: Expr, value: float, found: list[tuple[Branch, Expr, float]]
) -> None:
    if not opens(branch):
        found.append((branch, gain, value))
        return
    for child in branch.children:
        # a 1-junction with two bonds may turn the signs of effort and flow, not their ratio
        turn = child.sign * branch.sign if branch.kind == "1" else 1
        _open(child, times(gain, branch.gain), turn * value * branch.gain_value, found)


def _branch(graph: FlatGraph, index: int, bond: int, off: frozenset[int], seen: set[int]) -> Branch:
    node = graph.nodes[index]
    end = next(e for e in node.ends if e.bond == bond)
    if index in seen:
        raise structure(node, f"a loop of bonds leads back to {node.path!r}")
    seen.add(index)
    if node.is_junction and index in off:
        return Branch(node, "Se" if node.kind == "0" else "Sf", bond, end.sign)
    if node.kind == "GY":
        raise structure(node, f"the gyrator {node.path!r} turns inertia into compliance")
    if not node.is_junction and node.kind != "TF":
        if len(node.ends) > 1:
            raise structure(node, f"{node.kind} {node.path!r} is a field of {len(node.ends)} ports")
        return Branch(node, "R" if node.kind == "G" else node.kind, bond, end.sign)
    gain: Expr = ONE
    value = 1.0
    if node.kind == "TF":
        gain, value = _gain(graph, node, end.port, index in off)
    below = []
    for other in node.ends:
        if other.bond != bond:
            link = graph.bonds[other.bond]
            far = link.head if link.tail == index else link.tail
            below.append(_branch(graph, far, other.bond, off, seen))
    return Branch(node, node.kind, bond, end.sign, tuple(below), gain, value)


def _gain(graph: FlatGraph, node: Node, port: int, off: bool) -> tuple[Expr, float]:
    modulus, value = coefficient(graph, node)
    if off or value == 0.0:
        raise structure(node, f"the modulus of {node.path!r} is zero")
    if value != value:
        raise structure(node, f"the transformer {node.path!r} is modulated")
    return (modulus, value) if port == 1 else (inverse(modulus), 1.0 / value)


def structure(node: Node, why: str) -> ModelError:
    """Return the refusal of a contact that is not a tree of simple elements."""
    return ModelError(
        why,
        code="HB-A205",
        where=node.path,
        hint="restitution is derived for masses, springs and dampers on a tree of junctions and "
        "constant transformers",
    )


# -- coefficients


def coefficient(graph: FlatGraph, node: Node) -> tuple[Expr, float]:
    """Return a linear element's C, I, R or modulus: as a symbol, and its value (NaN: not linear).

    The symbol is what the element says, if that is made of parameters, else ``element.C``. A
    conductance gives ``1/G``.
    """
    law = node.law
    if law is None or law.matrix is None or len(law.matrix) != 1:
        return Name(f"{node.path}.{LETTER[node.kind]}"), math.nan
    m = law.matrix[0][0]
    flipped = node.kind in ("C", "I") or (node.kind in ("R", "G") and law.output == "f")
    if flipped and m == 0.0:
        return Name(f"{node.path}.{LETTER[node.kind]}"), math.nan
    value = 1.0 / m if flipped else m
    if node.kind in ("R", "G") and law.output == "f":
        return inverse(_symbol(graph, node, m, "G")), value
    return _symbol(graph, node, value, LETTER[node.kind]), value


def _symbol(graph: FlatGraph, node: Node, value: float, letter: str) -> Expr:
    plain = Name(f"{node.path}.{letter}")
    if not node.label or try_quantity(node.label) is not None:
        return plain
    try:
        tree = without_units(parse(node.label))
    except HybondError:
        return plain
    prefix = node.path.rpartition(".")[0]
    tree = substitute(tree, {n: Name(join(prefix, n)) for n in names(tree)})
    if not names(tree) or not names(tree) <= graph.parameters.keys():
        return plain
    says = evaluate(tree, graph)
    return tree if abs(says - value) <= 1e-12 * abs(value) else plain


def evaluate(e: Expr, graph: FlatGraph) -> float:
    """Return the value of an expression of the model's parameters."""
    bound = substitute(e, {k: Number(float(graph.parameters[k])) for k in names(e)})
    return float(compile_expression(bound, {}, pre_offset=0)([]))


# -- arithmetic of symbols


def inverse(e: Expr) -> Expr:
    """Return 1/e, without stacking fractions."""
    if isinstance(e, Binary) and e.op == "/":
        return e.right if e.left == ONE else Binary("/", e.right, e.left)
    return e if e == ONE else Binary("/", ONE, e)


def times(a: Expr, b: Expr) -> Expr:
    """Return a*b; inverses go below one fraction bar."""
    if isinstance(b, Binary) and b.op == "/" and b.left == ONE:
        return a if b.right == ONE else simplify(Binary("/", a, b.right))
    if isinstance(a, Binary) and a.op == "/" and a.left == ONE:
        return simplify(Binary("/", b, a.right))
    return simplify(Binary("*", a, b))


def squared(e: Expr) -> Expr:
    """Return e^2."""
    if isinstance(e, Binary) and e.op == "/" and e.left == ONE:
        return inverse(squared(e.right))
    return e if e == ONE else Binary("^", e, Number(2.0))


def total(parts: list[Expr]) -> Expr:
    """Return the sum of at least one term."""
    result = parts[0]
    for part in parts[1:]:
        result = Binary("+", result, part)
    return result


def harmonic(parts: list[Expr]) -> Expr:
    """Return ``1/(1/a + 1/b + ...)``; for two terms ``a*b/(a + b)``."""
    if len(parts) == 1:
        return parts[0]
    if len(parts) == 2 and not any(isinstance(p, Binary) and p.op == "/" for p in parts):
        a, b = parts
        return Binary("/", Binary("*", a, b), Binary("+", a, b))
    return inverse(total([inverse(p) for p in parts]))


# -- the answer to a blow


def lead(graph: FlatGraph, branch: Branch) -> Lead:
    """Return the leading term of a branch's impedance: mass, damper, spring, free or wall.

    Raises
    ------
    ModelError
        HB-A205 for an inertia whose law is not linear.
    """
    if branch.kind in ("Se", "Sf"):
        return Lead(FREE if branch.kind == "Se" else WALL)
    if branch.kind in ("I", "C", "R"):
        symbol, value = coefficient(graph, branch.node)
        if branch.kind == "I":
            if value != value:
                raise structure(branch.node, f"the inertia {branch.node.path!r} is not linear")
            return Lead(MASS, symbol, value)
        if branch.kind == "C":
            return Lead(SPRING, inverse(symbol), 1.0 / value)
        return Lead(DAMPER, symbol, value)
    below = [lead(graph, c) for c in branch.children]
    if branch.kind == "TF":
        (far,) = below
        scale = squared(branch.gain)
        return Lead(
            far.order, times(far.coefficient, inverse(scale)), far.value / branch.gain_value**2
        )
    if not below:
        return Lead(WALL if branch.kind == "0" else FREE)
    order = max(b.order for b in below) if branch.kind == "1" else min(b.order for b in below)
    same = [b for b in below if b.order == order]
    if branch.kind == "1":
        return Lead(order, total([b.coefficient for b in same]), sum(b.value for b in same))
    value = 1.0 / sum(1.0 / b.value if b.value else math.inf for b in same)
    return Lead(order, harmonic([b.coefficient for b in same]), value)


def blow(graph: FlatGraph, branch: Branch, flow: float) -> dict[int, float]:
    """Return the flow of each inertia, by node, when a blow makes the branch take `flow`."""
    if branch.kind == "I":
        return {branch.node.index: flow}
    if branch.kind == "TF":
        return blow(graph, branch.children[0], flow / branch.gain_value)
    found: dict[int, float] = {}
    if branch.kind == "1":
        for child in branch.children:
            found |= blow(graph, child, child.sign * branch.sign * flow)
    elif branch.kind == "0" and branch.children:
        below = [lead(graph, c) for c in branch.children]
        order = min(b.order for b in below)
        whole = sum(1.0 / b.value for b in below if b.order == order)
        for child, b in zip(branch.children, below, strict=True):
            share = 1.0 / b.value / whole if b.order == order else 0.0
            found |= blow(graph, child, share * flow)
    return found


def pull(branch: Branch) -> float | None:
    """Return the effort that constant sources put on a branch's bond; None if not that simple.

    Springs and dampers are at rest and give none.
    """
    if branch.kind == "Se":
        law = branch.node.law
        if branch.node.is_junction:
            return 0.0
        return law.matrix[0][0] if law is not None and law.matrix is not None else None
    if branch.kind in ("I", "C", "R"):
        return 0.0
    if branch.kind == "TF":
        far = pull(branch.children[0])
        return None if far is None else far / branch.gain_value
    if branch.kind != "1":
        return None
    whole = 0.0
    for child in branch.children:
        part = pull(child)
        if part is None:
            return None
        whole += child.sign * branch.sign * part
    return whole
