"""Friction in two directions at one instant: whether it holds, and where slip begins.

What slips already has a direction, ``f / |f|``: its force is known up to the limit, like that of
friction that surely slides forward. What is at rest is held if the force that this takes lies in
the disk of the breakaway limit. Otherwise slip begins, along the direction that the force on the
edge of the disk and the acceleration agree on (`solvers.friction_disk`).

Other laws answer at once: for each disk, the slip is what the complementarity problem of all other
laws makes of a given force, so that each disk by itself is solved exactly; several disks take
turns until none moves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.ports import Port, PortEquations, Response
from hybond.errors import CausalityError
from hybond.model.graph import FlatGraph, Mode
from hybond.model.planar_friction import HEADING, SLOW, TINY
from hybond.modes.laws.problem import (
    FORWARD,
    HELD,
    Answer,
    Branches,
    Friction,
    Problem,
    solve_laws,
)
from hybond.names import join
from hybond.solvers.friction_disk import on_disk

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

REST = 1e-10
"""Part of its terms below which a slip velocity is zero."""
BEGINS = 1e-12
"""Part of these terms up to which slip that begins has the direction of its heading."""
SAME = 1e-9
"""Headings that differ by less are one, rad."""
EDGE = 1e-12
"""A force beyond the limit by this part is beyond doubt."""
TURNS = 100
"""Rounds of all disks."""
ROUNDS = 1000
"""The same where each disk is solved for itself."""
STILL = 1e-12
"""The disks agree if no force moves by more than this part of its limit."""
ENOUGH = 1e-9
"""The same for disks that approach each other slowly."""

GIVES = 1e-8
"""Part of the largest response that disks give way by, if one body rests on more than it takes."""


@dataclass(slots=True)
class Disk:
    """One planar friction at an instant.

    Parameters
    ----------
    machine : int
    ports : tuple of int
        Its two directions among the ports.
    speed, size : float
        Of its slip, and what rounding of that is measured by.
    way : array, shape (2,)
        The direction of slip, or of what holds it.
    resting : bool
        Whether its slip is zero.
    """

    machine: int
    ports: tuple[int, int]
    speed: float
    size: float
    way: Vector
    resting: bool


def undetermined_slip(path: str) -> CausalityError:
    """Return the refusal of a friction whose slip does not follow from what is stored."""
    return CausalityError(
        f"the slip of {path} is not determined by what is stored",
        code="HB-C105",
        where=path,
        hint="friction in two directions needs inertia at both of its junctions",
    )


def disks_of(
    ports: PortEquations, response: Response, size: Vector, slow: dict[int, float]
) -> list[Disk]:
    """Return each planar friction of a graph, as it is at this instant; `slow` by machine.

    Raises
    ------
    CausalityError
        HB-C105 if its slip does not follow from what is stored.
    """
    found = []
    for k, second in _pairs(ports.ports):
        for j in (k, second):
            if ports.ports[j].given != "net" or response.D[j].any():
                raise undetermined_slip(ports.ports[j].path)
        f = response.y[[k, second]]
        speed = math.hypot(*f)
        own = math.hypot(*size[[k, second]])
        machine = ports.ports[k].machine
        resting = speed <= max(REST * own, -slow[machine])
        way = f / speed if speed > 0.0 else np.array([1.0, 0.0])
        found.append(Disk(machine, (k, second), speed, own, way, resting))
    return found


def _pairs(ports: Sequence[Port]) -> list[tuple[int, int]]:
    """Return the positions of the first and second direction of each planar friction."""
    at = {p.law.node: k for k, p in enumerate(ports)}
    seconds = ((k, p.law.second) for k, p in enumerate(ports))
    return [(k, at[second.node]) for k, second in seconds if second is not None]


def on_the_way(disk: Disk, limit: Friction, force: Vector | None = None) -> dict[int, Friction]:
    """Return what the two net variables are while the disk slips: ``limit * way``.

    With a `force`, that force instead.
    """
    if force is not None:
        still = np.zeros_like(limit.slope)
        return {k: Friction(float(p), still) for k, p in zip(disk.ports, force, strict=True)}
    return {
        k: Friction(limit.value * float(d), limit.slope * float(d))
        for k, d in zip(disk.ports, disk.way, strict=True)
    }


@dataclass(slots=True)
class Rests:
    """The disks whose slip is zero, solved together with all other laws.

    Parameters
    ----------
    disks : list of Disk
        Their `way` is written.
    problem : Problem
        That of all laws; `Rests` gives the disks' ports their roles and forces.
    rest, limit : list
        By disk: what it holds at rest, what it gives while it slips.
    start : array of int
        A guess of the branches.
    forces : list
        By disk, while an answer is looked for: the force it gives; None for one that is held.
    """

    disks: list[Disk]
    problem: Problem
    rest: list[Friction]
    limit: list[Friction]
    start: Branches
    forces: list[Vector | None] = field(default_factory=list)

    def answer(self) -> Answer | None:
        """Return what all laws do, None if nothing was found.

        First all that rest are held, and those let go that cannot be. Where that comes to no
        answer (what is held may bar a contact, or hold again once another one slips) the disks
        take turns, each solved for itself between the forces of the others.
        """
        return self._shared() or self._in_turn()

    def _shared(self) -> Answer | None:
        """Return an answer in which disks share what they hold alike, if more than one fits.

        All give way by the same little then.
        """
        ports = [k for disk in self.disks for k in disk.ports]
        own = self.problem.M[np.ix_(ports, ports)]
        size = float(np.abs(own).max(initial=0.0))
        if np.linalg.matrix_rank(own, tol=1e-2 * GIVES * size) == len(ports):
            return self._answer()
        rigid = self.problem
        soft = rigid.M.copy()
        soft[ports, ports] += GIVES * size
        self.problem = replace(rigid, M=soft)
        found = self._answer()
        self.problem = rigid
        # what does not slip then holds to the last digit, if that is unique
        return None if found is None else self._with(self.forces) or found

    def _in_turn(self) -> Answer | None:
        forces = [np.zeros(2) for _ in self.disks]
        loose = [False] * len(self.disks)
        holds = [False] * len(self.disks)
        before = math.inf
        for _ in range(ROUNDS):
            moved = 0.0
            for k, disk in enumerate(self.disks):
                self.forces = list(forces)
                way = self._local(k, loose[k])
                if way is None:
                    return None
                force, holds[k] = way
                loose[k] = loose[k] or not holds[k]
                size = max(math.hypot(*force), math.hypot(*forces[k]))
                change = math.hypot(*(force - forces[k])) / size if size > 0.0 else 0.0
                moved = max(moved, change)
                forces[k] = force
                if force.any():
                    disk.way = force / math.hypot(*force)
            if moved <= STILL or (moved <= ENOUGH and moved >= 0.5 * before):
                break
            before = moved
        else:
            return None
        self.forces = list(forces)
        near = self._with(self.forces)
        if near is None:
            return None
        self.forces = [None if held else p for held, p in zip(holds, forces, strict=True)]
        exact = self._with(self.forces)
        if exact is not None and self._fits(exact, holds, loose):
            return exact
        branch = near.branch.copy()
        for disk, held in zip(self.disks, holds, strict=True):
            branch[list(disk.ports)] *= not held
        return replace(near, branch=branch)

    def _local(self, k: int, loose: bool) -> tuple[Vector, bool] | None:
        """Return the force of one disk between the forces of the others, and whether it holds."""
        found = self._about(k)
        if found is None:
            return None
        A, f0, limit, follow = found
        if not f0.any():
            return np.zeros(2), True
        if np.linalg.matrix_rank(A) == 2:
            held: Vector = np.asarray(np.linalg.solve(A, f0), dtype=float)
            most, slope = limit, follow
            if not loose and self.rest[k] is not self.limit[k]:
                # the limit of breaking loose, as it is with this very force
                self.forces[k] = held
                known = self._with(self.forces)
                if known is None:
                    return None
                most = self.rest[k].value + float(self.rest[k].slope @ known.l)
                slope = np.zeros(2)
            if math.hypot(*held) <= (most + float(slope @ held)) * (1.0 + EDGE):
                return held, True
        way = on_disk(f0, A, limit, follow)
        if way is None:
            return None
        return limit / (1.0 - float(follow @ way)) * way, False

    def _fits(self, found: Answer, holds: Sequence[bool], loose: Sequence[bool]) -> bool:
        """Whether what is held stays within its limit."""
        for k, disk in enumerate(self.disks):
            most = (self.limit if loose[k] else self.rest)[k]
            reach = most.value + float(most.slope @ found.l)
            if holds[k] and math.hypot(*found.l[list(disk.ports)]) > reach * (1.0 + ENOUGH):
                return False
        return True

    def _answer(self) -> Answer | None:
        self.forces = [None] * len(self.disks)
        loose = [False] * len(self.disks)
        before = math.inf
        for _ in range(TURNS):
            found = self._with(self.forces)
            if found is None:
                return None
            moved = 0.0
            for k, disk in enumerate(self.disks):
                if self.forces[k] is None:
                    held = -found.l[list(disk.ports)]
                    most = (self.limit if loose[k] else self.rest)[k]
                    reach = most.value + float(most.slope @ found.l)
                    size = math.hypot(*held)
                    if size > 0.0:
                        disk.way = held / size
                    if size <= reach * (1.0 + EDGE):
                        continue
                    loose[k] = True
                    self.forces[k] = max(self._limit(k, found), 0.0) * disk.way
                    moved = math.inf
                else:
                    change = self._turned(k)
                    if change is None:
                        return None
                    moved = max(moved, change)
            if moved <= STILL or (moved <= ENOUGH and moved >= 0.5 * before):
                return self._with(self.forces)
            before = moved
        return None

    def _with(self, forces: Sequence[Vector | None]) -> Answer | None:
        roles: dict[int, str] = {}
        friction: dict[int, Friction] = {}
        for disk, limit, force in zip(self.disks, self.limit, forces, strict=True):
            roles.update(dict.fromkeys(disk.ports, HELD if force is None else FORWARD))
            if force is not None:
                friction.update(on_the_way(disk, limit, force))
        return solve_laws(self.problem.within(roles, friction), start=self.start)

    def _limit(self, k: int, found: Answer) -> float:
        return self.limit[k].value + float(self.limit[k].slope @ found.l)

    def _about(self, k: int) -> tuple[Matrix, Vector, float, Vector] | None:
        """Return how the slip and the limit of one disk follow its force, the others held.

        ``f = f0 - A p``, and the limit ``limit + follow . p``.
        """
        now = self.forces[k]
        assert now is not None
        ports = list(self.disks[k].ports)
        scale = max(float(np.abs(now).max()), abs(self.limit[k].value))
        probe = 1e-3 * scale if scale > 0.0 else 1.0
        slips, limits = [], []
        for step in np.array([[0.0, 0.0], [probe, 0.0], [0.0, probe]]):
            forces = list(self.forces)
            forces[k] = now + step
            found = self._with(forces)
            if found is None:
                return None
            slips.append((self.problem.M @ found.l + self.problem.q)[ports])
            limits.append(self._limit(k, found))
        A = -np.column_stack([slips[1] - slips[0], slips[2] - slips[0]]) / probe
        follow = np.array([limits[1] - limits[0], limits[2] - limits[0]]) / probe
        follow = np.where(np.abs(follow) <= EDGE * abs(limits[0]) / probe, 0.0, follow)
        return A, slips[0] + A @ now, limits[0] - float(follow @ now), follow

    def _turned(self, k: int) -> float | None:
        """Put one disk on its edge, the others held; return how far its force moved."""
        disk, now = self.disks[k], self.forces[k]
        about = self._about(k)
        if about is None or now is None:
            return None
        A, f0, limit, follow = about
        way = on_disk(f0, A, limit, follow)
        if way is None:
            return None
        force = limit / (1.0 - float(follow @ way)) * way
        self.forces[k], disk.way = force, way
        most = max(math.hypot(*force), math.hypot(*now))
        return math.hypot(*(force - now)) / most if most > 0.0 else 0.0


class Kept:
    """What planar friction keeps between events, in the vector of integrated signals."""

    def __init__(self, graph: FlatGraph) -> None:
        self.graph = graph
        at = {i.path: i.index for i in graph.integrals}
        self.places = {
            m.index: (at[join(m.path, HEADING)], at[join(m.path, SLOW)])
            for m in graph.machines
            if m.law is not None and m.law.planar
        }
        self.disks: list[Disk] = []

    def slow(self, s: Vector) -> dict[int, float]:
        """Return by machine the speed at which slip ends, or has begun."""
        return {m: float(s[slow]) for m, (_, slow) in self.places.items()}

    def after(self, s: Vector, mode: Mode) -> Vector:
        """Return the signals with the heading of what begins to slip in `mode`."""
        new = s.copy()
        for disk in self.disks:
            heading, slow = self.places[disk.machine]
            if mode[disk.machine] == 0:
                continue
            angle = math.atan2(disk.way[1], disk.way[0])
            apart = abs(math.remainder(angle - float(s[heading]), 2.0 * math.pi))
            if s[slow] < 0.0 and (apart <= SAME or not disk.resting):
                continue  # decided at this instant already
            if not disk.resting and 0.0 < s[slow] < disk.speed:
                continue  # slips on
            new[heading] = angle
            new[slow] = -max(BEGINS * disk.size, 10.0 * disk.speed * disk.resting, TINY)
        return new if not np.array_equal(new, s) else s
