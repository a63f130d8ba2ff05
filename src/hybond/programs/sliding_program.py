"""A program as it is while machines slide: which modes are combined, and how."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields

import numpy as np

from hybond.engine.outcome.combinations import Kind, corners_of, flipped
from hybond.equations.mode import ModeEquations
from hybond.equations.surfaces import Surface, SurfaceLaws
from hybond.model.expressions import compile_expression
from hybond.model.graph import FlatGraph, Mode
from hybond.model.interval import Interval
from hybond.programs.combined import KEPT, Combined
from hybond.programs.common_space import Meet
from hybond.programs.program import Field, Program

MOST_PRODUCT = 6
"""Most surfaces of a product combination, which takes 2^k fields."""
ADDITIVE = 1e-9
"""Fields are additive if what they lack is below this part of them."""


def combine(
    program: Program,
    surfaces: Sequence[Surface],
    mode: Mode,
    interval: Interval,
    t: float,
    *,
    laws: SurfaceLaws,
    meet: Meet,
    branch: Callable[[Mode], Mode],
    kind: Kind = "additive",
) -> Combined:
    """Return the equations of sliding on `surfaces`, all other machines being as in `mode`.

    `branch` gives each mode around the branches of its junction laws.
    """
    corners = corners_of(len(surfaces), kind)
    modes = [branch(flipped(mode, surfaces, c)) for c in corners]
    parts = [program.equations(m, interval, t) for m in modes]
    shown = program.equations(mode, interval, t)
    slots = program.slots
    return Combined(
        **{f.name: getattr(shown, f.name) for f in fields(ModeEquations)},
        program=program,
        interval=interval,
        surfaces=tuple(surfaces),
        kind=kind,
        corners=corners,
        parts=parts,
        laws=[laws.of(s, modes) for s in surfaces],
        plain=[compile_expression(s.g, slots.index, pre_offset=slots.size) for s in surfaces],
        common=meet(parts),
        branch=branch,
    )


def additive(combined: Combined, v: Sequence[float]) -> bool:
    """Whether the switches act independently of each other at the values `v`.

    Held against the fields with all machines above, and with every other one: what no switch does
    alone shows there, unless it cancels.
    """
    k = len(combined.surfaces)
    if k < 2:
        return True
    values = list(v)
    solutions, rates = combined.part_rates(values)
    n = rates.shape[1] - 2
    checks = {(1,) * k, tuple(i % 2 for i in range(k)), tuple(1 - i % 2 for i in range(k))}
    program = combined.program
    size = np.abs(rates[:, :n]).max(axis=0)
    bonds = np.array(solutions)
    bond_size = np.abs(bonds).max(axis=0)
    for corner in sorted(checks):
        mode = combined.branch(flipped(combined.mode, combined.surfaces, corner))
        part = program.equations(mode, combined.interval, values[0])
        w, _ = combined.part(part, values)
        c = np.array([1.0 - sum(corner), *corner])
        if (np.abs(w - c @ bonds) > ADDITIVE * (k * bond_size + np.abs(w).max())).any():
            return False
        s = np.array(program.rates(values))
        expected = (c @ rates)[program.nx : n]
        if s.size and (np.abs(s - expected) > ADDITIVE * (k * size[program.nx :] + 1e-300)).any():
            return False
    return True


class SlidingProgram(Program):
    """A program as it is while some machines slide: their rules rest, their modes combine."""

    def __init__(
        self,
        program: Program,
        graph: FlatGraph,
        surfaces: Sequence[Surface],
        *,
        kind: Kind,
        laws: SurfaceLaws,
        meet: Meet,
    ) -> None:
        self.__dict__.update(program.__dict__)
        self.whole = program
        self.graph = graph
        self.surfaces = tuple(surfaces)
        self.kind: Kind = kind
        self.laws = laws
        self.meet = meet
        self.branches: dict[Mode, Mode] = {}
        """The branches of junction laws in the modes that are combined, by `bare` mode."""
        self.choose: Callable[[Mode], Mode] = lambda mode: mode
        """What gives branches to a mode that was not combined before, in the present state."""
        self._combined: dict[tuple[object, ...], ModeEquations] = {}

    def bare(self, mode: Mode) -> Mode:
        """Return a mode without the branches of its junction laws."""
        machines = self.graph.machines
        return tuple(0 if m.law is not None else k for m, k in zip(machines, mode, strict=True))

    def branch(self, mode: Mode) -> Mode:
        """Return a mode with the branches that its laws have while it is combined."""
        bare = self.bare(mode)
        if bare not in self.branches:
            self.branches[bare] = self.choose(mode)
        return self.branches[bare]

    def equations(self, mode: Mode, interval: Interval, t: float) -> ModeEquations:
        """Return the combined equations; plain ones once no machine is between its states."""
        sides = [s for s in self.surfaces if mode[s.machine] in (s.below, s.above)]
        corners = corners_of(len(sides), self.kind)
        modes = [self.branch(flipped(mode, sides, c)) for c in corners]
        key = (mode, interval, *modes)
        if key not in self._combined:
            if len(self._combined) >= KEPT:
                self._combined.clear()
            self._combined[key] = (
                combine(
                    self.whole,
                    sides,
                    mode,
                    interval,
                    t,
                    laws=self.laws,
                    meet=self.meet,
                    branch=self.branch,
                    kind=self.kind,
                )
                if sides
                else self.whole.equations(mode, interval, t)
            )
        return self._combined[key]

    def fieldless(self, mode: Mode) -> bool:
        """Whether an active law of `mode` reads ``pre()``."""
        return self.whole.fieldless(mode)

    def field(self, equations: ModeEquations, interval: Interval) -> Field:
        """Return ``y' = field(t, y)``."""
        if isinstance(equations, Combined):
            return equations.motion()
        return self.whole.field(equations, interval)
