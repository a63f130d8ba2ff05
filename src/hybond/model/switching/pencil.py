"""Time constants of one mode of a linear model, straight from its graph.

Every equation of the mode is a row on the bonds' efforts and flows and on what is stored,
``W w + X x = 0``, and the rates are ``x' = S w``. The states that all constraints allow, hidden
ones included, are found by keeping those for which some rate stays among them; on these the rate
is a matrix, and its eigenvalues are the natural frequencies.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.model.expressions import Bool, Expr, Number, differentiate, names, simplify, substitute
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.kinds import SOURCES, STORAGES, TWO_PORTS
from hybond.model.switching.rows import Row, junction_rows, two_port_rows

Matrix = NDArray[np.float64]

RANK = 1e-11
"""Singular values below this part of the largest count as zero; rows are scaled to one."""
ROUNDING = 1e-13
"""A frequency below this part of the size of the equations is rounding."""
ZERO = 1e-13
"""A frequency below this part of the largest is zero."""


def time_constants(graph: FlatGraph, mode: Mode) -> tuple[float, ...]:
    """Return ``1/|s|`` of the natural frequencies s of a mode, s, shortest first.

    Frequencies that are zero are left out. Sources count as constant. Empty if a law is neither
    linear nor constant in the mode.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rl")
    >>> m.add(V=hb.Se(1), L=hb.I(2), r=hb.R(4), i=hb.One())
    >>> m.bond("V -> i -> L", "i -> r")
    >>> [round(tau, 9) for tau in time_constants(m.flatten(), ())]
    [0.5]
    """
    rows = _rows(graph, mode)
    if rows is None or not graph.storages:
        return ()
    bonds, states = len(graph.bonds), len(graph.storages)
    rates = np.zeros((states, 2 * bonds))
    for s in graph.storages:
        if s.kind == "I":
            rates[s.index, s.bond] = 1.0
        else:
            rates[s.index, bonds + s.bond] = float(s.sign)
    # energy makes charges and momenta of any size comparable
    scale = _energy_scale(graph)
    rows[:, 2 * bonds :] /= scale
    rates *= scale[:, None]
    rows /= np.abs(rows).max(axis=1, keepdims=True)
    inside = _null(rows)
    w, x = inside[: 2 * bonds], inside[2 * bonds :]
    y = rates @ w
    basis = np.eye(states)
    while True:
        # combinations of `inside` whose state and whose rate both lie in the span of `basis`
        out = np.eye(states) - basis @ basis.T
        keep = _null(np.vstack([out @ x, out @ y]))
        new = _span(x @ keep)
        if new.shape[1] == basis.shape[1]:
            break
        basis = new
    if not basis.shape[1]:
        return ()
    # a rate without a state would be free: leave such directions out
    part = keep @ np.linalg.pinv(basis.T @ x @ keep, rcond=1e-9)
    eigenvalues = np.linalg.eigvals(basis.T @ y @ part)
    largest = float(np.abs(eigenvalues).max(initial=0.0))
    # a mode that only moves on has no frequency at all, but rounding makes one
    noise = ROUNDING * float(np.abs(rates).max(initial=0.0) * np.abs(part).max(initial=0.0))
    least = max(ZERO * largest, noise)
    return tuple(sorted(1.0 / abs(complex(s)) for s in eigenvalues if abs(s) > least))


def _energy_scale(graph: FlatGraph) -> Matrix:
    scale = np.ones(len(graph.storages))
    for s in graph.storages:
        law = graph.nodes[s.node].law
        if law is not None and law.matrix is not None:
            scale[s.index] = np.sqrt(abs(law.matrix[s.port][s.port])) or 1.0
    return scale


def _null(m: Matrix) -> Matrix:
    if not m.size:
        return np.eye(m.shape[1])
    _, values, vt = np.linalg.svd(m)
    return np.asarray(vt[int((values > RANK * values.max(initial=0.0)).sum()) :].T)


def _span(m: Matrix) -> Matrix:
    u, values, _ = np.linalg.svd(m, full_matrices=False)
    return np.asarray(u[:, values > 1e-9])


def _rows(graph: FlatGraph, mode: Mode) -> Matrix | None:
    """Return all rows ``[W, X]`` of the mode, None if one is not linear."""
    bonds = len(graph.bonds)
    off = graph.off_nodes(mode)
    fixed = _fixed(graph, mode)
    rows: list[Row] = []
    for node in graph.nodes:
        if node.is_junction:
            rows += junction_rows(node, bonds, off=node.index in off)
        elif node.kind in SOURCES:
            rows.append({node.ends[0].bond + (bonds if node.kind == "Sf" else 0): 1.0})
        elif node.kind in TWO_PORTS:
            modulus = _modulus(node, fixed, off=node.index in off)
            if modulus is None:
                return None
            rows += two_port_rows(node, modulus, bonds)
        else:
            found = _law(node, graph, fixed)
            if found is None:
                return None
            rows += found
    table = np.zeros((len(rows), 2 * bonds + len(graph.storages)))
    for line, row in zip(table, rows, strict=True):
        for column, value in row.items():
            line[column] += value
    return table


def _fixed(graph: FlatGraph, mode: Mode) -> dict[str, Expr]:
    """Return the Booleans of the mode by canonical name."""
    on = graph.on_nodes(mode)
    found: dict[str, Expr] = {
        f"on:{n.index}": Bool(n.index in on) for n in graph.nodes if n.controlled
    }
    for m, k in zip(graph.machines, mode, strict=True):
        found.update({f"in:{m.index}:{j}": Bool(j == k) for j in range(len(m.states))})
    return found


def _modulus(node: Node, fixed: dict[str, Expr], *, off: bool) -> float | None:
    assert node.law is not None
    tree = Number(0.0) if off else simplify(substitute(node.law.expressions[0], fixed))
    return tree.value if isinstance(tree, Number) else None


def _law(node: Node, graph: FlatGraph, fixed: dict[str, Expr]) -> list[Row] | None:
    """Return the rows ``output - matrix @ argument = 0`` of a storage or resistor."""
    assert node.law is not None
    bonds = len(graph.bonds)
    many = len(node.ends) > 1
    stored = {s.port: s.index for s in graph.storages if s.node == node.index}
    flow = node.law.output == "f"
    argument = node.about.energy or ("e" if flow else "f")
    rows = []
    for end, law in zip(node.ends, node.law.expressions, strict=True):
        tree = simplify(substitute(law, fixed))
        row = {end.bond + (bonds if flow else 0): float(end.sign) if flow else 1.0}
        for other in node.ends:
            local = f"law:{argument}{other.port + 1 if many else ''}"
            slope = differentiate(tree, local)
            if not isinstance(slope, Number):
                return None
            if node.kind in STORAGES:
                column, sign = 2 * bonds + stored[other.port], 1.0
            elif flow:
                column, sign = other.bond, 1.0
            else:
                column, sign = bonds + other.bond, float(other.sign)
            row[column] = row.get(column, 0.0) - slope.value * sign
        if any(not n.startswith("law:") for n in names(tree)):
            return None
        rows.append(row)
    return rows
