"""Closed forms of the bond: line ends, barb, causal stroke."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hybond.draw.geometry import CLEARANCE, STROKE_LENGTH, Box, bond_shape, stroke


def around(x: float, y: float, half: float = 8.0) -> Box:
    return Box(x - half, y - half, x + half, y + half)


def shape_of(a: tuple[float, float], b: tuple[float, float]):  # type: ignore[no-untyped-def]
    return bond_shape(around(*a), around(*b), a, b)


@pytest.mark.parametrize(
    ("a", "b", "side"),
    [
        ((0, 0), (100, 0), (0, 1)),  # to the right: below
        ((100, 0), (0, 0), (0, 1)),  # to the left: below as well
        ((0, 0), (0, 100), (-1, 0)),  # down: left
        ((0, 100), (0, 0), (-1, 0)),  # up: left
        ((0, 0), (100, 100), (0, 1)),
        ((100, 100), (0, 0), (0, 1)),
        ((0, 100), (100, 0), (0, 1)),
    ],
)
def test_barb_is_on_the_conventional_side(a, b, side) -> None:  # type: ignore[no-untyped-def]
    shape = shape_of(a, b)
    assert shape.barb[0] == shape.head
    tip = shape.barb[1]
    off_line = (b[0] - a[0]) * (tip[1] - a[1]) - (b[1] - a[1]) * (tip[0] - a[0])
    towards = (b[0] - a[0]) * side[1] - (b[1] - a[1]) * side[0]
    assert off_line * towards > 0
    back = (tip[0] - shape.head[0]) * (a[0] - b[0]) + (tip[1] - shape.head[1]) * (a[1] - b[1])
    assert back > 0  # the barb points back along the bond, it makes an arrow head


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("end", [0, 1])
def test_stroke_is_across_the_end_for_both_directions(backwards: bool, end: int) -> None:
    left, right = (0.0, 0.0), (100.0, 0.0)
    tail, head = (right, left) if backwards else (left, right)
    shape = shape_of(tail, head)
    at = 13.5 if (end == 0) != backwards else 86.5
    (x1, y1), (x2, y2) = stroke(shape, end)
    assert (x1, x2) == pytest.approx((at, at))
    assert sorted([y1, y2]) == pytest.approx([-STROKE_LENGTH / 2, STROKE_LENGTH / 2])


coordinate = st.floats(-500, 500)


@given(coordinate, coordinate, coordinate, coordinate, st.sampled_from([0, 1]))
def test_stroke_is_perpendicular_and_centred(ax, ay, bx, by, end) -> None:  # type: ignore[no-untyped-def]
    assume(math.hypot(bx - ax, by - ay) > 60)
    shape = shape_of((ax, ay), (bx, by))
    (px, py), (qx, qy) = stroke(shape, end)
    along = (bx - ax, by - ay)
    assert (qx - px) * along[0] + (qy - py) * along[1] == pytest.approx(0, abs=1e-6)
    assert ((px + qx) / 2, (py + qy) / 2) == pytest.approx(
        shape.head if end else shape.tail, abs=1e-9
    )
    assert math.hypot(qx - px, qy - py) == pytest.approx(STROKE_LENGTH)


@given(coordinate, coordinate, coordinate, coordinate)
def test_bond_ends_clear_of_the_letters(ax, ay, bx, by) -> None:  # type: ignore[no-untyped-def]
    assume(math.hypot(bx - ax, by - ay) > 60)
    shape = shape_of((ax, ay), (bx, by))
    for node in ((ax, ay), (bx, by)):
        assert around(*node).grown(0.99 * CLEARANCE).cut((shape.tail, shape.head)) is None


def test_parallel_bonds_are_apart() -> None:
    a, b = (0.0, 0.0), (100.0, 0.0)
    one = bond_shape(around(*a), around(*b), a, b, shift=-4.5)
    two = bond_shape(around(*b), around(*a), b, a, shift=4.5)
    assert two.tail[1] - one.head[1] == pytest.approx(9.0)
