"""Mode selection at one instant: mythical modes, pinnacles, divergence of time.

The algorithm (Mosterman & Biswas 2002, eq. 18 and Algorithms 2 and 3; steps marked * are ours)::

    settle(x, mode, u-, u+):             # inputs at the left and right limits of the instant
      pre <- all signals at (x, mode, u-)          # frozen until x is written; at the start u- = u+
      x+ <- g_mode(x; pre, u+)           # * is x, bit for bit, if x is consistent: covers an
                                         #   inconsistent start, and a source step onto a storage
      repeat                             # outer loop, real modes: they write the state
        fired <- no
        repeat                           # inner loop, mythical modes: they do not
          s+ <- signals in mode at (x+, u+): impulses from x+ - x, finite parts right limits *
          T  <- the first enabled transition of each machine under (pre, s+)
          if T is empty: leave the inner loop
          mode <- T(mode);  x+ <- g_mode(x; pre, u+);  fired <- yes    # ALWAYS from the same x
        if not fired and x+ = x: return x, mode
        x <- x+;  pre <- the signals that have a value at (x, mode, u+)     # g is not applied again

A mode left in the inner loop is *mythical*; one that was written and then left is a *pinnacle*;
the last is *continuous*. All machines fire together. If the same ``(mode, x, x+, pre)`` returns at
one instant, nothing can ever change: time cannot advance, and the loop is reported as a cycle.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.leakage import undetermined
from hybond.errors import DivergenceOfTime, HybondError, ModelError, NumericsError
from hybond.model.expressions import names
from hybond.model.graph import FlatGraph, Machine, Mode, Rule, one_instant
from hybond.model.interval import Interval
from hybond.modes.dirac import Pairs
from hybond.modes.record import Recorder
from hybond.modes.trial import Trial, Trials
from hybond.programs.program import Program
from hybond.trace import Cause, Event, Fired, Step, Trace

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Settled:
    """Where an instant ends: the state and mode that time goes on from."""

    x: Vector
    s: Vector
    mode: Mode
    steps: tuple[Step, ...]


class Settler:
    """Settles modes for one program.

    Parameters
    ----------
    program : Program
    trace : Trace
        Takes the warnings.
    max_writes : int
        State writes at one instant after which the run stops.
    """

    def __init__(self, program: Program, trace: Trace, *, max_writes: int = 1000) -> None:
        self.program = program
        self.graph: FlatGraph = program.graph
        self.trace = trace
        self.max_writes = max_writes
        self.trials = Trials(program, trace)
        self.records = Recorder(program, self.trials.guards)
        self._offset = program.slots.size

    # -- the algorithm

    def settle(
        self,
        t: float,
        x: Vector,
        s: Vector,
        mode: Mode,
        before: Interval,
        after: Interval,
        *,
        start: bool = False,
        held: Vector | None = None,
    ) -> Settled:
        """Return the state and mode in which time goes on from `t`.

        `held` are the integrated signals with those set that are sampled at `t`.

        Raises
        ------
        DivergenceOfTime
            HB-N401, with the cycle.
        NumericsError
            HB-N402 after `max_writes` writes, HB-N403 if the last mode is fieldless.
        ModelError
            HB-J101 arithmetic on impulses without meaning, HB-J102 a guard on an undetermined
            signal.
        """
        steps: list[Step] = []
        pre = self.trials.a_priori(t, x, s, mode, before)
        s = s if held is None else held
        trial = self.trials.enter(t, x, s, mode, after, pre, jump=True)
        entered = self.by_law(mode, trial)
        seen: dict[tuple[object, ...], int] = {}
        history: list[tuple[Mode, tuple[Fired, ...]]] = []
        written = -1  # index in steps of the last written mode
        writes = 0
        while True:
            fired_any = False
            while True:
                fired, target = self._enabled(trial, t)
                self._look_for_cycle(t, x, s, trial, pre, seen, history, entered)
                if not fired:
                    break
                if fired_any or entered or trial.jump.happened or (start and not steps):
                    steps.append(self.records.step(trial, x, entered, "mythical"))
                elif written >= 0:
                    steps[written] = replace(steps[written], kind="pinnacle")
                trial = self.trials.enter(t, x, s, target, after, pre, jump=True)
                entered, fired_any = fired + self.by_law(target, trial), True
            moved = trial.jump.happened
            kept = np.array_equal(trial.s, s)  # planar friction may slip on in a new direction
            if not fired_any and not moved and trial.mode == mode and kept:
                x = trial.jump.x if trial.dusted else x
                break
            writes += 1
            if writes > self.max_writes:
                raise self._collapse(t, trial)
            if written >= 0:
                steps[written] = replace(steps[written], kind="pinnacle")
            steps += self.records.written(trial, x, entered, self.by_law)
            written = len(steps) - 1
            entered = ()
            x, s, mode = trial.jump.x, trial.s, trial.mode
            # what junction laws strike next; a declared impact law must not act on its own result
            again = bool(self.trials.laws.laws) and not self.program.fieldless(mode)
            trial = self.trials.enter(t, x, s, mode, after, pre, jump=False, stay=True)
            pre = trial.v[: self._offset]
            trial = self.trials.enter(t, x, s, mode, after, pre, jump=again, stay=True)
            entered = self.by_law(mode, trial)
        if self.program.fieldless(trial.mode):
            raise self._ends_fieldless(t, trial.mode)
        if not steps and start:
            steps.append(self.records.step(trial, x, (), "continuous"))
        self.note_open(trial.mode, trial.undetermined)
        return Settled(x, s, trial.mode, tuple(steps))

    def note_open(self, mode: Mode, undetermined: Collection[str]) -> None:
        """Warn of what the equations of a mode, in which time goes on, leave open."""
        if undetermined:
            self.trace.warn(
                f"in mode ({self.text(mode)}) the equations leave "
                f"{', '.join(undetermined)} open; least leakage decides"
            )

    def by_law(self, mode: Mode, trial: Trial, to: Mode | None = None) -> tuple[Fired, ...]:
        """Return the records of the laws whose branches changed from `mode` to that of `trial`."""
        to = to or trial.mode
        fired = []
        for index in self.trials.laws.laws:
            if mode[index] != to[index]:
                machine = self.graph.machines[index]
                fired.append(self.records.branch(machine, mode[index], to[index], trial.pairs))
        return tuple(fired)

    # -- transitions

    def holds(self, rule: Rule, pairs: Pairs, where: str = "") -> bool:
        """Return the truth of a guard, with the place added to a refusal."""
        return self.trials.guards.holds(rule, pairs, where)

    def _enabled(self, trial: Trial, t: float) -> tuple[tuple[Fired, ...], Mode]:
        target = list(trial.mode)
        fired: list[Fired] = []
        for machine in self.graph.machines:
            if machine.law is not None:
                continue
            chosen: Rule | None = None
            others: list[str] = []
            for rule in machine.rules:
                if rule.source != trial.mode[machine.index]:
                    continue
                if trial.freedom.shape[1]:
                    self._refuse_indeterminate(rule, machine, trial, t)
                where = f"{machine.path} at t = {t:.9g} s"
                if self.holds(rule, trial.pairs, where):
                    if chosen is None:
                        chosen = rule
                    else:
                        others.append(rule.text)
            if chosen is not None:
                target[machine.index] = chosen.target
                fired.append(self.records.fired(machine, chosen, trial.pairs, tuple(others)))
        return tuple(fired), tuple(target)

    def _refuse_indeterminate(self, rule: Rule, machine: Machine, trial: Trial, t: float) -> None:
        """Refuse a guard whose truth depends on what the equations leave open."""
        slots = self.program.slots
        guard = self.program.compile(rule.guard)
        if any(trial.pairs.impulse[slots.w]):
            return
        reach = 1e3 * max(1.0, max((abs(a) for a in trial.v[slots.w]), default=1.0))
        base = np.array(trial.v[slots.w])
        truths = set()
        for direction in trial.freedom.T:
            for k in (-reach, 0.0, reach):
                v = list(trial.v)
                v[slots.w] = (base + k * direction).tolist()
                truths.add(bool(guard(v)))
        if len(truths) < 2:
            return
        bonds = len(self.graph.bonds)
        free = {f"{'e' if k < bonds else 'f'}:{k % bonds}" for k in undetermined(trial.freedom)}
        open_ones = [text for text, e in rule.reads if names(e) & free]
        text = (
            f"the guard {rule.text!r} reads {', '.join(open_ones)}, which the equations leave open "
            f"in mode ({self.text(trial.mode)})"
        )
        if self.graph.indeterminate == "least leakage":
            self.trace.warn(f"{text}; least leakage decides, as the model asks")
            return
        raise ModelError(
            text,
            code="HB-J102",
            where=f"{machine.path} at t = {t:.9g} s",
            hint='add a resistor that decides it, or set indeterminate = "least leakage"',
        )

    # -- refusals

    def _look_for_cycle(
        self,
        t: float,
        x: Vector,
        s: Vector,
        trial: Trial,
        pre: list[float],
        seen: dict[tuple[object, ...], int],
        history: list[tuple[Mode, tuple[Fired, ...]]],
        entered: tuple[Fired, ...],
    ) -> None:
        key = (
            trial.mode,
            x.tobytes(),
            trial.jump.x.tobytes(),
            s.tobytes(),
            trial.s.tobytes(),
            trial.jump.happened,
            tuple(pre),
        )
        history.append((trial.mode, entered))
        if key not in seen:
            seen[key] = len(history) - 1
            return
        cycle = history[seen[key] :]
        focus = {f.machine for _, fired in cycle for f in fired}
        lines = []
        for mode, fired in cycle:
            why = "; ".join(_fired_text(f) for f in fired)
            lines.append(f"({self.text(mode, focus)})" + (f" by {why}" if why else ""))
        raise DivergenceOfTime(
            f"time cannot advance at t = {t:.9g} s: the modes "
            + " -> ".join(lines)
            + " follow each other without end",
            code="HB-N401",
            where=self.text(trial.mode, focus),
            hint="make the guards of the cycle exclude each other for this state, for instance "
            "with a threshold on pre() of a stored quantity",
        )

    def _collapse(self, t: float, trial: Trial) -> HybondError:
        return NumericsError(
            f"{self.max_writes} state writes at t = {t:.9g} s and still no mode to stay in",
            code="HB-N402",
            where=self.text(trial.mode),
            hint="an inelastic collapse: make the contact plastic below a speed",
        )

    def _ends_fieldless(self, t: float, mode: Mode) -> HybondError:
        return NumericsError(
            f"the mode ({self.text(mode)}) holds at an instant only (one of its laws reads pre()) "
            f"but no guard leaves it at t = {t:.9g} s",
            code="HB-N403",
            where=self.text(mode),
            hint="its exit must be true for the state that the jump wrote, such as "
            "pre(a.f) <= pre(b.f) after an impact",
        )

    def text(self, mode: Mode, focus: Collection[str] = ()) -> str:
        """Return a mode as written in tables and messages."""
        return self.graph.mode_text(mode, focus)


def _fired_text(fired: Fired) -> str:
    values = ", ".join(
        f"{k} = {fired.impulses[k]:.6g} δ" if k in fired.impulses else f"{k} = {a:.6g}"
        for k, a in fired.values.items()
    )
    return f"{fired.machine}: {fired.guard}" + (f" [{values}]" if values else "")


def cause_at(graph: FlatGraph, t: float) -> Cause:
    """Return what a timed event is due to."""
    if any(one_instant(s, t) for w in graph.watches for s in w.times):
        return "time"
    return "sample" if any(s.due(t) for s in graph.samples) else "input"


def event_of(t: float, cause: str, settled: Settled, x: Vector, s: Vector) -> Event:
    """Return the record of a settled instant."""
    return Event(
        float(t),
        cause,  # type: ignore[arg-type]
        settled.steps,
        np.concatenate([x, s]),
        np.concatenate([settled.x, settled.s]),
    )
