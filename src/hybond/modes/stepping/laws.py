"""What each junction law asks for in one step, read at its beginning."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.ports import PortEquations
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Machine, Mode
from hybond.modes.laws.problem import (
    CUT,
    HELD,
    ONE_SIDED,
    TWO_SIDED,
    Answer,
    Branches,
    Friction,
    ambiguous,
    solve_laws,
)

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
IDLE = 1e-14
"""Part of the largest response below which a law does nothing."""
ROUNDED = 1e-12
"""Part of the largest bond variable below which the value of such a law is rounding."""
Limit = Callable[[Expr], tuple[float, Vector]]


@dataclass(frozen=True, slots=True)
class Laws:
    """The laws of all ports for one step.

    Parameters
    ----------
    machines : tuple of Machine
        Of each port.
    start : Mode
        The mode in which the step begins.
    roles : tuple of str
        See `hybond.modes.laws.problem`.
    common : tuple of bool
        Whether `l` is the common variable.
    gap, rate : array, shape (ports,)
        Distance of contacts and its rate; a gap of -inf where there is none.
    w : array, shape (ports,)
        At the beginning.
    restitution : array, shape (ports,)
    limits : tuple of (Expr or None, Expr or None)
        Of friction: while it slides, and at rest.
    size : float
        Of the largest bond variable at the beginning.
    """

    machines: tuple[Machine, ...]
    start: Mode
    roles: tuple[str, ...]
    common: tuple[bool, ...]
    gap: Vector
    rate: Vector
    w: Vector
    restitution: Vector
    limits: tuple[tuple[Expr | None, Expr | None], ...]
    size: float = 0.0

    @property
    def guess(self) -> Branches:
        """The branches at the beginning."""
        states = [m.states[self.start[m.index]] for m in self.machines]
        values = [{"forward": 1, "backward": -1}.get(s) for s in states]
        return np.array(
            [
                int(bool(m.on[self.start[m.index]])) if a is None and m.on[0] != m.on[1] else a or 0
                for m, a in zip(self.machines, values, strict=True)
            ],
            dtype=np.int8,
        )

    def solve(self, M: Matrix, q: Vector, limit: Limit) -> tuple[Answer | None, list[int]]:
        """Return what the laws do where ``w = M l + q``, and which of them could do otherwise.

        What was at rest stays so up to its breakaway limit, and slides with the other one.
        """
        guess = self.guess
        # a law that neither acts on anything nor feels any other: its value is rounding, or right
        small = np.abs(M) <= IDLE * np.abs(M).max(initial=0.0)
        idle = small.all(axis=1) & small.all(axis=0)
        q = np.where(idle & (q < 0.0) & (q >= -ROUNDED * self.size), 0.0, q)
        loose = {
            k
            for k, (m, (_, rest)) in enumerate(zip(self.machines, self.limits, strict=True))
            if rest is not None and m.states[self.start[m.index]] == "sticks"
        }
        given = {"roles": self.roles, "common": self.common}
        shift = self.restitution * self.w if self.restitution.any() else None
        while True:
            friction = {
                k: Friction(*limit(rest if k in loose and rest is not None else sliding))
                for k, (sliding, rest) in enumerate(self.limits)
                if sliding is not None
            }
            answer = solve_laws(M, q, **given, shift=shift, friction=friction, start=guess)  # type: ignore[arg-type]
            if answer is None:
                return None, []
            broken = {k for k in loose if answer.branch[k] != 0}
            if not broken:
                break
            loose -= broken
        doubtful: list[int] = []
        if not np.array_equal(answer.branch, guess):
            doubtful = ambiguous(M, q, answer, **given, shift=shift, friction=friction)  # type: ignore[arg-type]
        # where either branch fits nothing has happened
        kept = answer.open & (np.array(self.roles) != CUT) & (np.array(self.roles) != HELD)
        branch = np.where(kept, guess, answer.branch)
        return replace(answer, branch=branch), doubtful

    def mode(self, branch: Branches) -> Mode:
        """Return the mode with these branches."""
        mode = list(self.start)
        for m, b in zip(self.machines, branch, strict=True):
            if m.law is not None and m.law.two_sided:
                mode[m.index] = m.states.index(("sticks", "forward", "backward")[int(b)])
            else:
                mode[m.index] = int(b != 0)
        return tuple(mode)


def read_laws(
    graph: FlatGraph, ports: PortEquations, value: Callable[[Expr], float], w: Vector, mode: Mode
) -> Laws:
    """Read the laws at the beginning of a step: `value` of expressions, bond variables `w`."""
    n = len(ports.ports)
    machines = tuple(graph.machines[p.machine] for p in ports.ports)
    roles: list[str] = []
    gap, rate = np.full(n, -np.inf), np.zeros(n)
    restitution = np.zeros(n)
    for k, (port, machine) in enumerate(zip(ports.ports, machines, strict=True)):
        law = port.law
        role = TWO_SIDED if law.two_sided else ONE_SIDED
        if law.gap is not None:
            gap[k], rate[k] = value(law.gap), -value(law.net)
        on = bool(machine.on[mode[machine.index]])
        if law.gate is not None and not on and not value(law.gate):
            role = CUT if port.given == "common" else HELD
        if law.restitution is not None and port.given == "common":
            restitution[k] = value(law.restitution)
        roles.append(role)
    return Laws(
        machines,
        mode,
        tuple(roles),
        tuple(p.given == "common" for p in ports.ports),
        gap,
        rate,
        np.asarray(ports.partner @ w),
        restitution,
        tuple((p.law.limit, p.law.breakaway) for p in ports.ports),
        float(np.abs(w).max(initial=0.0)),
    )


def closed_half_way(laws: Laws, h: float, free: Vector) -> Laws:
    """Leave out the contacts that stay open for the first half of a step of length `h`.

    The others take part with their coefficient of restitution. `free` is `w` at the end if no law
    acts: what rests on a contact and would fall again within the step is not let go of because
    its distance is positive by rounding.
    """
    away = laws.gap + 0.5 * h * laws.rate > 0.0
    closed = np.array([m.on[laws.start[m.index]] != m.on[0] for m in laws.machines], dtype=bool)
    rests = closed & np.array(laws.common, dtype=bool)
    away &= ~(rests & (laws.gap + 0.5 * h * np.minimum(free, 0.0) <= 0.0))
    if not away.any():
        return laws
    roles = tuple(
        (CUT if c else HELD) if a else r
        for r, c, a in zip(laws.roles, laws.common, away, strict=True)
    )
    return replace(laws, roles=roles, restitution=np.where(away, 0.0, laws.restitution))
