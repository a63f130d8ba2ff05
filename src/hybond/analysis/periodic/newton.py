"""Newton's method for a state that a period leads back to itself.

    J d = -(F(x) - x),   J = M - 1                       what drives the motion says how long T is
    [J  f] [d ]    [-(F(x) - x)]
    [f0 0] [dT] =  [     0     ]                         nothing drives it: T is unknown, too

with f the rates at the end, and f0 those at the beginning: of all the states of the orbit the one
is taken that is nearest. States are measured by the largest value that each has had. What the
motion conserves, l (F(x) - x) = 0 for all x, makes J singular with l J = 0; the step then keeps
it, l d = 0, and else is the smallest.

Where the end is off along the motion alone, only T is changed: where every motion repeats, as
without losses and sources, the one found is the one begun with.

A step that does not bring the end nearer to the beginning is halved, and after `HALVINGS` the
period is run on instead, as it is where the end has another mode or no derivative.
Source: Aprille and Trick, Steady-state analysis of nonlinear circuits with periodic inputs,
Proceedings of the IEEE 60, 1972.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.periodic.multipliers import is_double
from hybond.analysis.periodic.shots import Shot, Shots
from hybond.errors import HybondError, NumericsError
from hybond.model.graph import Mode
from hybond.result import Result

Vector = NDArray[np.float64]

HALVINGS = 3
FREE = 1e-9
"""Singular values of the scaled J below this part of the largest count as zero."""
ROUNDING = 1e-12
"""So do those below this: the difference of M and 1 is not known better."""
OTHER_MODES = 12
"""Periods in a row that may end in another mode than they begin with."""
DRIFTS = 6
"""Steps in a row in which something goes on changing whatever the state is."""
LATER, MOST_LATER = 16, 1000
"""Periods after which is seen whether what goes on changing runs away."""
CLOSE = 1e-7
"""How near end and beginning are, as a part of states, where rounding lets them come no nearer."""
STILL = 1e-7
"""Part of itself by which a state moves at the least within a period, or nothing does."""
MISSED = 1e-4
"""Part of what a motion of its own period moves by that its end is off at the most."""
ALONG = 0.05
"""Part of what the end is off by that is left at the most, where only the period is too long."""
SAME = 1e-5
"""Part of a period, for each part of a state, by which it changes within a family at the least."""
ELSEWHERE = 1e-6
"""Part of a state by which the orbit found is not the one that the search began on."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A shot that ends where it begins.

    Parameters
    ----------
    shot : Shot
    sizes : array, shape (n,)
        What states are measured by.
    kept : list of int
        States that come back: not integrals that nothing reads.
    free : tuple of str
        For each quantity that is conserved, what it is made of.
    residual : float
        Largest part of a state by which the end is off.
    history : tuple of float
        The same of all shots.
    notes : tuple of str
    """

    shot: Shot
    sizes: Vector
    kept: list[int]
    free: tuple[str, ...]
    residual: float
    history: tuple[float, ...]
    notes: tuple[str, ...]


@dataclass
class Newton:
    """The search for a state that a period leads back to itself.

    Parameters
    ----------
    shots : Shots
    own : bool
        Whether the length of the period is unknown, too.
    sizes : array, shape (n,)
        What states are measured by, as far as is known; 0 where it is not.
    tol : float
        Part of a state by which the end may be off.
    most : int
        Shots.
    """

    shots: Shots
    own: bool
    sizes: Vector
    tol: float
    most: int
    T_by: Vector | None = None
    history: list[float] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    _others: int = 0
    _drifting: int = 0

    def found(self, x: Vector, mode: Mode, T: float) -> Found:
        """Return the shot that ends where it begins.

        Raises
        ------
        NumericsError
            HB-A540 if there is none, HB-A542 where it has no derivative.
        """
        shot = self.shot(x, mode, T)
        self._begun = shot
        while True:
            off = self.off(shot)
            if shot.end_mode != shot.mode:
                self._other_mode(shot)
                shot = self._on(shot)
                continue
            self._others = 0
            if (off <= self.tol and self._is_whole(shot, off)) or self._settled():
                return self._done(shot)
            if shot.M is None:
                self._note(f"periods are run on where there is no derivative: {shot.why}")
                shot = self._on(shot)
                continue
            shot = self._ahead(shot, off)

    def shot(self, x: Vector, mode: Mode, T: float) -> Shot:
        """Return a shot, and note how far its end is off."""
        if self.shots.done >= self.most:
            self._none(f"{self.most} periods were run, and none ends where it begins", None)
        found = self.shots.shot(x, mode, T, self.T_by)
        for segment in found.run.segments:
            n = len(self.sizes)
            own = np.abs(segment.y[:, :n]).max(axis=0, initial=0.0)
            self.sizes = np.maximum(self.sizes, own)
        self.history.append(self.off(found))
        self._last = found
        return found

    @property
    def units(self) -> Vector:
        """What states are measured by."""
        return np.where(self.sizes > 0.0, self.sizes, 1.0)

    def off(self, shot: Shot) -> float:
        """Return the largest part of a state by which the end is off."""
        kept = self.kept(shot)
        return float((np.abs(shot.end - shot.x) / self.units)[kept].max(initial=0.0))

    def kept(self, shot: Shot) -> list[int]:
        """Return the states that have to come back: not integrals that nothing reads."""
        n, read = len(shot.x), self.shots.read
        if shot.M is None:
            return read
        unit = np.eye(n)
        return [k for k in range(n) if k in read or (shot.M[:, k] != unit[:, k]).any()]

    def system(self, shot: Shot) -> tuple[Vector, Vector, list[int]]:
        """Return the scaled J, bordered where T is unknown, the right side, and states kept."""
        assert shot.M is not None and shot.first is not None and shot.last is not None
        kept = self.kept(shot)
        unit = self.units[kept]
        J = (shot.M[np.ix_(kept, kept)] - np.eye(len(kept))) * unit / unit[:, None]
        right = -(shot.end - shot.x)[kept] / unit
        if not self.own:
            return J, right, kept
        many = len(kept)
        whole = np.zeros((many + 1, many + 1))
        whole[:many, :many] = J
        whole[:many, many] = shot.last[kept] / unit * shot.T
        row = shot.first[kept] / unit * shot.T
        whole[many, :many] = row / max(float(np.linalg.norm(row)), 1e-300)
        return whole, np.append(right, 0.0), kept

    def _ahead(self, shot: Shot, off: float) -> Shot:
        """Return the shot after Newton's step, or as much of it as brings the end nearer."""
        J, right, kept = self.system(shot)
        self._drifts(shot, J, right, kept)
        if self.own and (longer := self._longer(shot, J, right, off)) is not None:
            return longer
        step = smallest_step(J, right)
        part = 1.0
        for _ in range(HALVINGS + 1):
            x = shot.x.copy()
            x[kept] += part * step[: len(kept)] * self.units[kept]
            T = shot.T * (1.0 + part * float(step[-1])) if self.own else shot.T
            if 0.2 * shot.T < T < 5.0 * shot.T:
                try:
                    trial = self.shot(x, shot.mode, T)
                except HybondError as error:
                    if error.code == "HB-A540" and self.shots.done >= self.most:
                        raise
                    self._note(f"a step was halved, its period cannot be run: {error.why}")
                else:
                    if self.off(trial) <= max((1.0 - 0.1 * part) * off, self.tol):
                        return trial
            part /= 2.0
        self._note("where no part of a step came nearer the period was run on")
        return self._on(shot)

    def _longer(self, shot: Shot, J: Vector, right: Vector, off: float) -> Shot | None:
        """Return the shot that is as much longer as it takes, where nothing else is wrong.

        The state stays: where every motion repeats, this is the one that was begun with.
        """
        f, left = J[:-1, -1], right[:-1]
        part = float(f @ left) / max(float(f @ f), 1e-300)
        if np.linalg.norm(left - part * f) > ALONG * np.linalg.norm(left) or abs(part) > 0.5:
            return None
        try:
            trial = self.shot(shot.x, shot.mode, shot.T * (1.0 + part))
        except HybondError as error:
            if error.code == "HB-A540" and self.shots.done >= self.most:
                raise
            return None
        return trial if self.off(trial) < 0.9 * off else None

    def _drifts(self, shot: Shot, J: Vector, right: Vector, kept: list[int]) -> None:
        """Refuse a motion in which something goes on changing whatever the state is."""
        rows = conserved(J)
        drift = np.abs(rows @ right)
        if not (drift > max(1e-6, 0.5 * float(np.abs(right).max()))).any():
            self._drifting = 0
            return
        self._drifting += 1
        if self._drifting < DRIFTS:
            return
        k = int(np.argmax(np.abs(rows[int(np.argmax(drift))][: len(kept)])))
        change = float(shot.end[kept[k]] - shot.x[kept[k]])
        name = self.shots.names[kept[k]]
        if self._comes_again(shot, kept[k], change):
            self._none(
                f"{name} has a rhythm of its own, which nothing ties to the {shot.T:.6g} s: it is "
                f"off by {change:.6g} after each of them",
                shot,
                hint="couple the two, or say a time after which both are where they were: period=, "
                "multiple=",
            )
        self._none(
            f"{name} goes on changing, by {change:.6g} in each period, whatever the state is",
            shot,
            hint="what comes in has to go out again: a leak, a load, a balance",
        )

    def _comes_again(self, shot: Shot, k: int, change: float) -> bool:
        """Whether a state that is off after each period goes round, and does not run away."""

        def range_of(run: Result) -> float:
            return float(np.ptp(np.concatenate([segment.y[:, k] for segment in run.segments])))

        many = min(max(4 * round(range_of(shot.run) / abs(change)), LATER), MOST_LATER)
        begin = self.shots.state(shot.x, shot.mode)
        try:
            run = self.shots.run(self.shots.t0 + many * shot.T, begin)
        except HybondError:
            return False
        return range_of(run) < 0.5 * many * abs(change)

    def _on(self, shot: Shot) -> Shot:
        return self.shot(shot.end, shot.end_mode, shot.T)

    def _settled(self) -> bool:
        """Whether rounding keeps the end from coming nearer."""
        last = self.history[-4:]
        if len(last) < 4 or max(last) > CLOSE or min(last[2:]) < 0.5 * min(last[:2]):
            return False
        self._note(f"the end is off by {last[-1]:.2g} of a state, and comes no nearer")
        return True

    def _other_mode(self, shot: Shot) -> None:
        self._others += 1
        if self._others > OTHER_MODES:
            graph = self.shots.graph
            self._none(
                f"each period ends in another mode than it begins with: "
                f"({graph.mode_text(shot.mode)}), then ({graph.mode_text(shot.end_mode)})",
                shot,
                hint="the motion may repeat after two periods: multiple=2",
            )
        self._note("the period was run on where it ended in another mode than it began with")

    def _note(self, text: str) -> None:
        if text not in self.notes:
            self.notes.append(text)

    def _done(self, shot: Shot) -> Found:
        if shot.M is None:
            error = NumericsError(
                f"the motion repeats, but nearby motions cannot be followed: {shot.why}",
                code="HB-A542",
                where=f"T = {shot.T:.9g} s",
                hint="take other values: where a guard is only touched, orbits begin and end",
            )
            error.partial = shot.run
            raise error
        kept = self.kept(shot)
        self._is_moving(shot)
        off = self.off(shot)
        notes = list(self.notes)
        for k in range(len(shot.x)):
            change = shot.end[k] - shot.x[k]
            if k not in kept and abs(change) > self.tol * self.units[k]:
                name = self.shots.names[k]
                notes.append(f"{name} moves by {change:.9g} in each period; nothing reads it")
        free = self._free(shot)
        if self.own and free:
            notes += self._of_family(shot, kept)
        return Found(shot, self.units, kept, free, off, tuple(self.history), tuple(notes))

    def _of_family(self, shot: Shot, kept: list[int]) -> list[str]:
        """Return what is to be said of a motion of its own period beside which there are others."""
        J, _, _ = self.system(shot)
        _, values, v = np.linalg.svd(J)
        rank = int((values > max(FREE * values.max(initial=0.0), ROUNDING)).sum())
        found = []
        if rank < len(J) and (np.abs(v[rank:, -1]) <= SAME).all():
            found.append("a centre: all others near it repeat with the same period")
        begun = self._begun
        moved = float((np.abs(shot.x - begun.x) / self.units)[kept].max(initial=0.0))
        if moved > ELSEWHERE:
            found.append(
                f"the motion that the search began with is another one, {moved:.2g} of a state "
                "beside it, and repeats later or never"
            )
        return found

    def _is_moving(self, shot: Shot) -> None:
        """Refuse a motion of its own period that is none."""
        if self.own and self._moved(shot) <= STILL:
            self._none(
                "the search ended where nothing moves: at an equilibrium",
                shot,
                hint="start on another side of it, or further away",
            )

    def _is_whole(self, shot: Shot, off: float) -> bool:
        """Whether the end is off by little of what moves, so that a swing that shrinks is none."""
        if not self.own:
            return True
        moved = self._moved(shot)
        return moved <= STILL or off <= MISSED * moved

    def _moved(self, shot: Shot) -> float:
        """Return the largest part of a state by which one moves within the period."""
        n = len(shot.x)
        rows = np.concatenate([segment.y[:, :n] for segment in shot.run.segments])
        return float((np.ptp(rows, axis=0) / self.units).max(initial=0.0))

    def _free(self, shot: Shot) -> tuple[str, ...]:
        """Return what conserved quantities are made of."""
        J, _, kept = self.system(shot)
        found: list[str] = []
        rows = conserved(J)
        assert shot.M is not None
        if self.own and not len(rows):
            block = shot.M[np.ix_(kept, kept)]
            rows = np.linalg.svd(J)[0][:, -1:].T if is_double(block, self.units[kept]) else rows
        for left in rows:
            part = np.abs(left[: len(kept)])
            own = [self.shots.names[kept[k]] for k in np.flatnonzero(part > 1e-6 * part.max())]
            found.append(", ".join(own))
        return tuple(found)

    def _none(self, why: str, shot: Shot | None, hint: str = "") -> NoReturn:
        best = min(self.history, default=np.inf)
        history = ", ".join(f"{v:.3g}" for v in self.history[-8:])
        notes = "".join(f"; {note}" for note in self.notes)
        error = NumericsError(
            f"no periodic orbit was found: {why}. The nearest was off by {best:.3g} of a state; "
            f"the last ones by {history}{notes}",
            code="HB-A540",
            where=f"after {self.shots.done} runs",
            hint=hint or "let it settle longer (settle=...), start nearer, or ask for multiple=2",
        )
        error.partial = (shot or self._last).run
        raise error


def conserved(J: Vector) -> Vector:
    """Return what ``l J = 0`` says is conserved, a row each."""
    u, values, _ = np.linalg.svd(J)
    rank = int((values > max(FREE * values.max(initial=0.0), ROUNDING)).sum())
    return np.asarray(u[:, rank:].T)


def smallest_step(J: Vector, right: Vector) -> Vector:
    """Return the solution of ``J d = right`` that keeps what is conserved, else the smallest.

    Examples
    --------
    The difference of both is conserved:

    >>> import numpy as np
    >>> J = np.array([[-0.5, 0.0], [-0.5, 0.0]])
    >>> smallest_step(J, np.array([1.0, 1.0])).round(9).tolist()
    [-2.0, -2.0]
    """
    if not len(J):
        return np.zeros(0)
    kept = conserved(J)
    whole, value = np.vstack([J, kept]), np.append(right, np.zeros(len(kept)))
    return np.asarray(np.linalg.lstsq(whole, value, rcond=FREE)[0])
