"""Looking into the motion of finished runs: what may be asked, checked before an engine is."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from hybond.engine.compiled.points import Numbers, Points, Steps, Vector, Within, floats, whole
from hybond.engine.tables import ModelTables
from hybond.records import dataclass

AT_ONCE = 4096
"""Points between two looks at the world outside: a call of the library cannot be interrupted."""


@dataclass(frozen=True, slots=True)
class Motion:
    """What is looked into, as `Look.into` has it."""

    t: float
    state: Numbers
    landed: Numbers
    surfaces: Numbers
    product: bool
    modes: Numbers
    energy: float


@dataclass(frozen=True, slots=True)
class Motions:
    """Motions one after the other in which nothing is slid on."""

    t: Vector
    """Shape (motions,). When each begins, s."""
    state: Numbers
    landed: Numbers
    """Shape (motions, machines). `state` and `landed`: the states of machines, and whether each has
    landed."""
    first: Numbers
    """Shape (motions + 1,). Where the points of each begin, and where the last ones end."""
    energy: float
    """The largest energy that the run has seen, J."""


class Look(ABC):
    """Looks into the motion of finished runs of a model: by one thread at a time.

    First `into` says what the motion is, from its mode to what it slides on; what is asked next
    lies there. It does not matter what was looked into before.
    """

    def __init__(self, tables: ModelTables) -> None:
        self._numbers = tables.numbers
        self._lock = threading.Lock()
        self._parts = 0
        self._states = int(tables.numbers["storages"] + tables.numbers["integrals"])
        first = np.array(tables.ints["state_first"])
        self._state_first = first[:-1]
        self._states_of = np.diff(first)
        self._contact_at = np.array(tables.ints["contact_at"], dtype=int)

    @abstractmethod
    def _enter(self, motion: Motion) -> int:
        """Take the equations of a motion; return how many modes are combined there."""

    @abstractmethod
    def _follow(self, when: Vector, roots: Vector) -> None:
        """Follow the solutions that a motion had."""

    @abstractmethod
    def _modes(self) -> Numbers:
        """Return the states of machines in each of these modes."""

    @abstractmethod
    def _ask(
        self,
        what: str,
        points: Points | Within,
        first: int,
        last: int,
        outs: tuple[Vector, ...],
        slots: Numbers | None,
        end: Vector | None,
    ) -> None:
        """Put there what is asked for at points from `first` to before `last`.

        `what` is the name of the public method; `outs` are rows of these points.
        """

    @abstractmethod
    def _along(
        self,
        what: str,
        motions: Motions,
        points: Within,
        out: Vector,
        slots: Numbers | None,
        end: Vector | None,
    ) -> None:
        """Put there what is asked for at points of many motions, as `_ask` does at those of one."""

    @abstractmethod
    def _sources(self) -> tuple[Numbers, Numbers] | None:
        """Return the sources of a linear mode, and which of their rates are asked for."""

    @abstractmethod
    def _by_knowns(self, known: Vector) -> Vector:
        """Return what rows of knowns make in a linear mode."""

    @abstractmethod
    def _stored(self, y: Vector) -> Vector:
        """Return the stored energy of each row of states."""

    def into(
        self,
        t: float,
        state: ArrayLike,
        *,
        landed: ArrayLike = False,
        surfaces: Sequence[int] = (),
        product: bool = False,
        modes: ArrayLike | None = None,
        energy: float = 0.0,
    ) -> None:
        """Look into a motion.

        Parameters
        ----------
        t : float
            When it begins, s: inputs and comparisons of time are those of the interval that begins
            then or that contains it.
        state : array of int, shape (machines,)
            The state of each machine.
        landed : bool or array of bool, shape (machines,)
            Which of them have landed.
        surfaces : sequence of int
            The switching surfaces that are slid on, by their number in the tables.
        product : bool
            Whether all corners of the cube of their weights are combined.
        modes : array of int, shape (parts, machines), optional
            The states of machines in the modes that are combined: of them the branches of junction
            laws are taken, which are those of `state` if it is not given.
        energy : float
            The largest energy that the run has seen, J: what rounding is measured by.

        Raises
        ------
        ValueError
            For a time outside the run, or a machine, state or surface that there is not.
        NumericsError
            If the motion cannot be looked into.
        MemoryError
        """
        machines, many = int(self._numbers["machines"]), self._numbers["surfaces"]
        until = self._numbers["until"]
        if not 0.0 <= t <= until:
            raise ValueError(f"a run from 0 to {until} s does not have {t} s")
        if not 0.0 <= energy < np.inf:
            raise ValueError(f"energy = {energy}")
        mode = whole(state, "state")
        if mode.shape != (machines,):
            raise ValueError(f"the states of {machines} machines, not shape {mode.shape}")
        if not ((mode >= 0) & (mode < self._states_of)).all():
            raise ValueError("a machine does not have that state")
        on = np.ascontiguousarray(
            np.broadcast_to(np.asarray(landed, dtype=bool), mode.shape), dtype=np.intc
        )
        if (self._contact_at[(self._state_first + mode)[on != 0]] < 0).any():
            raise ValueError("a machine has landed in a state that closes no contact")
        found = whole(surfaces, "surfaces")
        if len(set(found.tolist())) != len(found):
            raise ValueError("surfaces: each once")
        if not ((found >= 0) & (found < many)).all():
            raise ValueError("a surface that there is not")
        rows = np.zeros((0, machines), dtype=np.intc)
        if modes is not None:
            rows = np.ascontiguousarray(modes, dtype=np.intc)
            if rows.ndim != 2 or rows.shape[1] != machines:
                raise ValueError(f"modes of {machines} machines, not shape {rows.shape}")
            if not ((rows >= 0) & (rows < self._states_of)).all():
                raise ValueError("a machine does not have that state")
        with self._lock:
            # into nothing, if that fails
            self._parts = 0
            self._parts = self._enter(Motion(t, mode, on, found, product, rows, energy))

    def follow(self, when: ArrayLike, roots: ArrayLike) -> None:
        """Follow the solution that the motion had of laws with several.

        Parameters
        ----------
        when : array, shape (points,)
            Times of the motion, in order, s.
        roots : array, shape (points, bond variables)
            What bond variables were then; between two points that is as good as straight.

        Raises
        ------
        ValueError
            For other shapes, or what is not finite.
        """
        self._ready()
        times, found = floats(when, 1, "when"), floats(roots, 2, "roots")
        if len(times) != len(found) or not found.size:
            raise ValueError("solutions and times do not belong together")
        with self._lock:
            self._follow(times, found)

    def modes(self) -> Numbers:
        """Return the states of machines in each mode that is combined, shape (parts, machines).

        Where nothing is slid on there is one.
        """
        self._ready()
        with self._lock:
            return self._modes()

    def values(self, points: Points | Within, slots: ArrayLike) -> Vector:
        """Return values at points, shape (points, slots).

        Parameters
        ----------
        slots : array of int
            Which: slots of the vector of values, those of stored quantities and integrated signals
            with the state put back on its constraints; a second copy follows, a priori values.
            While machines slide it is the average of bond variables.

        Raises
        ------
        ValueError
            For points of another model, or a slot that there is not.
        NumericsError
            If a law has no value at one of the points.
        MemoryError
        """
        chosen = self._slots(slots)
        out = np.zeros((len(points.t), len(chosen)))
        self._look("values", points, (out,), slots=chosen)
        return out

    def values_along(self, motions: Motions, points: Within, slots: ArrayLike) -> Vector:
        """Return values at points of many motions, shape (points, slots).

        Afterwards nothing is looked into.

        Parameters
        ----------
        points : Within
            Those of the first motion first.
        slots : array of int
            As for `values`.

        Raises
        ------
        ValueError, NumericsError, MemoryError
            As `into` and `values`.
        """
        chosen = self._slots(slots)
        out = np.zeros((len(points.t), len(chosen)))
        self._look_along("values", motions, points, out, slots=chosen)
        return out

    def energies_along(self, motions: Motions, points: Within, end: Vector) -> Vector:
        """Return energies from points of many motions on, as `energies`, shape (points, 3).

        Afterwards nothing is looked into.

        Parameters
        ----------
        points : Within
            Those of the first motion first.
        end : array, shape (points,)
            s; in the same step as the point.

        Raises
        ------
        ValueError, NumericsError, MemoryError
            As `into` and `energies`.
        """
        last = floats(end, 1, "end")
        Within(points.steps, last, points.step)
        if last.shape != points.t.shape or (last < points.t).any():
            raise ValueError("each interval has an end behind its begin")
        out = np.zeros((len(last), 3))
        self._look_along("energies", motions, points, out, end=last)
        return out

    def parts(self, points: Points | Within, slots: ArrayLike) -> tuple[Vector, Vector]:
        """Return the share of each mode that is combined, and values in that mode.

        Parameters
        ----------
        slots : array of int
            As for `values`.

        Returns
        -------
        shares : array, shape (points, parts)
            They add up to one.
        values : array, shape (points, parts, slots)

        Raises
        ------
        ValueError, NumericsError, MemoryError
            As `values`.
        """
        chosen = self._slots(slots)
        shares = np.zeros((len(points.t), self._parts))
        out = np.zeros((len(points.t), self._parts, len(chosen)))
        self._look("parts", points, (shares, out), slots=chosen)
        return shares, out

    def powers(self, points: Points | Within) -> Vector:
        """Return power supplied by sources and dissipated by resistors, W, shape (points, 2).

        Bonds on which effort times flow is no power are left out.

        Raises
        ------
        ValueError, NumericsError, MemoryError
            As `values`.
        """
        out = np.zeros((len(points.t), 2))
        self._look("powers", points, (out,))
        return out

    def energies(
        self, steps: Steps, begin: ArrayLike | None = None, end: ArrayLike | None = None
    ) -> Vector:
        """Return energies between pairs of instants, each pair in one step, J, shape (pairs, 3).

        Energy supplied, energy dissipated, and an estimate of the error of either: below a part of
        1e-11 of all that passes but where the powers jump or have many kinks within a step.

        Parameters
        ----------
        begin, end : array, shape (pairs,), optional
            s; from the begin of each step to where it was ended if they are not given.

        Raises
        ------
        ValueError
            For instants that are not in one step, or an end before its begin, or another model.
        NumericsError, MemoryError
            As `values`.
        """
        first = steps.time[:, 0] if begin is None else floats(begin, 1, "begin")
        last = floats(steps.time[:, 2] if end is None else end, 1, "end")
        if first.shape != last.shape or (last < first).any():
            raise ValueError("each interval has an end behind its begin")
        points = Within(steps, first, Within(steps, last).step)
        out = np.zeros((len(first), 3))
        self._look("energies", points, (out,), end=last)
        return out

    def stored(self, y: ArrayLike) -> Vector:
        """Return the energy that is stored in states, J, shape (states,).

        Of nonlinear storage it is counted from where nothing is stored; on bonds where effort times
        flow is no power there is none. It does not matter what is looked into.

        Parameters
        ----------
        y : array, shape (states, stored quantities and integrated signals)

        Raises
        ------
        ValueError
            For states of another model.
        """
        states = floats(y, 2, "y")
        if states.shape[1] != self._states:
            raise ValueError(f"{states.shape[1]} states, the model has {self._states}")
        with self._lock:
            return self._stored(states)

    def sources(self) -> tuple[Numbers, Numbers] | None:
        """Return the sources of the mode, in the order of `by_knowns`, if it is linear.

        Returns
        -------
        sources : array of int
            Their numbers in the tables.
        rated : array of int
            Of each, whether its rate is asked for.
        """
        self._ready()
        with self._lock:
            return self._sources()

    def by_knowns(self, known: ArrayLike) -> Vector:
        """Return the bond variables that are made of what is known in a linear mode.

        Parameters
        ----------
        known : array, shape (rows, storages + 2 * sources)
            Co-energy variables, sources and rates of sources; or derivatives of all of these.

        Returns
        -------
        array, shape (rows, 2 * bonds)

        Raises
        ------
        ValueError
            For a mode that is not linear, or another number of knowns.
        """
        self._ready()
        rows = np.asarray(known, dtype=np.float64, order="C")
        with self._lock:
            found = self._sources()
            if found is None:
                raise ValueError("the mode is not linear")
            size = int(self._numbers["storages"]) + 2 * len(found[0])
            if rows.ndim != 2 or rows.shape[1] != size:
                raise ValueError(f"rows of {size} knowns, not shape {rows.shape}")
            return self._by_knowns(rows)

    def _look(
        self,
        what: str,
        points: Points | Within,
        outs: tuple[Vector, ...],
        *,
        slots: Numbers | None = None,
        end: Vector | None = None,
    ) -> None:
        """Look at all points, some at a time."""
        self._ready()
        if points.states != self._states:
            raise ValueError(f"points with {points.states} states, the model has {self._states}")
        for first in range(0, len(points.t), AT_ONCE):
            last = min(first + AT_ONCE, len(points.t))
            some = tuple(out[first:last] for out in outs)
            with self._lock:
                self._ask(
                    what, points, first, last, some, slots, None if end is None else end[first:last]
                )

    def _look_along(
        self,
        what: str,
        motions: Motions,
        points: Within,
        out: Vector,
        *,
        slots: Numbers | None = None,
        end: Vector | None = None,
    ) -> None:
        """Look at points of many motions."""
        m = motions
        if points.states != self._states or m.state.shape != m.landed.shape:
            raise ValueError("points or motions of another model")
        if m.state.shape != (len(m.t), int(self._numbers["machines"])):
            raise ValueError("motions of another model")
        if not ((m.state >= 0) & (m.state < self._states_of)).all():
            raise ValueError("a machine does not have that state")
        if (self._contact_at[(self._state_first + m.state)[m.landed != 0]] < 0).any():
            raise ValueError("a machine has landed in a state that closes no contact")
        if not ((m.t >= 0.0) & (m.t <= self._numbers["until"])).all() or not m.energy < np.inf:
            raise ValueError("a motion outside the run")
        ends = np.array([0, len(points.t)])
        if (m.first[[0, -1]] != ends).any() or (np.diff(m.first) < 0).any():
            raise ValueError("points that belong to no motion")
        with self._lock:
            self._parts = 0
            self._along(what, motions, points, out, slots, end)

    def _ready(self) -> None:
        if not self._parts:
            raise ValueError("nothing is looked into yet")

    def _slots(self, slots: ArrayLike) -> Numbers:
        found = whole(slots, "slots")
        beyond = 2 * self._numbers["slots"]
        if not ((found >= 0) & (found < beyond)).all():
            raise ValueError(f"slots from 0 to {beyond - 1:.0f}")
        return found
