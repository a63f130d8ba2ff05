"""Matrices of storage over many powers of ten: symmetric as they are written, to rounding."""

import random
from fractions import Fraction

import pytest

import hybond as hb


def coupled(matrix: list[list[float]], kind: str = "C") -> hb.Model:
    """Return a model with a field of two ports, each beside a resistor."""
    m = hb.Model("field")
    field = hb.C(matrix, q=[0.5, -2.0]) if kind == "C" else hb.I(matrix, p=[0.5, -2.0])
    m.add(a=hb.Zero(), b=hb.Zero(), c=field, r=hb.R(1.0), s=hb.R(1.0))
    m.bond("a -> c.1", "b -> c.2", "a -> r", "b -> s")
    return m


@pytest.mark.parametrize("kind", ["C", "I"])
@pytest.mark.parametrize("seed", [0, 1])
def test_weak_coupling_beside_large_and_small_is_symmetric(kind: str, seed: int) -> None:
    draw = random.Random(seed)
    known = [[0.00789, -0.0111], [-0.0111, 247.0]]  # its inverse is symmetric but for 1.5e-12
    for k in range(12):
        a, d = (10.0 ** draw.uniform(-7.0, 7.0) for _ in range(2))
        b = draw.uniform(-0.9, 0.9) * (a * d) ** 0.5 * 10.0 ** draw.uniform(-9.0, 0.0)
        matrix = known if k == 0 else [[a, b], [b, d]]
        law = coupled(matrix, kind).flatten().nodes[2].law
        assert law is not None and law.matrix is not None
        (ia, ib), (ic, idd) = law.matrix
        assert ib == ic
        (x, y), (_, z) = [[Fraction(v) for v in row] for row in matrix]
        det = x * z - y * y
        size = float((x * z) ** 1 / det)
        assert ia == pytest.approx(float(z / det), rel=1e-14 * size + 1e-15)
        assert idd == pytest.approx(float(x / det), rel=1e-14 * size + 1e-15)
        scale = float(x * z) ** 0.5 / float(det)
        assert ib == pytest.approx(float(-y / det), abs=1e-14 * size * scale)


@pytest.mark.parametrize("off", [1.0 + 1e-9, -1.0, 0.0])
def test_a_field_that_is_not_symmetric_is_refused_as_it_is_written(off: float) -> None:
    with pytest.raises(hb.ModelError, match="HB-M163"):
        coupled([[1e3, 1e-5], [1e-5 * off, 1e-3]]).flatten()
