"""A second engine for tests: dense linear algebra on all bond variables of a random bond graph.

It shares nothing with the package. Notation: w = all efforts then all flows. The rows

    [K; S; Z] w = [0; u; z],   z = H x,   x' = Y w

are junctions, two-ports and linear resistors (K), sources (S) and storages (Z). Left null vectors
of the matrix are the constraints on what is stored; right null vectors are the impulses that the
structure lets through. Everything else follows by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import expm, null_space

import hybond as hb

RCOND = 1e-10


@dataclass
class Net:
    """A bond graph as plain data.

    nodes: name -> (kind, value); bonds: (tail, head) with ports as ``"g.1"``; on: the controlled
    junctions that are ON; controlled: all of them; start: stored quantity of each storage.
    A source's value is (constant, amplitude, frequency): a + b sin(c t).
    """

    nodes: dict[str, tuple[str, object]]
    bonds: list[tuple[str, str]]
    controlled: list[str] = field(default_factory=list)
    on: set[str] = field(default_factory=set)
    later: set[str] | None = None
    """ON from t = 1 s, if the mode switches."""
    start: dict[str, float] = field(default_factory=dict)

    # -- as a model of the package

    def model(self, seed: int | None = None) -> hb.Model:
        """Return the model; with a seed, elements and bonds in another order."""
        m = hb.Model("net")
        names, bonds = list(self.nodes), list(self.bonds)
        if seed is not None:
            rng = np.random.default_rng(seed)
            names = [names[k] for k in rng.permutation(len(names))]
            bonds = [bonds[k] for k in rng.permutation(len(bonds))]
        for name in names:
            kind, value = self.nodes[name]
            m.add(**{name: self._part(name, kind, value)})
        m.bond(*(f"{a} -> {b}" for a, b in bonds))
        if self.controlled:
            first = [n for n in self.controlled if n in self.on]
            states = {"first": first, "all": list(self.controlled)}
            rules = []
            if self.later is not None:
                states["later"] = [n for n in self.controlled if n in self.later]
                rules = ["first -> later when time >= 1"]
            m.machine("mode", states=states, start="first", rules=rules)
        return m

    def _part(self, name: str, kind: str, value):
        match kind:
            case "0":
                return hb.Zero()
            case "1":
                return hb.One()
            case "C":
                return hb.C(_law(value, "e", "q"), q=self.start.get(name, 0.0))
            case "I":
                return hb.I(_law(value, "f", "p"), p=self.start.get(name, 0.0))
            case "R":
                return hb.R(_law(value, "e", "f"))
            case "G":
                return hb.G(value) if not isinstance(value, tuple) else hb.R(_law(value, "f", "e"))
            case "TF":
                return hb.TF(value)
            case "GY":
                return hb.GY(value)
        a, b, c = value
        text = repr(a) if b == 0.0 else f"{a!r} + ({b!r})*sin({c!r}*time)"
        return hb.Se(text) if kind == "Se" else hb.Sf(text)

    def after(self) -> Net:
        """Return the net in its second mode."""
        assert self.later is not None
        return replace(self, on=self.later, later=None)

    # -- lists in a fixed order

    def ends(self, name: str) -> list[tuple[int, float, str]]:
        """Return (bond, +1 if it points at the node, port) of each bond at a node."""
        found = []
        for k, (tail, head) in enumerate(self.bonds):
            for end, sign in ((tail, -1.0), (head, 1.0)):
                base, _, port = end.partition(".")
                if base == name:
                    found.append((k, sign, port))
        return found

    def of(self, *kinds: str) -> list[str]:
        return [n for n, (kind, _) in self.nodes.items() if kind in kinds]

    def u(self, t: float) -> np.ndarray:
        values = [self.nodes[n][1] for n in self.of("Se", "Sf")]
        return np.array([a + b * np.sin(c * t) for a, b, c in values])

    def du(self, t: float) -> np.ndarray:
        values = [self.nodes[n][1] for n in self.of("Se", "Sf")]
        return np.array([b * c * np.cos(c * t) for _, b, c in values])

    def x0(self) -> np.ndarray:
        return np.array([self.start.get(n, 0.0) for n in self.of("C", "I")])


def _law(value, output: str, argument: str):
    if not isinstance(value, tuple):
        return value
    a, b = value  # output = a * argument + b * argument^3, as a coefficient of its own
    return {output: f"{a!r}*{argument} + {b!r}*{argument}^3"}


class Contradiction(Exception):
    """Sources that prescribe one variable differently."""


class Dense:
    """The dense equations of one mode of a `Net`."""

    def __init__(self, net: Net) -> None:
        self.net = net
        nb = self.nb = len(net.bonds)
        rows: list[np.ndarray] = []
        self.laws: list[tuple[np.ndarray, np.ndarray, float, float]] = []

        def row(*terms: tuple[int, float]) -> np.ndarray:
            r = np.zeros(2 * nb)
            for k, c in terms:
                r[k] += c
            return r

        for name, (kind, value) in net.nodes.items():
            ends = net.ends(name)
            if kind in ("0", "1"):
                same, other = (0, nb) if kind == "0" else (nb, 0)
                if name in net.controlled and name not in net.on:
                    rows += [row((same + k, 1.0)) for k, _, _ in ends]
                elif ends:
                    first = ends[0][0]
                    rows += [row((same + k, 1.0), (same + first, -1.0)) for k, _, _ in ends[1:]]
                    rows.append(row(*((other + k, s) for k, s, _ in ends)))
            elif kind in ("TF", "GY"):
                (b1, s1, _), (b2, s2, _) = sorted(ends, key=lambda e: e[2])
                f1, f2 = (nb + b1, s1), (nb + b2, -s2)
                if kind == "TF":
                    rows.append(row((b1, 1.0), (b2, -value)))
                    rows.append(row(f2, (f1[0], -value * f1[1])))
                else:
                    rows.append(row((b1, 1.0), (f2[0], -value * f2[1])))
                    rows.append(row((b2, 1.0), (f1[0], -value * f1[1])))
            elif kind in ("R", "G"):
                ((b, s, _),) = ends
                e, f = row((b, 1.0)), row((nb + b, s))
                out, arg = (e, f) if kind == "R" else (f, e)
                if isinstance(value, tuple):
                    self.laws.append((out, arg, *value))
                else:
                    rows.append(out - value * arg)
        self.k = np.array(rows).reshape(len(rows), 2 * nb)
        self.s = np.array(
            [
                row((net.ends(n)[0][0] + (0 if net.nodes[n][0] == "Se" else nb), 1.0))
                for n in net.of("Se", "Sf")
            ]
        ).reshape(-1, 2 * nb)
        z, y, h = [], [], []
        self.cubic = []
        for n in net.of("C", "I"):
            ((b, s, _),) = net.ends(n)
            kind, value = net.nodes[n]
            e, f = row((b, 1.0)), row((nb + b, s))
            z.append(e if kind == "C" else f)
            y.append(f if kind == "C" else e)
            h.append(value[0] if isinstance(value, tuple) else 1.0 / value)
            self.cubic.append(value[1] if isinstance(value, tuple) else 0.0)
        self.z = np.array(z).reshape(-1, 2 * nb)
        self.y = np.array(y).reshape(-1, 2 * nb)
        self.h = np.array(h)
        self.cubic = np.array(self.cubic)
        self.m = np.vstack([self.k, self.s, self.z])
        nk, nu = len(self.k), len(self.s)
        left = null_space(self.m.T, rcond=RCOND).T
        self.lu, self.lz = left[:, nk : nk + nu], left[:, nk + nu :]
        # rows without storage are agreements among sources alone; the cut is absolute, for the
        # rows of `left` are orthonormal
        u, sv, _ = np.linalg.svd(self.lz)
        r = int((sv > 1e-9).sum())
        self.gu, self.gz = u[:, :r].T @ self.lu, u[:, :r].T @ self.lz
        agree = u[:, r:].T @ self.lu
        self.agree = agree[np.abs(agree).max(axis=1, initial=0.0) > 1e-9]
        self.right = null_space(
            np.vstack([self.m, *(r[None] for p in self.laws for r in p[:2])]), rcond=RCOND
        )
        self.d = self.y @ self.right

    # -- storage

    def co(self, x: np.ndarray) -> np.ndarray:
        return self.h * x + self.cubic * x**3

    def hess(self, x: np.ndarray) -> np.ndarray:
        return np.diag(self.h + 3 * self.cubic * x**2)

    def energy(self, x: np.ndarray) -> float:
        return float(np.sum(0.5 * self.h * x**2 + 0.25 * self.cubic * x**4))

    # -- jump

    def check(self, t: float = 0.0) -> None:
        for at in (t, t + 0.123):
            if np.abs(self.agree @ self.net.u(at)).max(initial=0.0) > 1e-9:
                raise Contradiction

    def enter(self, x: np.ndarray, t: float) -> np.ndarray:
        """Return x+ by Newton on the areas nu, x+ = x + D nu, G z(x+) + Gu u = 0."""
        if not self.gz.shape[0]:
            return x
        nu = np.zeros(self.d.shape[1])
        target = self.gu @ self.net.u(t)
        for _ in range(60):
            here = x + self.d @ nu
            residual = self.gz @ self.co(here) + target
            slope = self.gz @ self.hess(here) @ self.d
            step = np.linalg.lstsq(slope, residual, rcond=1e-11)[0]
            nu = nu - step
            if np.abs(self.d @ step).max(initial=0.0) <= 1e-15 * (1 + np.abs(here).max(initial=0)):
                break
        return x + self.d @ nu

    def work(self, x: np.ndarray, after: np.ndarray, t: float) -> float:
        """Return what the sources supplied in the jump: impulse times own value."""
        if not len(self.s):
            return 0.0
        imp = self.right @ np.linalg.lstsq(self.d, after - x, rcond=RCOND)[0]
        total = 0.0
        for n, u in zip(self.net.of("Se", "Sf"), self.net.u(t), strict=True):
            ((b, s, _),) = self.net.ends(n)
            other = b + self.nb if self.net.nodes[n][0] == "Se" else b
            total -= s * u * imp[other]
        return total

    # -- motion

    def _solve(self, z, u, du, hess) -> np.ndarray:
        a = np.vstack([self.m, self.gz @ hess @ self.y])
        b = np.concatenate([np.zeros(len(self.k)), u, z, -self.gu @ du])
        return np.linalg.lstsq(a, b, rcond=RCOND)[0]

    def w(self, x: np.ndarray, t: float) -> np.ndarray:
        """Return bond variables; what is free has the least leakage."""
        hess = self.hess(x)
        z, u, du = self.co(x), self.net.u(t), self.net.du(t)
        if self.laws:
            w = self._newton(z, u, du, hess)
        else:
            w = self._solve(z, u, du, hess)
        a = np.vstack(
            [
                self.m,
                self.gz @ hess @ self.y,
                *((o - (c1 + 3 * c3 * (g @ w) ** 2) * g)[None] for o, g, c1, c3 in self.laws),
            ]
        )
        free = null_space(a, rcond=RCOND)
        if not free.shape[1]:
            return w
        j = self._leaks()
        seen = j @ free
        if len(j):
            # absolute cut: `free` is orthonormal and leaks have unit weights
            u, sv, vt = np.linalg.svd(seen)
            r = int((sv > 1e-9).sum())
            w = w - free @ (vt[:r].T @ ((u[:, :r].T @ (j @ w)) / sv[:r]))
            free = free @ vt[r:].T
        return w - free @ (free.T @ w)

    def _newton(self, z, u, du, hess) -> np.ndarray:
        a = np.vstack([self.m, self.gz @ hess @ self.y])
        b = np.concatenate([np.zeros(len(self.k)), u, z, -self.gu @ du])
        w = (
            self.guess
            if hasattr(self, "guess")
            else np.linalg.lstsq(
                np.vstack([a, *((o - c1 * g)[None] for o, g, c1, _ in self.laws)]),
                np.concatenate([b, np.zeros(len(self.laws))]),
                rcond=RCOND,
            )[0]
        )
        for _ in range(80):
            law = [o @ w - c1 * (g @ w) - c3 * (g @ w) ** 3 for o, g, c1, c3 in self.laws]
            jac = np.vstack(
                [a, *((o - (c1 + 3 * c3 * (g @ w) ** 2) * g)[None] for o, g, c1, c3 in self.laws)]
            )
            step = np.linalg.lstsq(jac, np.concatenate([a @ w - b, law]), rcond=RCOND)[0]
            w = w - step
            if np.abs(step).max() <= 1e-13 * (1 + np.abs(w).max()):
                break
        self.guess = w
        return w

    def _leaks(self) -> np.ndarray:
        rows = []
        for n in self.net.controlled:
            ends = self.net.ends(n)
            if not ends:
                continue
            zero = self.net.nodes[n][0] == "0"
            r = np.zeros(2 * self.nb)
            if n in self.net.on:
                r[ends[0][0] + (0 if zero else self.nb)] = 1.0
            else:
                for k, s, _ in ends:
                    r[k + (self.nb if zero else 0)] += s
            rows.append(r)
        return np.array(rows).reshape(-1, 2 * self.nb)

    def matrices(self) -> np.ndarray:
        """Return A with d/dt [x, v] = A [x, v], v the exosystem of 1, sin, cos per source."""
        n, nu = len(self.h), len(self.s)
        a = np.zeros((n + 1 + 2 * nu, n + 1 + 2 * nu))
        hess = np.diag(self.h)
        zero_u, zero_z = np.zeros(nu), np.zeros(n)
        for k in range(n):
            unit = np.zeros(n)
            unit[k] = self.h[k]
            a[:n, k] = self.y @ self._solve(unit, zero_u, zero_u, hess)
        for j, name in enumerate(self.net.of("Se", "Sf")):
            c0, c1, c2 = self.net.nodes[name][1]
            unit = np.zeros(nu)
            unit[j] = 1.0
            by_u = self.y @ self._solve(zero_z, unit, zero_u, hess)
            by_du = self.y @ self._solve(zero_z, zero_u, unit, hess)
            a[:n, n] += by_u * c0
            a[:n, n + 1 + 2 * j] += by_u * c1
            a[:n, n + 2 + 2 * j] += by_du * c1 * c2
            a[n + 1 + 2 * j, n + 2 + 2 * j] = c2
            a[n + 2 + 2 * j, n + 1 + 2 * j] = -c2
        return a

    def flow(self, x: np.ndarray, t0: float, t1: float) -> np.ndarray:
        """Return the state at t1 from x at t0, exactly (linear nets)."""
        n = len(self.h)
        v = [1.0]
        for name in self.net.of("Se", "Sf"):
            c = self.net.nodes[name][1][2]
            v += [np.sin(c * t0), np.cos(c * t0)]
        return (expm(self.matrices() * (t1 - t0)) @ np.concatenate([x, v]))[:n]

    def eigenvalues(self) -> np.ndarray:
        """Return the natural frequencies on the constrained space, sorted."""
        n = len(self.h)
        a = self.matrices()[:n, :n]
        v = null_space(self.gz @ np.diag(self.h), rcond=1e-9) if len(self.gz) else np.eye(n)
        return np.sort_complex(np.linalg.eigvals(np.linalg.pinv(v) @ a @ v))


# -- random nets -----------------------------------------------------------------------------------


def random_net(
    seed: int,
    size: int,
    *,
    rings: int = 1,
    controlled: float = 0.3,
    sources: float = 0.5,
    nonlinear: float = 0.0,
    zero: float = 0.0,
    timed: float = 0.5,
    resistors: float = 0.8,
) -> Net:
    """Return a random connected net: junctions in a tree with rings, elements hung on them."""
    rng = np.random.default_rng([seed, size, rings])

    def number(low: float = 0.5, high: float = 2.0) -> float:
        return round(float(rng.uniform(low, high)), 3)

    def either(a: str, b: str) -> tuple[str, str]:
        return (a, b) if rng.random() < 0.5 else (b, a)

    nodes: dict[str, tuple[str, object]] = {}
    bonds: list[tuple[str, str]] = []
    junctions = [f"j{k}" for k in range(size)]
    for j in junctions:
        nodes[j] = ("0" if rng.random() < 0.5 else "1", None)
    pairs = [(junctions[int(rng.integers(k))], junctions[k]) for k in range(1, size)]
    for _ in range(rings):
        if size > 2:
            a, b = rng.choice(size, 2, replace=False)
            pair = (junctions[a], junctions[b])
            if pair not in pairs and pair[::-1] not in pairs:
                pairs.append(pair)
    for k, (a, b) in enumerate(pairs):
        r = rng.random()
        if r < 0.7:
            bonds.append(either(a, b))
            continue
        kind = "TF" if r < 0.87 else "GY"
        value = number() * (1 if rng.random() < 0.7 else -1)
        if rng.random() < zero and kind == "TF":
            value = 0.0
        nodes[f"t{k}"] = (kind, value)
        bonds += [either(a, f"t{k}.1"), either(f"t{k}.2", b)]
    start: dict[str, float] = {}
    count = int(rng.integers(2, size + 4))
    n_sources = 0
    for k in range(count):
        r = rng.random()
        j = junctions[int(rng.integers(size))]
        if r < 0.62:
            kind = "C" if r < 0.31 else "I"
            name = f"{kind.lower()}{k}"
            value: object = number()
            if rng.random() < nonlinear:
                value = (number(), number(0.1, 0.8))
            start[name] = round(float(rng.uniform(-1, 1)), 3)
        elif r < 0.62 + 0.3 * resistors:
            kind = "R" if rng.random() < 0.5 else "G"
            name = f"r{k}"
            value = number()
            if rng.random() < zero:
                value = 0.0
            elif rng.random() < nonlinear:
                value = (number(), number(0.1, 0.8))
        elif n_sources < 2 and rng.random() < sources:
            kind = "Se" if rng.random() < 0.5 else "Sf"
            name = f"s{k}"
            value = (number(-2, 2), number() if rng.random() < timed else 0.0, number())
            n_sources += 1
        else:
            continue
        nodes[name] = (kind, value)
        bonds.append(either(j, name))
    switched = [j for j in junctions if rng.random() < controlled]
    on = {j for j in switched if rng.random() < 0.5}
    later = {j for j in switched if rng.random() < 0.5}
    order = rng.permutation(len(bonds))
    net = Net(nodes, [bonds[k] for k in order], switched, on, None, start)
    # a junction without any bond is no part of a connected net
    if size == 1 and not net.ends("j0"):
        nodes["c_only"] = ("C", 1.0)
        nodes["r_only"] = ("R", 1.0)
        net.bonds += [("j0", "c_only"), ("r_only", "j0")]
        start["c_only"] = 1.0
    net._later = later  # type: ignore[attr-defined]
    return net


def switching_net(seed: int, size: int, **options) -> Net:
    """Return a random net that changes mode at t = 1 s."""
    net = random_net(seed, size, controlled=0.6, **options)
    return replace(net, later=net._later)  # type: ignore[attr-defined]
