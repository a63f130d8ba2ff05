"""Whole hybrid runs by dense linear algebra: a second opinion on events.

Written from the meaning of models alone, on top of `dense_oracle`; nothing is shared with the
package. Storages and resistors are linear, so motion in a mode is a matrix exponential, signals
are rows on it, and events are sign changes on a fine grid, bracketed and solved for. Junctions
with laws are decided by trying every combination of branches.

A run of the oracle ends early, with the reason in `Outcome.stop`, where the model has no run
(``cycle``, ``sources``, ``undetermined``) or where rounding could decide (``close``).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from dense_oracle import RCOND, Contradiction, Dense, Net
from scipy.linalg import expm, null_space
from scipy.optimize import brentq, linprog

GRID = 0.01
"""Step of the search for events, s. Natural frequencies of the nets are of order one."""
SHIFT = 1e-11
"""A located instant is this far past the root, where the comparison holds literally."""
EQUAL = 1e-13
"""Margins of comparisons below this are rounding."""
ROUNDING = 1e-9
"""What a located instant leaves of a constraint that holds there."""
CLOSE = 1e-7
"""Other margins below this are not held against the package."""


class Stop(Exception):
    """The run cannot go on; the reason is one of the words of `Outcome.stop`."""


# -- models ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Atom:
    """A comparison: sum of coefficient times signal, `op`, bound.

    A term is (coefficient, name, whether it is ``pre()``).
    """

    terms: tuple[tuple[float, str, bool], ...]
    op: str
    bound: float

    def __str__(self) -> str:
        parts = [
            f"({c!r})*{f'pre({name})' if prior else name}" if c != 1.0 else f"pre({name})" if prior else name
            for c, name, prior in self.terms
        ]
        return f"{' + '.join(parts)} {self.op} {self.bound!r}"


@dataclass(frozen=True)
class Guard:
    """``and``, ``or``, ``not`` of guards, or one ``atom``."""

    word: str
    parts: tuple[Guard, ...] = ()
    atom: Atom | None = None

    def __str__(self) -> str:
        if self.atom is not None:
            return str(self.atom)
        if self.word == "not":
            return f"not ({self.parts[0]})"
        return f" {self.word} ".join(f"({p})" for p in self.parts)

    def atoms(self) -> Iterator[Atom]:
        if self.atom is not None:
            yield self.atom
        for p in self.parts:
            yield from p.atoms()


@dataclass(frozen=True)
class Rule:
    source: str
    target: str
    guard: Guard

    def __str__(self) -> str:
        return f"{self.source} -> {self.target} when {self.guard}"


@dataclass(frozen=True)
class Machine:
    name: str
    states: dict[str, tuple[str, ...]]
    start: str
    rules: tuple[Rule, ...]


@dataclass(frozen=True)
class Law:
    """What a junction obeys: ``diode``, or ``coulomb`` with a limit and a breakaway limit."""

    kind: str
    limit: float = 0.0
    breakaway: float = 0.0

    @property
    def branches(self) -> tuple[str, ...]:
        """Names of the branches; the first carries nothing."""
        return ("blocks", "conducts") if self.kind == "diode" else ("sticks", "forward", "backward")


@dataclass(frozen=True)
class Hybrid:
    """A hybrid model as plain data.

    net: nodes and bonds; machines in order; integrals: signal to (integrand as terms, start);
    prior: source to the factors of its value, terms of ``pre()``; steps: source to (time, change of
    its constant part); laws: junction to law, in the order of `laws`.
    """

    net: Net
    machines: tuple[Machine, ...] = ()
    integrals: dict[str, tuple[tuple[tuple[float, str], ...], float]] = field(default_factory=dict)
    prior: dict[str, tuple[tuple[float, str], ...]] = field(default_factory=dict)
    steps: dict[str, tuple[float, float]] = field(default_factory=dict)
    laws: dict[str, Law] = field(default_factory=dict)
    least_leakage: bool = False


# -- outcomes --------------------------------------------------------------------------------------


@dataclass
class Visit:
    """A mode visited within an event: one line of a record."""

    mode: tuple[str, ...]
    kind: str
    fired: tuple[tuple[str, str, str], ...]
    jump: np.ndarray
    """x+ - x, stored quantities."""
    impulses: np.ndarray
    """Of all bond variables; NaN where they are shares."""
    before: float
    after: float
    supplied: float
    branches: tuple[str, ...] = ()
    several: bool = False

    @property
    def lost(self) -> float:
        return self.before + self.supplied - self.after


@dataclass
class Happening:
    t: float
    before: np.ndarray
    after: np.ndarray
    visits: list[Visit]


@dataclass
class Outcome:
    events: list[Happening]
    stop: str
    """How it ended: ``end``, or why not."""
    t: float
    """Up to where it can be compared."""
    end: np.ndarray | None = None


# -- one mode --------------------------------------------------------------------------------------


class Linear:
    """One mode: its dense equations as matrices on X = [x, integrals, 1, sin, cos, ...].

    `slides` gives the net variable of junctions that obey Coulomb's law and slide.
    """

    def __init__(self, h: Hybrid, net: Net, slides: dict[str, float]) -> None:
        self.h, self.net = h, net
        self.dense = d = _Sliding(net, slides)
        self.names = net.of("C", "I")
        self.n, self.ni = len(self.names), len(h.integrals)
        self.nu = len(d.s)
        self.forced = d.forced
        self.size = self.n + self.ni + 1 + 2 * self.nu
        self.one = self.n + self.ni
        self.undetermined = d.undetermined()

    # inputs as rows on X
    @cached_property
    def u(self) -> np.ndarray:
        rows = np.zeros((self.nu, self.size))
        for j, (a, b, _) in enumerate(self.dense.values):
            rows[j, self.one] = a
            rows[j, self.one + 1 + 2 * j] = b
        return rows

    @cached_property
    def du(self) -> np.ndarray:
        rows = np.zeros((self.nu, self.size))
        for j, (_, b, c) in enumerate(self.dense.values):
            rows[j, self.one + 2 + 2 * j] = b * c
        return rows

    @cached_property
    def z(self) -> np.ndarray:
        rows = np.zeros((self.n, self.size))
        rows[:, : self.n] = np.diag(self.dense.h)
        return rows

    @cached_property
    def w(self) -> np.ndarray:
        """Bond variables as rows on X."""
        d = self.dense
        a = np.vstack([d.m, d.gz @ np.diag(d.h) @ d.y])
        b = np.vstack([np.zeros((len(d.k), self.size)), self.u, self.z, -d.gu @ self.du])
        w = np.linalg.lstsq(a, b, rcond=RCOND)[0]
        return d.least(w, null_space(a, rcond=RCOND))

    @cached_property
    def a(self) -> np.ndarray:
        """X' = a X."""
        a = np.zeros((self.size, self.size))
        a[: self.n] = self.dense.y @ self.w
        for k, (terms, _) in enumerate(self.h.integrals.values()):
            a[self.n + k] = self.row(terms)[0]
        for j, (_, _, c) in enumerate(self.dense.values):
            s = self.one + 1 + 2 * j
            a[s, s + 1], a[s + 1, s] = c, -c
        return a

    @cached_property
    def hop(self) -> np.ndarray:
        return expm(self.a * GRID)

    def bond_row(self, name: str) -> np.ndarray | None:
        """Return a signal as a row on bond variables, None if it is stored or integrated."""
        if name in self.h.integrals:
            return None
        base, _, quantity = name.rpartition(".")
        if quantity in ("q", "p"):
            return None
        r = np.zeros(2 * self.dense.nb)
        ends = self.net.ends(base)
        effort = quantity == "e"
        kind = self.net.nodes[base][0]
        if kind not in ("0", "1") or effort == (kind == "0"):
            r[ends[0][0] + (0 if effort else self.dense.nb)] = 1.0
            return r
        for k, s, _ in ends:
            r[k + (0 if effort else self.dense.nb)] += s
        return r

    def row(self, terms) -> tuple[np.ndarray, np.ndarray]:
        """Return a sum of signals as rows on X and on bond variables (the part of it that has
        impulses)."""
        on_x, on_w = np.zeros(self.size), np.zeros(2 * self.dense.nb)
        for c, name in terms:
            r = self.bond_row(name)
            if r is not None:
                on_w += c * r
            elif name in self.h.integrals:
                on_x[self.n + list(self.h.integrals).index(name)] += c
            else:
                on_x[self.names.index(name.rpartition(".")[0])] += c
        return on_x + on_w @ self.w, on_w

    def loose(self, on_w: np.ndarray) -> bool:
        """Whether the equations leave it open."""
        return bool(np.abs(on_w @ self.undetermined).max(initial=0.0) > 1e-9)

    def state(self, x: np.ndarray, t: float) -> np.ndarray:
        v = [1.0]
        for _, _, c in self.dense.values:
            v += [np.sin(c * t), np.cos(c * t)]
        return np.concatenate([x, v])

    def enter(self, x: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return x+ with integrals, the impulses of bond variables, and whether it is a jump.

        It is none if the state fits but for the shift of a located instant.
        """
        d, n = self.dense, self.n
        none = np.zeros(2 * d.nb)
        if np.abs(d.agree @ u).max(initial=0.0) > 1e-9:
            raise Stop("sources")
        residual = d.gz @ (d.h * x[:n]) + d.gu @ u
        off = np.abs(residual).max(initial=0.0)
        if off <= EQUAL:
            return x, none, False
        if ROUNDING < off <= CLOSE:
            raise Stop("close")
        slope = d.gz @ np.diag(d.h) @ d.d
        nu = -np.linalg.lstsq(slope, residual, rcond=1e-10)[0]
        if np.abs(slope @ nu + residual).max() > 1e-9:
            raise Stop("sources")
        shares = d.right @ null_space(d.d, rcond=RCOND)
        impulses = d.least((d.right @ nu)[:, None], shares)[:, 0]
        self.shares = shares
        after = x.copy()
        after[:n] += d.d @ nu
        for k, (terms, _) in enumerate(self.h.integrals.values()):
            after[n + k] += self.row(terms)[1] @ impulses
        return (after, impulses, True) if off > ROUNDING else (after, none, False)

    def open_impulses(self, on_w: np.ndarray) -> bool:
        shares = getattr(self, "shares", None)
        return shares is not None and bool(np.abs(on_w @ shares).max(initial=0.0) > 1e-9)

    def energy(self, x: np.ndarray) -> float:
        return self.dense.energy(x[: self.n])

    def supplied(self, impulses: np.ndarray, u: np.ndarray, skip) -> float:
        """Impulse times own value, over sources; those of `skip` are impact laws."""
        d, total = self.dense, 0.0
        for name, value in zip(self.net.of("Se", "Sf"), u, strict=False):
            if name in skip:
                continue
            ((b, s, _),) = self.net.ends(name)
            other = b + d.nb if self.net.nodes[name][0] == "Se" else b
            total -= s * value * impulses[other]
        return total


class _Sliding(Dense):
    """Dense equations in which some junctions have a net variable that is given, not zero."""

    def __init__(self, net: Net, slides: dict[str, float]) -> None:
        super().__init__(net)
        self.values = [net.nodes[n][1] for n in net.of("Se", "Sf")]
        self.forced = slides
        if not slides:
            return
        rows = []
        for name, value in slides.items():
            r = np.zeros(2 * self.nb)
            other = self.nb if net.nodes[name][0] == "0" else 0
            for k, s, _ in net.ends(name):
                r[k + other] += s
            # the junction's sum moves from the rows that are zero to those that are given
            same = [i for i, row in enumerate(self.k) if np.array_equal(row, r)]
            self.k = np.delete(self.k, same[0], axis=0)
            rows.append(r)
            self.values.append((value, 0.0, 0.0))
        self.s = np.vstack([self.s, *rows])
        self.m = np.vstack([self.k, self.s, self.z])
        nk, nu = len(self.k), len(self.s)
        left = null_space(self.m.T, rcond=RCOND).T
        self.lu, self.lz = left[:, nk : nk + nu], left[:, nk + nu :]
        u, sv, _ = np.linalg.svd(self.lz)
        r = int((sv > 1e-9).sum())
        self.gu, self.gz = u[:, :r].T @ self.lu, u[:, :r].T @ self.lz
        agree = u[:, r:].T @ self.lu
        self.agree = agree[np.abs(agree).max(axis=1, initial=0.0) > 1e-9]
        self.right = null_space(self.m, rcond=RCOND)
        self.d = self.y @ self.right

    def undetermined(self) -> np.ndarray:
        return null_space(np.vstack([self.m, self.gz @ np.diag(self.h) @ self.y]), rcond=RCOND)

    def least(self, w: np.ndarray, free: np.ndarray) -> np.ndarray:
        """Return columns of `w` with what is free at least leakage: junctions first."""
        if not free.shape[1]:
            return w
        j = self._leaks()
        if len(j):
            u, sv, vt = np.linalg.svd(j @ free)
            r = int((sv > 1e-9).sum())
            w = w - free @ (vt[:r].T @ ((u[:, :r].T @ (j @ w)) / sv[:r, None]))
            free = free @ vt[r:].T
        return w - free @ (free.T @ w)


# -- signals ---------------------------------------------------------------------------------------


@dataclass
class Signals:
    """All signals at one state, perhaps within a jump."""

    mode: Linear
    full: np.ndarray
    impulses: np.ndarray
    jumps: bool
    consistent: bool = True

    def value(self, terms) -> tuple[float, float, bool]:
        """Return impulse, finite part, and whether the equations leave it open."""
        if not self.consistent:
            return self.stored(terms)
        on_x, on_w = self.mode.row(terms)
        loose = self.mode.loose(on_w)
        if self.jumps and self.mode.open_impulses(on_w) and not self.mode.h.least_leakage:
            raise Stop("shares")
        return float(on_w @ self.impulses), float(on_x @ self.full), loose

    def stored(self, terms) -> tuple[float, float, bool]:
        """Return the value where the stored quantities fit no mode: only they tell."""
        mode, total = self.mode, 0.0
        for c, name in terms:
            base, _, quantity = name.rpartition(".")
            if name in mode.h.integrals or quantity in "qp":
                total += c * float(mode.row(((1.0, name),))[0] @ self.full)
                continue
            kind = mode.net.nodes[base][0]
            if (kind, quantity) not in (("C", "e"), ("I", "f")):
                raise Stop("prior without a value")
            ((_, s, _),) = mode.net.ends(base)
            k = mode.names.index(base)
            total += c * mode.dense.h[k] * self.full[k] * (s if kind == "I" else 1.0)
        return 0.0, total, False


def compare(op: str, margin: float, impulse: float, located: bool) -> bool:
    """Return the truth of ``a op b`` from a - b, impulse first."""
    for part, near in ((impulse, False), (margin, located)):
        size = abs(part)
        if size > (CLOSE if not near else EQUAL):
            return (part > 0) == (op[0] == ">")
        if size > EQUAL:
            raise Stop("close")
    return op in (">=", "<=")


def feasible(
    rows: np.ndarray, w: np.ndarray, free: np.ndarray, bounds: np.ndarray | None = None
) -> bool:
    """Whether ``rows (w + free c) + bounds >= 0`` for some c, up to rounding."""
    least = rows @ w + (0.0 if bounds is None else bounds)
    moves = rows @ free
    if not np.abs(moves).max(initial=0.0) > 1e-9:
        return bool((least >= -ROUNDING).all())
    answer = linprog(
        np.zeros(free.shape[1]), A_ub=-moves, b_ub=least + ROUNDING, bounds=(-1e6, 1e6)
    )
    return bool(answer.status == 0)


def lexicographic(mode: Linear, row: np.ndarray, bound: float, full: np.ndarray) -> bool:
    """Whether a quantity is not negative from now on: its value, else its first rate that counts."""
    value = float(row @ full) + bound
    for _ in range(mode.size + 1):
        if abs(value) > CLOSE:
            return value > 0.0
        if abs(value) > ROUNDING:
            raise Stop("close")
        full = mode.a @ full
        value = float(row @ full)
    return True


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
        past = frozenset(s for s, (at, _) in self.h.steps.items() if t > at or (t == at and side > 0))
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
        entered = self.entry(x, states, branches, t, prior)
        seen = []
        initial = not first
        for _ in range(60):
            fired = False
            inner = [states]
            while True:
                mode, after, impulses, jumps, chosen, several = entered
                full = self.full(mode, after, t, prior)
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
                for name, _, target in taken:
                    k = names.index(name)
                    states = (*states[:k], target, *states[k + 1 :])
                if states in inner:
                    raise Stop("cycle")
                inner.append(states)
                entered = self.entry(x, states, branches, t, prior)
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
            prior = Signals(mode, self.full(mode, x, t, prior), np.zeros(2 * mode.dense.nb), False)
            entered = (mode, x, np.zeros(2 * mode.dense.nb), False, chosen, several)
        raise Stop("writes")

    def fire(self, states, t: float, now: Signals, prior: Signals) -> tuple:
        taken = []
        for m, s in zip(self.h.machines, states, strict=True):
            for r in m.rules:
                if r.source != s:
                    continue
                holds = self.truth(r.guard, t, now, prior)
                if holds is None:
                    raise Stop("undetermined")
                if holds:
                    taken.append((m.name, s, r.target))
                    break
        return tuple(taken)

    def entry(self, x, states, branches, t: float, prior: Signals):
        """Return mode, x+, impulses, whether it jumps, branches, whether branches are several."""
        if not self.h.laws:
            mode = self.mode(states, t, 1)
            entered = mode.enter(x, mode.u @ self.full(mode, x, t, prior))
            return mode, *entered, (), False
        found = []
        for tried in product(*(law.branches for law in self.h.laws.values())):
            mode = self.mode(states, t, 1, tried)
            try:
                after, impulses, jumps = mode.enter(x, mode.u @ self.full(mode, x, t, prior))
            except Stop as stop:
                if str(stop) == "sources":
                    continue
                raise
            if jumps and not self.carries(mode, tried, impulses):
                continue
            if not jumps:
                after = x
            still = self.still(after, states, t, prior)
            if still:
                found.append((after, impulses, jumps, still))
        if not found:
            raise Stop("none")
        after, impulses, jumps, still = found[0]
        if any(np.abs(f[0] - after).max(initial=0.0) > ROUNDING for f in found):
            raise Stop("several")
        names = [b for b, _, _ in still]
        several = len(still) > 1 or still[0][2]
        chosen = names.index(branches) if branches in names else 0
        if branches not in names:
            rates = [(m.a @ self.full(m, after, t, prior), m) for b, m, _ in still]
            size = min(len(r) for r, _ in rates)
            for r, m in rates:
                second, first = m.a @ r, rates[0][1].a @ rates[0][0]
                n = m.n
                if np.abs(r[:n] - rates[0][0][:n]).max(initial=0.0) > CLOSE:
                    raise Stop("several")
                if np.abs(second[:n] - first[:n]).max(initial=0.0) > CLOSE:
                    raise Stop("several")
            assert size
        branch, mode, _ = still[chosen]
        # a state that fits but for the shift of the instant is put where it belongs
        after = mode.enter(after, mode.u @ self.full(mode, after, t, prior))[0]
        return mode, after, impulses, jumps, branch, several

    def carries(self, mode: Linear, tried: tuple[str, ...], impulses: np.ndarray) -> bool:
        """Whether the impulses of a jump obey the laws, for some admissible shares."""
        # a limit is finite: friction that holds lets no impulse pass, and none acts where it slides
        rows = np.array([r for r, _ in self.conditions(mode, tried)])
        return feasible(rows.reshape(-1, len(impulses)), impulses, mode.shares)

    def law_row(self, mode: Linear, name: str, branch: str) -> np.ndarray:
        """Return what a branch of a diode says is not negative, on bond variables."""
        common, net = (".f", ".e") if mode.net.nodes[name][0] == "1" else (".e", ".f")
        return mode.bond_row(name + common) if branch == "conducts" else -mode.bond_row(name + net)

    def conditions(self, mode: Linear, branches) -> list[tuple[np.ndarray, float]]:
        """Return (row on bond variables, bound): the row plus the bound is not negative."""
        found = []
        for (name, law), b in zip(self.h.laws.items(), branches, strict=True):
            common, net = (".f", ".e") if mode.net.nodes[name][0] == "1" else (".e", ".f")
            if law.kind == "diode":
                found.append((self.law_row(mode, name, b), 0.0))
            elif b == "sticks":
                r = mode.bond_row(name + net)
                found += [(-r, law.breakaway), (r, law.breakaway)]
            else:
                r = mode.bond_row(name + common)
                found.append((r if b == "forward" else -r, 0.0))
        return found

    def still(self, x, states, t: float, prior: Signals) -> list:
        """Return the branches that hold without a jump: finite values, then rates of all orders.

        A list of (branches, mode, whether a condition is open).
        """
        found = []
        for tried in product(*(law.branches for law in self.h.laws.values())):
            mode = self.mode(states, t, 1, tried)
            try:
                after, _, jumps = mode.enter(x, mode.u @ self.full(mode, x, t, prior))
            except Stop as stop:
                if str(stop) == "sources":
                    continue
                raise
            if jumps:
                continue
            full = self.full(mode, after, t, prior)
            conditions = self.conditions(mode, tried)
            loose = [(r, c) for r, c in conditions if mode.loose(r)]
            if loose:
                w = mode.w @ full
                rows = np.array([r for r, _ in conditions])
                bounds = np.array([c for _, c in conditions])
                if not feasible(rows, w, mode.undetermined, bounds):
                    continue
            if all(
                mode.loose(r) or lexicographic(mode, r @ mode.w, c, full) for r, c in conditions
            ):
                found.append((tried, mode, bool(loose)))
        return found

    # -- motion

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
        for r, c in self.conditions(mode, branches):
            if mode.loose(r):
                continue
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
            elif 0 < k and abs(f[k]) < min(abs(f[k - 1]), abs(f[k + 1])) and f[k - 1] * f[k] > 0 < f[k] * b:
                fine = np.linspace((k - 1) * step, (k + 1) * step, 201)
                g = np.array([at(s) for s in fine])
                if np.abs(g).min() < 1e-7 * (1 + np.abs(g).max()) or (g * f[k] < 0).any():
                    for i in range(200):
                        if g[i] * g[i + 1] < 0:
                            found.append(brentq(at, fine[i], fine[i + 1], xtol=1e-15) + SHIFT)
                    if not (g * f[k] < 0).any():
                        raise Stop("close")
        return found
