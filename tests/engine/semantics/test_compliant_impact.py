"""The law of Liu, Zhao and Brogliato against springs, closed forms and published numbers."""

from collections.abc import Callable

import numpy as np
import pytest
from engine_impacts import Impact, Refused, compliant_impact, impact
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

Array = np.ndarray


class Row:
    """Bodies in a row, each touching the next."""

    def __init__(self, *masses: float) -> None:
        self.m = np.array(masses, dtype=float)
        self.G = np.diff(np.eye(len(masses)), axis=0)
        self.W = self.G / self.m @ self.G.T

    def impact(self, u: list[float], **options: object) -> tuple[Array, Impact]:
        """Velocities of the bodies afterwards, and the record."""
        done = impact(self.W, self.G @ u, law="lzb", **options)
        return np.array(u, dtype=float) + self.G.T @ done.impulses / self.m, done


def springs(row: Row, u: list[float], k: list[float], m: float) -> Array:
    """Velocities after bodies in a row have met, with positions and elastic contacts that can open.

    Integrated until no contact is compressed or approached; says if a contact closed twice.
    """
    n = len(u)

    def squeeze(y: Array) -> Array:
        return np.maximum(-row.G @ y[:n], 0.0)

    def rates(t: float, y: Array) -> Array:
        return np.concatenate([y[n:], row.G.T @ (k * squeeze(y) ** m) / row.m])

    def busy(t: float, y: Array) -> float:
        gaps, apart = row.G @ y[:n], row.G @ y[n:]
        return float(np.max(np.where((gaps > 0) & (apart > 0), -1.0, 1.0))) if t > 0.1 else 1.0

    busy.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(
        rates, (0, 200), np.concatenate([np.zeros(n), u]), method="DOP853", rtol=1e-13,
        atol=1e-14, events=busy, max_step=0.05,
    )  # fmt: skip
    closed = np.array([squeeze(y) > 1e-9 for y in run.y.T]).astype(int)
    assert run.status == 1
    assert np.all(np.sum(np.diff(closed, axis=0) == 1, axis=0) <= 1), "a contact closed twice"
    return run.y[n:, -1]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("m", [1.0, 1.5])
@pytest.mark.parametrize(
    ("masses", "u", "k"),
    [
        ((1, 1, 1), [1, 0, 0], [1, 1]),
        ((1, 1, 1), [1, 0, 0], [1, 5]),
        ((1, 2, 1), [1, 0, 0], [1, 1]),
        ((3, 1, 2), [1, 0, -1], [2, 1]),
        ((1, 1, 1, 1), [1, 0, 0, 0], [1, 1, 1]),
        ((1, 1, 1, 1), [1, 1, 0, 0], [1, 1, 1]),
    ],
)
def test_elastic_contacts_are_springs(
    masses: tuple[float, ...], u: list[float], k: list[float], m: float
) -> None:
    row = Row(*masses)
    after, done = row.impact(u, eps=1.0, stiffness=k, exponent=m)
    assert after == pytest.approx(springs(row, u, k, m), abs=1e-8)
    assert done.error < 1e-7
    assert done.energy == 0.0


def test_three_equal_balls_with_linear_springs_in_closed_form() -> None:
    """W has eigenvalues 1 and 3: sines until the first contact ends, then two balls rebound."""
    w = 3**0.5

    def first(t: float) -> float:
        return float(np.sin(t) + np.sin(w * t) / w)

    t = brentq(first, 1.0, 3.0, xtol=1e-15)
    u1 = 1 - 0.5 * (1 - np.cos(t) + (1 - np.cos(w * t)) / 3)
    d2 = 0.5 * (np.sin(t) - np.sin(w * t) / w)  # compression of the second contact, and its rate
    rate = 0.5 * (np.cos(t) - np.cos(w * t))
    apart = (rate**2 + 2 * d2**2) ** 0.5
    middle = (1 - u1) / 2
    expected = [u1, middle - apart / 2, middle + apart / 2]
    after, _ = Row(1, 1, 1).impact([1, 0, 0], eps=1.0)
    assert after == pytest.approx(expected, abs=1e-9)


def test_ten_hertz_balls_as_published() -> None:
    # Newton's cradle in Siconos, by the implementation of the authors of the law: the first ball
    # goes back with 0.071, the last one leaves with 0.986.
    after, done = Row(*[1] * 10).impact([1] + [0] * 9, eps=1.0, exponent=1.5)
    assert [round(after[0], 3), round(after[-1], 3)] == [-0.071, 0.986]
    assert sum(after) == pytest.approx(1.0, abs=1e-14)
    assert np.all(np.diff(after) > 0)
    assert done.energy == 0.0


def bistiff(row: Row, u: list[float], e: list[float], m: float) -> Array:
    """Velocities after an impact of bi-stiffness contacts that each compress and expand once.

    On the way out the force is ``k ((d - r)/e**2)**m``, with the indentation r that remains such
    that the work returned is e**2 of the work done: r = d_max (1 - e**2).
    """
    n, c = len(u), len(e)
    eps = np.array(e)
    top = np.full(c, np.nan)  # indentation at the end of compression

    def force(d: Array) -> Array:
        out = np.maximum(d - top * (1 - eps**2), 0.0) / eps**2
        return np.where(np.isnan(top), np.maximum(d, 0.0), out) ** m

    def rates(t: float, y: Array) -> Array:
        return np.concatenate([y[n:], row.G.T @ force(-row.G @ y[:n]) / row.m])

    def turns(i: int) -> Callable[[float, Array], float]:
        def event(t: float, y: Array) -> float:
            return float(row.G[i] @ y[n:]) if np.isnan(top[i]) else -1.0

        event.terminal = True  # type: ignore[attr-defined]
        event.direction = 1.0  # type: ignore[attr-defined]
        return event

    y = np.concatenate([np.zeros(n), u])
    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14, "max_step": 0.05}
    while np.isnan(top).any():
        run = solve_ivp(rates, (0, 50), y, events=[turns(i) for i in range(c)], **options)
        assert run.status == 1
        y = run.y[:, -1]
        turned = np.isnan(top) & (row.G @ y[n:] >= -1e-12)  # both at once where they mirror
        top[turned] = -(row.G @ y[:n])[turned]
    run = solve_ivp(rates, (0, 50), y, **options)
    gaps, apart = np.array([[row.G @ y[:n], row.G @ y[n:]] for y in run.y.T]).swapaxes(0, 1)
    inside = -gaps > top * (1 - eps**2)
    assert not np.any(inside & (apart < -1e-12) & (np.arange(len(gaps)) > 2)[:, None])
    return run.y[n:, -1]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("m", [1.0, 1.5])
@pytest.mark.parametrize(
    ("masses", "u", "e"),
    [
        ((1, 1), [1, 0], [0.3]),
        ((2, 1, 2), [1, 0, -1], [0.7, 0.7]),
        ((1, 10, 1), [1, 0, -1], [0.7, 0.4]),
        ((1, 3, 1), [1, 0, 0], [0.8, 0.5]),
    ],
)
def test_inelastic_contacts_are_bistiff_springs(
    masses: tuple[float, ...], u: list[float], e: list[float], m: float
) -> None:
    row = Row(*masses)
    after, done = row.impact(u, eps=e, exponent=m)
    assert after == pytest.approx(bistiff(row, u, e, m), abs=1e-8)
    assert done.energy < 0.0


def test_only_ratios_of_stiffness_and_the_direction_of_the_velocities_count() -> None:
    row, u = Row(1, 2, 1, 3), np.array([1.0, 0.0, 0.0, -0.5])
    after, _ = row.impact(list(u), eps=0.8, stiffness=[1, 2, 3], exponent=1.5)
    other, _ = row.impact(list(1e-4 * u), eps=0.8, stiffness=[1e9, 2e9, 3e9], exponent=1.5)
    assert 1e4 * other == pytest.approx(after, abs=1e-12)


def test_a_mirrored_impact_is_the_mirrored_impact() -> None:
    row = Row(1, 2, 2, 1)
    after, _ = row.impact([1, 0, 0, -1], eps=[0.5, 0.9, 0.5], exponent=1.5)
    assert after == pytest.approx(-after[::-1], abs=1e-9)
    assert after[3] > after[2] > 0


@pytest.mark.sampled(1)
@pytest.mark.parametrize("m", [1.0, 1.5])
@pytest.mark.parametrize(
    ("masses", "u", "k", "of"),
    [
        ((1, 1, 1), [1, 0, 0], [1, 1], lambda e: [e, 1.0]),
        ((1, 1, 2, 1), [1, 0, 0, 0], [1, 1, 1], lambda e: [e, 0.7, e]),
        ((1, 1, 1, 1), [1, 0, 0, -1], [1, 1, 1], lambda e: [e, 1.0, e]),
        # here a plastic contact, pressed by the other one, does not expand to nothing
        ((3, 2, 4), [1, 0, 0], [1, 10], lambda e: [1.0, e]),
        ((1, 2, 4), [1, 0, -1], [3, 3], lambda e: [e, 1.0]),
    ],
)
def test_plastic_contacts_are_the_limit_of_vanishing_restitution(
    masses: tuple[float, ...],
    u: list[float],
    k: list[float],
    of: Callable[[float], list[float]],
    m: float,
) -> None:
    row = Row(*masses)
    plastic, _ = row.impact(u, eps=of(0.0), stiffness=k, exponent=m)
    for e in (
        1e-2,
        1e-3,
        1e-4,
    ):  # of first order: what a contact gives back is e times what it took
        near, _ = row.impact(u, eps=of(e), stiffness=k, exponent=m)
        assert np.abs(near - plastic).max() < e


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.integers(2, 4), st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1.5, 2.0]))
def test_rows_never_gain_energy_and_keep_momentum(n: int, seed: int, exponent: float) -> None:
    rng = np.random.default_rng(seed)
    row = Row(*rng.uniform(0.2, 5, n))
    u = rng.standard_normal(n)
    eps = rng.choice([0.0, 0.5, 0.8, 1.0], n - 1)
    after, done = row.impact(
        list(u), eps=eps, stiffness=rng.uniform(0.1, 10, n - 1), exponent=exponent
    )
    energy = 0.5 * (row.m @ after**2 - row.m @ u**2)
    scale = row.m @ u**2
    assert done.energy <= 0.0
    assert energy <= 1e-14 * scale
    assert energy == pytest.approx(done.energy, abs=1e-9 * scale)
    assert row.m @ after == pytest.approx(row.m @ u, abs=1e-13 * (row.m @ np.abs(u)))
    assert done.impulses.min() >= 0.0
    assert done.after.min() >= 0.0
    if (eps[list(done.active)] == 1.0).all():
        assert done.energy == pytest.approx(0.0, abs=1e-9 * scale)


def test_the_error_that_is_reported_bounds_the_error() -> None:
    row = Row(1, 2, 1, 3)
    options = {"eps": np.full(3, 0.8), "stiffness": np.ones(3), "exponent": 1.5}
    v = row.G @ [1, 0, 0, 0]
    exact = compliant_impact(row.W, v, **options)
    for rtol in (1e-6, 1e-8):
        done = compliant_impact(row.W, v, rtol=rtol, **options)
        error = np.abs(row.W @ (done.impulses - exact.impulses)).max()
        assert error < done.error


def test_an_impact_with_too_many_phases_is_refused() -> None:
    row = Row(1, 1, 1)
    with pytest.raises(Refused) as caught:
        compliant_impact(
            row.W, row.G @ [1, 0, 0], eps=np.full(2, 0.1), stiffness=np.ones(2), max_pieces=5
        )
    assert caught.value.code == "HB-J204"
