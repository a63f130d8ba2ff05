"""Stiffness: poles in closed form, and who makes them."""

from __future__ import annotations

import pytest

import hybond as hb
from hybond.analysis.structure.stiffness import STIFF, stiffness
from hybond.analysis.structure.structure import structure
from hybond.equations.descriptor import Descriptor
from hybond.equations.pencil import analyse


def two_cells(r1: float, c1: float, r2: float, c2: float) -> hb.Model:
    """Two RC cells on one voltage source: poles -1/(r1 c1) and -1/(r2 c2)."""
    m = hb.Model("cells", domain="electrical")
    m.add(V=hb.Se(1), n=hb.Zero(), i1=hb.One(), R1=hb.R(r1), C1=hb.C(c1))
    m.add(i2=hb.One(), R2=hb.R(r2), C2=hb.C(c2))
    m.bond("V -> n -> i1 -> R1", "i1 -> C1", "n -> i2 -> R2", "i2 -> C2")
    return m


@pytest.mark.parametrize("fast", [1e-3, 1e-6, 1e-9, 1e-12])
def test_the_ratio_of_two_cells(fast: float) -> None:
    report = structure(two_cells(1e3, fast, 1e3, 1e-3))
    row = report.rows[0]
    words = row.stiffness
    assert words is not None
    assert words.ratio == pytest.approx(1e-3 / fast, rel=1e-9)
    assert words.stiff == (words.ratio > STIFF)
    if words.stiff:
        assert (words.fast, words.slow, words.resistors) == (("C1.q",), ("C2.q",), ("R1",))
        assert words.fastest == pytest.approx(-1 / (1e3 * fast))
        assert report.marks(()) == {"C1": "stiff", "R1": "stiff"}
        assert any("stiff" in note and "R1" in note for note in row.notes)
    # a stiff mode is as controllable as any other
    assert row.controllable is not None
    assert row.controllable.finite == (fast != 1e-3) and row.controllable.sure


def test_an_overdamped_mass_is_fast_in_momentum_and_slow_in_place() -> None:
    """m s^2 + b s + k = 0 with b^2 >> m k: poles near -b/m and -k/b."""
    m = hb.Model("overdamped", domain="translational")
    m.add(F=hb.Se(1), v=hb.One(), mass=hb.I(1), spring=hb.C(1), damper=hb.R(1e4))
    m.bond("F -> v -> mass", "v -> spring", "v -> damper")
    words = structure(m).rows[0].stiffness
    assert words is not None
    exact = (1e4 + (1e8 - 4) ** 0.5) / 2
    assert words.fastest == pytest.approx(-exact, rel=1e-9)
    assert words.ratio == pytest.approx(exact**2, rel=1e-6)
    assert (words.fast, words.slow, words.resistors) == (("mass.p",), ("spring.q",), ("damper",))


def test_an_oscillator_is_not_stiff_and_poles_at_zero_do_not_count() -> None:
    m = hb.Model("free", domain="translational")
    m.add(F=hb.Se(1), v=hb.One(), a=hb.I(1), s=hb.Zero(), k=hb.C(1e-4), w=hb.One(), b=hb.I(1))
    m.bond("F -> v -> a", "v -> s -> w -> b", "s -> k")
    row = structure(m).rows[0]
    assert row.stiffness is not None
    assert row.stiffness.ratio == pytest.approx(1.0) and not row.stiffness.stiff
    assert row.poles.count(0j) == 1
    assert max(abs(z) for z in row.poles) == pytest.approx((2 / 1e-4) ** 0.5)


def test_nothing_that_moves_is_not_stiff() -> None:
    m = hb.Model("still")
    m.add(V=hb.Se(1), c=hb.C(1))
    m.bond("V -> c")
    assert structure(m).rows[0].stiffness is None


def test_what_a_fast_motion_drives_along_takes_no_part_in_it() -> None:
    """x1' = -2 x1, x2' = 2 x1 - x2: x2 moves in the fast mode, but does not make it."""
    d = Descriptor.of(
        [[1, 0], [0, 1]], [[-2, 0], [2, -1]], [[1], [0]], states=("x1", "x2"), inputs=("u",)
    )
    found = stiffness(analyse(d))
    assert found is not None
    assert (found.fast, found.slow) == ((0,), (1,))
