"""Tables of what time-stepping asks of a model: what is linear, and what friction brought in."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.equations.calculus import bent, gradient, reads_bonds
from hybond.equations.element_parts import Dynamic
from hybond.model.expressions import Expr, Number, names

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

OUTER = ("u:", "at:", "in:", "on:")
"""Names that do not depend on the state."""


def put_steps(t: ModelTables, dynamics: list[Dynamic]) -> None:
    """Put what time-stepping asks for into the tables."""
    g = t.graph
    laws = [(m, law) for m in g.machines if m.law is not None for law in m.law.junctions]
    t.ints["dynamic_fixed"] = [int(_is_fixed(d)) for d in dynamics]
    t.ints["port_affine"] = [
        int(all(_is_affine(a) for a in (law.limit, law.breakaway) if a is not None))
        for _, law in laws
    ]
    t.ints["port_pseudo"] = [int(g.nodes[law.node].domain.pseudo) for _, law in laws]
    t.ints["port_bounce"] = [
        m.states.index("impact") if "impact" in m.states else -1 for m, _ in laws
    ]
    forces, signs = [], []
    for _, law in laws:
        if law.source is None:
            forces.append(-1)
            signs.append(0)
            continue
        end = g.nodes[law.source].ends[0]
        forces.append(end.bond + (len(g.bonds) if g.nodes[law.node].kind == "0" else 0))
        signs.append(int(end.sign))
    t.ints["port_force"] = forces
    t.ints["port_force_sign"] = signs


def _is_fixed(row: Dynamic) -> bool:
    """Whether a row reads nothing but bond variables, with coefficients that are numbers."""
    return (
        all(n.startswith(("e:", "f:")) for n in names(row.expression))
        and all(isinstance(slope, Number) for slope in row.slopes.values())
        and not bent(row.expression)
    )


def _is_affine(e: Expr) -> bool:
    """Whether a limit is affine in bond variables, with coefficients from outside."""
    inner = [n for n in names(e) if not (n == "time" or n.startswith((*OUTER, "e:", "f:")))]
    return not inner and not bent(e) and not any(reads_bonds(d) for d in gradient(e).values())
