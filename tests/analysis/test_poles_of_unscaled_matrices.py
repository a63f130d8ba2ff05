"""Poles of matrices in any units: those at the origin are told from others by ranks."""

import numpy as np
import pytest

from hybond.analysis.structure.controllability import controllability
from hybond.equations.descriptor import Descriptor
from hybond.equations.pencil import analyse, poles_of


@pytest.mark.parametrize("fast", [1e-8, 1e-3, 1.0, 1e3, 1e5, 1e8])
def test_poles_that_coincide_far_from_one_are_not_taken_for_zero(fast: float) -> None:
    chain = np.array([[0, 1, 0], [0, -fast, 1], [0, 0, -fast]])
    for a in (chain, chain.T, np.array([[0, 1, 0], [-(fast**2), -2 * fast, 0], [1, 0, 0]])):
        found = poles_of(a)
        # a double pole is known to half the digits
        assert np.abs(found[:2] + fast).max() < 1e-6 * fast
        assert found[2] == 0.0


def test_chains_of_random_units_have_as_many_poles_at_the_origin_as_they_were_made_with() -> None:
    rng = np.random.default_rng(1)
    for _ in range(60):
        n = int(rng.integers(2, 6))
        size = 10.0 ** int(rng.integers(-9, 10))
        zeros = int(rng.integers(0, n + 1))
        a = np.diag([0.0] * zeros + [-size] * (n - zeros))
        for k in range(n - 1):
            a[k, k + 1] = 10.0 ** int(rng.integers(-3, 4)) * rng.integers(0, 2)
        units = 10.0 ** rng.integers(-4, 5, n)
        order = rng.permutation(n)
        a = (a * units / units[:, None])[np.ix_(order, order)]
        assert int((poles_of(a) == 0.0).sum()) == zeros


@pytest.mark.parametrize("fast", [1e-6, 1.0, 1e6])
def test_the_motions_that_nothing_steers_are_told_in_any_unit_of_time(fast: float) -> None:
    # a steered integrator beside a chain of two equal poles and an integrator that nobody steers
    a = [[0, 0, 0, 0], [0, 0, 1, 0], [0, 0, -fast, 1], [0, 0, 0, -fast]]
    d = Descriptor.of(
        np.eye(4), a, [[1], [0], [0], [0]], states=("a", "b", "c", "d"), inputs=("u",)
    )
    found = controllability(analyse(d))
    assert (found.finite, found.rank) == (False, 1)
    assert np.sort(found.modes) == pytest.approx([-fast, -fast, 0.0], rel=1e-6)


def test_a_slow_pole_beside_a_fast_one_is_none_at_the_origin() -> None:
    assert poles_of(np.diag([-1.0, -1e12])).tolist() == [-1e12, -1.0]
    # 1 F over 1 ohm beside 1 pF over 1 ohm
    a = [[-1, 0], [0, -1e12]]
    d = Descriptor.of(np.eye(2), a, [[1], [1e12]], states=("a", "b"), inputs=("u",))
    poles = analyse(d).poles
    assert poles is not None and np.sort(poles) == pytest.approx([-1e12, -1.0], rel=1e-12)
