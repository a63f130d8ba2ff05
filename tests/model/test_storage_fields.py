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
        exact = [float(v / det) for v in (z, x, -y)]
        assert [ia, idd, ib] == pytest.approx(exact, rel=3e-16, abs=0.0)


@pytest.mark.parametrize("coupling", [0.9, 0.999, 0.999999])
def test_of_equal_windings_the_inverse_has_two_numbers(coupling: float) -> None:
    """Of a diagonal 1 and k elsewhere it is known: (1 + 2k)/d and -k/d, d = (1 - k)(1 + 3k)."""
    m = hb.Model("windings", domain="electrical")
    m.add(core=hb.I([[1.0 if i == j else coupling for j in range(4)] for i in range(4)]))
    for j in range(4):
        m.add(**{f"n{j}": hb.One(), f"r{j}": hb.R("1 ohm")})
        m.bond(f"n{j} -> core.{j + 1}", f"n{j} -> r{j}")
    law = m.flatten().nodes[0].law
    assert law is not None and law.matrix is not None
    k = Fraction(coupling)
    d = (1 - k) * (1 + 3 * k)
    own, mutual = float((1 + 2 * k) / d), float(-k / d)
    for i, row in enumerate(law.matrix):
        assert list(row) == [own if i == j else mutual for j in range(4)]


@pytest.mark.parametrize("off", [1.0 + 1e-9, -1.0, 0.0])
def test_a_field_that_is_not_symmetric_is_refused_as_it_is_written(off: float) -> None:
    with pytest.raises(hb.ModelError, match="HB-M163"):
        coupled([[1e3, 1e-5], [1e-5 * off, 1e-3]]).flatten()
