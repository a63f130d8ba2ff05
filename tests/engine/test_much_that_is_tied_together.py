"""Much that is tied together, like a star, a chain or a tree: a jump costs what it has terms.

130 wheels locked to one shaft took a second for each that was added: jumps were solved for by
singular values of all that may move, and each tied storage stood in the row of every other.
"""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb
from hybond.engine.algebra.sparse_lu import (
    add_term,
    begin_system,
    end_equation,
    factor_sparse,
    make_factoring,
    make_sparse_lu,
    solve_sparse,
    solve_transposed,
)
from hybond.engine.constraints.sparse_ways import FEW

N = FEW + 8
BEFORE = {
    "star": lambda _: 0,
    "chain": lambda k: k - 1,
    "tree": lambda k: (k - 1) // 2,
    "stars in a chain": lambda k: k - 1 if k % 8 == 0 else k - k % 8,
}
"""What each body is coupled to, by its shape."""


def sizes() -> np.ndarray:
    """Return masses or capacities of all sizes: light ones between heavy ones."""
    return 10.0 ** np.tile([0.0, -9.0, 3.0, -3.0], N)[: N + 1] * (1.0 + np.arange(N + 1) / 7)


def levels() -> np.ndarray:
    """Return the speeds or voltages at which they begin."""
    return np.cos(np.arange(N + 1.0))


def coupled(shape: str, kind: str, times: list[float], *, backwards: bool = False) -> hb.Model:
    """Return bodies, or capacitors, of which each is tied to another one at its time."""
    masses = kind == "masses"
    m = hb.Model("coupled", domain="translational" if masses else "electrical")
    common, single, store = (hb.One, hb.Zero, hb.I) if masses else (hb.Zero, hb.One, hb.C)
    for k, (size, level) in enumerate(zip(sizes(), levels(), strict=True)):
        turned = backwards and k % 2 == 1
        held = {"f" if masses else "e": -level if turned and masses else level}
        m.add(**{f"v{k}": common(), f"S{k}": store(size, **held)})
        m.bond(f"S{k} -> v{k}" if turned else f"v{k} -> S{k}")
        if k == 0:
            continue
        ends = [f"v{BEFORE[shape](k)}", f"v{k}"]
        m.add(**{f"c{k}": single()})
        m.bond(" -> ".join([ends[backwards], f"c{k}", ends[not backwards]]))
        rules = [f"apart -> tied when time > {times[k - 1]}"]
        m.machine(f"w{k}", states={"apart": [], "tied": [f"c{k}"]}, start="apart", rules=rules)
    return m


@pytest.mark.parametrize(
    ("shape", "kind", "backwards"),
    [
        ("star", "masses", False),
        ("star", "capacitors", True),
        ("chain", "masses", True),
        ("tree", "capacitors", False),
        ("stars in a chain", "masses", True),
    ],
)
def test_what_is_tied_at_once_shares_all_it_has(shape, kind, backwards):
    run = hb.simulate(coupled(shape, kind, [0.5] * N, backwards=backwards), 1)
    size, level = sizes(), levels()
    shared = np.dot(size, level) / size.sum()
    held, sent = ("f", "e") if kind == "masses" else ("e", "f")
    # what each body gains comes through its coupling, and what those behind it gain too
    through = size * (shared - level)
    for k in range(N, 0, -1):
        through[BEFORE[shape](k)] += through[k]
    impulses = run.events[1].steps[-1].impulses
    most = abs(size * level).max()
    for k in range(N + 1):
        assert run.final[f"S{k}.{held}"] == pytest.approx(shared, rel=1e-12)
    for k in range(1, N + 1):
        found = impulses.get(f"c{k}.{sent}", 0.0)
        assert (-1 if backwards else 1) * found == pytest.approx(through[k], abs=1e-12 * most)


@pytest.mark.parametrize("shape", ["chain", "tree"])
def test_what_is_tied_one_after_the_other_keeps_its_momentum(shape):
    order = np.random.default_rng(1).permutation(N)
    run = hb.simulate(coupled(shape, "masses", [0.1 + 0.8 * k / N for k in order]), 1)
    size, level = sizes(), levels()
    assert len(run.events) == N + 1
    for k in range(N + 1):
        assert run.final[f"S{k}.f"] == pytest.approx(np.dot(size, level) / size.sum(), rel=1e-11)


@pytest.mark.parametrize("feed", [False, True], ids=["led", "led behind a switch of their own"])
def test_many_led_by_one_source_are_what_it_says(feed):
    m = hb.Model("led", domain="electrical")
    m.add(V=hb.Se("2 + sin(3*time)"), bus=hb.Zero(), main=hb.One())
    m.bond("V -> main -> bus")
    times = [0.2] * N
    for k, size in enumerate(sizes()[:N]):
        m.add(**{f"S{k}": hb.C(size), f"c{k}": hb.One()})
        m.bond(f"bus -> c{k} -> S{k}")
        rules = [f"off -> on when time > {times[k]}"]
        m.machine(f"w{k}", states={"off": [], "on": [f"c{k}"]}, start="off", rules=rules)
    if feed:
        rules = ["off -> on when time > 0.3"]
        m.machine("feeds", states={"off": [], "on": ["main"]}, start="off", rules=rules)
    run = hb.simulate(m, 1)
    for t in [0.35, 0.7, 1.0]:
        for k in [0, 1, N - 1]:
            want = (2 + np.sin(3 * t)) * sizes()[k]
            assert float(run[f"S{k}.q"].at(t)) == pytest.approx(want, rel=1e-14)


@pytest.mark.parametrize("n", [1, 3, 20, 60])
def test_sparse_factors_solve_and_tell_what_is_dependent(n):
    rng = np.random.default_rng(n)
    regular = 0
    for _ in range(20):
        a = np.where(rng.random((n, n)) < 4 / n, rng.normal(size=(n, n)), 0.0)
        f, room = make_sparse_lu(), make_factoring()
        begin_system(f, n, n * n)
        for row in a:
            for j in np.flatnonzero(row):
                add_term(f, int(j), float(row[j]))
            end_equation(f)
        found = factor_sparse(f, room)
        assert found == (np.linalg.matrix_rank(a) == n)
        regular += found
        if found:
            b, x, y = rng.normal(size=n), [0.0] * n, [0.0] * n
            solve_sparse(f, room, b.tolist(), x)
            solve_transposed(f, room, b.tolist(), y)
            least = 1e-12 * np.linalg.cond(a)
            assert a @ x == pytest.approx(b, abs=least)
            assert a.T @ y == pytest.approx(b, abs=least)
    assert regular > 0
