"""The equations of one configuration, ready to evaluate: state in, all bond variables out.

Notation: ``w`` all efforts then flows; ``z`` co-energy variables; ``xi = [z, u, du]`` the knowns;
``r`` the unknowns that elimination left free. Then ``w = N r + X xi``, twice: before the hidden
constraints (``N1, X1``, where impulses live) and after (``N2, X2``, for finite values). If there
are no dynamic rows ``r`` is undetermined or empty and evaluation is one matrix product. Otherwise
Newton solves, in the remaining ``r``,

* the laws, and the power structure projected on its range,
* the hidden constraints: the time derivative of what the power structure puts on ``z``, found by
  its left null vectors ``L`` (``L' F_w N1 = 0``), in which the derivative of a modulus enters.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import bent, partial_time, reads_bonds
from hybond.equations.damped import damped
from hybond.equations.element_parts import Dynamic
from hybond.equations.leakage import (
    Projection,
    junction_rows,
    least_leakage,
    null_space,
    times_orthonormal,
    undetermined,
)
from hybond.equations.slots import Slots
from hybond.equations.solved import Solved
from hybond.equations.storage import StorageLaws
from hybond.equations.tableau import Tableau
from hybond.errors import CausalityError, NumericsError
from hybond.model.expressions import Expr, Number, compile_expression
from hybond.model.graph import FlatGraph, Mode

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Closure = Callable[[Sequence[float]], float]

NEWTON_STEPS = 40
LOOKS_ASIDE = 3
"""Times that Newton leaves a point where the laws are flat."""
NEWTON_TOLERANCE = 1e-13
"""Newton ends when an update is below this part of the bond variables' size."""
RANK_TOLERANCE = 1e-10


@dataclass(slots=True)
class Gradient:
    """The derivatives of some rows by bond variables: a constant part and compiled entries."""

    constant: Matrix
    entries: list[tuple[int, int, Closure]]

    def at(self, v: Sequence[float]) -> Matrix:
        """Return the matrix at the values `v`, shape (rows, 2 * bonds)."""
        if not self.entries:
            return self.constant
        m = self.constant.copy()
        for i, j, f in self.entries:
            m[i, j] = f(v)
        return m


@dataclass(slots=True)
class Solution:
    """Bond variables of one evaluation.

    Parameters
    ----------
    w : array, shape (2 * bonds,)
    size : array, shape (2 * bonds,)
        Sum of the magnitudes of the terms that made each: what rounding is relative to.
    freedom : array, shape (2 * bonds, k)
        Directions in which they are undetermined; k is nearly always 0.
    """

    w: Vector
    size: Vector
    freedom: Matrix


@dataclass(slots=True)
class ModeEquations:
    """One configuration; made by `prepare`."""

    graph: FlatGraph
    mode: Mode
    slots: Slots
    tableau: Tableau
    storage: StorageLaws
    power: Solved
    finite: Solved
    source_values: list[tuple[int, Closure]]
    source_constants: Vector
    rate_values: list[tuple[int, Closure]]
    rows: list[Dynamic]
    values: list[Closure]
    slopes: Gradient
    frozen: Gradient
    structure: list[int]
    """Dynamic rows of the power structure; `others` are laws and constant hidden rows."""
    others: list[int]
    drift: list[Closure]
    """Time derivative of each structure row at constant bond variables."""
    drift_slopes: Gradient
    rank: int
    """Rank of the structure rows, found at generic values."""
    affine: bool
    """Whether all dynamic rows are affine in bond variables and nothing is hidden."""
    project: Projection | None = None
    freedom: Matrix = field(default_factory=lambda: np.zeros((0, 0)))
    guess: Vector | None = None
    newton_steps: int = 0
    ways: object = None
    """The impulses that the mode allows, once they are known and if they are always the same."""
    seen: Vector | None = None
    """What bond variables would be with a unit of energy in one storage, if always the same."""

    @property
    def n1(self) -> Matrix:
        """Bond variables by `r`, before the hidden constraints."""
        return self.power.free

    @property
    def x1(self) -> Matrix:
        """Bond variables by `xi`, before the hidden constraints; made anew at each call."""
        return self.power.spread()

    @property
    def n2(self) -> Matrix:
        """Bond variables by `r`."""
        return self.finite.free

    @property
    def x2(self) -> Matrix:
        """Bond variables by `xi`; made anew at each call."""
        return self.finite.spread()

    @property
    def shown(self) -> Solved:
        """Bond variables by what is known, least leakage applied; made anew at each call."""
        return self.finite if self.project is None else self.finite.projected(self.project)

    @property
    def junctions(self) -> Matrix:
        """The rows whose squares are the leakage power of controlled junctions, made anew."""
        return junction_rows(self.graph, self.graph.off_nodes(self.mode))

    @property
    def linear(self) -> bool:
        """Whether evaluation is one matrix product."""
        return not self.rows

    # -- knowns

    def knowns(self, v: Sequence[float], x: Vector, *, rates: bool = True) -> Vector:
        """Return ``xi`` for stored state `x`; sources are read at the values `v`."""
        nz = len(self.graph.storages)
        nu = len(self.tableau.sources)
        xi = np.zeros(nz + 2 * nu)
        xi[:nz] = self.storage.co_energy(x)
        xi[nz : nz + nu] = self.source_constants
        for k, f in self.source_values:
            xi[nz + k] = f(v)
        if rates:
            for k, f in self.rate_values:
                xi[nz + nu + k] = f(v)
        return xi

    # -- evaluation

    def solve(self, v: list[float], x: Vector) -> Vector:
        """Return the bond variables, shape (2 * bonds,), and write them into `v`.

        Raises
        ------
        NumericsError
            HB-N301 if Newton does not converge, HB-N302 if a law gives NaN.
        """
        xi = self.knowns(v, x)
        w = self.finite.by_knowns(xi) if self.linear else self._newton(v, x, xi)
        if self.project is not None:
            w = self.project @ w
        v[self.slots.w] = w.tolist()
        return w

    def solution(self, v: list[float], x: Vector) -> Solution:
        """Return the bond variables with the size of their terms and their freedom."""
        w = self.solve(v, x)
        size = self.finite.sizes(self.knowns(v, x))
        freedom = self.freedom
        if self.n2.shape[1]:
            r = w[self._free2]
            size = size + np.abs(self.n2) @ np.abs(r)
            if not self.linear:
                freedom = self._freedom_at(v, x)
        return Solution(w, np.maximum(size, np.abs(w)), freedom)

    @property
    def _free2(self) -> list[int]:
        return self.tableau.finite.free()

    def _newton(self, v: list[float], x: Vector, xi: Vector) -> Vector:
        base = self.finite.by_knowns(xi)
        r = self.guess if self.guess is not None else np.zeros(self.n2.shape[1])
        update = np.inf
        aside = 0
        for _ in range(NEWTON_STEPS):
            w = base + self.n2 @ r
            residual, jacobian = self._system(v, x, xi, w)
            if not np.isfinite(residual).all():
                raise self._blame(v)
            if not residual.any():
                # exact already, even where a law has no slope: a root at zero flow
                return self._found(v, r, w)
            if not np.isfinite(jacobian).all():
                raise self._blame(v)
            step = _least_squares(jacobian, residual)
            scale = np.abs(base).max(initial=0.0) + np.abs(r).max(initial=0.0)
            if self._stands_still(jacobian, residual, step) and aside < LOOKS_ASIDE:
                # flat here (a quadratic law at zero flow), yet not satisfied: look aside
                aside += 1
                r = r + 10.0 ** (-3 * aside) * max(scale, 1e-6) * (1.0 + 0.1 * np.arange(len(r)))
                update = np.inf
                continue
            r = r - step
            self.newton_steps += 1
            previous, update = update, float(np.abs(step).max(initial=0.0))
            if self.affine:
                # one step from anywhere is exact
                update = 0.0
            # rounding keeps a step from vanishing: stop as well when it no longer shrinks
            if update <= NEWTON_TOLERANCE * scale or (
                update <= 1e-9 * scale and update >= 0.5 * previous
            ):
                return self._found(v, r, base + self.n2 @ r)
        carefully = self._by_shorter_steps(v, x, xi, base)
        if carefully is not None:
            return self._found(v, carefully, base + self.n2 @ carefully)
        self.guess = None
        names = ", ".join(self.graph.nodes[d.node].path for d in self.rows if d.node >= 0)
        raise NumericsError(
            f"the laws of {names} have no solution near the last one (t = {v[0]:.9g} s)",
            code="HB-N301",
            where=self.graph.mode_text(self.mode),
            hint="check these laws for jumps or missing slopes; start closer to a solution",
        )

    def _by_shorter_steps(
        self, v: list[float], x: Vector, xi: Vector, base: Vector
    ) -> Vector | None:
        """Return the free unknowns where full steps of Newton did not find them, or None."""

        def system(r: Vector) -> tuple[Vector, Matrix]:
            self.newton_steps += 1
            return self._system(v, x, xi, base + self.n2 @ r)

        zero = np.zeros(self.n2.shape[1])
        for start in (zero,) if self.guess is None else (self.guess, zero):
            found = damped(system, _least_squares, start, tolerance=NEWTON_TOLERANCE)
            if found is not None:
                return found
        return None

    def _found(self, v: list[float], r: Vector, w: Vector) -> Vector:
        self.guess = r
        v[self.slots.w] = w.tolist()
        return w

    def _stands_still(self, jacobian: Matrix, residual: Vector, step: Vector) -> bool:
        """Whether a step leaves a part of the residual that the slopes here cannot reach.

        In an affine system that part says that laws contradict each other, wherever one looks.
        """
        if self.affine:
            return False
        rest = np.abs(residual - jacobian @ step)
        return bool((rest > 0.5 * np.abs(residual)).any() and rest.max() > 0.0)

    def _blame(self, v: Sequence[float]) -> NumericsError:
        """Return the refusal that names the law whose value or slope is not a number."""
        self.guess = None
        slopes = self.slopes.at(v)
        for k, (row, f) in enumerate(zip(self.rows, self.values, strict=True)):
            value = f(v)
            what = f"gives {value}" if value - value != 0.0 else ""
            if not what and not np.isfinite(slopes[k]).all():
                what = "has no finite slope"
            if what:
                node = self.graph.nodes[row.node] if row.node >= 0 else None
                name = f"{node.kind} {node.path}" if node else "a constraint's derivative"
                return NumericsError(
                    f"the law of {name} {what} at t = {v[0]:.9g} s",
                    code="HB-N302",
                    where=node.path if node else self.graph.mode_text(self.mode),
                    hint="look for a division by zero, a root of a negative number or a table "
                    "that ends",
                )
        return NumericsError(
            f"the equations overflow at t = {v[0]:.9g} s",
            code="HB-N302",
            where=self.graph.mode_text(self.mode),
            hint="look at the last values of the partial result",
        )

    def _system(self, v: list[float], x: Vector, xi: Vector, w: Vector) -> tuple[Vector, Matrix]:
        """Return Newton's residual and Jacobian in the free unknowns."""
        v[self.slots.w] = w.tolist()
        f = np.array([g(v) for g in self.values])
        slopes = self.slopes.at(v) @ self.n2
        if self.rank == len(self.structure):
            # the power structure leaves nothing hidden: its rows stand as they are
            return f, slopes
        onto, left = self._split(v)
        frozen = self.frozen.at(v)[self.structure]
        known = left.T @ (frozen @ self.x1)
        rates, rate_slopes = self._known_rates(v, x)
        drift = np.array([g(v) for g in self.drift])
        hidden = known @ (rates @ w + rate_slopes) + left.T @ drift
        hidden_slopes = (known @ rates + left.T @ self.drift_slopes.at(v)) @ self.n2
        residual = np.concatenate([onto.T @ f[self.structure], f[self.others], hidden])
        jacobian = np.vstack([onto.T @ slopes[self.structure], slopes[self.others], hidden_slopes])
        return residual, jacobian

    def _split(self, v: Sequence[float]) -> tuple[Matrix, Matrix]:
        """Return bases of range and left null space of the structure rows."""
        frozen = self.frozen.at(v)[self.structure] @ self.n1
        u, _, _ = np.linalg.svd(frozen)
        return u[:, : self.rank], u[:, self.rank :]

    def _known_rates(self, v: list[float], x: Vector) -> tuple[Matrix, Vector]:
        """Return A, b with ``d xi / dt = A w + b`` (source rates are not known twice)."""
        nz, nu = len(self.graph.storages), len(self.tableau.sources)
        a = np.zeros((nz + 2 * nu, self.slots.w.stop - self.slots.w.start))
        stiffness = self.storage.stiffness(x) * self.storage.sign
        for k, bond in enumerate(self.storage.bond.tolist()):
            a[:nz, bond] += stiffness[:, k]
        b = np.zeros(nz + 2 * nu)
        for k, f in self.rate_values:
            b[nz + k] = f(v)
        return a, b

    def _freedom_at(self, v: list[float], x: Vector) -> Matrix:
        if self.n2.shape[1] == 0:
            return self.freedom
        w = np.array(v[self.slots.w])
        _, jacobian = self._system(v, x, self.knowns(v, x), w)
        steep = ~np.isfinite(jacobian)
        if steep.any():
            # a slope without bound (a root at zero) fixes its variable like any other
            size = np.abs(jacobian[~steep]).max(initial=0.0)
            jacobian = np.where(steep, size or 1.0, jacobian)
        return np.asarray(self.n2 @ null_space(jacobian))


def prepare(
    graph: FlatGraph,
    mode: Mode,
    slots: Slots,
    tableau: Tableau,
    storage: StorageLaws | None = None,
) -> ModeEquations:
    """Make the equations of a configuration ready to evaluate.

    `storage` are the laws of storage, which are the same in all modes, if they are known.

    Raises
    ------
    CausalityError
        HB-C103 if a constraint would have to be differentiated twice.
    """
    if tableau.too_high:
        raise CausalityError(
            "a constraint on storage leaves no rate free that could keep it",
            code="HB-C103",
            where=graph.mode_text(mode),
            hint="a controlled source prescribes what it also measures; add storage or resistance",
        )
    storage = storage or StorageLaws.of(graph, slots)
    nk = tableau.knowns
    power = Solved.of(tableau.power, nk)
    # most modes hide no constraint: one pair of matrices serves impulses and finite values
    finite = Solved.of(tableau.finite, nk) if tableau.constraints else power
    rows = tableau.dynamic
    nw = tableau.unknowns
    structure = [k for k, d in enumerate(rows) if d.kind == "structure"]
    others = [k for k, d in enumerate(rows) if d.kind != "structure"]

    def compiled(e: Expr) -> Closure:
        return compile_expression(e, slots.index, pre_offset=slots.size)

    def gradient(which: list[dict[str, Expr]]) -> Gradient:
        constant = np.zeros((len(which), nw))
        entries = []
        for i, slopes in enumerate(which):
            for name, e in slopes.items():
                j = slots.index[name] - slots.w.start
                if isinstance(e, Number):
                    constant[i, j] = e.value
                else:
                    entries.append((i, j, compiled(e)))
        return Gradient(constant, entries)

    drifts = [partial_time(rows[k].expression, graph) for k in structure]
    from hybond.equations.calculus import gradient as slopes_of

    constants = np.zeros(len(tableau.sources))
    source_values, rate_values = [], []
    for k, s in enumerate(tableau.sources):
        if isinstance(s.value, Number):
            constants[k] = s.value.value
        else:
            source_values.append((k, compiled(s.value)))
        if s.rate != Number(0.0):
            rate_values.append((k, compiled(s.rate)))
    if not structure:
        # a source rate is evaluated only where a constraint asks for it
        first, used = len(graph.storages) + len(tableau.sources), finite.known.used()
        rate_values = [(k, f) for k, f in rate_values if used[first + k]]
    equations = ModeEquations(
        graph,
        mode,
        slots,
        tableau,
        storage,
        power,
        finite,
        source_values,
        constants,
        rate_values,
        rows,
        [compiled(d.expression) for d in rows],
        gradient([dict(d.slopes) for d in rows]),
        gradient([dict(d.frozen) for d in rows]),
        structure,
        others,
        [compiled(e) for e in drifts],
        gradient([slopes_of(e) for e in drifts]),
        0,
        False,
        freedom=np.zeros((nw, 0)),
    )
    if structure:
        equations.rank = _generic_rank(equations)
    equations.affine = equations.rank == len(structure) and not any(
        bent(d.expression) or any(reads_bonds(e) for e in d.slopes.values()) for d in rows
    )
    if equations.linear and equations.n2.shape[1]:
        equations.freedom = equations.n2
        equations.project = least_leakage(equations.n2, equations.junctions)
    elif not equations.linear:
        loose = times_orthonormal(equations.n2, _generic_null(equations))
        if loose.shape[1]:
            equations.freedom = loose
            equations.project = least_leakage(loose, equations.junctions)
    return equations


def _generic_values(equations: ModeEquations, seed: int) -> list[float]:
    """Return fixed pseudo-random values: generic, and the same in every run."""
    generator = np.random.default_rng(seed)
    return list(generator.uniform(0.3, 1.7, 2 * equations.slots.size))


def _generic_rank(equations: ModeEquations) -> int:
    """Return the structural rank of the power structure's dynamic rows."""
    best = 0
    for seed in range(3):
        m = equations.frozen.at(_generic_values(equations, seed))[equations.structure]
        m = m @ equations.n1
        if m.size and np.isfinite(m).all():
            best = max(best, int(np.linalg.matrix_rank(m, tol=RANK_TOLERANCE * np.abs(m).max())))
    return best


def _generic_null(equations: ModeEquations) -> Matrix:
    """Return the free directions that no dynamic row, hidden rows included, ever sees."""
    smallest: Matrix | None = None
    for seed in range(3):
        v = _generic_values(equations, seed)
        x = np.array(v[equations.slots.x])
        w = np.array(v[equations.slots.w])
        _, jacobian = equations._system(v, x, equations.knowns(v, x), w)
        if not np.isfinite(jacobian).all():
            continue
        found = null_space(jacobian)
        if smallest is None or found.shape[1] < smallest.shape[1]:
            smallest = found
    return np.zeros((equations.n2.shape[1], 0)) if smallest is None else smallest


def _least_squares(jacobian: Matrix, residual: Vector) -> Vector:
    """Solve; a square regular system directly, else the smallest solution."""
    if jacobian.shape[0] == jacobian.shape[1]:
        try:
            step = np.linalg.solve(jacobian, residual)
            if np.isfinite(step).all():
                return np.asarray(step)
        except np.linalg.LinAlgError:
            pass
    return np.asarray(np.linalg.lstsq(jacobian, residual, rcond=None)[0])


def undetermined_names(graph: FlatGraph, freedom: Matrix) -> list[str]:
    """Return the bond variables that `freedom` moves, as written."""
    bonds = len(graph.bonds)
    return [
        f'"{graph.bonds[k % bonds].name}".{"e" if k < bonds else "f"}'
        for k in undetermined(freedom)
    ]
