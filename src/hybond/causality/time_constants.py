"""Time constants of a linear mode, to say what a resistor costs that is added for causality.

The equations of the bond graph as they stand, ``M w = N x`` and ``x' = S w`` with all efforts
and flows in `w`, are reduced to the states that they let move: storage in derivative causality
takes no state of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hybond.model.expressions import names
from hybond.model.graph import End, FlatGraph, Mode, Node
from hybond.model.kinds import RESISTORS, SOURCES, STORAGES, TWO_PORTS

RANK_TOL = 1e-10
"""Relative size below which a singular value of the balanced equations is zero."""

STILL = 1e-9
"""Rates smaller than this part of the fastest are none: a constant of motion."""

ROUNDING = 1e-13
"""Rates smaller than this part of the size of the equations are rounding."""

Row = dict[int, float]


def time_constants(graph: FlatGraph, mode: Mode) -> tuple[float, ...] | None:
    """Return 1/|eigenvalue| of a mode with its sources at zero, s, fastest first.

    Returns
    -------
    tuple of float or None
        None if a law in the graph is not linear with constant coefficients; empty if nothing
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
    if not all(_is_linear(node) for node in graph.nodes):
        return None
    found = _state_matrix(graph, graph.off_nodes(mode))
    if found is None:
        return ()
    matrix, scale = found
    rates = np.abs(np.linalg.eigvals(matrix))
    moving = rates[rates > max(STILL * np.max(rates, initial=0.0), ROUNDING * scale)]
    return tuple(sorted(float(1.0 / rate) for rate in moving))


def _is_linear(node: Node) -> bool:
    if node.law is None or node.law.linear:
        return True
    if node.kind in SOURCES:  # of time and inputs alone: no feedback
        return all(
            name == "time" or name.startswith(("u:", "at:", "in:", "on:"))
            for e in node.law.expressions
            for name in names(e)
        )
    return False


def _state_matrix(graph: FlatGraph, off: frozenset[int]) -> tuple[Any, float] | None:
    """Return A of ``x' = A x`` and a size, or None if the equations settle no motion."""
    bonds, count = len(graph.bonds), len(graph.storages)
    written = [row for node in graph.nodes for row in _rows(node, node.index in off, bonds)]
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
        matrix = _matrix(graph.nodes[s.node])
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


def _rows(node: Node, off: bool, bonds: int) -> list[Row]:
    """Return the equations of a node, efforts first, then flows."""
    if node.kind in SOURCES:
        return [{node.ends[0].bond + (0 if node.kind == "Se" else bonds): 1.0}]
    if node.is_junction:
        common, other = (0, bonds) if node.kind == "0" else (bonds, 0)
        if off:
            return [{common + end.bond: 1.0} for end in node.ends]
        base = node.ends[0].bond if node.ends else 0
        rows: list[Row] = [{common + e.bond: 1.0, common + base: -1.0} for e in node.ends[1:]]
        return rows + ([{other + e.bond: float(e.sign) for e in node.ends}] if node.ends else [])
    if node.kind in TWO_PORTS:
        return _two_port(node, 0.0 if off else _matrix(node)[0][0], bonds)
    if node.kind in RESISTORS:
        assert node.law is not None
        gives_flow = node.law.output == "f"
        found = []
        for end, coefficients in zip(node.ends, _matrix(node), strict=True):
            row = {end.bond + (bonds if gives_flow else 0): _sign(end, flow=gives_flow)}
            for other_end, c in zip(node.ends, coefficients, strict=True):
                at = other_end.bond + (0 if gives_flow else bonds)
                row[at] = row.get(at, 0.0) - c * _sign(other_end, flow=not gives_flow)
            found.append(row)
        return found
    assert node.kind in STORAGES
    return []


def _two_port(node: Node, m: float, bonds: int) -> list[Row]:
    one, two = node.ends
    # Port 1 takes power in, port 2 gives it out.
    f1, f2 = float(one.sign), -float(two.sign)
    if node.kind == "TF":
        return [{one.bond: 1.0, two.bond: -m}, {bonds + two.bond: f2, bonds + one.bond: -m * f1}]
    return [{one.bond: 1.0, bonds + two.bond: -m * f2}, {two.bond: 1.0, bonds + one.bond: -m * f1}]


def _sign(end: End, *, flow: bool) -> float:
    return float(end.sign) if flow else 1.0


def _matrix(node: Node) -> tuple[tuple[float, ...], ...]:
    assert node.law is not None and node.law.matrix is not None
    return node.law.matrix


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
