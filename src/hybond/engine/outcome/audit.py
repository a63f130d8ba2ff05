"""The audit: what must hold in every run, whatever the model.

Power balances over the junction structure at every point; stored plus dissipated minus supplied
energy is constant in every segment; no jump creates energy except by a source.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.engine.method_numbers import MOREAU
from hybond.engine.outcome.balances import Balances, Looked, balances_of
from hybond.engine.outcome.signals import Signals
from hybond.engine.outcome.stretches import Places, Stretch, sizes_of, stretches
from hybond.model.expressions.slots import plain
from hybond.model.graph import FlatGraph, Node
from hybond.model.joined import Joined
from hybond.model.kinds import RESISTORS
from hybond.records import dataclass
from hybond.runs.trace import Segment, Trace, Violation

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_QUIET = 1e-3
"""Part of a run's largest power below which a point's imbalance is measured against that part.

The sum of powers is rounded to some 1e-16 of the largest one, and has to hold to 1e-12 of this.
"""
_IDLE = 1e-6
"""Part of what has passed through all elements below which energy is measured against that part.

Where forces cancel, rounding moves what is at rest: what is stored goes with its square, and what
sources supply adds up to nothing, but the energy that passes from one to another does not.
"""

_CANCELLED = 2e-3
"""Part of what a resistor would take at the largest flow that stands beside what passes: of that
1e-12 may be unbalanced, nine last places of that flow."""
COARSE = 0.1
"""Part of all energy that steps of a fixed length may be off by at the most, however coarse."""
USUAL = 1e-8
"""Tolerance that a run is judged by if its own is tighter: where a law bends, integrating powers
is no better."""


@dataclass(frozen=True, slots=True)
class Audit:
    """The worst imbalance of a run, each as a part of what is balanced.

    Parameters
    ----------
    power : float
        Of the power over the junction structure, at any accepted point.
    energy : float
        Of stored + dissipated - supplied over any segment, as a part of the largest energy that is
        stored, passes, or is taken by one element on balance, or of 1e-6 of all that passes through
        the elements in a segment, if that is more. Of time-stepping: the sum of its rises in the
        balance that each of its steps keeps exactly, the work of its laws and its own damping
        included.
    created : float
        Energy that jumps (or steps of time-stepping) created without a source, as a part of the
        largest energy.
    accuracy : float
        That of time-stepping, as far as it is known: the estimated error of the step.
    laws : tuple of Violation
        Laws that did not hold when the engine put its values back into them.
    beyond : float
        Of `energy`, what is more in single steps than the tolerance of the run lets each of them be
        wrong by: a state that is off by e changes what is stored by e times its co-energy variable.
        The sum of it over any segment.
    rtol : float
        The tolerance that the run was made with.
    """

    power: float
    energy: float
    created: float
    accuracy: float = 0.0
    laws: tuple[Violation, ...] = ()
    beyond: float = math.inf
    rtol: float = 1e-8

    def holds(self, rtol: float | None = None) -> bool:
        """Whether the run keeps its balances at a tolerance, else at that it was made with or 1e-8.

        Energy does not forget: what each of many steps may be wrong by adds up, even where the
        states come back to what they should be. So a run may be off by more than ten times its
        tolerance, if no more than that is what its steps had no right to. A step of fixed length
        has the accuracy of its step: a law that lets go within one does so at its end, and what
        that creates goes to zero with the step. A tenth of all energy it may not create.

        Parameters
        ----------
        rtol : float, optional
            With one below that of the run, what its steps may be wrong by is held against it.

        Examples
        --------
        >>> Audit(power=1e-16, energy=0.0, created=1e-5).holds()
        False
        >>> Audit(power=1e-16, energy=0.0, created=1e-5, accuracy=1e-3).holds()
        True
        >>> many_steps = Audit(power=1e-16, energy=4e-7, created=0.0, beyond=0.0)
        >>> many_steps.holds(), many_steps.holds(1e-9)
        (True, False)
        """
        return (
            not self.laws
            and self.power <= 1e-12
            and is_balanced(
                self.energy, self.beyond, made=self.rtol, asked=rtol, accuracy=self.accuracy
            )
            and self.created <= max(1e-9, min(10.0 * self.accuracy, COARSE))
        )


def is_balanced(
    energy: float, beyond: float, *, made: float, asked: float | None, accuracy: float = 0.0
) -> bool:
    """Return whether energy is balanced: the one rule of a run's audit and of its losses.

    Parameters
    ----------
    energy, beyond : float
        What is unbalanced, and what of it the steps had no right to, as parts of all energy.
    made, asked : float
        The tolerance that the run was made with, and that which it is held to; None: the first one,
        1e-8 at the tightest.
    accuracy : float
        Of steps of a fixed length.

    Examples
    --------
    >>> is_balanced(4e-7, 0.0, made=1e-8, asked=None), is_balanced(4e-7, 0.0, made=1e-8, asked=1e-9)
    (True, False)
    """
    held_to = max(made, USUAL) if asked is None else asked
    wrong = energy if held_to < made else min(energy, beyond)
    return wrong <= max(10.0 * held_to, min(10.0 * accuracy, COARSE))


@np.errstate(over="ignore", invalid="ignore")
def audit(graph: FlatGraph, trace: Trace, signals: Signals) -> Audit:
    """Return the audit of what a run wrote down; pseudo bonds carry no power and are left out.

    Powers beyond the largest number are infinite, and what is to balance them is none: it does not
    hold, and need not be said twice.
    """
    stepped = _stepped(signals, trace)
    powers = _Powers(graph, [w for _, w in stepped])
    energy = created = beyond = 0.0
    rtol = signals.tables.numbers["rtol"]
    if not len(powers.bond):
        # nothing carries power: machines and signals alone
        return Audit(0.0, energy, created, laws=tuple(trace.unsound), beyond=beyond, rtol=rtol)
    largest = through = 0.0
    balances: list[Balances] = []
    looked = Looked(graph, signals, sizes_of(trace))
    for segment, w in stepped:
        powers.add_steps(w)
        made, size_of = _created_by_steps(signals, segment)
        created += made
        largest = max(largest, size_of)
    for found in stretches(signals, trace):
        flows, size = powers.add(found)
        # of a motion along a surface, the mode through which most passes
        flux = size.reshape(len(found.t), -1).max(axis=1)
        through = max(through, float(found.sums(found.integrals(flux)).max()))
        if found.parts == 1:
            largest = max(largest, _most_taken(flows, found))
        largest = max(largest, float(np.abs(found.stored).max()), float(found.passed.max()))
        off = found.changes(found.balance)
        balances.append(Balances(found, off, looked.allowed(found)))
    for event in trace.events:
        for step in event.steps:
            if event.cause == "step":
                continue  # counted with the segments
            if step.energy is not None and step.kind != "mythical":
                created = max(created, -step.energy.lost)
                largest = max(largest, abs(step.energy.before), abs(step.energy.after))
    span = trace.segments[-1].t[-1] - trace.segments[0].t[0] if trace.segments else 0.0
    power = powers.unbalanced(largest / span if span > 0.0 else 0.0)
    largest = max(largest, _IDLE * through)
    scale = largest if largest > 0.0 else 1.0
    energy, beyond = balances_of(looked, trace, balances, rtol * scale)
    fixed = trace.stats.get("energy_unbalanced", 0.0)
    return Audit(
        power,
        max(energy, fixed) / scale,
        created / scale,
        trace.stats.get("step_error", 0.0),
        tuple(trace.unsound),
        max(beyond, fixed) / scale,
        rtol,
    )


class _Powers:
    """The powers of all elements at all points of a run, and what rounding leaves of their sum."""

    def __init__(self, graph: FlatGraph, stepped: Sequence[Matrix]) -> None:
        owned = [
            (node, end)
            for node in graph.nodes
            if not node.is_junction and node.kind not in ("TF", "GY")
            for end in node.ends
            if not graph.bonds[end.bond].domain.pseudo
        ]
        ends = [end for _, end in owned]
        self.bond = np.array([end.bond for end in ends], dtype=np.intp)
        self._sign = np.array([float(end.sign) for end in ends])
        self._many = many = len(graph.bonds)
        names = [b.domain.name for b in graph.bonds]
        domains = list(dict.fromkeys(names))
        self._domains = [np.array([n == d for n in names]) for d in domains]
        self._domain = np.array([domains.index(names[k]) for k in self.bond], dtype=np.intp)
        self._resisted = np.array([_resistance(node) for node, _ in owned])
        apart: Joined[int] = Joined(range(many))
        for node in graph.nodes:
            if node.is_junction:
                apart.join(end.bond for end in node.ends)
        self._groups = [np.array(group, dtype=np.intp) for group in apart.groups()]
        group_of = {bond: k for k, group in enumerate(self._groups) for bond in group.tolist()}
        self._group = np.array([group_of[k] for k in self.bond], dtype=np.intp)
        # of steps in which laws hold at the end: the largest efforts and flows of the run
        self._strongest = np.zeros(2 * many)
        for w in stepped:
            most = np.abs(w).max(axis=1, initial=0.0)
            self._strongest = np.maximum(self._strongest, most[: 2 * many])
        self._totals: list[Vector] = []
        self._sizes: list[Vector] = []

    def add_steps(self, w: Matrix) -> None:
        """Count bond variables at the ends of steps in which laws hold there.

        What is across a resistor where two flows all but cancel has their rounding, so that power
        is balanced to a few last places of what the largest flow it hangs together with would take.
        """
        e, f = self._parts(w)
        self._totals.append(np.abs(self._flows(w).sum(axis=0)))
        rounding = self._rounding(e, f, self._strongest[:, None])
        fastest = self._strongest[self._many :]
        speeds = np.array([fastest[own].max(initial=0.0) for own in self._groups])[self._group]
        cancelled = _CANCELLED * float((self._resisted * speeds**2).sum())
        self._sizes.append((e * f + rounding).sum(axis=0) + cancelled)

    def add(self, found: Stretch) -> tuple[Matrix, Vector]:
        """Count those of a motion; return the powers, and the sum of their sizes."""
        w, parts = found.bonds, found.parts
        flows = self._flows(w)
        size = np.abs(flows).sum(axis=0)
        # of each segment the largest efforts and flows, at each of its points
        most = np.maximum.reduceat(np.abs(w), found.begins * parts, axis=1)
        points = np.diff(found.begins, append=len(found.t)) * parts
        rounding = self._rounding(*self._parts(w), most, points)
        self._totals.append(np.abs(flows.sum(axis=0)))
        self._sizes.append(size + rounding.sum(axis=0))
        return flows, size

    def unbalanced(self, least: float) -> float:
        """Return the largest sum as a part of its terms, of which none counts as below `least`.

        That is power that in all the time of the run adds up to no part of its energy: where
        nothing moves, rounding of large flows that a gyrator passes on is a force, and no other is
        there.
        """
        if not self._sizes:
            return 0.0
        size = np.maximum(np.concatenate(self._sizes), least)
        # where a motion turns round there is no power to be a part of, but the rounding of flows
        size = np.maximum(size, _QUIET * size.max(initial=0.0))
        ratio = np.concatenate(self._totals) / np.where(size > 0.0, size, 1.0)
        return float(ratio.max(initial=0.0))

    def _flows(self, w: Matrix) -> Matrix:
        return np.asarray(w[self.bond] * w[self.bond + self._many] * self._sign[:, None])

    def _parts(self, w: Matrix) -> tuple[Matrix, Matrix]:
        return np.abs(w[self.bond]), np.abs(w[self.bond + self._many])

    def _rounding(self, e: Matrix, f: Matrix, most: Matrix, points: Places | int = 1) -> Matrix:
        """Return what rounding of the largest efforts and flows makes of others.

        What rests under a load moves by the rounding of the fastest motion in its domain, and what
        flows without a load feels the rounding of the largest one, between two-ports too.
        """
        many = self._many
        loads, speeds = (
            np.repeat(
                np.array([a[own].max(axis=0) for own in self._domains])[self._domain],
                points,
                axis=1,
            )
            for a in (most[:many], most[many : 2 * many])
        )
        return np.asarray(0.1 * (e * speeds + loads * f))


def _resistance(node: Node) -> float:
    """Return the resistance of an element of one port with a linear law; else zero."""
    law = node.law
    if node.kind not in RESISTORS or len(node.ends) != 1 or law is None or law.matrix is None:
        return 0.0
    factor = abs(plain(law.matrix[0][0]))
    if law.output == "e":
        return factor
    return 1.0 / factor if factor > 0.0 else 0.0


def _stepped(signals: Signals, trace: Trace) -> list[tuple[Segment, Matrix]]:
    """Return the segments of time-stepping, each with the bond variables where its steps end."""
    if signals.tables.numbers["method"] != MOREAU:
        return []
    return [(s, s.bonds.T) for s in trace.segments if s.bonds is not None]


def _most_taken(flows: Matrix, found: Stretch) -> float:
    """Return the most that went into or out of one element on balance, between two points, J.

    Where stores exchange energy that adds up to nothing, this is what is there to be exchanged.
    """
    taken = found.along(found.integrals(flows))
    return float((found.most(taken) + found.most(-taken)).max())


def _created_by_steps(signals: Signals, segment: Segment) -> tuple[float, float]:
    """Return what the steps of a segment created, and the largest energy in it, J.

    A step loses energy in impacts, and by damping if theta is above 1/2. It should not have more at
    its end than what it began with and was supplied. It may, where a law lets go or takes hold
    within it, the less the shorter it is. What resistances give on balance is supplied, too: one
    may be negative.
    """
    stored = signals.stored(segment.y)
    supplied, dissipated = segment.y[:, -2], segment.y[:, -1]
    given = np.diff(supplied) - np.minimum(np.diff(dissipated), 0.0)
    created = np.maximum(np.diff(stored) - given, 0.0)
    passed = float(np.abs(np.diff(supplied)).sum() + np.abs(np.diff(dissipated)).sum())
    return float(created.sum()), max(float(np.abs(stored).max()), passed)
