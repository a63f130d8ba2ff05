"""One mode of a hybrid model as matrices: motion, signals, entry. Linear laws only."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from dense_oracle import RCOND, Dense, Net
from hybrid_models import Hybrid
from scipy.linalg import expm, null_space

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

    def enter(self, full: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return x+ with integrals, the impulses of bond variables, and whether it is a jump.

        It is none if the state fits but for the shift of a located instant.
        """
        d, n, x = self.dense, self.n, full[: self.one]
        u, rates = self.u @ full, self.du @ full
        none = np.zeros(2 * d.nb)
        if max(np.abs(d.agree @ v).max(initial=0.0) for v in (u, rates)) > 1e-9:
            raise Stop("sources")
        residual = d.gz @ (d.h * x[:n]) + d.gu @ u
        off = np.abs(residual).max(initial=0.0)
        if off <= EQUAL:
            return x.copy(), none, False
        if ROUNDING < off <= CLOSE:
            raise Stop("close")
        slope = d.gz @ np.diag(d.h) @ d.d
        nu = -np.linalg.lstsq(slope, residual, rcond=1e-10)[0]
        if np.abs(slope @ nu + residual).max() > 1e-9:
            raise Stop("sources")
        impulses = d.least((d.right @ nu)[:, None], self.shares)[:, 0]
        self.areas = impulses.copy()
        if self.h.laws:
            # laws bound the shares, which is not looked into here
            impulses[np.abs(self.shares).max(axis=1, initial=0.0) > 1e-9] = np.nan
        after = x.copy()
        after[:n] += d.d @ nu
        for k, (terms, _) in enumerate(self.h.integrals.values()):
            after[n + k] += self.row(terms)[1] @ impulses
        return (after, impulses, True) if off > ROUNDING else (after, none, False)

    @cached_property
    def shares(self) -> np.ndarray:
        """Impulses of bond variables that move nothing stored."""
        return self.dense.right @ null_space(self.dense.d, rcond=RCOND)

    def open_impulses(self, on_w: np.ndarray) -> bool:
        return bool(np.abs(on_w @ self.shares).max(initial=0.0) > 1e-9)

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
        loose = self.mode.loose(on_w) or (self.jumps and self.mode.open_impulses(on_w))
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
