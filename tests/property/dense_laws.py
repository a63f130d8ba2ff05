"""Junctions with laws, decided by trying every combination of branches."""

from __future__ import annotations

from itertools import product

import numpy as np
from dense_modes import CLOSE, ROUNDING, Linear, Signals, Stop
from scipy.linalg import expm
from scipy.optimize import linprog

SOON = 1e-4
"""s; rates are of order one."""


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
    """Whether a quantity is not negative from now on: its value, else its first rate."""
    value = float(row @ full) + bound
    for _ in range(mode.size + 1):
        if abs(value) > CLOSE:
            return value > 0.0
        if abs(value) > ROUNDING:
            raise Stop("close")
        full = mode.a @ full
        value = float(row @ full)
    return True


def entry(run, x, states, branches, t: float, prior: Signals):
    """Return mode, x+, impulses, whether it jumps, branches, whether branches are several."""
    if not run.h.laws:
        mode = run.mode(states, t, 1)
        entered = mode.enter(run.full(mode, x, t, prior))
        return mode, *entered, (), False
    found = []
    for tried in product(*(law.branches for law in run.h.laws.values())):
        mode = run.mode(states, t, 1, tried)
        try:
            after, impulses, jumps = mode.enter(run.full(mode, x, t, prior))
        except Stop as stop:
            if str(stop) == "sources":
                continue
            raise
        if jumps and not carries(run, mode, tried, mode.areas):
            continue
        if not jumps:
            after = x
        holds = still(run, after, states, t, prior)
        if holds:
            found.append((after, impulses, jumps, holds))
    if not found:
        raise Stop("none")
    after, impulses, jumps, standing = found[0]
    if any(np.abs(f[0] - after).max(initial=0.0) > ROUNDING for f in found):
        raise Stop("several")
    names = [b for b, _, _ in standing]
    several = len(standing) > 1 or standing[0][2]
    chosen = names.index(branches) if branches in names else 0
    if branches not in names:
        # which of them is named does not matter if they move alike
        motions = []
        for _, m, _ in standing:
            rate = m.a @ run.full(m, after, t, prior)
            motions.append(np.concatenate([rate[: m.n], (m.a @ rate)[: m.n]]))
        if np.ptp(np.array(motions), axis=0).max(initial=0.0) > CLOSE:
            raise Stop("several")
    branch, mode, _ = standing[chosen]
    # a state that fits but for the shift of the instant is put where it belongs
    after = mode.enter(run.full(mode, after, t, prior))[0]
    return mode, after, impulses, jumps, branch, several


def carries(run, mode: Linear, tried: tuple[str, ...], impulses: np.ndarray) -> bool:
    """Whether the impulses of a jump obey the laws, for some admissible shares."""
    # a limit is finite: friction that holds lets no impulse pass, and none acts where it slides
    rows = np.array([r for r, _ in conditions(run, mode, tried)])
    return feasible(rows.reshape(-1, len(impulses)), impulses, mode.shares)


def law_row(run, mode: Linear, name: str, branch: str) -> np.ndarray:
    """Return what a branch of a diode says is not negative, on bond variables."""
    common, net = (".f", ".e") if mode.net.nodes[name][0] == "1" else (".e", ".f")
    return mode.bond_row(name + common) if branch == "conducts" else -mode.bond_row(name + net)


def conditions(run, mode: Linear, branches) -> list[tuple[np.ndarray, float]]:
    """Return (row on bond variables, bound): the row plus the bound is not negative."""
    found = []
    for (name, law), b in zip(run.h.laws.items(), branches, strict=True):
        common, net = (".f", ".e") if mode.net.nodes[name][0] == "1" else (".e", ".f")
        if law.kind == "diode":
            found.append((law_row(run, mode, name, b), 0.0))
        elif b == "sticks":
            r = mode.bond_row(name + net)
            found += [(-r, law.breakaway), (r, law.breakaway)]
        else:
            r = mode.bond_row(name + common)
            found.append((r if b == "forward" else -r, 0.0))
    return found


def still(run, x, states, t: float, prior: Signals) -> list:
    """Return the branches that hold without a jump: finite values, then rates of all orders.

    A list of (branches, mode, whether a condition is open).
    """
    found = []
    for tried in product(*(law.branches for law in run.h.laws.values())):
        mode = run.mode(states, t, 1, tried)
        try:
            after, _, jumps = mode.enter(run.full(mode, x, t, prior))
        except Stop as stop:
            if str(stop) == "sources":
                continue
            raise
        if jumps:
            continue
        full = run.full(mode, after, t, prior)
        needed = conditions(run, mode, tried)
        loose = [(r, c) for r, c in needed if mode.loose(r)]
        if loose:
            rows = np.array([r for r, _ in needed])
            bounds = np.array([c for _, c in needed])
            # where all is zero and zero, what comes a little later decides
            times = (full, expm(mode.a * SOON) @ full)
            if not all(feasible(rows, mode.w @ x, mode.undetermined, bounds) for x in times):
                continue
        if all(mode.loose(r) or lexicographic(mode, r @ mode.w, c, full) for r, c in needed):
            found.append((tried, mode, bool(loose)))
    return found
