"""Locating guards inside a step, on the solver's own interpolant.

A guard is a level: none that leaves the current state is true when a step begins. Within a step
its comparisons are sampled; where one changes sign, or has an extremum on its way to zero, the
guard itself is asked, so that an even number of crossings or a touch is not lost. The instant
returned is the first at which the guard holds, found on the comparison that made it true
(Illinois method) and confirmed by the same test, rounding included, that settling applies.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.model.expressions import names
from hybond.model.graph import Machine, Mode, Rule
from hybond.model.interval import Interval
from hybond.modes.dirac import ROUNDING, Pairs, steady
from hybond.modes.guards import Followed, Guards
from hybond.modes.settle import Settler
from hybond.programs.program import Program
from hybond.solvers import Step

Vector = NDArray[np.float64]

FRACTIONS = np.array([0.0, 0.113, 0.261, 0.372, 0.5127, 0.6291, 0.7713, 0.8837, 1.0])
"""Where in a step guards are sampled: unevenly, so that no periodic signal looks constant."""
_POWERS = np.vander(2.0 * FRACTIONS - 1.0, 6)
LEFT_OVER = np.eye(len(FRACTIONS)) - _POWERS @ np.linalg.pinv(_POWERS)
"""Samples to what a polynomial of degree 5 does not explain of them."""
GRID = np.linspace(0.0, 1.0, 65)
FINE = np.vander(2.0 * GRID - 1.0, 6) @ np.linalg.pinv(_POWERS)
"""Samples to that polynomial on a fine grid."""
UNRESOLVED = 0.02
"""A block whose samples leave more than this part of their spread unexplained is halved."""
ROUNDED = 1e-9
"""... unless that is less than this part of the largest sample."""
DEEPEST = 14
"""Halvings of one step; a jump of a guard's signal is closed in on no further."""
AROUND = 6
"""Grid points on either side of an extremum of the polynomial where the true one is sought."""
NEAR = 0.05
"""An extremum is searched if the polynomial comes this near to zero, as a part of the spread."""
_STILL = ("in:", "on:", "at:")
"""What is constant while time passes: a guard of these alone changes only at an event."""
SEARCH = 40
"""Most iterations of one root or extremum search."""


@dataclass(frozen=True, slots=True)
class Watched:
    """The guards that may leave the current mode.

    Parameters
    ----------
    guards : tuple of Followed
    rounded : bool
        Whether a guard leaves as soon as it holds with rounding counted as zero. What ends sliding
        is asked without.
    """

    guards: tuple[Followed, ...]
    rounded: bool = True

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules that the guards belong to."""
        return tuple(g.rule for g in self.guards)


def watch(guards: Guards, mode: Mode, machines: Sequence[Machine] | None = None) -> Watched:
    """Return the guards that leave `mode`.

    `machines` are those of the graph with the rules in force, if not their own.
    """
    return Watched(
        tuple(
            guards.followed(rule)
            for m, k in zip(machines or guards.program.graph.machines, mode, strict=True)
            for rule in m.rules
            if rule.source == k and any(not n.startswith(_STILL) for n in names(rule.guard))
        )
    )


@dataclass(frozen=True, slots=True)
class _Shape:
    """What the samples of all atoms of a block look like, at once.

    Parameters
    ----------
    rest : array, shape (atoms,)
        What a polynomial leaves of the samples.
    doubtful : array of int
        Atoms of which it leaves too much, unless that is rounding beside the sides compared.
    calm : array of bool, shape (guards,)
        All atoms keep their sign, and stay away from zero between samples or on it.
    turn : array, shape (guards,)
        About when the first atom changes sign, as a fraction of the block; infinite if none does.
    """

    rest: Vector
    doubtful: NDArray[np.intp]
    calm: NDArray[np.bool_]
    turn: Vector

    @staticmethod
    def of(atoms: Sequence[Sequence[Vector]]) -> _Shape:
        """Look at the atoms of each guard."""
        d = np.array([a for ds in atoms for a in ds]).reshape(-1, len(FRACTIONS))
        rest = np.abs(d @ LEFT_OVER.T).max(axis=1, initial=0.0)
        spread, size = np.ptp(d, axis=1), np.abs(d).max(axis=1)
        shown = (rest <= UNRESOLVED * spread) | (rest <= ROUNDED * size) | ~np.isfinite(rest)
        up = np.sign(d[:, :1]) * d
        low = np.minimum(up.min(axis=1), (up @ FINE.T).min(axis=1))
        stays = (low > NEAR * spread + 3.0 * rest) | (size == 0.0)
        calm = np.ones(len(atoms), dtype=bool)
        guard = np.repeat(np.arange(len(atoms)), [len(ds) for ds in atoms])
        calm[guard[~stays]] = False
        turn = np.full(len(atoms), np.inf)
        np.minimum.at(turn, guard, _first_turn(up))
        return _Shape(rest, np.flatnonzero(~shown), calm, turn)


def _first_turn(up: Vector) -> Vector:
    """Return where samples that begin positive first become negative; infinite if never."""
    below = up < 0.0
    i = below.argmax(axis=1)
    rows = np.arange(len(up))
    high, low = up[rows, i - 1], up[rows, i]
    share = high / np.where(below.any(axis=1), high - low, 1.0)
    at = FRACTIONS[i - 1] + share * (FRACTIONS[i] - FRACTIONS[i - 1])
    return np.where(below.any(axis=1), at, np.inf)


@dataclass(slots=True)
class Locator:
    """Finds the first instant of a step at which a guard holds."""

    program: Program
    settler: Settler
    equations: ModeEquations
    interval: Interval
    watched: Watched
    _points: dict[tuple[float, bytes], Pairs] = field(init=False, default_factory=dict)
    """Signals at points of this step: many guards ask about the same ones."""
    _seen: dict[float, list[float]] = field(init=False, default_factory=dict)
    """The same without what rounding is measured by, for the search of roots."""

    def first(self, step: Step) -> float | None:
        """Return the first instant in ``(t0, t1]`` at which a guard holds, or None."""
        guards = self.watched.guards
        if not guards:
            return None
        self._points.clear()
        self._seen.clear()
        blocks = [(step.t0, step.t1, 0)]
        # a guard may divide by what is zero at a sample; settling refuses it by name if it must
        with np.errstate(all="ignore"):
            while blocks:
                low, high, depth = blocks.pop()
                t = low + (high - low) * FRACTIONS
                t[-1] = high
                values = self._sample(step, t)
                atoms = [[np.broadcast_to(f(values), t.shape) for f in g.arrays] for g in guards]
                shape = _Shape.of(atoms)
                if depth < DEEPEST and not self._resolved(shape, values):
                    middle = 0.5 * (low + high)
                    blocks += [(middle, high, depth + 1), (low, middle, depth + 1)]
                    continue
                found: float | None = None
                for k in np.argsort(shape.turn, kind="stable").tolist():
                    truth = np.asarray(guards[k].array_test(values), dtype=bool)
                    if shape.calm[k] and not truth.any():
                        continue
                    truth = np.broadcast_to(truth, t.shape)
                    at = self._of_rule(k, step, t, truth, atoms[k], found)
                    if at is not None and (found is None or at < found):
                        found = at
                if found is not None:
                    return found
        return None

    def _resolved(self, shape: _Shape, values: list[Vector]) -> bool:
        """Whether the samples show all that the guards do, rounding left out."""
        if not len(shape.doubtful):
            return True
        sizes = [f for g in self.watched.guards for f in g.sizes]
        # what a bond variable cancels from: its own value may be nothing but rounding
        slots, nx = self.program.slots, self.program.nx
        v = [float(a[0]) for a in values]
        x = np.array(v[slots.x])[:nx]
        terms = self.equations.solution(v, x).size
        bonds = self.settler.trials.measured(self.equations, x, terms)
        magnitudes: list[Vector] = list(values)
        magnitudes[slots.w] = [
            np.maximum(np.abs(a), b) for a, b in zip(values[slots.w], bonds, strict=True)
        ]
        return all(
            float(np.max(sizes[j](magnitudes))) * ROUNDING >= shape.rest[j] for j in shape.doubtful
        )

    def _sample(self, step: Step, t: Vector) -> list[Vector]:
        rows = [
            step.y0 if a == step.t0 else step.y1 if a == step.t1 else step.interpolant(a)
            for a in t.tolist()
        ]
        y = np.array(rows)
        return list(self.program.evaluate_many(t, y, self.interval, self.equations))

    def _of_rule(
        self,
        k: int,
        step: Step,
        t: Vector,
        truth: NDArray[np.bool_],
        atoms: list[Vector],
        before: float | None,
    ) -> float | None:
        end = math.inf
        if before is not None and not self._test(k, step, before):
            # unless it holds and ceases to before that, it becomes true later than another guard
            end = before
        candidates = set(t[1:][truth[1:]].tolist())
        beside: list[float] = []
        for j, d in enumerate(atoms):
            turns = self._extrema(k, j, step, t, d, end)
            candidates.update(turns)
            if len(atoms) > 1:
                beside += [r for c in turns for r in self._beside(k, j, step, t, c)]
        if len(atoms) > 1:
            # a window between two crossings may be narrower than the sampling: ask halfway
            # between any two neighbouring roots
            roots = [
                self._root(k, j, step, float(t[i]), float(t[i + 1]))[1]
                for j, d in enumerate(atoms)
                for i in np.flatnonzero((np.sign(d[:-1]) * np.sign(d[1:]) < 0) & (t[:-1] < end))
            ]
            roots += beside
            if roots:
                marks = sorted([*roots, *t.tolist()])
                candidates.update(roots)
                candidates.update(0.5 * (x + y) for x, y in pairwise(marks) if y - x > 0.0)
        for c in sorted(candidates):
            # true at c: it may have become so at any time after the candidate before
            low = max([float(t[0]), *(a for a in (*t.tolist(), *candidates) if a < c)])
            if c >= end or (before is not None and low >= before):
                break
            if c > step.t0 and self._test(k, step, c):
                return self._bracket(k, step, low, c)
        return None

    def _values(self, step: Step, t: float) -> list[float]:
        found = self._seen.get(t)
        if found is None:
            found = self._seen[t] = self._evaluate(step, t)
        return found

    def _evaluate(self, step: Step, t: float) -> list[float]:
        y = step.y1 if t == step.t1 else step.y0 if t == step.t0 else step.interpolant(t)
        return self.program.evaluate(t, np.asarray(y), self.interval, self.equations)

    def _atom(self, k: int, j: int, step: Step, t: float) -> float:
        return float(self.watched.guards[k].atoms[j](self._values(step, t)))

    def _test(self, k: int, step: Step, t: float) -> bool:
        """Ask the guard as settling will: with rounding counted as zero."""
        y = step.y1 if t == step.t1 else step.interpolant(t)
        return self.holds(self.watched.guards[k].rule, t, np.asarray(y))

    def holds(self, rule: Rule, t: float, y: Vector) -> bool:
        """Return the truth of a guard at a point of the motion."""
        return self.settler.holds(rule, self.pairs(t, y), rule.text)

    def pairs(self, t: float, y: Vector) -> Pairs:
        """Return all signals at a point of the motion; nothing jumps there."""
        key = t, y.tobytes()
        found = self._points.get(key)
        if found is None:
            found = self._points[key] = self._pairs(t, y)
        return found

    def _pairs(self, t: float, y: Vector) -> Pairs:
        program = self.program
        nx, ns = program.nx, program.ns
        v = program.values(t, self.interval, self.equations.mode, y[:nx], y[nx : nx + ns])
        solution = self.equations.solution(v, y[:nx])
        n = program.slots.size
        size = np.abs(v[:n])
        trials = self.settler.trials
        size[program.slots.w] = trials.measured(self.equations, y[:nx], solution.size)
        return steady(v, size.tolist())

    def _beside(self, k: int, j: int, step: Step, t: Vector, c: float) -> list[float]:
        """Return the roots of an atom on both sides of an extremum beyond zero between samples.

        Another comparison may hold on one side of it only: of a ball that grazes, on the way up.
        """
        after = int(np.searchsorted(t, c))
        if not 0 < after < len(t) or float(t[after]) == c:
            return []
        middle = self._atom(k, j, step, c)
        ends = [(float(t[after - 1]), c), (c, float(t[after]))]
        outer = [self._atom(k, j, step, low if low != c else high) for low, high in ends]
        return [
            self._root(k, j, step, low, high)[1]
            for (low, high), value in zip(ends, outer, strict=True)
            if value * middle < 0.0
        ]

    def _extrema(self, k: int, j: int, step: Step, t: Vector, d: Vector, end: float) -> list[float]:
        """Return extrema of an atom that reach, or nearly reach, zero between samples.

        Those that lie beyond `end` altogether are left out. The samples' polynomial shows where
        they are, also next to the ends of a block.
        """
        near = NEAR * float(np.ptp(d)) + 3.0 * float(np.abs(LEFT_OVER @ d).max())
        found: list[float] = []
        for sign in (1.0, -1.0):
            if (sign * d > 0.0).any():
                found += self._dips(k, j, step, t, sign * d, sign, near, end)
        return found

    def _dips(
        self, k: int, j: int, step: Step, t: Vector, d: Vector, sign: float, near: float, end: float
    ) -> list[float]:
        """Return minima of ``d = sign * atom`` near zero, between samples where it is positive."""
        fine = FINE @ d
        last = len(fine) - 1
        after = np.searchsorted(FRACTIONS, GRID[1:-1], side="right")
        inner = 1 + np.flatnonzero(
            (fine[1:-1] <= fine[:-2])
            & (fine[1:-1] <= fine[2:])
            & (fine[1:-1] <= near)
            & (d[after - 1] > 0.0)
            & (d[after] > 0.0)
        )
        brackets = [(max(i - AROUND, 0), min(i + AROUND, last)) for i in inner.tolist()]
        # the polynomials of two neighbouring blocks may each place an extremum in the other
        for edge, away, at in ((0, AROUND, 0), (last, last - AROUND, -1)):
            if 0.0 < d[at] <= near and fine[edge] <= fine[away]:
                begin, there = (float(t[0] + (t[-1] - t[0]) * GRID[m]) for m in (edge, away))
                if sign * self._atom(k, j, step, begin + 1e-3 * (there - begin)) < d[at]:
                    brackets.append((min(edge, away), max(edge, away)))
        found: list[float] = []
        for low, high in brackets:
            begin, until = (float(t[0] + (t[-1] - t[0]) * GRID[m]) for m in (low, high))
            if begin < end:
                found += self._dip(k, j, step, begin, until, sign)
        return found

    def _dip(self, k: int, j: int, step: Step, low: float, high: float, sign: float) -> list[float]:
        """Return the instant where ``sign * atom`` is least (golden section), if near zero."""
        ratio = 0.5 * (math.sqrt(5.0) - 1.0)
        a, b = low, high
        c, d = b - ratio * (b - a), a + ratio * (b - a)
        fc, fd = (sign * self._atom(k, j, step, x) for x in (c, d))
        for _ in range(SEARCH):
            if min(fc, fd) <= 0.0:
                return [c if fc <= fd else d]
            if fc < fd:
                b, d, fd = d, c, fc
                c = b - ratio * (b - a)
                fc = sign * self._atom(k, j, step, c)
            else:
                a, c, fc = c, d, fd
                d = a + ratio * (b - a)
                fd = sign * self._atom(k, j, step, d)
        return [c if fc <= fd else d]

    def _root(self, k: int, j: int, step: Step, low: float, high: float) -> tuple[float, float]:
        """Return a bracket of the sign change of an atom, a few units in the last place wide."""
        a, b = low, high
        fa, fb = self._atom(k, j, step, a), self._atom(k, j, step, b)
        if fa == 0.0 or fa * fb > 0.0:
            return low, high
        side = 0
        wide = 4.0 * np.spacing(max(abs(low), abs(high)))
        for _ in range(SEARCH):
            if b - a <= wide or fb == 0.0:
                break
            c = b - fb * (b - a) / (fb - fa)
            # a step off either end keeps the bracket shrinking from both sides
            c = min(max(c, a + 0.25 * wide), b - 0.25 * wide)
            fc = self._atom(k, j, step, c)
            if fc * fb > 0.0 or fc == 0.0:
                b, fb = c, fc
                fa = 0.5 * fa if side > 0 else fa
                side = 1
            else:
                a, fa = c, fc
                fb = 0.5 * fb if side < 0 else fb
                side = -1
        return a, b

    def _bracket(self, k: int, step: Step, low: float, high: float) -> float:
        """Return the first instant in ``(low, high]`` at which guard k holds."""
        before, after = self._values(step, low), self._values(step, high)
        atoms = self.watched.guards[k].atoms
        turned = [
            j
            for j, f in enumerate(atoms)
            if (f(before) > 0.0) != (f(after) > 0.0) or f(before) * f(after) == 0.0
        ]
        if len(turned) == 1 and _crosses(atoms[turned[0]], before, after):
            low, high = self._around(
                k, step, low, self._root(k, turned[0], step, low, high)[1], high
            )
        wide = 4.0 * float(np.spacing(max(abs(low), abs(high))))
        while high - low > wide:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self._test(k, step, middle) else (middle, high)
        return high

    def _around(
        self, k: int, step: Step, low: float, root: float, high: float
    ) -> tuple[float, float]:
        """Return a bracket, near the root of its comparison, of the instant where a guard holds.

        It may hold a little before the root, because rounding counts as zero, or a little after,
        where the comparison is strict. All guards are asked alike, and by the same test as
        settling: a bounce ever smaller begins and ends at the same distance then.
        """
        reach = 4.0 * float(np.spacing(root))
        if self._test(k, step, root):
            if not self.watched.rounded:
                return root, root
            yes = root
            while (at := root - reach) > low and self._test(k, step, at):
                yes, reach = at, 2.0 * reach
            return max(at, low), yes
        no = root
        while (at := root + reach) < high and not self._test(k, step, at):
            no, reach = at, 2.0 * reach
        return no, min(at, high)


def _crosses(
    atom: Callable[[Sequence[float]], float], before: Sequence[float], after: Sequence[float]
) -> bool:
    """Whether an atom passes or reaches zero: a restart exactly on it has no sign to begin with."""
    return atom(before) != 0.0 and atom(before) * atom(after) <= 0.0
