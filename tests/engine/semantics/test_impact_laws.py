"""Impact laws against closed forms, quadratic programmes, published numbers, and each other."""

from fractions import Fraction

import numpy as np
import pytest
from engine_impacts import LAWS, Refused, impact
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

Array = np.ndarray


class Row:
    """Bodies in a row, each touching the next: contact i closes between bodies i and i + 1."""

    def __init__(self, *masses: float) -> None:
        self.m = np.array(masses, dtype=float)
        self.G = np.diff(np.eye(len(masses)), axis=0)
        self.W = self.G / self.m @ self.G.T

    def after(self, u: list[float], impulses: Array) -> Array:
        """Velocities of the bodies after the impulses."""
        return np.array(u, dtype=float) + self.G.T @ impulses / self.m

    def hit(self, u: list[float], **options: object) -> Array:
        return self.after(u, impact(self.W, self.G @ u, **options).impulses)


def rebound(m: float, M: float, u: float, w: float, e: float) -> list[float]:
    """Two bodies: momentum is kept, the relative velocity is reversed and reduced."""
    centre = (m * u + M * w) / (m + M)
    return [centre + M / (m + M) * e * (w - u), centre - m / (m + M) * e * (w - u)]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("e", [0.0, 0.001, 0.3, 1.0])
@pytest.mark.parametrize(("m", "M"), [(1.0, 1.0), (2.0, 3.0), (1e-3, 1e3)])
@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_two_bodies(law: str, e: float, m: float, M: float, exponent: float) -> None:
    row = Row(m, M)
    done = impact(row.W, [-5.0], eps=e, law=law, stiffness=7e8, exponent=exponent)
    assert row.after([2, -3], done.impulses) == pytest.approx(
        rebound(m, M, 2, -3, e), abs=1e-9 if law == "lzb" else 1e-14
    )
    lost = 0.5 * m * M / (m + M) * 25 * (1 - e**2)
    assert done.energy == pytest.approx(-lost, rel=1e-9, abs=0.0 if e == 1 else 1e-9)
    assert done.active == (0,)


@pytest.mark.parametrize("law", LAWS)
def test_nothing_happens_where_nothing_approaches(law: str) -> None:
    done = impact(Row(1, 1, 1).W, [0.0, 1.0], eps=1.0, law=law)
    assert (done.active, done.energy) == ((), 0.0)
    assert done.after.tolist() == [0.0, 1.0] and done.impulses.tolist() == [0.0, 0.0]


def test_an_elastic_impact_keeps_energy_to_the_last_bit() -> None:
    for law in ("newton_simultaneous", "poisson"):
        assert impact(Row(1, 3, 7).W, [-1.0, -0.3], eps=1.0, law=law).energy == 0.0


# --- three balls ---------------------------------------------------------------------------------


def test_three_elastic_balls() -> None:
    at_once = Row(1, 1, 1).hit([1, 0, 0], eps=1.0, law="newton_simultaneous")
    assert at_once == pytest.approx([-1 / 3, 2 / 3, 2 / 3], abs=1e-15)


@pytest.mark.parametrize("e", [0.0, 0.25, 1.0])
def test_three_balls_with_equal_restitution_by_poisson_are_the_simultaneous_ones(e: float) -> None:
    # compression ends at (1/3, 1/3, 1/3) with impulses (2/3, 1/3); a part e comes back
    expected = [(1 - 2 * e) / 3, (1 + e) / 3, (1 + e) / 3]
    for law in ("poisson", "newton_simultaneous"):
        assert Row(1, 1, 1).hit([1, 0, 0], eps=e, law=law) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("eps", "impulses"),
    [
        # impulses (4/3, 1/3) would let 2 run into 3: these two go on together at 2/3
        ([1.0, 0.0], [4 / 3, 2 / 3]),
        # impulses (2/3, 2/3) would let 1 run into 2: these two go on together at 1/6
        ([0.0, 1.0], [5 / 6, 2 / 3]),
        # (3/2)(2/3), (1 + f)/3 with f = 3/4: 2 has 1 - 7/12 = 5/12, 3 has 7/12, 1 has 0: no more
        ([0.5, 0.75], [1.0, 7 / 12]),
    ],
)
def test_poisson_with_different_restitution(eps: list[float], impulses: list[float]) -> None:
    row = Row(1, 1, 1)
    done = impact(row.W, [-1.0, 0.0], eps=eps, law="poisson")
    assert done.impulses == pytest.approx(impulses, abs=1e-15)
    after = row.after([1, 0, 0], np.array(impulses))
    assert done.energy == pytest.approx(0.5 * (after @ after - 1), abs=1e-15)


# --- blocks --------------------------------------------------------------------------------------


def block(mass: float, inertia: float, half: float) -> Array:
    """A block on its two lower corners, a distance `half` on either side of its centre."""
    J = np.array([[1.0, -half], [1.0, half]])
    return J @ np.diag([1 / mass, 1 / inertia]) @ J.T


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
def test_a_block_that_falls_flat_rebounds_flat(law: str, e: float) -> None:
    done = impact(block(2, 5, 3), [-1.0, -1.0], eps=e, law=law)
    assert done.after == pytest.approx([e, e], abs=1e-9)
    assert done.impulses == pytest.approx([1 + e, 1 + e], abs=1e-9)  # 2 kg, 1 m/s, on two corners


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
def test_a_rocking_block(law: str, e: float) -> None:
    # It turns about the right corner; the left one hits. m b^2 < J: the right corner is lifted by
    # the blow. m b^2 > J: it is pressed down, and stays where it is.
    slender, wide = block(1, 5, 2), block(1, 3, 2)
    lifted = impact(slender, [-1.0, 0.0], eps=e, law=law)
    assert lifted.after == pytest.approx([e, (1 + e) * (1 / 1 - 4 / 5) / (1 + 4 / 5)], abs=1e-15)
    assert lifted.active == (0,)
    pressed = impact(wide, [-1.0, 0.0], eps=e, law=law)
    assert pressed.after == pytest.approx([e, 0.0], abs=1e-15)
    assert pressed.active == (0, 1)


# --- plastic impacts -----------------------------------------------------------------------------


def projection(W: Array, v: Array) -> Array:
    """Velocities nearest to `v`, in the metric of kinetic energy, that do not approach."""
    L = np.linalg.cholesky(W)
    z, _ = nnls(L.T, -np.linalg.solve(L, v))
    return v + W @ z


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_a_plastic_impact_is_the_projection(n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    G = rng.standard_normal((n, n + 2))
    W, v = G @ G.T, rng.standard_normal(n)
    for law in ("newton_simultaneous", "poisson"):
        done = impact(W, v, eps=0.0, law=law)
        assert done.after == pytest.approx(projection(W, v), abs=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("masses", [(1, 1, 1), (1, 5, 2), (3, 1, 1, 4)])
def test_plastic_bodies_in_a_row_go_on_together_by_all_laws(
    law: str, masses: tuple[int, ...]
) -> None:
    u = [1.0] + [0.0] * (len(masses) - 1)
    expected = np.full(len(masses), masses[0] / sum(masses))
    assert Row(*masses).hit(u, eps=0.0, law=law) == pytest.approx(expected, abs=1e-9)


# --- one contact after the other --------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("e", ["1", "4/5", "1/2"])
def test_spheres_at_distances_as_in_argesim_c12(law: str, e: str) -> None:
    """Four equal spheres at equal distances, the first one moves: one collision at a time.

    The oracle goes the same way in rational numbers, with the rule for two bodies.
    """
    x, exact_x = [0.0, 2.0, 4.0, 6.0], [Fraction(i) for i in (0, 2, 4, 6)]
    u, exact = [1.0, 0.0, 0.0, 0.0], [Fraction(i) for i in (1, 0, 0, 0)]
    W, r, hits = Row(1, 1).W, Fraction(e), 0
    while pairs := [i for i in range(3) if exact[i] > exact[i + 1]]:
        waits = [(exact_x[i + 1] - exact_x[i] - 1) / (exact[i] - exact[i + 1]) for i in pairs]
        wait = min(waits)
        i = pairs[waits.index(wait)]
        assert waits.count(wait) == 1
        exact_x = [a + wait * b for a, b in zip(exact_x, exact)]
        x = [a + float(wait) * b for a, b in zip(x, u)]
        assert x[i + 1] - x[i] == pytest.approx(1.0, abs=1e-7)
        a, b = exact[i], exact[i + 1]
        exact[i], exact[i + 1] = ((1 - r) * a + (1 + r) * b) / 2, ((1 + r) * a + (1 - r) * b) / 2
        nu = impact(W, [u[i + 1] - u[i]], eps=float(r), law=law).impulses[0]
        u[i], u[i + 1] = u[i] - nu, u[i + 1] + nu
        hits += 1
        assert hits < 60
    assert u == pytest.approx([float(b) for b in exact], abs=1e-8)
    if e == "1":
        assert (hits, exact) == (3, [0, 0, 0, 1])


# --- contacts that depend on each other ----------------------------------------------------------

LEGS = np.array([[1, -1, -1], [1, -1, 1], [1, 1, 1], [1, 1, -1.0]])  # heave, pitch, roll
TABLE = LEGS @ np.diag([1 / 8, 1 / 2, 1 / 3]) @ LEGS.T


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
def test_the_legs_of_a_table_share_equally_and_say_so(law: str) -> None:
    done = impact(TABLE, [-1.0] * 4, eps=0.5, law=law)
    assert done.after == pytest.approx([0.5] * 4, abs=1e-14)
    assert done.impulses == pytest.approx([1.5 * 8 / 4] * 4, abs=1e-13)
    assert done.shared
    assert impact(TABLE, [-1.0] * 4, eps=0.5, law="lzb").impulses == pytest.approx([3.0] * 4)


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
def test_shares_do_not_depend_on_the_order_of_the_contacts(law: str) -> None:
    v = LEGS @ [-1.0, 0.1, -0.2]
    done = impact(TABLE, v, eps=0.5, law=law).impulses
    for order in ([1, 2, 3, 0], [3, 1, 0, 2]):
        other = impact(TABLE[np.ix_(order, order)], v[order], eps=0.5, law=law).impulses
        assert other == pytest.approx(done[order], abs=1e-13)


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
def test_dependent_contacts_with_different_restitution_are_refused(law: str) -> None:
    with pytest.raises(Refused) as caught:
        impact(TABLE, [-1.0] * 4, eps=[0.5, 0.5, 0.5, 0.4], law=law)
    assert (caught.value.code, caught.value.contacts) == ("HB-J202", [0, 1, 2, 3])


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
def test_only_the_dependent_ones_are_named(law: str) -> None:
    W = np.block([[np.ones((2, 2)), np.zeros((2, 1))], [np.zeros((1, 2)), np.ones((1, 1))]])
    with pytest.raises(Refused) as caught:
        impact(W, [-1.0, -1.0, -1.0], eps=[0.5, 0.4, 0.3], law=law)
    assert caught.value.contacts == [0, 1]
    # of equal restitution, the third one may have another
    done = impact(W, [-1.0, -1.0, -1.0], eps=[0.5, 0.5, 0.3], law=law)
    assert done.after == pytest.approx([0.5, 0.5, 0.3], abs=1e-15)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("W", "v"), [([[0.0]], [-1.0]), ([[1, -1], [-1, 1]], [-1.0, -1.0])])
def test_what_no_impulse_can_stop_is_refused(law: str, W: list, v: list) -> None:
    with pytest.raises(Refused) as caught:
        impact(W, v, eps=0.5, law=law)
    assert caught.value.code == "HB-J203"


# --- energy --------------------------------------------------------------------------------------


def test_the_simultaneous_law_with_different_restitution_may_create_energy() -> None:
    with pytest.raises(Refused) as caught:
        impact(Row(1, 1, 1).W, [-1.0, 0.2], eps=[1.0, 0.0], law="newton_simultaneous")
    assert caught.value.code == "HB-J201"
    for law in ("poisson", "lzb"):
        done = impact(Row(1, 1, 1).W, [-1.0, 0.2], eps=[1.0, 0.0], law=law)
        assert done.energy <= 0.0 and done.impulses.min() >= 0.0


@pytest.mark.parametrize("law", LAWS)
def test_restitution_above_one_is_a_source(law: str) -> None:
    done = impact([[1.0]], [-1.0], eps=1.2, law=law)
    assert done.energy == pytest.approx(0.5 * (1.44 - 1), abs=1e-9)


@settings(max_examples=150, deadline=None)
@given(st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_poisson_loses_energy_whatever_the_restitutions(n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    G = rng.standard_normal((n, n + 1))
    W, v, eps = G @ G.T, rng.standard_normal(n), rng.uniform(0, 1, n)
    K = np.linalg.inv(W)  # v' K v / 2: kinetic energy that the contacts can change
    done = impact(W, v, eps=eps, law="poisson")
    assert done.impulses.min() >= 0.0
    assert done.energy <= 0.0
    change = 0.5 * (done.after @ K @ done.after - v @ K @ v)
    assert done.energy == pytest.approx(change, abs=1e-9 * (v @ K @ v))
    squeezed = 0.5 * (v @ K @ v - projection(W, v) @ K @ projection(W, v))
    kept = 1 - eps.max() ** 2  # at least this part of what the compression took is lost
    assert done.energy <= -kept * squeezed + 1e-9 * (v @ K @ v)
    assert done.after.min() >= -1e-9 * np.abs(v).max()
