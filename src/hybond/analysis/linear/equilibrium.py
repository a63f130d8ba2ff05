"""The rest of a model: states from which nothing moves, found by Newton's iteration.

Each step solves ``A d = -rates`` with the matrix of the linearisation at the present point, in the
states that are independent there. Where A has no inverse there are either many states of rest or
none. Of many, the one is taken that keeps what the motion conserves (the volume in two tanks that a
pipe joins) and else is nearest; there is none where what A cannot change is not zero.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.point import Point, settled
from hybond.engine.outcome.apart import Apart
from hybond.equations.calculus import rate_name
from hybond.equations.linear_rows import LinearRows, linear_rows
from hybond.errors import HybondError, NumericsError
from hybond.export.linear.proper import Proper, proper
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Mode
from hybond.units import format_quantity

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

SINGULAR = 1e-10
"""Singular values of the balanced matrix below this part of the largest count as zero."""
REST = 1e-10
"""A rate below this part of the largest effort or flow around counts as none."""
STEPS = 60
"""Of Newton's iteration, in one mode."""


def equilibrium(graph: FlatGraph, mode: Mode, *, chosen: bool) -> tuple[Point, list[str]]:
    """Return a point at which nothing moves, and what is to be said of it.

    The search begins at the start of a run. Where a step ends in another mode it goes on there.

    Raises
    ------
    NumericsError
        HB-A510 if there is none, or it is not found.
    """
    apart = Apart(graph)
    point = settled(apart, graph, apart.start, mode, chosen=chosen, said="")
    begin = point.state
    rates = _rates(graph)
    notes: list[str] = []
    step = 0
    for step in range(STEPS):
        rows = linear_rows(graph, point.mode, point.values, inputs=(), outputs={})
        if rows.timed:
            raise _none(graph, point, f"{', '.join(rows.timed)} changes with time", timed=True)
        first = range(len(graph.storages), rows.stored)
        found = proper(rows.E, rows.A, rows.B, rows.stored, keep=first)
        still = _still(graph, found, rows)
        move, notes, lost = _move(graph, apart, point, rates, found, still, begin)
        small = _is_rest(graph, point, rates, found, still)
        if small and (step > 0 or not move.any() or _negligible(move, point, begin)):
            break
        if lost is not None:
            if small:
                break
            raise _none(graph, point, lost)
        point = _ahead(apart, graph, point, move, rates, found, still, chosen=chosen, mode=mode)
    else:
        raise _none(graph, point, f"the iteration does not settle in {STEPS} steps", settles=False)
    _check(apart, graph, point)
    return Point(point.t, point.mode, point.state, point.values, point.landed, "equilibrium"), notes


def _rates(graph: FlatGraph) -> list[Expr]:
    return [rate_name(s) for s in graph.storages] + [i.rate for i in graph.integrals]


def _still(graph: FlatGraph, found: Proper, rows: LinearRows) -> NDArray[np.bool_]:
    """Return which of the kept states have to be at rest: not integrals that nothing reads."""
    stored = len(graph.storages)
    read = np.abs(found.A).max(axis=0, initial=0.0) > 0.0
    return np.array([k < stored or bool(read[j]) for j, k in enumerate(found.kept)], dtype=bool)


def _values(apart: Apart, point: Point, expressions: list[Expr]) -> Vector:
    return np.array(apart.signals.after(0.0, point.state, point.mode, expressions))


def _sizes(graph: FlatGraph, point: Point, kept: tuple[int, ...]) -> Vector:
    """Return what the rates of kept states are measured by: efforts and flows of their domains."""
    found = []
    for k in kept:
        if k < len(graph.storages):
            s = graph.storages[k]
            kind = "e" if s.kind == "I" else "f"
            own = graph.bonds[s.bond].domain
            same = [b.index for b in graph.bonds if b.domain == own]
            found.append(max(abs(point.values[f"{kind}:{b}"]) for b in same))
        else:
            found.append(abs(point.values[f"s:{k - len(graph.storages)}"]))
    return np.array(found)


def _is_rest(
    graph: FlatGraph,
    point: Point,
    rates: list[Expr],
    found: Proper,
    still: NDArray[np.bool_],
) -> bool:
    moves = _rates_at(graph, point, rates, found)
    sizes = _sizes(graph, point, found.kept)
    return bool((np.abs(moves)[still] <= REST * np.maximum(sizes[still], 1e-300)).all())


def _rates_at(graph: FlatGraph, point: Point, rates: list[Expr], found: Proper) -> Vector:
    from hybond.model.expressions import compile_expression

    index = {name: k for k, name in enumerate(point.values)}
    row = list(point.values.values())
    return np.array(
        [float(compile_expression(rates[k], index, pre_offset=0)(row)) for k in found.kept]
    )


def _move(
    graph: FlatGraph,
    apart: Apart,
    point: Point,
    rates: list[Expr],
    found: Proper,
    still: NDArray[np.bool_],
    begin: Vector,
) -> tuple[Vector, list[str], str | None]:
    """Return Newton's step of the kept states, notes, and why there is no rest if that shows."""
    from scipy.linalg import matrix_balance

    f = _rates_at(graph, point, rates, found)
    kept = list(found.kept)
    A, f = found.A[np.ix_(still, still)], f[still]
    move = np.zeros(len(kept))
    if not len(A):
        return move, [], None
    balanced, (scale, _) = matrix_balance(A, permute=False, separate=True)
    u, values, vt = np.linalg.svd(balanced)
    rank = int((values > SINGULAR * values.max(initial=0.0)).sum())
    g = f / scale
    d = -vt[:rank].T @ ((u[:, :rank].T @ g) / values[:rank])
    notes = []
    lost = None
    if rank < len(A):
        conserved, free = u[:, rank:].T, vt[rank:].T
        off = conserved.T @ (conserved @ g)
        sizes = _sizes(graph, point, found.kept)[still]
        worst = int(np.argmax(np.abs(off) * scale / np.maximum(sizes, 1e-300)))
        if abs(off[worst] * scale[worst]) > 1e-6 * max(sizes[worst], 1e-300):
            own = np.flatnonzero(still)[worst]
            k = kept[int(own)]
            path = (
                graph.storages[k].path
                if k < len(graph.storages)
                else graph.integrals[k - len(graph.storages)].path
            )
            lost = f"{path} goes on changing, {f[worst]:.6g} a second, whatever the states are"
        now = (point.state[kept][still] - begin[kept][still]) / scale
        share = np.linalg.lstsq(conserved @ free, -(conserved @ (now + d)), rcond=1e-8)[0]
        d = d + free @ share
        many = len(A) - rank
        notes.append(
            f"not the only rest: {many} direction{'s' if many > 1 else ''} in which the states may "
            "be moved; what the motion conserves is as at the start"
        )
    move[still] = d * scale
    moving = np.flatnonzero(~still)
    for j in moving.tolist():
        path = graph.integrals[kept[j] - len(graph.storages)].path
        speed = _rates_at(graph, point, rates, found)[j]
        if speed:
            notes.append(f"{path} goes on at {speed:.6g} a second; nothing reads it")
    return move, notes, lost


def _negligible(move: Vector, point: Point, begin: Vector) -> bool:
    size = max(float(np.abs(point.state).max(initial=0.0)), float(np.abs(begin).max(initial=0.0)))
    return bool(np.abs(move).max(initial=0.0) <= 1e-12 * size)


def _ahead(
    apart: Apart,
    graph: FlatGraph,
    point: Point,
    move: Vector,
    rates: list[Expr],
    found: Proper,
    still: NDArray[np.bool_],
    *,
    chosen: bool,
    mode: Mode,
) -> Point:
    """Return the next point: the whole step, or as much of it as makes rates smaller."""
    n = len(point.state)
    direction = found.basis[:n] @ move
    sizes = np.maximum(_sizes(graph, point, found.kept), 1e-300)
    before = np.abs(_rates_at(graph, point, rates, found) / sizes)[still].max(initial=0.0)
    part, last, why = 1.0, None, None
    while part > 1e-4:
        try:
            trial = settled(
                apart, graph, point.state + part * direction, point.mode, chosen=False, said=""
            )
        except HybondError as error:
            why = error
            part /= 2.0
            continue
        last = trial
        if trial.mode != point.mode:
            if chosen:
                raise _none(
                    graph, trial, f"on the way to it the mode ({graph.mode_text(mode)}) is left"
                )
            return trial
        after = np.abs(_rates_at(graph, trial, rates, found) / sizes)[still].max(initial=0.0)
        if after <= (1.0 - 0.1 * part) * before or after <= REST:
            return trial
        part /= 2.0
    if last is None:
        assert why is not None
        raise why
    return last


def _check(apart: Apart, graph: FlatGraph, point: Point) -> None:
    """Refuse a rest in which the mode is left at once."""
    after = settled(apart, graph, point.state, point.mode, chosen=False, said="")
    if after.mode != point.mode:
        raise _none(
            graph, point, f"there the mode is left at once for ({graph.mode_text(after.mode)})"
        )


def _none(
    graph: FlatGraph, point: Point, why: str, *, timed: bool = False, settles: bool = True
) -> NumericsError:
    hint = "choose another mode, or linearise at a time of a run, or at states that you give"
    if timed:
        hint = "linearise at a time of a run, or at states that you give: both hold the time"
    elif not settles:
        hint = "give start values nearer to it, or linearise at the end of a long run"
    return NumericsError(
        f"no equilibrium: {why}",
        code="HB-A510",
        where=graph.mode_text(point.mode) or format_quantity(point.t, "s"),
        hint=hint,
    )
