"""Elimination knows how many digits it lost, and what is rounding: held against fractions."""

import math
import operator
import sys
from fractions import Fraction

import numpy as np
import pytest

from hybond.engine.mode.rows.elimination import add_row, give
from hybond.engine.mode.rows.elimination_of_another import repeat_elimination
from hybond.engine.mode.rows.elimination_records import (
    Elimination,
    begin_elimination,
    make_elimination,
)

KNOWN = 2
Matrix = list[list[Fraction]]


def eliminated(rows: Matrix, n: int) -> Elimination:
    e = make_elimination(n, n + KNOWN)
    begin_elimination(e)
    for row in rows:
        for k, c in enumerate(row):
            if c:
                give(e, k, float(c))
        assert add_row(e) == -1
    return e


def solved(rows: Matrix, n: int) -> Matrix:
    """What the knowns add to each unknown, by Gauss and Jordan without rounding."""
    a = [list(row) for row in rows]
    for k in range(n):
        pivot = next(i for i in range(k, n) if a[i][k])
        a[k], a[pivot] = a[pivot], a[k]
        a[k] = [c / a[k][k] for c in a[k]]
        for i in range(n):
            if i != k and a[i][k]:
                factor = a[i][k]
                a[i] = [x - factor * y for x, y in zip(a[i], a[k], strict=True)]
    return [row[n:] for row in a]


def ladder(seed: int) -> tuple[Matrix, int]:
    """Node potentials and currents of a random net of resistors over ten powers of ten."""
    draw = np.random.default_rng(seed)
    nodes = int(draw.integers(2, 6))
    edges = [(k, int(draw.integers(-1, k))) for k in range(nodes)]
    edges += [tuple(int(i) for i in draw.integers(-1, nodes, 2)) for _ in range(nodes)]
    edges = [(a, b) for a, b in edges if a != b]
    n = nodes + len(edges)
    rows = []
    for i, (a, b) in enumerate(edges):
        row = [Fraction(0)] * (n + KNOWN)
        row[nodes + i] = Fraction(float(10.0 ** draw.uniform(-5, 5)))
        for node, sign in ((a, -1), (b, 1)):
            if node >= 0:
                row[node] += sign
        rows.append(row)
    for node in range(nodes):
        row = [Fraction(0)] * (n + KNOWN)
        for i, (a, b) in enumerate(edges):
            row[nodes + i] += (a == node) - (b == node)
        row[n + int(draw.integers(0, KNOWN))] = Fraction(float(draw.normal()))
        rows.append(row)
    return rows, n


@pytest.mark.parametrize("seed", range(40))
def test_no_more_is_lost_than_it_says(seed: int) -> None:
    rows, n = ladder(seed)
    e, exact = eliminated(rows, n), solved(rows, n)
    for k in range(n):
        for i in range(e.first[k], e.first[k] + e.count[k]):
            assert e.column.at[i] >= n
            true = exact[k][e.column.at[i] - n]
            off = float(abs(Fraction(e.entry.at[i]) - true))
            assert off <= 8.0 * sys.float_info.epsilon * e.loss.at[i]
            assert e.loss.at[i] >= abs(e.entry.at[i])


@pytest.mark.sampled(10)
@pytest.mark.parametrize("seed", range(40))
def test_entries_and_their_rests_have_twice_the_digits(seed: int) -> None:
    rows, n = ladder(seed)
    e, exact = eliminated(rows, n), solved(rows, n)
    for k in range(n):
        for i in range(e.first[k], e.first[k] + e.count[k]):
            true = exact[k][e.column.at[i] - n]
            assert e.entry.at[i] == pytest.approx(float(true), rel=2.0**-52)
            off = float(abs(Fraction(e.entry.at[i]) + Fraction(e.rest.at[i]) - true))
            assert off <= 2.0**-96 * e.loss.at[i]


def test_what_cancelled_is_known_to_be_uncertain() -> None:
    # x + y = a, x + (1 + 2^-30) y = b: y is 2^30 (b - a), of which thirty binary digits are lost
    small = Fraction(1, 2**30)
    one = Fraction(1)
    e = eliminated([[one, one, -one, 0 * one], [one, 1 + small, 0 * one, -one]], 2)
    losses = [e.loss.at[i] / abs(e.entry.at[i]) for i in range(e.first[1], e.first[1] + 2)]
    assert [math.log2(x) for x in losses] == pytest.approx([31, 31], abs=2)


def test_what_does_not_cancel_loses_little() -> None:
    # a chain of equal resistors from a source: sums of terms of one sign
    n = 60
    rows = []
    for k in range(n):
        row = [Fraction(0)] * (n + KNOWN)
        row[k] = Fraction(1)
        row[k - 1 if k else n] = Fraction(-1, 2)
        rows.append(row)
    e = eliminated(rows, n)
    for k in range(n):
        assert e.loss.at[e.first[k]] <= 4 * (k + 1) * abs(e.entry.at[e.first[k]])


def geared(seed: int) -> tuple[Matrix, int]:
    """A net of resistors over fifteen powers of ten, some behind gears, of three values or many.

    All numbers are quotients of small ones: bridges are in balance, gears undo each other.
    """
    draw = np.random.default_rng(seed)

    def quotient(most: int, decades: int) -> Fraction:
        a, b, power = draw.integers(1, most), draw.integers(1, most), draw.integers(decades + 1)
        return Fraction(int(a), int(b)) * Fraction(10) ** (int(power) - decades // 2)

    nodes = int(draw.integers(2, 7))
    edges = [(k, int(draw.integers(-1, k))) for k in range(nodes)]
    edges += [tuple(int(i) for i in draw.integers(-1, nodes, 2)) for _ in range(nodes)]
    edges = [(a, b) for a, b in edges if a != b]
    few = [quotient(12, 15) for _ in range(3)]
    rows = [[Fraction(0)] * (nodes + len(edges) + KNOWN) for _ in range(nodes + len(edges))]
    for i, (a, b) in enumerate(edges):
        ratio = quotient(8, 0) if draw.random() < 0.4 else Fraction(1)
        rows[i][nodes + i] = few[draw.integers(3)] if draw.random() < 0.6 else quotient(12, 15)
        for node, factor in ((a, ratio), (b, Fraction(-1))):
            if node >= 0:
                rows[i][node] -= factor
                rows[len(edges) + node][nodes + i] += factor
    for node in range(nodes):
        known = nodes + len(edges) + int(draw.integers(KNOWN))
        rows[len(edges) + node][known] = Fraction(int(draw.integers(-5, 6)), 3)
    return [rows[i] for i in draw.permutation(len(rows))], nodes + len(edges)


@pytest.mark.parametrize("seed", range(60))
def test_no_coefficient_is_dropped_and_no_rounding_is_kept(seed: int) -> None:
    rows, n = geared(seed)
    e, exact = eliminated(rows, n), solved(rows, n)
    for k in range(n):
        kept = {e.column.at[i] for i in range(e.first[k], e.first[k] + e.count[k])}
        assert kept == {n + j for j in range(KNOWN) if exact[k][j]}


@pytest.mark.parametrize(
    ("there", "back", "closes"),
    [
        (Fraction(3, 7), Fraction(7, 3), True),
        (Fraction(1, 49), Fraction(49), True),
        (Fraction(-17, 10), Fraction(10, -17), True),
        (Fraction(3, 7), Fraction(7, 3) * (1 + Fraction(1, 10**12)), False),
        (Fraction(2), Fraction(1, 2) * (1 - Fraction(1, 10**13)), False),
    ],
)
def test_gears_that_undo_each_other_but_for_rounding(
    there: Fraction, back: Fraction, closes: bool
) -> None:
    # x = there y, y = back x: any x does if the two undo each other, else none but zero
    e = make_elimination(2, 2 + KNOWN)
    begin_elimination(e)
    for row in ((1.0, -float(there)), (-float(back), 1.0)):
        for k, c in enumerate(row):
            give(e, k, c)
        add_row(e)
    assert (e.solved[0] + e.solved[1] == 1) is closes


def test_one_that_only_keeps_another_gives_it_back_and_takes_no_room_to_add_rows() -> None:
    def added(e: Elimination, coefficients: list[float]) -> None:
        for k, c in enumerate(coefficients):
            give(e, k, c)
        add_row(e)

    def rows(e: Elimination) -> list[dict[int, float]]:
        places = [range(a, a + n) for a, n in zip(e.first, e.count, strict=True)]
        return [{e.column.at[i]: e.entry.at[i] for i in own} for own in places]

    first, second = [1.0, 3.0, 0.5, 0.0, 2.0], [0.7, -1.0, 4.0, 1.0, 0.0]
    kept = make_elimination(3, 3 + KNOWN)
    e = make_elimination(3, 3 + KNOWN)
    begin_elimination(e)
    added(e, first)
    repeat_elimination(e, kept)
    assert not kept.furnished
    added(e, second)
    once = rows(e)
    begin_elimination(e)
    added(e, second)
    repeat_elimination(kept, e)
    added(e, second)
    assert rows(e) == once
    # what is free and known at will: both rows hold
    values = [0.3, -1.7, 2.9, 0.6, -0.8]
    solved = [k for k in range(3) if e.solved[k]]
    for k in solved:
        values[k] = -sum(c * values[j] for j, c in once[k].items())
    assert len(solved) == 2
    for row in (first, second):
        assert sum(map(operator.mul, row, values)) == pytest.approx(0.0, abs=1e-14)
