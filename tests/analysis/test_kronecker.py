"""Pencils of known Kronecker structure, hidden by random transformations, must be recovered."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import block_diag

from hybond.analysis.structure.controllability import controllability, observability
from hybond.analysis.structure.stored_form import stored_form
from hybond.equations.descriptor import Descriptor
from hybond.equations.pencil import analyse

SMALL = settings(max_examples=75, deadline=None, derandomize=True)


def hidden(rng: np.random.Generator, n: int) -> np.ndarray:
    """Return a random matrix with singular values between 1/2 and 2."""
    u = np.linalg.qr(rng.normal(size=(n, n)))[0]
    v = np.linalg.qr(rng.normal(size=(n, n)))[0]
    return u @ np.diag(rng.uniform(0.5, 2.0, n)) @ v


def shift(n: int) -> np.ndarray:
    return np.eye(n, k=1)


def record(e, a, b, c=None, f=None) -> Descriptor:
    n, p = b.shape
    c = np.zeros((0, n)) if c is None else c
    return Descriptor(
        np.asarray(e, dtype=float),
        np.asarray(a, dtype=float),
        b,
        c,
        np.zeros((len(c), p)),
        np.zeros_like(c) if f is None else f,
        tuple(f"x{k}" for k in range(n)),
        tuple(f"u{k}" for k in range(p)),
        tuple(f"y{k}" for k in range(len(c))),
        n,
    )


jordan = st.lists(
    st.tuples(st.sampled_from([-3.0, -1.0, -0.5, 0.0, 2.0]), st.integers(1, 3)), max_size=3
)
nilpotent = st.lists(st.integers(1, 3), max_size=2)
seeds = st.integers(0, 10_000)


@SMALL
@given(jordan, nilpotent, seeds)
def test_degree_index_and_rank_of_a_regular_pencil(blocks, chains, seed) -> None:
    if not blocks and not chains:
        return
    rng = np.random.default_rng(seed)
    slow = [lam * np.eye(k) + shift(k) for lam, k in blocks]
    r, m = sum(k for _, k in blocks), sum(chains)
    e = block_diag(np.eye(r), *(shift(k) for k in chains))[: r + m, : r + m]
    a = block_diag(*slow, np.eye(m))[: r + m, : r + m]
    p, q = hidden(rng, r + m), hidden(rng, r + m)
    found = analyse(record(p @ e @ q, p @ a @ q, np.zeros((r + m, 0))))
    assert found.regular
    assert found.order == r
    assert found.rank_e == r + sum(k - 1 for k in chains)
    assert found.index == max(chains, default=0)
    assert found.impulse_free == all(k == 1 for k in chains)
    assert found.sure
    # a coalescing eigenvalue is known to a part of its digits: compare what is well-posed
    exact = np.poly([lam for lam, k in blocks for _ in range(k)])
    assert np.allclose(np.poly(found.poles), exact, atol=1e-8 * np.abs(exact).max())


@SMALL
@given(st.integers(0, 2), st.integers(0, 2), jordan, seeds)
def test_a_singular_pencil_is_never_solvable(right, left, blocks, seed) -> None:
    """One Kronecker block k x (k+1) and one (l+1) x l make it square and singular."""
    rng = np.random.default_rng(seed)
    wide_e, wide_a = np.eye(right, right + 1), np.eye(right, right + 1, k=1)
    tall_e, tall_a = np.eye(left + 1, left), np.eye(left + 1, left, k=-1)
    slow = [lam * np.eye(k) + shift(k) for lam, k in blocks]
    e = block_diag(wide_e, tall_e, np.eye(sum(k for _, k in blocks)))
    a = block_diag(wide_a, tall_a, *slow)
    n = right + left + 1 + sum(k for _, k in blocks)
    e, a = e[:n, :n], a[:n, :n]
    p, q = hidden(rng, n), hidden(rng, n)
    found = analyse(record(p @ e @ q, p @ a @ q, np.zeros((n, 0))))
    assert not found.regular and found.order is None
    assert found.normal_rank == n - 1


@pytest.mark.slow
@SMALL
@given(
    st.lists(st.sampled_from([-3.0, -2.0, -1.0, 0.0, 1.0]), min_size=1, max_size=4),
    st.lists(st.sampled_from([-2.5, -1.0, 0.0]), max_size=3),
    nilpotent,
    st.lists(st.booleans(), min_size=2, max_size=2),
    seeds,
)
def test_controllability_is_that_of_the_blocks(steered, free, chains, driven, seed) -> None:
    """A chain of integrators with poles is steered by u; the other block is not.

    A nilpotent chain of length k that u enters at its end is controllable at infinity; one that
    it does not enter is not, and makes impulses that u cannot avoid if k > 1.
    """
    rng = np.random.default_rng(seed)
    r1, r2 = len(steered), len(free)
    # a chain: each state feeds the next, so u at its head steers all
    chain = np.diag(steered) + np.eye(r1, k=-1)
    loose = np.diag(free) + np.triu(rng.normal(size=(r2, r2)), 1)
    m = sum(chains)
    a_slow = np.block([[chain, rng.normal(size=(r1, r2))], [np.zeros((r2, r1)), loose]])
    e = block_diag(np.eye(r1 + r2), *(shift(k) for k in chains))
    a = block_diag(a_slow, np.eye(m))
    e, a = e[: len(a), : len(a)], a
    b = np.zeros((len(a), 1 + len(chains)))
    b[0, 0] = 1.0
    at = r1 + r2
    entered = driven[: len(chains)]
    for j, k in enumerate(chains):
        at += k
        if entered[j]:
            b[at - 1, 1 + j] = 1.0
    p, q = hidden(rng, len(a)), hidden(rng, len(a))
    e, a, b = p @ e @ q, p @ a @ q, p @ b
    found = controllability(analyse(record(e, a, b)))
    assert found.rank == r1
    assert found.finite == (r2 == 0)
    assert found.infinite == all(entered)
    assert found.impulse == all(d or k == 1 for d, k in zip(entered, chains))
    exact = np.poly(free)
    assert np.allclose(np.poly(found.modes), exact, atol=1e-7 * np.abs(exact).max())
    # the dual system has the dual properties
    dual = observability(analyse(record(e.T, a.T, np.zeros((len(a), 0)), b.T)))
    assert (dual.rank, dual.finite, dual.infinite, dual.impulse) == (
        found.rank,
        found.finite,
        found.infinite,
        found.impulse,
    )


@SMALL
@given(seeds, st.integers(1, 4), st.integers(0, 3))
def test_eigenvalue_test_of_the_whole_pencil_agrees(seed, r, m) -> None:
    """Random pencils: rank [zE - A, B] at the poles of a generic pencil is an independent test."""
    rng = np.random.default_rng(seed)
    n = r + m
    a = rng.normal(size=(n, n))
    e = hidden(rng, n)[:, :r] @ rng.normal(size=(r, n))
    b = rng.normal(size=(n, 1))
    found = analyse(record(e, a, b))
    assert found.order == r
    reach = controllability(found)
    ranks = [np.linalg.matrix_rank(np.hstack([z * e - a, b])) for z in found.poles]
    assert reach.finite == all(k == n for k in ranks)


@pytest.mark.parametrize("power", [-12, -6, 6, 12])
def test_units_do_not_change_any_rank(power: int) -> None:
    """The same pencil in other units of v, of the equations and of time."""
    rng = np.random.default_rng(7)
    e = np.diag([1.0, 1.0, 1.0, 0.0]) @ rng.normal(size=(4, 4))
    a, b = rng.normal(size=(4, 4)), rng.normal(size=(4, 2))
    c = rng.normal(size=(1, 4))
    units = 10.0 ** rng.uniform(-abs(power), abs(power), 4)
    rows = 10.0 ** rng.uniform(-abs(power), abs(power), 4)
    for time in (1.0, 10.0**power):
        d = record(
            rows[:, None] * e * units * time,
            rows[:, None] * a * units,
            rows[:, None] * b,
            c * units,
        )
        found = analyse(d)
        assert (found.order, found.index, found.rank_e, found.sure) == (3, 1, 3, True)
        assert controllability(found).finite and observability(found).finite


@SMALL
@given(seeds, st.integers(1, 4), st.integers(0, 3), st.integers(0, 3))
@pytest.mark.slow
def test_the_stored_form_has_the_same_transfer_function(seed, n, multipliers, followers) -> None:
    """Kept variables of both kinds: some hold a constraint, some follow from algebraic rows."""
    rng = np.random.default_rng(seed)
    m = min(multipliers, n)
    k = m + followers
    size = n + k
    e = np.zeros((size, size))
    e[:n, :n] = np.eye(n)
    a = rng.normal(size=(size, size))
    # the rows of constraints read what is stored alone
    a[n : n + m, n:] = 0.0
    d = record(e, a, rng.normal(size=(size, 2)), rng.normal(size=(2, size)))
    d = replace(d, stored=n)
    small = stored_form(d)
    assert len(small.states) == n and small.stored == n
    assert np.linalg.matrix_rank(small.E) == n - m
    for s in (0.3 + 1.1j, -2.0 + 0.4j):
        assert np.allclose(small.response(s), d.response(s), rtol=1e-7, atol=1e-7)
    assert analyse(small).order == analyse(d).order == n - m
