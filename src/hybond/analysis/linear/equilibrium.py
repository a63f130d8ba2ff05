"""The rest of a model: states from which nothing moves, found by Newton's iteration.

Each step solves ``A d = -rates`` with the matrix of the linearisation at the present point, in the
states that are independent there. Where A has no inverse there are either many states of rest or
none. Of many, the one is taken that keeps what the motion conserves (the volume in two tanks that a
pipe joins) and else is nearest; there is none where what A cannot change is not zero.

What is conserved may bend: a spring that a turning arm pulls is as long as the angle says. The
search then begins anew, and its steps are paths on which nothing is gained of it from point to
point (of the charge of the spring, in terms of the turning), not straight lines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.going_on import readings, said_of
from hybond.analysis.linear.point import Point, entered, valued
from hybond.engine.outcome.apart import Apart
from hybond.equations.calculus import rate_name
from hybond.equations.linear_rows import linear_rows
from hybond.errors import HybondError, NumericsError
from hybond.export.linear.proper import Proper, proper
from hybond.model.expressions import compile_expression
from hybond.model.graph import FlatGraph, Mode

Vector = NDArray[np.float64]

SINGULAR = 1e-10
"""Singular values of the balanced matrix below this part of the largest count as zero."""
REST = 1e-10
"""A rate below this part of the largest effort or flow seen around counts as none."""
HELD = 1e-6
"""A rate that no state changes, above this part of them, goes on for ever."""
STEPS = 60
"""Of Newton's iteration."""
LEAST = 1e-4
"""Part of a step below which it is not shortened any more."""
SMALL = 1e-6
"""Part of the largest state that the step is at a rest at the most, by rates that are rounding."""
DUST = 1e-13
"""Part of the largest move or rate, or of what a state has been, below which one is rounding."""
STUCK = 4
"""Steps that may make nothing smaller."""
SLOW = 0.01
"""Part by which a step that is a path makes rates smaller that is as good as nothing."""
BENT = 1e-9
"""Sine of the angle between what two points conserve above which it is not the same."""
LONGER = 8.0
"""How much longer than the last step the next one is, at the most, where what is conserved turns:
a path is dear."""
TURNS = 80
"""Points at which one path is looked at, at the most."""
WHOLE = 700
"""Points at which all paths of a search are looked at together, at the most: seconds."""
PATH = 1e-10
"""To which part of the step, and of the states, a path is followed on which all is conserved."""
NEARER = "give start values nearer to it, or linearise at the end of a long run"
OTHER = "choose another mode, or linearise at a time of a run, or at states that you give"


def equilibrium(graph: FlatGraph, mode: Mode, *, chosen: bool) -> tuple[Point, list[str]]:
    """Return a point at which nothing moves, and what is to be said of it.

    The search begins at the start of a run. Where a step ends in another mode it goes on there,
    unless the mode was `chosen`.

    Raises
    ------
    NumericsError
        HB-A510 if there is none, or it is not found.
    """
    return _Search(graph, mode, chosen=chosen).found()


@dataclass(frozen=True, slots=True)
class _Here:
    """The linearisation at a point of the search.

    Parameters
    ----------
    rates : array
        Of the kept states.
    still : array of bool
        Which of them have to be at rest: not integrals that nothing reads.
    """

    point: Point
    found: Proper
    rates: Vector
    still: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class _Kept:
    """What the motion conserves near a point, to first order.

    Parameters
    ----------
    mode : Mode
    states : array of int
        The states that it is made of.
    scale : array
        What they are measured in.
    rows : array
        Orthonormal: how it changes with them.
    """

    mode: Mode
    states: NDArray[np.intp]
    scale: Vector
    rows: NDArray[np.float64]


class _Bent(Exception):
    """What is conserved is not the same at two points."""


class _Search:
    def __init__(self, graph: FlatGraph, mode: Mode, *, chosen: bool) -> None:
        self.graph, self.mode, self.chosen = graph, mode, chosen
        self.apart = Apart(graph)
        self.stored = len(graph.storages)
        self.rates = [rate_name(s) for s in graph.storages] + [i.rate for i in graph.integrals]
        self.paths = [s.path for s in graph.storages] + [i.path for i in graph.integrals]
        self.sizes = np.zeros(len(self.rates))
        """What the rate of each state is measured by: the largest seen of its kind around."""
        self.largest = 0.0
        """The largest state seen."""
        self.seen = np.zeros(len(self.rates))
        """The largest value that each state has had."""
        self.stuck = 0
        """Steps that made nothing smaller."""
        self.conserved: _Kept | None = None
        """What the motion conserves at the last point."""
        self.bent = False
        """Whether that turns, so that steps follow it."""
        self.asked = 0
        """Points of paths that were looked at."""
        self.reach = np.inf
        """How long the last step was that made rates smaller, where what is conserved turns."""

    def found(self) -> tuple[Point, list[str]]:
        point = entered(
            self.apart, self.graph, self.apart.start, self.mode, chosen=self.chosen, said=""
        )
        begin = point.state
        for _ in range(STEPS):
            here = self._here(point)
            try:
                move, notes, lost = self._move(here, begin)
            except _Bent:
                point = self._anew(begin, here)
                continue
            # rounding is that of the terms which cancel in a rate
            kept = list(here.found.kept)
            terms = np.abs(here.found.A) @ np.maximum(np.abs(move), np.abs(point.state[kept]))
            self.sizes[kept] = np.maximum(self.sizes[kept], terms)
            if self._off(here) <= REST and (lost is not None or self._is_small(move, here)):
                self._check(point)
                return Point(
                    point.t, point.mode, point.state, point.values, point.landed, "equilibrium"
                ), self._going_on(here) + notes
            if lost is not None:
                self._none(point, lost)
            point = self._ahead(here, move)
        self._none(
            point,
            f"the iteration does not settle in {STEPS} steps",
            hint=NEARER,
        )

    def _here(self, point: Point) -> _Here:
        found = self._proper(point)
        read = np.abs(found.A).max(axis=0, initial=0.0) > 0.0
        still = [k < self.stored or bool(read[j]) for j, k in enumerate(found.kept)]
        if not all(still):
            everywhere = self._read_anywhere(point)
            still = [s or k in everywhere for s, k in zip(still, found.kept, strict=True)]
        self._measure(point)
        return _Here(point, found, self._rates(point, found), np.array(still, dtype=bool))

    def _read_anywhere(self, point: Point) -> set[int]:
        """Return the states that laws of the mode read, be it that they do not show at the point.

        A spring that is slack pulls no arm, whatever its angle is.
        """
        found = self._proper(point, reading=True)
        read = np.abs(found.A).max(axis=0, initial=0.0) > 0.0
        return {k for j, k in enumerate(found.kept) if read[j]}

    def _proper(self, point: Point, *, reading: bool = False) -> Proper:
        rows = linear_rows(
            self.graph, point.mode, point.values, inputs=(), outputs={}, reading=reading
        )
        if rows.timed:
            self._none(
                point,
                f"{', '.join(rows.timed)} changes with time",
                hint="linearise at a time of a run, or at states that you give: both hold the time",
            )
        first = range(self.stored, rows.stored)
        return proper(rows.E, rows.A, rows.B, rows.stored, keep=first)

    def _measure(self, point: Point) -> None:
        """Note how large efforts and flows are around each state."""
        graph = self.graph
        self.largest = max(self.largest, float(np.abs(point.state).max(initial=0.0)))
        self.seen = np.maximum(self.seen, np.abs(point.state))
        for k in range(len(self.sizes)):
            if k < self.stored:
                s = graph.storages[k]
                kind = "e" if s.kind == "I" else "f"
                domain = graph.bonds[s.bond].domain
                same = [b.index for b in graph.bonds if b.domain == domain]
                now = max(abs(point.values[f"{kind}:{b}"]) for b in same)
            else:
                now = abs(point.values[f"s:{k - self.stored}"])
            self.sizes[k] = max(self.sizes[k], now)

    def _rates(self, point: Point, found: Proper) -> Vector:
        index = {name: k for k, name in enumerate(point.values)}
        row = list(point.values.values())
        rates = [compile_expression(self.rates[k], index, pre_offset=0)(row) for k in found.kept]
        return np.array(rates, dtype=float)

    def _off(self, here: _Here) -> float:
        """Return the largest rate that should be none, as a part of what it is measured by."""
        sizes = np.maximum(self.sizes[list(here.found.kept)], 1e-300)
        return float((np.abs(here.rates) / sizes)[here.still].max(initial=0.0))

    def _is_small(self, move: Vector, here: _Here) -> bool:
        """Whether a step is rounding, or comes of rates that are."""
        return bool(np.abs(move).max(initial=0.0) <= SMALL * self.largest)

    def _move(self, here: _Here, begin: Vector) -> tuple[Vector, list[str], str | None]:
        """Return Newton's step of the kept states, notes, and why there is no rest, if so."""
        from scipy.linalg import matrix_balance

        kept, still = np.array(here.found.kept, dtype=int), here.still
        move = np.zeros(len(kept))
        if self.bent:
            self.conserved = None
        A, f = here.found.A[np.ix_(still, still)], here.rates[still]
        if not len(A):
            return move, [], None
        balanced, (scale, _) = matrix_balance(A, permute=False, separate=True)
        u, values, vt = np.linalg.svd(balanced)
        rank = int((values > SINGULAR * values.max(initial=0.0)).sum())
        g = f / scale
        d = -vt[:rank].T @ ((u[:, :rank].T @ g) / values[:rank])
        notes: list[str] = []
        lost = None
        if rank < len(A):
            conserved, free = u[:, rank:].T, vt[rank:].T
            lost = self._lost(kept[still], f, scale, conserved)
            idle = ~np.abs(A).max(axis=0).astype(bool) & (kept[still] >= self.stored)
            if lost is not None and idle.any():
                # a state that is read and does not act just here: so it may be elsewhere
                move[still] = d * scale
                return move, notes, None
            self._note(here, kept[still], scale, conserved)
            now = (here.point.state[kept] - begin[kept])[still] / scale
            if self.bent:
                now[:] = 0.0
            d = d + free @ np.linalg.lstsq(conserved @ free, -conserved @ (now + d), rcond=1e-8)[0]
            notes.append(_many(len(A) - rank))
        # what is rounding beside the others waits until they have settled: a body that is at rest
        # while another state moves stays there, as no rank may hang on
        d[np.abs(d) <= DUST * np.abs(d).max(initial=0.0)] = 0.0
        move[still] = d * scale
        return move, notes, lost

    def _lost(
        self, states: NDArray[np.intp], f: Vector, scale: Vector, conserved: NDArray[np.float64]
    ) -> str | None:
        """Return which state goes on changing, as what no state changes is not zero; or None."""
        g = f / scale
        lasting = np.abs(conserved.T @ (conserved @ g))
        # what is left of the other rates by rounding moves nothing that has not moved yet
        lasting[lasting <= DUST * np.abs(g).max(initial=0.0)] = 0.0
        part = lasting * scale / np.maximum(self.sizes[states], 1e-300)
        worst = int(np.argmax(part))
        if part[worst] <= HELD:
            return None
        return (
            f"{self.paths[states[worst]]} goes on changing, {f[worst]:.6g} a second, "
            "whatever the states are"
        )

    def _note(
        self, here: _Here, states: NDArray[np.intp], scale: Vector, rows: NDArray[np.float64]
    ) -> None:
        """Note what is conserved at a point.

        Raises
        ------
        _Bent
            Where it is not what it was at the point before.
        """
        old = self.conserved
        self.conserved = _Kept(here.point.mode, states, scale, rows)
        if self.bent or old is None or old.mode != here.point.mode:
            return
        if rows.shape[0] == old.rows.shape[0] and np.array_equal(states, old.states):
            was = np.linalg.qr((old.rows * (scale / old.scale)).T)[0]
            if np.abs(rows - (rows @ was) @ was.T).max(initial=0.0) > BENT:
                raise _Bent

    def _anew(self, begin: Vector, here: _Here) -> Point:
        """Return where the search begins anew, on paths on which all is conserved.

        What is not part of it, as a speed at the start, is taken from the present point: while
        the point moves, how a rate changes does not tell what its coefficients conserve.
        """
        assert self.conserved is not None
        self.bent, self.stuck = True, 0
        state = begin.copy()
        part = np.abs(self.conserved.rows).max(axis=0) > BENT
        free = np.ones(len(state), dtype=bool)
        free[self.conserved.states[part]] = False
        state[free] = here.point.state[free]
        return entered(self.apart, self.graph, state, self.mode, chosen=self.chosen, said="")

    def _along(self, here: _Here, move: Vector) -> Vector:
        """Return the states at the end of a step of the kept ones on which all is conserved."""
        from scipy.integrate import solve_ivp

        start, kept = here.point.state, self.conserved
        assert kept is not None
        most = self.asked + TURNS
        whole = np.asarray(here.found.basis[: len(start)] @ move)
        still = set(kept.states.tolist())
        scales = dict(zip(kept.states.tolist(), kept.scale.tolist(), strict=True))

        def way(_: float, state: Vector) -> Vector:
            self.asked += 1
            if self.asked > min(most, WHOLE):
                raise self._far(here.point)
            point = valued(self.graph, self.apart.signals, 0.0, state, here.point.mode)
            found = self._proper(point)
            # of storage that moves as one, either may be among the states
            at = [j for j, k in enumerate(found.kept) if k < self.stored or k in still]
            states = [found.kept[j] for j in at]
            scale = np.array([scales.get(k, 1.0) for k in states])
            A = found.A[np.ix_(at, at)] * scale / scale[:, None]
            rows = np.linalg.svd(A)[0][:, len(at) - len(kept.rows) :].T
            step = whole[list(found.kept)]
            d = step[at] / scale
            d = d - rows.T @ (rows @ d)
            d[np.abs(d) <= DUST * np.abs(d).max(initial=0.0)] = 0.0
            step[at] = d * scale
            return np.asarray(found.basis[: len(state)] @ step)

        sizes = np.maximum(np.abs(start), np.abs(whole))
        sizes = np.maximum(sizes, self.seen)
        solved = solve_ivp(
            way,
            (0.0, 1.0),
            start,
            method="DOP853",
            rtol=PATH,
            atol=PATH * np.maximum(sizes, DUST * self.largest),
        )
        if not solved.success:
            raise self._far(here.point)
        return np.asarray(solved.y[:, -1])

    def _far(self, point: Point) -> NumericsError:
        """Return why a path was not followed: the step is halved, if there are points left."""
        return NumericsError(
            "no equilibrium: the way to it is long, and what is conserved turns on it",
            code="HB-A510",
            where=self.graph.mode_text(point.mode),
            hint=NEARER,
        )

    def _ahead(self, here: _Here, move: Vector) -> Point:
        """Return the next point: the whole step, or as much of it as makes rates smaller."""
        point = here.point
        direction = here.found.basis[: len(point.state)] @ move
        before = self._off(here)
        part, length = 1.0, 0.0
        if self.conserved is not None and self.bent:
            at = [here.found.kept.index(k) for k in self.conserved.states.tolist()]
            length = float(np.abs(move[at] / self.conserved.scale).max(initial=0.0))
        if length > 0.0:
            part = min(1.0, LONGER * self.reach / length)
        least = LEAST * part
        last: Point | None = None
        why: HybondError | None = None
        while part > least:
            try:
                if length > 0.0:
                    ahead = self._along(here, part * move)
                else:
                    ahead = point.state + part * direction
                # a state that goes to zero arrives there: a modulus may be a multiple of it
                ahead[np.abs(ahead) <= DUST * self.seen] = 0.0
                trial = self._settled(ahead, point.mode)
            except HybondError as error:
                why = error
                if self.asked > WHOLE:
                    raise
                part /= 2.0
                continue
            last = trial
            if trial.mode != point.mode:
                if self.chosen:
                    said = self.graph.mode_text(self.mode)
                    self._none(trial, f"on the way to it the mode ({said}) is left")
                return trial
            after = self._off(_Here(trial, here.found, self._rates(trial, here.found), here.still))
            if after <= (1.0 - 0.1 * part) * before or after <= REST:
                self.reach = part * length or self.reach
                if self.reach < np.inf and after > max(REST, (1.0 - SLOW) * before):
                    self._is_stuck(point)
                return trial
            part /= 2.0
        if last is None:
            assert why is not None
            raise why
        self._is_stuck(point)
        return last

    def _is_stuck(self, point: Point) -> None:
        """Count a step that made nothing smaller, and refuse after some."""
        self.stuck += 1
        if self.stuck > STUCK:
            self._none(point, "no step makes the rates smaller", hint=NEARER)

    def _settled(self, state: Vector, mode: Mode) -> Point:
        return entered(self.apart, self.graph, state, mode, chosen=False, said="")

    def _check(self, point: Point) -> None:
        """Refuse a rest in which the mode is left at once."""
        after = self._settled(point.state, point.mode)
        if after.mode != point.mode:
            text = self.graph.mode_text(after.mode)
            self._none(point, f"there the mode is left at once for ({text})")

    def _going_on(self, here: _Here) -> list[str]:
        """Return notes of what goes on at a rest; refuse one at which a guard waits for it."""
        notes = []
        going = [(here.found.kept[j], float(here.rates[j])) for j in np.flatnonzero(~here.still)]
        rates = {f"s:{k - self.stored}": r for k, r in going if abs(r) > REST * self.sizes[k]}
        for k, rate in going:
            if not rate:
                continue
            found = readings(self.graph, here.point, rates, f"s:{k - self.stored}")
            if found and found[0].comes and f"s:{k - self.stored}" in rates:
                self._none(
                    here.point,
                    f"{self.paths[k]} goes on changing, {rate:.6g} a second, and "
                    f"{found[0].machine.path} reads it: {found[0].rule.said}",
                )
            notes.append(f"{self.paths[k]} goes on at {rate:.6g} a second; {said_of(found)}")
        return notes

    def _none(self, point: Point, why: str, hint: str = OTHER) -> NoReturn:
        raise NumericsError(
            f"no equilibrium: {why}",
            code="HB-A510",
            where=self.graph.mode_text(point.mode),
            hint=hint,
        )


def _many(directions: int) -> str:
    """Return what is said of a rest beside which there are others."""
    return (
        f"not the only rest: {directions} direction{'s' if directions > 1 else ''} in which the "
        "states may be moved; what the motion conserves is as at the start"
    )
