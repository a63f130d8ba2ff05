"""Time constants of a linear mode, to say what a resistor costs that is added for causality.

The equations of the bond graph as they stand, ``M w = N x`` and ``x' = S w`` with all efforts
and flows in `w`, are reduced to the states that they let move: storage in derivative causality
takes no state of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hybond.model.expressions import Bool, Expr, Number, differentiate, names, simplify, substitute
from hybond.model.graph import End, FlatGraph, Mode, Node
from hybond.model.junction_structure import Row, junction_rows, two_port_rows
from hybond.model.kinds import RESISTORS, SOURCES, STORAGES, TWO_PORTS

RANK_TOL = 1e-10
"""Relative size below which a singular value of the balanced equations is zero."""

STILL = 1e-13
"""Rates smaller than this part of the fastest are none: a constant of motion."""

ROUNDING = 1e-13
"""Rates smaller than this part of the size of the equations are rounding."""

Matrix = tuple[tuple[float, ...], ...]


def time_constants(
    graph: FlatGraph, mode: Mode, *, open_loop: bool = False
) -> tuple[float, ...] | None:
    """Return 1/|eigenvalue| of a mode with its sources at zero, s, fastest first.

    Parameters
    ----------
    open_loop : bool
        Whether sources that read the state are at zero too; else the mode is not linear.

    Returns
    -------
    tuple of float or None
        None if a law is not linear with constant coefficients in the mode; empty if nothing
        moves, or the equations of the mode do not settle how.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(V=hb.Se("1 V"), r=hb.R("2 kohm"), c=hb.C("3 uF"), j=hb.One())
    >>> m.bond("V -> j -> c", "j -> r")
    >>> graph = m.flatten()
    >>> [round(tau, 6) for tau in time_constants(graph, graph.start_mode)]
    [0.006]
    """
    matrices = _matrices(graph, mode, open_loop)
    if matrices is None:
        return None
    found = _state_matrix(graph, graph.off_nodes(mode), matrices)
    if found is None:
        return ()
    matrix, scale = found
    rates = np.abs(np.linalg.eigvals(matrix))
    moving = rates[rates > max(STILL * np.max(rates, initial=0.0), ROUNDING * scale)]
    return tuple(sorted(float(1.0 / rate) for rate in moving))


def _matrices(graph: FlatGraph, mode: Mode, open_loop: bool) -> dict[int, Matrix] | None:
    """Return the coefficients of each law by node, sources aside; None if one is not linear."""
    on = graph.on_nodes(mode)
    fixed: dict[str, Expr] = {f"on:{n.index}": Bool(n.index in on) for n in graph.nodes}
    for m, k in zip(graph.machines, mode, strict=True):
        fixed |= {f"in:{m.index}:{j}": Bool(j == k) for j in range(len(m.states))}
    held = {f"s:{k}" for sample in graph.samples for k in sample.signals}
    found: dict[int, Matrix] = {}
    for node in graph.nodes:
        if node.law is None or (node.kind in SOURCES and open_loop):
            continue
        if node.law.matrix is not None:
            found[node.index] = node.law.matrix
            continue
        trees = [simplify(substitute(e, fixed)) for e in node.law.expressions]
        read = {name for tree in trees for name in names(tree)}
        if node.kind in SOURCES:
            # of time, inputs and what is sampled alone: no feedback
            if not all(n in held or n == "time" or n.startswith(("u:", "at:")) for n in read):
                return None
            continue
        arguments = _arguments(node)
        slopes = [[differentiate(tree, name) for name in arguments] for tree in trees]
        if node.kind in TWO_PORTS:
            slopes = [trees]
        if not read <= set(arguments) or not all(isinstance(c, Number) for r in slopes for c in r):
            return None
        found[node.index] = tuple(
            tuple(c.value for c in row if isinstance(c, Number)) for row in slopes
        )
    return found


def _arguments(node: Node) -> list[str]:
    """Return the names of what the law of a storage or resistor is a function of."""
    if node.kind in TWO_PORTS or node.law is None:
        return []
    argument = node.about.energy or ("e" if node.law.output == "f" else "f")
    many = len(node.ends) > 1
    return [f"law:{argument}{end.port + 1 if many else ''}" for end in node.ends]


def _state_matrix(
    graph: FlatGraph, off: frozenset[int], matrices: Mapping[int, Matrix]
) -> tuple[Any, float] | None:
    """Return A of ``x' = A x`` and a size, or None if the equations settle no motion."""
    bonds, count = len(graph.bonds), len(graph.storages)
    written = [
        row
        for node in graph.nodes
        for row in _rows(node, matrices.get(node.index, ()), node.index in off, bonds)
    ]
    rows, stands_for = _merged(written, 2 * bonds)
    left = {k: j for j, k in enumerate(sorted({k for k, c in stands_for if c != 0.0}))}
    size = len(left)
    both = np.zeros((len(rows) + count, size + count))
    for k, row in enumerate(rows):
        for column, value in row.items():
            both[k, left[column]] = value
    rates = np.zeros((count, size))
    for s in graph.storages:
        effort, flow = stands_for[s.bond], stands_for[bonds + s.bond]
        gives, takes = (effort, flow) if s.kind == "C" else (flow, effort)
        k = len(rows) + s.index
        if gives[1] != 0.0:
            both[k, left[gives[0]]] = -gives[1] * (1.0 if s.kind == "C" else s.sign)
        if takes[1] != 0.0:
            rates[s.index, left[takes[0]]] = takes[1] * (s.sign if s.kind == "C" else 1.0)
        matrix = matrices[s.node]
        for other in graph.storages:
            if other.node == s.node:
                both[k, size + other.index] = matrix[s.port][other.port]
    both, columns = _balanced(both)
    w, x = columns[:size], columns[size:]
    P, Q, C = _solved(both, size)
    S = rates * w / x[:, None] if count else rates
    scale = float(np.linalg.norm(S))
    C = _independent(C)
    # C x = 0 is kept if its rate is zero too, and that is what the open variables are for.
    steer = C @ S @ Q
    inverse = np.linalg.pinv(steer, rcond=RANK_TOL)
    if np.linalg.matrix_rank(steer, tol=RANK_TOL * np.linalg.norm(steer)) < len(C):
        return None
    held = inverse @ C @ S @ P
    idle = np.eye(Q.shape[1]) - inverse @ steer
    if np.linalg.norm(S @ Q @ idle) > RANK_TOL * scale:
        return None  # an open variable that nothing settles moves a storage
    return S @ (P - Q @ held), scale


def _solved(both: Any, size: int) -> tuple[Any, Any, Any]:
    """Solve ``[M, -N] (w, x) = 0`` for w as far as it goes, by sparse elimination.

    Returns
    -------
    P, Q, C : ndarray
        ``w = P x + Q v`` for any v, if ``C x = 0``.
    """
    rows: list[Row] = []
    holds: dict[int, set[int]] = {}
    for k in range(both.shape[0]):
        columns = np.flatnonzero(both[k])
        rows.append({int(c): float(both[k, c]) for c in columns})
        for c in rows[k]:
            holds.setdefault(c, set()).add(k)
    pivots: dict[int, int] = {}
    waiting = set(range(len(rows)))
    constraints: list[int] = []
    while waiting:
        k = min(waiting, key=lambda j: (len(rows[j]), j))
        waiting.remove(k)
        row = rows[k]
        open_ones = [c for c in row if c < size and abs(row[c]) > RANK_TOL]
        if not open_ones:
            constraints.append(k)
            continue
        pivot = max(open_ones, key=lambda c: (abs(row[c]), -c))
        pivots[pivot] = k
        factor = row[pivot]
        rows[k] = row = {c: v / factor for c, v in row.items()}
        for j in sorted(holds[pivot] - {k}):
            other = rows[j]
            part = other.pop(pivot)
            holds[pivot].discard(j)
            for c, v in row.items():
                if c == pivot:
                    continue
                old = other.get(c, 0.0)
                new = old - part * v
                if abs(new) <= RANK_TOL**1.25 * max(abs(old), abs(part * v)):
                    other.pop(c, None)
                    holds[c].discard(j)
                else:
                    other[c] = new
                    holds.setdefault(c, set()).add(j)
    count = both.shape[1] - size
    left = [c for c in range(size) if c not in pivots]
    P, Q = np.zeros((size, count)), np.zeros((size, len(left)))
    for j, c in enumerate(left):
        Q[c, j] = 1.0
    place = {c: j for j, c in enumerate(left)}
    for pivot, k in pivots.items():
        for c, v in rows[k].items():
            if c >= size:
                P[pivot, c - size] = -v
            elif c in place:
                Q[pivot, place[c]] = -v
    kept = [k for k in constraints if any(c >= size for c in rows[k])]
    C = np.zeros((len(kept), count))
    for j, k in enumerate(kept):
        for c, v in rows[k].items():
            if c >= size:
                C[j, c - size] = v
    return P, Q, C


def _merged(rows: list[Row], count: int) -> tuple[list[Row], list[tuple[int, float]]]:
    """Take the equations of one and two variables out: most of a bond graph's.

    Returns
    -------
    rows : list of dict
        The equations left.
    stands_for : list of (int, float)
        Each variable as another one times a factor; the factor is 0 if it is zero.
    """
    of = [(k, 1.0) for k in range(count)]

    def find(k: int) -> tuple[int, float]:
        factor = 1.0
        while of[k] != (k, 1.0) and factor != 0.0:
            k, step = of[k]
            factor *= step
        return k, factor

    while True:
        left: list[Row] = []
        for row in rows:
            sums: Row = {}
            largest = 0.0
            for k, value in row.items():
                root, factor = find(k)
                sums[root] = sums.get(root, 0.0) + value * factor
                largest = max(largest, abs(value * factor))
            sums = {k: v for k, v in sums.items() if abs(v) > 1e-13 * largest}
            if len(sums) > 2:
                left.append(sums)
            elif len(sums) == 2:
                (a, in_a), (b, in_b) = sums.items()
                of[a] = (b, -in_b / in_a)
            elif sums:
                (a,) = sums
                of[a] = (a, 0.0)
        if len(left) == len(rows):
            return left, [find(k) for k in range(count)]
        rows = left


def _rows(node: Node, matrix: Matrix, off: bool, bonds: int) -> list[Row]:
    """Return the equations of a node, efforts first, then flows."""
    if node.kind in SOURCES:
        return [{node.ends[0].bond + (0 if node.kind == "Se" else bonds): 1.0}]
    if node.is_junction:
        return junction_rows(node, bonds, off=off)
    if node.kind in TWO_PORTS:
        return two_port_rows(node, 0.0 if off else matrix[0][0], bonds)
    if node.kind in RESISTORS:
        assert node.law is not None
        gives_flow = node.law.output == "f"
        found = []
        for end, coefficients in zip(node.ends, matrix, strict=True):
            row = {end.bond + (bonds if gives_flow else 0): _sign(end, flow=gives_flow)}
            for other_end, c in zip(node.ends, coefficients, strict=True):
                at = other_end.bond + (0 if gives_flow else bonds)
                row[at] = row.get(at, 0.0) - c * _sign(other_end, flow=not gives_flow)
            found.append(row)
        return found
    assert node.kind in STORAGES
    return []


def _sign(end: End, *, flow: bool) -> float:
    return float(end.sign) if flow else 1.0


def _balanced(matrix: Any) -> tuple[Any, Any]:
    """Scale rows and columns towards size 1; return the matrix and the factors of its columns."""
    matrix, columns = matrix.copy(), np.ones(matrix.shape[1])
    for _ in range(8):
        for axis in (1, 0):
            size = np.max(np.abs(matrix), axis=axis, initial=0.0)
            scale = 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))
            if axis == 1:
                matrix *= scale[:, None]
            else:
                matrix *= scale
                columns *= scale
    return matrix, columns


def _independent(rows: Any) -> Any:
    """Return a basis of the rows of a matrix."""
    _, sizes, directions = np.linalg.svd(rows, full_matrices=False)
    return directions[sizes > RANK_TOL * np.max(sizes, initial=1.0)]


def coefficients(graph: FlatGraph) -> Mapping[int, float]:
    """Return for each one-port linear storage the co-energy variable per stored quantity."""
    return {
        s.index: node.law.matrix[0][0]
        for s in graph.storages
        if (node := graph.nodes[s.node]).law is not None
        and node.law.matrix is not None
        and len(node.ends) == 1
    }
