"""Whole hybrid runs by dense linear algebra: a second opinion on events.

Written from the meaning of models alone, on top of `dense_oracle`; nothing is shared with the
package. Storages and resistors are linear, so motion in a mode is a matrix exponential, signals
are rows on it, and events are sign changes on a fine grid, bracketed and solved for. Junctions
with laws are decided by trying every combination of branches.

A run of the oracle ends early, with the reason in `Outcome.stop`, where the model has no run
(``cycle``, ``sources``, ``undetermined``) or where rounding could decide (``close``).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from dense_laws import conditions, entry
from dense_modes import CLOSE, EQUAL, GRID, SHIFT, Linear, Signals, Stop
from dense_oracle import Contradiction
from hybrid_models import Atom, Guard, Happening, Hybrid, Outcome, Visit
from scipy.linalg import expm
from scipy.optimize import brentq

UNSOLVED = ("none", "sources")
"""Why a mode has no solution."""


def compare(op: str, margin: float, impulse: float, located: bool) -> bool:
    """Return the truth of ``a op b`` from a - b, impulse first."""
    for part, near in ((impulse, False), (margin, located)):
        size = abs(part)
        if size > (CLOSE if not near else EQUAL):
            return (part > 0) == (op[0] == ">")
        if size > EQUAL:
            raise Stop("close")
    return op in (">=", "<=")


def passed(states: tuple[str, ...], fired: tuple, x: np.ndarray) -> Visit:
    """Return the visit of a mode without a solution, of which nothing is known."""
    return Visit(states, "mythical", fired, 0.0 * x, np.zeros(0), 0.0, 0.0, 0.0)


class Run:
    """The oracle's simulation of a hybrid model."""

    def __init__(self, h: Hybrid, until: float) -> None:
        self.h, self.until = h, until
        self.modes: dict[object, Linear] = {}
        self.located = False
        self.names = h.net.of("C", "I")
        self.sources = h.net.of("Se", "Sf")
        self.times = sorted(
            {t for t, _ in h.steps.values()}
            | {
                a.bound
                for m in h.machines
                for r in m.rules
                for a in r.guard.atoms()
                if a.terms[0][1] == "time"
            }
        )

    # -- modes

    def mode(
        self, states: tuple[str, ...], t: float, side: int, branches: tuple[str, ...] = ()
    ) -> Linear:
        """Return the equations of a mode, with inputs as they are on one side of an instant."""
        past = frozenset(
            s for s, (at, _) in self.h.steps.items() if t > at or (t == at and side > 0)
        )
        key = (states, past, branches)
        if key not in self.modes:
            on = set()
            for m, s in zip(self.h.machines, states, strict=True):
                on |= set(m.states[s])
            slides = {}
            for (name, law), b in zip(self.h.laws.items(), branches, strict=True):
                if b in ("conducts", "forward", "backward"):
                    on.add(name)
                if b in ("forward", "backward"):
                    slides[name] = law.limit if b == "forward" else -law.limit
            nodes = dict(self.h.net.nodes)
            for s in past:
                kind, (a, b, c) = nodes[s]
                nodes[s] = (kind, (a + self.h.steps[s][1], b, c))
            self.modes[key] = Linear(self.h, replace(self.h.net, nodes=nodes, on=on), slides)
        return self.modes[key]

    def full(self, mode: Linear, x: np.ndarray, t: float, prior: Signals) -> np.ndarray:
        """Return the state with time's signals; sources that read ``pre()`` are set from it."""
        full = mode.state(x, t)
        for name, terms in self.h.prior.items():
            j = self.sources.index(name)
            full[mode.one + 1 + 2 * j] = sum(prior.value(((c, n),))[1] for c, n in terms)
        return full

    # -- guards

    def truth(self, guard: Guard, t: float, now: Signals, prior: Signals) -> bool | None:
        """Return whether a guard holds; None if that is left open."""
        if guard.atom is not None:
            a = guard.atom
            if a.terms[0][1] == "time":
                return t >= a.bound if a.op == ">=" else t < a.bound
            impulse, margin, loose = 0.0, -a.bound, False
            for c, name, is_prior in a.terms:
                i, f, open_ = (prior if is_prior else now).value(((c, name),))
                impulse += 0.0 if is_prior else i
                margin += f
                loose |= open_
            if loose and self.h.laws:
                raise Stop("open beside laws")  # laws bound what the equations leave open
            if loose and not self.h.least_leakage:
                return None
            return compare(a.op, margin, impulse, self.located)
        parts = [self.truth(p, t, now, prior) for p in guard.parts]
        if guard.word == "not":
            return None if parts[0] is None else not parts[0]
        decisive = guard.word == "or"
        if decisive in parts:
            return decisive
        return None if None in parts else not decisive

    # -- settling

    def settle(self, x, states, branches, t: float, first: bool) -> tuple:
        """Return x, mode, branches and the visits of one instant."""
        visits: list[Visit] = []
        old = self.mode(states, t, -1 if not first else 1, branches)
        full = old.state(x, t)
        residual = old.dense.gz @ (old.dense.h * x[: old.n]) + old.dense.gu @ (old.u @ full)
        prior = Signals(
            old,
            full,
            np.zeros(2 * old.dense.nb),
            False,
            consistent=not (first and np.abs(residual).max(initial=0.0) > 1e-10),
        )
        names = [m.name for m in self.h.machines]
        fired_now: tuple = ()
        entered = entry(self, x, states, branches, t, prior)
        seen = []
        initial, kept = not first, None
        for _ in range(60):
            fired = False
            inner = [states]
            while True:
                mode, after, impulses, jumps, chosen, several = entered
                # a law of pre() holds what it was when its mode was entered, until that is left
                full = self.full(mode, after, t, prior) if kept is None else kept
                kept = None
                now = Signals(mode, full, impulses, jumps)
                taken = self.fire(states, t, now, prior)
                visit = Visit(
                    states,
                    "continuous",
                    fired_now,
                    (after - x)[: mode.n],
                    impulses,
                    mode.energy(x),
                    mode.energy(after),
                    mode.supplied(impulses, mode.u @ full, self.h.prior),
                    chosen,
                    several,
                )
                if not taken:
                    break
                if not fired and visits and visits[-1].kind == "written":
                    visits[-1].kind = "pinnacle"
                elif not initial:
                    visit.kind = "mythical"
                    visits.append(visit)
                initial = False
                fired = True
                fired_now = taken
                entered = None
                while entered is None:
                    for name, _, target in taken:
                        k = names.index(name)
                        states = (*states[:k], target, *states[k + 1 :])
                    if states in inner:
                        raise Stop("cycle")
                    inner.append(states)
                    try:
                        entered = entry(self, x, states, branches, t, prior)
                    except (Contradiction, Stop) as refused:
                        taken = self.leave(states, t, prior)
                        other = isinstance(refused, Stop) and str(refused) not in UNSOLVED
                        if other or not taken:
                            raise
                        visits.append(passed(states, fired_now, x))
                        fired_now = taken
            if not fired and not jumps:
                if visits:
                    visits[-1].kind = "continuous"
                else:
                    visits.append(visit)
                return after, states, chosen, visits
            visit.kind = "written"
            visits.append(visit)
            initial = False
            fired_now = ()
            branches = chosen
            if any(s == states and np.abs(y - after).max(initial=0.0) < 1e-12 for s, y in seen):
                raise Stop("cycle")
            seen.append((states, after))
            x = after
            prior = Signals(mode, full, np.zeros(2 * mode.dense.nb), False)
            kept = full
            entered = (mode, x, np.zeros(2 * mode.dense.nb), False, chosen, several)
        raise Stop("writes")

    def fire(self, states, t: float, now: Signals, prior: Signals) -> tuple:
        """Return (machine, source, target) of each machine's first enabled transition."""
        taken = []
        for m, s in zip(self.h.machines, states, strict=True):
            rules = [r for r in m.rules if r.source == s]
            holds = [self.truth(r.guard, t, now, prior) for r in rules]
            if None in holds:
                raise Stop("undetermined")
            if True in holds:
                taken.append((m.name, s, rules[holds.index(True)].target))
        return tuple(taken)

    def leave(self, states, t: float, prior: Signals) -> tuple:
        """Return what machines do in a mode without a solution: rules that ask for no value of it.

        A machine that would have to ask one that does, before one that holds, stays.
        """
        taken = []
        for m, s in zip(self.h.machines, states, strict=True):
            for r in (r for r in m.rules if r.source == s):
                terms = [term for a in r.guard.atoms() for term in a.terms]
                if not all(name == "time" or is_prior for _, name, is_prior in terms):
                    break
                if self.truth(r.guard, t, prior, prior):
                    taken.append((m.name, s, r.target))
                    break
        return tuple(taken)

    def run(self) -> Outcome:
        h = self.h
        x = np.concatenate([h.net.x0(), [s for _, s in h.integrals.values()]])
        states = tuple(m.start for m in h.machines)
        branches = tuple(law.branches[0] for law in h.laws.values())
        t = 0.0
        events: list[Happening] = []
        before = x
        first = True
        while True:
            held = branches
            try:
                x, states, branches, visits = self.settle(x, states, branches, t, first)
            except Stop as stop:
                return Outcome(events, str(stop), t)
            except Contradiction:
                return Outcome(events, "sources", t)
            moved = len(visits) > 1 or visits[0].fired or visits[0].impulses.any()
            if first or moved or branches != held:
                events.append(Happening(t, before, x, visits))
            if len(events) > 60:
                return Outcome(events, "many", t)
            first = False
            try:
                t_next, x, found = self.advance(x, states, branches, t)
            except Stop as stop:
                return Outcome(events, str(stop), t)
            if not found and t_next >= self.until:
                return Outcome(events, "end", t_next, x)
            if t_next - t < 1e-5 and t_next not in self.times:
                return Outcome(events, "close", t)
            t, before = t_next, x

    def advance(self, x, states, branches, t: float) -> tuple[float, np.ndarray, bool]:
        """Return the next instant, the state there, and whether something was located."""
        mode = self.mode(states, t, 1, branches)
        stop = min([s for s in self.times if s > t], default=self.until)
        stop = min(stop, self.until)
        count = max(int(np.ceil((stop - t) / GRID)), 1)
        step = (stop - t) / count
        hop = expm(mode.a * step)
        points = [mode.state(x, t)]
        for _ in range(count):
            points.append(hop @ points[-1])
        path = np.array(points)
        rules = [
            r
            for m, s in zip(self.h.machines, states, strict=True)
            for r in m.rules
            if r.source == s
        ]
        atoms = [a for r in rules for a in r.guard.atoms() if a.terms[0][1] != "time"]
        rows = [self.margin_row(mode, a) for a in atoms]
        rows += self.law_rows(mode, branches)
        roots: list[float] = []
        for row in rows:
            if row is not None:
                roots += self.roots(mode, row, path, step)
        for tau in sorted(roots):
            if tau > stop - t - 1e-9:
                break
            full = expm(mode.a * tau) @ points[0]
            here = full[: mode.one]
            if self.wants(mode, rules, branches, t + tau, full):
                if tau < CLOSE:
                    raise Stop("close")
                return t + tau, here, True
        self.located = False
        return stop, path[-1][: mode.one], stop < self.until or stop in self.times

    def margin_row(self, mode: Linear, a: Atom) -> np.ndarray | None:
        on_x, on_w = mode.row([(c, name) for c, name, _ in a.terms])
        if mode.loose(on_w) and not self.h.least_leakage:
            return None
        on_x = on_x.copy()
        on_x[mode.one] -= a.bound
        return on_x

    def law_rows(self, mode: Linear, branches) -> list[np.ndarray]:
        rows = []
        for r, c in conditions(self, mode, branches):
            if mode.loose(r):
                raise Stop("open beside laws")  # when it ends is not looked into here
            row = r @ mode.w
            row[mode.one] += c
            rows.append(row)
        return rows

    def wants(self, mode, rules, branches, t: float, full) -> bool:
        """Whether a rule holds, a little past a root."""
        self.located = True
        now = Signals(mode, full, np.zeros(2 * mode.dense.nb), False)
        if any(row @ full < -EQUAL for row in self.law_rows(mode, branches)):
            return True
        return any(self.truth(r.guard, t, now, now) for r in rules)

    def roots(self, mode, row, path, step) -> list[float]:
        """Return times just past the sign changes of a row, touches as close calls."""
        f = path @ row
        if np.abs(f).max() < 1e-10:
            return []
        found = []

        def at(tau: float) -> float:
            k = int(tau / step)
            return float(row @ expm(mode.a * (tau - k * step)) @ path[k])

        start = f[0]
        for k in range(len(f) - 1):
            a, b = (start if k == 0 else f[k]), f[k + 1]
            if k == 0 and abs(a) < 1e-9:
                # it starts on the surface: what counts is where it goes
                a = at(1e-6)
                if abs(a) < 1e-12:
                    continue
                if a * b > 0:
                    found.append(1e-8)
                    continue
            if a * b < 0:
                low = k * step if k or abs(start) >= 1e-9 else 1e-6
                found.append(brentq(at, low, (k + 1) * step, xtol=1e-15, rtol=1e-15) + SHIFT)
            elif (
                k > 0
                and abs(f[k]) < min(abs(f[k - 1]), abs(f[k + 1]))
                and f[k - 1] * f[k] > 0 < f[k] * b
            ):
                fine = np.linspace((k - 1) * step, (k + 1) * step, 201)
                g = np.array([at(s) for s in fine])
                if np.abs(g).min() < 1e-7 * (1 + np.abs(g).max()) or (g * f[k] < 0).any():
                    for i in range(200):
                        if g[i] * g[i + 1] < 0:
                            found.append(brentq(at, fine[i], fine[i + 1], xtol=1e-15) + SHIFT)
                    if not (g * f[k] < 0).any():
                        raise Stop("close")
        return found
