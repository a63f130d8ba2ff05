"""Landing: what happens where impacts accumulate.

A machine lands when its next flight would be below the position tolerance and all that is left of
its flights below the time room; such a flight is never started. It then stays in its pinnacle
state, whose impact law has every ``pre()`` term at its limit 0: what held for an instant is now a
mode with a field. Its own exits are suspended. It leaves, by its first exit, when the reaction (the
conjugate of what the impact law prescribes) changes the sign that its impulses had: a floor
pushes, it never pulls. A landing is accepted only if the reaction has that sign to begin with.

Sources: Mosterman & Biswas 2002, section 4 (pinnacles, time-scale abstraction); the extrapolation
and the landing are hybond's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.engine.tables.contacts import Contact, Reaction, contact_of
from hybond.equations.mode import ModeEquations
from hybond.errors import HybondError
from hybond.model.graph import FlatGraph, Machine, Mode
from hybond.model.interval import Interval
from hybond.modes.landing.accumulation import POSITION, Clock, Limit, Series, chatter
from hybond.modes.landing.contacts import at_rest, with_states
from hybond.modes.landing.rest import moved, rest, still
from hybond.modes.locate import Locator, watch
from hybond.modes.settle import Settler
from hybond.modes.trial import Trial
from hybond.programs.program import Program
from hybond.trace import Accumulation, Event, Fired, Trace

Vector = NDArray[np.float64]

CROWD = 100
"""Events in a row between which no time passes that end a run."""
MOMENT = 1e-13
"""What counts as no time for all of them together, as a part of the run."""
SLOW = 1e-3
LIVELY, FADING = 10.0, 1000.0
"""A rebound at half the speed of the approach or more is looked at more closely if the last flight
was shorter than `LIVELY` times the time room; a slower one if it is below the part `SLOW` of the
fastest approach, or if the last flight was shorter than `FADING` times the time room."""


KEPT = 64
"""Instants kept of a machine that is not struck."""


@dataclass(frozen=True, slots=True)
class Touch:
    """An impact that has just been settled: how fast it was approached and is left."""

    contact: Contact
    t: float
    gap: float
    approach: float
    rebound: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """What becomes of contacts after an impact: `limit` if they land, else `why` they do not."""

    limit: Limit | None
    trial: Trial | None
    why: str


class Landings:
    """Watches the impacts of one run, and lands machines where they accumulate."""

    def __init__(self, program: Program, settler: Settler, trace: Trace, until: float) -> None:
        self.whole = self.program = program
        self.graph: FlatGraph = program.graph
        self.settler = settler
        self.trace = trace
        self.until = until
        self.clock = Clock(until)
        self.landed: dict[int, Contact] = {}
        """By machine: where it has landed."""
        self._series: dict[int, Series] = {}
        self._others: dict[int, list[float]] = {}
        self._contacts: dict[tuple[int, int], Contact | None] = {}
        self._touches: list[Touch] = []
        self._why: dict[int, str] = {}
        self._held: tuple[int, ...] = ()
        """Storages that landed contacts hold still."""
        self._in_force: dict[int, tuple[int, ...]] = {}
        """By settler: the machines whose rules there are those of a landed one."""

    @property
    def names(self) -> tuple[str, ...]:
        """Paths of the machines that have landed."""
        return tuple(c.machine.path for c in self.landed.values())

    @property
    def machines(self) -> tuple[Machine, ...]:
        """The machines with the rules in force: a landed one is left when its reaction turns."""
        return self.settler.graph.machines

    # -- watching

    def observe(self, event: Event, before: Mode, interval: Interval) -> None:
        """Learn from an event, settled from the mode `before`, which impacts it was."""
        self._sync(event.steps[-1].mode, event.t)
        self._touches = []
        struck: dict[int, tuple[Contact, Mode]] = {}
        for step in event.steps:
            for machine in self.graph.machines:
                state = step.mode[machine.index]
                if step.kind != "pinnacle" or machine.index in self.landed:
                    continue
                contact = self._contact(machine, state)
                if contact is not None:
                    struck[machine.index] = contact, step.mode
        fired = {f.machine for step in event.steps for f in step.fired}
        for machine in self.graph.machines:
            if machine.index in struck:
                contact, pinnacle = struck[machine.index]
                self._touch(contact, event, before, pinnacle, interval)
            elif machine.path in fired:
                times = self._others.setdefault(machine.index, [])
                times.append(event.t)
                del times[:-KEPT]

    def observe_many(self, t: Vector, approach: Vector, fired: NDArray[np.bool_]) -> None:
        """Learn from events none of which may be a landing.

        Parameters
        ----------
        t : array, shape (events,)
        approach : array, shape (events, machines)
            What the impact laws read that were struck; nan for the other machines.
        fired : array of bool, shape (events, machines)
            Whether a machine fired.
        """
        self._touches = []
        struck = ~np.isnan(approach)
        for k in np.flatnonzero(struck.any(axis=0)).tolist():
            own = struck[:, k]
            series = self._series.setdefault(k, Series())
            series.note(t[own].tolist(), approach[own, k].tolist())
        others = fired & ~struck
        for k in np.flatnonzero(others.any(axis=0)).tolist():
            times = self._others.setdefault(k, [])
            times += t[others[:, k]].tolist()[-KEPT:]
            del times[:-KEPT]

    def contacts(self) -> list[Contact]:
        """Return the impact laws of all written machines."""
        found = [
            self._contact(machine, state)
            for machine in self.graph.machines
            if machine.law is None
            for state in range(len(machine.states))
        ]
        return [c for c in found if c is not None]

    def known(self, contact: Contact) -> bool:
        """Whether the signs of its reactions have been learned."""
        series = self._series.get(contact.machine.index)
        return series is not None and len(series.signs) >= len(contact.reactions)

    def flown(self, machine: int) -> tuple[float, float]:
        """Return when the last impact of a machine was, s, and the fastest approach so far."""
        series = self._series.get(machine, Series())
        return series.since, series.speed

    def _touch(
        self, contact: Contact, event: Event, before: Mode, pinnacle: Mode, interval: Interval
    ) -> None:
        series = self._series.setdefault(contact.machine.index, Series())
        mode = event.steps[-1].mode
        approach = self._speed(contact, event.t, event.before, mode, interval)
        rebound = self._speed(contact, event.t, event.after, mode, interval)
        gap = event.t - series.since
        series.note([event.t], [approach])
        self._touches.append(Touch(contact, event.t, gap, approach, rebound))
        if len(series.signs) < len(contact.reactions):
            series.signs.update(self._signs(contact, event, before, pinnacle, interval))

    def _speed(
        self, contact: Contact, t: float, y: Vector, mode: Mode, interval: Interval
    ) -> float:
        """Return how far the state is from what the impact laws prescribe at rest."""
        program = self.program
        v = program.evaluate(t, y, interval, program.equations(mode, interval, t))
        at_rest = v[: program.slots.size] + [0.0] * program.slots.size
        worst = 0.0
        for r in contact.reactions:
            total = sum(sign * v[program.slots.index[name]] for name, sign in r.prescribed)
            if r.own:
                law = self.graph.nodes[r.law].law
                assert law is not None
                total += r.own * float(program.compile(law.expressions[0])(at_rest))
            worst = max(worst, abs(total))
        return worst

    def _signs(
        self, contact: Contact, event: Event, before: Mode, pinnacle: Mode, interval: Interval
    ) -> dict[str, int]:
        """Return the sign of each reaction's impulse in the impact."""
        trials = self.settler.trials
        nx, ns = self.program.nx, self.program.ns
        x, s = event.before[:nx], event.before[nx : nx + ns]
        try:
            pre = trials.a_priori(event.t, x, s, before, interval)
            trial = trials.enter(event.t, x, s, pinnacle, interval, pre, jump=True)
        except HybondError:
            return {}
        areas = {r.name: self._area(trial, r) for r in contact.reactions}
        return {name: 1 if a > 0.0 else -1 for name, a in areas.items() if a != 0.0}

    def _area(self, trial: Trial, reaction: Reaction) -> float:
        slots = self.program.slots
        return float(trial.jump.impulses[slots.index[reaction.name] - slots.w.start])

    def _contact(self, machine: Machine, state: int) -> Contact | None:
        key = machine.index, state
        if key not in self._contacts:
            self._contacts[key] = contact_of(self.graph, machine, state)
        return self._contacts[key]

    # -- landing

    def land(
        self, t: float, y: Vector, mode: Mode, interval: Interval
    ) -> tuple[float, Vector, Mode, Event] | None:
        """Land the machines whose impacts, just observed, are over; None if there is none.

        Call it until it returns None.

        Returns
        -------
        tuple
            Time, state and mode from which time goes on, and the event to note.
        """
        touches, self._touches = self._touches, []
        touches = [c for c in touches if self._worth_trying(c, mode)]
        together = [touches] if len(touches) > 1 else []
        for chosen in (*together, *([c] for c in touches)):
            verdict = self._verdict(chosen, t, y, mode, interval)
            if verdict.limit is not None and verdict.trial is not None:
                self._touches = [c for c in touches if c not in chosen]
                return self._put_down(chosen, verdict.limit, verdict.trial, t, y, mode, interval)
            for touch in chosen:
                self._why[touch.contact.machine.index] = verdict.why
        return None

    def _worth_trying(self, touch: Touch, mode: Mode) -> bool:
        contact = touch.contact
        machine = contact.machine
        if machine.on[mode[machine.index]] >= machine.on[contact.rest]:
            return False  # it closed without our help
        series = self._series[machine.index]
        room = self.clock.room(touch.t)
        if touch.rebound >= 0.5 * touch.approach:
            # it flies about as long as before
            return touch.gap <= LIVELY * room
        return touch.rebound <= SLOW * series.speed or touch.gap <= FADING * room

    def _verdict(
        self, touches: Sequence[Touch], t: float, y: Vector, mode: Mode, interval: Interval
    ) -> Verdict:
        """Try the pinnacles' structure at rest, and see what it would have to carry."""
        program = self.program
        nx, ns = program.nx, program.ns
        x, s = y[:nx], y[nx : nx + ns]
        target = with_states(mode, [c.contact for c in touches])
        try:
            pre = self.settler.trials.a_priori(t, x, s, mode, interval)
            trial = rest(program, t, x, s, target, interval, pre, energy=self.trace.energy)
        except HybondError as error:
            return Verdict(None, None, f"its structure has no solution at rest ({error.why})")
        found: Limit | None = None
        for touch in touches:
            series = self._series[touch.contact.machine.index]
            for reaction in touch.contact.reactions:
                why = self._refusal(reaction, series, trial)
                if why:
                    return Verdict(None, None, why)
            limit = self._limit(touch, series, trial)
            if limit is None:
                return Verdict(None, None, "its rebounds do not vanish")
            found = limit if found is None or limit.t > found.t else found
        return Verdict(found, trial, "")

    def _refusal(self, reaction: Reaction, series: Series, trial: Trial) -> str:
        sign = series.signs.get(reaction.name)
        if sign is None:
            return f"the impulses of {reaction.text} have no sign"
        slot = self.program.slots.index[reaction.name]
        if np.any(trial.freedom[slot - self.program.slots.w.start]):
            return f"the equations at rest leave {reaction.text} open"
        pair = trial.pairs[slot]
        if pair.sign != sign:
            wanted = "positive" if sign > 0 else "negative"
            return f"at rest {reaction.text} = {pair.finite:.6g}, which is not {wanted}"
        return ""

    def _limit(self, touch: Touch, series: Series, trial: Trial) -> Limit | None:
        """Return where the impacts end if the next flight is none, else None."""
        tick, room = self.clock.tick(touch.t), self.clock.room(touch.t)
        flight = peak = 0.0
        for reaction in touch.contact.reactions:
            force = abs(trial.v[self.program.slots.index[reaction.name]])
            area = abs(self._area(trial, reaction))
            flight = max(flight, 2.0 * area / force)
            peak = max(peak, touch.rebound * area / (2.0 * force))
        ratio = touch.rebound / touch.approach if touch.approach > 0.0 else 0.0
        told = series.limit()
        if flight <= tick:
            return told if told is not None and told.left <= room else Limit(touch.t, None, 0.0)
        left = flight / (1.0 - ratio) if ratio < 1.0 else float("inf")
        if told is not None:
            left = max(left, told.left)
        if left > room or peak > POSITION * series.flight:
            return None
        return told if told is not None else Limit(touch.t + left, None, left)

    def _put_down(
        self,
        touches: Sequence[Touch],
        limit: Limit,
        trial: Trial,
        t: float,
        y: Vector,
        mode: Mode,
        interval: Interval,
    ) -> tuple[float, Vector, Mode, Event]:
        fired = []
        for touch in touches:
            machine, series = touch.contact.machine, self._series[touch.contact.machine.index]
            if machine.law is None:
                self.landed[machine.index] = touch.contact
            own = limit if len(touches) == 1 else series.limit() or limit
            self.trace.accumulations.append(
                Accumulation(
                    own.t,
                    own.ratio,
                    series.count,
                    machine.path,
                    landed=True,
                    state=machine.states[touch.contact.rest],
                )
            )
            fired.append(
                Fired(
                    machine.path,
                    machine.states[mode[machine.index]],
                    machine.states[touch.contact.rest],
                    "impacts accumulate",
                    {"impacts": float(series.count), "t": own.t},
                    {},
                )
            )
            series.restart(limit.t)
        self._held = moved(trial.equations, list(trial.v)) if self.landed else ()
        self._enforce()
        step = self.settler.records.step(trial, y[: self.program.nx], tuple(fired), "continuous")
        # the rest of the rebound is extrapolated away: no floor pulled at it
        step = replace(step, impulses={})
        at_rest = np.concatenate([trial.jump.x, trial.s, y[-2:]])
        resting = trial.mode
        t, here = self._carried(limit.t, t, at_rest, resting, interval)
        nx, ns = self.program.nx, self.program.ns
        x, s = here[:nx], here[nx : nx + ns]
        settled = self.settler.settle(t, x, s, resting, interval, interval)
        if settled.steps:
            step = replace(step, kind="pinnacle")
        self._sync(settled.mode, t)
        event = Event(
            float(t),
            "accumulation",
            (step, *settled.steps),
            y[: nx + ns].copy(),
            np.concatenate([settled.x, settled.s]),
            self.names,
        )
        after = np.concatenate([settled.x, settled.s, here[nx + ns :]])
        return t, after, settled.mode, event

    def _carried(
        self, limit: float, t: float, y: Vector, mode: Mode, interval: Interval
    ) -> tuple[float, Vector]:
        """Carry the state over to the limit, unless something else would happen before it."""
        program = self.program
        if not t < limit < min(interval.end, self.until):
            return t, y
        equations = program.equations(mode, interval, t)
        field, h = program.field(equations, interval), limit - t
        k1 = field(t, y)
        k2 = field(t + 0.5 * h, y + 0.5 * h * k1)
        k3 = field(t + 0.5 * h, y + 0.5 * h * k2)
        there = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + field(limit, y + h * k3))
        if not np.isfinite(there).all():
            return t, y
        watched = watch(self.settler.trials.guards, mode, self.machines)
        locator = Locator(program, self.settler, equations, interval, watched)
        if any(locator.holds(rule, limit, there) for rule in watched.rules):
            return t, y
        return limit, there

    def still(self, y: Vector, equations: ModeEquations) -> Vector:
        """Return a state of the motion without rounding in what landed contacts hold still."""
        if not self.landed:
            return y
        nx = self.program.nx
        before = y[:nx]
        x = still(before, self._held, equations.storage, self.trace.energy)
        return y if x is before else np.concatenate([x, y[nx:]])

    # -- rules in force

    def _sync(self, mode: Mode, t: float) -> None:
        """Forget landings that were left."""
        left = [m for m, c in self.landed.items() if mode[m] != c.state]
        for m in left:
            del self.landed[m]
            self._series[m].restart(t)
        if left:
            self._enforce()

    def use(self, program: Program, settler: Settler) -> None:
        """Go on with the equations and rules of a program, such as those of a sliding motion."""
        if settler is not self.settler:
            self.program, self.settler = program, settler
            self._enforce()

    def _enforce(self) -> None:
        """Put the rules of landed machines in force where settling and locating look for them."""
        settler = self.settler
        machines = list(settler.graph.machines)
        for m in self._in_force.get(id(settler), ()):
            machines[m] = self.graph.machines[m]
        for m, contact in self.landed.items():
            machines[m] = at_rest(self.graph.machines[m], contact, self._series[m].signs)
        self._in_force[id(settler)] = tuple(self.landed)
        settler.graph = replace(settler.graph, machines=tuple(machines))
        self.whole.landed = frozenset(self.landed)
        if self.program is not self.whole:
            # locating in a sliding motion looks there
            self.program.graph = settler.graph

    # -- where time runs out of room

    def stuck(self, t: float) -> bool:
        """Whether events accumulate that nothing was landed for; note it and warn if so."""
        for machine in self.graph.machines:
            series = self._series.get(machine.index)
            if series is not None and series.fell_silent(self.clock):
                limit = series.limit() or Limit(t, None, 0.0)
                why = self._why.get(machine.index, "its rebounds do not vanish")
                self._stop(machine, limit, series.count, f"{machine.path} cannot rest: {why}")
                return True
            times = self._others.get(machine.index, [])
            found = chatter(times, self.clock)
            if found is not None:
                hint = "if the guards chatter, give them a hysteresis"
                self._stop(machine, found, len(times), hint)
                return True
        recent = self.trace.events.times[-CROWD:]
        if len(recent) == CROWD and recent[-1] - recent[0] <= MOMENT * self.clock.until:
            fired = [f.machine for step in self.trace.events[-1].steps for f in step.fired]
            machine = next(m for m in self.graph.machines if not fired or m.path == fired[0])
            hint = "no time passes between them"
            self._stop(machine, Limit(t, None, 0.0), CROWD, hint)
            return True
        return False

    def _stop(self, machine: Machine, limit: Limit, events: int, why: str) -> None:
        record = Accumulation(limit.t, limit.ratio, events, machine.path)
        self.trace.accumulations.append(record)
        shrinking = "" if limit.ratio is None else f", intervals shrinking by {limit.ratio:.6g}"
        self.trace.warn(
            f"events of {machine.path} accumulate at t = {limit.t:.9g} s{shrinking}: the run "
            f"stops there; {why}"
        )
