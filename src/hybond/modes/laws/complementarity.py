"""Which branches the laws of junctions take: decided together, impulses first.

At an instant, in the mode that the machines are in, the graph seen from its junction laws is
(`equations.ports`)::

    w = y + D l;    y moves by C E nu under impulses nu, and at the rate y' + C E l

1. *Impulses.* Where some law is violated by what is stored (``y < 0``), the branches that carry
   impulses are those of the complementarity problem ``0 <= nu  |  y + C E nu >= 0``. Entering the
   mode of these branches is the jump (`jump.enter`): conservation of state, as for any other mode.
   Newton's restitution adds ``eps pre(y)``: its contacts take the branch ``impact``.
2. *Finite values, then rates.* From the state after the jump, the branches that last are those of
   an implicit step of vanishing length ``h``: ``0 <= l  |  (y + h y') + (D + h C E) l >= 0``. The
   finite values decide; where both of a pair are zero, the rates do.

Each answer is checked: in the mode found, no rule of a law may hold. Dry friction has two pairs
per junction, sliding forward and backward; its limit may follow a contact force of the same
problem. Sources: Heemels, Schumacher & Weiland, *Linear complementarity systems*, SIAM J. Appl.
Math. 60 (2000); Camlibel et al. on passive ones (2002). SEMANTICS: all junctions at once, never
one after another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.causality.assign import assign
from hybond.causality.explain import describe_conflict
from hybond.causality.orientation import base_mode
from hybond.equations.leakage import null_space
from hybond.equations.ports import Port, PortEquations, Response
from hybond.errors import NumericsError
from hybond.model.expressions import Expr, Number, compile_expression
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.dirac import DIRAC, Pair, Pairs, steady
from hybond.modes.jump import enter, reach_of_bonds
from hybond.modes.laws.friction import Linearised, breaking_loose
from hybond.modes.laws.gaps import check_gaps
from hybond.modes.laws.planar import Kept, Rests, disks_of, on_the_way
from hybond.modes.laws.problem import (
    BACKWARD,
    CUT,
    FORWARD,
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
from hybond.programs.program import Program
from hybond.solvers.lcp import positive_semidefinite
from hybond.trace import Trace

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]

ZERO = 1e-12
"""Part of its terms below which a value counts as zero; guards are located a tenth before that, so
that what passes through zero at an event is decided by its rate."""
LOCATED = 0.02
"""Part of that zero from which on guards may be located."""
DUST = 1e-9
"""Part of its terms up to which a violation without a solution is rounding."""
SHORT = 1e-6
"""The vanishing step, as a part of the shortest time that feedthrough and storage make."""
TRIES = (
    (1.0, True, True),
    (1.0, False, True),
    (1.0, False, False),
    (1.0, None, True),
    (1e-3, True, True),
    (1e-3, False, True),
    (1e3, False, True),
    (1e-6, False, True),
)
"""Factors of the vanishing step; whether what is open is left as it was (None: friction exactly at
its limit breaks loose); and whether rounding of what is stored counts as zero; in turn."""
ADRIFT = 1e-6
"""Share of a unit of freedom from which a junction has part in it."""
CLOSED = 1e-10
"""Part of the largest gap so far below which a gap is closed."""


@dataclass(slots=True)
class Instant:
    """Everything at one instant that the branches depend on."""

    t: float
    s: Vector
    mode: Mode
    after: Interval
    pre: Sequence[float]


class Complementarity:
    """Chooses branches for one program."""

    def __init__(self, program: Program, trace: Trace) -> None:
        self.program = program
        self.trace = trace
        self.graph = program.graph
        self.laws = tuple(m.index for m in self.graph.machines if m.law is not None)
        self.kept = Kept(self.graph)
        self.limits = Linearised(program)
        self._largest: dict[int, float] = {}
        self._checked = False
        self._sized: dict[int, Callable[[Pairs], Pair]] = {}

    # -- the two problems

    def jumping(self, at: Instant, x: Vector, *, energy: float) -> Iterator[Mode]:
        """Yield modes whose branches may carry impulses, the likeliest first.

        Nothing if no law is violated by what is stored.
        """
        ports, v, x = self.consistent(at, x, energy)
        self.kept.disks = []
        response = ports.response(v, x)
        y = self.clean(response, ports, x, energy)
        one_sided = np.array([not p.law.two_sided for p in ports.ports])
        taking = one_sided & self.able(ports, v, at)
        rebound = np.array(
            [
                0.0 if p.law.restitution is None else float(self.value(p.law.restitution, v))
                for p in ports.ports
            ]
        )
        # what rebounds enters one after another; what does not stays together, as in one problem
        taking &= (rebound == 0.0) | (y < 0.0)
        # OFF where the common variable follows from what is stored alone: it must be zero
        shut = one_sided & ~self.able(ports, v, at) & ~response.D.any(axis=1)
        shut &= np.array([p.given == "net" for p in ports.ports])
        wrong = (taking & (y < 0.0)) | (shut & (y != 0.0))
        if not wrong.any():
            return
        taking |= np.array([p.law.impulsive for p in ports.ports])
        roles = [_role(p, takes) for p, takes in zip(ports.ports, taking, strict=True)]
        # friction that is no impulse lets its junction slide through a jump
        for k, port in enumerate(ports.ports):
            if port.law.two_sided and not port.law.impulsive:
                roles[k] = HELD if port.given == "common" else CUT
        start = self._branches(ports, at.mode)
        resting = set(range(len(ports.ports)))
        shift = rebound * y
        for factor in dict.fromkeys(f for f, _, _ in TRIES):
            h = factor * self.step(response, y)
            found = self._solve(ports, v, response, y, h, roles, start, resting, shift)
            if found is not None:
                yield self._mode(at, ports, found, keep=False, impact=True)
        if (np.abs(y) <= DUST * self._size(response, ports, x, energy))[wrong].all():
            return  # rounding has no solution; what lasts is decided without it
        raise self._unsolvable(at, ports, taking, "impulses")

    def dusted(self, at: Instant, x: Vector, *, energy: float) -> Vector:
        """Return the state without approaches that are nothing but rounding.

        For the laws they are zero, for the guards that watch them they may not be. They are taken
        away as an impact would, along the impulses of their contacts.
        """
        ports, v, x = self.consistent(at, x, energy)
        response = ports.response(v, x)
        size = self._size(response, ports, x, energy)
        slow = (response.y < -LOCATED * ZERO * size) & (response.y >= -ZERO * size)
        slow &= np.array([not p.law.two_sided for p in ports.ports])
        slow &= ~response.D.any(axis=1)
        who = np.flatnonzero(slow & self.able(ports, v, at)) if slow.any() else np.flatnonzero(slow)
        if not len(who):
            return x
        impulse = np.linalg.lstsq(response.CE[np.ix_(who, who)], -response.y[who], rcond=None)[0]
        return np.asarray(x + response.E[:, who] @ impulse)

    def lasting(self, at: Instant, x: Vector, *, energy: float) -> Iterator[tuple[Mode, bool]]:
        """Yield modes whose branches may last from the state `x`, the likeliest first."""
        ports, v, x = self.consistent(at, x, energy)
        response = ports.response(v, x, later=lambda dt, field: self._later(at, x, dt, field))
        able = self.able(ports, v, at)
        state_like = np.abs(np.diag(response.D)) == 0.0
        stored = ~response.D.any(axis=1)
        given_net = np.array([p.given == "net" for p in ports.ports])
        start = self._branches(ports, at.mode)
        disks = self.kept.disks = []
        if self.kept.places:
            size = self._size(response, ports, x, energy)
            disks = self.kept.disks = disks_of(ports, response, size, self.kept.slow(at.s))
        solved = False
        for factor, keep, clean in TRIES:
            y = self.clean(response, ports, x, energy) if clean else response.y.copy()
            roles = [
                _lasting_role(p, bool(a), bool(state), float(value))
                for p, a, state, value in zip(ports.ports, able, state_like, y, strict=True)
            ]
            for disk in disks:
                # their slip is zero in both directions or in none
                y[list(disk.ports)] = 0.0 if disk.resting else response.y[list(disk.ports)]
                for port in disk.ports:
                    roles[port] = HELD if disk.resting else FORWARD
            # what is stored keeps these apart, however fast that may change
            apart = stored & (y > 0.0) & np.array([r == ONE_SIDED for r in roles])
            for k in np.flatnonzero(apart):
                roles[k] = CUT
            h = factor * self.step(response, y)
            q = y + h * response.rate
            found = self._slide(ports, v, response, y, q, h, roles, start)
            if found is not None and keep is None:
                found = self._loosened(ports, v, response, y, q, h, roles, found)
            if found is None:
                continue
            found.branch[apart & given_net] = 1
            solved = True
            adrift = _adrift(response, found, given_net)
            if adrift.any():
                parted = replace(found, branch=np.where(adrift, 0, found.branch).astype(np.int8))
                yield self._mode(at, ports, parted, keep=False, impact=False), False
            yield self._mode(at, ports, found, keep=bool(keep), impact=False), bool(keep)
        if not solved:
            raise self._unsolvable(at, ports, able, "finite values")

    def _slide(
        self,
        ports: PortEquations,
        v: list[float],
        response: Response,
        y: Vector,
        q: Vector,
        h: float,
        roles: list[str],
        start: Branches,
        loose: set[int] | None = None,
    ) -> Answer | None:
        """Solve, with breakaway where a friction junction is at rest, sliding limits elsewhere.

        `loose` are junctions at rest that break loose now.
        """
        held = {
            k for k, p in enumerate(ports.ports) if p.law.breakaway is not None and not p.law.planar
        }
        held -= {k for k in held if ports.ports[k].given == "net" and abs(y[k]) > 0.0}
        held -= loose or set()
        return breaking_loose(
            held, lambda resting: self._solve(ports, v, response, q, h, roles, start, resting)
        )

    def _loosened(
        self,
        ports: PortEquations,
        v: list[float],
        response: Response,
        y: Vector,
        q: Vector,
        h: float,
        roles: list[str],
        found: Answer,
    ) -> Answer | None:
        """Let friction slide that holds with all it has; None if there is none."""
        w = (response.D + h * response.CE) @ found.l + q
        force = [-found.l[k] if p.given == "net" else -w[k] for k, p in enumerate(ports.ports)]
        edge = [
            k
            for k, p in enumerate(ports.ports)
            if p.law.two_sided and found.open[k] and found.branch[k] == 0 and force[k] != 0.0
        ]
        if not edge:
            return None
        roles = list(roles)
        start = found.branch.copy()
        for k in edge:
            start[k] = 1 if force[k] > 0.0 else -1
            if ports.ports[k].given == "net":
                roles[k] = FORWARD if force[k] > 0.0 else BACKWARD
        again = self._slide(ports, v, response, y, q, h, roles, start, loose=set(edge))
        if again is None:
            return None
        branch = again.branch.copy()
        branch[edge] = start[edge]
        return replace(again, branch=branch)

    # -- parts of them

    def consistent(
        self, at: Instant, x: Vector, energy: float
    ) -> tuple[PortEquations, list[float], Vector]:
        """Return the ports, values, and the state on what the machines' mode alone asks for."""
        program = self.program
        ports = program.ports(at.mode, at.after, at.t)
        v = program.values(at.t, at.after, base_mode(self.graph, at.mode), x, at.s)
        v[program.slots.size :] = list(at.pre)
        where = self.graph.mode_text(at.mode)
        energy = max(energy, abs(ports.equations.storage.energy(x)))
        moved = enter(ports.equations, v, x, where=where, energy=energy).x
        v[program.slots.x] = moved.tolist()
        if not self._checked:
            self._checked = True
            check_gaps(program, ports, v, moved)
        return ports, v, moved

    def _later(self, at: Instant, x: Vector, dt: float, field: Vector) -> list[float]:
        """Return the values a moment later, for the rates of a nonlinear graph."""
        program = self.program
        v = program.values(
            at.t + dt, at.after, base_mode(self.graph, at.mode), x + dt * field, at.s
        )
        v[program.slots.size :] = list(at.pre)
        return v

    def able(self, ports: PortEquations, v: list[float], at: Instant) -> Mask:
        """Return which laws may take their ON branch at all: contacts closed, thyristors fired."""
        able = np.ones(len(ports.ports), dtype=bool)
        # rounding of a gap is that of its terms, as for the guards that watch it
        pairs = steady(v, np.abs(v[: self.program.slots.size]).tolist())
        for k, port in enumerate(ports.ports):
            on = bool(self.graph.machines[port.machine].on[at.mode[port.machine]])
            if port.law.gap is not None:
                gap = self._compiled(port.law.gap)(pairs)
                largest = max(self._largest.get(port.machine, 0.0), abs(gap.finite))
                self._largest[port.machine] = largest
                able[k] = on or gap.sign <= 0 or gap.finite <= CLOSED * largest
            if port.law.gate is not None:
                able[k] = on or bool(self.value(port.law.gate, v))
        return able

    def clean(self, response: Response, ports: PortEquations, x: Vector, energy: float) -> Vector:
        """Return `y` with rounding counted as zero.

        Rounding of what is stored is measured by what the energy of the run would make of it: a
        mass that has come to rest need not do so to the last 1e-30.
        """
        size = self._size(response, ports, x, energy)
        return np.where(np.abs(response.y) <= ZERO * size, 0.0, response.y)

    def _size(self, response: Response, ports: PortEquations, x: Vector, energy: float) -> Vector:
        """Return what rounding of each `y` is measured by."""
        reach = reach_of_bonds(ports.equations, x, energy)
        return np.asarray(response.size + 10.0 * (ports.partner_size @ reach))

    def observe(self, v: Sequence[float]) -> None:
        """Learn how large gaps are in this run, which their rounding is measured by."""
        self.observed({k: abs(float(self.value(gap, v))) for k, gap in self.gaps.items()})

    @property
    def gaps(self) -> dict[int, Expr]:
        """The distances of contacts, machine by machine."""
        laws = {k: self.graph.machines[k].law for k in self.laws}
        return {k: law.gap for k, law in laws.items() if law is not None and law.gap is not None}

    def observed(self, gaps: Mapping[int, float]) -> None:
        """Learn the same from the largest distances of a stretch of motion."""
        for index, gap in gaps.items():
            self._largest[index] = max(self._largest.get(index, 0.0), gap)

    def value(self, e: Expr, v: Sequence[float]) -> float:
        """Return the value of an expression of a law."""
        return e.value if isinstance(e, Number) else self.program.compile(e)(v)

    def _compiled(self, e: Expr) -> Callable[[Pairs], Pair]:
        """Return an expression of a law over values that know the size of their terms."""
        found = self._sized.get(id(e))
        if found is None:
            slots = self.program.slots
            found = compile_expression(e, slots.index, DIRAC, pre_offset=slots.size)
            self._sized[id(e)] = found
        return found

    def _branches(self, ports: PortEquations, mode: Mode) -> Branches:
        """Return the branches of `mode`: 0 OFF or at rest, 1 ON or forward, -1 backward."""
        found = []
        for port in ports.ports:
            machine = self.graph.machines[port.machine]
            state = mode[port.machine]
            backward = machine.states[state] == "backward"
            found.append(-1 if backward else int(bool(machine.on[state])))
        return np.array(found, dtype=np.int8)

    def step(self, response: Response, y: Vector) -> float:
        """Return a step so short that finite values outweigh rates, and feedthrough storage."""
        through, stored = np.abs(np.diag(response.D)), np.abs(np.diag(response.CE))
        both = (through > 0.0) & (stored > 0.0)
        h = SHORT * float((through[both] / stored[both]).min(initial=1.0))
        quick = (y != 0.0) & (np.abs(response.rate) > 0.0)
        apart = np.abs(y[quick]) / np.abs(response.rate[quick])
        return min(h, 1e-3 * float(apart.min(initial=np.inf)))

    def _solve(
        self,
        ports: PortEquations,
        v: list[float],
        response: Response,
        q: Vector,
        h: float,
        roles: list[str],
        start: Branches,
        resting: set[int],
        shift: Vector | None = None,
    ) -> Answer | None:
        """Solve one complementarity problem; warn where another answer fits as well.

        `resting` are friction junctions that hold up to their breakaway limits.
        """

        def limit(k: int, *, at_rest: bool) -> Friction:
            law = ports.ports[k].law
            e = law.breakaway if at_rest and law.breakaway is not None else law.limit
            assert e is not None
            return self.limits.at(e, values, response.bonds, response.gain)

        values = list(v)
        values[self.program.slots.w] = response.bonds.tolist()
        friction = {
            k: limit(k, at_rest=k in resting)
            for k in range(len(ports.ports))
            if roles[k] in (TWO_SIDED, FORWARD, BACKWARD)
        }
        m = response.D + h * response.CE
        disks = [d for d in self.kept.disks if roles[d.ports[0]] in (HELD, FORWARD)]
        for disk in disks:
            if not disk.resting:
                friction.update(on_the_way(disk, friction[disk.ports[0]]))
        # a law that neither acts on anything nor feels any other: its value is rounding, or right
        idle = ~(m.any(axis=1) | m.any(axis=0))
        q = np.where(idle & (q < 0.0) & (q >= -DUST * response.size), 0.0, q)
        common = [p.given == "common" for p in ports.ports]
        problem = Problem(m, q, roles, common, shift, friction)
        held = [d for d in disks if d.resting]
        if held and shift is None:
            rest, slip = ([limit(d.ports[0], at_rest=r) for d in held] for r in (True, False))
            found = Rests(held, problem, rest, slip, start).answer()
        elif friction:
            found = solve_laws(problem, start=start)
        else:
            # in units in which efforts and flows are of one size: both must show their signs
            d = self._units(ports, q)
            scaled = None if shift is None else shift * d
            even = replace(problem, M=m * d * d[:, None], q=q * d, shift=scaled)
            found = solve_laws(even, start=start)
            found = None if found is None else replace(found, l=found.l * d)
        if found is None or held or np.array_equal(found.branch, start):
            return found
        coupled = any(f.slope.any() for f in friction.values())
        if not coupled and positive_semidefinite(m):
            return found
        other = ambiguous(problem, found)
        if other:
            names = ", ".join(ports.ports[k].path for k in other)
            self.trace.warn(
                f"at t = {v[0]:.9g} s the laws of {names} have more than one solution (Painleve): "
                "the one found first is taken; a stiffness in the contact decides"
            )
        return found

    def _units(self, ports: PortEquations, q: Vector) -> Vector:
        """Return factors of `w` that make its efforts and its flows alike, domain by domain.

        The same factors divide `l`, so that powers stay what they are.
        """
        effort = np.array(
            [
                (self.graph.nodes[p.law.node].kind == "1") == (p.given == "common")
                for p in ports.ports
            ]
        )
        domain = np.array([self.graph.nodes[p.law.node].domain.name for p in ports.ports])
        d = np.ones(len(q))
        for name in dict.fromkeys(domain.tolist()):
            own = domain == name
            e = float(np.abs(q[own & effort]).max(initial=0.0))
            f = float(np.abs(q[own & ~effort]).max(initial=0.0))
            if e > 0.0 and f > 0.0:
                d[own] = np.where(effort[own], np.sqrt(f / e), np.sqrt(e / f))
        return d

    # -- answers

    def _mode(
        self, at: Instant, ports: PortEquations, found: Answer, *, keep: bool, impact: bool
    ) -> Mode:
        """Return the mode with the branches found; what is open stays as it was if `keep`."""
        mode = list(base_mode(self.graph, at.mode))
        for k, port in enumerate(ports.ports):
            machine = self.graph.machines[port.machine]
            now = at.mode[port.machine]
            if port.law.planar:
                mode[port.machine] = int(impact or found.branch[k] != 0)
                continue
            if port.law.two_sided:
                # sticking would carry impulses, friction does not: it slides through a jump
                names = {0: "sticks", 1: "forward", -1: "backward"}
                state = found.branch[k]
                if impact and not port.law.impulsive:
                    state = -1 if machine.states[now] == "backward" else 1
                mode[port.machine] = machine.states.index(names[int(state)])
                continue
            on = bool(found.branch[k])
            if keep and found.open[k] and now < 2:
                on = bool(machine.on[now])
            if on and impact and port.law.restitution is not None:
                mode[port.machine] = machine.states.index("impact")
            else:
                mode[port.machine] = int(on)
        return tuple(mode)

    def _unsolvable(
        self, at: Instant, ports: PortEquations, taking: Mask, what: str
    ) -> NumericsError:
        # where none may be ON, what keeps them OFF leaves no answer
        names = ", ".join(
            p.path for p, a in zip(ports.ports, taking, strict=True) if a or not taking.any()
        )
        mode = base_mode(self.graph, at.mode)
        opposed = " ".join(
            f" {describe_conflict(self.graph, mode, c)}" for c in assign(self.graph, mode).conflicts
        )
        return NumericsError(
            f"the {what} of {names} have no solution at t = {at.t:.9g} s.{opposed}".rstrip("."),
            code="HB-J110",
            where=self.graph.mode_text(at.mode),
            hint="give the flow of a source another way, or the source a resistance"
            if opposed
            else "friction of a rigid contact may leave none (Painleve): give the contact a "
            "stiffness, or a source a resistance",
        )


def _adrift(response: Response, found: Answer, given_net: Mask) -> Mask:
    """Return the junctions that conduct nothing and whose blocked value nothing determines.

    Around a loop that others have opened, each may block as well as conduct, and the voltage of the
    loop lies on the open ones in shares that no equation fixes. To let one conduct would put all of
    it on the others, in the order of the elements.
    """
    idle = found.open & given_net & (found.branch == 1)
    if not idle.any():
        return np.asarray(idle)
    blocked = given_net & (found.branch == 0)
    who = np.flatnonzero(idle | blocked)
    shares = null_space(np.vstack([m[np.ix_(who, who)] for m in (response.D, response.CE)]))
    shown = np.zeros(len(idle), dtype=bool)
    shown[who] = (np.abs(shares) > ADRIFT).any(axis=1)
    return np.asarray(idle & shown)


def _role(port: Port, takes: bool) -> str:
    """Return how a port takes part; one that does not is OFF."""
    if not takes:
        return CUT if port.given == "common" else HELD
    return TWO_SIDED if port.law.two_sided else ONE_SIDED


def _lasting_role(port: Port, able: bool, state_like: bool, y: float) -> str:
    """Return how a port takes part in what lasts, `y` being decided by what is stored."""
    law = port.law
    if law.two_sided:
        if state_like and port.given == "net" and y != 0.0:
            return FORWARD if y > 0.0 else BACKWARD
        return TWO_SIDED
    # a contact that still approaches is for the next jump
    comes = law.restitution is not None and state_like and y < 0.0
    return _role(port, able and not comes)
