"""What each junction law asks for in one step, read at its beginning."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.ports import PortEquations
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Machine, Mode
from hybond.modes.laws.friction import breaking_loose
from hybond.modes.laws.planar import Disk, Rests, undetermined_slip
from hybond.modes.laws.problem import (
    CUT,
    HELD,
    ONE_SIDED,
    TWO_SIDED,
    Answer,
    Branches,
    Friction,
    Problem,
    ambiguous,
    solve_laws,
)
from hybond.modes.stepping.coupling import Coupling, cleared
from hybond.modes.stepping.shares import least_shares

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
ROUNDED = 1e-12
"""Part of the largest bond variable below which `w` of a law that feels nothing is rounding."""
CANCELLED = 1e-14
"""A sum below this part of its terms is rounding: a law does not change its branch for it."""
TOUCHING = 1e-9
"""Part of the motion in a step within which a contact that was closed is still closed."""
Limit = Callable[[Expr], Friction]
Leaks = tuple[Vector, Matrix]


@dataclass(frozen=True, slots=True)
class Together:
    """What the laws do together.

    Parameters
    ----------
    answer : Answer
    ambiguous : list of int
        Laws whose variables are others in a second solution.
    shared : list of int
        Laws whose shares were open, and are those of least leakage.
    """

    answer: Answer
    ambiguous: list[int]
    shared: list[int]


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
    def planar(self) -> list[tuple[int, int]]:
        """The ports of each friction in two directions."""
        found: dict[int, list[int]] = {}
        for k, m in enumerate(self.machines):
            if m.law is not None and m.law.planar:
                found.setdefault(m.index, []).append(k)
        return [(x, y) for x, y in found.values()]

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

    def solve(
        self, coupling: Coupling, q: Vector, limit: Limit, leaks: Leaks | None = None
    ) -> Together | None:
        """Return what the laws do where ``w = M l + q``, None if nothing was found.

        What was at rest stays so up to its breakaway limit, and slides with the other one.
        `leaks` are what flows at junctions that machines switch, at ``l = 0`` and by `l`.
        """
        M = coupling.M
        guess = self.guess
        q = np.where(coupling.deaf & (q < 0.0) & (q >= -ROUNDED * self.size), 0.0, q)
        loose = {
            k
            for k, (m, (_, rest)) in enumerate(zip(self.machines, self.limits, strict=True))
            if rest is not None and m.states[self.start[m.index]] == "sticks"
        } - {k for pair in self.planar for k in pair}
        shift = self.restitution * self.w if self.restitution.any() else None
        problem = Problem(M, q, self.roles, self.common, shift)

        def answered(resting: set[int]) -> Answer | None:
            nonlocal problem
            friction = {
                k: limit(rest if k in resting and rest is not None else sliding)
                for k, (sliding, rest) in enumerate(self.limits)
                if sliding is not None
            }
            problem = replace(problem, friction=friction)
            if self.planar:
                return self._in_the_plane(problem, guess, limit)
            return solve_laws(problem, start=guess)

        answer = breaking_loose(loose, answered)
        if answer is None:
            return None
        doubtful: list[int] = []
        convex = set(self.roles) <= {ONE_SIDED, CUT} and coupling.semidefinite
        if not convex and not self.planar and not np.array_equal(answer.branch, guess):
            doubtful = ambiguous(problem, answer)
        # where either branch fits nothing has happened
        moved = problem.moved
        either = answer.open | self._rounding(M, moved, answer.l)
        answer = replace(answer, open=either)
        kept = either & (np.array(self.roles) != CUT) & (np.array(self.roles) != HELD)
        answer = replace(answer, branch=np.where(kept, guess, answer.branch))
        if not coupling.still.shape[1]:
            return Together(answer, doubtful, [])
        answer, shared = self._shared(coupling, moved, answer, problem.friction, leaks)
        return Together(answer, doubtful, shared)

    def _in_the_plane(self, problem: Problem, guess: Branches, limit: Limit) -> Answer | None:
        """Return what the laws do, those of two directions in their disks."""
        rest: list[Friction] = []
        for x, _ in self.planar:
            sliding, still = self.limits[x]
            sticks = self.start[self.machines[x].index] == 0
            most = still if sticks and still is not None else sliding
            assert most is not None
            rest.append(limit(most))
        disks = [
            Disk(self.machines[x].index, (x, y), 0.0, 0.0, np.array([1.0, 0.0]), resting=True)
            for x, y in self.planar
        ]
        slip = [problem.friction[x] for x, _ in self.planar]
        return Rests(disks, problem, rest, slip, guess).answer()

    def _rounding(self, M: Matrix, q: Vector, l: Vector) -> Mask:
        """Return which one-sided laws have nothing but rounding in both of their variables."""
        size = CANCELLED * (np.abs(M) @ np.abs(l) + np.abs(q))
        own = np.diag(M)
        sided = np.array([r == ONE_SIDED for r in self.roles], dtype=bool)
        return sided & (own > 0.0) & (np.abs(M @ l + q) <= size) & (own * l <= size)

    def _shared(
        self,
        coupling: Coupling,
        q: Vector,
        answer: Answer,
        friction: Mapping[int, Friction],
        leaks: Leaks | None,
    ) -> tuple[Answer, list[int]]:
        """Return the answer with shares of least leakage, and the laws whose shares were open."""
        n = len(q)
        l, w = answer.l, coupling.M @ answer.l + q
        low, high = np.concatenate([l, w]), np.concatenate([l, w])
        idle = coupling.idle
        # disks have shared already
        plane = {k for pair in self.planar for k in pair}
        for k, role in enumerate(self.roles):
            if k in plane:
                continue
            active = (answer.branch[k] == 1) == self.common[k]
            if role == ONE_SIDED:
                # what does nothing stays as it was; another one that may carry something carries it
                if active or (not idle[k] and (coupling.semidefinite or answer.open[k])):
                    low[k], high[k] = 0.0, np.inf
                low[n + k], high[n + k] = 0.0, np.inf
            elif role == HELD:
                low[k], high[k] = -np.inf, np.inf
            elif role == CUT:
                low[n + k], high[n + k] = -np.inf, np.inf
            elif answer.branch[k] == 0 and not self.common[k]:
                bound = friction[k].value
                if not friction[k].slope.any() and abs(l[k]) <= bound:
                    low[k], high[k] = -bound, bound
        still = coupling.still_at(q, [f.slope for f in friction.values() if f.slope.any()])
        basis = np.vstack([still, cleared(coupling.M, still)])
        others = flows = None
        if leaks is not None:
            others = np.hstack([leaks[1], np.zeros_like(leaks[1])])
            flows = leaks[0] + leaks[1] @ l
        shares, shared = least_shares(
            np.concatenate([l, w]), basis, low=low, high=high, others=others, flows=flows
        )
        who = sorted({k % n for k in shared})
        if not who:
            return answer, []
        l = shares[:n]
        branch = answer.branch.copy()
        for k, role in enumerate(self.roles):
            if role == ONE_SIDED and (l[k] > 0.0 or shares[n + k] > 0.0):
                branch[k] = int((l[k] > 0.0) == self.common[k])
        return replace(answer, l=l, branch=branch), who

    def mode(self, branch: Branches) -> Mode:
        """Return the mode with these branches."""
        mode = list(self.start)
        for m, b in zip(self.machines, branch, strict=True):
            if m.law is not None and m.law.two_sided and not m.law.planar:
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
        if law.planar and port.given != "net":
            raise undetermined_slip(port.path)
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
    its distance is positive by rounding; nor is the leg of a table that the load on the other
    legs would lift if it were not for them.
    """
    away = laws.gap + 0.5 * h * laws.rate > 0.0
    if not away.any():
        return laws
    closed = np.array([m.on[laws.start[m.index]] != m.on[0] for m in laws.machines], dtype=bool)
    rests = closed & np.array(laws.common, dtype=bool)
    touches = laws.gap + 0.5 * h * np.minimum(free, 0.0) <= 0.0
    motion = h * float(np.abs(free[np.isfinite(laws.gap)]).max(initial=0.0))
    away &= ~(rests & (touches | (laws.gap + 0.5 * h * laws.rate <= TOUCHING * motion)))
    if not away.any():
        return laws
    roles = tuple(
        (CUT if c else HELD) if a else r
        for r, c, a in zip(laws.roles, laws.common, away, strict=True)
    )
    return replace(laws, roles=roles, restitution=np.where(away, 0.0, laws.restitution))
