"""Entering a mode: the jump that conserves state.

    x+ = x + D nu,   nu such that   G z(x+) = c

`D` spans the rates that impulses allowed by the power structure can make: an impulse may pass
junctions, transformers (moduli held at their a priori values) and source bonds, but no storage
takes one in its own variable, no resistor carries one. `G z = c` are the constraints of the power
structure and the sources at the right limit. The areas `nu` sent through the junction structure
are the impulses of every bond. Sources: Mosterman & Biswas 2002, section 3 (conservation of
state); for linear storage this is the projection ``D (G H D)^-1 (c - G z)``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.causality.assign import assign
from hybond.causality.explain import describe_conflict
from hybond.equations.elimination import Row
from hybond.equations.leakage import least_leakage, null_space
from hybond.equations.mode import ModeEquations, undetermined_names
from hybond.equations.storage import StorageLaws
from hybond.errors import CausalityError, NumericsError
from hybond.model.interval import Interval
from hybond.programs.program import Program

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

TINY = float(np.finfo(float).tiny) * 1e12
"""A term is not smaller than this: the last bit of what is denormal is no small part of it."""
CONSISTENT = 1e-12
"""A constraint is met if its residual is below this part of its terms."""
AGREE = 1e-9
"""Contradicting sources agree if they differ by less than this part of their values."""
NOTICED = 1e-9
"""Part of the largest share that a storage has in a way below which it does not count."""
JUMP_STEPS = 60
CANCELLED = 1e-15
"""A sum of two terms below this part of their sizes is zero."""
NOTHING = 1e-20
"""A stored quantity that a constraint moves is zero below this part of what it may be."""


@dataclass(frozen=True, slots=True)
class Jump:
    """What entering a mode does.

    Parameters
    ----------
    x : array, shape (storages,)
        The a posteriori state; the same object as given if it was consistent.
    impulses : array, shape (2 * bonds,)
        Area of the impulse part of each effort and flow.
    undetermined : tuple of str
        Bond variables whose impulse is a share chosen by least leakage.
    """

    x: Vector
    impulses: Vector
    undetermined: tuple[str, ...]
    happened: bool


def enter(
    equations: ModeEquations, v: list[float], x: Vector, *, where: str, energy: float = 0.0
) -> Jump:
    """Return the jump on entering a configuration with the a priori state `x`.

    Parameters
    ----------
    equations : ModeEquations
    v : list of float
        Values: time and inputs at the right limit, bond variables and the second copy a priori.
    x : array, shape (storages,)
    where : str
        The mode, for messages.
    energy : float
        The largest energy that the run has seen, J. What a storage would hold with all of it is
        what its rounding is measured by: a momentum that must become zero need not do so to the
        last 1e-30.

    Raises
    ------
    CausalityError
        HB-C101 if sources contradict each other.
    NumericsError
        HB-N303 if no jump meets the constraints, HB-N304 if Newton does not converge.
    """
    check_agreement(equations, v, x, where)
    nothing = np.zeros(equations.tableau.unknowns)
    if not equations.tableau.constraints and not equations.structure:
        return Jump(x, nothing, (), happened=False)
    problem = _Constraints(equations, v, x, energy)
    if problem.count == 0:
        return Jump(x, nothing, (), happened=False)
    residual, size = problem.residual(x)
    if not residual.any():
        return Jump(x, nothing, (), happened=False)

    ways = _ways(equations, v, problem, x)
    nu = _newton(problem, x, ways, where)
    directions, moving, d = ways.directions, ways.moving, ways.d
    if (np.abs(residual) <= CONSISTENT * size).all():
        # rounding, not a jump: dust is swept up without an impulse
        return Jump(_moved(x, d @ nu), nothing, (), happened=False)
    impulses = directions @ (moving @ nu)
    free = _shares(ways)
    if free.shape[1]:
        impulses = least_leakage(free, equations.junctions) @ impulses
    names = tuple(undetermined_names(equations.graph, free)) if free.shape[1] else ()
    return Jump(_moved(x, d @ nu), impulses, names, happened=True)


def _moved(x: Vector, change: Vector) -> Vector:
    """Return ``x + change``, what cancels to rounding being zero."""
    total = x + change
    size = np.abs(x) + np.abs(change)
    return np.where(np.abs(total) <= CANCELLED * size, 0.0, total)


def check_agreement(equations: ModeEquations, v: list[float], x: Vector, where: str) -> None:
    """Refuse sources that prescribe one variable differently."""
    if not equations.tableau.agreements:
        return
    xi = equations.knowns(v, x, rates=False)
    first = equations.tableau.unknowns
    for row in equations.tableau.agreements:
        terms = {k: c * float(xi[k - first]) for k, c in row.items()}
        total, size = sum(terms.values()), sum(abs(a) for a in terms.values())
        if abs(total) <= AGREE * size:
            continue
        raise contradiction(equations, row, total, float(v[0]), where)


def contradiction(
    equations: ModeEquations, row: Row, difference: float, t: float, where: str
) -> CausalityError:
    """Return the refusal of a mode whose sources contradict each other, with their chains."""
    graph = equations.graph
    nz = len(graph.storages)
    first = equations.tableau.unknowns
    sources = [graph.nodes[equations.tableau.sources[k - first - nz].node] for k in sorted(row)]
    names = " and ".join(f"{n.kind} {n.path}" for n in sources)
    chains = [
        describe_conflict(graph, equations.mode, c) for c in assign(graph, equations.mode).conflicts
    ]
    if len(sources) == 1:
        why = f"{names} is shorted or cut off by what holds zero, but its value is {difference:.6g}"
    else:
        why = f"{names} prescribe the same variable and differ by {difference:.6g}"
    return CausalityError(
        f"{why} at t = {t:.9g} s. " + " ".join(chains),
        code="HB-C101",
        where=where,
        hint="put a resistor between them, or change the rule that switches them together",
    )


class _Constraints:
    """``G z(x) - c``: the constraints of one configuration as a function of the state."""

    def __init__(self, equations: ModeEquations, v: list[float], x: Vector, energy: float) -> None:
        self.e = equations
        self.v = list(v)
        nk = equations.tableau.knowns
        first = equations.tableau.unknowns
        rows = np.zeros((len(equations.tableau.constraints), nk))
        for row, given in zip(rows, equations.tableau.constraints, strict=True):
            for k, c in given.items():
                row[k - first] = c
        self.rows = rows
        self.left = np.zeros((0, 0))
        if equations.structure:
            frozen = equations.frozen.at(v)
            self.left = equations._split(v)[1]
            self.two_port = frozen[equations.structure]
            self.x1 = equations.x1
            self.sourced = [
                j
                for j, k in enumerate(equations.structure)
                if equations.graph.nodes[equations.rows[k].node].kind in ("Se", "Sf")
            ]
        self.count = len(rows) + self.left.shape[1]
        self.reach = np.zeros(nk)
        self.may_hold = reach_of(equations.storage, x, energy)
        self.reach[: len(x)] = self.may_hold * stiffness_of(equations.storage, x)

    def residual(self, x: Vector) -> tuple[Vector, Vector]:
        """Return residuals and the size of their terms, each of shape (count,)."""
        e = self.e
        v = self.v
        v[e.slots.x] = x.tolist()
        xi = e.knowns(v, x, rates=False)
        known = np.abs(xi) + self.reach + TINY
        known[: len(x)] += e.storage.coupled(x)
        value, size = self.rows @ xi, np.abs(self.rows) @ known
        if self.left.shape[1]:
            w = self.x1 @ xi
            f = self.two_port @ w
            terms = np.abs(self.two_port) @ (np.abs(self.x1) @ known)
            if self.sourced:
                # a controlled source is read at the state tried; two-ports keep their moduli
                v[e.slots.w] = w.tolist()
                for j in self.sourced:
                    f[j] = e.values[e.structure[j]](v)
                    terms[j] += abs(f[j])
            value = np.concatenate([value, self.left.T @ f])
            size = np.concatenate([size, np.abs(self.left.T) @ terms])
        return value, size

    def slope(self, x: Vector, d: Matrix) -> Matrix:
        """Return the derivative of the residual by the areas, shape (count, areas)."""
        e = self.e
        if not e.source_values and not (self.left.shape[1] and self.sourced):
            known = self.rows
            if self.left.shape[1]:
                known = np.vstack([known, self.left.T @ (self.two_port @ self.x1)])
            known = known[:, : len(x)]
            if e.storage.laws:
                return np.asarray(known @ (e.storage.stiffness(x) @ d))
            return np.asarray(known @ e.storage.matrix.times(d))
        # controlled sources: a difference quotient is a good enough slope, because the residual
        # decides when Newton ends
        base, _ = self.residual(x)
        columns = []
        for j in range(d.shape[1]):
            step = 1e-7 * self._far(x, d[:, j])
            ahead, _ = self.residual(x + step * d[:, j])
            columns.append((ahead - base) / step)
        return np.array(columns).reshape(d.shape[1], len(base)).T

    def _far(self, x: Vector, way: Vector) -> float:
        """Return how far along a way the storage goes that it fills first."""
        share = np.abs(way)
        moved = share > NOTICED * share.max()
        held = np.abs(x) + self.may_hold
        moved &= held > 0.0
        if not moved.any():
            return 1e-6 / float(share.max())
        return float((held[moved] / share[moved]).min())


def stiffness_of(storage: StorageLaws, x: Vector) -> Vector:
    """Return each storage's own stiffness, positive, shape (storages,)."""
    return np.abs(storage.own_stiffness(x))


def reach_of(storage: StorageLaws, x: Vector, energy: float) -> Vector:
    """Return what each storage would hold with all of `energy`, shape (storages,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.sqrt(2.0 * energy / stiffness_of(storage, x))
    return np.where(np.isfinite(reach), reach, 0.0)


def reach_of_bonds(equations: ModeEquations, x: Vector, energy: float) -> Vector:
    """Return what each bond variable would be with all of `energy` in one storage.

    Rounding of what is stored shows itself in bond variables in these proportions. Shape
    (2 * bonds,).
    """
    seen = equations.seen
    if seen is None:
        reach = reach_of(equations.storage, x, 1.0) * stiffness_of(equations.storage, x)
        seen = equations.finite.largest(np.where(np.isfinite(reach), reach, 0.0))
        if equations.storage.linear:
            equations.seen = seen
    return np.asarray(np.sqrt(energy) * seen)


def impulse_directions(equations: ModeEquations, v: list[float]) -> Matrix:
    """Return all impulses that the power structure allows, shape (2 * bonds, k), as columns."""
    rows: list[Vector] = []
    if equations.rows:
        frozen = equations.frozen.at(v)
        for k, row in enumerate(equations.rows):
            if row.kind == "hidden":
                continue
            if row.impulse_free:
                for name in row.impulse_free:
                    unit = np.zeros(equations.tableau.unknowns)
                    unit[equations.slots.index[name] - equations.slots.w.start] = 1.0
                    rows.append(unit)
            else:
                rows.append(frozen[k])
    if not rows:
        return equations.n1
    return np.asarray(equations.n1 @ null_space(np.array(rows) @ equations.n1))


def _moving(rates: Matrix) -> Matrix:
    """Return the combinations of impulses that move the state, orthonormal columns."""
    if rates.shape[1] == 0:
        return np.eye(0)
    _, values, vt = np.linalg.svd(rates, full_matrices=False)
    rank = int((values > 1e-10 * max(float(values.max(initial=0.0)), 1e-300)).sum())
    return np.asarray(vt[:rank].T)


def _complement(basis: Matrix) -> Matrix:
    """Return an orthonormal basis of what is orthogonal to the columns of `basis`."""
    whole, _ = np.linalg.qr(basis, mode="complete")
    return np.asarray(whole[:, basis.shape[1] :])


@dataclass(frozen=True, slots=True)
class Ways:
    """The impulses that a mode allows, and what they do to what is stored.

    Parameters
    ----------
    directions : array, shape (2 * bonds, k)
        All impulses that the power structure allows.
    moving : array, shape (k, areas)
        Combinations of them that move the state; the others are only shares.
    d : array, shape (storages, areas)
        How the former move it.
    slope, inverse : arrays or None
        From areas to residuals of the constraints and back, where that is the same everywhere.
    rank : int
        Of `slope`.
    shares : array or None
        Combinations of impulses that move nothing, where all this is kept.
    """

    directions: Matrix
    moving: Matrix
    d: Matrix
    slope: Matrix | None = None
    inverse: Matrix | None = None
    rank: int = 0
    shares: Matrix | None = None


def _ways(equations: ModeEquations, v: list[float], problem: _Constraints, x: Vector) -> Ways:
    """Return the impulses of a mode; in a linear mode they are found once."""
    if equations.ways is not None:
        return equations.ways  # type: ignore[return-value]
    directions = impulse_directions(equations, v)
    if not (equations.linear and equations.storage.linear):
        rates = equations.storage.rates_of(directions)
        moving = _moving(rates)
        return Ways(directions, moving, rates @ moving)
    found = ways_of(equations.storage, directions, lambda d: problem.slope(x, d))
    equations.ways = found
    return found


def ways_of(storage: StorageLaws, directions: Matrix, slope_of: Callable[[Matrix], Matrix]) -> Ways:
    """Return the impulses of a linear mode; `slope_of` gives the slopes of its constraints."""
    rates = storage.rates_of(directions)
    moving = _moving(rates)
    d = rates @ moving
    slope = slope_of(d)
    inverse, rank = _inverse(slope)
    shares = directions @ _complement(moving)
    return Ways(directions, moving, d, slope, inverse, rank, shares)


def _inverse(slope: Matrix) -> tuple[Matrix, int]:
    """Return the pseudo-inverse of a slope, and its rank.

    Where it seems not to determine all areas, rows and columns are measured by their largest
    entries: a capacitor and a column of oil are ten orders apart in SI units.
    """
    rank = _rank(slope)
    if not slope.size:
        return slope.T, rank
    if rank < slope.shape[1]:
        size = np.abs(slope).max(axis=1)
        size = np.where(size > 0.0, size, 1.0)
        rows = slope / size[:, None]
        reach = np.abs(rows).max(axis=0)
        reach = np.where(reach > 0.0, reach, 1.0)
        if _rank(rows / reach) == slope.shape[1]:
            found = np.linalg.pinv(rows / reach, rcond=1e-12)
            return np.asarray(found / reach[:, None] / size, dtype=float), slope.shape[1]
    return np.asarray(np.linalg.pinv(slope, rcond=1e-12), dtype=float), rank


def _shares(ways: Ways) -> Matrix:
    """Return the impulses that move nothing: what is left to least leakage."""
    if ways.shares is not None:
        return ways.shares
    return np.asarray(ways.directions @ _complement(ways.moving))


def kicks_of(equations: ModeEquations, ways: Ways) -> Matrix:
    """Return the impulses that a unit of each residual asks for, shape (2 * bonds, constraints)."""
    assert ways.inverse is not None
    impulses = ways.directions @ ways.moving
    free = _shares(ways)
    if free.shape[1]:
        impulses = least_leakage(free, equations.junctions) @ impulses
    return np.asarray(-impulses @ ways.inverse)


def _rank(slope: Matrix) -> int:
    if not slope.size:
        return 0
    return int(np.linalg.matrix_rank(slope, tol=1e-10 * np.abs(slope).max(initial=0.0)))


def _scaled_step(slope: Matrix, residual: Vector, size: Vector) -> tuple[Vector, int]:
    """Return Newton's step and the rank of the slope.

    A volume of oil and a momentum are far apart in SI units, and neither may count as nothing
    beside the other: rows are measured by their terms, columns by their largest entry. Where
    areas are left open the smallest are taken, as they stand.
    """
    rows = slope / np.where(size > 0.0, size, 1.0)[:, None]
    reach = np.abs(rows).max(axis=0, initial=0.0)
    reach = np.where(reach > 0.0, reach, 1.0)
    rank = _rank(rows / reach)
    if rank < slope.shape[1]:
        rank = _rank(slope)
        return np.asarray(np.linalg.lstsq(slope, residual, rcond=1e-12)[0], dtype=float), rank
    found = np.linalg.lstsq(rows / reach, residual / np.where(size > 0.0, size, 1.0), rcond=1e-12)
    return np.asarray(found[0], dtype=float) / reach, rank


def _newton(problem: _Constraints, x: Vector, ways: Ways, where: str) -> Vector:
    d = ways.d
    nu = np.zeros(d.shape[1])
    best = np.inf
    for _ in range(JUMP_STEPS):
        here = x + d @ nu
        residual, size = problem.residual(here)
        if ways.slope is not None and ways.inverse is not None:
            slope, rank = ways.slope, ways.rank
            step = np.asarray(ways.inverse @ residual, dtype=float)
        else:
            slope = problem.slope(here, d)
            step, rank = _scaled_step(slope, residual, size)
        worst = float((np.abs(residual) / np.where(size > 0.0, size, 1.0)).max(initial=0.0))
        converged = worst <= 1e-14 or (worst <= CONSISTENT and worst >= 0.5 * best)
        if converged and best < np.inf:
            return nu
        if rank < problem.count and float(
            np.abs(residual - slope @ step).max(initial=0.0)
        ) > 1e-9 * float(size.max(initial=0.0)):
            raise NumericsError(
                "no redistribution of what is stored meets the constraints of this mode",
                code="HB-N303",
                where=where,
                hint="a controlled source opposes them, or storage is missing where one is closed",
            )
        best = min(best, worst)
        nu = nu - step
    residual, size = problem.residual(x + d @ nu)
    if (np.abs(residual) <= 1e-9 * size).all():
        return nu
    raise NumericsError(
        "the jump into this mode does not converge",
        code="HB-N304",
        where=where,
        hint="check the laws of storage and of sources for jumps or flat parts",
    )


def constrained(equations: ModeEquations) -> bool:
    """Whether a mode has constraints on what is stored, off which a motion may drift."""
    tableau = equations.tableau
    return bool(tableau.constraints or equations.structure or tableau.agreements)


def on_constraints(
    program: Program,
    equations: ModeEquations,
    interval: Interval,
    t: float,
    y: Vector,
    *,
    energy: float,
) -> Vector:
    """Return the state put back on its mode's constraints, off which integration drifts.

    The same projection as a jump, but within a mode: what it moves is less than the tolerance.
    """
    if not constrained(equations):
        return y
    where = program.graph.mode_text(equations.mode)
    v = program.evaluate(t, y, interval, equations)
    x = y[: program.nx]
    if not (equations.linear and equations.storage.linear):
        # by sizes Newton knows its end, and a run that begins empty had no energy before this step
        energy = max(energy, abs(equations.storage.energy(x)))
    jump = enter(equations, v, x, where=where, energy=energy)
    if jump.x is x:
        return y
    # what a constraint holds at zero is zero, not ever smaller numbers
    held = np.abs(jump.x) <= NOTHING * reach_of(equations.storage, x, energy)
    return np.concatenate([np.where(held, 0.0, jump.x), y[program.nx :]])
