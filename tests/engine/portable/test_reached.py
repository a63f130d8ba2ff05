"""What no given value reaches: block after block, in any order of equations and unknowns."""

from __future__ import annotations

import numpy as np
import pytest

from hybond.engine.algebra.reached import make_reached, put_zeros


@pytest.mark.parametrize("seed", range(20))
def test_only_blocks_that_are_led_to_are_not_zero(seed: int) -> None:
    """Blocks below the given one are zero, those above are not; the solution is NumPy's."""
    rng = np.random.default_rng(seed)
    sizes = rng.integers(1, 4, size=4)
    ends = np.cumsum(sizes)
    n = int(ends[-1])
    block = np.repeat(np.arange(4), sizes)
    a = rng.normal(size=(n, n)) + 4.0 * np.eye(n)
    a[block[:, None] > block[None, :]] = 0.0  # an equation has what is in its block, or after it
    given = int(rng.integers(4))
    b = np.where(block == given, rng.normal(size=n), 0.0)
    rows, columns = rng.permutation(n), rng.permutation(n)
    mixed, wanted = a[rows][:, columns], np.linalg.solve(a, b)[columns]
    x = (wanted + 1e-17).tolist()
    put_zeros(make_reached(), n, mixed.ravel().tolist(), b[rows].tolist(), x)
    assert [value != 0.0 for value in x] == (block[columns] <= given).tolist()
    assert x == pytest.approx(wanted, abs=1e-16)


def test_equations_that_share_an_unknown_are_left() -> None:
    """Two equations of one unknown: there is no way to say which stands for which."""
    x = [1.0, 2.0]
    put_zeros(make_reached(), 2, [1.0, 0.0, 2.0, 0.0], [0.0, 0.0], x)
    assert x == [1.0, 2.0]
