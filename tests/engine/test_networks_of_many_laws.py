"""Networks of many laws that each know of few unknowns: pipes of a town, resistors that saturate.

Newton's step was made by dense factors, as was what flows are measured by, so that a run of 180
pipes took seconds. Where tanks of such a net had become level, rates that differ by rounding were
taken for a jump of a law: HB-N410, after minutes of steps that led nowhere.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb
from hybond.engine.algebra.sparse_lu import (
    add_term,
    begin_system,
    end_equation,
    factor_again,
    factor_sparse,
    make_factoring,
    make_sparse_lu,
    solve_sparse,
)

LAWS = {
    "turbulent": ("e", "{}*f*abs(f) + 0.05*f"),
    "saturating": ("f", "{}*tanh(e) + 0.01*e"),
    "cubic": ("f", "{}*e^3 + 0.02*e"),
}


def inverse(law: str, c: np.ndarray, drop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what flows by a drop of effort, and its slope."""
    if law == "turbulent":
        root = np.sqrt(0.0025 + 4 * c * np.abs(drop))
        return 2 * drop / (0.05 + root), 1 / root
    if law == "saturating":
        return c * np.tanh(drop) + 0.01 * drop, c / np.cosh(drop) ** 2 + 0.01
    return c * drop**3 + 0.02 * drop, 3 * c * drop**2 + 0.02


def pipes_of(n: int) -> list[tuple[int, int, float]]:
    """Return which nodes of a square net are joined, and how."""
    right = [(n * i + j, n * i + j + 1) for i in range(n) for j in range(n - 1)]
    down = [(n * i + j, n * i + n + j) for i in range(n - 1) for j in range(n)]
    return [(a, b, round(1.5 + np.sin(7.0 * k), 3)) for k, (a, b) in enumerate(right + down)]


def net(n: int, law: str, tanks: dict[int, float], *, turned: bool, level: str = "5") -> hb.Model:
    """Return a net that a source, or tanks, feed, and from which a little is taken everywhere."""
    m = hb.Model("net")
    given, text = LAWS[law]
    for k in range(n * n):
        m.add(**{f"z{k}": hb.Zero()})
        if k in tanks:
            m.add(**{f"t{k}": hb.C(2.0, q=2.0 * tanks[k])})
            m.bond(f"z{k} -> t{k}")
        elif not tanks and k > 0:
            m.add(**{f"d{k}": hb.Sf(0.01 * (k % 4))})
            m.bond(f"z{k} -> d{k}")
    if not tanks:
        m.add(s=hb.Se(level))
        m.bond("s -> z0")
    for k, (a, b, c) in enumerate(pipes_of(n)):
        m.add(**{f"l{k}": hb.One(), f"r{k}": hb.R({given: text.format(c)})})
        back = turned and k % 2 == 1
        m.bond(f"z{b} -> l{k} -> z{a}" if back else f"z{a} -> l{k} -> z{b}", f"l{k} -> r{k}")
    return m


def flows(n: int, law: str, level: float) -> np.ndarray:
    """Return what flows through the pipes: Newton's method on the balances of the nodes."""
    pipes = pipes_of(n)
    c = np.array([p[2] for p in pipes])
    ends = np.zeros((len(pipes), n * n))
    for k, (a, b, _) in enumerate(pipes):
        ends[k, a], ends[k, b] = 1.0, -1.0
    taken = 0.01 * (np.arange(n * n) % 4)
    x = np.full(n * n, level)
    for _ in range(200):
        flow, slope = inverse(law, c, ends @ x)
        off = (ends.T @ flow + taken)[1:]
        step = np.linalg.solve((ends.T * slope @ ends)[1:, 1:], off)
        part = 1.0
        while part > 1e-9:
            there = x.copy()
            there[1:] -= part * step
            left = (ends.T @ inverse(law, c, ends @ there)[0] + taken)[1:]
            if np.linalg.norm(left) < np.linalg.norm(off):
                break
            part /= 2
        else:
            break
        x = there
    return inverse(law, c, ends @ x)[0]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.sampled(1)
def test_what_flows_in_a_net_of_many_laws_is_what_its_nodes_say(law: str, turned: bool) -> None:
    """60 laws that all hang together, against Newton's method in other unknowns."""
    run = hb.simulate(net(6, law, {}, turned=turned), until=1e-3)
    found = np.array([run[f"r{k}.f"].at(0.0) for k in range(60)])
    right = flows(6, law, 5.0)
    ways = np.where(turned & (np.arange(60) % 2 == 1), -1.0, 1.0)
    assert ways * found == pytest.approx(right, rel=1e-9, abs=1e-11)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("apart", [3e-8, 1e-6])
def test_tanks_that_are_level_but_for_last_places_have_no_jump(apart: float, turned: bool) -> None:
    """So near to rest the laws are lines, and levels an exponential of a matrix."""
    n = 5
    tanks = {k: 5.9 + apart * np.sin(7.0 * k) for k in range(n * n) if (k // n + k % n) % 3 == 0}
    run = hb.simulate(net(n, "turbulent", tanks, turned=turned), until=0.02)
    laplace = np.zeros((n * n, n * n))
    for a, b, _ in pipes_of(n):
        laplace[np.ix_([a, b], [a, b])] += 20.0 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    own = list(tanks)
    rest = [k for k in range(n * n) if k not in tanks]
    by = laplace[np.ix_(own, rest)] @ np.linalg.inv(laplace[np.ix_(rest, rest)])
    reduced = laplace[np.ix_(own, own)] - by @ laplace[np.ix_(rest, own)]
    begun = np.array(list(tanks.values())) - 5.9
    right = expm(-reduced * 0.02 / 2.0) @ begun
    found = np.array([run[f"t{k}.e"].at(0.02) for k in own]) - 5.9
    assert run.status == "ok"
    assert found == pytest.approx(right, abs=1e-3 * apart)
    assert np.max(np.abs(right - begun)) > 0.1 * apart


@pytest.mark.parametrize("n", [1, 7, 40])
def test_factors_found_again_in_the_same_order_solve_other_values(n: int) -> None:
    """Against dense factors; where an order fits no more, that is said."""
    rng = np.random.default_rng(n)
    pattern = (rng.random((n, n)) < 3.0 / n) | np.eye(n, dtype=bool)
    f, r = make_sparse_lu(), make_factoring()
    a = np.where(pattern, rng.normal(size=(n, n)), 0.0) + 3.0 * np.eye(n)
    begin_system(f, n, int(pattern.sum()))
    for i in range(n):
        for j in np.flatnonzero(pattern[i]):
            add_term(f, int(j), float(a[i, j]))
        end_equation(f)
    assert factor_sparse(f, r)
    other = np.where(pattern, a * rng.uniform(0.9, 1.1, (n, n)), 0.0)
    for p, (i, j) in enumerate(np.argwhere(pattern)):
        f.term.at[p] = float(other[i, j])
    assert factor_again(f, r)
    b = rng.normal(size=n)
    x = [0.0] * n
    solve_sparse(f, r, list(b), x)
    assert np.array(x) == pytest.approx(np.linalg.solve(other, b), rel=1e-10, abs=1e-12)
    for p in range(f.begins.at[1]):
        f.term.at[p] = 0.0
    assert not factor_again(f, r)
