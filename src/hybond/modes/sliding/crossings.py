"""What crossing a surface does to what is stored: nothing, a jump that vanishes, or one that stays.

Modes with different constraints can slide along their surface where all constraints are met, since
a jump is nothing there. Off that place a state may still be brought to it:

* by jumps that do not move the switching function, at once: switching back and forth in no time
  ends where all constraints are met, whatever it began with (alternating projections, von Neumann);
* by jumps that become ever smaller (`VANISHED`), in a sequence of events.

Jumps that stay, as between two belts that run in opposite directions, have no limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.equations.surfaces import Rates, Surface, SurfaceLaws
from hybond.errors import HybondError
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.jump import enter, reach_of
from hybond.modes.sliding.meeting import held_to, meet
from hybond.programs.common_space import CommonSpace
from hybond.programs.program import Program
from hybond.trace import Trace

Vector = NDArray[np.float64]

VANISHED = 1e-9
"""A jump below this part of what may be stored has vanished."""
MET = 1e-12
"""A constraint is met if its residual is below this part of its terms."""


@dataclass(frozen=True, slots=True)
class Collapse:
    """Infinitely many jumps of one instant, added up.

    Parameters
    ----------
    y : array
        The state where all constraints are met.
    impulses : array, shape (2 * bonds,)
    lost : tuple of float
        Energy before and after, J.
    """

    y: Vector
    impulses: Vector
    lost: tuple[float, float]


class Crossings:
    """Tells for one run how states cross surfaces."""

    def __init__(self, program: Program, trace: Trace, laws: SurfaceLaws) -> None:
        self.program = program
        self.graph = program.graph
        self.trace = trace
        self.laws = laws
        self.storage = program.storage
        self._told: set[Surface] = set()

    # -- without a jump

    def meet(self, modes: Sequence[Mode], t: float, y: Vector, interval: Interval) -> bool:
        """Whether the state is where all constraints of `modes` are met, and can be kept there."""
        if not all(self.taken(m, t, y, interval) for m in modes):
            return False
        parts = [self.program.equations(m, interval, t) for m in modes]
        if len({held_to(e) for e in parts}) < 2:
            return True
        common = meet(parts)
        return common is not None and self._kept(common, parts, t, y, interval)

    def taken(self, mode: Mode, t: float, y: Vector, interval: Interval) -> bool:
        """Whether a mode can be entered without a jump."""
        program = self.program
        if program.fieldless(mode):
            return False
        try:
            e = program.equations(mode, interval, t)
            if e.tableau.constraints or e.structure or e.tableau.agreements:
                moved = self._entered(e, t, y, interval) - y[: program.nx]
                return self.vanishes(moved, y)
        except HybondError:
            return False
        return True

    def vanishes(self, moved: Vector, y: Vector) -> bool:
        """Whether a jump of what is stored is next to nothing."""
        x = y[: self.program.nx]
        room = np.abs(x) + reach_of(self.storage, x, self.trace.energy)
        return bool((np.abs(moved) <= VANISHED * room).all())

    # -- with jumps

    def collapse(
        self, s: Surface, t: float, y: Vector, modes: Sequence[Mode], interval: Interval
    ) -> Collapse | None:
        """Return where switching back and forth over `s` in no time ends; warn if nowhere.

        None as well if time passes in one of `modes`, those below and above.
        """
        mode = modes[0]
        if not self._no_time(s, t, y, modes, interval):
            return None
        program = self.program
        nx = program.nx
        parts = [program.equations(m, interval, t) for m in modes]
        common = meet(parts)
        if common is not None and self._still(common, s, t, y, modes, interval):
            x, total = y[:nx], np.zeros(common.moves.shape[1])
            for _ in range(3):
                v = program.values(t, interval, mode, x, y[nx : nx + program.ns])
                total = total - common.correction(v, x)
                x = y[:nx] + common.moves @ total
            there = np.concatenate([x, y[nx:]])
            v = program.values(t, interval, mode, x, y[nx : nx + program.ns])
            if common.met(v, x, MET) and self.meet(modes, t, there, interval):
                storage = parts[0].storage
                lost = (storage.energy(y[:nx]), storage.energy(x))
                return Collapse(there, common.directions @ total, lost)
        if s not in self._told:
            self._told.add(s)
            self.trace.warn(
                f"{self.graph.machines[s.machine].path} is pushed back over {s.text} at once from "
                f"either side, and crossings make stored quantities jump without an end "
                f"(t = {t:.9g} s): no sliding motion is the limit of that"
            )
        return None

    def _no_time(
        self, s: Surface, t: float, y: Vector, modes: Sequence[Mode], interval: Interval
    ) -> bool:
        """Whether the modes on both sides, entered from here, push back into the surface."""
        program = self.program
        nx, n = program.nx, program.nx + program.ns
        law = self.laws.of(s, modes)
        if law is None or any(program.fieldless(m) for m in modes):
            return False
        speeds = []
        try:
            for m in modes:
                e = program.equations(m, interval, t)
                there = np.concatenate([self._entered(e, t, y, interval), y[nx:]])
                v = program.values(t, interval, m, there[:nx], there[nx:n])
                rate = program.field(e, interval)(t, there)[None, :n]
                speeds.append(float(law.along(v, rate[:, :nx], rate[:, nx:])[0]))
        except HybondError:
            return False
        return speeds[0] > 0.0 > speeds[1]

    def _still(
        self,
        common: CommonSpace,
        s: Surface,
        t: float,
        y: Vector,
        modes: Sequence[Mode],
        interval: Interval,
    ) -> bool:
        """Whether jumps move neither the switching function nor anything by a source's impulse."""
        program = self.program
        nx, n = program.nx, program.nx + program.ns
        law = self.laws.of(s, modes)
        assert isinstance(law, Rates)
        v = program.values(t, interval, modes[0], y[:nx], y[nx:n])
        moves = common.moves.T
        nothing = np.zeros((len(moves), program.ns))
        change = law.along(v, moves, nothing) - float(law.drift(v))
        size = law.along(v, np.abs(moves), nothing) - float(law.drift(v))
        bonds = len(self.graph.bonds)
        fed = [
            k
            for node in self.graph.nodes
            if node.kind in ("Se", "Sf")
            for k in (node.ends[0].bond, bonds + node.ends[0].bond)
        ]
        return bool(
            (np.abs(change) <= MET * np.maximum(np.abs(size), 1.0)).all()
            and (np.abs(common.directions[fed]) <= MET).all()
        )

    # -- entering a mode, and keeping to all constraints

    def _entered(self, e: ModeEquations, t: float, y: Vector, interval: Interval) -> Vector:
        v = self.program.evaluate(t, y, interval, e)
        where = self.graph.mode_text(e.mode)
        return enter(e, v, y[: self.program.nx], where=where, energy=self.trace.energy).x

    def _kept(
        self,
        common: CommonSpace,
        parts: Sequence[ModeEquations],
        t: float,
        y: Vector,
        interval: Interval,
    ) -> bool:
        program = self.program
        nx, n = program.nx, program.nx + program.ns
        for e in parts:
            v = program.values(t, interval, e.mode, y[:nx], y[nx:n])
            rates = e.storage.rates_of(e.solve(v, y[:nx]))
            if not common.can_keep(v, y[:nx], rates):
                return False
        return True


def sides_of(s: Surface, mode: Mode) -> list[Mode]:
    """Return the modes below and above a surface, all other machines being as in `mode`."""
    return [(*mode[: s.machine], k, *mode[s.machine + 1 :]) for k in (s.below, s.above)]
